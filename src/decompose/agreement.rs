//! How well the two renderers agree where they must: rung 3 (rasterized, lit per fragment) against rung 4 (primary
//! rays on the same triangles).
//!
//! Judged at pixel centres that are *interior*: farther than 1/256 px (without a snap grid 1/4096 px) from an edge of either
//! visible triangle, and
//! farther than 2^-18 (of a cosine) from a discontinuity of the model, which are the specular gate n.l = 0 and the edge
//! of a spot cone. Two surfaces whose depths differ by less than 2^-22 relative are an edge, too. There the colours must
//! agree to 1e-5 x max(1, magnitude), and coverage without exception.

use super::Options;
use crate::error::Error;
use crate::frame::{Frame, NONE, Plane};
use crate::gl::{LightSource, ShadeModel};
use crate::lanes::Real;
use crate::math::DVec2;
use crate::math::float::{dot, normalize};
use crate::scene::assembly::Assembly;
use crate::scene::requirements::Model;
use crate::scene::{Scene, Snap};
use crate::{raster, trace};

/// Distance from an edge, in pixels, within which vertices snapped to a grid may decide otherwise.
const EDGE_PX: f64 = 1.0 / 256.0;
/// The same without a grid: the projection's own rounding in f32.
const EXACT_EDGE_PX: f64 = 1.0 / 4096.0;
/// Relative distance of two depths below which they are a tie (2^-22).
const TIE: f64 = 1.0 / 4_194_304.0;
/// Distance of a cosine from its boundary below which the two sides are both right (2^-18).
const GATE: f64 = 1.0 / 262_144.0;

/// Who covers the interior pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// Both renderers see something.
    pub both: u64,
    /// Only the rasterizer does.
    pub raster_only: u64,
    /// Only the tracer does.
    pub trace_only: u64,
}

/// Rungs 3 and 4 compared at the interior pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

/// Measures the agreement; frames with several samples are drawn again with one, since it is judged at centres.
pub(super) fn measure<R: Real>(
    scene: &Scene,
    assembly: &Assembly<R>,
    options: &Options,
    per_fragment: Frame<R>,
    cast: Frame<R>,
) -> Result<Agreement, Error> {
    if scene.image.samples == 1 && scene.image.pattern == crate::sampling::Pattern::Grid {
        return Ok(compare(scene, assembly, &per_fragment, &cast));
    }
    let mut single = scene.clone();
    single.image.samples = 1;
    single.image.pattern = crate::sampling::Pattern::Grid;
    let isa = options.isa;
    let raster_options = raster::Options {
        shading: ShadeModel::Phong,
        clamp: false,
        layers: true,
        isa,
    };
    let (per_fragment, _) =
        raster::Plan::new(&single, assembly, options.model).draw(&raster_options)?;
    let plan = trace::Plan::new(&single, assembly, trace::Geometry::Mesh, options.model)?;
    let (cast, _) = plan.draw(&trace::Options::cast(isa))?;
    Ok(compare(&single, assembly, &per_fragment, &cast))
}

fn compare<R: Real>(
    scene: &Scene,
    assembly: &Assembly<R>,
    per_fragment: &Frame<R>,
    cast: &Frame<R>,
) -> Agreement {
    let plan = raster::Plan::new(scene, assembly, Model::Required);
    let width = match scene.raster.snap {
        Snap::Exact => EXACT_EDGE_PX,
        Snap::Bits8 | Snap::Bits12 => EDGE_PX,
    };
    let raster_edge = plan.near_edge(&per_fragment.primitive, width);
    let cast_edge = plan.near_edge(&cast.primitive, width);
    let probe = Discontinuities {
        scene,
        assembly,
        lights: scene.lights_eye(),
    };
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
            || probe.near(pixel, &per_fragment.primitive);
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

fn tie<R: Real>(a: R, b: R) -> bool {
    let (a, b) = (a.to_f64(), b.to_f64());
    (a - b).abs() <= TIE * a.abs().max(b.abs())
}

/// Largest difference over channels, relative to max(1, sum of the magnitudes of the terms).
fn relative_error<R: Real>(a: &Frame<R>, b: &Frame<R>, pixel: usize) -> f64 {
    let magnitude = a.layers.as_ref().map_or(0.0, |layers| {
        let channel = |c: usize| -> f64 {
            layers
                .planes
                .iter()
                .map(|plane| plane.data[pixel][c].to_f64().abs())
                .sum()
        };
        channel(0).max(channel(1)).max(channel(2))
    });
    let (a, b) = (a.color.data[pixel], b.color.data[pixel]);
    // Equal infinities agree; an infinite term allows every finite difference, and no infinite one.
    let error = [0, 1, 2].map(|c| match (a[c].to_f64(), b[c].to_f64()) {
        (a, b) if a == b => 0.0,
        (a, b) if (a - b).is_finite() => (a - b).abs() / magnitude.max(1.0),
        _ => f64::INFINITY,
    });
    error[0].max(error[1]).max(error[2])
}

/// Finds pixels whose visible point lies at a jump of the lighting equation.
struct Discontinuities<'a, R> {
    scene: &'a Scene,
    assembly: &'a Assembly<R>,
    lights: Vec<LightSource>,
}

impl<R: Real> Discontinuities<'_, R> {
    fn near(&self, pixel: usize, primitives: &Plane<u32>) -> bool {
        let primitive = primitives.data[pixel];
        if primitive == NONE {
            return false;
        }
        let place = [pixel % primitives.width, pixel / primitives.width].map(|x| x as f64 + 0.5);
        let (position, normal) = self.surface(primitive, DVec2::from_array(place));
        self.lights
            .iter()
            .any(|light| at_jump(light, position, normal))
    }

    /// Eye-space point and unit normal of a triangle under a place of the picture, in f64.
    fn surface(&self, primitive: u32, place: DVec2) -> ([f64; 3], [f64; 3]) {
        let image = &self.scene.image;
        let (origin, direction) = self
            .scene
            .camera
            .primary_ray(place, image.width, image.height);
        let corners = self.assembly.triangles[primitive as usize];
        let [a, b, c] = corners.map(|v| {
            glam::DVec3::from_array(self.assembly.vertex_eye(v).map(Real::to_f64)) - origin
        });
        // Cross the ray first: weights relative to a vertex, accurate from afar.
        let weights = [(b, c), (c, a), (a, b)].map(|(p, q)| direction.cross(p).dot(q - p));
        let sum = weights[0] + weights[1] + weights[2];
        let weights = if sum == 0.0 {
            [1.0, 0.0, 0.0]
        } else {
            weights.map(|w| w / sum)
        };
        let position = origin + weights[0] * a + weights[1] * b + weights[2] * c;
        let mut normal = [0.0; 3];
        for (v, w) in corners.into_iter().zip(weights) {
            for (n, x) in normal
                .iter_mut()
                .zip(self.assembly.vertex_normal_weighted(v))
            {
                *n += w * x;
            }
        }
        (position.to_array(), normalize(normal).0)
    }
}

fn at_jump(light: &LightSource, position: [f64; 3], normal: [f64; 3]) -> bool {
    let [x, y, z, w] = light.position;
    let raw = if w == 0.0 {
        [x, y, z]
    } else {
        [
            x / w - position[0],
            y / w - position[1],
            z / w - position[2],
        ]
    };
    let to_light = normalize(raw).0;
    if dot(normal, to_light).abs() < GATE {
        return true;
    }
    if light.spot_cutoff_deg == 180.0 {
        return false;
    }
    let axis = normalize(light.spot_direction).0;
    (-dot(to_light, axis) - libm::cos(light.spot_cutoff_deg.to_radians())).abs() < GATE
}
