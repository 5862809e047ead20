//! Faces of any size to triangles that cover what the face covers by winding number: every place that its outline goes
//! round, however often and whichever way.
//!
//! The face is seen along the largest component of its area vector (Newell's), so signs of areas are those of a plane
//! figure. A convex face is a fan; one whose edges share nothing but neighbouring corners is cut by ear clipping, into
//! n - 2 triangles. Both are checked: triangles whose signed sum is the face and none of which is turned over cover each
//! place as often as the outline goes round it. What fails that, has edges that touch or cross, or more corners than ear
//! clipping is fast for (it looks at reflex corners only: O(n r) for r of them) goes to [`crossed`].
//!
//! A face that crosses itself gets new corners where it does, and all its triangles have the face's own winding; where
//! its area vanishes, that of the first corner's turn.

mod crossed;

use crate::math::{DVec2, DVec3};
use crate::scene::Mesh;

/// Most corners of a face.
pub(crate) const MAX_CORNERS: usize = 1 << 14;
/// Most corners of a face that is cut by ear clipping.
const MAX_CLIPPED: usize = 512;

/// A face cut into triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Cut {
    /// Corners by their number in the face; those of `crossings` follow.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Where the face crosses itself.
    pub(crate) crossings: Vec<Crossing>,
    /// What a reader of the file should be told.
    pub(crate) doubt: Option<Doubt>,
}

/// A new corner, on an edge of the face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// The edge's corners by their number in the face.
    pub(crate) edge: [u32; 2],
    /// Where on it, 0 to 1.
    pub(crate) t: f64,
}

impl Crossing {
    /// What is there of something that the corners have.
    pub(crate) fn between(&self, of: impl Fn(u32) -> DVec3) -> DVec3 {
        let [a, b] = self.edge.map(of);
        a.lerp(b, self.t)
    }
}

/// What is odd about a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Doubt {
    /// It crosses or covers itself; its triangles cover what it covers.
    CrossesItself,
    /// It crosses itself so often that it was cut into a fan, which may cover more.
    TooManyCrossings,
}

/// Faces that were odd: how many, and the number of the first.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Doubts {
    crossed: Option<(usize, usize)>,
    too_many: Option<(usize, usize)>,
}

impl Doubts {
    /// Adds what is odd about a face.
    pub(crate) fn add(&mut self, doubt: Option<Doubt>, face: usize) {
        let found = match doubt {
            None => return,
            Some(Doubt::CrossesItself) => &mut self.crossed,
            Some(Doubt::TooManyCrossings) => &mut self.too_many,
        };
        found.get_or_insert((0, face)).0 += 1;
    }

    /// What to say, each with the number of the first face that it is about.
    pub(crate) fn messages(&self) -> Vec<(String, usize)> {
        let crossed = self.crossed.map(|(count, first)| {
            let message = match count {
                1 => "a face crosses or covers itself: what its outline goes round is drawn, once".to_owned(),
                n => format!("{n} faces cross or cover themselves: what their outlines go round is drawn, once"),
            };
            (message, first)
        });
        let too_many = self.too_many.map(|(count, first)| {
            let faces = if count == 1 {
                "a face crosses itself".to_owned()
            } else {
                format!("{count} faces cross themselves")
            };
            let most = crossed::MAX_CROSSINGS;
            let message =
                format!("{faces} more than {most} times: drawn as a fan, which may cover more");
            (message, first)
        });
        crossed.into_iter().chain(too_many).collect()
    }
}

/// Area vector of a face: twice its area, along its normal.
pub(crate) fn area_vector(points: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    fan_areas(points).sum()
}

/// The area vectors of the triangles of the fan from the first corner.
fn fan_areas(mut points: impl Iterator<Item = DVec3> + Clone) -> impl Iterator<Item = DVec3> {
    let first = points.next().unwrap_or_default();
    // Differences from the first corner keep the precision of small faces far from the origin.
    let edges = points.map(move |p| p - first);
    let next = edges.clone().skip(1);
    edges.zip(next).map(|(a, b)| a.cross(b))
}

/// Cuts a face of `n` corners, at least three, into triangles.
pub(crate) fn triangulate(n: usize, position: impl Fn(usize) -> DVec3) -> Cut {
    if n == 3 {
        return Cut::plain(vec![[0, 1, 2]]);
    }
    let points = project(n, position);
    if is_convex(&points) {
        return Cut::plain(fan(n));
    }
    // Four corners that cross each other have no two triangles that both turn the same way.
    let simple = n == 4 || n <= MAX_CLIPPED && !crossed::has_contact(&points);
    if simple {
        let triangles = clip_ears(&points);
        let turned_over = |t: &[u32; 3]| is_negative(t.map(|i| points[i as usize]));
        if !triangles.iter().any(turned_over) {
            return Cut::plain(triangles);
        }
    }
    crossed::cut(&points)
}

impl Cut {
    /// Adds the new corners of a face, whose corners are these vertices of a mesh, and returns its triangles.
    pub(crate) fn add_crossings(&self, mesh: &mut Mesh, face: &[u32]) -> Vec<[u32; 3]> {
        let first = mesh.positions.len() as u32;
        let vertex = |i: u32| face[i as usize] as usize;
        for crossing in &self.crossings {
            let [a, b] = crossing.edge.map(vertex);
            let t = crossing.t;
            add_between(&mut mesh.positions, a, b, |a: DVec3, b| a.lerp(b, t));
            add_between(&mut mesh.normals, a, b, |a: DVec3, b| a.lerp(b, t));
            add_between(&mut mesh.texcoords, a, b, |a: DVec2, b| a.lerp(b, t));
            add_between(&mut mesh.colors, a, b, |a: [f64; 4], b| {
                std::array::from_fn(|c| a[c] + (b[c] - a[c]) * t)
            });
        }
        let corner = |i: u32| match face.get(i as usize) {
            Some(vertex) => *vertex,
            None => first + i - face.len() as u32,
        };
        self.triangles.iter().map(|t| t.map(corner)).collect()
    }

    fn plain(triangles: Vec<[u32; 3]>) -> Self {
        Self {
            triangles,
            ..Self::default()
        }
    }
}

/// Adds what lies between two of a list; nothing where the list is empty, which says that there are none.
fn add_between<T: Copy>(list: &mut Vec<T>, a: usize, b: usize, between: impl Fn(T, T) -> T) {
    if let (Some(a), Some(b)) = (list.get(a).copied(), list.get(b).copied()) {
        list.push(between(a, b));
    }
}

fn fan(n: usize) -> Vec<[u32; 3]> {
    (1..n as u32 - 1).map(|i| [0, i, i + 1]).collect()
}

/// The face in the plane of its two smaller area components, turned so that its area is positive.
fn project(n: usize, position: impl Fn(usize) -> DVec3) -> Vec<DVec2> {
    let points = (0..n).map(&position);
    let area = area_vector(points.clone());
    let mut total: DVec3 = fan_areas(points.clone()).map(DVec3::abs).sum();
    // Where corners coincide, only the turns show the plane.
    for i in 0..n {
        let [a, b, c] = [i, i + 1, i + 2].map(|i| position(i % n));
        total += (b - a).cross(c - b).abs();
    }
    // What is left of areas that cancel says nothing about the plane.
    let left = total * (n as f64 * f64::EPSILON);
    let vanishes = area.abs().cmple(left).all();
    let size = if vanishes { total } else { area.abs() };
    let (flatten, sign): (fn(DVec3) -> DVec2, f64) = if size.x >= size.y && size.x >= size.z {
        (|p| DVec2::new(p.y, p.z), area.x)
    } else if size.y >= size.z {
        (|p| DVec2::new(p.z, p.x), area.y)
    } else {
        (|p| DVec2::new(p.x, p.y), area.z)
    };
    let mut flat: Vec<DVec2> = points.map(flatten).collect();
    let first_turn = || {
        let turns = (0..n).map(|i| cross(flat[(i + n - 1) % n], flat[i], flat[(i + 1) % n]));
        turns.into_iter().find(|turn| *turn != 0.0).unwrap_or(1.0)
    };
    let sign = if vanishes { first_turn() } else { sign };
    if sign < 0.0 {
        flat.iter_mut().for_each(|p| *p = DVec2::new(p.y, p.x));
    }
    flat
}

fn cross(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// The sign of [`cross`]; 0 where rounding leaves it open (Shewchuk 1997, the first bound of orient2d).
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    const BOUND: f64 = (3.0 + 16.0 * (f64::EPSILON / 2.0)) * (f64::EPSILON / 2.0);
    let (left, right) = ((a.x - c.x) * (b.y - c.y), (a.y - c.y) * (b.x - c.x));
    let det = left - right;
    if det.abs() > BOUND * (left.abs() + right.abs()) {
        det.signum()
    } else {
        0.0
    }
}

/// Whether a triangle is turned over for certain.
fn is_negative([a, b, c]: [DVec2; 3]) -> bool {
    turn(a, b, c) < 0.0
}

/// No corner turns right, the edges go round once, and no edge goes back on the one before it.
fn is_convex(points: &[DVec2]) -> bool {
    let n = points.len();
    let at = |i: usize| points[i % n];
    let mut turns = 0;
    let mut last_sign = 0.0;
    for i in 0..n {
        let turn = cross(at(i), at(i + 1), at(i + 2));
        if turn.is_nan() || turn < 0.0 || is_negative([at(0), at(i), at(i + 1)]) {
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

fn clip_ears(points: &[DVec2]) -> Vec<[u32; 3]> {
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
            triangles.push(corners.map(|i| i as u32));
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
    triangles.push([previous[current], current, next[current]].map(|i| i as u32));
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
                let triangles = triangulate(points.len(), |i| points[i]).triangles;
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
        let (_, total) = area(&points, &triangulate(points.len(), |i| points[i]).triangles);
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
        let corner = |i: usize| {
            let angle = i as f64 * std::f64::consts::TAU / 7.0;
            DVec3::new(libm::cos(angle), libm::sin(angle), 0.0)
        };
        let fan: Vec<[u32; 3]> = (1..6).map(|i| [0, i, i + 1]).collect();
        assert_eq!(triangulate(7, corner).triangles, fan);
        // The star through every third corner turns left everywhere, but goes round three times.
        let star = triangulate(7, |i| corner(3 * i % 7));
        assert_eq!(star.doubt, Some(Doubt::CrossesItself));
        assert_eq!(star.crossings.len(), 7);
    }
}
