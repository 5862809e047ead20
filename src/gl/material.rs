//! GL materials and the light model.

use super::{RangeViolation, Tracked};
use crate::math::color::Rgb;

/// A material, as glMaterial sets it (GL 2.1 table 2.10).
///
/// ```
/// let material = rastray::gl::Material::default();
/// assert_eq!(material.ambient, [0.2; 3]);
/// assert_eq!(material.diffuse, [0.8; 3]);
/// assert_eq!(material.shininess, 0.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Emitted colour; lights nothing else. Default black.
    pub emission: Rgb,
    /// Ambient reflectance. Default 0.2.
    pub ambient: Rgb,
    /// Diffuse reflectance. Default 0.8.
    pub diffuse: Rgb,
    /// Specular reflectance. Default black.
    pub specular: Rgb,
    /// Alpha of the diffuse colour, the only alpha that GL uses. Default 1.
    pub alpha: f64,
    /// Specular exponent. Default 0; GL accepts 0..128.
    pub shininess: f64,
    /// The terms that vertex colours overwrite (GL_COLOR_MATERIAL). Default none.
    pub tracked: Tracked,
}

impl Material {
    /// What GL would refuse of these values.
    pub fn range_violations(&self) -> Vec<RangeViolation> {
        if (0.0..=128.0).contains(&self.shininess) {
            return Vec::new();
        }
        let value = self.shininess;
        vec![RangeViolation {
            parameter: "shininess",
            value,
            legal: "0 to 128",
        }]
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            emission: [0.0; 3],
            ambient: [0.2; 3],
            diffuse: [0.8; 3],
            specular: [0.0; 3],
            alpha: 1.0,
            shininess: 0.0,
            tracked: Tracked::default(),
        }
    }
}

/// Where the specular term goes (GL_LIGHT_MODEL_COLOR_CONTROL).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorControl {
    /// One colour, clamped as a whole (the default).
    #[default]
    Single,
    /// Specular is a colour of its own: both are clamped, added, and clamped again.
    SeparateSpecular,
}

impl ColorControl {
    /// The one table of names: command line, scene file and reports; the first name of a value is the one to print.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("single", Self::Single),
        ("separate", Self::SeparateSpecular),
    ];
}

/// Which vectors the specular term compares.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpecularModel {
    /// (n.h)^s with the half vector h, OpenGL's form (Blinn).
    #[default]
    HalfVector,
    /// (V.R)^n with the mirrored light direction R, the lecture's form (Phong).
    Reflection,
}

impl SpecularModel {
    /// The one table of names: command line, scene file and reports; the first name of a value is the one to print.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("half-vector", Self::HalfVector),
        ("reflection", Self::Reflection),
        ("blinn", Self::HalfVector),
        ("phong", Self::Reflection),
    ];
}

/// How a triangle gets its colour (GL 2.1 section 2.14.7; per-fragment is this program's addition).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShadeModel {
    /// One evaluation at the provoking vertex, the last of each triangle.
    Flat,
    /// Per vertex, clamped, interpolated (GL_SMOOTH; the default).
    #[default]
    Gouraud,
    /// Per fragment with interpolated position and renormalised normal ("Phong shading").
    Phong,
}

impl ShadeModel {
    /// The one table of names: command line, scene file and reports; the first name of a value is the one to print.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("flat", Self::Flat),
        ("gouraud", Self::Gouraud),
        ("phong", Self::Phong),
        ("per-vertex", Self::Gouraud),
        ("per-pixel", Self::Phong),
    ];
}

/// The light model (GL 2.1 table 2.10, and GL_NORMALIZE and GL_RESCALE_NORMAL of section 2.11.3).
#[derive(Clone, Debug, PartialEq)]
pub struct LightModel {
    /// Scene ambient colour. Default 0.2.
    pub ambient: Rgb,
    /// The viewer is at the eye (rastray's default), not infinitely far along +z (GL's).
    pub local_viewer: bool,
    /// Back faces are lit with the flipped normal and the back material. Default false.
    pub two_sided: bool,
    /// Where specular goes. Default single colour.
    pub color_control: ColorControl,
    /// The specular form. Default half vector.
    pub specular_model: SpecularModel,
    /// Normals are made unit length after the transform (rastray's default; GL's is off).
    pub normalize: bool,
    /// Normals are scaled by the modelview's uniform scale. Default false.
    pub rescale_normal: bool,
}

impl LightModel {
    /// GL's own defaults: infinite viewer, normals taken as they come.
    pub fn gl_default() -> Self {
        Self {
            local_viewer: false,
            normalize: false,
            ..Self::default()
        }
    }
}

impl Default for LightModel {
    fn default() -> Self {
        Self {
            ambient: [0.2; 3],
            local_viewer: true,
            two_sided: false,
            color_control: ColorControl::Single,
            specular_model: SpecularModel::HalfVector,
            normalize: true,
            rescale_normal: false,
        }
    }
}
