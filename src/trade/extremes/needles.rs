//! Needles: meshes whose triangles are cut so that one of every three is as thin as asked.

use std::sync::Arc;

use crate::math::DVec3;
use crate::scene::assembly::object_mesh;
use crate::scene::{Geometry, Mesh, Scene};

/// Slices of a full turn of what is cut up.
const LEVEL: u32 = 16;

/// Turns every object into a mesh of needles and what lies between them.
pub(super) fn split(scene: &mut Scene, aspect: f64) {
    for object in &mut scene.objects {
        let mesh = object_mesh(
            object,
            object
                .tessellation
                .map_or(Some(LEVEL), |n| Some(n.min(LEVEL))),
        );
        object.geometry = Geometry::Mesh(Arc::new(needles(&mesh, aspect)));
    }
}

/// Each triangle cut at a point near the middle of its first side: a needle of the aspect there, and two others.
fn needles(mesh: &Mesh, aspect: f64) -> Mesh {
    let mut cut = mesh.clone();
    (cut.triangles, cut.slots) = (Vec::new(), Vec::new());
    for (i, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        let weights = near_first_side([a, b, c].map(|v| mesh.positions[v as usize]), aspect);
        let p = cut.positions.len() as u32;
        let corners = [a, b, c].map(|v| v as usize);
        push(&mut cut.positions, &mesh.positions, |list| {
            blend(corners.map(|v| list[v]), weights)
        });
        push(&mut cut.normals, &mesh.normals, |list| {
            blend(corners.map(|v| list[v]), weights)
        });
        push(&mut cut.texcoords, &mesh.texcoords, |list| list[corners[0]]);
        push(&mut cut.colors, &mesh.colors, |list| list[corners[0]]);
        cut.triangles.extend([[a, b, p], [b, c, p], [c, a, p]]);
        cut.slots.extend([mesh.slot(i) as u32; 3]);
    }
    cut
}

/// Adds an element where the list has any.
fn push<T>(to: &mut Vec<T>, from: &[T], element: impl FnOnce(&[T]) -> T) {
    if !from.is_empty() {
        to.push(element(from));
    }
}

fn blend([a, b, c]: [DVec3; 3], [u, v, w]: [f64; 3]) -> DVec3 {
    u * a + v * b + w * c
}

/// Weights of the corners at a point over the middle of the first side, at the side's length over `aspect`; never nearer to
/// the third corner than the middle.
fn near_first_side([a, b, c]: [DVec3; 3], aspect: f64) -> [f64; 3] {
    let side = b - a;
    let height = side.cross(c - a).length() / side.length();
    let wanted = side.length() / aspect / height;
    let third = if wanted.is_finite() {
        wanted.min(0.5)
    } else {
        0.0
    };
    [0.5 * (1.0 - third), 0.5 * (1.0 - third), third]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_aspect_is_length_over_width_and_the_area_stays() {
        let mesh = Mesh {
            positions: vec![DVec3::ZERO, 4.0 * DVec3::X, DVec3::new(1.0, 3.0, 0.0)],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        for aspect in [10.0, 1e6] {
            let cut = needles(&mesh, aspect);
            let at = |v: u32| cut.positions[v as usize];
            let area = |[a, b, c]: [u32; 3]| (at(b) - at(a)).cross(at(c) - at(a)).z / 2.0;
            assert_eq!(cut.triangles[0], [0, 1, 3]);
            // Width 4 / aspect over a side of 4.
            assert!((area(cut.triangles[0]) * aspect - 8.0).abs() < 1e-9);
            let whole: f64 = cut.triangles.iter().map(|t| area(*t)).sum();
            assert!((whole - 6.0).abs() < 1e-12);
        }
    }
}
