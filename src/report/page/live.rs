//! What the page's script works on: pictures, layers, explained pixels, packed to fit.
//!
//! In: the ladder and its further views. Out: [`Live`], an index (JSON) and packed planes. The page shall stay below
//! 15 MB, so there is a budget. What does not fit is left out in a stated order, and `Live::left_out` says it: lights
//! share sliders (the first three alone, then all in one group), then no mixer, no further shade models, no inner rungs, and
//! at last no moving part at all.
//!
//! Measured (2026-11, whole page): `lights` (four lights) at 1024 x 768 2.8 MB; `whitted` with four lights, so with mirrors and
//! glass, 5.6 MB, of which 2.2 MB are pictures, 2.1 MB layers, 0.4 MB explained pixels; at 320 x 240 with 4 samples 2.2 MB;
//! `12-eight-lights` at 320 x 240 1.3 MB. Bound of the mixer's error at strength 2: 6e-4 to 1.5e-3 of the larger of 1 and the
//! largest layer (2^-9 is 2.0e-3).

use rayon::prelude::*;
use serde_json::{Value, json};

use super::codec::{Blob, Codes, bytes, mask, raw, rgb};
use super::mix::{Mix, Source};
use crate::decompose::{CAUSES, Ladder, RUNGS, Views};
use crate::error::Error;
use crate::frame::Plane;
use crate::gl::ShadeModel;
use crate::report::files::View;

/// Bytes that packed planes may take in the page, in base 64. Type, script, words and small pictures take the rest.
const BUDGET: usize = 12_500_000;
/// Lights that have sliders of their own where there are more than fit.
const ALONE: usize = 3;

/// A pixel with its explanation.
#[derive(Clone, Debug)]
pub struct Explained {
    /// Column and row from the top-left.
    pub pixel: [usize; 2],
    /// Why this one: "largest shadow", or nothing on the grid.
    pub why: String,
    /// `explain --json` of it.
    pub explanation: Value,
}

/// What a page can be made live with.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The ten pictures and the layers.
    pub ladder: &'a Ladder,
    /// Shade models, and light without shadows.
    pub views: &'a Views,
    /// Which shade model the ladder begins with.
    pub shading: ShadeModel,
    /// Names of the enabled lights, in order.
    pub lights: &'a [String],
    /// How values are shown.
    pub view: View,
    /// Pixels explained beforehand.
    pub explained: &'a [Explained],
    /// The command that explains a pixel, before and after X Y.
    pub explain: &'a [String; 2],
}

/// The packed parts of a page.
#[derive(Clone, Debug, Default)]
pub struct Live {
    /// What is there, for the script; null where nothing is.
    pub(super) index: Value,
    /// Packed planes by name.
    pub(super) blobs: Vec<(String, Vec<u8>)>,
    /// The lights as the mixer has them: names of each group.
    pub(super) groups: Vec<Vec<String>>,
    /// What was left out for size, in sentences.
    pub(super) left_out: Vec<String>,
    /// Bound of the mixer's error at strengths up to 2; none without a mixer.
    pub(super) mix_error: Option<f32>,
}

impl Live {
    /// Packs as much as fits.
    ///
    /// # Errors
    /// Pictures that cannot be packed.
    pub fn new(input: &Input<'_>) -> Result<Self, Error> {
        Self::within(input, BUDGET)
    }

    fn within(input: &Input<'_>, budget: usize) -> Result<Self, Error> {
        let mut live = Self::default();
        let pictures = Pictures::pack(input)?;
        let mut room = budget;
        let Some(kept) = pictures.fitting(&mut room, &mut live.left_out) else {
            return Ok(live);
        };
        let explained = explained(input.explained)?;
        let explains = take(&mut room, &[&explained]);
        if !explains {
            live.left_out.push(
                "No ray trees are explained beforehand, so that this page stays below 15 MB."
                    .to_owned(),
            );
        }
        let mix = live.mix(input, room)?;
        live.index = json!({
            "size": [pictures.size[0], pictures.size[1]],
            "srgb": input.view == View::Srgb,
            "pictures": pictures.index(&kept),
            "causes": CAUSES,
            "groups": live.groups,
            "layers": mix.as_ref().map(|mix| &mix.index),
            "explain": input.explain,
            "explained": explains.then_some("explained"),
            "how": {},
        });
        let blobs = pictures
            .blobs
            .into_iter()
            .filter(|b| kept.contains(&b.name));
        let blobs = blobs
            .chain(explains.then_some(explained))
            .chain(mix.into_iter().flat_map(|mix| mix.blobs));
        for blob in blobs {
            live.index["how"][&blob.name] = blob.how;
            live.blobs.push((blob.name, blob.bytes));
        }
        Ok(live)
    }

    /// The mixer with as many lights apart as fit.
    fn mix(&mut self, input: &Input<'_>, room: usize) -> Result<Option<Mix>, Error> {
        let ladder = input.ladder;
        let lights = input.lights.len();
        let source = Source {
            traced: &ladder.trace_layers,
            local: &ladder.local_layers,
            unshadowed: input.views.unshadowed.as_ref(),
            lights,
        };
        let apart = |alone: usize| -> Vec<Vec<usize>> {
            let single = (0..alone.min(lights)).map(|light| vec![light]);
            let rest: Vec<usize> = (alone.min(lights)..lights).collect();
            single.chain((!rest.is_empty()).then_some(rest)).collect()
        };
        // A group of one is no group.
        let tries = [lights, ALONE, 0].into_iter();
        for alone in tries.filter(|alone| *alone == lights || alone + 1 < lights) {
            let groups = apart(alone);
            let mix = source.pack(&groups)?;
            let mut left = room;
            if take(&mut left, &mix.blobs.iter().collect::<Vec<_>>()) {
                let name = |light: &usize| input.lights[*light].clone();
                self.groups = groups
                    .iter()
                    .map(|group| group.iter().map(name).collect())
                    .collect();
                self.mix_error = Some(2.0 * mix.error);
                if alone < lights {
                    self.left_out.push(format!(
                        "The mixer has {} of the {lights} lights on one slider, so that this page stays below 15 MB.",
                        lights - alone
                    ));
                }
                return Ok(Some(mix));
            }
        }
        self.left_out.push(
            "There is no term mixer: its layers would make this page larger than 15 MB. They are in layers.exr."
                .to_owned(),
        );
        Ok(None)
    }
}

/// Whether blobs fit; the room shrinks if they do.
fn take(room: &mut usize, blobs: &[&Blob]) -> bool {
    let size: usize = blobs
        .iter()
        .map(|blob| blob.bytes.len().div_ceil(3) * 4)
        .sum();
    let fits = size <= *room;
    if fits {
        *room -= size;
    }
    fits
}

/// All pictures to choose from.
struct Pictures {
    size: [usize; 2],
    blobs: Vec<Blob>,
    /// Name of the float picture of the ladder's own shade model, and the shade models.
    shadings: Vec<(&'static str, String)>,
}

const SHADED: [(ShadeModel, &str, &str); 3] = [
    (ShadeModel::Flat, "flat", "raster, flat"),
    (ShadeModel::Gouraud, "gouraud", "raster, Gouraud"),
    (ShadeModel::Phong, "phong", "raster, Phong"),
];

impl Pictures {
    fn pack(input: &Input<'_>) -> Result<Self, Error> {
        let rungs = &input.ladder.rungs;
        let float = |plane: &Plane<[f64; 3]>| plane.map(|c| c.map(|x| x as f32));
        // Rungs 1 to 8 in turn: what the stored precision cannot tell apart stays equal.
        let mut codes: Vec<Codes> = Vec::new();
        for rung in &rungs[1..9] {
            let plane = float(rung);
            codes.push(match codes.last() {
                Some(before) => Codes::near(&plane, before),
                None => Codes::of(&plane),
            });
        }
        let names: Vec<String> = (0..10).map(|k| format!("rung{k}")).collect();
        // Each is packed beside a neighbour, so that rungs 1 and 8 need no other and the inner ones may be left out.
        let beside = |rung: usize| match rung {
            1 => None,
            2 | 8 => Some(1),
            k => Some(k + 1),
        };
        let mut blobs = codes
            .par_iter()
            .enumerate()
            .map(|(i, own)| {
                let base = beside(i + 1).map(|k| (names[k].as_str(), &codes[k - 1]));
                rgb(&names[i + 1], own, base)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let (first, last) = (float(&rungs[0]), float(&rungs[9]));
        blobs.push(bytes(&names[0], &first, (&names[1], &codes[0]))?);
        blobs.push(bytes(&names[9], &last, (&names[8], &codes[7]))?);
        let shadings = shade_models(input, (&names[1], &codes[0]), &mut blobs)?;
        Ok(Self {
            size: [first.width, first.height],
            blobs,
            shadings,
        })
    }

    /// Names of the blobs that fit; none where not even the two pictures do.
    fn fitting(&self, room: &mut usize, left_out: &mut Vec<String>) -> Option<Vec<String>> {
        let inner =
            |name: &str| matches!(name.strip_prefix("rung"), Some(k) if ("2".."8").contains(&k));
        let ends = |name: &str| name.starts_with("rung") && !inner(name);
        let own = |name: &str| {
            let own = self.shadings.iter().find(|(_, blob)| blob == "rung1");
            own.is_some_and(|(model, _)| name == format!("{model}-clamped"))
        };
        type Test<'a> = &'a dyn Fn(&str) -> bool;
        let sets: [(Test<'_>, &str); 3] = [
            (
                &|n| ends(n) || own(n),
                "The pictures of this page do not move: at this size they would make it larger than 15 MB. \
              The files beside it are complete.",
            ),
            (
                &|n| inner(n),
                "Rungs 2 to 7 are left out, so that this page stays below 15 MB.",
            ),
            (
                &|n| !n.starts_with("rung") && !own(n),
                "The other shade models are left out, so that this page stays below 15 MB.",
            ),
        ];
        let mut kept = Vec::new();
        for (number, (test, sentence)) in sets.into_iter().enumerate() {
            let set: Vec<&Blob> = self.blobs.iter().filter(|b| test(&b.name)).collect();
            if take(room, &set) {
                kept.extend(set.iter().map(|b| b.name.clone()));
            } else {
                left_out.push(sentence.to_owned());
                if number == 0 {
                    return None;
                }
            }
        }
        Some(kept)
    }

    /// What the script may show: id, name, blob, and where its clamped pixels are.
    fn index(&self, kept: &[String]) -> Vec<Value> {
        let has = |name: &str| kept.iter().any(|k| k == name);
        let shaded = SHADED.iter().filter_map(|(_, id, name)| {
            let blob = &self.shadings.iter().find(|(own, _)| own == id)?.1;
            let clamped = format!("{id}-clamped");
            (has(blob) && has(&clamped)).then(|| {
                json!({"id": id, "name": name, "blob": blob, "clamped": clamped, "terms": "EADS"})
            })
        });
        let own = self.shadings.iter().find(|(_, blob)| blob == "rung1");
        let rung = |k: usize| {
            let blob = format!("rung{k}");
            let clamped = match (k, own) {
                (0 | 1, Some((model, _))) => json!(format!("{model}-clamped")),
                (9, _) => json!("rung8"),
                _ => Value::Null,
            };
            let terms = match k {
                0..=5 => "EADS",
                6 => "EADSs",
                7 => "EADSsR",
                _ => "EADSsRT",
            };
            has(&blob).then(|| {
                json!({"id": format!("r{k}"), "rung": k, "name": RUNGS[k], "blob": blob, "clamped": clamped, "terms": terms})
            })
        };
        shaded.chain((0..10).filter_map(rung)).collect()
    }
}

/// Packs the shade models; the ladder's own is `base`, rung 1. Returns each one's id and picture.
fn shade_models(
    input: &Input<'_>,
    base: (&str, &Codes),
    blobs: &mut Vec<Blob>,
) -> Result<Vec<(&'static str, String)>, Error> {
    let mut shadings = Vec::new();
    for (model, name, _) in SHADED {
        let mut shaded = input.views.shadings.iter();
        let Some(shaded) = shaded.find(|s| s.shading == model) else {
            continue;
        };
        blobs.push(mask(&format!("{name}-clamped"), &shaded.clamped.data)?);
        if model == input.shading {
            shadings.push((name, base.0.to_owned()));
            continue;
        }
        let own = Codes::near(&shaded.color, base.1);
        blobs.push(rgb(name, &own, Some(base))?);
        shadings.push((name, name.to_owned()));
    }
    Ok(shadings)
}

/// The explained pixels as one blob.
fn explained(pixels: &[Explained]) -> Result<Blob, Error> {
    let list: Vec<Value> = pixels
        .iter()
        .map(|e| json!({"pixel": e.pixel, "why": e.why, "explanation": e.explanation}))
        .collect();
    raw("explained", Value::from(list).to_string().as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decompose::{decompose, views};
    use crate::import::{LoadOptions, load};
    use crate::render::Options;

    /// Packs a shipped scene with four lights within a budget.
    fn pack(budgets: &[usize]) -> Vec<Live> {
        let mut scene = load("lights", &LoadOptions::default()).unwrap().scene;
        (scene.image.width, scene.image.height) = (40, 30);
        let options = Options {
            level: Some(8),
            ..Options::default()
        };
        let quiet = |_: &str| {};
        let ladder = decompose(&scene, &options, &quiet).unwrap();
        let views = views(&scene, &options, &ladder, &quiet).unwrap();
        let input = Input {
            ladder: &ladder,
            views: &views,
            shading: scene.raster.shading,
            lights: &scene.light_names(),
            view: View::Linear,
            explained: &[],
            explain: &["rastray explain lights ".to_owned(), String::new()],
        };
        let within = |budget: &usize| Live::within(&input, *budget).unwrap();
        budgets.iter().map(within).collect()
    }

    fn size(live: &Live) -> usize {
        live.blobs
            .iter()
            .map(|(_, b)| b.len().div_ceil(3) * 4)
            .sum()
    }

    #[test]
    fn all_of_a_small_picture_fits() {
        let live = &pack(&[BUDGET])[0];
        assert_eq!(live.index["pictures"].as_array().unwrap().len(), 13);
        assert_eq!(live.groups.len(), 4);
        assert!(live.left_out.is_empty());
        assert!(live.mix_error.unwrap() < 1.0 / 512.0);
        for (name, _) in &live.blobs {
            assert!(live.index["how"][name]["kind"].is_string(), "{name}");
        }
    }

    #[test]
    fn what_does_not_fit_is_left_out_in_order_and_said() {
        let full = size(&pack(&[BUDGET])[0]);
        let budgets: Vec<usize> = (0..40).map(|k| full * (40 - k) / 40).chain([0]).collect();
        let lives = pack(&budgets);
        for (live, budget) in lives.iter().zip(&budgets) {
            assert!(size(live) <= *budget);
            assert_eq!(live.left_out.is_empty(), *budget == full, "{budget}");
            let said = |words: &str| live.left_out.iter().any(|s| s.contains(words));
            let shown = !live.index.is_null();
            assert_eq!(shown, !said("do not move"), "{budget}");
            assert_eq!(shown && live.groups.is_empty(), said("no term mixer"));
            assert_eq!(
                live.groups.iter().any(|g| g.len() > 1),
                said("on one slider")
            );
            assert!(!shown || live.index["pictures"].as_array().unwrap().len() >= 5);
        }
        assert!(
            lives
                .iter()
                .any(|live| !live.index.is_null() && live.groups.is_empty())
        );
        let last = lives.last().unwrap();
        assert!(last.index.is_null() && last.left_out[0].contains("do not move"));
    }
}
