//! Further looks at a scene beside the ladder's: every shade model of the rasterizer, and the traced picture without S_L.
//!
//! They change nothing about the causes. They are what a reader who switches terms on and off needs: the ladder's layers
//! hold reflection and refraction with shadows in what they show, and these hold the same light unblocked.

use super::{Ladder, Options};
use crate::error::Error;
use crate::frame::{Frame, LayerIndex, Layers, Plane};
use crate::gl::ShadeModel;
use crate::lanes::Real;
use crate::scene::Scene;
use crate::scene::assembly::Assembly;
use crate::{raster, trace};

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

/// Draws them in the precision `R`.
///
/// # Errors
/// What the renderers refuse, as for [`super::decompose`].
pub fn views<R: Real>(
    scene: &Scene,
    options: &Options,
    ladder: &Ladder,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Views, Error> {
    progress("shade models, and light without shadows");
    let assembly = Assembly::<R>::new(scene, options.level)?;
    let plan = raster::Plan::new(scene, &assembly, options.model);
    let models = [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong];
    let shadings = models.map(|shading| shaded(&plan, shading, options));
    let bounced = LayerIndex {
        lights: scene.enabled_lights().count(),
    };
    let bounces = [bounced.reflection(), bounced.refraction()]
        .into_iter()
        .any(|layer| !is_zero(&ladder.trace_layers.planes[layer]));
    let unshadowed = (options.shadows && bounces).then(|| unblocked(scene, &assembly, options));
    Ok(Views {
        shadings: shadings.into_iter().collect::<Result<_, _>>()?,
        unshadowed: unshadowed.transpose()?,
    })
}

fn is_zero(plane: &Plane<[f32; 3]>) -> bool {
    plane.data.as_flattened().iter().all(|x| *x == 0.0)
}

/// One shade model with GL's clamps, and where they mattered.
fn shaded<R: Real>(
    plan: &raster::Plan<'_, R>,
    shading: ShadeModel,
    options: &Options,
) -> Result<Shaded, Error> {
    let draw = |clamp| {
        let options = raster::Options {
            shading,
            clamp,
            layers: false,
            isa: options.isa,
        };
        plan.draw(&options).map(|(frame, _)| frame)
    };
    let (clamped, free): (Frame<R>, Frame<R>) = (draw(true)?, draw(false)?);
    let pairs = clamped.color.data.iter().zip(&free.color.data);
    let lost = Plane {
        width: clamped.color.width,
        height: clamped.color.height,
        data: pairs.map(|(a, b)| a != b).collect(),
    };
    Ok(Shaded {
        shading,
        color: clamped.color_f32(),
        clamped: lost,
    })
}

/// The layers of rung 8 without S_L.
fn unblocked<R: Real>(
    scene: &Scene,
    assembly: &Assembly<R>,
    options: &Options,
) -> Result<Layers<f32>, Error> {
    let plan = trace::Plan::new(scene, assembly, trace::Geometry::Exact, options.model)?;
    let asked = trace::Options {
        shadows: false,
        reflection: options.reflection,
        refraction: options.refraction,
        layers: true,
        ..trace::Options::of(scene, options.isa)
    };
    let frame = super::draw_layers(&plan, scene, &asked)?.0;
    Ok(frame
        .layers
        .as_ref()
        .map(Layers::to_f32)
        .unwrap_or_default())
}
