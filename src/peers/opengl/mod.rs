//! The system's real OpenGL as a third renderer: the rasterizer's scene, drawn by a driver's fixed function.
//!
//! In: a [`Scene`] and the triangles ([`Assembled`]) that the rasterizer draws. Out: a [`Picture`] of float colours, GL window depths and
//! triangle numbers, top row first; and the [`Driver`]'s name. The driver is found when the program runs (EGL without a
//! window, `egl`); where there is none, or none with fixed function, an error says so.
//!
//! **What is compared.** Eye-space positions and normals of the assembly go to GL as they are, under an identity modelview:
//! GL does with them what the rasterizer does, so that differences are those of lighting, projection, coverage and
//! interpolation. A real modelview would add the driver's f32 matrix products to every vertex and measure those instead.
//! (Modelviews, normal transforms and light matrices of the driver are held against the specification case by case: see
//! [`Driver::light_point`].) GL 2.1 sections 2.11 to 2.14, 3.5, 3.9, 4.1.6.
//!
//! **How.** Fixed function (glLight, glMaterial, glColorMaterial, glLightModel) wherever GL has the feature
//! ([`Method::FixedFunction`]). More lights than GL holds (GL_MAX_LIGHTS, at least 8) are added in further passes over the
//! same triangles, where no clamp stands between them. What GL does not have goes through a GLSL 1.20 shader with the same
//! equation, and the picture says why: the (V.R)^n form, values that GL refuses (a shininess above 128), clamped colours of
//! more than GL_MAX_LIGHTS lights, vertex colours in terms that no glColorMaterial combines, lighting per fragment. Samples
//! are passes with the picture shifted by sub-pixels, averaged here. A second draw with the same state and the triangle's
//! number as its flat colour tells which triangle each pixel shows.
//!
//! Transmissive triangles that the scene asks to blend (`raster.transparency = "blend"`) go to GL_BLEND as the rasterizer has
//! them: after the opaque ones, in order, depth writes off; their numbers and depths are not drawn.
//!
//! Left out: jittered samples (one place a pixel is not a shift of the picture), textures. Depth is the driver's 32-bit (or
//! 24-bit) window depth, so surfaces closer together than its steps may change places.

mod api;
mod egl;
mod point;
mod scenery;
mod shader;
mod state;
mod target;

pub use point::LightPoint;

use serde::Serialize;

use crate::error::Error;
use crate::frame::Plane;
use crate::gl::{ColorMaterial, ColorMaterialMode, Face, LightSource, ShadeModel};
use crate::render::Assembled;
use crate::sampling::Pattern;
use crate::scene::{Camera, Material, Projection, Scene};
use api::Gl;
use scenery::Scenery;
use target::Target;

/// What the driver says of itself.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Info {
    /// GL_RENDERER, such as "llvmpipe (LLVM 15.0.6, 256 bits)".
    pub renderer: String,
    /// GL_VERSION, such as "4.5 (Compatibility Profile) Mesa 22.3.6".
    pub version: String,
    /// GL_VENDOR.
    pub vendor: String,
    /// GL_SHADING_LANGUAGE_VERSION.
    pub shading_language: String,
    /// How EGL reached it: "surfaceless", or "device" with its number.
    pub platform: String,
    /// GL_MAX_LIGHTS.
    pub max_lights: usize,
    /// GL_SUBPIXEL_BITS: how finely the driver says that it places vertices.
    pub subpixel_bits: u32,
}

/// How one picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Flat, Gouraud or per fragment; instead of the scene's own.
    pub shading: ShadeModel,
    /// GL's clamps to [0, 1], as the rasterizer's option of this name.
    pub clamp: bool,
}

/// Which part of GL lit a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Method {
    /// glLight and glMaterial, in so many passes over the triangles.
    FixedFunction {
        /// More than one where the scene has more lights than GL holds.
        passes: usize,
    },
    /// A vertex shader, and fixed function behind it.
    VertexShader {
        /// What GL's fixed function does not have.
        because: String,
    },
    /// A fragment shader, for lighting per fragment.
    FragmentShader,
}

impl std::fmt::Display for Method {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::FixedFunction { passes: 1 } => write!(f, "fixed function"),
            Self::FixedFunction { passes } => write!(f, "fixed function, {passes} passes"),
            Self::VertexShader { because } => write!(f, "GLSL 1.20 vertex shader, since {because}"),
            Self::FragmentShader => write!(f, "GLSL 1.20 fragment shader"),
        }
    }
}

/// What the driver drew, top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Linear colour, clamped only where the options asked for GL's clamps.
    pub color: Plane<[f32; 3]>,
    /// GL window depth at the first sample; 1 where nothing is.
    pub window_depth: Plane<f32>,
    /// Number of the triangle at the first sample; [`crate::frame::NONE`] where nothing is.
    pub primitive: Plane<u32>,
    /// What lit it.
    pub method: Method,
    /// The camera as the driver had it: an orthographic view without a far plane has one behind the farthest vertex.
    pub camera: Camera,
}

/// Finds and opens the system's OpenGL on a thread of its own, and works with it there until the work is done.
///
/// The thread has ended when this returns: with Mesa 22.3 a process may crash that exits while a thread which used GL is still
/// being taken down (seen in 1 of 100 runs from a thread pool, which does not wait for its threads). Work that is not
/// GL's own belongs outside, where the caller's thread pool is.
///
/// # Errors
/// [`Error::Unsupported`] where there is no EGL, no OpenGL, no fixed function, or no float framebuffer; and those of `work`.
pub fn with_driver<T: Send>(
    work: impl FnOnce(&Driver) -> Result<T, Error> + Send,
) -> Result<T, Error> {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("opengl".to_owned());
        let thread = thread
            .spawn_scoped(scope, || work(&Driver::open()?))
            .map_err(|e| Error::limit(format!("cannot start a thread for OpenGL: {e}")))?;
        thread
            .join()
            .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// The system's OpenGL, on the thread that opened it: see [`with_driver`].
pub struct Driver {
    gl: Gl,
    info: Info,
}

/// What to do where there is no driver.
const HELP: &str = "install a driver (Debian: apt-get install libegl1 libgl1-mesa-dri); \
                    GALLIUM_DRIVER=llvmpipe or softpipe chooses one of Mesa's";

/// An error of the driver, with advice.
fn failed(reason: impl std::fmt::Display) -> Error {
    Error::Unsupported {
        place: None,
        message: format!("OpenGL: {reason}"),
        help: Some(HELP.to_owned()),
    }
}

impl Driver {
    fn open() -> Result<Self, Error> {
        let gl = Gl::open().map_err(failed)?;
        let info = Info {
            renderer: gl.string(api::RENDERER),
            version: gl.string(api::VERSION),
            vendor: gl.string(api::VENDOR),
            shading_language: gl.string(api::SHADING_LANGUAGE_VERSION),
            platform: gl.platform().to_owned(),
            max_lights: usize::try_from(gl.integer(api::MAX_LIGHTS)).unwrap_or(0),
            subpixel_bits: u32::try_from(gl.integer(api::SUBPIXEL_BITS)).unwrap_or(0),
        };
        let driver = Self { gl, info };
        driver.check()?;
        Ok(driver)
    }

    /// What the driver says of itself.
    pub fn info(&self) -> &Info {
        &self.info
    }

    /// Fixed function and float framebuffers: both are needed, and both may be absent.
    fn check(&self) -> Result<(), Error> {
        let Info {
            renderer,
            version,
            max_lights,
            ..
        } = &self.info;
        // A core profile does not know GL_MAX_LIGHTS: the error is taken away here.
        let refused = self.gl.get_error() != 0;
        if refused || *max_lights < 8 || version.contains("ES ") {
            return Err(failed(format!(
                "{renderer} ({version}) has no fixed-function lighting"
            )));
        }
        let major = version.split('.').next().and_then(|v| v.parse().ok());
        let extensions = self.gl.string(api::EXTENSIONS);
        let has = |name: &&str| extensions.split_whitespace().any(|e| e == *name);
        let needed = [
            "GL_ARB_framebuffer_object",
            "GL_ARB_texture_float",
            "GL_ARB_color_buffer_float",
        ];
        let missing: Vec<&str> = needed.into_iter().filter(|name| !has(name)).collect();
        if major.unwrap_or(0) < 3 && !missing.is_empty() {
            return Err(failed(format!(
                "{renderer} ({version}) lacks {}",
                missing.join(", ")
            )));
        }
        Ok(())
    }

    /// Draws a scene's triangles.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for what GL or this driver cannot draw, with its reason.
    pub fn draw(
        &self,
        scene: &Scene,
        assembled: &Assembled,
        options: &Options,
    ) -> Result<Picture, Error> {
        self.gl.make_current().map_err(failed)?;
        let image = &scene.image;
        if image.pattern == Pattern::Jitter {
            return Err(Error::parameter(
                "pattern",
                "OpenGL cannot jitter its samples from pixel to pixel",
            )
            .with_help("use pattern = \"grid\""));
        }
        let lights = scene.lights_eye();
        let method = self.method(scene, &lights, options);
        let limit = shader::light_limit(&self.gl);
        if !matches!(method, Method::FixedFunction { .. }) && lights.len() > limit {
            return Err(failed(format!(
                "this driver's shaders hold {limit} lights, and the scene has {}",
                lights.len()
            )));
        }
        let target = Target::new(&self.gl, image.width, image.height).map_err(failed)?;
        let scenery = Scenery {
            gl: &self.gl,
            scene,
            assembled,
            options,
            lights,
            camera: bounded(&scene.camera, assembled),
        };
        let picture = scenery.picture(&target, method)?;
        match self.gl.get_error() {
            0 => Ok(picture),
            code => Err(failed(format!("the driver reports error 0x{code:04X}"))),
        }
    }

    /// Fixed function wherever it has what the scene asks for.
    fn method(&self, scene: &Scene, lights: &[LightSource], options: &Options) -> Method {
        if options.shading == ShadeModel::Phong {
            return Method::FragmentShader;
        }
        if let Some(because) = self.beyond_fixed_function(scene, lights, options) {
            return Method::VertexShader { because };
        }
        let passes = lights.len().div_ceil(self.info.max_lights).max(1);
        Method::FixedFunction { passes }
    }

    /// What fixed function does not have, if anything.
    fn beyond_fixed_function(
        &self,
        scene: &Scene,
        lights: &[LightSource],
        options: &Options,
    ) -> Option<String> {
        use crate::gl::SpecularModel::Reflection;
        if scene.light_model.specular_model == Reflection {
            return Some("GL has no reflection form (V.R)^n".to_owned());
        }
        let materials = scene.materials.iter();
        let materials = materials.flat_map(|m| std::iter::once(&m.front).chain(&m.back));
        let mut refused = lights
            .iter()
            .flat_map(LightSource::range_violations)
            .chain(materials.flat_map(crate::gl::Material::range_violations));
        if let Some(v) = refused.next() {
            return Some(format!(
                "GL refuses {} = {} (legal: {})",
                v.parameter, v.value, v.legal
            ));
        }
        let mut colored = scene
            .materials
            .iter()
            .map(|m| self.beyond_color_material(scene, m));
        if let Some(because) = colored.find_map(|because| because) {
            return Some(because);
        }
        let (count, most) = (lights.len(), self.info.max_lights);
        if count <= most {
            return None;
        }
        if scene.blends() {
            // The groups of one triangle would have to follow each other, before the next triangle is blended.
            return Some(format!(
                "surfaces are blended under {count} lights, and GL holds {most}"
            ));
        }
        match (options.clamp, scene.raster.depth_test) {
            (true, _) => Some(format!(
                "colours of {count} lights are clamped, and GL holds {most}"
            )),
            // Passes add up by equal depths.
            (false, false) => Some(format!(
                "{count} lights without a depth test, and GL holds {most}"
            )),
            (false, true) => None,
        }
    }
}

impl Driver {
    /// What glColorMaterial, or this driver's, does not have of a material, if anything.
    fn beyond_color_material(&self, scene: &Scene, material: &Material) -> Option<String> {
        let tracked = state::sides(material, &scene.light_model).map(|side| side.tracked);
        if !tracked.iter().any(|side| side.any()) {
            return None;
        }
        let name = &material.name;
        match ColorMaterial::of(tracked) {
            None => Some(format!(
                "no mode of glColorMaterial has the vertex colour in the terms of material {name}"
            )),
            // Mesa 22.3.6: both software drivers, which differ from each other there, too. Each one's GLSL path is right.
            Some(ColorMaterial {
                face: Face::Back,
                mode,
            }) if mode != ColorMaterialMode::Emission && self.info.version.contains("Mesa") => {
                Some(format!(
                    "Mesa's fixed function lights back faces wrong where they alone follow the vertex colour (material {name})"
                ))
            }
            Some(_) => None,
        }
    }
}

/// The camera with a far plane where GL's matrix needs one: an orthographic view without one gets it behind the farthest
/// vertex.
fn bounded(camera: &Camera, assembled: &Assembled) -> Camera {
    if camera.far.is_some() || !matches!(camera.projection, Projection::Orthographic { .. }) {
        return *camera;
    }
    let distances = (0..assembled.vertices() as u32).map(|v| -assembled.vertex_eye(v)[2]);
    let farthest = distances.fold(2.0 * camera.near, f64::max);
    Camera {
        far: Some(1.001 * farthest),
        ..*camera
    }
}
