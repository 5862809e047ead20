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

pub use agreement::{Agreement, Coverage, agreement};
pub use masks::silhouette;
pub use views::{Shaded, Views, views};

use crate::error::{Error, Note};
use crate::frame::{LayerIndex, Layers, Plane};
use crate::gl::ShadeModel;
use crate::render::{Assembled, Counters, Drawn, Options, Picture, Rasterizer, Tracer};
use crate::scene::Scene;
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

/// Work and time of one render of the ladder.
#[derive(Clone, Debug)]
pub struct Work {
    /// Which rungs it gave.
    pub rungs: &'static str,
    /// Counters of whoever drew it.
    pub counters: Counters,
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

/// Climbs the ladder of a scene; `progress` hears the name of each step before it starts. `options.geometry` is what rungs 5
/// to 9 trace: on the rasterizer's triangles the step `tessellation` is 0.
///
/// # Errors
/// What the renderers refuse: too many triangles, too many rays a pixel.
pub fn decompose(
    scene: &Scene,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Ladder, Error> {
    let (image, lights) = (&scene.image, scene.enabled_lights().count());
    LayerIndex { lights }.check_size(image.width, image.height)?;
    progress("triangles");
    let assembled = Assembled::new(scene, options.level, options.precision)?;
    let mut climb = Climb {
        scene,
        options,
        progress,
        pixel: None,
        rungs: Vec::new(),
        work: Vec::new(),
    };
    let model = options.model;
    let traced_plan = |geometry| Tracer::new(scene, &assembled, geometry, model);
    let rasterized = climb.raster(&Rasterizer::new(scene, &assembled, model))?;
    let cast = climb.cast_on_triangles(&traced_plan(trace::Geometry::Mesh)?)?;
    let traced = climb.trace(&traced_plan(options.geometry)?)?;
    progress("agreement");
    let pair = [&rasterized.per_fragment, &cast];
    let agreement = agreement::measure(scene, &assembled, options, pair)?;
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
        triangles: assembled.triangles().len(),
        work: climb.work,
    };
    ladder.limited_pixels = limit(&mut climb.rungs);
    ladder.rungs = climb.rungs;
    ladder.residual_max = residual(&ladder);
    Ok(ladder)
}

/// The plans that the rungs are drawn with.
pub struct Plans<'p, 'a> {
    /// Rungs 0 to 3.
    pub raster: &'p Rasterizer<'a>,
    /// Rung 4: on the rasterizer's triangles.
    pub mesh: &'p Tracer<'a>,
    /// Rungs 5 to 9: on the true shapes.
    pub exact: &'p Tracer<'a>,
}

/// The ten values of one pixel, as [`Ladder::rungs`] hold them, and whether one of them had to be limited.
///
/// # Errors
/// A pixel outside the picture, and what the renderers refuse.
pub fn rungs_at(
    scene: &Scene,
    options: &Options,
    plans: &Plans<'_, '_>,
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

/// What the rasterizer leaves: objects of rung 0, layers and picture of rung 2, and the picture of rung 3.
struct Rasterized {
    object: Plane<u32>,
    layers: Layers<f32>,
    color: Plane<[f32; 3]>,
    per_fragment: Picture,
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
    fn raster(&mut self, plan: &Rasterizer<'_>) -> Result<Rasterized, Error> {
        let (asked, shading) = (self.options, self.scene.raster.shading);
        let clamped = self.draw_raster(plan, "0, 1", &asked.raster(shading, true, false))?;
        self.rungs.push(clamped.stored());
        self.rungs.push(clamped.color_f64());
        let unclamped = self.draw_raster(plan, "2", &asked.raster(shading, false, true))?;
        self.rungs.push(unclamped.color_f64());
        let by_fragment = asked.raster(ShadeModel::Phong, false, true);
        let per_fragment = self.draw_raster(plan, "3", &by_fragment)?;
        self.rungs.push(per_fragment.color_f64());
        Ok(Rasterized {
            object: clamped.object().clone(),
            layers: unclamped.layers_f32().unwrap_or_default(),
            color: unclamped.color_f32(),
            per_fragment,
        })
    }

    /// Rung 4.
    fn cast_on_triangles(&mut self, plan: &Tracer<'_>) -> Result<Picture, Error> {
        let picture = self.draw_trace(plan, "4", &self.options.cast())?;
        self.rungs.push(picture.color_f64());
        Ok(picture)
    }

    /// Rungs 5 to 9.
    fn trace(&mut self, plan: &Tracer<'_>) -> Result<Traced, Error> {
        let cast = trace::Options {
            layers: true,
            ..self.options.cast()
        };
        let local = self.draw_trace(plan, "5", &cast)?;
        self.rungs.push(local.color_f64());
        let asked = self.options.trace(self.scene);
        let step = |reflection, refraction, layers| trace::Options {
            reflection: reflection && asked.reflection,
            refraction: refraction && asked.refraction,
            layers,
            ..asked
        };
        let shadowed = self.draw_trace(plan, "6", &step(false, false, false))?;
        self.rungs.push(shadowed.color_f64());
        let reflected = self.draw_trace(plan, "7", &step(true, false, false))?;
        self.rungs.push(reflected.color_f64());
        let complete = self.draw_trace(plan, "8, 9", &step(true, true, true))?;
        self.rungs.push(complete.color_f64());
        self.rungs.push(complete.stored());
        Ok(Traced {
            local: local.layers_f32().unwrap_or_default(),
            layers: complete.layers_f32().unwrap_or_default(),
            color: complete.color_f32(),
            object: complete.object().clone(),
        })
    }

    fn draw_raster(
        &mut self,
        plan: &Rasterizer<'_>,
        rungs: &'static str,
        options: &raster::Options,
    ) -> Result<Picture, Error> {
        (self.progress)(&format!("rung {rungs}: rasterizer"));
        match self.pixel {
            Some(pixel) => plan.draw_pixel(options, pixel),
            None => Ok(self.note(rungs, plan.draw(options)?)),
        }
    }

    fn draw_trace(
        &mut self,
        plan: &Tracer<'_>,
        rungs: &'static str,
        options: &trace::Options,
    ) -> Result<Picture, Error> {
        (self.progress)(&format!("rung {rungs}: tracer"));
        match self.pixel {
            Some(pixel) => plan.draw_pixel(options, pixel),
            None => Ok(self.note(rungs, draw_layers(plan, self.scene, options)?)),
        }
    }

    /// Notes work and time.
    fn note(&mut self, rungs: &'static str, drawn: Drawn) -> Picture {
        self.work.push(Work {
            rungs,
            counters: drawn.counters,
            seconds: drawn.seconds.render,
        });
        drawn.picture
    }
}

/// Traces; layers come with reflection and refraction split by light, unless that would fill the memory.
fn draw_layers(plan: &Tracer<'_>, scene: &Scene, options: &trace::Options) -> Result<Drawn, Error> {
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
