//! Fixed-function OpenGL for programs: GL's commands, names, defaults and rules in safe Rust (GL 2.1 sections 2.5 to 2.14).
//!
//! A [`Context`] is a window of some size. Commands set state or record polygons; [`Context::scene`] is what they have drawn
//! since the last clear, as a [`Scene`] that the rasterizer draws ([`Context::draw`], [`Context::read_pixels`]) and the
//! tracer traces ([`Context::trace`]): the same vertices, the same materials, the same lights.
//!
//! | module | GL 2.1 |
//! | - | - |
//! | `matrix` | matrix modes, stacks, the matrices of GL and GLU: 2.11.2 |
//! | `state` | lights, materials, light model, enables: 2.14, 2.11.1, 2.11.3 |
//! | `immediate` | begin, vertices, end, vertex arrays, provoking vertices: 2.6, 2.8, 2.14.7 |
//! | `batch` `record` | what becomes of vertices: vertex colours or material slots; objects and the scene |
//! | `pixels` | reading the framebuffer: 4.3.2 |
//!
//! **Rules kept.** Defaults are GL's: no lighting, no depth test, no normalisation, an infinite viewer, white light 0. Positions
//! and spot directions are transformed when they are set. A wrong value records an error and keeps the old one; the first
//! error stays until [`Context::get_error`] reads it (2.5). Enums are Rust's, so GL's INVALID_ENUM cannot happen.
//!
//! **Space.** Lighting is in eye space, so the scene's camera stands at the origin, objects carry the modelview that they were
//! drawn with (any affine matrix: shear, mirrors), and the projection matrix is the camera's. Lighting off is a material
//! that only emits, and emits the current colour (2.14: the colour is then used as it is).
//!
//! **What a scene cannot hold** is refused by [`Context::scene`], with a message: lights, light model, normalisation,
//! projection, viewport, shade model, culling or depth test that change between the polygons of one picture; clearing one
//! buffer of two; vertices of one smooth triangle whose materials differ in more than one colour.
//!
//! Left out, and absent from the types: points, lines, textures, fog, user clip planes, polygon offset, blending, evaluators,
//! display lists, attribute stacks, colour-index mode.
//!
//! ```
//! use rastray::context::*;
//! let mut gl = Context::new(4, 4);
//! gl.color3(1.0, 0.5, 0.0);
//! gl.begin(PrimitiveMode::Quads);
//! for [x, y] in [[-1.0, -1.0], [0.0, -1.0], [0.0, 1.0], [-1.0, 1.0]] {
//!     gl.vertex2(x, y);
//! }
//! gl.end();
//! let row = gl.read_pixels::<u8>(0, 0, 4, 1, Format::Rgb)?;
//! assert_eq!(row, [255, 128, 0, 255, 128, 0, 0, 0, 0, 0, 0, 0]);
//! assert_eq!(gl.get_error(), None);
//! # Ok::<(), rastray::error::Error>(())
//! ```

mod batch;
mod immediate;
mod matrix;
mod pixels;
mod record;
mod state;

use std::ops::BitOr;

pub use crate::gl::{ColorControl, ColorMaterialMode, Face, ShadeModel};
pub use crate::scene::FrontFace;
pub use immediate::{Array, PrimitiveMode};
pub use matrix::{MAX_MODELVIEW_STACK_DEPTH, MAX_PROJECTION_STACK_DEPTH, MatrixMode};
pub use pixels::{Component, Format};
pub use record::Unrecordable;
pub use state::{LightModelParameter, LightParameter, MaterialParameter};

use crate::error::Error;
use crate::frame::Frame;
use crate::gl::{ColorMaterial, LightModel, LightSource};
use crate::lanes::Isa;
use crate::math::DVec3;
use crate::render::{self, Assembled, Job, Renderer};
use crate::scene::{Scene, TraceSettings};
use crate::trace::Geometry;
use batch::{Batch, Surface};
use immediate::Pointer;
use matrix::Stack;
use record::Recorded;

/// How many lights there are (GL asks for 8 or more).
pub const MAX_LIGHTS: usize = 256;

/// What GL's error flag says (GL 2.1 section 2.5). INVALID_ENUM cannot happen: enums are Rust's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GlError {
    /// A number is out of range; the command did nothing.
    InvalidValue,
    /// Not allowed now: between begin and end, or end without begin; the command did nothing.
    InvalidOperation,
    /// A push onto a full stack.
    StackOverflow,
    /// A pop from a stack of one.
    StackUnderflow,
}

/// What enable and disable switch. All are off at first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Capability {
    /// GL_LIGHTING.
    Lighting,
    /// GL_LIGHTi, i below [`MAX_LIGHTS`].
    Light(usize),
    /// GL_DEPTH_TEST: nearer fragments win (GL_LESS), else later ones.
    DepthTest,
    /// GL_CULL_FACE.
    CullFace,
    /// GL_NORMALIZE.
    Normalize,
    /// GL_RESCALE_NORMAL.
    RescaleNormal,
    /// GL_COLOR_MATERIAL.
    ColorMaterial,
}

/// Buffers to clear: `Buffers::COLOR | Buffers::DEPTH`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Buffers {
    color: bool,
    depth: bool,
}

impl Buffers {
    /// GL_COLOR_BUFFER_BIT.
    pub const COLOR: Self = Self {
        color: true,
        depth: false,
    };
    /// GL_DEPTH_BUFFER_BIT.
    pub const DEPTH: Self = Self {
        color: false,
        depth: true,
    };
}

impl BitOr for Buffers {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self {
            color: self.color || other.color,
            depth: self.depth || other.depth,
        }
    }
}

/// A rectangle of the window, from its lower left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Viewport {
    x: i32,
    y: i32,
    width: u32,
    height: u32,
}

/// The switches but for the lights.
#[derive(Clone, Debug, Default)]
struct Enabled {
    lighting: bool,
    depth_test: bool,
    cull_face: bool,
    normalize: bool,
    rescale_normal: bool,
    color_material: bool,
}

/// A window, GL's state, and what has been drawn. See the [module](self).
#[derive(Clone, Debug)]
pub struct Context {
    error: Option<GlError>,
    matrix_mode: MatrixMode,
    modelview: Stack,
    projection: Stack,
    enabled: Enabled,
    lights: Vec<LightSource>,
    lit: Vec<bool>,
    model: LightModel,
    color_material: ColorMaterial,
    surface: Surface,
    shade_model: ShadeModel,
    front_face: FrontFace,
    cull_face: Face,
    viewport: Viewport,
    depth_range: [f64; 2],
    clear_color: [f64; 4],
    normal: DVec3,
    color: [f64; 4],
    vertex_array: Pointer,
    normal_array: Pointer,
    color_array: Pointer,
    /// The mode of an open begin.
    open: Option<PrimitiveMode>,
    batch: Batch,
    recorded: Recorded,
    trace: TraceSettings,
    isa: Isa,
    /// The picture of `recorded`, once it was asked for.
    frame: Option<Frame<f32>>,
}

impl Context {
    /// A window of this size in GL's initial state, cleared to transparent black.
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            error: None,
            matrix_mode: MatrixMode::default(),
            modelview: Stack::new(MAX_MODELVIEW_STACK_DEPTH),
            projection: Stack::new(MAX_PROJECTION_STACK_DEPTH),
            enabled: Enabled::default(),
            lights: state::default_lights(),
            lit: vec![false; MAX_LIGHTS],
            model: LightModel::gl_default(),
            color_material: ColorMaterial::default(),
            surface: Surface::default(),
            shade_model: ShadeModel::Gouraud,
            front_face: FrontFace::Ccw,
            cull_face: Face::Back,
            viewport: Viewport {
                x: 0,
                y: 0,
                width,
                height,
            },
            depth_range: [0.0, 1.0],
            clear_color: [0.0; 4],
            normal: DVec3::Z,
            color: crate::gl::CURRENT_COLOR,
            vertex_array: Pointer::default(),
            normal_array: Pointer::default(),
            color_array: Pointer::default(),
            open: None,
            batch: Batch::default(),
            recorded: Recorded::default(),
            trace: TraceSettings::default(),
            isa: Isa::detect(),
            frame: None,
        }
    }

    /// glGetError: the first error since the last call; reading it clears it.
    pub fn get_error(&mut self) -> Option<GlError> {
        self.error.take()
    }

    /// glClear: a new picture begins, unless it would keep one of two buffers that are both in use.
    pub fn clear(&mut self, buffers: Buffers) {
        if !self.outside() {
            return;
        }
        let tests_depth = self.recorded.tests_depth();
        if buffers.color && (buffers.depth || !tests_depth) {
            self.recorded = Recorded::cleared(self.clear_color);
            self.frame = None;
        } else if tests_depth {
            self.refuse(Unrecordable::HalfCleared);
        }
    }

    /// What has been drawn since the last clear, as a scene for either renderer.
    ///
    /// # Errors
    /// [`Error::Unsupported`] where the commands drew what one scene cannot hold ([`Unrecordable`]).
    pub fn scene(&self) -> Result<Scene, Error> {
        self.recorded.scene(self)
    }

    /// How the tracer recurses (depth, what blocks shadow rays). Not GL's.
    pub fn trace_settings(&mut self, settings: TraceSettings) {
        self.trace = settings;
    }

    /// The picture in the viewport as OpenGL draws it: clamped colours, depth as distance along -z; top row first.
    ///
    /// # Errors
    /// As [`Context::scene`], and what the rasterizer refuses.
    pub fn draw(&mut self) -> Result<&Frame<f32>, Error> {
        let frame = match self.frame.take() {
            Some(frame) => frame,
            None => self.rasterize(&self.scene()?)?,
        };
        Ok(self.frame.insert(frame))
    }

    /// The same scene ray traced, with shadows and what [`Context::optics`] asked for: unclamped colours, top row first.
    ///
    /// # Errors
    /// As [`Context::scene`], and what the tracer refuses.
    pub fn trace(&self) -> Result<Frame<f32>, Error> {
        self.drawn_by(Renderer::Trace, &self.scene()?)
    }

    fn rasterize(&self, scene: &Scene) -> Result<Frame<f32>, Error> {
        self.drawn_by(Renderer::Raster, scene)
    }

    /// The scene as recorded, on GL's own triangles: those with vertices beyond the range of f32 are left out, as GL does.
    fn drawn_by(&self, by: Renderer, scene: &Scene) -> Result<Frame<f32>, Error> {
        let options = render::Options {
            geometry: Geometry::Mesh,
            isa: self.isa,
            ..render::Options::default()
        };
        let job = Job {
            clamp: true,
            ..Job::with(scene, by, &options)
        };
        let assembled = Assembled::unchecked(scene, None, options.precision)?;
        Ok(job.draw_of(&assembled)?.picture.into_f32())
    }

    /// Records an error, unless one waits to be read.
    fn error(&mut self, error: GlError) {
        self.error.get_or_insert(error);
    }

    /// Whether a command that is illegal between begin and end may run; else that is recorded.
    fn outside(&mut self) -> bool {
        if self.open.is_some() {
            self.error(GlError::InvalidOperation);
        }
        self.open.is_none()
    }

    /// Remembers the first thing that the scene cannot hold.
    fn refuse(&mut self, why: Unrecordable) {
        self.recorded.refused.get_or_insert(why);
    }
}
