//! Mistakes that people make in this equation: what `crate::check` holds pictures against.
//!
//! None unless asked for ([`super::Rig::with_faults`]). They stand inside the one equation, as branches that go the same way
//! for all points of a call, so that a mistaken picture is wrong in what it names and in nothing else. A right one pays a test
//! for some points side by side: 0.02 % of the instructions of `render whitted --shading phong`, 0.06 % with `--mode trace`
//! (`valgrind --tool=callgrind` by source line, 2026-12).

use crate::lanes::{Lanes, Real};
use crate::math::color::{clamp01, quantize8};

/// Mistakes in the equation; none by default.
///
/// ```
/// use rastray::lighting::{Early, Faults};
/// assert_eq!(Faults::default().early, Early::Nothing);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// What is done to the terms instead of to the finished sum.
    pub early: Early,
    /// f_i is always 1: highlights appear where the light is below the horizon, too.
    pub ungated_specular: bool,
}

/// What is done to terms before they are summed. GL does none of it (GL 2.1 section 2.14.6: the clamp follows the sum).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Early {
    /// Nothing, as it should be.
    #[default]
    Nothing,
    /// Every term is clamped to [0, 1].
    ClampTerm,
    /// The three terms of each light are clamped to [0, 1] together.
    ClampLight,
    /// Every term is clamped and rounded to 8 bits.
    EightBits,
}

impl Early {
    /// Ambient, diffuse and specular of one light. Kept out of line: the loop that calls it has no mistakes to make.
    #[cold]
    #[inline(never)]
    pub(super) fn terms<L: Lanes>(self, [a, d, s]: [L; 3]) -> [L; 3] {
        let (zero, one) = (L::splat(L::Scalar::ZERO), L::splat(L::Scalar::ONE));
        match self {
            Self::Nothing => [a, d, s],
            Self::ClampTerm => [
                a.max(zero).min(one),
                d.max(zero).min(one),
                s.max(zero).min(one),
            ],
            // What is above 1 is taken from the last terms, so that their sum is the clamped one.
            Self::ClampLight => {
                let a = a.max(zero).min(one);
                let d = d.max(zero).min(one - a);
                [a, d, s.max(zero).min(one - a - d)]
            }
            Self::EightBits => [round8(a), round8(d), round8(s)],
        }
    }

    /// Emission, or scene ambient.
    pub(super) fn constant<R: Real>(self, x: R) -> R {
        match self {
            Self::Nothing | Self::ClampLight => x,
            Self::ClampTerm => clamp01(x),
            Self::EightBits => R::from_f64(f64::from(quantize8(x)) / 255.0),
        }
    }
}

/// The nearest multiple of 1/255 in [0, 1]: a sum with 1/u has no places behind the point.
#[inline(always)]
fn round8<L: Lanes>(x: L) -> L {
    let (zero, one) = (L::splat(L::Scalar::ZERO), L::splat(L::Scalar::ONE));
    let steps = L::splat(L::Scalar::from_f64(255.0));
    let whole = L::splat(L::Scalar::ONE / L::Scalar::ROUNDOFF / L::Scalar::from_f64(2.0));
    (x.max(zero).min(one) * steps + whole - whole) / steps
}
