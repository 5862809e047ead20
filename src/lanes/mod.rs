//! Number types that the equation and the renderers are written over, and the entry at a chosen instruction set.
//!
//! [`Real`] is one number: f32 or f64, what `--precision` picks. [`Lanes`] is several of them side by side; the lighting
//! equation stands once, generic over it. [`Wide`] is the only implementation: a plain array, without a token of the
//! instruction set. Inside [`dispatch`], the compiler knows which instructions it may use and turns the array loops
//! into vectors. Whether `mul_add` may use the hardware's is part of the type (`FMA`).
//!
//! **Same bytes everywhere.** Every operation is one IEEE 754 rounding, at every width; products and sums fuse only in
//! `mul_add`, which rounds once everywhere: hardware FMA in the AVX2, AVX-512 and NEON entries; without it, f32 goes
//! through f64 with round-to-odd (exact, not fast) and f64 through the standard library's, which promises one
//! rounding. exp, ln and pow are polynomials of our own ([`elementary`]), so that no system library takes part.
//!
//! | instruction set | f32 lanes | f64 lanes | FMA |
//! | - | - | - | - |
//! | scalar | 1 | 1 | emulated |
//! | SSE4.2 | 4 | 2 | emulated |
//! | AVX2 | 8 | 4 | hardware |
//! | AVX-512 | 16 | 8 | hardware |
//! | NEON (written, not run) | 4 | 2 | hardware |
//!
//! Tried and dropped: `Lanes` on bare f32 and f64 (`Wide<_, 1, _>` is the same code), and a wide f64 companion for hard
//! decisions: decisions are filtered in `Real` with a proven bound, and what the filter leaves open, a few points on
//! an edge, is decided exactly and one at a time.

pub mod elementary;
mod isa;
mod real;
mod wide;

pub use isa::{Isa, Kernel, dispatch};
pub use real::{Family, Real};
pub use wide::{Wide, WideMask};

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// One yes or no for each lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Some lane says yes.
    fn any(self) -> bool;
    /// Every lane says yes.
    fn all(self) -> bool;
    /// What one lane says.
    fn lane(self, i: usize) -> bool;
}

/// Numbers side by side; each operation acts on every lane and rounds once.
pub trait Lanes:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// What one lane holds.
    type Scalar: Real;
    /// Answers of comparisons.
    type Mask: Mask;
    /// How many lanes.
    const WIDTH: usize;
    /// The same number in every lane.
    fn splat(x: Self::Scalar) -> Self;
    /// The first `WIDTH` numbers of a list; 0 for those that it lacks.
    fn load(list: &[Self::Scalar]) -> Self;
    /// Writes the lanes to the first `WIDTH` numbers of a list; those that it lacks are dropped.
    fn store(self, list: &mut [Self::Scalar]);
    /// The number in one lane.
    fn lane(self, i: usize) -> Self::Scalar;
    /// `self * b + c` with one rounding.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// `self` where it is smaller, else `other` (also where one is NaN).
    fn min(self, other: Self) -> Self;
    /// `self` where it is larger, else `other` (also where one is NaN).
    fn max(self, other: Self) -> Self;
    /// self < other.
    fn lt(self, other: Self) -> Self::Mask;
    /// self <= other.
    fn le(self, other: Self) -> Self::Mask;
    /// self > other.
    fn gt(self, other: Self) -> Self::Mask;
    /// self >= other.
    fn ge(self, other: Self) -> Self::Mask;
    /// self == other.
    fn same(self, other: Self) -> Self::Mask;
    /// `yes` where the mask says so, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// [`Real::power_of_two_scale`] of each lane.
    fn power_of_two_scale(self) -> (Self, Self);
    /// [`Real::split_exponent`] of each lane.
    fn split_exponent(self) -> (Self, Self);
    /// [`Real::add_exponent`] of each lane.
    fn add_exponent(self, shifted: Self) -> Self;
}
