//! The one place where pictures are made: a [`Job`] in, a [`Drawn`] out.
//!
//! A job says which scene, who draws it, in which shading and precision, and with which [`Options`]. What it leaves is
//! precision-erased: [`Picture`] holds a frame of f32 or of f64 and answers in either. Below this module renderers, lighting
//! and geometry are generic over the float `Real`; here that ends, each renderer is instantiated once a precision, and
//! everything above (ladder, explain, trade, check, context, peers, command line, tests) is plain.
//!
//! Whoever draws several pictures of one scene keeps the parts that a job goes through, in this order:
//! [`Assembled`] (triangles), then [`Rasterizer`] or [`Tracer`] (a plan over them), then [`Drawn`] a draw.
//!
//! ```
//! use rastray::{import, render::{Job, Renderer}};
//! let mut scene = import::load("whitted", &import::LoadOptions::default()).unwrap().scene;
//! (scene.image.width, scene.image.height) = (64, 48);
//! let local = Job::new(&scene, Renderer::Raster).draw().unwrap();
//! let global = Job::new(&scene, Renderer::Trace).draw().unwrap();
//! assert_ne!(local.picture.color_f32(), global.picture.color_f32());
//! ```

mod assembled;
mod drawn;
mod picture;
mod plan;

pub use assembled::Assembled;
pub use drawn::{Counters, Drawn, Seconds};
pub use picture::Picture;
pub use plan::{Meets, Rasterizer, Tracer};

use std::time::Instant;

use crate::error::Error;
use crate::gl::ShadeModel;
use crate::lanes::Isa;
use crate::lighting::Rounded;
use crate::scene::Scene;
use crate::scene::requirements::Model;
use crate::trace::Geometry;
use crate::{raster, trace};

/// Runs one expression on whichever precision an erased value holds.
macro_rules! each {
    ($erased:expr, $inner:ident => $body:expr) => {
        match $erased {
            Self::F32($inner) => $body,
            Self::F64($inner) => $body,
        }
    };
}
use each;

/// Who draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Renderer {
    /// The rasterizer.
    Raster,
    /// Primary rays only, nothing blocked: the rasterizer's terms by rays.
    Cast,
    /// Whitted's tracer.
    Trace,
}

impl Renderer {
    /// The one table of names: those of `--mode`.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("raster", Self::Raster),
        ("cast", Self::Cast),
        ("trace", Self::Trace),
    ];

    /// Its name in the table.
    pub fn name(self) -> &'static str {
        name_of(Self::NAMES, self)
    }
}

/// The floats of the whole path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 32 bits (the default).
    #[default]
    F32,
    /// 64 bits.
    F64,
}

impl Precision {
    /// The one table of names: those of `--precision`.
    pub const NAMES: &[(&'static str, Self)] = &[("f32", Self::F32), ("f64", Self::F64)];

    /// Both.
    pub const ALL: [Self; 2] = [Self::F32, Self::F64];

    /// Its name in the table.
    pub fn name(self) -> &'static str {
        name_of(Self::NAMES, self)
    }

    /// The nearest number that this precision holds.
    pub fn round(self, x: f64) -> f64 {
        match self {
            Self::F32 => f64::from(x as f32),
            Self::F64 => x,
        }
    }
}

/// The first name of a value in a table; empty where it has none.
pub fn name_of<T: Copy + PartialEq>(names: &[(&'static str, T)], value: T) -> &'static str {
    let found = names.iter().find(|(_, known)| *known == value);
    found.map_or("", |(name, _)| name)
}

/// How a scene is rendered, whichever picture of it; what the scene itself states (size, samples, shading, depth, snap) is
/// not repeated here.
#[derive(Clone, Debug)]
pub struct Options {
    /// Floats.
    pub precision: Precision,
    /// Tessellation level: slices of a full turn; `None` = 64.
    pub level: Option<u32>,
    /// What rays meet: the true shapes, or the rasterizer's triangles.
    pub geometry: Geometry,
    /// Only what the scene requires, or everything: the same bytes.
    pub model: Model,
    /// Instruction set of the lanes: the same bytes.
    pub isa: Isa,
    /// Whether the tracer casts shadow rays at all.
    pub shadows: bool,
    /// Whether it casts mirror rays.
    pub reflection: bool,
    /// Whether it casts transmitted rays.
    pub refraction: bool,
}

impl Default for Options {
    /// What `render` and `compare` do without flags, at the best instruction set that this machine has.
    fn default() -> Self {
        Self {
            precision: Precision::F32,
            level: None,
            geometry: Geometry::Exact,
            model: Model::Required,
            isa: Isa::detect(),
            shadows: true,
            reflection: true,
            refraction: true,
        }
    }
}

impl Options {
    /// What the rasterizer is asked for.
    pub fn raster(&self, shading: ShadeModel, clamp: bool, layers: bool) -> raster::Options {
        raster::Options {
            shading,
            clamp,
            layers,
            isa: self.isa,
        }
    }

    /// What the tracer is asked for: primary rays alone.
    pub fn cast(&self) -> trace::Options {
        trace::Options::cast(self.isa)
    }

    /// What the tracer is asked for: the scene's depth, and those kinds of rays that are on.
    pub fn trace(&self, scene: &Scene) -> trace::Options {
        trace::Options {
            shadows: self.shadows,
            reflection: self.reflection,
            refraction: self.refraction,
            ..trace::Options::of(scene, self.isa)
        }
    }
}

/// Deliberate departures from the right picture, for studies: none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Study {
    /// Inputs of the equation rounded to f32 in a render in f64.
    pub rounded: Rounded,
    /// Mistakes of the rasterizer.
    pub raster: raster::Faults,
    /// Mistakes of the tracer.
    pub trace: trace::Faults,
}

/// One picture to be made.
#[derive(Clone, Debug)]
pub struct Job<'a> {
    /// What is drawn.
    pub scene: &'a Scene,
    /// Who draws it.
    pub by: Renderer,
    /// Rasterizer: flat, Gouraud or per fragment.
    pub shading: ShadeModel,
    /// Rasterizer: GL's clamps. What rays bring is never clamped here.
    pub clamp: bool,
    /// The picture carries the terms of the equation as layers.
    pub layers: bool,
    /// Precision, tessellation, rays.
    pub options: Options,
    /// Departures from the right picture.
    pub study: Study,
}

impl<'a> Job<'a> {
    /// The scene in its own shading, unclamped, without layers, with the default options.
    pub fn new(scene: &'a Scene, by: Renderer) -> Self {
        Self::with(scene, by, &Options::default())
    }

    /// [`Self::new`] with options.
    pub fn with(scene: &'a Scene, by: Renderer, options: &Options) -> Self {
        Self {
            scene,
            by,
            shading: scene.raster.shading,
            clamp: false,
            layers: false,
            options: options.clone(),
            study: Study::default(),
        }
    }

    /// In a precision.
    #[must_use]
    pub fn precision(mut self, precision: Precision) -> Self {
        self.options.precision = precision;
        self
    }

    /// In a shade model of the rasterizer.
    #[must_use]
    pub fn shading(self, shading: ShadeModel) -> Self {
        Self { shading, ..self }
    }

    /// With the terms as layers.
    #[must_use]
    pub fn layers(self) -> Self {
        Self {
            layers: true,
            ..self
        }
    }

    /// Makes the picture: triangles, plan, pixels.
    ///
    /// # Errors
    /// What the renderers refuse: no pixels or too many, too many triangles, places beyond the precision, too many rays a
    /// pixel.
    pub fn draw(&self) -> Result<Drawn, Error> {
        let start = Instant::now();
        let mut assembled = Assembled::new(self.scene, self.options.level, self.options.precision)?;
        assembled.round(self.study.rounded);
        let assemble = start.elapsed().as_secs_f64();
        let mut drawn = self.draw_of(&assembled)?;
        drawn.seconds.assemble = assemble;
        Ok(drawn)
    }

    /// [`Self::draw`] of triangles that are there.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn draw_of(&self, assembled: &Assembled) -> Result<Drawn, Error> {
        let (scene, study, start) = (self.scene, &self.study, Instant::now());
        if self.by == Renderer::Raster {
            let plan = Rasterizer::new(scene, assembled, self.options.model);
            let plan = plan.rounding(study.rounded).with_faults(study.raster);
            let planned = start.elapsed().as_secs_f64();
            let options = self.options.raster(self.shading, self.clamp, self.layers);
            return Ok(plan.draw(&options)?.planned_in(planned));
        }
        let plan = Tracer::new(scene, assembled, self.options.geometry, self.options.model)?;
        let plan = plan.rounding(study.rounded).with_faults(study.trace);
        let planned = start.elapsed().as_secs_f64();
        Ok(plan.draw(&self.trace_options())?.planned_in(planned))
    }

    /// What the tracer is asked for.
    pub fn trace_options(&self) -> trace::Options {
        let options = match self.by {
            Renderer::Trace => self.options.trace(self.scene),
            Renderer::Raster | Renderer::Cast => self.options.cast(),
        };
        trace::Options {
            layers: self.layers,
            ..options
        }
    }
}
