//! How well the two renderers agree where they must: rung 3 (rasterized, lit per fragment) against rung 4 (primary
//! rays on the same triangles).
//!
//! Judged at pixel centres that are *interior*: farther than 1/256 px (without a snap grid 1/4096 px) from an edge of either
//! visible triangle, and
//! farther than 2^-18 (of a cosine) from a discontinuity of the model, which are the specular gate n.l = 0 and the edge
//! of a spot cone. Two surfaces whose depths differ by less than 2^-22 relative are an edge, too. There the colours must
//! agree to 1e-5 x max(1, magnitude), and coverage without exception.
//!
//! Where the scene blends transmissive surfaces (`raster.transparency = "blend"`), rung 3 is drawn again with them opaque:
//! rays blend nothing, and what is judged here is where the two renderers must agree.

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::frame::{Frame, NONE};
use crate::gl::ShadeModel;
use crate::render::{Assembled, Options, Picture, Rasterizer, Tracer};
use crate::scene::requirements::Model;
use crate::scene::{Scene, Snap, Transparency};
use crate::trace::Geometry;

/// Distance from an edge, in pixels, within which vertices snapped to a grid may decide otherwise.
const EDGE_PX: f64 = 1.0 / 256.0;
/// The same without a grid: the projection's own rounding in f32.
const EXACT_EDGE_PX: f64 = 1.0 / 4096.0;
/// Relative distance of two depths below which they are a tie (2^-22).
const TIE: f64 = 1.0 / 4_194_304.0;

/// Who covers the interior pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Coverage {
    /// Both renderers see something.
    pub both: u64,
    /// Only the rasterizer does.
    pub raster_only: u64,
    /// Only the tracer does.
    pub trace_only: u64,
}

/// Rungs 3 and 4 compared at the interior pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// Largest error relative to max(1, magnitude), over channels.
    pub interior_max: f64,
    /// Mean over pixels of that error (largest channel).
    pub interior_mean: f64,
    /// Pixels set apart: at an edge or a discontinuity.
    pub edge_pixels: u64,
    /// Coverage of the interior pixels.
    pub coverage: Coverage,
}

/// Measures the agreement of the pictures of rungs 3 and 4; those with several samples are drawn again with one, since it is
/// judged at centres, and blended ones without blending.
pub(super) fn measure(
    scene: &Scene,
    assembled: &Assembled,
    options: &Options,
    [per_fragment, cast]: [&Picture; 2],
) -> Result<Agreement, Error> {
    let centers = scene.image.samples == 1 && scene.image.pattern == crate::sampling::Pattern::Grid;
    if centers && !scene.blends() {
        return Ok(compare(
            scene,
            assembled,
            &per_fragment.to_f64(),
            &cast.to_f64(),
        ));
    }
    drawn(scene, assembled, options)
}

/// The agreement of a scene alone, without its ladder: draws rungs 3 and 4 with one sample, without blending.
///
/// # Errors
/// What the renderers refuse.
pub fn agreement(scene: &Scene, options: &Options) -> Result<Agreement, Error> {
    let assembled = Assembled::new(scene, options.level, options.precision)?;
    drawn(scene, &assembled, options)
}

fn drawn(scene: &Scene, assembled: &Assembled, options: &Options) -> Result<Agreement, Error> {
    let mut single = scene.clone();
    single.image.samples = 1;
    single.image.pattern = crate::sampling::Pattern::Grid;
    single.raster.transparency = Transparency::Opaque;
    let plan = Rasterizer::new(&single, assembled, options.model);
    let per_fragment = plan.draw(&options.raster(ShadeModel::Phong, false, true))?;
    let plan = Tracer::new(&single, assembled, Geometry::Mesh, options.model)?;
    let cast = plan.draw(&options.cast())?;
    let pair = [per_fragment, cast].map(|drawn| drawn.picture.to_f64());
    Ok(compare(&single, assembled, &pair[0], &pair[1]))
}

fn compare(
    scene: &Scene,
    assembled: &Assembled,
    per_fragment: &Frame<f64>,
    cast: &Frame<f64>,
) -> Agreement {
    let plan = Rasterizer::new(scene, assembled, Model::Required);
    let width = match scene.raster.snap {
        Snap::Exact => EXACT_EDGE_PX,
        Snap::Bits8 | Snap::Bits12 => EDGE_PX,
    };
    let raster_edge = plan.near_edge(&per_fragment.primitive, width);
    let cast_edge = plan.near_edge(&cast.primitive, width);
    let jump = plan.near_jump(&per_fragment.primitive, ShadeModel::Phong);
    let mut agreement = Agreement::default();
    let mut sum = 0.0;
    let mut judged = 0u64;
    for pixel in 0..per_fragment.color.data.len() {
        let seen = [per_fragment, cast].map(|f| f.primitive.data[pixel]);
        if seen == [NONE; 2] {
            continue;
        }
        let edge = raster_edge.data[pixel]
            || cast_edge.data[pixel]
            || (seen[0] != seen[1] && tie(per_fragment.depth.data[pixel], cast.depth.data[pixel]))
            || jump.data[pixel];
        if edge {
            agreement.edge_pixels += 1;
            continue;
        }
        match seen.map(|s| s != NONE) {
            [true, false] => agreement.coverage.raster_only += 1,
            [false, true] => agreement.coverage.trace_only += 1,
            _ => {
                agreement.coverage.both += 1;
                let error = relative_error(per_fragment, cast, pixel);
                agreement.interior_max = agreement.interior_max.max(error);
                sum += error;
                judged += 1;
            }
        }
    }
    agreement.interior_mean = if judged > 0 { sum / judged as f64 } else { 0.0 };
    agreement
}

fn tie(a: f64, b: f64) -> bool {
    (a - b).abs() <= TIE * a.abs().max(b.abs())
}

/// Largest difference over channels, relative to max(1, sum of the magnitudes of the terms).
fn relative_error(a: &Frame<f64>, b: &Frame<f64>, pixel: usize) -> f64 {
    let magnitude = a.layers.as_ref().map_or(0.0, |layers| {
        let channel = |c: usize| -> f64 {
            layers
                .planes
                .iter()
                .map(|plane| plane.data[pixel][c].abs())
                .sum()
        };
        channel(0).max(channel(1)).max(channel(2))
    });
    let (a, b) = (a.color.data[pixel], b.color.data[pixel]);
    // Equal infinities agree; an infinite term allows every finite difference, and no infinite one.
    let error = [0, 1, 2].map(|c| match (a[c], b[c]) {
        (a, b) if a == b => 0.0,
        (a, b) if (a - b).is_finite() => (a - b).abs() / magnitude.max(1.0),
        _ => f64::INFINITY,
    });
    error[0].max(error[1]).max(error[2])
}
