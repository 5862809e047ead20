//! Why this colour? One pixel in both renderers: the equation with its numbers, per light and term, the weighted ray tree, and
//! the causes of the pixel's difference.
//!
//! In: a scene and the options of its renders. Out: an [`Explanation`] a pixel, plain values that serialise as
//! `explain --json`. Nothing is computed twice: the renderers draw the one pixel through their own passes and write down what
//! they do (`raster::record`, `trace::record`), the ladder climbs at it (`decompose::rungs_at`), and here the numbers only get
//! names and world space. So totals are the stored pixels, bit for bit:
//!
//! - `raster.color` and `trace.color` are the pixels of the float pictures of `render`.
//! - One sample: the tracer's colour is the sum of its primary hit's terms in their order, then `reflection.contribution`, then
//!   `refraction.contribution`, in the render's precision (f64 rounded once where some colour is negative). Each contribution
//!   is the sum over its rays, in the order of their numbers, of path weight times term.
//! - Per fragment, the rasterizer's colour is the sum of its terms; flat, that of the provoking vertex; Gouraud, the colours of
//!   three vertices interpolated with their weights, whose terms are interpolated alike and leave a remainder of rounding.
//! - Several samples: the colour is the mean over the samples; one sample, the nearest to the centre, is explained.
//! - The causes add up to the difference of the two PNGs exactly.
//!
//! Cost: a [`Setting`] assembles the triangles and an [`Explainer`] plans both renderers, once a scene; a pixel then costs
//! about what seven renders of one pixel cost.
//!
//! ```
//! use rastray::{explain::Setting, import, render::Options};
//! let mut scene = import::load("two-sided", &import::LoadOptions::default()).unwrap().scene;
//! (scene.image.width, scene.image.height) = (64, 48);
//! let setting = Setting::new(&scene, Options::default()).unwrap();
//! let explained = setting.explainer().unwrap().at(32, 24).unwrap();
//! let sum: f64 = explained.causes.iter().map(|cause| cause.rgb[0]).sum();
//! assert_eq!(sum, explained.difference[0]);
//! ```

mod local;
pub mod nested;
mod raster_side;
mod tree;
mod value;

pub use value::{
    Blended, Cause, Coefficients, Explanation, Factors, Hit, Light, LightTerms, Raster, Ray,
    Reflection, Refraction, Samples, Terms, Trace, Vector, Vertex,
};

pub use crate::trace::record::Kind;

use crate::decompose::{self, CAUSES, rungs_at};
use crate::error::Error;
use crate::gl::SpecularModel;
use crate::math::color::{Rgb, quantize8};
use crate::render::{Assembled, Options, Precision, Rasterizer, Tracer};
use crate::scene::requirements::Model;
use crate::scene::{Geometry, Scene};
use crate::{sampling, trace};
use local::Local;

/// A scene with its triangles: what an [`Explainer`] borrows.
pub struct Setting<'a> {
    scene: &'a Scene,
    options: Options,
    assembled: Assembled,
}

impl<'a> Setting<'a> {
    /// Assembles the triangles of a scene. What changes the pictures beside the options is the scene's own: its size, samples,
    /// shading, depth and snap. On the rasterizer's triangles (`options.geometry`) the ladder's step `tessellation` is 0.
    ///
    /// # Errors
    /// What the renderers refuse: too many triangles, places beyond the precision.
    pub fn new(scene: &'a Scene, options: Options) -> Result<Self, Error> {
        let assembled = Assembled::new(scene, options.level, options.precision)?;
        Ok(Self {
            scene,
            options,
            assembled,
        })
    }

    /// Plans both renderers.
    ///
    /// # Errors
    /// A picture without pixels.
    pub fn explainer(&self) -> Result<Explainer<'_>, Error> {
        let (scene, options, assembled) = (self.scene, &self.options, &self.assembled);
        // Factors are shown even where their product is 0; the colours are the same bits.
        let model = Model::Full;
        let plan = |geometry| Tracer::new(scene, assembled, geometry, model);
        let shapes = |o: &crate::scene::Object| matches!(o.geometry, Geometry::Shape(_));
        let apart = options.geometry == trace::Geometry::Exact && scene.objects.iter().any(shapes);
        Ok(Explainer {
            scene,
            options,
            assembled,
            raster: Rasterizer::new(scene, assembled, model),
            mesh: apart.then(|| plan(trace::Geometry::Mesh)).transpose()?,
            traced: plan(options.geometry)?,
        })
    }
}

/// Explains pixels of one scene: both renderers, planned. Several threads may ask at once.
pub struct Explainer<'a> {
    scene: &'a Scene,
    options: &'a Options,
    assembled: &'a Assembled,
    raster: Rasterizer<'a>,
    /// The tracer on the rasterizer's triangles; `None` where that is what `traced` traces.
    mesh: Option<Tracer<'a>>,
    traced: Tracer<'a>,
}

impl Explainer<'_> {
    /// Explains the pixel X, Y, counted from the top left.
    ///
    /// # Errors
    /// [`Error::Parameter`] outside the picture, and what the renderers refuse.
    pub fn at(&self, x: u32, y: u32) -> Result<Explanation, Error> {
        let pixel = [x, y];
        let plans = decompose::Plans {
            raster: &self.raster,
            mesh: self.mesh.as_ref().unwrap_or(&self.traced),
            exact: &self.traced,
        };
        let (rungs, limited) = rungs_at(self.scene, self.options, &plans, pixel)?;
        let stored = |rung: Rgb| rung.map(|x| (x * 255.0).round() as u8);
        let (shown, places) = samples(self.scene, pixel);
        let rastered = self.raster_record(pixel, shown)?;
        let asked = self.options.trace(self.scene);
        let traced = self.traced.record_pixel(&asked, pixel, shown)?;
        let place = [0, 1].map(|k| f64::from(pixel[k]) + places[shown as usize][k]);
        let local = self.local();
        let samples = (places.len() > 1).then(|| Samples {
            shown: shown as usize,
            places,
            raster: rastered.samples.clone(),
            trace: traced.samples.iter().map(|(c, _)| *c).collect(),
        });
        let raster = self.raster_side(&rastered, place, stored(rungs[0]));
        let trace = Trace {
            color: traced.color,
            stored: stored(rungs[9]),
            rays: tree::rays(&local, &traced, self.scene.trace.depth),
        };
        let light_model = &self.scene.light_model;
        Ok(Explanation {
            scene: self.scene.name.clone(),
            pixel,
            size: [self.scene.image.width, self.scene.image.height],
            precision: self.options.precision.name(),
            specular_model: match light_model.specular_model {
                SpecularModel::HalfVector => "half-vector",
                SpecularModel::Reflection => "reflection",
            },
            scene_ambient: light_model.ambient,
            lights: local.sources(),
            samples,
            raster,
            trace,
            difference: less(rungs[9], rungs[0]),
            causes: causes(&rungs),
            rungs: rungs.to_vec(),
            limited,
        })
    }

    /// Explains what a ray of the caller's brings back: world space, a direction of any length but zero. It is seen along
    /// itself, starts in the media around its origin, and knows no near and far plane.
    ///
    /// # Errors
    /// [`Error::Parameter`] for numbers that make no ray, and what the tracer refuses.
    pub fn along(&self, origin: Vector, direction: Vector) -> Result<Trace, Error> {
        let finite = |v: Vector| v.iter().all(|x| x.is_finite());
        if !finite(origin) || !finite(direction) || direction == [0.0; 3] {
            let message = format!(
                "from {origin:?} along {direction:?}: expected finite numbers and a direction that is not zero"
            );
            return Err(Error::parameter("ray", message));
        }
        let ray = trace::ray::Ray::new(origin.into(), direction.into());
        let asked = self.options.trace(self.scene);
        let record = self.traced.record_ray(&asked, &ray)?;
        Ok(Trace {
            color: record.color,
            stored: quantized(self.options.precision, record.color),
            rays: tree::rays(&self.local(), &record, self.scene.trace.depth),
        })
    }

    fn local(&self) -> Local<'_> {
        Local {
            scene: self.scene,
            precision: self.options.precision,
            tracer: &self.traced,
            world_from_eye: self.scene.camera.eye_from_world_rotation().transpose(),
            shadows: self.options.shadows,
        }
    }
}

/// Eight bits a channel, rounded in the precision of the render.
fn quantized(precision: Precision, color: Rgb) -> [u8; 3] {
    match precision {
        Precision::F32 => color.map(|x| quantize8(x as f32)),
        Precision::F64 => color.map(quantize8),
    }
}

/// The steps between neighbouring rungs.
fn causes(rungs: &[Rgb; 10]) -> Vec<Cause> {
    let steps = CAUSES.into_iter().zip(rungs.windows(2));
    steps
        .map(|(name, pair)| Cause {
            name,
            rgb: less(pair[1], pair[0]),
        })
        .collect()
}

/// The sample nearest to the centre of a pixel, and where each one lies.
fn samples(scene: &Scene, [x, y]: [u32; 2]) -> (u32, Vec<[f64; 2]>) {
    let image = &scene.image;
    let step = f64::from(sampling::SUBPIXEL);
    let place = |i| {
        let (a, b) = sampling::position(image.pattern, image.samples, x, y, i);
        [f64::from(a) / step, f64::from(b) / step]
    };
    let places: Vec<[f64; 2]> = (0..image.samples.max(1)).map(place).collect();
    let off = |[a, b]: [f64; 2]| (a - 0.5) * (a - 0.5) + (b - 0.5) * (b - 0.5);
    let nearest = (1..places.len()).fold(0, |best, i| {
        if off(places[i]) < off(places[best]) {
            i
        } else {
            best
        }
    });
    (nearest as u32, places)
}

fn less(a: Rgb, b: Rgb) -> Rgb {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
