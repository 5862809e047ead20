//! Meshes of round shapes: disk, cylinder, cone, torus. Object space, exact vertex normals.
//!
//! With N = `level` slices of a full turn: a disk has N / 4 rings; the side of a cylinder or a cone has N / 2 stacks and
//! their caps are such disks; the tube of a torus has N / 2 slices of its own. Vertices lie on the shape. Chord error, the
//! largest distance of the mesh from the shape, with the step a = 2 pi / N and b = 2 pi / (slices of the tube):
//!
//! | shape | at most |
//! | - | - |
//! | disk, cylinder, cone | r (1 - cos(a / 2)), about r a^2 / 8 (in the plane of the disk) |
//! | torus | ((R + r) a^2 + 2 r a b + r b^2) / 8 |
//!
//! The torus' bound is that of linear interpolation over a triangle whose sides are steps: an eighth of the largest second
//! derivative, |f_uu| <= R + r, |f_uv| <= r, |f_vv| = r. Positions on shared edges are computed once or by the same
//! expression, so closed shapes give closed meshes. An apex has a vertex for each slice, with the normal of its middle.

use super::shape::Mesh;
use super::tessellate::turn;
use crate::math::{DVec2, DVec3};

/// An axis with two directions across it: u, v, axis are a right-handed frame of unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Across; slice 0 lies here. It is horizontal (x for a vertical axis).
    pub u: DVec3,
    /// Across, a quarter turn on.
    pub v: DVec3,
    /// Along.
    pub axis: DVec3,
}

impl Frame {
    /// The frame about a direction of any length; +y stands in for a zero one.
    pub fn about(direction: DVec3) -> Self {
        let unit = |v: DVec3| DVec3::from_array(crate::math::float::normalize(v.to_array()).0);
        let axis = match unit(direction) {
            DVec3::ZERO => DVec3::Y,
            axis => axis,
        };
        // y x axis, which rounds nothing.
        let u = match unit(DVec3::new(axis.z, 0.0, -axis.x)) {
            DVec3::ZERO => DVec3::X,
            u => u,
        };
        let v = axis.cross(u) + DVec3::ZERO;
        Self { u, v, axis }
    }

    /// The unit vector at slice `i` of `n`.
    pub(super) fn radial(&self, i: u32, n: u32) -> DVec3 {
        let (sin, cos) = turn(i % n, n);
        self.u * cos + self.v * sin
    }

    /// The unit vector in the middle of slice `i` of `n`.
    pub(super) fn radial_middle(&self, i: u32, n: u32) -> DVec3 {
        let (sin, cos) = turn(2 * i + 1, 2 * n);
        self.u * cos + self.v * sin
    }
}

/// Slices, stacks of a side, rings of a cap and slices of a tube at a level.
pub(super) fn divisions(level: u32) -> [u32; 4] {
    let slices = level.max(3);
    [
        slices,
        (slices / 2).max(1),
        (slices / 4).max(1),
        (slices / 2).max(3),
    ]
}

/// A disk that faces along its frame's axis.
pub(super) fn disk(center: DVec3, normal: DVec3, radius: f64, level: u32) -> Mesh {
    let mut mesh = Mesh::default();
    cap(
        &mut mesh,
        center,
        &Frame::about(normal),
        radius,
        level,
        true,
    );
    mesh
}

/// A cylinder's side and ends.
pub(super) fn cylinder(base: DVec3, top: DVec3, radius: f64, caps: bool, level: u32) -> Mesh {
    let frame = Frame::about(top - base);
    let [slices, stacks, ..] = divisions(level);
    let mut mesh = Mesh::default();
    for j in 0..=stacks {
        ring(&mut mesh, slices, f64::from(j) / f64::from(stacks), |i| {
            let radial = frame.radial(i, slices);
            (between(base, top, j, stacks) + radius * radial, radial)
        });
    }
    bands(&mut mesh, 0, slices, stacks);
    if caps {
        cap(&mut mesh, base, &frame, radius, level, false);
        cap(&mut mesh, top, &frame, radius, level, true);
    }
    mesh
}

/// A cone's side and base.
pub(super) fn cone(base: DVec3, apex: DVec3, radius: f64, closed: bool, level: u32) -> Mesh {
    let frame = Frame::about(apex - base);
    let [slices, stacks, ..] = divisions(level);
    let height = (apex - base).length();
    // Across the generators: radius along the axis for every height outwards.
    let slope = DVec2::new(height, radius).normalize_or(DVec2::X);
    let normal = |radial: DVec3| radial * slope.x + frame.axis * slope.y;
    let mut mesh = Mesh::default();
    for j in 0..stacks {
        let part = f64::from(stacks - j) / f64::from(stacks);
        ring(&mut mesh, slices, 1.0 - part, |i| {
            let radial = frame.radial(i, slices);
            let p = between(base, apex, j, stacks) + radius * part * radial;
            (p, normal(radial))
        });
    }
    bands(&mut mesh, 0, slices, stacks - 1);
    let last = (stacks - 1) * (slices + 1);
    for i in 0..slices {
        let tip = mesh.positions.len() as u32;
        let u = (f64::from(i) + 0.5) / f64::from(slices);
        push(
            &mut mesh,
            apex,
            normal(frame.radial_middle(i, slices)),
            DVec2::new(u, 1.0),
        );
        mesh.triangles.push([last + i, last + i + 1, tip]);
    }
    if closed {
        cap(&mut mesh, base, &frame, radius, level, false);
    }
    mesh
}

/// A torus: u runs around the axis, v around the tube, from the outermost circle towards the axis' direction.
pub(super) fn torus(center: DVec3, axis: DVec3, major: f64, minor: f64, level: u32) -> Mesh {
    let frame = Frame::about(axis);
    let [slices, _, _, tube] = divisions(level);
    let mut mesh = Mesh::default();
    for j in 0..=tube {
        let (sin, cos) = turn(j % tube, tube);
        ring(&mut mesh, slices, f64::from(j) / f64::from(tube), |i| {
            let radial = frame.radial(i, slices);
            let normal = radial * cos + frame.axis * sin;
            (center + major * radial + minor * normal, normal)
        });
    }
    bands(&mut mesh, 0, slices, tube);
    mesh
}

/// The point `j / n` of the way, both ends exactly.
fn between(from: DVec3, to: DVec3, j: u32, n: u32) -> DVec3 {
    if j == n {
        return to;
    }
    from + (f64::from(j) / f64::from(n)) * (to - from)
}

pub(super) fn push(mesh: &mut Mesh, position: DVec3, normal: DVec3, texcoord: DVec2) {
    mesh.positions.push(position);
    mesh.normals.push(normal);
    mesh.texcoords.push(texcoord);
}

/// A row of `slices` + 1 vertices, the last at the place of the first.
pub(super) fn ring(mesh: &mut Mesh, slices: u32, v: f64, at: impl Fn(u32) -> (DVec3, DVec3)) {
    for i in 0..=slices {
        let (position, normal) = at(i);
        let u = f64::from(i) / f64::from(slices);
        push(mesh, position, normal, DVec2::new(u, v));
    }
}

/// Quads between `rows` + 1 rows that follow each other, the first at vertex `first`.
pub(super) fn bands(mesh: &mut Mesh, first: u32, slices: u32, rows: u32) {
    for j in 0..rows {
        for i in 0..slices {
            let a = first + j * (slices + 1) + i;
            let d = a + slices + 1;
            mesh.triangles.push([a, a + 1, d + 1]);
            mesh.triangles.push([a, d + 1, d]);
        }
    }
}

/// A disk across a frame's axis that faces along it, or against it where not `up`.
fn cap(mesh: &mut Mesh, center: DVec3, frame: &Frame, radius: f64, level: u32, up: bool) {
    let [slices, _, rings, _] = divisions(level);
    let normal = if up { frame.axis } else { -frame.axis };
    let middle = mesh.positions.len() as u32;
    push(mesh, center, normal, DVec2::splat(0.5));
    for k in 1..=rings {
        let part = f64::from(k) / f64::from(rings);
        for i in 0..slices {
            let radial = frame.radial(i, slices);
            let (sin, cos) = turn(i, slices);
            let texcoord = DVec2::splat(0.5) + 0.5 * part * DVec2::new(cos, sin);
            push(mesh, center + radius * part * radial, normal, texcoord);
        }
    }
    let at = |k: u32, i: u32| middle + 1 + (k - 1) * slices + i % slices;
    let mut add = |a: u32, b: u32, c: u32| {
        mesh.triangles.push(if up { [a, b, c] } else { [b, a, c] });
    };
    for i in 0..slices {
        add(middle, at(1, i), at(1, i + 1));
        for k in 1..rings {
            add(at(k, i), at(k + 1, i), at(k + 1, i + 1));
            add(at(k, i), at(k + 1, i + 1), at(k, i + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::shape::Shape;
    use super::super::tessellate::{tessellate, triangle_count};
    use super::*;
    use std::collections::HashMap;

    const BASE: DVec3 = DVec3::new(1.0, 2.0, 3.0);
    const TOP: DVec3 = DVec3::new(-0.5, 4.0, 3.5);
    const R: f64 = 1.5;
    const MINOR: f64 = 0.4;

    fn shapes() -> Vec<Shape> {
        let (base, radius, top) = (BASE, R, TOP);
        let (caps, cap, apex) = (true, true, TOP);
        vec![
            Shape::Cylinder {
                base,
                top,
                radius,
                caps,
            },
            Shape::Cone {
                base,
                apex,
                radius,
                cap,
            },
            Shape::Torus {
                center: base,
                axis: top - base,
                major: radius,
                minor: MINOR,
            },
            Shape::Disk {
                center: base,
                normal: top - base,
                radius,
            },
        ]
    }

    /// Signed distance from the true surface, negative inside; for the disk, how far outside its rim.
    fn distance(shape: &Shape, p: DVec3) -> f64 {
        let axis = (TOP - BASE).normalize();
        let height = (p - BASE).dot(axis);
        let across = (p - BASE - height * axis).length();
        let length = (TOP - BASE).length();
        match shape {
            Shape::Cylinder { .. } => (across - R).max(-height).max(height - length),
            Shape::Cone { .. } => {
                let slope = DVec2::new(length, R).normalize();
                DVec2::new(across, height - length).dot(slope).max(-height)
            }
            Shape::Torus { .. } => DVec2::new(across - R, height).length() - MINOR,
            _ => (across - R).max(height.abs()),
        }
    }

    /// Every edge is used once in each direction; vertices are told apart by their bits alone.
    fn is_closed(mesh: &Mesh) -> bool {
        let key = |i: u32| {
            (mesh.positions[i as usize] + DVec3::ZERO)
                .to_array()
                .map(f64::to_bits)
        };
        let mut edges = HashMap::new();
        for &[a, b, c] in &mesh.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((key(from), key(to))).or_insert(0) += 1;
                *edges.entry((key(to), key(from))).or_insert(0) -= 1;
            }
        }
        edges.values().all(|n| *n == 0)
    }

    #[test]
    fn meshes_are_closed_outward_and_as_many_triangles_as_promised() {
        for level in [3, 4, 7, 64] {
            for shape in shapes() {
                let mesh = tessellate(&shape, level, 1);
                assert_eq!(
                    mesh.triangles.len() as u64,
                    triangle_count(&shape, level, 1)
                );
                assert_eq!(mesh.positions.len(), mesh.normals.len());
                assert_eq!(mesh.positions.len(), mesh.texcoords.len());
                let open = matches!(shape, Shape::Disk { .. });
                assert!(is_closed(&mesh) != open, "{shape:?}");
                for t in &mesh.triangles {
                    let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                    let face = (b - a).cross(c - a);
                    let n: DVec3 = t.iter().map(|i| mesh.normals[*i as usize]).sum();
                    assert!(face.dot(n) > 0.0, "{shape:?} {t:?}");
                }
            }
        }
    }

    #[test]
    fn vertices_lie_on_the_shape_with_its_normals() {
        for shape in shapes() {
            let mesh = tessellate(&shape, 24, 1);
            for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
                assert!((n.length() - 1.0).abs() < 1e-15);
                if matches!(shape, Shape::Disk { .. }) {
                    assert!(distance(&shape, *p) < 1e-14);
                    continue;
                }
                assert!(distance(&shape, *p).abs() < 1e-14, "{shape:?}");
                // The distance grows by the step along the normal: it is the gradient. (Not beyond a rim, where two meet.)
                let step = 1e-6;
                let grown = distance(&shape, *p + step * *n) / step;
                assert!((grown - 1.0).abs() < 1e-5 || *p == TOP, "{shape:?} {grown}");
            }
        }
    }

    #[test]
    fn the_chord_error_is_as_documented_and_falls_with_the_square() {
        for shape in shapes() {
            let mut last = f64::INFINITY;
            for level in [8u32, 16, 32, 64] {
                let mesh = tessellate(&shape, level, 1);
                let a = std::f64::consts::TAU / f64::from(level);
                let b = 2.0 * a;
                let bound = match shape {
                    Shape::Torus { .. } => {
                        ((R + MINOR) * a * a + 2.0 * MINOR * a * b + MINOR * b * b) / 8.0
                    }
                    _ => R * (1.0 - (a / 2.0).cos()),
                };
                let mut worst = 0.0f64;
                for t in &mesh.triangles {
                    let corners = t.map(|i| mesh.positions[i as usize]);
                    for i in 0..=6 {
                        for j in 0..=6 - i {
                            let (u, v) = (f64::from(i) / 6.0, f64::from(j) / 6.0);
                            let [p, q, r] = corners;
                            let point = (1.0 - u - v) * p + u * q + v * r;
                            worst = worst.max(distance(&shape, point).abs());
                        }
                    }
                }
                if matches!(shape, Shape::Disk { .. }) {
                    // A disk's mesh lies in it; what it lacks is the height of the segments at the rim.
                    assert!(worst < 1e-14);
                    let [c, ..] = mesh.positions[..] else {
                        panic!("no vertex")
                    };
                    let rim = &mesh.positions[mesh.positions.len() - level as usize..];
                    let middle = (rim[0] + rim[1]) / 2.0;
                    worst = R - (middle - c).length();
                }
                assert!(
                    worst <= bound * (1.0 + 1e-12),
                    "{shape:?} {level}: {worst} {bound}"
                );
                assert!(
                    worst > 0.2 * bound && worst < last / 3.0,
                    "{shape:?} {level}: {worst}"
                );
                last = worst;
            }
        }
    }
}
