//! Mistakes that people make in a rasterizer: what `crate::check` holds pictures against.
//!
//! None unless asked for ([`super::Plan::with_faults`]); then asked once a sample, where its weights are known.

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
