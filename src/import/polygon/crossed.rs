//! Faces whose edges touch, overlap or cross: holes bridged through one vertex, spikes, figures that cross themselves.
//!
//! The package `i_triangle` (with `i_overlay`) does it, since robust arrangements are its subject: corners are placed on
//! a grid of whole numbers, edges are cut where they meet, what the outline goes round (winding number not 0) is kept and
//! swept into triangles in O(n log n). The grid has 2^-52 of the face's size, and corners that are not new are the face's
//! own again afterwards, so nothing moves. Tried beside it (2026-12): ear clipping that tells coincident corners apart is
//! right for holes that touch, but finds no new corners; earcut's cures for crossings do not keep the winding number.

use std::collections::HashMap;

use i_triangle::i_overlay::i_float::int::point::IntPoint;
use i_triangle::int::triangulatable::IntTriangulatable;
use i_triangle::int::triangulation::RawIntTriangulation;

use super::{Crossing, Cut, Doubt, cross, fan, turn};
use crate::math::DVec2;

/// Most crossings of a face that are resolved.
pub(super) const MAX_CROSSINGS: usize = 1 << 18;
/// A face's size is so many steps of the grid, as a power of two.
const GRID_BITS: i32 = 52;

/// How two edges that are no neighbours meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Contact {
    None,
    /// They share a point or a stretch, or rounding leaves open whether they do.
    Touch,
    Cross,
}

/// Whether any two edges share more than the corner between them.
pub(super) fn has_contact(points: &[DVec2]) -> bool {
    let mut found = false;
    each_close_pair(points, |a, b| {
        found |= contact(points, a, b) != Contact::None;
        !found
    });
    found
}

/// The edges that cross another, by the neighbourhood of the place; none where they cross too often.
fn crossings(points: &[DVec2], grid: &Grid) -> Option<HashMap<(i64, i64), u32>> {
    let n = points.len();
    let mut count = 0;
    let mut edge_at = HashMap::new();
    each_close_pair(points, |a, b| {
        if contact(points, a, b) == Contact::Cross {
            count += 1;
            let [p, q, r, s] = [a, a + 1, b, b + 1].map(|i| points[i % n]);
            let (c, d) = (cross(r, s, p), cross(r, s, q));
            let place = grid.place(p + (q - p) * (c / (c - d)));
            edge_at.entry(neighbourhood(place)).or_insert(a as u32);
        }
        count <= MAX_CROSSINGS
    });
    (count <= MAX_CROSSINGS).then_some(edge_at)
}

/// Places that the rounding of a crossing may exchange, mostly.
fn neighbourhood(place: IntPoint<i64>) -> (i64, i64) {
    (place.x >> 8, place.y >> 8)
}

/// Calls with each two edges whose boxes meet, by their first corners, as long as it says true.
fn each_close_pair(points: &[DVec2], mut call: impl FnMut(usize, usize) -> bool) {
    let n = points.len();
    let ends = |i: usize| (points[i], points[(i + 1) % n]);
    let low = |i: usize| ends(i).0.min(ends(i).1);
    let high = |i: usize| ends(i).0.max(ends(i).1);
    let mut order: Vec<(usize, DVec2, DVec2)> = (0..n).map(|i| (i, low(i), high(i))).collect();
    order.sort_by(|a, b| a.1.x.total_cmp(&b.1.x).then(a.0.cmp(&b.0)));
    for (at, (a, low, high)) in order.iter().enumerate() {
        for (b, other_low, other_high) in &order[at + 1..] {
            if other_low.x > high.x {
                break;
            }
            let apart = other_low.y > high.y || other_high.y < low.y;
            if !apart && !call(*a, *b) {
                return;
            }
        }
    }
}

/// How two edges meet; neighbours may share their corner.
fn contact(points: &[DVec2], a: usize, b: usize) -> Contact {
    let n = points.len();
    let at = |i: usize| points[i % n];
    if (a + 1) % n == b || (b + 1) % n == a {
        let first = if (a + 1) % n == b { a } else { b };
        let [p, q, r] = [first, first + 1, first + 2].map(at);
        let back = turn(p, q, r) == 0.0 && (q - p).dot(r - q) < 0.0;
        return if back { Contact::Touch } else { Contact::None };
    }
    let [p, q, r, s] = [a, a + 1, b, b + 1].map(at);
    let (c, d) = (turn(p, q, r), turn(p, q, s));
    let (e, f) = (turn(r, s, p), turn(r, s, q));
    match (c * d, e * f) {
        (cd, ef) if cd < 0.0 && ef < 0.0 => Contact::Cross,
        (cd, ef) if cd > 0.0 || ef > 0.0 => Contact::None,
        _ => Contact::Touch,
    }
}

/// Cuts a face into triangles by winding number.
pub(super) fn cut(points: &[DVec2]) -> Cut {
    let n = points.len();
    let Some(grid) = Grid::new(points) else {
        return Cut::plain(fan(n));
    };
    let Some(edge_at) = crossings(points, &grid) else {
        return Cut {
            triangles: fan(n),
            doubt: Some(Doubt::TooManyCrossings),
            ..Cut::default()
        };
    };
    let outline: Vec<IntPoint<i64>> = points.iter().map(|p| grid.place(*p)).collect();
    let found: RawIntTriangulation<i64> = outline.triangulate();
    if found.is_empty() {
        // Nothing is inside.
        return Cut::plain(vec![[0, 1, 1]]);
    }
    let places = Places::new(points, &outline);
    let mut corners = Corners {
        points,
        grid: &grid,
        places: &places,
        edge_at: &edge_at,
        crossings: Vec::new(),
        number_of: HashMap::new(),
    };
    let mut covered = 0.0;
    let indices: Vec<usize> = found.triangle_indices();
    let triangles = indices.chunks_exact(3).map(|t| {
        let mut t = [t[0], t[1], t[2]].map(|i| found.points()[i]);
        let [a, b, c] = t.map(|p| grid.point(p));
        if cross(a, b, c) < 0.0 {
            t.swap(1, 2);
        }
        covered += cross(a, b, c).abs();
        let middle = (a + b + c) / 3.0;
        t.map(|p| corners.corner(p, middle))
    });
    let triangles = triangles.collect();
    let outlined: f64 = (1..n - 1)
        .map(|i| cross(points[0], points[i], points[i + 1]))
        .sum();
    // Each place once and the right way round, or not: far beyond the rounding of sums and of the grid.
    let once = (covered - outlined).abs() <= 1e-9 * covered;
    let doubt = !once || !corners.crossings.is_empty();
    Cut {
        triangles,
        crossings: corners.crossings,
        doubt: doubt.then_some(Doubt::CrossesItself),
    }
}

/// Whole numbers for places. The step is a power of two, so that most corners lie on the grid exactly.
struct Grid {
    middle: DVec2,
    scale: f64,
}

impl Grid {
    /// None for a face without size.
    fn new(points: &[DVec2]) -> Option<Self> {
        let low = points.iter().copied().reduce(DVec2::min)?;
        let high = points.iter().copied().reduce(DVec2::max)?;
        let size = (high - low).max_element();
        let (_, exponent) = libm::frexp(size);
        let scale = libm::ldexp(1.0, GRID_BITS - exponent);
        // The corner at the middle of the list keeps differences exact where a middle of the bounds would not.
        let middle = points[0];
        (size > 0.0 && scale.is_finite() && (1.0 / scale) > 0.0).then_some(Self { middle, scale })
    }

    fn place(&self, p: DVec2) -> IntPoint<i64> {
        let q = ((p - self.middle) * self.scale).round();
        IntPoint::new(q.x as i64, q.y as i64)
    }

    fn point(&self, p: IntPoint<i64>) -> DVec2 {
        DVec2::new(p.x as f64, p.y as f64) / self.scale + self.middle
    }
}

/// The corners at each place of the grid.
struct Places(HashMap<(i64, i64), Vec<u32>>);

impl Places {
    fn new(points: &[DVec2], outline: &[IntPoint<i64>]) -> Self {
        let mut places: HashMap<(i64, i64), Vec<u32>> = HashMap::with_capacity(points.len());
        for (i, p) in outline.iter().enumerate() {
            places.entry((p.x, p.y)).or_default().push(i as u32);
        }
        Self(places)
    }
}

/// Finds the corner of the face, or makes a new one.
struct Corners<'a> {
    points: &'a [DVec2],
    grid: &'a Grid,
    places: &'a Places,
    edge_at: &'a HashMap<(i64, i64), u32>,
    crossings: Vec<Crossing>,
    number_of: HashMap<(i64, i64), u32>,
}

impl Corners<'_> {
    /// The corner at a place of the grid, of a triangle around `middle`.
    fn corner(&mut self, p: IntPoint<i64>, middle: DVec2) -> u32 {
        let key = (p.x, p.y);
        if let Some(here) = self.places.0.get(&key) {
            let owns = |i: &&u32| self.is_within(**i as usize, middle);
            return here.iter().find(owns).map_or(here[0], |i| *i);
        }
        if let Some(number) = self.number_of.get(&key) {
            return *number;
        }
        let number = (self.points.len() + self.crossings.len()) as u32;
        self.crossings.push(self.crossing(p));
        self.number_of.insert(key, number);
        number
    }

    /// Whether a place lies between the edges of a corner, on the left of the outline.
    fn is_within(&self, corner: usize, place: DVec2) -> bool {
        let n = self.points.len();
        let at = self.points[corner];
        let differs = |i: &usize| self.points[*i] != at;
        let next = (1..n).map(|k| (corner + k) % n).find(differs);
        let previous = (1..n).map(|k| (corner + n - k) % n).find(differs);
        let (Some(next), Some(previous)) = (next, previous) else {
            return false;
        };
        let (next, previous) = (self.points[next], self.points[previous]);
        let (left, right) = (
            cross(at, next, place) >= 0.0,
            cross(at, place, previous) >= 0.0,
        );
        // A reflex corner has all that is not on its outside.
        if cross(previous, at, next) >= 0.0 {
            left && right
        } else {
            left || right
        }
    }

    /// The edge that a place is on, and where on it.
    fn crossing(&self, p: IntPoint<i64>) -> Crossing {
        let place = self.grid.point(p);
        let (x, y) = neighbourhood(p);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| (x + i, y + j)));
        let known = around.filter_map(|key| self.edge_at.get(&key)).copied();
        let nearest = known.map(|edge| self.project(place, edge)).reduce(nearer);
        // Edges that are nearly in line cross at no place that is known so well.
        let all = || (0..self.points.len() as u32).map(|edge| self.project(place, edge));
        let step = 1.0 / self.grid.scale;
        let (_, edge, t) = match nearest.filter(|(distance, ..)| *distance <= 4.0 * step * step) {
            Some(found) => found,
            None => all().reduce(nearer).unwrap_or_default(),
        };
        let next = (edge + 1) % self.points.len() as u32;
        Crossing {
            edge: [edge, next],
            t,
        }
    }

    /// The squared distance of a place from an edge, the edge, and where on it is the nearest point.
    fn project(&self, place: DVec2, edge: u32) -> (f64, u32, f64) {
        let from = edge as usize;
        let (a, b) = (
            self.points[from],
            self.points[(from + 1) % self.points.len()],
        );
        let length = (b - a).length_squared();
        let t = match length > 0.0 {
            true => ((place - a).dot(b - a) / length).clamp(0.0, 1.0),
            false => 0.0,
        };
        (a.lerp(b, t).distance_squared(place), edge, t)
    }
}

fn nearer(a: (f64, u32, f64), b: (f64, u32, f64)) -> (f64, u32, f64) {
    if b.0 < a.0 { b } else { a }
}
