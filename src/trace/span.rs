//! Where a ray is inside a convex solid: one interval of t in pairs, and the faces at its ends.
//!
//! A solid that is the intersection of simpler ones has the intersection of their intervals. So a ray that enters leaves,
//! whatever rounding does, through rims and apexes too: none slips between a side and its cap, none is counted twice.

use super::exact::{Twofold, add_scaled, pairs};
use crate::math::DVec3;
use crate::math::Each;

/// The interval and the faces that bound it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Ray parameters of entry and exit; may be negative, infinite or equal.
    pub t: [Twofold; 2],
    /// What is crossed there, in the solid's own numbers.
    pub face: [u32; 2],
}

impl Span {
    /// The whole line.
    pub const LINE: Self = Self {
        t: [
            Twofold {
                high: f64::NEG_INFINITY,
                low: 0.0,
            },
            Twofold {
                high: f64::INFINITY,
                low: 0.0,
            },
        ],
        face: [0; 2],
    };

    /// From t on.
    pub fn from(t: Twofold, face: u32) -> Self {
        let line = Self::LINE;
        Self {
            t: [t, line.t[1]],
            face: [face; 2],
        }
    }

    /// Up to t.
    pub fn until(t: Twofold, face: u32) -> Self {
        let line = Self::LINE;
        Self {
            t: [line.t[0], t],
            face: [face; 2],
        }
    }

    /// The part inside both; a common point counts. Where ends are equal, this one's faces stay.
    pub fn and(self, other: Self) -> Option<Self> {
        let mut both = self;
        if self.t[0].is_below(other.t[0]) {
            (both.t[0], both.face[0]) = (other.t[0], other.face[0]);
        }
        if other.t[1].is_below(self.t[1]) {
            (both.t[1], both.face[1]) = (other.t[1], other.face[1]);
        }
        (!both.t[1].is_below(both.t[0])).then_some(both)
    }

    /// In units of a direction that is `factor` (a power of two) times as long; `None` where an end is not finite.
    pub fn in_units(self, factor: f64) -> Option<Self> {
        let t = self.t.each(|t| t.scaled(factor));
        let finite = t.iter().all(|t| t.value().is_finite());
        finite.then_some(Self { t, ..self })
    }
}

/// A hit point in the space of its shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// From the shape's anchor to the point.
    pub offset: DVec3,
    /// Outward unit normal.
    pub normal: DVec3,
}

/// The point of the ray at t, from the anchor: t d - q.
pub(super) fn along(q: [Twofold; 3], d: DVec3, t: Twofold) -> [Twofold; 3] {
    add_scaled(q.each(|x| -x), t, pairs(d))
}

/// Powers of two that bring the largest component of a vector near 1, and back; `None` where it is zero or not finite.
pub(super) fn unit_scale(v: DVec3) -> Option<(f64, f64)> {
    use crate::lanes::Real;
    let largest = v.abs().max_element();
    (largest > 0.0 && v.is_finite()).then(|| largest.power_of_two_scale())
}
