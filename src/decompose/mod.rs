//! The ladder: ten pictures from the rasterizer's to the tracer's, each changing one thing, so that the differences
//! between neighbours are the causes of the total difference and sum to it exactly.
//!
//! | rung | picture | cause of the step to it |
//! | - | - | - |
//! | 0 | `raster.png`: GL's picture, clamped, 8 bits | |
//! | 1 | the same in float | quantization |
//! | 2 | vertex colours unclamped | clamping |
//! | 3 | lighting per fragment | interpolation |
//! | 4 | primary rays on the same triangles | coverage |
//! | 5 | the true shapes | tessellation |
//! | 6 | + shadows (the lecture's ray casting) | shadow |
//! | 7 | + reflection | reflection |
//! | 8 | + refraction | refraction |
//! | 9 | `trace.png`: clamped, 8 bits | display |
//!
//! Each rung's values are rounded to a multiple of 2^-32 and limited to |x| <= 2^20 (limited pixels are counted), so
//! that differences and their sums are exact in f64 and the residual is 0. The order is part of the answer: another
//! order would give the causes other shares.
//!
//! `raster.transparency = "blend"`: rungs 0 to 3 are the rasterizer's, so they are blended; from rung 4 on rays see the
//! nearest surface alone. The step to rung 4, coverage, then holds the end of blending beside its own cause, and a note of
//! the ladder says so. The sum stays exact, and the agreement is judged with transmissive surfaces opaque.

mod agreement;
mod masks;
mod views;

pub use agreement::{Agreement, Coverage};
pub use masks::silhouette;
pub use views::{Shaded, Views, views};

use std::time::Instant;

use crate::error::{Error, Note};
use crate::frame::{Frame, LayerIndex, Layers, Plane};
use crate::gl::ShadeModel;
use crate::lanes::{Isa, Real};
use crate::math::color::quantize8;
use crate::scene::Scene;
use crate::scene::assembly::Assembly;
use crate::scene::requirements::Model;
use crate::{raster, trace};

/// Names of the causes in ladder order; cause i is the step from rung i to rung i + 1.
pub const CAUSES: [&str; 9] = [
    "quantization",
    "clamping",
    "interpolation",
    "coverage",
    "tessellation",
    "shadow",
    "reflection",
    "refraction",
    "display",
];

/// Names of the rungs, for reports.
pub const RUNGS: [&str; 10] = [
    "raster",
    "raster in float",
    "vertex colours unclamped",
    "lit per fragment",
    "cast on the same triangles",
    "cast on the true shapes",
    "with shadows",
    "with reflection",
    "with refraction",
    "trace",
];

/// How to climb.
#[derive(Clone, Debug)]
pub struct Options {
    /// Tessellation level; `None` = the default.
    pub level: Option<u32>,
    /// Instruction set of the lanes.
    pub isa: Isa,
    /// Only what the scene requires, or everything: the same bytes.
    pub model: Model,
    /// Whether the tracer casts shadow rays at all.
    pub shadows: bool,
    /// Whether it casts mirror rays.
    pub reflection: bool,
    /// Whether it casts transmitted rays.
    pub refraction: bool,
}

/// Work and time of one render of the ladder.
#[derive(Clone, Debug)]
pub struct Work {
    /// Which rungs it gave.
    pub rungs: &'static str,
    /// Rasterizer counters, if the rasterizer drew it.
    pub raster: Option<raster::Counters>,
    /// Tracer counters, if the tracer drew it.
    pub trace: Option<trace::Counters>,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// The ten pictures and what follows from them.
#[derive(Clone, Debug)]
pub struct Ladder {
    /// The rungs' values: multiples of 2^-32.
    pub rungs: Vec<Plane<[f64; 3]>>,
    /// How many pixels had a value beyond 2^20 on some rung.
    pub limited_pixels: u64,
    /// Largest |total difference - sum of the causes|: 0.
    pub residual_max: f64,
    /// How well rungs 3 and 4 agree.
    pub agreement: Agreement,
    /// Pixels at a silhouette of the first or the last rung: see [`silhouette`].
    pub silhouette: Plane<bool>,
    /// What a step holds beside its own cause.
    pub notes: Vec<Note>,
    /// The rasterizer's layers: the unclamped picture of rung 2.
    pub raster_layers: Layers<f32>,
    /// Primary hits on the true shapes, unshadowed: the layers of rung 5.
    pub local_layers: Layers<f32>,
    /// The tracer's layers: the picture of rung 8, with reflection and refraction split by light where memory allows.
    pub trace_layers: Layers<f32>,
    /// The tracer's unclamped picture in f32, as float files hold it.
    pub trace_color: Plane<[f32; 3]>,
    /// The rasterizer's unclamped picture in f32.
    pub raster_color: Plane<[f32; 3]>,
    /// Triangles drawn.
    pub triangles: usize,
    /// Work and time of each render.
    pub work: Vec<Work>,
}

impl Ladder {
    /// The difference picture of a cause: rung `cause + 1` minus rung `cause`, exact.
    pub fn cause(&self, cause: usize) -> Plane<[f64; 3]> {
        difference(&self.rungs[cause + 1], &self.rungs[cause])
    }

    /// `trace.png` minus `raster.png`, exact.
    pub fn total(&self) -> Plane<[f64; 3]> {
        difference(&self.rungs[9], &self.rungs[0])
    }
}

fn difference(to: &Plane<[f64; 3]>, from: &Plane<[f64; 3]>) -> Plane<[f64; 3]> {
    let data = to
        .data
        .iter()
        .zip(&from.data)
        .map(|(b, a)| [0, 1, 2].map(|c| b[c] - a[c]));
    Plane {
        width: to.width,
        height: to.height,
        data: data.collect(),
    }
}

/// Climbs the ladder of a scene in the precision `R`; `progress` hears the name of each step before it starts.
///
/// # Errors
/// What the renderers refuse: too many triangles, too many rays a pixel.
pub fn decompose<R: Real>(
    scene: &Scene,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Ladder, Error> {
    let (image, lights) = (&scene.image, scene.enabled_lights().count());
    LayerIndex { lights }.check_size(image.width, image.height)?;
    progress("triangles");
    let assembly = Assembly::<R>::new(scene, options.level)?;
    assembly.check_range(scene)?;
    let mut climb = Climb {
        scene,
        options,
        progress,
        pixel: None,
        rungs: Vec::new(),
        work: Vec::new(),
    };
    let traced_plan = |geometry| trace::Plan::new(scene, &assembly, geometry, options.model);
    let rasterized = climb.raster(&raster::Plan::new(scene, &assembly, options.model))?;
    let cast = climb.cast_on_triangles(&traced_plan(trace::Geometry::Mesh)?)?;
    let traced = climb.trace(&traced_plan(trace::Geometry::Exact)?)?;
    progress("agreement");
    let agreement = agreement::measure(scene, &assembly, options, rasterized.per_fragment, cast)?;
    let mut ladder = Ladder {
        rungs: Vec::new(),
        limited_pixels: 0,
        residual_max: 0.0,
        agreement,
        silhouette: silhouette(&rasterized.object, &traced.object),
        notes: blend_note(scene).into_iter().collect(),
        raster_layers: rasterized.layers,
        local_layers: traced.local,
        trace_layers: traced.layers,
        trace_color: traced.color,
        raster_color: rasterized.color,
        triangles: assembly.triangles.len(),
        work: climb.work,
    };
    ladder.limited_pixels = limit(&mut climb.rungs);
    ladder.rungs = climb.rungs;
    ladder.residual_max = residual(&ladder);
    Ok(ladder)
}

/// The plans that the rungs are drawn with.
pub struct Plans<'p, 'a, R> {
    /// Rungs 0 to 3.
    pub raster: &'p raster::Plan<'a, R>,
    /// Rung 4: on the rasterizer's triangles.
    pub mesh: &'p trace::Plan<'a, R>,
    /// Rungs 5 to 9: on the true shapes.
    pub exact: &'p trace::Plan<'a, R>,
}

/// The ten values of one pixel, as [`Ladder::rungs`] hold them, and whether one of them had to be limited.
///
/// # Errors
/// A pixel outside the picture, and what the renderers refuse.
pub fn rungs_at<R: Real>(
    scene: &Scene,
    options: &Options,
    plans: &Plans<'_, '_, R>,
    pixel: [u32; 2],
) -> Result<([[f64; 3]; 10], bool), Error> {
    let mut climb = Climb {
        scene,
        options,
        progress: &|_| (),
        pixel: Some(pixel),
        rungs: Vec::new(),
        work: Vec::new(),
    };
    climb.raster(plans.raster)?;
    climb.cast_on_triangles(plans.mesh)?;
    climb.trace(plans.exact)?;
    let limited = limit(&mut climb.rungs) > 0;
    let mut values = [[0.0; 3]; 10];
    for (value, rung) in values.iter_mut().zip(&climb.rungs) {
        *value = rung.data[0];
    }
    Ok((values, limited))
}

/// What must be said where the rasterizer blends.
fn blend_note(scene: &Scene) -> Option<Note> {
    scene.blends().then(|| Note {
        place: None,
        message: "raster.transparency = \"blend\": rungs 0 to 3 are blended and no later one is, so the step `coverage` \
                  holds the end of blending beside its own cause; the agreement of rungs 3 and 4 is judged with \
                  transmissive surfaces opaque"
            .to_owned(),
    })
}

/// What the rasterizer leaves: objects of rung 0, layers and picture of rung 2, and the frame of rung 3.
struct Rasterized<R> {
    object: Plane<u32>,
    layers: Layers<f32>,
    color: Plane<[f32; 3]>,
    per_fragment: Frame<R>,
}

/// What the tracer leaves: the layers of rung 5, and layers, picture and objects of rung 8.
struct Traced {
    object: Plane<u32>,
    local: Layers<f32>,
    layers: Layers<f32>,
    color: Plane<[f32; 3]>,
}

/// The renders of the ladder in order.
struct Climb<'a> {
    scene: &'a Scene,
    options: &'a Options,
    progress: &'a (dyn Fn(&str) + Sync),
    /// The one pixel to be drawn; `None` = the whole picture.
    pixel: Option<[u32; 2]>,
    rungs: Vec<Plane<[f64; 3]>>,
    work: Vec<Work>,
}

impl Climb<'_> {
    /// Rungs 0 to 3.
    fn raster<R: Real>(&mut self, plan: &raster::Plan<'_, R>) -> Result<Rasterized<R>, Error> {
        let shading = self.scene.raster.shading;
        let options = |shading, clamp, layers| raster::Options {
            shading,
            clamp,
            layers,
            isa: self.options.isa,
        };
        let clamped = self.draw_raster(plan, "0, 1", &options(shading, true, false))?;
        self.rungs.push(stored(&clamped.color));
        self.rungs.push(values(&clamped.color));
        let unclamped = self.draw_raster(plan, "2", &options(shading, false, true))?;
        self.rungs.push(values(&unclamped.color));
        let per_fragment = self.draw_raster(plan, "3", &options(ShadeModel::Phong, false, true))?;
        self.rungs.push(values(&per_fragment.color));
        let layers = unclamped
            .layers
            .as_ref()
            .map(Layers::to_f32)
            .unwrap_or_default();
        Ok(Rasterized {
            object: clamped.object,
            layers,
            color: unclamped.color_f32(),
            per_fragment,
        })
    }

    /// Rung 4.
    fn cast_on_triangles<R: Real>(&mut self, plan: &trace::Plan<'_, R>) -> Result<Frame<R>, Error> {
        let cast = trace::Options::cast(self.options.isa);
        let frame = self.draw_trace(plan, "4", &cast)?;
        self.rungs.push(values(&frame.color));
        Ok(frame)
    }

    /// Rungs 5 to 9.
    fn trace<R: Real>(&mut self, plan: &trace::Plan<'_, R>) -> Result<Traced, Error> {
        let asked = self.options;
        let cast = trace::Options {
            layers: true,
            ..trace::Options::cast(asked.isa)
        };
        let local = self.draw_trace(plan, "5", &cast)?;
        self.rungs.push(values(&local.color));
        let full = trace::Options::of(self.scene, asked.isa);
        let step = |reflection, refraction, layers| trace::Options {
            shadows: asked.shadows,
            reflection: reflection && asked.reflection,
            refraction: refraction && asked.refraction,
            layers,
            ..full
        };
        let shadowed = self.draw_trace(plan, "6", &step(false, false, false))?;
        self.rungs.push(values(&shadowed.color));
        let reflected = self.draw_trace(plan, "7", &step(true, false, false))?;
        self.rungs.push(values(&reflected.color));
        let complete = self.draw_trace(plan, "8, 9", &step(true, true, true))?;
        self.rungs.push(values(&complete.color));
        self.rungs.push(stored(&complete.color));
        let layers = |frame: &Frame<R>| {
            frame
                .layers
                .as_ref()
                .map(Layers::to_f32)
                .unwrap_or_default()
        };
        Ok(Traced {
            local: layers(&local),
            layers: layers(&complete),
            color: complete.color_f32(),
            object: complete.object,
        })
    }

    fn draw_raster<R: Real>(
        &mut self,
        plan: &raster::Plan<'_, R>,
        rungs: &'static str,
        options: &raster::Options,
    ) -> Result<Frame<R>, Error> {
        (self.progress)(&format!("rung {rungs}: rasterizer"));
        if let Some(pixel) = self.pixel {
            return plan.draw_pixel(options, pixel);
        }
        let start = Instant::now();
        let (frame, counters) = plan.draw(options)?;
        let seconds = start.elapsed().as_secs_f64();
        self.work.push(Work {
            rungs,
            raster: Some(counters),
            trace: None,
            seconds,
        });
        Ok(frame)
    }

    fn draw_trace<R: Real>(
        &mut self,
        plan: &trace::Plan<'_, R>,
        rungs: &'static str,
        options: &trace::Options,
    ) -> Result<Frame<R>, Error> {
        (self.progress)(&format!("rung {rungs}: tracer"));
        if let Some(pixel) = self.pixel {
            return plan.draw_pixel(options, pixel);
        }
        let start = Instant::now();
        let (frame, counters) = draw_layers(plan, self.scene, options)?;
        let seconds = start.elapsed().as_secs_f64();
        self.work.push(Work {
            rungs,
            raster: None,
            trace: Some(counters),
            seconds,
        });
        Ok(frame)
    }
}

/// Traces; layers come with reflection and refraction split by light, unless that would fill the memory.
fn draw_layers<R: Real>(
    plan: &trace::Plan<'_, R>,
    scene: &Scene,
    options: &trace::Options,
) -> Result<(Frame<R>, trace::Counters), Error> {
    let lights = scene.enabled_lights().count();
    let mut optics = scene.materials.iter().map(|material| &material.optics);
    let bounces = optics.any(|o| o.is_mirror() || o.is_transmissive()) && options.depth > 0;
    let fits = LayerIndex { lights }.splits_fit(scene.image.width, scene.image.height);
    if options.layers && bounces && fits {
        plan.draw_split(options)
    } else {
        plan.draw(options)
    }
}

/// The float values of a picture.
fn values<R: Real>(color: &Plane<[R; 3]>) -> Plane<[f64; 3]> {
    color.map(|c| c.map(Real::to_f64))
}

/// The values that an 8-bit file holds.
fn stored<R: Real>(color: &Plane<[R; 3]>) -> Plane<[f64; 3]> {
    color.map(|c| c.map(|x| f64::from(quantize8(x)) / 255.0))
}

/// 2^32: rungs hold multiples of its inverse.
const STEPS: f64 = 4_294_967_296.0;
/// 2^20: the largest magnitude on a rung.
const LIMIT: f64 = 1_048_576.0;

/// Rounds every rung to the grid on which differences are exact; counts pixels that had to be limited.
fn limit(rungs: &mut [Plane<[f64; 3]>]) -> u64 {
    let pixels = rungs.first().map_or(0, |plane| plane.data.len());
    let mut limited = vec![false; pixels];
    for plane in rungs {
        for (color, limited) in plane.data.iter_mut().zip(&mut limited) {
            for x in color {
                *limited |= x.abs() > LIMIT;
                *x = (x.clamp(-LIMIT, LIMIT) * STEPS).round() / STEPS;
            }
        }
    }
    limited.into_iter().filter(|l| *l).count() as u64
}

/// Largest |total - sum of the causes|. With multiples of 2^-32 below 2^21 every operation is exact.
fn residual(ladder: &Ladder) -> f64 {
    let mut sum = ladder.total().map(|_| [0.0; 3]);
    for cause in 0..CAUSES.len() {
        for (s, d) in sum.data.iter_mut().zip(ladder.cause(cause).data) {
            *s = [0, 1, 2].map(|c| s[c] + d[c]);
        }
    }
    let total = ladder.total();
    let gap = total
        .data
        .iter()
        .zip(&sum.data)
        .flat_map(|(t, s)| [0, 1, 2].map(|c| t[c] - s[c]));
    gap.map(f64::abs).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limited_values_are_multiples_and_counted() {
        let plane = |x: f64| Plane::filled(2, 1, [x, 0.1, -0.3]);
        let mut rungs = vec![plane(1e9), plane(1.0 / 3.0)];
        assert_eq!(limit(&mut rungs), 2);
        assert_eq!(rungs[0].data[0][0], LIMIT);
        for x in rungs.iter().flat_map(|p| p.data.iter().flatten()) {
            assert_eq!((x * STEPS).fract(), 0.0);
        }
    }
}
