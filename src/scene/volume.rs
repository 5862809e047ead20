//! How much space objects enclose, and their order by it: contacts are left smallest first and entered largest first.
//!
//! World space, f64. Exact formulas for shapes, tetrahedra about a corner for meshes; 0 for what encloses nothing. Volumes that
//! differ by less than their own rounding are equal, so that turning a scene changes no order.

use super::profile::Piece;
use super::{Geometry, Mesh, Object, Scene, Shape};
use crate::math::{DAffine3, DVec3};

/// Volumes closer together than this part of themselves are equal: sums over 2^20 triangles round by less.
const SAME: f64 = 1.0 / (1u64 << 30) as f64;

/// The volume that an object encloses.
///
/// ```
/// use rastray::scene::{Geometry, Object, Shape, volume};
/// use rastray::math::{DAffine3, DVec3};
/// let object = Object {
///     name: "box".into(),
///     geometry: Geometry::Shape(Shape::Box { min: DVec3::ZERO, max: DVec3::new(1.0, 2.0, 3.0) }),
///     materials: vec![0],
///     world_from_object: DAffine3::from_scale(DVec3::new(1.0, 1.0, -2.0)),
///     tessellation: None,
///     priority: 0,
/// };
/// assert_eq!(volume::of(&object), 12.0);
/// ```
pub fn of(object: &Object) -> f64 {
    let place = &object.world_from_object;
    let volume = match &object.geometry {
        Geometry::Shape(shape) if shape.is_closed() => of_shape(shape),
        Geometry::Mesh(mesh) if mesh.is_closed() => of_mesh(mesh, place),
        _ => return 0.0,
    };
    let factor = match &object.geometry {
        Geometry::Shape(_) => place.matrix3.determinant(),
        Geometry::Mesh(_) => 1.0,
    };
    (volume * factor).abs()
}

/// For each object its rank by volume, the smallest first; equal volumes share one.
pub fn ranks(scene: &Scene) -> Vec<u32> {
    let clear = |object: &Object| {
        let mut optics = object.materials.iter().map(|m| &scene.materials[*m].optics);
        optics.any(|o| o.is_transmissive() && !o.thin)
    };
    let of_clear = |object: &Object| if clear(object) { of(object) } else { 0.0 };
    let volumes: Vec<f64> = scene.objects.iter().map(of_clear).collect();
    let mut order: Vec<usize> = (0..volumes.len()).collect();
    order.sort_by(|a, b| volumes[*a].total_cmp(&volumes[*b]));
    let mut ranks = vec![0; volumes.len()];
    let mut rank = 0;
    for pair in order.windows(2) {
        let [before, after] = [volumes[pair[0]], volumes[pair[1]]];
        rank += u32::from(after - before > SAME * after);
        ranks[pair[1]] = rank;
    }
    ranks
}

fn of_shape(shape: &Shape) -> f64 {
    use std::f64::consts::PI;
    match shape {
        Shape::Sphere { radius, .. } => 4.0 / 3.0 * PI * radius * radius * radius,
        Shape::Box { min, max } => {
            let size = *max - *min;
            size.x * size.y * size.z
        }
        Shape::Cylinder {
            base, top, radius, ..
        } => PI * radius * radius * (*top - *base).length(),
        Shape::Cone {
            base, apex, radius, ..
        } => PI / 3.0 * radius * radius * (*apex - *base).length(),
        Shape::Torus { major, minor, .. } => 2.0 * PI * PI * major * minor * minor,
        Shape::Revolution { profile, .. } => {
            profile.pieces().iter().map(of_piece).sum::<f64>() * PI
        }
        Shape::Patch { .. } | Shape::Disk { .. } | Shape::Bezier { .. } => 0.0,
    }
}

/// Integral of r^2 dz over a piece: of degree 8 at most, so that Gauss's rule with five nodes is exact.
fn of_piece(piece: &Piece) -> f64 {
    const NODES: [[f64; 2]; 3] = [
        [0.0, 0.568_888_888_888_888_9],
        [0.538_469_310_105_683_1, 0.478_628_670_499_366_47],
        [0.906_179_845_938_664, 0.236_926_885_056_189_08],
    ];
    let slope = |s: f64| {
        let d = [0, 1, 2].map(|i| piece.z[i + 1] - piece.z[i]);
        match piece.degree {
            1 => d[0],
            _ => {
                let t = 1.0 - s;
                3.0 * (t * t * d[0] + 2.0 * t * s * d[1] + s * s * d[2])
            }
        }
    };
    let value = |x: f64| {
        let s = 0.5 + 0.5 * x;
        let r = piece.at(s).x;
        r * r * slope(s)
    };
    let both = |[x, weight]: &[f64; 2]| match *x {
        0.0 => weight * value(0.0),
        x => weight * (value(x) + value(-x)),
    };
    NODES.iter().map(both).sum::<f64>() / 2.0
}

fn of_mesh(mesh: &Mesh, place: &DAffine3) -> f64 {
    let corner = |v: u32| place.transform_point3(mesh.positions[v as usize]);
    let about = mesh.triangles.first().map_or(DVec3::ZERO, |t| corner(t[0]));
    let part = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| corner(v) - about);
        a.dot(b.cross(c))
    };
    mesh.triangles.iter().map(part).sum::<f64>() / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::profile::{Curve, Profile};
    use std::sync::Arc;

    #[test]
    fn turned_shapes_have_the_volumes_of_their_formulas() {
        let tube = [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [0.0, 3.0]];
        let profile = Profile::new(Curve::Polyline, &tube).unwrap();
        let found = of_shape(&Shape::Revolution {
            base: DVec3::X,
            axis: DVec3::Z,
            profile: Arc::new(profile),
        });
        assert!((found - 12.0 * std::f64::consts::PI).abs() < 1e-13 * found);
    }
}
