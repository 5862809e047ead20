//! Small vectors over the lanes: unit vectors at any scale, and powers of cosines.

use crate::lanes::elementary::ln_near_one;
use crate::lanes::{Lanes, Mask, Real};

/// `v` as unit vectors and their lengths. Zero or non-finite vectors give zero.
///
/// Squares are safe for nearly every length; where some lane's is not, its components are first divided by the power
/// of two of the largest. The other lanes keep their scale, so no lane's bits depend on its neighbours.
#[inline(always)]
pub(super) fn unit_and_length<L: Lanes>(v: [L; 3]) -> ([L; 3], L) {
    let zero = L::splat(L::Scalar::ZERO);
    let one = L::splat(L::Scalar::ONE);
    let smallest = L::Scalar::MIN_POSITIVE.sqrt();
    let squared = dot3(v, v);
    let usual = squared.gt(L::splat(smallest)) & squared.lt(L::splat(L::Scalar::ONE / smallest));
    if usual.all() {
        let length = squared.sqrt();
        let inverse = one / length;
        return (v.map_lanes(inverse), length);
    }
    // Scale the unusual lanes; drop the vectors that have no direction.
    let largest = v[0].abs().max(v[1].abs()).max(v[2].abs());
    let most = L::splat(L::Scalar::MAX);
    let finite = v[0].abs().le(most) & v[1].abs().le(most) & v[2].abs().le(most);
    let valid = finite & largest.gt(zero);
    let (down, up) = L::select(valid, largest, one).power_of_two_scale();
    let (down, up) = (L::select(usual, one, down), L::select(usual, one, up));
    let scaled = [
        L::select(valid, v[0] * down, zero),
        L::select(valid, v[1] * down, zero),
        L::select(valid, v[2] * down, zero),
    ];
    let length = dot3(scaled, scaled).sqrt();
    let inverse = L::select(valid, one / length, zero);
    (scaled.map_lanes(inverse), (length * up).min(most))
}

/// Multiplies the three components by one number each lane (closures given to `array::map` are not inlined).
trait MapLanes<L> {
    fn map_lanes(self, factor: L) -> Self;
}
impl<L: Lanes> MapLanes<L> for [L; 3] {
    #[inline(always)]
    fn map_lanes(self, factor: L) -> Self {
        [self[0] * factor, self[1] * factor, self[2] * factor]
    }
}

/// Dot product with two fused steps.
#[inline(always)]
pub(super) fn dot3<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// |a x b|^2, each component with one fused step.
#[inline(always)]
pub(super) fn cross_squared<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    let x = a[1].mul_add(b[2], -(a[2] * b[1]));
    let y = a[2].mul_add(b[0], -(a[0] * b[2]));
    let z = a[0].mul_add(b[1], -(a[1] * b[0]));
    dot3([x, y, z], [x, y, z])
}

/// cosine^exponent, given squared sine and squared cosine: exp(exponent/2 ln(1 - sin^2)) near the peak, where the
/// cosine has lost the angle, and exp(exponent/2 ln(cos^2)) elsewhere. The cosine must be positive.
#[inline(always)]
pub(super) fn ln_cosine<L: Lanes>(sin_squared: L, cos_squared: L) -> L {
    let half = L::Scalar::ONE / (L::Scalar::ONE + L::Scalar::ONE);
    let near = sin_squared.le(L::splat(half * half));
    let cos_squared = cos_squared.max(L::splat(L::Scalar::MIN_POSITIVE));
    L::splat(half) * ln_near_one::<L>(near, sin_squared, cos_squared)
}

/// 0^exponent for exponents other than 0.
#[inline(always)]
pub(super) fn zero_to<R: Real>(exponent: R) -> R {
    if exponent < R::ZERO {
        R::INFINITY
    } else {
        R::ZERO
    }
}

/// A number rounded once to a finite number: infinity counts as the largest, NaN and -0 as 0.
pub(super) fn finite<R: Real>(x: f64) -> R {
    let most = R::MAX.to_f64();
    if x.is_nan() {
        return R::ZERO;
    }
    R::from_f64(x.clamp(-most, most)) + R::ZERO
}
