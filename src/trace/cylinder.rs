//! Cylinders in their own space: a tube between two parallel planes.
//!
//! With a = axis from base to top, q = base - origin, x = q x a and y = d x a (both across the axis, so nothing of the
//! heights is in them): |y|^2 t^2 - 2 (x.y) t + |x|^2 - r^2 |a|^2 <= 0 inside the tube, whose discriminant is |a|^2 times
//! r^2 |y|^2 - (q.y)^2, a difference of two perpendicular squares (NUMERICS 2). Everything is in pairs: hit or miss, and
//! which face, are right to about 2^-100 of the operands. Ties count as hits; a ray along the axis is decided by
//! |x|^2 <= r^2 |a|^2 alone. The point is base + height a + r n, never origin + t d.

use super::exact::{Twofold, add_scaled, cross2, dot2, pairs, unit, values};
use super::span::{Span, Spot, along, unit_scale};
use crate::math::DVec3;
use crate::math::Each;

/// The round side.
pub const SIDE: u32 = 0;
/// The end at the anchor.
pub const BASE: u32 = 1;
/// The other end.
pub const TOP: u32 = 2;

/// A relative margin far above every rounding of a coarse test in f64.
const COARSE: f64 = 1e-13;

/// A cylinder; its anchor is the middle of its base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// From base to top, exactly.
    pub axis: [Twofold; 3],
    /// Radius.
    pub radius: f64,
}

impl Cylinder {
    /// Where the ray is inside; `q` leads from its origin to the base.
    ///
    /// ```
    /// use rastray::{math::DVec3, trace::cylinder::{Cylinder, SIDE, TOP}};
    /// let post = Cylinder { axis: [0.0, 2.0, 0.0].map(Into::into), radius: 1.0 };
    /// let span = post.span([0.0, -3.0, 0.0].map(Into::into), DVec3::new(0.0, -1.0, 0.5)).unwrap();
    /// assert_eq!((span.t.map(|t| t.value()), span.face), ([1.0, 2.0], [TOP, SIDE]));
    /// ```
    pub fn span(&self, q: [Twofold; 3], d: DVec3) -> Option<Span> {
        let (a_down, a_up) = unit_scale(values(self.axis))?;
        let (d_down, _) = unit_scale(d)?;
        let (a, d) = (self.axis.each(|x| x.scaled(a_down)), d * d_down);
        if self.surely_missed(values(a), values(q), d) {
            return None;
        }
        let d = pairs(d);
        let tube = self.tube(a, q, d)?;
        tube.and(slab(a, q, d, a_up)?)?.in_units(d_down)
    }

    /// The line passes the axis too far off, beyond doubt.
    fn surely_missed(&self, a: DVec3, q: DVec3, d: DVec3) -> bool {
        let y = d.cross(a);
        let doubt = COARSE * (a.length() * d.length());
        q.dot(y).abs() - q.length() * doubt > self.radius * (y.length() + doubt)
    }

    fn tube(&self, a: [Twofold; 3], q: [Twofold; 3], d: [Twofold; 3]) -> Option<Span> {
        let (x, y) = (cross2(q, a), cross2(d, a));
        let r = Twofold::from(self.radius);
        let (aa, yy) = (dot2(a, a), dot2(y, y));
        let c = dot2(x, x) - r * r * aa;
        if yy.value() == 0.0 {
            return (c.value() <= 0.0).then_some(Span::LINE);
        }
        let s = dot2(q, y);
        let discriminant = r * r * yy - s * s;
        if discriminant.value() < 0.0 {
            return None;
        }
        let (b, root) = (dot2(x, y), (aa * discriminant).sqrt());
        // The root on b's side adds what has one sign; its product with the other is c / |y|^2.
        let backwards = b.value() < 0.0;
        let reach = if backwards { b - root } else { b + root };
        if reach.value() == 0.0 {
            let t = [Twofold::default(); 2];
            return Some(Span { t, face: [SIDE; 2] });
        }
        let (large, small) = (reach.over(yy), c.over(reach));
        let t = if backwards {
            [large, small]
        } else {
            [small, large]
        };
        Some(Span { t, face: [SIDE; 2] })
    }

    /// The point at an end of the span, from the base, and its normal.
    pub fn spot(&self, q: [Twofold; 3], d: DVec3, end: usize) -> Option<Spot> {
        let span = self.span(q, d)?;
        let rest = along(q, d, span.t[end]);
        let (height, across) = split(rest, self.axis);
        let axis = values(self.axis);
        let spot = match span.face[end] {
            SIDE => {
                let normal = unit(values(across));
                let offset = height.value().clamp(0.0, 1.0) * axis + self.radius * normal;
                Spot { offset, normal }
            }
            BASE => Spot {
                offset: values(across),
                normal: -unit(axis),
            },
            _ => Spot {
                offset: values(across) + axis,
                normal: unit(axis),
            },
        };
        Some(spot)
    }
}

/// Part of the axis (0 at the anchor, 1 at its end), and what is left across it.
pub(super) fn split(rest: [Twofold; 3], axis: [Twofold; 3]) -> (Twofold, [Twofold; 3]) {
    let height = dot2(rest, axis) / dot2(axis, axis);
    (height, add_scaled(rest, -height, axis))
}

/// Between the planes across the axis at its two ends; `axis` is `a` times `up`.
fn slab(a: [Twofold; 3], q: [Twofold; 3], d: [Twofold; 3], up: f64) -> Option<Span> {
    let (near, climb) = (dot2(q, a), dot2(d, a));
    let far = near + dot2(a, a).scaled(up);
    if climb.value() == 0.0 {
        return (near.value() <= 0.0 && far.value() >= 0.0).then_some(Span::LINE);
    }
    let (base, top) = (near.over(climb), far.over(climb));
    Some(if climb.value() > 0.0 {
        Span {
            t: [base, top],
            face: [BASE, TOP],
        }
    } else {
        Span {
            t: [top, base],
            face: [TOP, BASE],
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, z: f64) -> [Twofold; 3] {
        [x, y, z].map(Twofold::from)
    }

    #[test]
    fn rays_along_the_axis_are_decided_by_the_radius() {
        let post = Cylinder {
            axis: at(0.0, 2.0, 0.0),
            radius: 5.0,
        };
        let down = |x: f64, z: f64| post.span(at(-x, -3.0, -z), DVec3::NEG_Y);
        let span = down(3.0, 4.0).unwrap();
        assert_eq!(span.t.map(Twofold::value), [1.0, 3.0]);
        assert_eq!(span.face, [TOP, BASE]);
        assert_eq!(down(3.0, 4.0f64.next_up()), None);
        assert!(post.span(at(0.0, -3.0, 0.0), DVec3::ZERO).is_none());
    }

    #[test]
    fn tangents_hit_and_the_next_one_out_does_not() {
        let post = Cylinder {
            axis: at(0.0, 0.0, 1.0),
            radius: 1.0,
        };
        let graze = |x: f64| post.span(at(-x, 7.0, -0.5), DVec3::Y);
        assert_eq!(graze(1.0).unwrap().t.map(Twofold::value), [7.0, 7.0]);
        assert_eq!(graze(1.0f64.next_up()), None);
        let spot = post.spot(at(-1.0, 7.0, -0.5), DVec3::Y, 0).unwrap();
        assert_eq!(
            (spot.offset, spot.normal),
            (DVec3::new(1.0, 0.0, 0.5), DVec3::X)
        );
    }

    #[test]
    fn rays_in_the_plane_of_an_end_hit() {
        let post = Cylinder {
            axis: at(0.0, 1.0, 0.0),
            radius: 1.0,
        };
        let level = |y: f64| post.span(at(4.0, -y, 0.0), DVec3::X);
        for y in [0.0, 1.0] {
            let span = level(y).unwrap();
            assert_eq!(
                (span.t.map(Twofold::value), span.face),
                ([3.0, 5.0], [SIDE; 2])
            );
        }
        assert!(level(1.0f64.next_up()).is_none() && level(-1e-300).is_none());
    }
}
