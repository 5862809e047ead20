//! Further looks at a scene beside the ladder's: every shade model of the rasterizer, and the traced picture without S_L.
//!
//! They change nothing about the causes. They are what a reader who switches terms on and off needs: the ladder's layers
//! hold reflection and refraction with shadows in what they show, and these hold the same light unblocked.

use super::Ladder;
use crate::error::Error;
use crate::frame::{LayerIndex, Layers, Plane};
use crate::gl::ShadeModel;
use crate::render::{Assembled, Options, Rasterizer, Tracer};
use crate::scene::Scene;
use crate::trace;

/// The rasterizer's picture in one shade model.
#[derive(Clone, Debug)]
pub struct Shaded {
    /// Flat, Gouraud, or per fragment.
    pub shading: ShadeModel,
    /// GL's picture: clamped, float.
    pub color: Plane<[f32; 3]>,
    /// Where GL's clamps took something away.
    pub clamped: Plane<bool>,
}

/// What the ladder leaves out.
#[derive(Clone, Debug)]
pub struct Views {
    /// Flat, Gouraud, per fragment.
    pub shadings: Vec<Shaded>,
    /// The layers of rung 8 with every light unblocked, wherever a ray lands, split by light as the ladder's are. None
    /// where nothing bounces or no shadow ray is cast: then the layers of rung 5 say the same.
    pub unshadowed: Option<Layers<f32>>,
}

/// Draws them.
///
/// # Errors
/// What the renderers refuse, as for [`super::decompose`].
pub fn views(
    scene: &Scene,
    options: &Options,
    ladder: &Ladder,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Views, Error> {
    progress("shade models, and light without shadows");
    let assembled = Assembled::new(scene, options.level, options.precision)?;
    let plan = Rasterizer::new(scene, &assembled, options.model);
    let models = [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong];
    let shadings = models.map(|shading| shaded(&plan, shading, options));
    let bounced = LayerIndex {
        lights: scene.enabled_lights().count(),
    };
    let bounces = [bounced.reflection(), bounced.refraction()]
        .into_iter()
        .any(|layer| !is_zero(&ladder.trace_layers.planes[layer]));
    let unshadowed = (options.shadows && bounces).then(|| unblocked(scene, &assembled, options));
    Ok(Views {
        shadings: shadings.into_iter().collect::<Result<_, _>>()?,
        unshadowed: unshadowed.transpose()?,
    })
}

fn is_zero(plane: &Plane<[f32; 3]>) -> bool {
    plane.data.as_flattened().iter().all(|x| *x == 0.0)
}

/// One shade model with GL's clamps, and where they mattered.
fn shaded(plan: &Rasterizer<'_>, shading: ShadeModel, options: &Options) -> Result<Shaded, Error> {
    let draw = |clamp| plan.draw(&options.raster(shading, clamp, false));
    let (clamped, free) = (draw(true)?.picture, draw(false)?.picture);
    let (a, b) = (clamped.color_f64(), free.color_f64());
    let pairs = a.data.iter().zip(&b.data);
    let lost = Plane {
        width: a.width,
        height: a.height,
        data: pairs.map(|(a, b)| a != b).collect(),
    };
    Ok(Shaded {
        shading,
        color: clamped.color_f32(),
        clamped: lost,
    })
}

/// The layers of rung 8 without S_L.
fn unblocked(
    scene: &Scene,
    assembled: &Assembled,
    options: &Options,
) -> Result<Layers<f32>, Error> {
    let plan = Tracer::new(scene, assembled, options.geometry, options.model)?;
    let asked = trace::Options {
        shadows: false,
        layers: true,
        ..options.trace(scene)
    };
    let drawn = super::draw_layers(&plan, scene, &asked)?;
    Ok(drawn.picture.layers_f32().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decompose::decompose;
    use crate::import::{LoadOptions, load};

    fn scene(samples: u32) -> Scene {
        let mut scene = load("whitted", &LoadOptions::default())
            .expect("a shipped scene")
            .scene;
        (scene.image.width, scene.image.height) = (32, 24);
        scene.image.samples = samples;
        scene
    }

    fn draw(scene: &Scene) -> (Ladder, Views) {
        let options = Options {
            level: Some(16),
            ..Options::default()
        };
        let quiet = |_: &str| {};
        let ladder = decompose(scene, &options, &quiet).expect("climbs");
        let views = views(scene, &options, &ladder, &quiet).expect("draws");
        (ladder, views)
    }

    #[test]
    fn parts_by_light_add_up_to_their_layers_within_rounding() {
        for samples in [1, 4] {
            let scene = scene(samples);
            let at = LayerIndex {
                lights: scene.enabled_lights().count(),
            };
            let (ladder, views) = draw(&scene);
            let free = views.unshadowed.expect("whitted has mirrors and shadows");
            for layers in [&ladder.trace_layers, &free] {
                assert_eq!(layers.splits.len(), at.splits());
                let mut lit = 0;
                for (branch, whole) in [at.reflection(), at.refraction()].into_iter().enumerate() {
                    let split = |light| layers.splits[at.split(branch, light)].data.as_flattened();
                    for (i, sum) in layers.planes[whole].data.as_flattened().iter().enumerate() {
                        let parts: f32 = (0..=at.lights).map(|light| split(light)[i]).sum();
                        let error = (parts - sum).abs();
                        assert!(error <= 1e-5 * sum.abs().max(1.0), "{parts} {sum}");
                        lit += usize::from(*sum > 0.0);
                    }
                }
                assert!(lit > 100, "{lit}");
            }
        }
    }

    #[test]
    fn without_shadows_no_light_is_darker() {
        let scene = scene(1);
        let (ladder, views) = draw(&scene);
        let free = views.unshadowed.expect("whitted has mirrors and shadows");
        let mut brighter = 0;
        for (lit, free) in ladder.trace_layers.planes.iter().zip(&free.planes) {
            for (a, b) in lit.data.as_flattened().iter().zip(free.data.as_flattened()) {
                assert!(b >= a, "{b} {a}");
                brighter += usize::from(b > a);
            }
        }
        assert!(brighter > 50, "{brighter}");
        // And the primary hits are those of rung 5.
        let local = 2 + 3 * scene.enabled_lights().count();
        assert_eq!(free.planes[..local], ladder.local_layers.planes[..local]);
    }

    #[test]
    fn the_ladders_shade_model_is_among_them() {
        let scene = scene(1);
        let (ladder, views) = draw(&scene);
        let own = views
            .shadings
            .iter()
            .find(|s| s.shading == scene.raster.shading)
            .expect("all three are drawn");
        assert_eq!(
            own.color.map(|c| c.map(f64::from)).data.len(),
            ladder.rungs[1].data.len()
        );
        for (i, color) in own.color.data.iter().enumerate() {
            for (x, rung) in color.iter().zip(ladder.rungs[1].data[i]) {
                assert!((f64::from(*x) - rung).abs() < 1e-9);
            }
            let changed = ladder.rungs[1].data[i] != ladder.rungs[2].data[i];
            assert!(own.clamped.data[i] || !changed, "pixel {i}");
        }
    }
}
