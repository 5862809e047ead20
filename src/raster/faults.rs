//! Mistakes that people make in a rasterizer: what `crate::check` holds pictures against.
//!
//! None unless asked for ([`super::Plan::with_faults`]); then asked once a sample, where its weights are known.
//! A right picture pays two tests of a flag a sample: 0.14 % of the instructions of `render whitted --shading phong` (`valgrind
//! --tool=callgrind` by source line, 2026-12). A type parameter would compile the rasterizer twice to save that.

use crate::lighting;

/// Mistakes of a rasterizer; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// Mistakes in the lighting equation.
    pub lighting: lighting::Faults,
    /// Attributes are interpolated with the weights of the window: the division by w is left out (GL 2.1 section 3.5.1).
    pub affine: bool,
    /// Per-fragment normals keep the length that interpolation leaves.
    pub normals_unnormalized: bool,
}
