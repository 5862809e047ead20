//! Bounds of a scene, and the cameras and near distances that follow from them where a file is silent.
//!
//! World space, f64. Bounds are exact for every shape under any affine transform (Bezier patches: wider by their pieces'
//! chord error at most), and the vertices' own for meshes. Nothing here is an absolute distance: every rule scales with the scene.

use super::{Camera, Geometry, Object, Projection, Shape, revolution};
use crate::math::{DAffine3, DVec2, DVec3};

/// The part of a scene's diagonal that near is fitted to where the eye stands inside the bounds of an object.
pub const NEAR_INSIDE: f64 = 1e-3;

/// Room that a fitted camera leaves around the bounds: distance as a multiple of the tightest one.
const MARGIN: f64 = 1.08;

/// An axis-aligned box in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest corner.
    pub min: DVec3,
    /// Highest corner.
    pub max: DVec3,
}

impl Bounds {
    /// The bounds of an object; `None` where it has no vertex or its bounds are not finite.
    pub fn of_object(object: &Object) -> Option<Self> {
        let m = &object.world_from_object;
        let bounds = match &object.geometry {
            Geometry::Shape(shape) => of_shape(shape, m),
            Geometry::Mesh(mesh) => of_points(m, mesh.positions.iter().copied()),
        }?;
        (bounds.min.is_finite() && bounds.max.is_finite()).then_some(bounds)
    }

    /// The bounds of all objects.
    pub fn of_objects(objects: &[Object]) -> Option<Self> {
        objects
            .iter()
            .filter_map(Self::of_object)
            .reduce(|a, b| a.union(&b))
    }

    /// The smallest box around two.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The middle.
    pub fn center(&self) -> DVec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        (self.max - self.min).length()
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
            DVec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }

    /// Distance from a point to the box, 0 inside.
    pub fn distance(&self, point: DVec3) -> f64 {
        (point.clamp(self.min, self.max) - point).length()
    }
}

fn of_points(m: &DAffine3, points: impl Iterator<Item = DVec3>) -> Option<Bounds> {
    points
        .map(|p| m.transform_point3(p))
        .map(|p| Bounds { min: p, max: p })
        .reduce(|a, b| a.union(&b))
}

/// The bounds of a shape in world space, whatever its transform does to it.
pub fn of_shape(shape: &Shape, m: &DAffine3) -> Option<Bounds> {
    match *shape {
        Shape::Sphere { center, radius } => {
            // An affine image of a sphere reaches as far along an axis as that row of the matrix is long.
            let c = m.transform_point3(center);
            let reach = radius * reach(m, |row| row.length());
            Some(Bounds {
                min: c - reach,
                max: c + reach,
            })
        }
        Shape::Patch {
            corner,
            edge_u,
            edge_v,
            ..
        } => {
            let points = [
                corner,
                corner + edge_u,
                corner + edge_v,
                corner + edge_u + edge_v,
            ];
            of_points(m, points.into_iter())
        }
        Shape::Box { min, max } => of_points(m, Bounds { min, max }.corners().into_iter()),
        Shape::Disk {
            center,
            normal,
            radius,
        } => Some(of_disk(center, normal, radius, m)),
        Shape::Cylinder {
            base, top, radius, ..
        } => {
            let ends = [base, top].map(|p| of_disk(p, top - base, radius, m));
            Some(ends[0].union(&ends[1]))
        }
        Shape::Cone {
            base, apex, radius, ..
        } => {
            let tip = of_points(m, std::iter::once(apex))?;
            Some(of_disk(base, apex - base, radius, m).union(&tip))
        }
        Shape::Torus {
            center,
            axis,
            major,
            minor,
        } => {
            // A ball carried around a circle: their reaches add.
            let ring = of_disk(center, axis, major, m);
            let ball = minor * reach(m, |row| row.length());
            Some(Bounds {
                min: ring.min - ball,
                max: ring.max + ball,
            })
        }
        Shape::Revolution {
            base,
            axis,
            ref profile,
        } => {
            let pieces = profile.pieces().iter();
            pieces
                .map(|piece| revolution::bounds(base, axis, piece, m))
                .reduce(|a, b| a.union(&b))
        }
        Shape::Bezier {
            ref points,
            ref patches,
        } => {
            let [min, max] = super::bezier::bounds(points, patches, m)?;
            Some(Bounds { min, max })
        }
    }
}

/// One number for each row of the linear part.
fn reach(m: &DAffine3, of_row: impl Fn(DVec3) -> f64) -> DVec3 {
    let rows = m.matrix3.transpose();
    DVec3::new(
        of_row(rows.x_axis),
        of_row(rows.y_axis),
        of_row(rows.z_axis),
    )
}

/// An affine image of a circle reaches as far along an axis as that row's part in the plane of the circle is long.
fn of_disk(center: DVec3, normal: DVec3, radius: f64, m: &DAffine3) -> Bounds {
    let n = DVec3::from_array(crate::math::float::normalize(normal.to_array()).0);
    let c = m.transform_point3(center);
    let reach = radius * reach(m, |row| row.cross(n).length());
    Bounds {
        min: c - reach,
        max: c + reach,
    }
}

/// The near distance for a camera that states none; `aspect` is width / height of the picture.
///
/// Half of the least eye-plane distance that a visible point of an object's bounds can have, taken over the objects. So
/// nothing that is in front of the eye is clipped, however near. An object whose bounds hold the eye asks for
/// [`NEAR_INSIDE`] of the scene's diagonal instead. Never more than half of `far`.
pub fn near(camera: &Camera, objects: &[Object], aspect: f64) -> f64 {
    let rotation = camera.eye_from_world_rotation();
    let (cosine, perspective) = match camera.projection {
        Projection::Perspective { .. } => {
            let half = camera.half_extent(aspect);
            (1.0 / half.extend(1.0).length(), true)
        }
        Projection::Orthographic { .. } | Projection::Matrix { .. } => (0.0, false),
    };
    let inside = NEAR_INSIDE * Bounds::of_objects(objects).map_or(0.0, |b| b.diagonal());
    let least = objects
        .iter()
        .filter_map(Bounds::of_object)
        .map(|bounds| {
            // In the frustum, a point at distance d from the eye is at least d times the corner ray's cosine deep.
            let depth = bounds
                .corners()
                .map(|p| -(rotation * (p - camera.eye)).z)
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            let oblique = if perspective {
                bounds.distance(camera.eye) * cosine
            } else {
                0.0
            };
            let nearest = depth.max(oblique) / 2.0;
            if nearest > 0.0 { nearest } else { inside }
        })
        .fold(f64::INFINITY, f64::min);
    let usable = |x: f64| x.is_normal() && x > 0.0 && (x as f32).is_normal();
    let fallback = NEAR_INSIDE * (camera.target - camera.eye).length();
    let found = [least, inside, fallback, Camera::default().near]
        .into_iter()
        .find(|x| usable(*x))
        .unwrap_or(1.0);
    camera.far.map_or(found, |far| found.min(far / 2.0))
}

/// The eye from which the whole of `bounds` is in the picture, looking at `target` along `-toward`.
pub fn eye(
    bounds: &Bounds,
    target: DVec3,
    toward: DVec3,
    up: DVec3,
    projection: Projection,
    aspect: f64,
) -> DVec3 {
    let toward = toward.normalize_or(DVec3::Z);
    let probe = Camera {
        eye: toward,
        target: DVec3::ZERO,
        up,
        projection,
        ..Camera::default()
    };
    let rotation = probe.eye_from_world_rotation();
    let half: DVec2 = probe.half_extent(aspect);
    // A corner at (x, y, z) from the target, z toward the eye, is in the picture from distance z + |x| / half width on.
    let distance = bounds
        .corners()
        .map(|p| rotation * (p - target))
        .into_iter()
        .map(|p| match projection {
            Projection::Perspective { .. } => p.z + (p.x.abs() / half.x).max(p.y.abs() / half.y),
            Projection::Orthographic { .. } | Projection::Matrix { .. } => p.z + bounds.diagonal(),
        })
        .fold(0.0, f64::max);
    let distance = if distance > 0.0 && distance.is_finite() {
        distance * MARGIN
    } else {
        1.0
    };
    target + toward * distance
}

#[cfg(test)]
mod tests {
    use super::*;

    fn object(shape: Shape, m: DAffine3) -> Object {
        Object {
            name: "x".into(),
            geometry: Geometry::Shape(shape),
            materials: vec![0],
            world_from_object: m,
            tessellation: None,
            priority: 0,
        }
    }

    #[test]
    fn sphere_bounds_are_exact_under_shear() {
        let mut m = DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0));
        m.matrix3.y_axis = DVec3::new(3.0, 4.0, 0.0);
        let shape = Shape::Sphere {
            center: DVec3::ZERO,
            radius: 2.0,
        };
        let bounds = Bounds::of_object(&object(shape, m)).unwrap();
        let reach = 2.0 * 10f64.sqrt(); // row (1, 3, 0)
        assert!((bounds.max.x - (1.0 + reach)).abs() < 1e-14);
        assert_eq!(bounds.max.y, 2.0 + 8.0); // row (0, 4, 0)
        assert_eq!(bounds.min.z, 1.0);
    }

    #[test]
    fn near_is_half_the_depth_of_what_is_in_front() {
        let ball = Shape::Sphere {
            center: DVec3::ZERO,
            radius: 1.0,
        };
        let camera = Camera::default(); // at (0, 0, 5)
        let objects = [object(ball, DAffine3::IDENTITY)];
        assert_eq!(near(&camera, &objects, 4.0 / 3.0), 2.0);
        let far = Camera {
            far: Some(3.0),
            ..camera
        };
        assert_eq!(near(&far, &objects, 4.0 / 3.0), 1.5);
    }

    #[test]
    fn near_scales_with_the_scene() {
        let floor = Shape::Patch {
            corner: DVec3::new(-5.0, 0.0, 5.0),
            edge_u: DVec3::X * 10.0,
            edge_v: DVec3::NEG_Z * 10.0,
            tiles: [1, 1],
        };
        for scale in [1e-6, 1.0, 1e6] {
            let m = DAffine3::from_scale(DVec3::splat(scale));
            let camera = Camera {
                eye: DVec3::new(0.0, 1.0, 2.0) * scale,
                target: DVec3::ZERO,
                ..Camera::default()
            };
            let found = near(&camera, &[object(floor.clone(), m)], 1.0);
            // The floor starts behind the eye; it is 1 below it, and the corner ray's cosine is 1 / sqrt(1 + 2 tan^2).
            let tan = libm::tan(22.5f64.to_radians());
            let expected = 0.5 * scale / (1.0 + 2.0 * tan * tan).sqrt();
            assert!((found / expected - 1.0).abs() < 1e-12, "{found}");
        }
    }

    #[test]
    fn fitted_eye_sees_all_corners() {
        let bounds = Bounds {
            min: DVec3::new(-1.0, 0.0, 3.0),
            max: DVec3::new(7.0, 2.0, 4.0),
        };
        let camera = Camera::default();
        let target = bounds.center();
        let toward = DVec3::new(0.4, 0.3, 1.0);
        let eye = eye(&bounds, target, toward, DVec3::Y, camera.projection, 1.5);
        let camera = Camera {
            eye,
            target,
            ..camera
        };
        let half = camera.half_extent(1.5);
        let mut largest = 0.0f64;
        for corner in bounds.corners() {
            let p = camera.eye_from_world(corner);
            let x = (p.x / -p.z / half.x).abs();
            largest = largest.max(x.max((p.y / -p.z / half.y).abs()));
        }
        assert!(largest < 1.0 && largest > 0.8, "{largest}");
    }
}
