//! Exact shapes to meshes at a level: the accuracy knob of the rasterizer.
//!
//! A sphere of `level` slices and `level / 2` stacks has its vertices on the sphere; with step a = 2 pi / level the
//! mesh lies at most r (1 - cos(a / 2)^2) inside it (a quarter turn of slices and of stacks at once), about
//! r a^2 / 4 = r pi^2 / level^2. Its vertex normals are exact. Flat shapes have no such error: a level only adds vertices.
//! The other round shapes stand in [`super::round`], surfaces of revolution in [`super::revolution`], Bezier patches in
//! [`super::bezier`].

use super::shape::{Mesh, Shape};
use super::{bezier, revolution, round};
use crate::math::{DVec2, DVec3};

/// Level where neither the scene nor the command line says: slices of a full turn.
pub const DEFAULT_LEVEL: u32 = 64;
/// Smallest and largest level accepted.
pub const LEVELS: std::ops::RangeInclusive<u32> = 3..=4096;

/// The mesh of a shape at a level (slices of a full turn; a patch takes `cells` a tile side, 1 where not asked).
pub fn tessellate(shape: &Shape, level: u32, cells: u32) -> Mesh {
    match *shape {
        Shape::Sphere { center, radius } => sphere(center, radius, level),
        Shape::Patch {
            corner,
            edge_u,
            edge_v,
            tiles,
        } => patch(corner, edge_u, edge_v, tiles, cells),
        Shape::Box { min, max } => cuboid(min, max, cells),
        Shape::Disk {
            center,
            normal,
            radius,
        } => round::disk(center, normal, radius, level),
        Shape::Cylinder {
            base,
            top,
            radius,
            caps,
        } => round::cylinder(base, top, radius, caps, level),
        Shape::Cone {
            base,
            apex,
            radius,
            cap,
        } => round::cone(base, apex, radius, cap, level),
        Shape::Torus {
            center,
            axis,
            major,
            minor,
        } => round::torus(center, axis, major, minor, level),
        Shape::Revolution {
            base,
            axis,
            ref profile,
        } => revolution::mesh(base, axis, profile, level),
        Shape::Bezier {
            ref points,
            ref patches,
        } => bezier::mesh(points, patches, level),
    }
}

/// How many triangles [`tessellate`] makes.
pub fn triangle_count(shape: &Shape, level: u32, cells: u32) -> u64 {
    let [slices, stacks, rings, tube] = round::divisions(level).map(u64::from);
    let cells = u64::from(cells.max(1));
    let cap = slices * (2 * rings - 1);
    match shape {
        Shape::Sphere { .. } => 2 * slices * ((slices / 2).max(2) - 1),
        Shape::Patch { tiles: [a, b], .. } => 2 * u64::from(*a) * u64::from(*b) * cells * cells,
        Shape::Box { .. } => 12 * cells * cells,
        Shape::Disk { .. } => cap,
        Shape::Cylinder { caps, .. } => 2 * slices * stacks + if *caps { 2 * cap } else { 0 },
        Shape::Cone { cap: closed, .. } => {
            slices * (2 * stacks - 1) + if *closed { cap } else { 0 }
        }
        Shape::Torus { .. } => 2 * slices * tube,
        Shape::Revolution { profile, .. } => revolution::triangle_count(profile, level),
        Shape::Bezier { points, patches } => bezier::triangle_count(points, patches, level),
    }
}

/// Sine and cosine of `i / n` of a full turn, exact at the quarter turns.
pub(super) fn turn(i: u32, n: u32) -> (f64, f64) {
    let eighth = 8 * u64::from(i) % (8 * u64::from(n));
    match (eighth / u64::from(n), eighth.is_multiple_of(u64::from(n))) {
        (0, true) => (0.0, 1.0),
        (2, true) => (1.0, 0.0),
        (4, true) => (0.0, -1.0),
        (6, true) => (-1.0, 0.0),
        _ => {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            (libm::sin(angle), libm::cos(angle))
        }
    }
}

fn sphere(center: DVec3, radius: f64, slices: u32) -> Mesh {
    let slices = slices.max(3);
    let stacks = (slices / 2).max(2);
    let mut mesh = Mesh::default();
    for j in 0..=stacks {
        let (sin_phi, cos_phi) = turn(j, 2 * stacks);
        for i in 0..=slices {
            let (sin_theta, cos_theta) = turn(i % slices, slices);
            let normal = DVec3::new(sin_phi * cos_theta, cos_phi, -sin_phi * sin_theta);
            mesh.positions.push(center + radius * normal);
            mesh.normals.push(normal);
            let v = f64::from(j) / f64::from(stacks);
            mesh.texcoords
                .push(DVec2::new(f64::from(i) / f64::from(slices), 1.0 - v));
        }
    }
    for j in 0..stacks {
        for i in 0..slices {
            let a = (slices + 1) * j + i;
            let b = a + slices + 1;
            if j + 1 < stacks {
                mesh.triangles.push([a, b, b + 1]);
            }
            if j > 0 {
                mesh.triangles.push([a, b + 1, a + 1]);
            }
        }
    }
    mesh
}

fn patch(corner: DVec3, edge_u: DVec3, edge_v: DVec3, tiles: [u32; 2], cells: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let normal = edge_u.cross(edge_v).normalize_or_zero();
    for j in 0..tiles[1] {
        for i in 0..tiles[0] {
            grid(&mut mesh, cells, i + j, normal, |s, t| {
                let u = (f64::from(i) + s) / f64::from(tiles[0]);
                let v = (f64::from(j) + t) / f64::from(tiles[1]);
                (corner + u * edge_u + v * edge_v, DVec2::new(u, v))
            });
        }
    }
    mesh
}

fn cuboid(min: DVec3, max: DVec3, cells: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let size = max - min;
    let [x, y, z] = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z];
    let faces = [
        (min + x, y, z), // +x
        (min, z, y),     // -x
        (min + y, z, x), // +y
        (min, x, z),     // -y
        (min + z, x, y), // +z
        (min, y, x),     // -z
    ];
    for (corner, edge_u, edge_v) in faces {
        let normal = edge_u.cross(edge_v).normalize_or_zero();
        grid(&mut mesh, cells, 0, normal, |s, t| {
            (corner + s * edge_u + t * edge_v, DVec2::new(s, t))
        });
    }
    mesh
}

/// Adds `cells` x `cells` quads, each split along the same diagonal, over (s, t) in the unit square.
fn grid(
    mesh: &mut Mesh,
    cells: u32,
    slot: u32,
    normal: DVec3,
    at: impl Fn(f64, f64) -> (DVec3, DVec2),
) {
    let cells = cells.max(1);
    let first = mesh.positions.len() as u32;
    for j in 0..=cells {
        for i in 0..=cells {
            let place = |k: u32| f64::from(k) / f64::from(cells);
            let (position, texcoord) = at(place(i), place(j));
            mesh.positions.push(position);
            mesh.normals.push(normal);
            mesh.texcoords.push(texcoord);
        }
    }
    for j in 0..cells {
        for i in 0..cells {
            let a = first + j * (cells + 1) + i;
            let d = a + cells + 1;
            mesh.triangles.push([a, a + 1, d + 1]);
            mesh.triangles.push([a, d + 1, d]);
            mesh.slots.extend([slot, slot]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outward(mesh: &Mesh, center: DVec3) -> bool {
        mesh.triangles.iter().all(|t| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            (b - a).cross(c - a).dot(a + b + c - 3.0 * center) > 0.0
        })
    }

    #[test]
    fn sphere_is_closed_outward_and_on_the_sphere() {
        let center = DVec3::new(1.0, 2.0, 3.0);
        for level in [3, 4, 7, 64] {
            let mesh = tessellate(
                &Shape::Sphere {
                    center,
                    radius: 2.0,
                },
                level,
                1,
            );
            let stacks = (level / 2).max(2) as usize;
            assert_eq!(mesh.triangles.len(), 2 * level as usize * (stacks - 1));
            assert!(outward(&mesh, center));
            for p in &mesh.positions {
                assert!(((*p - center).length() - 2.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn sphere_chord_error_is_as_documented() {
        let mesh = tessellate(
            &Shape::Sphere {
                center: DVec3::ZERO,
                radius: 1.0,
            },
            32,
            1,
        );
        let deepest = mesh
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                let n = (b - a).cross(c - a).normalize();
                1.0 - n.dot(a)
            })
            .fold(0.0, f64::max);
        let half = std::f64::consts::TAU / 64.0;
        assert!(
            deepest <= 1.0 - half.cos() * half.cos() + 1e-12,
            "{deepest}"
        );
    }

    #[test]
    fn box_and_patch_face_outward() {
        let shape = Shape::Box {
            min: DVec3::ZERO,
            max: DVec3::new(1.0, 2.0, 3.0),
        };
        let mesh = tessellate(&shape, 64, 2);
        assert_eq!(mesh.triangles.len(), 6 * 8);
        assert!(outward(&mesh, DVec3::new(0.5, 1.0, 1.5)));
        let floor = Shape::Patch {
            corner: DVec3::ZERO,
            edge_u: DVec3::Z * 4.0,
            edge_v: DVec3::X * 6.0,
            tiles: [2, 3],
        };
        let mesh = tessellate(&floor, 64, 1);
        assert_eq!(mesh.triangles.len(), 12);
        assert_eq!(mesh.normals[0], DVec3::Y);
        assert_eq!(&mesh.slots[..6], &[0, 0, 1, 1, 1, 1]);
    }
}
