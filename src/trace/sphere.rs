//! Spheres in their own space: roots, and the unit normal from the centre.
//!
//! With q = centre - origin, the offset of the centre from the ray is l = (d x (q x d)) / |d|^2 and the half chord
//! h^2 = (r - |l|)(r + |l|); close to the surface h^2 = b^2 / |d|^2 - C with C = |q|^2 - r^2 and b = q.d summed in pairs.
//! One root adds what has the same sign, the other is C over it: no cancellation. The hit point is
//! centre + r n with n = unit(-l -+ h d / |d|), never origin + t d (Haines, Guenther and Akenine-Moeller 2019; NUMERICS 2).
//!
//! A tangent ray (h = 0) hits, with two equal roots. A radius <= 0 or a zero direction is no hit.

use super::exact::{Twofold, cross, cross2, dot2, pairs, unit};
use crate::math::DVec3;

/// Both roots of a ray, near first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roots {
    /// Ray parameters; may be negative.
    pub t: [f64; 2],
    /// Vector from the centre to the middle of the chord.
    middle: DVec3,
    /// From the middle of the chord to its far end.
    half: DVec3,
}

impl Roots {
    /// Outward unit normal at a root (0 near, 1 far).
    pub fn normal(&self, root: usize) -> DVec3 {
        unit(if root == 0 {
            self.middle - self.half
        } else {
            self.middle + self.half
        })
    }
}

/// Roots of the ray with direction `d` for a sphere whose centre lies at `q` from the ray's origin.
///
/// ```
/// use rastray::{math::DVec3, trace::sphere::roots};
/// let r = roots([0.0, 0.0, -5.0].map(Into::into), DVec3::NEG_Z, 2.0).unwrap();
/// assert_eq!(r.t, [3.0, 7.0]);
/// assert_eq!(r.normal(0), DVec3::Z);
/// ```
pub fn roots(q: [Twofold; 3], d: DVec3, r: f64) -> Option<Roots> {
    let q_high = DVec3::new(q[0].high, q[1].high, q[2].high);
    let dd = d.length_squared();
    if !(dd > 0.0 && dd.is_finite() && q_high.is_finite() && r > 0.0) {
        return None;
    }
    // Far from the sphere's line? A coarse test with a margin far above every rounding.
    let b_plain = q_high.dot(d);
    let qq = q_high.length_squared();
    if (qq - r * r) * dd > b_plain * b_plain + 1e-9 * (qq + r * r) * dd {
        return None;
    }
    let c = dot2(q, q) - Twofold::from(r) * Twofold::from(r);
    let b = dot2(q, pairs(d));
    let near_surface = c.high.abs() <= r * r / 16.0;
    let offset = if near_surface {
        cross(d, cross(q_high, d)) / dd
    } else {
        far_offset(q, d, dd)
    };
    // Half chord squared.
    let h2 = if near_surface {
        let dd2 = dot2(pairs(d), pairs(d));
        ((b * b) / dd2 - c).value()
    } else {
        let l = offset.length();
        (r - l) * (r + l)
    };
    if h2 < 0.0 || !h2.is_finite() {
        return None;
    }
    let (h, length) = (h2.sqrt(), dd.sqrt());
    let t = parameters(b.value(), h * length, c.value(), dd);
    let half = d * (h / length);
    let middle = -offset;
    Some(Roots { t, middle, half })
}

/// Both t from b = q.d, the half chord times |d|, C and |d|^2. The root on b's side comes first: both its parts have one
/// sign. Its product with the other is C / |d|^2.
fn parameters(b: f64, half: f64, c: f64, dd: f64) -> [f64; 2] {
    let reach = b.abs() + half;
    if reach == 0.0 {
        return [0.0; 2];
    }
    let (large, small) = (reach / dd, c / reach);
    if b < 0.0 {
        [-large, -small]
    } else {
        [small, large]
    }
}

/// From the ray's point nearest to the centre, to the centre: d x (q x d) / |d|^2 in pairs, for origins far away.
fn far_offset(q: [Twofold; 3], d: DVec3, dd: f64) -> DVec3 {
    let d2 = pairs(d);
    let w = cross2(q, d2);
    let l = cross2(d2, w);
    DVec3::new(l[0].value(), l[1].value(), l[2].value()) / dd
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, z: f64) -> [Twofold; 3] {
        [x, y, z].map(Twofold::from)
    }

    #[test]
    fn tangent_rays_hit_and_the_next_one_out_does_not() {
        let d = DVec3::NEG_Z;
        let hit = roots(at(1.0, 0.0, -4.0), d, 1.0).unwrap();
        assert_eq!(hit.t, [4.0, 4.0]);
        assert_eq!(hit.normal(0), DVec3::NEG_X);
        assert!(roots(at(1.0f64.next_up(), 0.0, -4.0), d, 1.0).is_none());
    }

    #[test]
    fn roots_from_inside_and_on_the_surface() {
        let inside = roots(at(0.0, 0.0, 0.0), DVec3::X * 2.0, 3.0).unwrap();
        assert_eq!(inside.t, [-1.5, 1.5]);
        assert_eq!(inside.normal(1), DVec3::X);
        let on = roots(at(0.0, 0.0, -1.0), DVec3::NEG_Z, 1.0).unwrap();
        assert_eq!(on.t, [0.0, 2.0]);
    }

    #[test]
    fn the_outline_is_seen_under_asin_r_over_d() {
        let (r, distance) = (1.5, 40.0);
        let half = libm::asin(r / distance);
        for (step, expected) in [(-1e-13, true), (1e-13, false)] {
            let a = half + step;
            let d = DVec3::new(libm::sin(a), 0.0, -libm::cos(a));
            assert_eq!(roots(at(0.0, 0.0, -distance), d, r).is_some(), expected);
        }
    }
}
