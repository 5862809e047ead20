//! OpenGL fixed-function state in API shape: light sources, materials, the light model, with names, defaults and
//! ranges of the GL 2.1 specification (section 2.14.1, tables 2.10 and 2.11). No arithmetic stands here.

mod color_material;
mod light;
mod material;

pub use color_material::{CURRENT_COLOR, ColorMaterial, ColorMaterialMode, Face, Tracked};
pub use light::{LightSource, RangeViolation};
pub use material::{ColorControl, LightModel, Material, ShadeModel, SpecularModel};
