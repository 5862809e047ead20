//! Faces of any size to triangles: a fan where the face is convex, ear clipping where it is not.
//!
//! The face is seen along the largest component of its area vector (Newell's), so signs of areas are those of a plane
//! figure. A simple polygon keeps its area and its winding; a face that crosses itself still gives n - 2 triangles.
//! Ear clipping looks at reflex corners only: O(n r) for r of them, hence [`MAX_CORNERS`].

use crate::math::{DVec2, DVec3};

/// Most corners of a face.
pub(crate) const MAX_CORNERS: usize = 1 << 14;

/// Area vector of a face: twice its area, along its normal.
pub(crate) fn area_vector(points: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    let Some(first) = points.clone().next() else {
        return DVec3::ZERO;
    };
    // Differences from the first corner keep the precision of small faces far from the origin.
    let edges = points.clone().skip(1).map(|p| p - first);
    let next = edges.clone().skip(1);
    edges.zip(next).map(|(a, b)| a.cross(b)).sum()
}

/// Cuts a face of at least three corners into triangles, whose corners are those of the face.
pub(crate) fn triangulate(face: &[u32], position: impl Fn(u32) -> DVec3) -> Vec<[u32; 3]> {
    if let [a, b, c] = *face {
        return vec![[a, b, c]];
    }
    let points = project(face, position);
    let n = face.len();
    let pick = |t: [usize; 3]| t.map(|i| face[i]);
    if is_convex(&points) {
        return (1..n.saturating_sub(1))
            .map(|i| pick([0, i, i + 1]))
            .collect();
    }
    clip_ears(&points).into_iter().map(pick).collect()
}

/// The face in the plane of its two smaller area components, turned so that its area is positive.
fn project(face: &[u32], position: impl Fn(u32) -> DVec3) -> Vec<DVec2> {
    let area = area_vector(face.iter().map(|i| position(*i)));
    let size = area.abs();
    let flatten = |p: DVec3| {
        if size.x >= size.y && size.x >= size.z {
            (DVec2::new(p.y, p.z), area.x)
        } else if size.y >= size.z {
            (DVec2::new(p.z, p.x), area.y)
        } else {
            (DVec2::new(p.x, p.y), area.z)
        }
    };
    let turned = |p: DVec3| {
        let (p, sign) = flatten(p);
        if sign < 0.0 { DVec2::new(p.y, p.x) } else { p }
    };
    face.iter().map(|i| turned(position(*i))).collect()
}

fn cross(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// No corner turns right, and the edges go round once.
fn is_convex(points: &[DVec2]) -> bool {
    let n = points.len();
    let at = |i: usize| points[i % n];
    let mut turns = 0;
    let mut last_sign = 0.0;
    for i in 0..n {
        let turn = cross(at(i), at(i + 1), at(i + 2));
        if turn.is_nan() || turn < 0.0 {
            return false;
        }
        let dx = at(i + 1).x - at(i).x;
        if dx != 0.0 {
            if last_sign * dx < 0.0 {
                turns += 1;
            }
            last_sign = dx.signum();
        }
    }
    // Once round, x goes one way and comes back: at most two changes, one of which may lie at the start.
    turns <= 2
}

fn clip_ears(points: &[DVec2]) -> Vec<[usize; 3]> {
    let n = points.len();
    let mut next: Vec<usize> = (0..n).map(|i| (i + 1) % n).collect();
    let mut previous: Vec<usize> = (0..n).map(|i| (i + n - 1) % n).collect();
    let turn = |p: usize, i: usize, q: usize| cross(points[p], points[i], points[q]);
    let mut reflex: Vec<usize> = (0..n)
        .filter(|&i| turn(previous[i], i, next[i]) <= 0.0)
        .collect();
    let mut triangles = Vec::with_capacity(n - 2);
    let (mut current, mut left, mut failed) = (0, n, 0);
    while left > 3 {
        let (p, q) = (previous[current], next[current]);
        let corners = [p, current, q];
        let area = turn(p, current, q);
        // A figure that crosses itself may have no ear: after a whole round any corner will do.
        let give_up = failed >= left;
        let free = || {
            !reflex
                .iter()
                .any(|&r| !corners.contains(&r) && inside(points, corners, r))
        };
        // A corner without area (two edges in line, or there and back) is cut off without harm.
        let is_ear = area > 0.0 && free() || area == 0.0 && points[p] != points[q] && free();
        if give_up || is_ear {
            triangles.push(corners);
            next[p] = q;
            previous[q] = p;
            reflex.retain(|&r| {
                r != current && (r != p && r != q || turn(previous[r], r, next[r]) <= 0.0)
            });
            (left, failed, current) = (left - 1, 0, q);
        } else {
            (failed, current) = (failed + 1, q);
        }
    }
    triangles.push([previous[current], current, next[current]]);
    triangles
}

/// Whether a corner lies in a triangle or on its edges; corners at the same place as one of the triangle's do not count.
fn inside(points: &[DVec2], [a, b, c]: [usize; 3], r: usize) -> bool {
    let [a, b, c, p] = [a, b, c, r].map(|i| points[i]);
    if p == a || p == b || p == c {
        return false;
    }
    cross(a, b, p) >= 0.0 && cross(b, c, p) >= 0.0 && cross(c, a, p) >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[DVec3], triangles: &[[u32; 3]]) -> (f64, f64) {
        let vector = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            (b - a).cross(c - a)
        };
        let sum: DVec3 = triangles.iter().map(vector).sum();
        let total: f64 = triangles.iter().map(|t| vector(t).length()).sum();
        (sum.length() / 2.0, total / 2.0)
    }

    fn check(flat: &[(f64, f64)], expected: f64) {
        // In three planes and both windings.
        let lifts: [fn(f64, f64) -> DVec3; 3] = [
            |x, y| DVec3::new(x, y, 3.0),
            |x, y| DVec3::new(x, -2.0, y),
            |x, y| DVec3::new(x + y, x - y, y - x),
        ];
        for (lift, scale) in lifts.into_iter().zip([1.0, 1.0, (6.0f64 * 2.0).sqrt()]) {
            let mut points: Vec<DVec3> = flat.iter().map(|&(x, y)| lift(x, y)).collect();
            for _ in 0..2 {
                let face: Vec<u32> = (0..points.len() as u32).collect();
                let triangles = triangulate(&face, |i| points[i as usize]);
                assert_eq!(triangles.len(), points.len() - 2);
                let (net, total) = area(&points, &triangles);
                let newell = area_vector(points.iter().copied()).length() / 2.0;
                assert!((net - newell).abs() < 1e-12 * newell);
                assert!((total - newell).abs() < 1e-12 * newell, "{triangles:?}");
                let _ = scale;
                points.reverse();
            }
        }
        let points: Vec<DVec3> = flat.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect();
        let face: Vec<u32> = (0..points.len() as u32).collect();
        let (_, total) = area(&points, &triangulate(&face, |i| points[i as usize]));
        assert!((total - expected).abs() < 1e-12);
    }

    #[test]
    fn concave_faces_keep_their_area() {
        check(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 0.5)], 1.5); // arrow head
        let l = [
            (0.0, 0.0),
            (3.0, 0.0),
            (3.0, 1.0),
            (1.0, 1.0),
            (1.0, 3.0),
            (0.0, 3.0),
        ];
        check(&l, 5.0);
        let comb = [
            (0.0, 0.0),
            (5.0, 0.0),
            (5.0, 3.0),
            (4.0, 3.0),
            (4.0, 1.0),
            (3.0, 1.0),
            (3.0, 3.0),
            (2.0, 3.0),
            (2.0, 1.0),
            (1.0, 1.0),
            (1.0, 3.0),
            (0.0, 3.0),
        ];
        check(&comb, 11.0);
        // A square ring, its inside joined to its outside by a seam that is walked twice.
        let ring = [
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 4.0),
            (0.0, 4.0),
            (0.0, 0.0),
            (1.0, 1.0),
            (1.0, 3.0),
            (3.0, 3.0),
            (3.0, 1.0),
            (1.0, 1.0),
        ];
        check(&ring, 12.0);
    }

    #[test]
    fn convex_faces_are_fans() {
        let corner = |i: u32| {
            let angle = f64::from(i) * std::f64::consts::TAU / 7.0;
            DVec3::new(libm::cos(angle), libm::sin(angle), 0.0)
        };
        let fan: Vec<[u32; 3]> = (1..6).map(|i| [0, i, i + 1]).collect();
        assert_eq!(triangulate(&[0, 1, 2, 3, 4, 5, 6], corner), fan);
        // The star through every third corner turns left everywhere, but goes round three times.
        assert_eq!(triangulate(&[0, 3, 6, 2, 5, 1, 4], corner).len(), 5);
    }
}
