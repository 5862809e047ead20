//! Spaces, vectors, transforms and colours: the words that every other module uses.
//!
//! | space | handedness, range | where |
//! | - | - | - |
//! | object | right-handed | meshes and shapes as written |
//! | world | right-handed | scene file, BVH |
//! | eye | right-handed, camera at the origin looking down -z, y up | lighting |
//! | clip | x, y, z, w; inside where -w <= x, y, z <= w | near clipping |
//! | normalized device (ndc) | -1..1, z = -1 at near | after the division by w |
//! | pixel frame | (0,0) = top-left corner of the top-left pixel, y down, centres at +0.5 | rasterizer, files, command line |
//!
//! GL's bottom-left window coordinates appear only in GL-facing code. Matrices are named `b_from_a`; points and
//! vectors end in the name of their space. Scene data and matrices are f64; renderers round once to their precision.

pub mod color;
mod each;
pub mod float;
pub mod transform;

pub(crate) use each::Each;
pub use glam::{DAffine3, DMat3, DMat4, DVec2, DVec3, DVec4};
