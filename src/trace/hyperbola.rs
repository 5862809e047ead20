//! A ray as the axis of a surface of revolution sees it: one branch of a hyperbola in the half plane (radius, height).
//!
//! With n = the axis' unit direction, a ray p + t d has the height h(t) = h + t (d.n) and the distance from the axis
//! rho(t), rho^2 = C + 2 B t + A t^2 (A = |d|^2 - (d.n)^2). In the half plane (radius, height) it is one branch of a
//! hyperbola, travelled inwards and out again, and convex: a point of the profile (r, z) is *within* it where r >= rho at
//! the ray's height z. The profile crosses the ray where it changes between within and without.
//!
//! - **Steep** rays, (d.n)^2 > A: within is G = r^2 - rho^2(t) >= 0 at t = (z - h) / (d.n).
//! - **Shallow** rays: let m be the least distance from the axis, k its height and w = sqrt(r^2 - m^2); within is
//!   |d.n| w >= sqrt(A) |z - k|. So the branch may fold up to a line: a ray across the axis is one that rises by less
//!   than any number, and meets what lies at its height on both sides.
//!
//! Everything that decides is in pairs; the ray's t counts from its point nearest to the middle of the shape, so that
//! coefficients are of the shape's size.

use super::exact::{Twofold, add_scaled, dot2, pairs, values};
use super::span::along;
use crate::math::DVec3;

/// The ray as the axis sees it.
pub(super) struct View {
    /// p and d across the axis.
    pub(super) across: [[Twofold; 3]; 2],
    /// d.n.
    pub(super) climb: Twofold,
    pub(super) way: Way,
    /// What p is ahead of the ray's origin, in units of the scaled direction; and these units.
    pub(super) start: f64,
    pub(super) units: f64,
}

/// Its hyperbola.
pub(super) enum Way {
    /// rho^2 = (square zeta + twice) zeta + rest, with zeta = z - height.
    Steep {
        height: Twofold,
        square: Twofold,
        twice: Twofold,
        rest: Twofold,
    },
    /// `nearest` = t there, `length` = sqrt(A), `rise` = |d.n| / sqrt(A).
    Shallow {
        height: Twofold,
        least_square: Twofold,
        rise: Twofold,
        length: Twofold,
        nearest: Twofold,
    },
}

impl View {
    /// The ray with direction `d` from whose origin `q` leads to the axis' point at height 0, and `middle` on from there;
    /// `n` is the axis. `None` where numbers end.
    pub(super) fn new(
        q: [Twofold; 3],
        d: DVec3,
        n: [Twofold; 3],
        middle: DVec3,
        units: f64,
    ) -> Option<Self> {
        let start = (values(q) + middle).dot(d) / d.length_squared();
        if !start.is_finite() {
            return None;
        }
        let (p, d) = (along(q, d, Twofold::from(start)), pairs(d));
        let (height, climb) = (dot2(p, n), dot2(d, n));
        let across = [add_scaled(p, -height, n), add_scaled(d, -climb, n)];
        let [x, y] = across;
        let (a, b, c) = (dot2(y, y), dot2(x, y), dot2(x, x));
        if !(c.value().is_finite() && height.value().is_finite()) {
            return None;
        }
        let way = if a.is_below(climb * climb) {
            Way::Steep {
                height,
                square: a / (climb * climb),
                twice: (b / climb).scaled(2.0),
                rest: c,
            }
        } else {
            let (length, nearest) = (a.sqrt(), -(b / a));
            let rise = climb / length;
            Way::Shallow {
                height: height + climb * nearest,
                least_square: c + b * nearest,
                rise: if climb.value() < 0.0 { -rise } else { rise },
                length,
                nearest,
            }
        };
        Some(View {
            across,
            climb,
            way,
            start,
            units,
        })
    }

    pub(super) fn height(&self) -> Twofold {
        match self.way {
            Way::Steep { height, .. } | Way::Shallow { height, .. } => height,
        }
    }

    /// z above h or k.
    pub(super) fn above(&self, z: Twofold) -> Twofold {
        z - self.height()
    }

    /// r^2 - m^2 (shallow) or G (steep).
    pub(super) fn room(&self, [r, z]: [Twofold; 2]) -> f64 {
        self.square([r, z]).value()
    }

    pub(super) fn square(&self, [r, z]: [Twofold; 2]) -> Twofold {
        match self.way {
            Way::Steep {
                height,
                square,
                twice,
                rest,
            } => {
                let zeta = z - height;
                r * r - ((square * zeta + twice) * zeta + rest)
            }
            Way::Shallow { least_square, .. } => r * r - least_square,
        }
    }

    /// Whether a point of the half plane is within the branch.
    pub(super) fn is_within(&self, point: [Twofold; 2]) -> bool {
        let room = self.square(point);
        if room.value() < 0.0 {
            return false;
        }
        let Way::Shallow { rise, .. } = self.way else {
            return true;
        };
        let above = self.above(point[1]);
        let above = if above.value() < 0.0 { -above } else { above };
        (rise * room.sqrt() - above).value() >= 0.0
    }

    /// Coefficients of G = weight r^2 - (square zeta^2 + 2 half zeta + rest).
    pub(super) fn plain(&self) -> [f64; 4] {
        match self.way {
            Way::Steep {
                square,
                twice,
                rest,
                ..
            } => [1.0, square.value(), 0.5 * twice.value(), rest.value()],
            Way::Shallow {
                least_square, rise, ..
            } => {
                let weight = rise.value() * rise.value();
                [weight, 1.0, 0.0, weight * least_square.value()]
            }
        }
    }
}
