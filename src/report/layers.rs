//! The layers of `layers.exr`: the same light as the page's, named.

use super::layered::{self, NamedLayer};
use crate::decompose::{Ladder, Views};
use crate::frame::{LayerIndex, Layers, Plane};
use crate::scene::Scene;

/// The layers of `layers.exr`: the tracer's, which add up to the picture; then, under prefixes, what adds nothing to it.
///
/// `raster.*`: the rasterizer's. `unshadowed.*`: diffuse and specular of each light without S_L, where S_L changes them, and
/// reflection and refraction likewise. `split.reflection.LIGHT`, `split.refraction.LIGHT`: the part of each light in them,
/// and under `split.reflection` itself what no light made; `unshadowed.split.*` the same without S_L. Parts of zeros are
/// left out.
pub fn of<'a>(ladder: &'a Ladder, views: &'a Views, scene: &Scene) -> Vec<NamedLayer<'a>> {
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
