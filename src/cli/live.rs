//! What `compare` gives its page beside pictures and numbers: packed layers, explained pixels, the line that explains one.
//! And the layers of `layers.exr`, which are the same light.

use rastray::decompose::{Ladder, Views};
use rastray::error::Error;
use rastray::frame::{LayerIndex, Layers, Plane};
use rastray::render::Options;
use rastray::report::files::View;
use rastray::report::layered::{self, NamedLayer};
use rastray::report::page::live::{Input, Live};
use rastray::scene::Scene;

use super::args::CompareArgs;
use super::compare::quoted;
use super::telling::explained;

/// Where the page's moving part comes from.
pub(super) struct Source<'a> {
    pub(super) args: &'a CompareArgs,
    pub(super) scene: &'a Scene,
    pub(super) ladder: &'a Ladder,
    pub(super) views: &'a Views,
    pub(super) options: &'a Options,
}

impl Source<'_> {
    /// Packs it.
    pub(super) fn pack(&self, view: View) -> Result<Live, Error> {
        let explained = explained(self.scene, self.ladder, self.options)?;
        Live::new(&Input {
            ladder: self.ladder,
            views: self.views,
            shading: self.scene.raster.shading,
            lights: &self.scene.light_names(),
            view,
            explained: &explained,
            explain: &explain_line(self.args),
        })
    }
}

/// `rastray explain SCENE`, and the options behind X Y: those of this command that change a pixel.
fn explain_line(args: &CompareArgs) -> [String; 2] {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let scene = words.iter().position(|word| *word == args.scene.scene);
    let mut options = Vec::new();
    let mut skip = false;
    for (i, word) in words.iter().enumerate() {
        if skip {
            skip = false;
        } else if OWN_VALUE.contains(&word.as_str()) {
            skip = true;
        } else if i > 0 && Some(i) != scene && !is_own(word) {
            options.push(quoted(word));
        }
    }
    let before = format!("rastray explain {} ", quoted(&args.scene.scene));
    let mut after = options.join(" ");
    if !after.is_empty() {
        after.insert(0, ' ');
    }
    [before, after]
}

/// Options of `compare` that take a value and do not concern a pixel.
const OWN_VALUE: [&str; 6] = ["-o", "--output", "-j", "--threads", "--color", "--against"];

/// Whether a word concerns files and messages, not the picture.
fn is_own(word: &str) -> bool {
    let flag = matches!(
        word,
        "compare" | "-q" | "--quiet" | "-v" | "--verbose" | "--json" | "--open" | "--watch"
    );
    let joined = OWN_VALUE.iter().any(|own| {
        let rest = word.strip_prefix(own);
        rest.is_some_and(|rest| rest.starts_with('=') || own.len() == 2 && !word.starts_with("--"))
    });
    flag || joined
}

/// The layers of `layers.exr`: the tracer's, which add up to the picture; then, under prefixes, what adds nothing to it.
///
/// `raster.*`: the rasterizer's. `unshadowed.*`: diffuse and specular of each light without S_L, where S_L changes them, and
/// reflection and refraction likewise. `split.reflection.LIGHT`, `split.refraction.LIGHT`: the part of each light in them,
/// and under `split.reflection` itself what no light made; `unshadowed.split.*` the same without S_L. Parts of zeros are
/// left out.
pub(super) fn layers<'a>(
    ladder: &'a Ladder,
    views: &'a Views,
    scene: &Scene,
) -> Vec<NamedLayer<'a>> {
    let at = LayerIndex {
        lights: scene.enabled_lights().count(),
    };
    let traced = &ladder.trace_layers;
    let mut all = named("", traced, |_| true);
    all.extend(named(layered::RASTER, &ladder.raster_layers, |_| true));
    let differs = |local: &Layers<f32>, k: usize| local.planes[k].data != traced.planes[k].data;
    let local = &ladder.local_layers;
    all.extend(named(layered::UNSHADOWED, local, |k| {
        k < at.local() && differs(local, k)
    }));
    all.extend(splits(layered::SPLIT, traced, at, scene));
    if let Some(free) = &views.unshadowed {
        let bounced = at.reflection()..=at.refraction();
        all.extend(named(layered::UNSHADOWED, free, |k| {
            bounced.contains(&k) && differs(free, k)
        }));
        all.extend(splits("unshadowed.split.", free, at, scene));
    }
    all
}

/// Layers with a prefix to their names.
fn named<'a>(
    prefix: &str,
    layers: &'a Layers<f32>,
    wanted: impl Fn(usize) -> bool,
) -> Vec<NamedLayer<'a>> {
    let pairs = layers.names.iter().zip(&layers.planes).enumerate();
    pairs
        .filter(|(k, _)| wanted(*k))
        .map(|(_, (name, plane))| NamedLayer {
            name: format!("{prefix}{name}"),
            plane,
        })
        .collect()
}

/// The parts of reflection and refraction that are not zero.
fn splits<'a>(
    prefix: &str,
    layers: &'a Layers<f32>,
    at: LayerIndex,
    scene: &Scene,
) -> Vec<NamedLayer<'a>> {
    let lights = scene.light_names();
    let mut found = Vec::new();
    for (branch, term) in ["reflection", "refraction"].into_iter().enumerate() {
        for light in 0..=at.lights {
            let name = match lights.get(light) {
                Some(name) => format!("{prefix}{term}.{name}"),
                None => format!("{prefix}{term}"),
            };
            let plane = layers.splits.get(at.split(branch, light));
            found.extend(
                plane
                    .filter(|p| !is_zero(p))
                    .map(|plane| NamedLayer { name, plane }),
            );
        }
    }
    found
}

fn is_zero(plane: &Plane<[f32; 3]>) -> bool {
    plane.data.as_flattened().iter().all(|x| *x == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_options_of_the_picture_reach_the_line() {
        for own in [
            "-o",
            "-j4",
            "--output=x",
            "--threads=2",
            "--json",
            "--watch",
            "compare",
        ] {
            assert!(is_own(own) || OWN_VALUE.contains(&own), "{own}");
        }
        for word in [
            "--set",
            "--samples",
            "16",
            "--no-shadows",
            "light.key.diffuse=0.5",
        ] {
            assert!(!is_own(word) && !OWN_VALUE.contains(&word), "{word}");
        }
        assert_eq!(quoted("it's"), "'it'\\''s'");
    }
}
