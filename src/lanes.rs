//! Number types that the equation and the renderers are written over.
use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

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
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Positive infinity.
    const INFINITY: Self;
    /// Unit roundoff u: half the distance from 1 to the next number.
    const ROUNDOFF: Self;
    /// The command line's name of this precision.
    const NAME: &'static str;
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
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// For `x > 0` finite: (2^-e, 2^e) such that x 2^-e is near 1 and both factors are normal numbers.
    fn power_of_two_scale(self) -> (Self, Self);
    /// The next number towards +infinity.
    fn next_up(self) -> Self;
    /// The next number towards -infinity.
    fn next_down(self) -> Self;
}

macro_rules! real {
    ($t:ident, $bits:ident, $mantissa:expr, $bias:expr) => {
        impl Real for $t {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const INFINITY: Self = $t::INFINITY;
            const ROUNDOFF: Self = $t::EPSILON / 2.0;
            const NAME: &'static str = stringify!($t);
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
real!(f32, u32, 23, 127);
real!(f64, u64, 52, 1023);

/// An instruction set that the lanes can be entered at. The bytes of a picture do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Isa {
    /// One lane, no vector instructions asked for.
    Scalar,
    /// x86-64 SSE4.2: 4 lanes of f32.
    Sse42,
    /// x86-64 AVX2 and FMA: 8 lanes of f32.
    Avx2,
    /// x86-64 AVX-512 (Ice Lake's set): 16 lanes of f32.
    Avx512,
    /// AArch64 NEON: 4 lanes of f32.
    Neon,
}

impl Isa {
    /// The best instruction set of this machine.
    pub fn detect() -> Self {
        Self::Scalar
    }

    /// Every instruction set that this machine can run, slowest first.
    pub fn available() -> Vec<Self> {
        vec![Self::Scalar]
    }

    /// The command line's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Sse42 => "sse4.2",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Neon => "neon",
        }
    }

    /// The instruction set of a name, whether or not this machine has it.
    pub fn from_name(name: &str) -> Option<Self> {
        [
            Self::Scalar,
            Self::Sse42,
            Self::Avx2,
            Self::Avx512,
            Self::Neon,
        ]
        .into_iter()
        .find(|isa| isa.name() == name)
    }
}
