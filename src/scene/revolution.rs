//! Surfaces of revolution: their mesh and their bounds. Object space.
//!
//! With N = `level` slices of a full turn, a = 2 pi / N and R the largest radius, the mesh lies at most R (1 - cos(a / 2))
//! from the surface where the profile is straight, and twice that where it is curved (about R a^2 / 4): the slices take
//! one share; each piece of the profile gets so many stacks, even in its parameter, that its chords take no more than
//! another. (k chords of a curve whose second derivative is at most B long stay within B / (8 k^2).) A quad is planar, since
//! its two rings have parallel sides, so its diagonal adds nothing. Stacks are also at most two slices of the widest ring
//! high, for what is lit at vertices, as long as that asks for no more than N.
//!
//! Vertices lie on the shape with its exact normals. Pieces meet in rings of the same bits, each with its own normals:
//! creases stay creases, smooth joints smooth. A pole has a vertex for each slice, as an apex does.

use super::fit::Bounds;
use super::profile::{Piece, Profile};
use super::round::{Frame, bands, divisions, push, ring};
use super::shape::Mesh;
use crate::math::float::normalize;
use crate::math::{DAffine3, DVec2, DVec3};

/// Stacks of one piece of a profile whose largest radius is `radius`.
fn stacks(piece: &Piece, radius: f64, level: u32) -> u64 {
    let slices = f64::from(divisions(level)[0]);
    let half_turn = std::f64::consts::PI / slices;
    let sine = libm::sin(half_turn / 2.0);
    let allowed = radius * 2.0 * sine * sine;
    let curved = (piece.bend() / (8.0 * allowed)).sqrt().ceil();
    let length = (piece.at(1.0) - piece.at(0.0)).length();
    let high = (length / (4.0 * radius * half_turn)).ceil().min(slices);
    // Beyond 2^40 nobody asks: the count alone says that it is too many.
    curved.max(high).clamp(1.0, (1u64 << 40) as f64) as u64
}

/// How many triangles [`mesh`] makes.
pub(super) fn triangle_count(profile: &Profile, level: u32) -> u64 {
    let slices = u64::from(divisions(level)[0]);
    let radius = profile.radius();
    let of_piece = |piece: &Piece| {
        let on_axis = [0.0, 1.0].map(|s| u64::from(piece.at(s).x == 0.0));
        slices * (2 * stacks(piece, radius, level) - on_axis[0] - on_axis[1])
    };
    let counts = profile.pieces().iter().map(of_piece);
    counts.fold(0, u64::saturating_add)
}

/// The mesh at a level: u runs around the axis, v along the profile, piece by piece.
pub(super) fn mesh(base: DVec3, axis: DVec3, profile: &Profile, level: u32) -> Mesh {
    let frame = Frame::about(axis);
    let radius = profile.radius();
    let count = profile.pieces().len() as f64;
    let mut mesh = Mesh::default();
    for (index, piece) in profile.pieces().iter().enumerate() {
        let stacks = stacks(piece, radius, level) as u32;
        let v = |s: f64| (index as f64 + s) / count;
        band(&mut mesh, base, &frame, piece, stacks, level, v);
    }
    mesh
}

/// The mesh of one piece; `v` gives its texture coordinate.
fn band(
    mesh: &mut Mesh,
    base: DVec3,
    frame: &Frame,
    piece: &Piece,
    stacks: u32,
    level: u32,
    v: impl Fn(f64) -> f64,
) {
    let slices = divisions(level)[0];
    let at = |s: f64, radial: DVec3| {
        let (p, way) = (piece.at(s), piece.tangent(s));
        // To the right of the way.
        let [out, up, _] = normalize([way.y, -way.x, 0.0]).0;
        let position = base + p.y * frame.axis + p.x * radial;
        (position, out * radial + up * frame.axis)
    };
    let part = |j: u32| f64::from(j) / f64::from(stacks);
    let is_pole = |j: u32| (j == 0 || j == stacks) && piece.at(part(j)).x == 0.0;
    let (low, high) = (u32::from(is_pole(0)), stacks - u32::from(is_pole(stacks)));
    let first = mesh.positions.len() as u32;
    for j in low..=high {
        ring(mesh, slices, v(part(j)), |i| {
            at(part(j), frame.radial(i, slices))
        });
    }
    if low < high {
        bands(mesh, first, slices, high - low);
    }
    for (s, row, is_pole) in [(0.0, 0, low > 0), (1.0, high - low, high < stacks)] {
        for i in 0..if is_pole { slices } else { 0 } {
            let tip = mesh.positions.len() as u32;
            let (position, normal) = at(s, frame.radial_middle(i, slices));
            let u = (f64::from(i) + 0.5) / f64::from(slices);
            push(mesh, position, normal, DVec2::new(u, v(s)));
            let a = first + row * (slices + 1) + i;
            let up = [a, a + 1, tip];
            let triangle = if s == 0.0 { [a + 1, a, tip] } else { up };
            mesh.triangles.push(triangle);
        }
    }
}

/// World bounds of the part of a surface that one piece of its profile makes, under any affine transform.
///
/// Along a world axis whose row of the matrix is w, the circle of radius r at height z reaches z w.n + r |w x n|.
pub fn bounds(base: DVec3, axis: DVec3, piece: &Piece, m: &DAffine3) -> Bounds {
    let n = DVec3::from_array(normalize(axis.to_array()).0);
    let rows = m.matrix3.transpose();
    let reach = |row: DVec3, side: f64| piece.extremes(side * row.cross(n).length(), row.dot(n));
    let both = [rows.x_axis, rows.y_axis, rows.z_axis]
        .map(|row| [reach(row, -1.0)[0], reach(row, 1.0)[1]]);
    let b = m.transform_point3(base);
    Bounds {
        min: b + DVec3::from_array(both.map(|x| x[0])),
        max: b + DVec3::from_array(both.map(|x| x[1])),
    }
}
