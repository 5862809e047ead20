//! The tables of the scene file's keys: the one list that the reader, its advice and the JSON Schema share.
//!
//! A key has a kind, which says what values are legal, a default in words or JSON, and a line for editors. Sections are
//! those of the scene file (DESIGN, section 2).

use crate::gl;
use crate::sampling::{MAX_SAMPLES, Pattern};
use crate::scene::{Cull, Curve, Fresnel, FrontFace, LightSpace, Shadow, Tir, Transparency};

/// Largest width or height of a picture.
pub const MAX_SIDE: u32 = 16384;
/// Largest number of pixels of a picture.
pub const MAX_PIXELS: u64 = 1 << 27;
/// Largest number of triangles that the levels stated in one file may ask for.
pub const MAX_TESSELLATED: u64 = 1 << 24;
/// Largest number of triangles that the meshes of a scene have together, each object's counted.
pub const MAX_MESH_TRIANGLES: u64 = 1 << 27;
/// Largest number of tiles along one side of a patch.
pub const MAX_TILES: u32 = 4096;
/// Largest number of Bezier patches of an object.
pub const MAX_PATCHES: u32 = 1 << 16;
/// Largest number of their control points.
pub const MAX_PATCH_POINTS: u32 = 1 << 20;
/// Largest priority of a solid, and smallest with a minus sign.
pub const MAX_PRIORITY: i32 = 1_000_000;
/// Deepest recursion that a file may ask for.
pub const MAX_DEPTH: u32 = 1 << 20;

/// Legal numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Range {
    Any,
    /// x >= the bound.
    AtLeast(f64),
    /// x > the bound.
    Above(f64),
    /// Both ends included.
    Within(f64, f64),
    /// Both ends excluded.
    Between(f64, f64),
}

impl Range {
    /// Whether a number is legal; NaN never is.
    pub(crate) fn holds(self, x: f64) -> bool {
        match self {
            Self::Any => x.is_finite(),
            Self::AtLeast(low) => x >= low,
            Self::Above(low) => x > low,
            Self::Within(low, high) => x >= low && x <= high,
            Self::Between(low, high) => x > low && x < high,
        }
    }

    /// What an error message says was expected.
    pub(crate) fn words(self) -> String {
        match self {
            Self::Any => "a number".into(),
            Self::AtLeast(low) => format!("a number, {low} or more"),
            Self::Above(low) => format!("a number above {low}"),
            Self::Within(low, high) => format!("a number from {low} to {high}"),
            Self::Between(low, high) => {
                format!("a number between {low} and {high}, both excluded")
            }
        }
    }
}

/// What a key holds.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    Number(Range),
    Integer(u32, u32),
    /// A whole number that may be negative.
    Signed(i32, i32),
    Bool,
    Text,
    /// One of some names.
    Choice(fn() -> Vec<&'static str>),
    /// Sub-pixel bits: 8 or 12 (or "exact", which is refused with a reason).
    Snap,
    /// A number (grey) or [r, g, b].
    Color,
    /// A colour, or "K_S".
    Weight,
    /// [x, y, z].
    Vector,
    /// [x, y, z] or [x, y, z, w].
    Position,
    /// [a, b], each in 0..1.
    DepthRange,
    /// A number above 0, or [w, d].
    Size,
    /// A number above 0, or [x, y, z] of such.
    BoxSize,
    /// A number other than 0, or [x, y, z] of such.
    Scale,
    /// { axis, degrees }.
    Rotation,
    /// A whole number, or two.
    Tiles,
    /// Lists of numbers, flat or nested: points, normals, texture coordinates.
    Numbers,
    /// Four points.
    Corners,
    /// Points [radius, height].
    Profile,
    /// Vertex numbers, flat triples or nested faces.
    Indices,
    /// Bezier patches of sixteen point numbers, or the name of a file.
    Patches,
    /// A list of names.
    Names,
    /// Sixteen numbers, or four rows of four.
    Matrix,
    /// A list of steps.
    Transform,
    /// The back face's material.
    Back,
    /// true, false, or { enabled, face, mode }.
    ColorMaterial,
    /// Known to DESIGN, not to this version: always an error with a reason.
    Unsupported(&'static str),
}

/// One key of a section.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KeyInfo {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    /// As JSON, for the schema; empty where the default is computed.
    pub(crate) default: &'static str,
    /// One line for editors.
    pub(crate) doc: &'static str,
}

/// A row of a table.
const fn key(name: &'static str, kind: Kind, default: &'static str, doc: &'static str) -> KeyInfo {
    KeyInfo {
        name,
        kind,
        default,
        doc,
    }
}

/// The names of a table, in its order.
fn names<T>(table: &[(&'static str, T)]) -> Vec<&'static str> {
    table.iter().map(|(name, _)| *name).collect()
}

/// How `convention` may be spelt.
pub(crate) const CONVENTIONS: &[(&str, bool)] = &[("opengl", false), ("lecture", true)];

/// Keys and sections at the top of the file.
pub(crate) const TOP: &[&str] = &[
    "convention",
    "include",
    "image",
    "camera",
    "light_model",
    "raster",
    "trace",
    "light",
    "material",
    "object",
];

/// Which section a key without one most likely belongs to.
pub(crate) const SECTIONS: &[(&str, &[KeyInfo])] = &[
    ("[image]", IMAGE),
    ("[camera]", CAMERA),
    ("[light_model]", LIGHT_MODEL),
    ("[raster]", RASTER),
    ("[trace]", TRACE),
    ("[light.NAME]", LIGHT),
    ("[material.NAME]", SURFACE),
    ("[material.NAME]", MATERIAL),
    ("[object.NAME]", OBJECT),
];

/// `convention`.
pub(crate) const CONVENTION: KeyInfo = key(
    "convention",
    Kind::Choice(|| names(CONVENTIONS)),
    "\"opengl\"",
    "\"lecture\" sets specular_model = \"reflection\" and the mirror weight of every material to K_S, where they are not stated",
);

/// `include`.
pub(crate) const INCLUDE: KeyInfo = key(
    "include",
    Kind::Names,
    "",
    "Files whose materials this file uses, their paths relative to it",
);

/// `[image]`.
#[rustfmt::skip] // a table
pub(crate) const IMAGE: &[KeyInfo] = &[
    key("width", Kind::Integer(1, MAX_SIDE), "640", "Width in pixels"),
    key("height", Kind::Integer(1, MAX_SIDE), "480", "Height in pixels"),
    key("background", Kind::Color, "0", "Colour where nothing is hit; unlit"),
    key("samples", Kind::Integer(1, MAX_SAMPLES), "1", "Samples a pixel"),
    key("pattern", Kind::Choice(|| names(Pattern::NAMES)), "\"grid\"", "How the samples of a pixel are spread"),
    key("seed", Kind::Integer(0, u32::MAX), "0", "Other places for the jitter"),
];

/// `[camera]`.
#[rustfmt::skip] // a table
pub(crate) const CAMERA: &[KeyInfo] = &[
    key("eye", Kind::Vector, "", "Eye point, world space; fitted to the scene where omitted"),
    key("target", Kind::Vector, "", "The point looked at; the middle of the scene where omitted"),
    key("up", Kind::Vector, "[0, 1, 0]", "Upward direction, not parallel to the view"),
    key("fovy", Kind::Number(Range::Between(0.0, 180.0)), "45", "Full vertical angle of view in degrees"),
    key("near", Kind::Number(Range::Above(0.0)), "", "Near distance; fitted to the scene where omitted"),
    key("far", Kind::Number(Range::Above(0.0)), "", "Far distance; infinite where omitted"),
    key("orthographic", Kind::Number(Range::Above(0.0)), "", "Parallel view of this height in scene units, instead of fovy"),
];

/// `[light_model]`.
#[rustfmt::skip] // a table
pub(crate) const LIGHT_MODEL: &[KeyInfo] = &[
    key("ambient", Kind::Color, "0.2", "Ambient light of the whole scene"),
    key("local_viewer", Kind::Bool, "true", "The viewer is at the eye, not infinitely far along +z"),
    key("two_sided", Kind::Bool, "false", "Back faces are lit with the flipped normal and the back material"),
    key("color_control", Kind::Choice(|| names(gl::ColorControl::NAMES)), "\"single\"", "Whether specular is clamped as a colour of its own"),
    key("specular_model", Kind::Choice(|| names(gl::SpecularModel::NAMES)), "\"half-vector\"", "(n.h)^s as OpenGL, or (V.R)^n as the lecture"),
    key("normalize", Kind::Bool, "true", "Normals are made unit length after the transform"),
    key("rescale_normal", Kind::Bool, "false", "Normals are scaled by the transform's uniform scale"),
    key("color_material", Kind::ColorMaterial, "false", "Vertex colours overwrite material terms (white where a mesh has none): true, or { face, mode }"),
];

/// The table form of `color_material`.
#[rustfmt::skip] // a table
pub(crate) const COLOR_MATERIAL: &[KeyInfo] = &[
    key("enabled", Kind::Bool, "true", "Whether vertex colours are used"),
    key("face", Kind::Choice(|| names(gl::Face::NAMES)), "\"front_and_back\"", "The sides whose material follows"),
    key("mode", Kind::Choice(|| names(gl::ColorMaterialMode::NAMES)), "\"ambient_and_diffuse\"", "The terms that follow"),
];

/// `[raster]`.
#[rustfmt::skip] // a table
pub(crate) const RASTER: &[KeyInfo] = &[
    key("shading", Kind::Choice(|| names(gl::ShadeModel::NAMES)), "\"gouraud\"", "How a triangle gets its colour"),
    key("cull", Kind::Choice(|| names(Cull::NAMES)), "\"none\"", "Which triangles are dropped by facing"),
    key("front_face", Kind::Choice(|| names(FrontFace::NAMES)), "\"ccw\"", "Which winding is the front"),
    key("depth_range", Kind::DepthRange, "[0, 1]", "Depth of the near and the far plane"),
    key("depth_test", Kind::Bool, "true", "The nearest surface shows; false: the last one drawn"),
    key("snap", Kind::Snap, "8", "Sub-pixel bits that vertices are rounded to: 8, 12, or \"exact\" for none"),
    key("transparency", Kind::Choice(|| names(Transparency::NAMES)), "\"opaque\"", "How the rasterizer draws transmissive surfaces; blend: with alpha = 1 - luminance(transmission), in file order"),
];

/// `[trace]`.
#[rustfmt::skip] // a table
pub(crate) const TRACE: &[KeyInfo] = &[
    key("depth", Kind::Integer(0, MAX_DEPTH), "6", "Generations of secondary rays"),
    key("shadow", Kind::Choice(|| names(Shadow::NAMES)), "\"opaque\"", "What blocks a shadow ray"),
    key("tir", Kind::Choice(|| names(Tir::NAMES)), "\"none\"", "What total internal reflection leaves"),
    key("weight_cutoff", Kind::Number(Range::AtLeast(0.0)), "0", "A branch whose weight is below this in every channel is dropped"),
];

/// `[light.NAME]`.
#[rustfmt::skip] // a table
pub(crate) const LIGHT: &[KeyInfo] = &[
    key("position", Kind::Position, "", "[x, y, z], or [x, y, z, w] as glLight takes it"),
    key("direction", Kind::Vector, "", "The way a directional light travels, instead of a position"),
    key("space", Kind::Choice(|| names(LightSpace::NAMES)), "\"world\"", "The space of position, direction and spot_direction"),
    key("enabled", Kind::Bool, "true", "A disabled light takes part in nothing"),
    key("ambient", Kind::Color, "0", "Ambient colour; attenuated, never shadowed"),
    key("diffuse", Kind::Color, "1", "Diffuse colour"),
    key("specular", Kind::Color, "", "Specular colour; the diffuse colour where omitted"),
    key("attenuation", Kind::Vector, "[1, 0, 0]", "Constant, linear and quadratic attenuation"),
    key("spot_direction", Kind::Vector, "[0, 0, -1]", "Axis of the spot cone"),
    key("spot_exponent", Kind::Number(Range::AtLeast(0.0)), "0", "Falloff inside the spot cone"),
    key("spot_cutoff", Kind::Number(Range::Within(0.0, 180.0)), "180", "Half angle of the spot cone in degrees; 180 = no cone"),
];

/// The GL part of a material: front, and the whole of `back`.
#[rustfmt::skip] // a table
pub(crate) const SURFACE: &[KeyInfo] = &[
    key("color", Kind::Color, "", "Ambient and diffuse together"),
    key("emission", Kind::Color, "0", "Emitted colour; lights nothing else"),
    key("ambient", Kind::Color, "0.2", "Ambient reflectance"),
    key("diffuse", Kind::Color, "0.8", "Diffuse reflectance"),
    key("specular", Kind::Color, "0", "Specular reflectance, K_S"),
    key("shininess", Kind::Number(Range::AtLeast(0.0)), "0", "Specular exponent"),
];

/// The rest of `[material.NAME]`.
#[rustfmt::skip] // a table
pub(crate) const MATERIAL: &[KeyInfo] = &[
    key("back", Kind::Back, "", "GL material of back faces under two-sided lighting"),
    key("reflection", Kind::Weight, "0", "Mirror weight, or \"K_S\" to use the specular reflectance"),
    key("transmission", Kind::Color, "0", "K_T, the weight of the transmitted ray, once per interface"),
    key("ior", Kind::Number(Range::Above(0.0)), "1", "Index of refraction of the inside"),
    key("thin", Kind::Bool, "false", "A thin surface: transmitted rays go straight on"),
    key("fresnel", Kind::Choice(|| names(Fresnel::NAMES)), "\"off\"", "Whether Fresnel's equations share the weights"),
    key("color_material", Kind::ColorMaterial, "", "The same for this material alone, instead of light_model.color_material"),
    key("texture", Kind::Unsupported("textures are not in this version"), "", "Not in this version"),
];

/// Keys of every object.
#[rustfmt::skip] // a table
pub(crate) const OBJECT: &[KeyInfo] = &[
    key("shape", Kind::Choice(|| SHAPES.iter().map(|s| s.0).collect()), "", "An exact shape"),
    key("mesh", Kind::Text, "", "An OBJ file, its path relative to this file"),
    key("instance", Kind::Text, "", "Another object, further up: the same form once more; its transform comes first, its materials hold unless others are stated"),
    key("material", Kind::Text, "", "Name of its material; OpenGL's default material where omitted"),
    key("materials", Kind::Names, "", "Names of its materials, taken in turn by tiles or by the mesh's own materials"),
    key("transform", Kind::Transform, "[]", "Steps from object to world space, applied in the order written"),
    key("priority", Kind::Signed(-MAX_PRIORITY, MAX_PRIORITY), "0", "Of clear solids that overlap, the one with the higher number is there, and surfaces inside it are not; equal numbers: the one entered last"),
];

/// Tessellation, for the shapes that have one.
const TESSELLATION: KeyInfo = key(
    "tessellation",
    Kind::Integer(1, 4096),
    "",
    "Slices of a full turn (at least 3) of a round shape, or cells a side of a flat one",
);

/// `smooth`, for meshes.
const SMOOTH: KeyInfo = key(
    "smooth",
    Kind::Bool,
    "",
    "true: area-weighted vertex normals; false: flat; omitted: the mesh's own",
);

/// Keys of `mesh = "file"`.
pub(crate) const MESH: &[KeyInfo] = &[SMOOTH];

/// Keys of an inline mesh.
#[rustfmt::skip] // a table
pub(crate) const INLINE: &[KeyInfo] = &[
    key("positions", Kind::Numbers, "", "Vertex positions: [x, y, z, ...] or [[x, y, z], ...]"),
    key("normals", Kind::Numbers, "", "Vertex normals, one a position"),
    key("texcoords", Kind::Numbers, "", "Texture coordinates [u, v], one a position"),
    key("colors", Kind::Numbers, "", "Vertex colours [r, g, b] or [r, g, b, a], one a position, for color_material"),
    key("indices", Kind::Indices, "", "Vertex numbers from 0: triangles [a, b, c, ...], or faces [[a, b, c], ...]; every three positions where omitted"),
    SMOOTH,
];

/// A shape's name and its own keys.
#[rustfmt::skip] // a table
pub(crate) const SHAPES: &[(&str, &[KeyInfo])] = &[
    (
        "sphere",
        &[
            key("center", Kind::Vector, "[0, 0, 0]", "Centre"),
            key("radius", Kind::Number(Range::Above(0.0)), "1", "Radius"),
            TESSELLATION,
        ],
    ),
    (
        "plane",
        &[
            key("center", Kind::Vector, "[0, 0, 0]", "Centre of the finite patch"),
            key("normal", Kind::Vector, "[0, 1, 0]", "Its front side"),
            key("size", Kind::Size, "10", "Side lengths: a number or [width, depth]"),
            TESSELLATION,
        ],
    ),
    (
        "quad",
        &[
            key("points", Kind::Corners, "", "Four corners in turn, planar or not; counter-clockwise seen from the front"),
            key("corner", Kind::Vector, "", "A corner, with edge_u and edge_v instead of points"),
            key("edge_u", Kind::Vector, "", "The side from the corner that u runs along"),
            key("edge_v", Kind::Vector, "", "The side from the corner that v runs along; front = edge_u x edge_v"),
            TESSELLATION,
        ],
    ),
    (
        "disk",
        &[
            key("center", Kind::Vector, "[0, 0, 0]", "Centre"),
            key("normal", Kind::Vector, "[0, 1, 0]", "Its front side"),
            key("radius", Kind::Number(Range::Above(0.0)), "1", "Radius"),
            TESSELLATION,
        ],
    ),
    (
        "box",
        &[
            key("min", Kind::Vector, "", "Lowest corner, with max"),
            key("max", Kind::Vector, "", "Highest corner"),
            key("center", Kind::Vector, "[0, 0, 0]", "Centre, instead of min and max"),
            key("size", Kind::BoxSize, "1", "Side lengths about the centre: a number or [x, y, z]"),
            TESSELLATION,
        ],
    ),
    (
        "cylinder",
        &[
            key("base", Kind::Vector, "[0, 0, 0]", "Middle of one end"),
            key("top", Kind::Vector, "[0, 1, 0]", "Middle of the other end"),
            key("radius", Kind::Number(Range::Above(0.0)), "1", "Radius"),
            key("caps", Kind::Bool, "true", "Both ends are closed; false: a tube, its front outside"),
            TESSELLATION,
        ],
    ),
    (
        "cone",
        &[
            key("base", Kind::Vector, "[0, 0, 0]", "Middle of the round end"),
            key("apex", Kind::Vector, "[0, 1, 0]", "The tip"),
            key("radius", Kind::Number(Range::Above(0.0)), "1", "Radius of the round end"),
            key("cap", Kind::Bool, "true", "The round end is closed; false: a funnel, its front outside"),
            TESSELLATION,
        ],
    ),
    (
        "torus",
        &[
            key("center", Kind::Vector, "[0, 0, 0]", "Centre"),
            key("axis", Kind::Vector, "[0, 1, 0]", "Axis of the ring"),
            key("major_radius", Kind::Number(Range::Above(0.0)), "1", "From the centre to the middle of the tube"),
            key("minor_radius", Kind::Number(Range::Above(0.0)), "0.25", "Radius of the tube, below major_radius"),
            TESSELLATION,
        ],
    ),
    (
        "revolution",
        &[
            key("base", Kind::Vector, "[0, 0, 0]", "The point of the axis where heights are 0"),
            key("axis", Kind::Vector, "[0, 1, 0]", "The way heights count; its length does not matter"),
            key("profile", Kind::Profile, "", "Points [radius, height]; upwards = front outside. Both ends on the axis, or the first point again at the end: a solid"),
            key("curve", Kind::Choice(|| names(Curve::NAMES)), "\"polyline\"", "How they are joined: straight; smooth through all points, creased at one written twice; or point, control, control, point ..."),
            TESSELLATION,
        ],
    ),
    (
        "bezier",
        &[
            key("points", Kind::Numbers, "", "Control points: [[x, y, z], ...]"),
            key("patches", Kind::Patches, "", "Bicubic patches: [[16 point numbers from 0], ...], four rows (v) of four (u), front = du x dv; or a file, its path relative to this file"),
            TESSELLATION,
        ],
    ),
    (
        "teapot",
        &[
            key("base", Kind::Vector, "[0, 0, 0]", "Middle of its bottom; its spout points along +x"),
            key("radius", Kind::Number(Range::Above(0.0)), "1", "Radius of its body"),
            key("height", Kind::Number(Range::Above(0.0)), "", "From the bottom to the top of the knob, instead of radius: 1.575 times that"),
            TESSELLATION,
        ],
    ),
    (
        "checkered floor",
        &[
            key("center", Kind::Vector, "[0, 0, 0]", "Centre; the floor faces +y"),
            key("size", Kind::Size, "10", "Side lengths: a number or [width, depth]"),
            key("tiles", Kind::Tiles, "10", "Tiles a side: a number or [along x, along z]"),
            TESSELLATION,
        ],
    ),
];

/// The steps of a transform.
#[rustfmt::skip] // a table
pub(crate) const STEPS: &[KeyInfo] = &[
    key("translate", Kind::Vector, "", "Moves by [x, y, z]"),
    key("rotate", Kind::Rotation, "", "{ axis = [x, y, z], degrees = number }, counter-clockwise about the axis"),
    key("scale", Kind::Scale, "", "A number, or [x, y, z]; negative mirrors"),
    key("matrix", Kind::Matrix, "", "Four rows of four numbers, or 16 numbers row by row; column vectors, so the translation stands last in each row"),
];

/// The parts of a rotation.
#[rustfmt::skip] // a table
pub(crate) const ROTATE: &[KeyInfo] = &[
    key("axis", Kind::Vector, "", "Axis through the origin"),
    key("degrees", Kind::Number(Range::Any), "", "Angle, counter-clockwise seen against the axis"),
];

/// Whether the key of an override (`trace.depth`, `object.floor.tiles`) holds whole numbers.
///
/// ```
/// assert!(rastray::import::keys::wants_whole("trace.depth"));
/// assert!(!rastray::import::keys::wants_whole("material.red.shininess"));
/// ```
pub fn wants_whole(path: &str) -> bool {
    let mut parts = path.split('.').map(str::trim);
    let (section, key) = (parts.next().unwrap_or(""), parts.next_back().unwrap_or(""));
    let whole = |k: &KeyInfo| {
        k.name == key
            && matches!(
                k.kind,
                Kind::Integer(..) | Kind::Signed(..) | Kind::Tiles | Kind::Snap
            )
    };
    let sections = SECTIONS
        .iter()
        .filter(|(name, _)| name.trim_start_matches('[').split(['.', ']']).next() == Some(section));
    let shapes = SHAPES.iter().filter(|_| section == "object");
    sections
        .chain(shapes)
        .any(|(_, keys)| keys.iter().any(whole))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_section_names_a_key_twice() {
        let mut sections: Vec<Vec<KeyInfo>> = [
            IMAGE,
            CAMERA,
            LIGHT_MODEL,
            RASTER,
            TRACE,
            LIGHT,
            STEPS,
            ROTATE,
        ]
        .map(<[_]>::to_vec)
        .to_vec();
        sections.push([SURFACE, MATERIAL].concat());
        sections.push([OBJECT, MESH].concat());
        sections.push([OBJECT, INLINE].concat());
        sections.extend(SHAPES.iter().map(|s| [OBJECT, s.1].concat()));
        for section in sections {
            let mut names: Vec<_> = section.iter().map(|k| k.name).collect();
            names.sort_unstable();
            let count = names.len();
            names.dedup();
            assert_eq!(names.len(), count, "{names:?}");
        }
    }
}
