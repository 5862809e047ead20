//! One number: f32 or f64.

use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

use super::elementary::Coefficients;
use super::{Lanes, Wide};

/// A scalar precision: f32 or f64. `--precision` picks one for the whole path.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialEq
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Sum
    + Coefficients
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Positive infinity.
    const INFINITY: Self;
    /// The largest finite number.
    const MAX: Self;
    /// The smallest positive normal number.
    const MIN_POSITIVE: Self;
    /// Unit roundoff u: half the distance from 1 to the next number.
    const ROUNDOFF: Self;
    /// 1.5 times 2 to the number of mantissa bits: adding it rounds a small number to an integer, which then stands in
    /// the low bits.
    const SHIFTER: Self;
    /// The command line's name of this precision.
    const NAME: &'static str;
    /// An unsigned integer of the same size, for masks.
    type Bits: Copy
        + Send
        + Sync
        + 'static
        + PartialEq
        + BitAnd<Output = Self::Bits>
        + BitOr<Output = Self::Bits>
        + Not<Output = Self::Bits>;
    /// No bit set.
    const NO_BITS: Self::Bits;
    /// Every bit set.
    const ALL_BITS: Self::Bits;
    /// One lane.
    type Single: Lanes<Scalar = Self>;
    /// The lanes of the SSE4.2 entry.
    type Sse42: Lanes<Scalar = Self>;
    /// The lanes of the AVX2 entry.
    type Avx2: Lanes<Scalar = Self>;
    /// The lanes of the AVX-512 entry.
    type Avx512: Lanes<Scalar = Self>;
    /// The lanes of the NEON entry.
    type Neon: Lanes<Scalar = Self>;
    /// From code generic over the precision into code that is compiled once for each, in the crate that has it.
    fn enter<F: Family>(input: F::Of<Self>) -> F::Output;
    /// Rounded once from f64.
    fn from_f64(x: f64) -> Self;
    /// Exact.
    fn to_f64(self) -> f64;
    /// Rounded once where the type is wider than f32.
    fn to_f32(self) -> f32;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller; the other one if one is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger; the other one if one is NaN.
    fn max(self, other: Self) -> Self;
    /// `self * b + c` with one rounding.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self * b + c` with one rounding, without asking the hardware for it (same bytes as [`Real::mul_add`]).
    fn mul_add_emulated(self, b: Self, c: Self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// For `x > 0` finite: (2^-e, 2^e) such that x 2^-e is near 1 and both factors are normal numbers.
    fn power_of_two_scale(self) -> (Self, Self);
    /// For `x > 0` normal: (m, k) with x = m 2^k and m in [sqrt(1/2), sqrt(2)).
    fn split_exponent(self) -> (Self, Self);
    /// `self * 2^k` where `shifted` = [`Real::SHIFTER`] + k, and the product must be a normal number.
    fn add_exponent(self, shifted: Self) -> Self;
    /// The bits.
    fn to_bits(self) -> Self::Bits;
    /// The number with these bits.
    fn from_bits(bits: Self::Bits) -> Self;
    /// The next number towards +infinity.
    fn next_up(self) -> Self;
    /// The next number towards -infinity.
    fn next_down(self) -> Self;
}

/// Work with one entry a precision, neither of them generic.
///
/// A generic function is compiled anew in every crate that calls it: the equation at all its widths costs half a minute
/// in each test. Behind [`Real::enter`] it is compiled once, with the library.
pub trait Family {
    /// The input at a precision.
    type Of<R: Real>;
    /// What the work answers.
    type Output;
    /// The work at f32.
    fn at_f32(input: Self::Of<f32>) -> Self::Output;
    /// The work at f64.
    fn at_f64(input: Self::Of<f64>) -> Self::Output;
}

macro_rules! real {
    ($t:ident, $bits:ident, $mantissa:expr, $bias:expr, $sqrt_half:expr, $emulated:path, $lanes128:expr, $entry:ident) => {
        impl Real for $t {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const INFINITY: Self = $t::INFINITY;
            const MAX: Self = $t::MAX;
            const MIN_POSITIVE: Self = $t::MIN_POSITIVE;
            const ROUNDOFF: Self = $t::EPSILON / 2.0;
            const SHIFTER: Self = (3u64 << ($mantissa - 1)) as $t;
            const NAME: &'static str = stringify!($t);
            type Bits = $bits;
            const NO_BITS: $bits = 0;
            const ALL_BITS: $bits = !0;
            fn enter<F: Family>(input: F::Of<Self>) -> F::Output {
                F::$entry(input)
            }
            type Single = Wide<$t, 1, false>;
            type Sse42 = Wide<$t, $lanes128, false>;
            type Avx2 = Wide<$t, { 2 * $lanes128 }, true>;
            type Avx512 = Wide<$t, { 4 * $lanes128 }, true>;
            type Neon = Wide<$t, $lanes128, true>;
            #[inline(always)]
            fn from_f64(x: f64) -> Self {
                x as $t
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.into()
            }
            #[inline(always)]
            fn to_f32(self) -> f32 {
                self as f32
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $t::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $t::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                $t::min(self, other)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                $t::max(self, other)
            }
            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                $t::mul_add(self, b, c)
            }
            #[inline(always)]
            fn mul_add_emulated(self, b: Self, c: Self) -> Self {
                $emulated(self, b, c)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $t::is_finite(self)
            }
            #[inline(always)]
            fn power_of_two_scale(self) -> (Self, Self) {
                let exponent = (self.to_bits() >> $mantissa).clamp(2, 2 * $bias - 2);
                let up = $t::from_bits(exponent << $mantissa);
                let down = $t::from_bits((2 * $bias - exponent) << $mantissa);
                (down, up)
            }
            #[inline(always)]
            fn split_exponent(self) -> (Self, Self) {
                // Counting exponents from sqrt(1/2) instead of 1 puts m around 1.
                let shifted = self
                    .to_bits()
                    .wrapping_add($t::to_bits(1.0).wrapping_sub($sqrt_half));
                let m = $t::from_bits((shifted & ((1 << $mantissa) - 1)).wrapping_add($sqrt_half));
                // The exponent as a number: or-ed into the mantissa of 2^mantissa, which is then taken away.
                let two_to_mantissa = (1u64 << $mantissa) as $t;
                let biased = $t::from_bits((shifted >> $mantissa) | two_to_mantissa.to_bits());
                (m, biased - (two_to_mantissa + $bias as $t))
            }
            #[inline(always)]
            fn add_exponent(self, shifted: Self) -> Self {
                $t::from_bits(self.to_bits().wrapping_add(shifted.to_bits() << $mantissa))
            }
            #[inline(always)]
            fn to_bits(self) -> $bits {
                $t::to_bits(self)
            }
            #[inline(always)]
            fn from_bits(bits: $bits) -> Self {
                $t::from_bits(bits)
            }
            #[inline(always)]
            fn next_up(self) -> Self {
                $t::next_up(self)
            }
            #[inline(always)]
            fn next_down(self) -> Self {
                $t::next_down(self)
            }
        }
    };
}
real!(
    f32,
    u32,
    23,
    127,
    0x3f35_04f3u32,
    fma_through_f64,
    4,
    at_f32
);
real!(
    f64,
    u64,
    52,
    1023,
    0x3fe6_a09e_667f_3bcdu64,
    f64::mul_add,
    2,
    at_f64
);

/// f32 fused multiply-add through f64: the product of two f32 is exact there, the sum is rounded to odd, and a number
/// rounded to odd with 29 bits to spare rounds to f32 as the exact sum would (Boldo and Melquiond 2008).
#[inline(always)]
fn fma_through_f64(a: f32, b: f32, c: f32) -> f32 {
    let product = f64::from(a) * f64::from(b);
    let addend = f64::from(c);
    let sum = product + addend;
    // two_sum: the exact error of the addition; NaN (no adjustment) where something is not finite.
    let virtual_addend = sum - product;
    let error = (product - (sum - virtual_addend)) + (addend - virtual_addend);
    // Where the sum is inexact and even, step to the odd neighbour on the side of the exact value.
    let bits = sum.to_bits();
    let inexact = error.abs() > 0.0; // false for NaN
    let away_from_zero = (error > 0.0) == (sum > 0.0);
    let step = if away_from_zero { 1 } else { u64::MAX };
    let even_inexact = inexact && bits & 1 == 0;
    f64::from_bits(bits.wrapping_add(if even_inexact { step } else { 0 })) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::elementary::tests::Random;

    /// Ties and near-ties on purpose: c is an odd multiple of half an ulp away from where the product lands.
    #[test]
    fn emulated_fma_is_one_rounding() {
        let mut random = Random(7);
        let check = |a: f32, b: f32, c: f32| {
            let expected = libm::fmaf(a, b, c);
            let found = fma_through_f64(a, b, c);
            assert!(
                expected.to_bits() == found.to_bits() || (expected.is_nan() && found.is_nan()),
                "{a:e} * {b:e} + {c:e}: expected {expected:e}, found {found:e}"
            );
        };
        for i in 0..200_000 {
            let mut number = |range: i32| {
                let mantissa = (random.next() >> 41) as f32 / (1u64 << 22) as f32 - 1.0;
                let power = (random.next() % (2 * range as u64 + 1)) as i32 - range;
                mantissa * libm::ldexpf(1.0, power)
            };
            let (a, b) = (number(20), number(20));
            let product = f64::from(a) * f64::from(b);
            check(a, b, number(60));
            // The sum lies just beside a tie of f32.
            let ulp = f64::from((product as f32).next_up()) - f64::from(product as f32);
            check(
                a,
                b,
                (ulp * 0.5 - (product - f64::from(product as f32))) as f32,
            );
            check(a, b, (ulp * 2f64.powi(i % 40 - 20)) as f32);
            // A product far below the ulp of a tie-shaped addend decides the rounding.
            check(
                number(2) * 1e-12,
                b * 1e-9,
                1.0 + f32::EPSILON * (i % 3) as f32,
            );
            check(a * 1e-20, b * 1e-20, number(4) * 1e-38); // subnormal results
        }
        check(f32::MAX, 2.0, -f32::MAX);
        check(f32::INFINITY, 0.0, 1.0);
        check(f32::MAX, f32::MAX, 1.0);
        check(-1.0, 1.0, 1.0);
        check(-0.0, 1.0, -0.0);
    }

    #[test]
    fn exponents_split_and_add() {
        for x in [1.0f32, 0.7, 0.71, 1.5, 3.0, 1e-30, 1e30, f32::MIN_POSITIVE] {
            let (m, k) = x.split_exponent();
            assert!((0.707..1.415).contains(&m), "{x}: {m}");
            assert_eq!(libm::ldexpf(m, k as i32), x);
            assert_eq!(m.add_exponent(f32::SHIFTER + k), x);
        }
        for x in [
            1.0f64,
            0.7,
            0.71,
            1.5,
            3.0,
            1e-300,
            1e300,
            f64::MIN_POSITIVE,
        ] {
            let (m, k) = x.split_exponent();
            assert!((0.707..1.415).contains(&m), "{x}: {m}");
            assert_eq!(m.add_exponent(f64::SHIFTER + k), x);
        }
    }
}
