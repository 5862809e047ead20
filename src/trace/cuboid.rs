//! Axis-aligned boxes in their own space: the slabs that a ray crosses, and through which faces.
//!
//! A ray parallel to a slab skips that axis when it runs inside (faces included) and misses otherwise; no 0 * infinity.
//! Faces are numbered -x, +x, -y, +y, -z, +z.

use crate::math::DVec3;

/// Entry and exit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slabs {
    /// Ray parameters of entry and exit; may be negative or equal.
    pub t: [f64; 2],
    /// Numbers of the faces.
    pub face: [u32; 2],
}

/// Outward normal of a face.
pub fn face_normal(face: u32) -> DVec3 {
    let mut n = [0.0; 3];
    n[(face / 2) as usize % 3] = if face.is_multiple_of(2) { -1.0 } else { 1.0 };
    DVec3::from_array(n)
}

/// Where a ray crosses the box `min ..= max`.
///
/// ```
/// use rastray::{math::DVec3, trace::cuboid::slabs};
/// let s = slabs(DVec3::new(0.5, 0.5, 4.0), DVec3::NEG_Z, DVec3::ZERO, DVec3::ONE).unwrap();
/// assert_eq!((s.t, s.face), ([3.0, 4.0], [5, 4]));
/// ```
pub fn slabs(origin: DVec3, direction: DVec3, min: DVec3, max: DVec3) -> Option<Slabs> {
    let (o, d) = (origin.to_array(), direction.to_array());
    let (low, high) = (min.to_array(), max.to_array());
    let mut found = Slabs {
        t: [f64::NEG_INFINITY, f64::INFINITY],
        face: [u32::MAX; 2],
    };
    for axis in 0..3 {
        if d[axis] == 0.0 {
            if o[axis] < low[axis] || o[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let number = 2 * axis as u32;
        let mut enter = ((low[axis] - o[axis]) / d[axis], number);
        let mut leave = ((high[axis] - o[axis]) / d[axis], number + 1);
        if d[axis] < 0.0 {
            std::mem::swap(&mut enter, &mut leave);
        }
        if enter.0 > found.t[0] {
            (found.t[0], found.face[0]) = enter;
        }
        if leave.0 < found.t[1] {
            (found.t[1], found.face[1]) = leave;
        }
    }
    let real = found.t.iter().all(|t| t.is_finite());
    (real && found.t[0] <= found.t[1]).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parallel_rays_in_a_face_hit_and_outside_miss() {
        let hit = |o: [f64; 3]| slabs(o.into(), DVec3::X, DVec3::ZERO, DVec3::ONE).is_some();
        assert!(hit([-1.0, 0.0, 1.0]) && hit([-1.0, 1.0, 0.5]));
        assert!(!hit([-1.0, -1e-300, 0.5]) && !hit([-1.0, 0.5, 1.0f64.next_up()]));
        assert!(slabs(DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DVec3::ONE).is_none());
    }

    #[test]
    fn faces_point_outwards() {
        for face in 0..6 {
            let n = face_normal(face);
            let s = slabs(n * 3.0, -n, DVec3::NEG_ONE, DVec3::ONE).unwrap();
            assert_eq!((s.face[0], s.t), (face, [2.0, 4.0]));
        }
    }
}
