//! Outlines of objects as they project onto a plane: the convex hull where the shape is convex, else the edges at which the
//! surface turns away from the viewer, or ends.

use std::collections::HashMap;

use super::svg::Point;
use crate::math::DVec3;
use crate::scene::assembly::object_mesh;
use crate::scene::{Geometry, Mesh, Object, Shape};

/// Slices of a full turn: outlines of a drawing, not of a picture.
const LEVEL: u32 = 48;
/// More triangles than this are drawn by their hull.
const TRIANGLES: usize = 20_000;

/// An outline on the plane.
pub(super) enum Outline {
    /// A closed convex curve.
    Hull(Vec<Point>),
    /// Pieces of edges.
    Edges(Vec<[Point; 2]>),
}

impl Outline {
    /// Its points.
    pub(super) fn points(&self) -> Vec<Point> {
        match self {
            Self::Hull(points) => points.clone(),
            Self::Edges(edges) => edges.iter().flatten().copied().collect(),
        }
    }
}

/// The outline of an object: `project` takes world points to the plane, `towards` is the direction to the viewer.
pub(super) fn outline(
    object: &Object,
    project: impl Fn(DVec3) -> Point,
    towards: DVec3,
) -> Outline {
    let mesh = object_mesh(object, Some(LEVEL));
    let place = &object.world_from_object;
    let world: Vec<DVec3> = mesh
        .positions
        .iter()
        .map(|p| place.transform_point3(*p))
        .collect();
    let convex = matches!(
        &object.geometry,
        Geometry::Shape(
            Shape::Sphere { .. }
                | Shape::Patch { .. }
                | Shape::Box { .. }
                | Shape::Disk { .. }
                | Shape::Cylinder { .. }
                | Shape::Cone { .. }
        )
    );
    if convex || mesh.triangles.len() > TRIANGLES {
        return Outline::Hull(hull(world.into_iter().map(project).collect()));
    }
    let edges = turning_edges(&mesh, &world, towards).into_iter();
    Outline::Edges(edges.map(|(a, b)| [project(a), project(b)]).collect())
}

/// The convex hull, counter-clockwise (Andrew's monotone chain).
fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.retain(|p| p.iter().all(|x| x.is_finite()));
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let left = |a: Point, b: Point, c: Point| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    };
    let chain = |points: &mut dyn Iterator<Item = &Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for p in points {
            while chain.len() > 1 && !left(chain[chain.len() - 2], chain[chain.len() - 1], *p) {
                chain.pop();
            }
            chain.push(*p);
        }
        chain.pop();
        chain
    };
    let mut all = chain(&mut points.iter());
    all.extend(chain(&mut points.iter().rev()));
    all
}

/// Edges between a triangle that faces the viewer and one that does not, and edges of one triangle only.
fn turning_edges(mesh: &Mesh, world: &[DVec3], towards: DVec3) -> Vec<(DVec3, DVec3)> {
    // Vertices that stand at one place are one, whatever normals they have.
    let mut places: HashMap<[u64; 3], u32> = HashMap::new();
    let number: Vec<u32> = world
        .iter()
        .map(|p| {
            let next = places.len() as u32;
            *places.entry(p.to_array().map(f64::to_bits)).or_insert(next)
        })
        .collect();
    let mut sides: HashMap<(u32, u32), (u32, u32, [DVec3; 2])> = HashMap::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| world[v as usize]);
        let faces = (b - a).cross(c - a).dot(towards) > 0.0;
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (p, q) = (triangle[i], triangle[j]);
            let ends = [p, q].map(|v| number[v as usize]);
            let key = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            let places = [p, q].map(|v| world[v as usize]);
            let entry = sides.entry(key).or_insert((0, 0, places));
            if faces {
                entry.0 += 1;
            } else {
                entry.1 += 1;
            }
        }
    }
    let mut found: Vec<_> = sides
        .into_iter()
        .filter(|(_, (front, back, _))| (*front == 1 && *back == 1) || front + back == 1)
        .collect();
    found.sort_by_key(|(key, _)| *key);
    found
        .into_iter()
        .map(|(_, (_, _, [a, b]))| (a, b))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hulls_hold_their_points() {
        let square = [
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [0.5, 0.5],
            [0.5, 0.0],
        ];
        let found = hull(square.to_vec());
        assert_eq!(found, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(hull(vec![[2.0, 1.0]; 5]), [[2.0, 1.0]]);
    }
}
