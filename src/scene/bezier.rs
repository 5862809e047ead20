//! Bicubic Bezier patches: points, normals, halves, meshes. Object or world space, f64.
//!
//! A net holds 4 x 4 control points, `net[i][j]`: u runs along j, v along i, both over 0..=1, and the front side is that of du x dv.
//!
//! *Shared borders.* A border depends on its own four control points alone, and each routine here gives the same bits for
//! them in reverse order. So patches that share a border meet in the same points, in both renderers.
//!
//! *Normals* are exact up to rounding. Where du x dv is 0, its limit on the way from the middle of the patch counts: on a border that
//! is a single point (as on the teapot's knob), or whose neighbouring points lie on it, by the next derivatives; where those are 0
//! too, by a point 2^-20 of the way to the middle. A patch without area has the zero vector.
//!
//! *Mesh.* With N = level, each patch becomes n x n cells of two triangles, n = N / 4 rounded up (a teapot's patch is a quarter turn),
//! less those that a border shrunk to a point leaves without area. Chord error: linear interpolation over a triangle with legs 1 / n
//! along u and v is off by at most (|f_uu| + 2 |f_uv| + |f_vv|) / (8 n^2) (Filip, Magedson and Markot 1986), each largest
//! derivative at most that of its own control points: [`chord_error`].

use super::shape::Mesh;
use crate::math::{DAffine3, DVec2, DVec3};

/// The control points of a patch: four rows of four.
pub type Net = [[DVec3; 4]; 4];

/// Halvings along u and v of a patch's pieces, where their number allows.
const PIECE_LEVEL: u32 = 3;
/// The most pieces made for the sake of speed and tight boxes.
const MAX_PIECES: usize = 1 << 18;

/// A point of a patch and the derivatives there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// The point.
    pub point: DVec3,
    /// d point / du.
    pub du: DVec3,
    /// d point / dv.
    pub dv: DVec3,
}

/// The net of a patch from a list of points; indices beyond its end are the caller's mistake and panic.
pub fn net(points: &[DVec3], patch: &[u32; 16]) -> Net {
    std::array::from_fn(|i| std::array::from_fn(|j| points[patch[4 * i + j] as usize]))
}

/// de Casteljau's scheme at weights (1 - t, t).
#[inline]
fn curve(p: [DVec3; 4], [s, t]: [f64; 2]) -> DVec3 {
    let between = |a: DVec3, b: DVec3| s * a + t * b;
    let (a, b, c) = (
        between(p[0], p[1]),
        between(p[1], p[2]),
        between(p[2], p[3]),
    );
    between(between(a, b), between(b, c))
}

/// d/dt of a curve, from the differences of its points: exactly 0 where they are one point.
#[inline]
fn slope(p: [DVec3; 4], [s, t]: [f64; 2]) -> DVec3 {
    let between = |a: DVec3, b: DVec3| s * a + t * b;
    let (a, b, c) = (p[1] - p[0], p[2] - p[1], p[3] - p[2]);
    3.0 * between(between(a, b), between(b, c))
}

/// d^2/dt^2 of a curve.
#[inline]
fn bend(p: [DVec3; 4], [s, t]: [f64; 2]) -> DVec3 {
    let (a, b, c) = (p[1] - p[0], p[2] - p[1], p[3] - p[2]);
    6.0 * (s * (b - a) + t * (c - b))
}

/// The point and its derivatives at weights (1 - u, u) and (1 - v, v).
#[inline]
fn jet_at(net: &Net, u: [f64; 2], v: [f64; 2]) -> Jet {
    let (mut rows, mut slopes) = ([DVec3::ZERO; 4], [DVec3::ZERO; 4]);
    for i in 0..4 {
        rows[i] = curve(net[i], u);
        slopes[i] = slope(net[i], u);
    }
    Jet {
        point: curve(rows, v),
        du: curve(slopes, v),
        dv: slope(rows, v),
    }
}

/// The point and its derivatives.
///
/// ```
/// use rastray::{math::DVec3, scene::bezier};
/// // x = u, y = v, z = u v in Bernstein form.
/// let net = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| {
///     let (u, v) = (f64::from(j) / 3.0, f64::from(i) / 3.0);
///     DVec3::new(u, v, u * v)
/// }));
/// let jet = bezier::jet(&net, 0.25, 0.5);
/// assert_eq!(jet.point, DVec3::new(0.25, 0.5, 0.125));
/// assert_eq!(jet.du, DVec3::new(1.0, 0.0, 0.5));
/// ```
#[inline]
pub fn jet(net: &Net, u: f64, v: f64) -> Jet {
    jet_at(net, [1.0 - u, u], [1.0 - v, v])
}

/// The unit normal of the front side, or its limit (module head).
pub fn normal(net: &Net, u: f64, v: f64) -> DVec3 {
    let unit = |n: DVec3| DVec3::from_array(crate::math::float::normalize(n.to_array()).0);
    let (net, _) = about_corner(net);
    let at = jet(&net, u, v);
    let mut n = at.du.cross(at.dv);
    if n != DVec3::ZERO {
        return unit(n);
    }
    // Its first change on the way to the middle.
    let (wu, wv) = ([1.0 - u, u], [1.0 - v, v]);
    let uu = curve(net.map(|row| bend(row, wu)), wv);
    let uv = slope(net.map(|row| slope(row, wu)), wv);
    let vv = bend(net.map(|row| curve(row, wu)), wv);
    let (to_u, to_v) = (0.5 - u, 0.5 - v);
    n = (to_u * uu + to_v * uv).cross(at.dv) + at.du.cross(to_u * uv + to_v * vv);
    let mut step = 1.0 / f64::from(1 << 20);
    while n == DVec3::ZERO && step <= 1.0 {
        let near = jet(&net, u + step * (0.5 - u), v + step * (0.5 - v));
        n = near.du.cross(near.dv);
        step *= 2.0;
    }
    unit(n)
}

/// The net relative to its first corner, and that corner: so far from the origin differences keep their digits. Lengths are scaled
/// by a power of two so that products of derivatives neither over- nor underflow; directions stay.
fn about_corner(net: &Net) -> (Net, DVec3) {
    use crate::lanes::Real;
    let corner = net[0][0];
    let about = net.map(|row| row.map(|p| p - corner));
    let size = about
        .iter()
        .flatten()
        .fold(0.0, |s: f64, p| s.max(p.abs().max_element()));
    if !(size > 0.0 && size.is_finite()) {
        return (about, corner);
    }
    let (down, _) = size.power_of_two_scale();
    (about.map(|row| row.map(|p| p * down)), corner)
}

/// Both halves of a curve, by midpoints: the same bits for the reversed curve.
#[inline]
pub fn halve([a, b, c, d]: [DVec3; 4]) -> [[DVec3; 4]; 2] {
    let middle = |p: DVec3, q: DVec3| 0.5 * (p + q);
    let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
    let (abc, bcd) = (middle(ab, bc), middle(bc, cd));
    let m = middle(abc, bcd);
    [[a, ab, abc, m], [m, bcd, cd, d]]
}

/// Both halves along u: u < 1/2 first.
#[inline]
pub fn halve_u(net: &Net) -> [Net; 2] {
    let rows = net.map(halve);
    [rows.map(|r| r[0]), rows.map(|r| r[1])]
}

/// Both halves along v: v < 1/2 first.
#[inline]
pub fn halve_v(net: &Net) -> [Net; 2] {
    let mut halves = [*net; 2];
    for j in 0..4 {
        let [low, high] = halve(net.map(|row| row[j]));
        for i in 0..4 {
            halves[0][i][j] = low[i];
            halves[1][i][j] = high[i];
        }
    }
    halves
}

/// How often each patch of a set is halved along u and v to get its pieces: the same for all, so that pieces share borders, too.
pub fn piece_level(patches: usize) -> u32 {
    let fits = |level: &u32| patches <= MAX_PIECES >> (2 * level);
    (1..=PIECE_LEVEL).rev().find(fits).unwrap_or(0)
}

/// The 4^level pieces of a patch, in rows along u.
pub fn pieces(net: &Net, level: u32) -> Vec<Net> {
    let mut rows = vec![*net];
    for _ in 0..level {
        rows = rows.iter().flat_map(halve_v).collect();
    }
    let mut pieces = rows;
    for _ in 0..level {
        pieces = pieces.iter().flat_map(halve_u).collect();
    }
    pieces
}

/// Corners of a box around a set of patches under a transform: that of its pieces' control points, so it is too large by their
/// chord error at most.
pub fn bounds(points: &[DVec3], patches: &[[u32; 16]], m: &DAffine3) -> Option<[DVec3; 2]> {
    let level = piece_level(patches.len());
    let mut corners: Option<[DVec3; 2]> = None;
    for patch in patches {
        let placed = net(points, patch).map(|row| row.map(|p| m.transform_point3(p)));
        for p in pieces(&placed, level).iter().flatten().flatten() {
            let [low, high] = corners.unwrap_or([*p; 2]);
            corners = Some([low.min(*p), high.max(*p)]);
        }
    }
    corners
}

/// Cells along a side of a patch at a level.
pub(super) fn cells(level: u32) -> u32 {
    level.div_ceil(4).max(1)
}

/// A bound of the distance between a patch and its mesh of n x n cells (module head).
pub fn chord_error(net: &Net, n: u32) -> f64 {
    let second = |p: [DVec3; 3]| 6.0 * (p[0] - 2.0 * p[1] + p[2]).length();
    let (mut uu, mut uv, mut vv) = (0.0f64, 0.0f64, 0.0f64);
    for i in 0..4 {
        for j in 0..4 {
            if j < 2 {
                uu = uu.max(second([net[i][j], net[i][j + 1], net[i][j + 2]]));
            }
            if i < 2 {
                vv = vv.max(second([net[i][j], net[i + 1][j], net[i + 2][j]]));
            }
            if i < 3 && j < 3 {
                let twist = net[i][j] - net[i][j + 1] - net[i + 1][j] + net[i + 1][j + 1];
                uv = uv.max(9.0 * twist.length());
            }
        }
    }
    (uu + 2.0 * uv + vv) / (8.0 * f64::from(n) * f64::from(n))
}

/// Which borders are a single point: v = 0, v = 1, u = 0, u = 1.
fn collapsed(net: &Net) -> [bool; 4] {
    let is_point = |p: [DVec3; 4]| p[1..].iter().all(|q| *q == p[0]);
    let column = |j: usize| net.map(|row| row[j]);
    [net[0], net[3], column(0), column(3)].map(is_point)
}

/// How many triangles [`mesh`] makes.
pub(super) fn triangle_count(points: &[DVec3], patches: &[[u32; 16]], level: u32) -> u64 {
    let n = u64::from(cells(level));
    let of_patch = |patch: &[u32; 16]| {
        let [bottom, top, left, right] = collapsed(&net(points, patch)).map(u64::from);
        // The lower triangles of a row, the upper ones of a column; a corner in both counts once.
        let lower = (bottom + right) * n - bottom * right;
        let upper = (top + left) * n - top * left;
        2 * n * n - lower - upper
    };
    patches.iter().map(of_patch).sum()
}

/// The mesh of a set of patches: vertices on the surface with its normals, texture coordinates (u, v) of each patch.
pub(super) fn mesh(points: &[DVec3], patches: &[[u32; 16]], level: u32) -> Mesh {
    let n = cells(level);
    let mut mesh = Mesh::default();
    for patch in patches {
        let net = net(points, patch);
        let first = mesh.positions.len() as u32;
        let weights = |k: u32| [n - k, k].map(|x| f64::from(x) / f64::from(n));
        let [bottom, top, left, right] = collapsed(&net);
        for i in 0..=n {
            for j in 0..=n {
                let (u, v) = (weights(j), weights(i));
                // A border that is a point stays one, whatever the weights round to.
                mesh.positions.push(match () {
                    () if bottom && i == 0 || left && j == 0 => net[0][0],
                    () if top && i == n || right && j == n => net[3][3],
                    () => jet_at(&net, u, v).point,
                });
                mesh.normals.push(normal(&net, u[1], v[1]));
                mesh.texcoords.push(DVec2::new(u[1], v[1]));
            }
        }
        for i in 0..n {
            for j in 0..n {
                let a = first + i * (n + 1) + j;
                let d = a + n + 1;
                if !(bottom && i == 0 || right && j == n - 1) {
                    mesh.triangles.push([a, a + 1, d + 1]);
                }
                if !(top && i == n - 1 || left && j == 0) {
                    mesh.triangles.push([a, d + 1, d]);
                }
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::super::tessellate::{tessellate, triangle_count};
    use super::super::{Shape, teapot};
    use super::*;
    use std::collections::HashMap;

    fn bits(p: DVec3) -> [u64; 3] {
        (p + DVec3::ZERO).to_array().map(f64::to_bits)
    }

    fn parts(shape: &Shape) -> (&[DVec3], &[[u32; 16]]) {
        let Shape::Bezier { points, patches } = shape else {
            panic!("no patches")
        };
        (points, patches)
    }

    #[test]
    fn halves_meet_and_cover_the_patch() {
        let pot = teapot::teapot(DVec3::ZERO, 1.0);
        let (points, patches) = parts(&pot);
        let net = net(points, &patches[5]);
        let [left, right] = halve_u(&net);
        let [low, high] = halve_v(&net);
        for i in 0..4 {
            assert_eq!(bits(left[i][3]), bits(right[i][0]));
            assert_eq!(bits(low[3][i]), bits(high[0][i]));
        }
        for (part, u, v) in [(left, 0.2, 0.6), (high, 0.4, 0.8)] {
            let error = jet(&part, 0.4, 0.6).point - jet(&net, u, v).point;
            assert!(error.length() < 1e-15, "{error}");
        }
        // The same bits for the curve the other way round.
        let back = |p: [DVec3; 4]| [p[3], p[2], p[1], p[0]];
        let [first, second] = halve(net[1]);
        let [a, b] = halve(back(net[1]));
        assert_eq!((back(second), back(first)), (a, b));
    }

    #[test]
    fn a_mesh_has_as_many_triangles_as_promised_and_none_without_area() {
        let pot = teapot::teapot(DVec3::ZERO, 1.0);
        // Collapsed at the other ends, too: rows and columns of the knob in reverse.
        let (points, patches) = parts(&pot);
        let turned: Vec<[u32; 16]> = patches[20..24]
            .iter()
            .flat_map(|p| {
                let upside: [u32; 16] = std::array::from_fn(|k| p[15 - k]);
                let across: [u32; 16] = std::array::from_fn(|k| p[4 * (k % 4) + k / 4]);
                let both: [u32; 16] = std::array::from_fn(|k| across[15 - k]);
                [upside, across, both]
            })
            .collect();
        let turned = Shape::Bezier {
            points: points.into(),
            patches: turned.into(),
        };
        for level in [3, 4, 7, 8, 64] {
            for shape in [&pot, &turned] {
                let mesh = tessellate(shape, level, 1);
                let count = mesh.triangles.len() as u64;
                assert_eq!(count, triangle_count(shape, level, 1));
                for t in &mesh.triangles {
                    let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                    let face = (b - a).cross(c - a);
                    let n: DVec3 = t.iter().map(|i| mesh.normals[*i as usize]).sum();
                    // One cell has the corners alone: the spout's mouth is a line, and half a turn of the handle has no side.
                    assert!(level < 8 || face != DVec3::ZERO, "{level}: {t:?}");
                    assert!(level < 32 || face.dot(n) > 0.0, "{level}: {t:?}");
                }
            }
        }
    }

    #[test]
    fn shared_borders_have_shared_vertices() {
        // Body, bottom and spout: an edge that one triangle alone has lies on the rim, or on an end of the spout.
        let pot = teapot::teapot(DVec3::ZERO, 1.0);
        let (points, patches) = parts(&pot);
        let body: Vec<_> = [&patches[4..12], &patches[16..20], &patches[28..]].concat();
        let shape = Shape::Bezier {
            points: points.into(),
            patches: body.into(),
        };
        for level in [8, 12, 64] {
            let mesh = tessellate(&shape, level, 1);
            let mut edges = HashMap::new();
            for &[a, b, c] in &mesh.triangles {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    let key = |i: u32| bits(mesh.positions[i as usize]);
                    *edges.entry((key(from), key(to))).or_insert(0) += 1;
                    *edges.entry((key(to), key(from))).or_insert(0) -= 1;
                }
            }
            let open = edges.values().filter(|n| **n > 0).count() as u32;
            // One ring of the rim, two of the spout, which has two patches around.
            assert_eq!(open, (4 + 2 + 2) * cells(level));
        }
    }
}
