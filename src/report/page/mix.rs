//! The layers of the mixer: every term of every light, with and without S_L, and what arrives by mirrors and glass.
//!
//! I = E + A + sum over lights of g (a + D + S) + reflection + refraction, where D and S are the shadowed or the
//! unshadowed layer, and g is the light's strength times its colour. Reflection and refraction come split by light, so
//! that g acts inside mirrors and glass, too; what no light made (emission, scene ambient, background) stays.
//! Lights may stand in groups that share one g.
//!
//! A shadowed layer that is the unshadowed one or 0 at every pixel is kept as a mask a light. Layers of zeros are left out.

use std::borrow::Cow;

use rayon::prelude::*;
use serde_json::{Value, json};

use super::codec::{Blob, Codes, Tone, mask, rgb, value};
use crate::error::Error;
use crate::frame::{LayerIndex, Layers, Plane};

type Colors = Plane<[f32; 3]>;

/// Where the layers come from.
pub(super) struct Source<'a> {
    /// Rung 8.
    pub(super) traced: &'a Layers<f32>,
    /// Rung 5: primary hits, unshadowed.
    pub(super) local: &'a Layers<f32>,
    /// Rung 8 without S_L, where it differs beyond the primary hits.
    pub(super) unshadowed: Option<&'a Layers<f32>>,
    /// How many lights there are.
    pub(super) lights: usize,
}

/// One summand of the mix.
struct Layer<'a> {
    term: &'static str,
    /// Number of the group of lights; none for what no light made.
    group: Option<usize>,
    lit: Cow<'a, Colors>,
    /// Without S_L, where that is something else.
    free: Option<Cow<'a, Colors>>,
}

/// The packed layers.
pub(super) struct Mix {
    /// One a layer: term, group, names of blobs.
    pub(super) index: Vec<Value>,
    /// The blobs.
    pub(super) blobs: Vec<Blob>,
    /// No mix of these layers, each at most at its own strength, is off by more than this times max(1, its largest layer).
    pub(super) error: f32,
}

impl Source<'_> {
    /// Packs the layers for groups of lights.
    pub(super) fn pack(&self, groups: &[Vec<usize>]) -> Result<Mix, Error> {
        let layers = self.layers(groups);
        let masks: Vec<Option<Vec<bool>>> = (0..groups.len())
            .into_par_iter()
            .map(|group| shadow_mask(&layers, group))
            .collect();
        let packed = layers
            .par_iter()
            .enumerate()
            .map(|(i, layer)| {
                let masked = layer.group.is_some_and(|g| masks[g].is_some());
                pack_layer(i, layer, masked && is_direct(layer.term))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut mix = Mix {
            index: Vec::new(),
            blobs: Vec::new(),
            error: worst_error(&packed),
        };
        for (group, mask_pixels) in masks.iter().enumerate() {
            if let Some(pixels) = mask_pixels {
                mix.blobs.push(mask(&format!("shadow{group}"), pixels)?);
            }
        }
        for layer in packed.into_iter().flatten() {
            mix.index.push(layer.index);
            mix.blobs.extend(layer.blobs);
        }
        Ok(mix)
    }

    /// The layers in the order of their sum.
    fn layers(&self, groups: &[Vec<usize>]) -> Vec<Layer<'_>> {
        let at = LayerIndex {
            lights: self.lights,
        };
        let traced = &self.traced.planes;
        let own = |term, layer: usize| Layer {
            term,
            group: None,
            lit: Cow::Borrowed(&traced[layer]),
            free: None,
        };
        let mut layers = vec![
            own("emission", LayerIndex::EMISSION),
            own("ambient", LayerIndex::AMBIENT),
        ];
        for (group, lights) in groups.iter().enumerate() {
            for (k, term) in ["ambient", "diffuse", "specular"].into_iter().enumerate() {
                let index = |&light: &usize| at.light(light) + k;
                layers.push(Layer {
                    term,
                    group: Some(group),
                    lit: sum(traced, lights.iter().map(index)),
                    free: (k > 0).then(|| sum(&self.local.planes, lights.iter().map(index))),
                });
            }
        }
        for (branch, term) in ["reflection", "refraction"].into_iter().enumerate() {
            layers.extend(self.bounced(at, branch, term, groups));
        }
        for layer in &mut layers {
            layer.free.take_if(|free| free.data == layer.lit.data);
        }
        layers
    }

    /// Reflection (`branch` 0) or refraction: by group of lights, then what no light made; whole where it was not split.
    fn bounced(
        &self,
        at: LayerIndex,
        branch: usize,
        term: &'static str,
        groups: &[Vec<usize>],
    ) -> Vec<Layer<'_>> {
        let (lit, free) = (&self.traced.splits, self.unshadowed.map(|u| &u.splits));
        if lit.is_empty() {
            let whole = at.reflection() + branch;
            return vec![Layer {
                term,
                group: None,
                lit: Cow::Borrowed(&self.traced.planes[whole]),
                free: self.unshadowed.map(|u| Cow::Borrowed(&u.planes[whole])),
            }];
        }
        let part = |&light: &usize| at.split(branch, light);
        let of = |group: Option<usize>, lights: &[usize]| Layer {
            term,
            group,
            lit: sum(lit, lights.iter().map(part)),
            free: free
                .filter(|free| free.len() == lit.len())
                .map(|free| sum(free, lights.iter().map(part))),
        };
        let grouped = groups.iter().enumerate();
        let mut layers: Vec<_> = grouped.map(|(g, lights)| of(Some(g), lights)).collect();
        layers.push(of(None, &[self.lights]));
        layers
    }
}

/// The sum of some planes; a single one as it is.
fn sum(planes: &[Colors], mut which: impl Iterator<Item = usize>) -> Cow<'_, Colors> {
    let Some(first) = which.next() else {
        return Cow::Owned(planes[0].map(|_| [0.0; 3]));
    };
    let mut total = Cow::Borrowed(&planes[first]);
    for next in which {
        for (t, x) in total.to_mut().data.iter_mut().zip(&planes[next].data) {
            *t = [0, 1, 2].map(|c| t[c] + x[c]);
        }
    }
    total
}

fn is_direct(term: &str) -> bool {
    matches!(term, "diffuse" | "specular")
}

/// Where a group's diffuse and specular light arrives, if that is all that S_L does to them: 0 or 1 at every pixel.
fn shadow_mask(layers: &[Layer<'_>], group: usize) -> Option<Vec<bool>> {
    let mut direct = layers
        .iter()
        .filter(|l| l.group == Some(group) && is_direct(l.term));
    let (diffuse, specular) = (direct.next()?, direct.next()?);
    if diffuse.free.is_none() && specular.free.is_none() {
        return None;
    }
    let values = |layer: &Layer<'_>, i: usize| {
        let lit = layer.lit.data[i];
        (lit, layer.free.as_ref().map_or(lit, |free| free.data[i]))
    };
    let mut before = true;
    (0..diffuse.lit.data.len())
        .map(|i| {
            let pairs = [values(diffuse, i), values(specular, i)];
            let open = pairs.iter().all(|(lit, free)| lit == free);
            let shut = pairs.iter().all(|(lit, _)| *lit == [0.0; 3]);
            before = match (open, shut) {
                (true, true) => before,
                (true, false) => true,
                (false, true) => false,
                (false, false) => return None,
            };
            Some(before)
        })
        .collect()
}

/// A layer's entry, blobs, and how far its values are off.
struct Packed {
    index: Value,
    blobs: Vec<Blob>,
    /// Of each value: signed error / max(1, |value|), of the shadowed and unshadowed layer the larger.
    errors: Vec<f32>,
}

/// None where the layer is zero.
fn pack_layer(number: usize, layer: &Layer<'_>, masked: bool) -> Result<Option<Packed>, Error> {
    let free = layer.free.as_deref().unwrap_or(&layer.lit);
    let zero = |plane: &Colors| plane.data.as_flattened().iter().all(|x| *x == 0.0);
    if zero(free) && zero(&layer.lit) {
        return Ok(None);
    }
    let name = format!("layer{number}");
    let (blob, mut errors) = pack_plane(&name, free, None)?;
    let mut blobs = vec![blob];
    let mut index = json!({"term": layer.term, "group": layer.group, "free": name});
    if layer.free.is_some() && masked {
        index["mask"] = json!(format!("shadow{}", layer.group.unwrap_or(0)));
    } else if layer.free.is_some() {
        let shadowed = format!("{name}s");
        let base = Codes::of(free);
        // A tone cannot be a picture's base: only what is packed as colours can.
        let base = (blobs[0].how["kind"] == "rgb").then_some((name.as_str(), &base));
        let (blob, lit) = pack_plane(&shadowed, &layer.lit, base)?;
        blobs.push(blob);
        index["lit"] = json!(shadowed);
        for (e, l) in errors.iter_mut().zip(lit) {
            *e = if l.abs() > e.abs() { l } else { *e };
        }
    }
    Ok(Some(Packed {
        index,
        blobs,
        errors,
    }))
}

/// A plane packed, and the error of each value.
fn pack_plane(
    name: &str,
    plane: &Colors,
    base: Option<(&str, &Codes)>,
) -> Result<(Blob, Vec<f32>), Error> {
    let error = |seen: f32, x: f32| (seen - x) / x.abs().max(1.0);
    if let Some(tone) = Tone::of(plane) {
        let mut escape = 0;
        let pixel = |(i, x): (usize, &[f32; 3])| {
            let seen = tone.value(i, &mut escape);
            [0, 1, 2].map(|c| error(seen[c], x[c]))
        };
        let errors = plane.data.iter().enumerate().flat_map(pixel).collect();
        return Ok((tone.blob(name)?, errors));
    }
    let codes = Codes::of(plane);
    let pixel =
        |(i, x): (usize, &[f32; 3])| [0, 1, 2].map(|c| error(value(codes.channels[c][i]), x[c]));
    let errors = plane.data.iter().enumerate().flat_map(pixel).collect();
    Ok((rgb(name, &codes, base)?, errors))
}

/// Over all values, the sum of all errors of one sign: no choice of layers is off by more.
fn worst_error(layers: &[Option<Packed>]) -> f32 {
    let layers: Vec<&Packed> = layers.iter().flatten().collect();
    let values = layers.first().map_or(0, |layer| layer.errors.len());
    let at = |i: usize| {
        let errors = layers.iter().map(|layer| layer.errors[i]);
        let (up, down) = errors.fold((0.0f32, 0.0f32), |(up, down), e| {
            (up + e.max(0.0), down - e.min(0.0))
        });
        up.max(down)
    };
    (0..values).into_par_iter().map(at).reduce(|| 0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two lights over four pixels; key is blocked at the last two.
    fn layers(key_last: f32, splits: bool) -> Layers<f32> {
        let names = ["key".to_owned(), "fill".to_owned()];
        let mut layers = Layers::zero(&names, 4, 1, false);
        let at = LayerIndex { lights: 2 };
        let plane = |v: [f32; 4]| Plane {
            width: 4,
            height: 1,
            data: v.map(|x| [x, x / 2.0, 0.0]).into(),
        };
        layers.planes[at.light(0) + 1] = plane([0.5, 0.25, key_last, key_last]);
        layers.planes[at.light(1) + 1] = plane([0.125; 4]);
        layers.planes[at.reflection()] = plane([0.0, 0.0, 0.75, 0.5]);
        if splits {
            layers.splits = vec![plane([0.0; 4]); at.splits()];
            layers.splits[at.split(0, 0)] = plane([0.0, 0.0, 0.5, 0.25]);
            layers.splits[at.split(0, 2)] = plane([0.0, 0.0, 0.25, 0.25]);
        }
        layers
    }

    fn terms(mix: &Mix) -> Vec<String> {
        let entry = |v: &Value| format!("{} {}", v["term"].as_str().unwrap_or("?"), v["group"]);
        mix.index.iter().map(entry).collect()
    }

    #[test]
    fn zero_layers_are_left_out_and_shadows_become_masks() {
        let (traced, local) = (layers(0.0, true), layers(0.75, false));
        let source = Source {
            traced: &traced,
            local: &local,
            unshadowed: None,
            lights: 2,
        };
        let mix = source.pack(&[vec![0], vec![1]]).unwrap();
        let expected = ["diffuse 0", "diffuse 1", "reflection 0", "reflection null"];
        assert_eq!(terms(&mix), expected);
        assert_eq!(mix.index[0]["mask"], "shadow0");
        assert!(mix.index[1].get("mask").is_none());
        assert_eq!(mix.error, 0.0);
    }

    #[test]
    fn grouped_lights_share_layers_that_keep_both_forms() {
        let (traced, local) = (layers(0.0, true), layers(0.75, false));
        let source = Source {
            traced: &traced,
            local: &local,
            unshadowed: None,
            lights: 2,
        };
        let mix = source.pack(&[vec![0, 1]]).unwrap();
        assert_eq!(
            terms(&mix),
            ["diffuse 0", "reflection 0", "reflection null"]
        );
        assert_eq!(mix.index[0]["lit"], "layer3s");
    }

    #[test]
    fn what_was_not_split_keeps_the_scenes_lights() {
        let (traced, local) = (layers(0.0, false), layers(0.75, false));
        let source = Source {
            traced: &traced,
            local: &local,
            unshadowed: None,
            lights: 2,
        };
        let mix = source.pack(&[vec![0], vec![1]]).unwrap();
        assert_eq!(terms(&mix), ["diffuse 0", "diffuse 1", "reflection null"]);
    }
}
