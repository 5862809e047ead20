//! The scene as plain data: what every importer ends in and both renderers start from.
//!
//! World space, f64, file order. No lighting arithmetic stands here. [`assembly`] turns the objects into the triangles
//! that the rasterizer draws and `--geometry mesh` traces; [`requirements`] says which features the scene needs.

pub mod assembly;
pub mod bezier;
pub mod camera;
pub mod contact;
pub mod fit;
pub mod optics;
pub mod piece;
pub mod profile;
pub mod projection;
pub mod requirements;
pub mod revolution;
pub mod round;
pub mod shape;
pub mod teapot;
pub mod tessellate;
pub mod volume;

use std::sync::Arc;

pub use camera::{Camera, Projection};
pub use optics::{Fresnel, Optics};
pub use profile::{Curve, Profile};
pub use shape::{Mesh, Shape};

use crate::error::Error;
use crate::gl;
use crate::math::color::Rgb;
use crate::math::{DAffine3, DMat3, DVec3, DVec4};
use crate::sampling::Pattern;

/// `[image]`: size, background, samples.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageSettings {
    /// Width in pixels. Default 640.
    pub width: u32,
    /// Height in pixels. Default 480.
    pub height: u32,
    /// Colour where nothing is hit: neither lit nor shadowed. Default black.
    pub background: Rgb,
    /// Samples a pixel. Default 1.
    pub samples: u32,
    /// How they are spread. Default grid.
    pub pattern: Pattern,
    /// Seed of the jitter. Default 0.
    pub seed: u32,
}

impl Default for ImageSettings {
    fn default() -> Self {
        let (background, pattern) = ([0.0; 3], Pattern::Grid);
        Self {
            width: 640,
            height: 480,
            background,
            samples: 1,
            pattern,
            seed: 0,
        }
    }
}

impl ImageSettings {
    /// Refuses a pixel outside the picture.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the range.
    pub fn check_pixel(&self, [x, y]: [u32; 2]) -> Result<[u32; 2], Error> {
        let (width, height) = (self.width, self.height);
        if x < width && y < height {
            return Ok([x, y]);
        }
        let message = format!(
            "{x} {y} lies outside the picture of {width}x{height}: expected X from 0 to {} and Y from 0 to {}",
            width.saturating_sub(1),
            height.saturating_sub(1)
        );
        Err(Error::parameter("pixel", message).with_help("0 0 is the top left pixel"))
    }
}

/// Which triangles the rasterizer drops by facing (GL_CULL_FACE).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cull {
    /// None (GL's default).
    #[default]
    None,
    /// Back faces.
    Back,
    /// Front faces.
    Front,
}

impl Cull {
    /// The one table of names: command line, scene file and reports; the first name of a value is the one to print.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("none", Self::None),
        ("back", Self::Back),
        ("front", Self::Front),
    ];
}

/// Which winding in the window, y up, is the front (GL_FRONT_FACE).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrontFace {
    /// Counter-clockwise (GL's default).
    #[default]
    Ccw,
    /// Clockwise.
    Cw,
}

impl FrontFace {
    /// The one table of names: command line, scene file and reports; the first name of a value is the one to print.
    pub const NAMES: &[(&'static str, Self)] = &[("ccw", Self::Ccw), ("cw", Self::Cw)];
}

/// The grid that vertices snap to before coverage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Snap {
    /// 1/256 pixel (the default).
    #[default]
    Bits8,
    /// 1/4096 pixel.
    Bits12,
    /// None: coverage is decided on the vertices as they are.
    Exact,
}

impl Snap {
    /// The one table of names: command line, scene file and reports.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("8", Self::Bits8),
        ("12", Self::Bits12),
        ("exact", Self::Exact),
    ];

    /// Sub-pixel bits; `None` = no grid.
    pub fn bits(self) -> Option<u32> {
        match self {
            Self::Bits8 => Some(8),
            Self::Bits12 => Some(12),
            Self::Exact => None,
        }
    }

    /// Its name in the table.
    pub fn name(self) -> &'static str {
        let found = Self::NAMES.iter().find(|(_, snap)| *snap == self);
        found.map_or("", |(name, _)| name)
    }
}

/// What the rasterizer makes of transmissive surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transparency {
    /// They are drawn like any other, so that the tracer's difference is exactly K_T I_T (the default).
    #[default]
    Opaque,
    /// GL's stand-in (GL 2.1 section 4.1.8): blended over the opaque surfaces with [`Optics::blend_alpha`], in the order
    /// of the triangles, tested against the depth of the opaque ones and writing none.
    Blend,
}

impl Transparency {
    /// The one table of names: scene file and reports; the first name of a value is the one to print.
    pub const NAMES: &[(&'static str, Self)] = &[("opaque", Self::Opaque), ("blend", Self::Blend)];
}

/// `[raster]`: how the rasterizer draws.
#[derive(Clone, Debug, PartialEq)]
pub struct RasterSettings {
    /// Shade model. Default Gouraud.
    pub shading: gl::ShadeModel,
    /// Culling; the tracer ignores it. Default none.
    pub cull: Cull,
    /// Front winding. Default counter-clockwise.
    pub front_face: FrontFace,
    /// GL depth range of near and far. Turned round, the farthest surface shows; a single depth, the first one drawn (none at
    /// depth 1, to which the buffer is cleared). The tracer ignores it. Default 0, 1.
    pub depth_range: [f64; 2],
    /// Sub-pixel grid. Default 8 bits.
    pub snap: Snap,
    /// The nearest surface shows (GL_DEPTH_TEST with GL_LESS); else the last one drawn does, and depth stays unwritten. The
    /// tracer ignores it. Default true.
    pub depth_test: bool,
    /// Transmissive surfaces; the tracer ignores it. Default opaque.
    pub transparency: Transparency,
}

impl Default for RasterSettings {
    fn default() -> Self {
        Self {
            shading: gl::ShadeModel::Gouraud,
            cull: Cull::None,
            front_face: FrontFace::Ccw,
            depth_range: [0.0, 1.0],
            snap: Snap::Bits8,
            depth_test: true,
            transparency: Transparency::Opaque,
        }
    }
}

/// What blocks a shadow ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shadow {
    /// Any object strictly between hit and light: S_L is 0 or 1 (the default).
    #[default]
    Opaque,
    /// Blockers multiply by their K_T, straight through.
    Filtered,
}

impl Shadow {
    /// The one table of names: command line, scene file and reports; the first name of a value is the one to print.
    pub const NAMES: &[(&'static str, Self)] =
        &[("opaque", Self::Opaque), ("filtered", Self::Filtered)];
}

/// What happens where total internal reflection leaves no transmitted ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tir {
    /// I_T = 0, the lecture's form (the default).
    #[default]
    None,
    /// The K_T weight is reflected.
    Reflect,
}

impl Tir {
    /// The one table of names: command line, scene file and reports; the first name of a value is the one to print.
    pub const NAMES: &[(&'static str, Self)] = &[("none", Self::None), ("reflect", Self::Reflect)];
}

/// `[trace]`: how the tracer recurses.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceSettings {
    /// Generations of secondary rays. Default 6.
    pub depth: u32,
    /// What blocks light. Default opaque.
    pub shadow: Shadow,
    /// Total internal reflection. Default none.
    pub tir: Tir,
    /// A branch whose weight is below this in every channel is dropped. Default 0.
    pub weight_cutoff: f64,
}

impl Default for TraceSettings {
    fn default() -> Self {
        Self {
            depth: 6,
            shadow: Shadow::Opaque,
            tir: Tir::None,
            weight_cutoff: 0.0,
        }
    }
}

/// The space that a light's position and spot direction are given in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightSpace {
    /// World space (the default): the light stays where it is when the camera moves.
    #[default]
    World,
    /// Eye space: the light moves with the camera.
    Eye,
}

impl LightSpace {
    /// The one table of names: command line, scene file and reports; the first name of a value is the one to print.
    pub const NAMES: &[(&'static str, Self)] = &[("world", Self::World), ("eye", Self::Eye)];
}

/// A named light source.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name in the file.
    pub name: String,
    /// The GL parameters, in `space`.
    pub source: gl::LightSource,
    /// The space of position and spot direction.
    pub space: LightSpace,
    /// A disabled light takes part in nothing.
    pub enabled: bool,
}

/// A named material: GL's terms, and the optics that only the tracer reads.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file.
    pub name: String,
    /// GL material of front faces.
    pub front: gl::Material,
    /// GL material of back faces under two-sided lighting; `None` = the front material.
    pub back: Option<gl::Material>,
    /// Mirror weight, K_T, index of refraction.
    pub optics: Optics,
}

/// What an object is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// An exact shape: traced exactly, tessellated for the rasterizer.
    Shape(Shape),
    /// Triangles.
    Mesh(Arc<Mesh>),
}

/// One thing in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its name in the file.
    pub name: String,
    /// Its form, in object space.
    pub geometry: Geometry,
    /// Indices into [`Scene::materials`], at least one; meshes and tiled patches choose by slot.
    pub materials: Vec<usize>,
    /// Object to world.
    pub world_from_object: DAffine3,
    /// Slices of a full turn (N/2 stacks), or cells a side of a patch; `None` = the render's level.
    pub tessellation: Option<u32>,
    /// Of solids that overlap, the one with the higher number is there, and surfaces inside it are not; default 0.
    pub priority: i32,
}

/// A complete scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// What to call it in reports: the file's stem.
    pub name: String,
    /// Size and samples.
    pub image: ImageSettings,
    /// The view.
    pub camera: Camera,
    /// The GL light model.
    pub light_model: gl::LightModel,
    /// Rasterizer settings.
    pub raster: RasterSettings,
    /// Tracer settings.
    pub trace: TraceSettings,
    /// Light sources in file order.
    pub lights: Vec<Light>,
    /// Materials in file order.
    pub materials: Vec<Material>,
    /// Objects in file order.
    pub objects: Vec<Object>,
}

impl Scene {
    /// The enabled lights in file order: the lights of the equation, and of the layers.
    pub fn enabled_lights(&self) -> impl Iterator<Item = &Light> {
        self.lights.iter().filter(|light| light.enabled)
    }

    /// The colour where nothing is hit; a component that is not a number shows as 0.
    pub fn background(&self) -> Rgb {
        self.image
            .background
            .map(|x| if x.is_nan() { 0.0 } else { x })
    }

    /// Names of the enabled lights.
    pub fn light_names(&self) -> Vec<String> {
        self.enabled_lights()
            .map(|light| light.name.clone())
            .collect()
    }

    /// The enabled lights with position and spot direction in eye space (GL transforms the position by the whole
    /// modelview, the direction by its upper-left 3x3: GL 2.1 section 2.14.1).
    pub fn lights_eye(&self) -> Vec<gl::LightSource> {
        let eye = self.camera.eye;
        let rotation = self.camera.eye_from_world_rotation();
        self.enabled_lights()
            .map(|light| match light.space {
                LightSpace::Eye => light.source.clone(),
                LightSpace::World => to_eye(&light.source, eye, &rotation),
            })
            .collect()
    }

    /// Some material follows the vertex colour (GL_COLOR_MATERIAL), and some mesh has colours.
    pub fn has_vertex_colors(&self) -> bool {
        let tracks = |m: &Material| {
            m.front.tracked.any() || m.back.as_ref().is_some_and(|b| b.tracked.any())
        };
        self.materials.iter().any(tracks) && self.vertex_colors().next().is_some()
    }

    /// The colours of all meshes' vertices.
    fn vertex_colors(&self) -> impl Iterator<Item = &[f64; 4]> {
        let meshes = self.objects.iter().filter_map(|o| match &o.geometry {
            Geometry::Mesh(mesh) => Some(mesh),
            Geometry::Shape(_) => None,
        });
        meshes.flat_map(|mesh| &mesh.colors)
    }

    /// Whether the rasterizer blends anything: the setting asks for it, and some object's material is transmissive.
    pub fn blends(&self) -> bool {
        let mut used = self.objects.iter().flat_map(|o| &o.materials);
        self.raster.transparency == Transparency::Blend
            && used.any(|m| self.materials[*m].optics.blend_alpha().is_some())
    }

    /// Some colour of a light, a material, a vertex or the light model is negative: sums run in f64, rounded once.
    pub fn has_negative_colors(&self) -> bool {
        let negative = |c: &Rgb| c.iter().any(|x| *x < 0.0);
        let material = |m: &gl::Material| {
            [&m.emission, &m.ambient, &m.diffuse, &m.specular]
                .into_iter()
                .any(negative)
        };
        let vertex = |c: &[f64; 4]| c[..3].iter().any(|x| *x < 0.0);
        negative(&self.light_model.ambient)
            || self.vertex_colors().any(vertex)
            || negative(&self.image.background)
            || self.lights.iter().any(|light| {
                let s = &light.source;
                [&s.ambient, &s.diffuse, &s.specular]
                    .into_iter()
                    .any(negative)
                    || s.attenuation.iter().any(|k| *k < 0.0)
            })
            || self.materials.iter().any(|m| {
                let optics = [&m.optics.reflection, &m.optics.transmission];
                material(&m.front)
                    || m.back.as_ref().is_some_and(material)
                    || optics.into_iter().any(negative)
            })
    }
}

fn to_eye(source: &gl::LightSource, eye: DVec3, rotation: &DMat3) -> gl::LightSource {
    let p = DVec4::from_array(source.position);
    // The eye is subtracted before rotating: (xyz - w eye) keeps what two large numbers have in common.
    let xyz = *rotation * (p.truncate() - p.w * eye);
    let spot = *rotation * DVec3::from_array(source.spot_direction);
    gl::LightSource {
        position: [xyz.x, xyz.y, xyz.z, p.w],
        spot_direction: spot.to_array(),
        ..source.clone()
    }
}
