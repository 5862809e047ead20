//! Disks in their own space: the plane's root, and a decision without division.
//!
//! With q = centre - origin, t = (n.q) / (n.d) and the offset from the centre times n.d is n x (d x q); so the ray hits
//! where |n x (d x q)|^2 <= r^2 (n.d)^2, in pairs (relative error about 2^-100). A ray parallel to the plane, or in it,
//! misses. The point is centre + the offset's part in the plane.

use super::exact::{Twofold, add_scaled, cross2, dot2, pairs, unit, values};
use super::span::{Spot, along, unit_scale};
use crate::math::DVec3;

/// A disk about its anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// Front side, any length.
    pub normal: DVec3,
    /// Radius.
    pub radius: f64,
}

/// Where a ray with direction `d` meets the plane through the point `q` from its origin; `None` where it runs parallel.
///
/// ```
/// use rastray::{math::DVec3, trace::disk::plane};
/// let q = [0.0, -2.0, 0.0].map(Into::into);
/// assert_eq!(plane(q, DVec3::new(0.0, -0.5, 7.0), DVec3::Y).unwrap().value(), 4.0);
/// ```
pub fn plane(q: [Twofold; 3], d: DVec3, normal: DVec3) -> Option<Twofold> {
    let (n_down, _) = unit_scale(normal)?;
    let (d_down, _) = unit_scale(d)?;
    let n = pairs(normal * n_down);
    let along = dot2(n, pairs(d * d_down));
    if along.value() == 0.0 {
        return None;
    }
    let t = dot2(n, q).over(along).scaled(d_down);
    t.value().is_finite().then_some(t)
}

impl Disk {
    /// Where the ray meets the disk, and whether from behind; `q` leads from its origin to the centre.
    pub fn hit(&self, q: [Twofold; 3], d: DVec3) -> Option<(f64, bool)> {
        let (n_down, _) = unit_scale(self.normal)?;
        let (d_down, _) = unit_scale(d)?;
        let (n, d2) = (pairs(self.normal * n_down), pairs(d * d_down));
        let along = dot2(n, d2);
        if along.value() == 0.0 {
            return None;
        }
        let offset = cross2(n, cross2(d2, q));
        let reach = Twofold::from(self.radius) * along;
        if (reach * reach).is_below(dot2(offset, offset)) {
            return None;
        }
        let t = (dot2(n, q).over(along).value()) * d_down;
        t.is_finite().then_some((t, along.value() > 0.0))
    }

    /// The point and normal of the hit.
    pub fn spot(&self, q: [Twofold; 3], d: DVec3) -> Option<Spot> {
        let t = plane(q, d, self.normal)?;
        let (n_down, _) = unit_scale(self.normal)?;
        let n = pairs(self.normal * n_down);
        let rest = along(q, d, t);
        let out = -(dot2(rest, n) / dot2(n, n));
        Some(Spot {
            offset: values(add_scaled(rest, out, n)),
            normal: unit(self.normal),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rim_is_part_of_the_disk() {
        let disk = Disk {
            normal: DVec3::new(0.0, 4.0, 0.0),
            radius: 5.0,
        };
        let hit = |x: f64, z: f64| disk.hit([-x, -1.0, -z].map(Twofold::from), DVec3::NEG_Y);
        assert_eq!(hit(3.0, 4.0), Some((1.0, false)));
        assert_eq!(hit(3.0f64.next_up(), 4.0), None);
        let q = [0.0, 1.0, 0.0].map(Twofold::from);
        assert_eq!(disk.hit(q, DVec3::Y), Some((1.0, true)));
        assert_eq!(disk.hit(q, DVec3::X), None);
        assert_eq!(disk.hit([Twofold::default(); 3], DVec3::X), None);
    }
}
