//! Rays, hits and the spawn offset, in world space and f64 for both precisions of a render.
//!
//! A ray's parameter t counts in units of its direction, which need not be of unit length. An f32 render stores f32
//! vertices and lights in f32; its rays and hit points stay f64 ("f32 data may use f64 inside a routine", NUMERICS 2), so
//! decisions of both precisions differ by their data only.

use crate::math::DVec3;

/// Stands for no item: see [`Ray::skip`].
pub const NO_ITEM: u32 = u32::MAX;

/// Stands for no set of faces: see [`Ray::set`].
pub const NO_SET: u32 = u32::MAX;

/// The smallest positive number: the lower end of "t > 0".
pub const AFTER_ZERO: f64 = f64::from_bits(1);

/// A ray, world space. Hits count in the closed interval `t_min ..= t_max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes; any length but zero.
    pub direction: DVec3,
    /// The smallest t that counts, >= 0: the near plane, or [`AFTER_ZERO`].
    pub t_min: f64,
    /// The largest t that counts.
    pub t_max: f64,
    /// The item that the ray leaves and cannot meet again (planar, or convex and left outwards); [`NO_ITEM`] = none.
    pub skip: u32,
    /// The set of faces (`touch`) that the ray leaves and cannot meet again; [`NO_SET`] = none.
    pub set: u32,
}

impl Ray {
    /// A ray of t > 0 without end.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin,
            direction,
            t_min: AFTER_ZERO,
            t_max: f64::INFINITY,
            skip: NO_ITEM,
            set: NO_SET,
        }
    }

    /// A ray from a point to a light at t = 1, which itself does not count.
    pub fn towards(origin: DVec3, light: DVec3) -> Self {
        Self {
            t_max: 1.0f64.next_down(),
            ..Self::new(origin, light - origin)
        }
    }
}

/// The nearest hit of a ray. Where it is and which way the surface faces is computed once, for the hit that is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter.
    pub t: f64,
    /// Primitive number: the order of the file, equal in both geometries. Equal t: the lowest number wins.
    pub primitive: u32,
    /// Where the primitive's data stand.
    pub item: u32,
    /// Weights of the second and third corner of a triangle; (u, v) of a patch or a piece of one; unused by other shapes.
    pub uv: [f64; 2],
    /// Sphere: 0 near root, 1 far root. Box: face number (-x, +x, -y, ...). Cylinder, cone: face,
    /// plus 4 where the ray leaves. Torus: number of the crossing. Surface of revolution: 8 times the piece, plus
    /// the crossing's number, plus 2^31 where the ray leaves. Bezier patches: 32 times the piece, plus the number of the
    /// crossing. Triangle, patch, disk: 0.
    pub feature: u32,
    /// The ray arrives from behind: from the inside of a shape, or where a triangle's corners run clockwise.
    pub back: bool,
}

/// A hit point with the bound of its error: what spawned rays start from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// The point, world space.
    pub point: DVec3,
    /// Geometric unit normal, outward (front) side.
    pub normal: DVec3,
    /// Largest length that entered the computation of the point beside its own coordinates: the local scale.
    pub scale: f64,
}

impl Foot {
    /// The bound of the point's distance from the surface: 8u (|n|.|p| + scale).
    pub(super) fn bound(&self) -> f64 {
        4.0 * f64::EPSILON * (self.normal.abs().dot(self.point.abs()) + self.scale)
    }

    /// The origin of a ray that leaves the point in a direction: moved along the normal, to the side the ray goes to,
    /// by `Self::bound`, then each component one step further (NUMERICS 2, "Spawned rays").
    ///
    /// ```
    /// use rastray::{math::DVec3, trace::ray::Foot};
    /// let foot = Foot { point: DVec3::new(1e6, 0.0, 0.0), normal: DVec3::Y, scale: 1.0 };
    /// assert!(foot.spawn(DVec3::Y).y > 0.0);
    /// assert!(foot.spawn(DVec3::NEG_Y).y < 0.0);
    /// ```
    pub fn spawn(&self, direction: DVec3) -> DVec3 {
        let side = if self.normal.dot(direction) < 0.0 {
            -self.normal
        } else {
            self.normal
        };
        let moved = (self.point + side * self.bound()).to_array();
        let mut origin = [0.0; 3];
        for (i, (x, n)) in moved.into_iter().zip(side.to_array()).enumerate() {
            origin[i] = match n {
                n if n > 0.0 => x.next_up(),
                n if n < 0.0 => x.next_down(),
                _ => x,
            };
        }
        DVec3::from_array(origin)
    }
}
