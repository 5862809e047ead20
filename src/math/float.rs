//! Error-aware arithmetic: the toolbox of the numerics guide.
//!
//! No absolute epsilon stands here: bounds come from the operands.

use crate::lanes::Real;

/// `v` scaled to unit length, and its length; zero or non-finite vectors give the zero vector and length 0.
///
/// The largest component is first divided by its own power of two, so that no square over- or underflows.
pub fn normalize<R: Real>(v: [R; 3]) -> ([R; 3], R) {
    let largest = v[0].abs().max(v[1].abs()).max(v[2].abs());
    if !(largest > R::ZERO && largest < R::INFINITY) {
        return ([R::ZERO; 3], R::ZERO);
    }
    let (down, up) = largest.power_of_two_scale();
    let s = v.map(|x| x * down);
    let length = dot(s, s).sqrt();
    (s.map(|x| x / length), length * up)
}

/// Dot product, plain left-to-right sum.
pub fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
