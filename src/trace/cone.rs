//! Cones in their own space: one nappe cut by the plane of the base.
//!
//! With a = axis from apex to base, q = apex - origin, w = q x d, x = q x a, y = d x a, alpha = q.a, delta = d.a: inside
//! the double cone A t^2 - 2 B t + C <= 0 with A = |a|^2 |y|^2 - r^2 delta^2, B = |a|^2 x.y - r^2 alpha delta,
//! C = |a|^2 |x|^2 - r^2 alpha^2. Its discriminant is |a|^4 (r^2 |a x w|^2 - |a|^2 (a.w)^2), a difference of two
//! perpendicular squares. A > 0: both roots lie on one nappe, that of the chord's middle; A < 0: one on each, and the ray
//! stays inside beyond ours; A = 0: the ray runs parallel to a generator and has one root.
//!
//! Everything is in pairs, as for cylinders. A ray through the apex hits it; its normal there points away from the base.

use super::cylinder::split;
use super::exact::{Twofold, cross2, dot2, pairs, unit, values};
use super::span::{Span, Spot, along, unit_scale};
use crate::math::DVec3;
use crate::math::Each;

/// The round side.
pub const SIDE: u32 = 0;
/// The round end.
pub const BASE: u32 = 1;

/// A relative margin far above every rounding of a coarse test in f64.
const COARSE: f64 = 1e-13;

/// A cone; its anchor is its apex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// From apex to base, exactly.
    pub axis: [Twofold; 3],
    /// Radius at the base.
    pub radius: f64,
}

/// The vectors of the module head, axis and direction scaled to about 1.
struct Ray {
    a: [Twofold; 3],
    q: [Twofold; 3],
    d: [Twofold; 3],
    /// Height of apex and of base above the origin, times |a|; climb of the direction.
    alpha: Twofold,
    delta: Twofold,
}

impl Cone {
    /// Where the ray is inside; `q` leads from its origin to the apex.
    ///
    /// ```
    /// use rastray::{math::DVec3, trace::cone::{BASE, Cone, SIDE}};
    /// let tip = Cone { axis: [0.0, -2.0, 0.0].map(Into::into), radius: 2.0 };
    /// let span = tip.span([-0.5, -1.0, 0.0].map(Into::into), DVec3::NEG_Y).unwrap();
    /// assert_eq!((span.t.map(|t| t.value()), span.face), ([1.5, 3.0], [SIDE, BASE]));
    /// ```
    pub fn span(&self, q: [Twofold; 3], d: DVec3) -> Option<Span> {
        let (a_down, a_up) = unit_scale(values(self.axis))?;
        let (d_down, _) = unit_scale(d)?;
        let (a, d) = (self.axis.each(|x| x.scaled(a_down)), d * d_down);
        let radius = self.radius * a_down;
        if surely_missed(radius, values(a), values(q), d) {
            return None;
        }
        let d = pairs(d);
        let (alpha, delta) = (dot2(q, a), dot2(d, a));
        let ray = Ray {
            a,
            q,
            d,
            alpha,
            delta,
        };
        let base = alpha + dot2(a, a).scaled(a_up);
        let below = if delta.value() > 0.0 {
            Span::until(base.over(delta), BASE)
        } else if delta.value() < 0.0 {
            Span::from(base.over(delta), BASE)
        } else if base.value() >= 0.0 {
            Span::LINE
        } else {
            return None;
        };
        ray.nappe(Twofold::from(radius))?
            .and(below)?
            .in_units(d_down)
    }

    /// The point at an end of the span, from the apex, and its normal.
    pub fn spot(&self, q: [Twofold; 3], d: DVec3, end: usize) -> Option<Spot> {
        let span = self.span(q, d)?;
        let rest = along(q, d, span.t[end]);
        let (height, across) = split(rest, self.axis);
        let axis = values(self.axis);
        if span.face[end] == BASE {
            let offset = values(across) + axis;
            let normal = unit(axis);
            return Some(Spot { offset, normal });
        }
        let out = unit(values(across));
        let height = height.value().clamp(0.0, 1.0);
        let length = dot2(self.axis, self.axis).sqrt().value();
        Some(Spot {
            offset: height * (axis + self.radius * out),
            normal: unit(length * out - self.radius * unit(axis)),
        })
    }
}

/// The line passes beyond doubt outside both nappes.
fn surely_missed(radius: f64, a: DVec3, q: DVec3, d: DVec3) -> bool {
    let w = q.cross(d);
    let length = a.length();
    let doubt = COARSE * length * q.length() * d.length();
    (a.dot(w).abs() - doubt) * length > radius * (a.cross(w).length() + doubt)
}

impl Ray {
    /// Where it is inside our nappe, without end.
    fn nappe(&self, r: Twofold) -> Option<Span> {
        let Self { a, q, d, .. } = *self;
        let (alpha, delta, rr) = (self.alpha, self.delta, r * r);
        let (x, y, w) = (cross2(q, a), cross2(d, a), cross2(q, d));
        let (aa, yy, xy) = (dot2(a, a), dot2(y, y), dot2(x, y));
        let square = aa * yy - rr * delta * delta;
        let b = aa * xy - rr * alpha * delta;
        let c = aa * dot2(x, x) - rr * alpha * alpha;
        let (m, s) = (cross2(a, w), dot2(a, w));
        let mut discriminant = rr * dot2(m, m) - aa * s * s;
        let steep = square.value() < 0.0;
        if discriminant.value() < 0.0 {
            if !steep {
                return None;
            }
            // A steep line meets both nappes, so this is rounding.
            discriminant = Twofold::default();
        }
        if square.value() == 0.0 {
            return self.parallel(b, c);
        }
        let root = aa * discriminant.sqrt();
        let reach = if b.value() < 0.0 { b - root } else { b + root };
        let t = if reach.value() == 0.0 {
            [Twofold::default(); 2]
        } else {
            let (one, other) = (reach.over(square), c.over(reach));
            if other.is_below(one) {
                [other, one]
            } else {
                [one, other]
            }
        };
        if !steep {
            // Height of the middle of the chord, times what is positive.
            let ours = (delta * xy - alpha * yy).value() >= 0.0;
            return ours.then_some(Span { t, face: [SIDE; 2] });
        }
        Some(if delta.value() > 0.0 {
            Span::from(t[1], SIDE)
        } else {
            Span::until(t[0], SIDE)
        })
    }

    /// Parallel to a generator: C - 2 B t <= 0.
    fn parallel(&self, b: Twofold, c: Twofold) -> Option<Span> {
        let climbs = self.delta.value() > 0.0;
        let t = if b.value() != 0.0 {
            if (b.value() > 0.0) != climbs {
                return None; // inside the other nappe only
            }
            c.over(b.scaled(2.0))
        } else if c.value() <= 0.0 {
            // Along a generator, from the apex on.
            self.alpha.over(self.delta)
        } else {
            return None;
        };
        Some(if climbs {
            Span::from(t, SIDE)
        } else {
            Span::until(t, SIDE)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, z: f64) -> [Twofold; 3] {
        [x, y, z].map(Twofold::from)
    }

    /// Apex at the origin, opening upwards at 45 degrees, base at y = 2. Rays are given by origin and direction.
    fn cut(o: [f64; 3], d: [f64; 3]) -> Option<([f64; 2], [u32; 2])> {
        let cone = Cone {
            axis: at(0.0, 2.0, 0.0),
            radius: 2.0,
        };
        let span = cone.span(o.map(|x| Twofold::from(-x)), d.into())?;
        Some((span.t.map(Twofold::value), span.face))
    }

    #[test]
    fn only_our_nappe_is_met() {
        assert_eq!(
            cut([-5.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
            Some(([4.0, 6.0], [SIDE; 2]))
        );
        assert_eq!(cut([-5.0, -1.0, 0.0], [1.0, 0.0, 0.0]), None);
        assert_eq!(
            cut([0.5, 9.0, 0.0], [0.0, -1.0, 0.0]),
            Some(([7.0, 8.5], [BASE, SIDE]))
        );
        assert_eq!(
            cut([0.5, -9.0, 0.0], [0.0, 1.0, 0.0]),
            Some(([9.5, 11.0], [SIDE, BASE]))
        );
        assert_eq!(cut([2.5, -9.0, 0.0], [0.0, 1.0, 0.0]), None);
    }

    #[test]
    fn the_apex_is_a_point_of_the_cone() {
        assert_eq!(
            cut([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
            Some(([5.0, 5.0], [SIDE; 2]))
        );
        assert_eq!(cut([-5.0, -1e-300, 0.0], [1.0, 0.0, 0.0]), None);
        let cone = Cone {
            axis: at(0.0, 2.0, 0.0),
            radius: 2.0,
        };
        let spot = cone.spot(at(0.0, 3.0, 0.0), DVec3::Y, 0).unwrap();
        assert_eq!((spot.offset, spot.normal), (DVec3::ZERO, DVec3::NEG_Y));
    }

    #[test]
    fn rays_along_and_beside_a_generator() {
        // On the surface from apex to rim.
        assert_eq!(
            cut([-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]),
            Some(([1.0, 3.0], [SIDE, BASE]))
        );
        // Parallel to it inside: enters through the other side, leaves by the base.
        assert_eq!(
            cut([-1.0, 0.0, 0.0], [1.0, 1.0, 0.0]),
            Some(([0.5, 2.0], [SIDE, BASE]))
        );
        // Parallel outside: only the other nappe.
        assert_eq!(cut([1.0, 0.0, 0.0], [1.0, 1.0, 0.0]), None);
    }
}
