//! Profiles of surfaces of revolution: points (radius, height) to the pieces of curve that are the exact shape.
//!
//! A profile is drawn with the radius to the right and the axis up. Its front is to the right of the way it is
//! travelled: outside, where it goes up. A profile that encloses an area - both ends on the axis, or the last point equal
//! to the first - has its front outside whichever way it goes; an open one written backwards is turned inside out.
//!
//! | curve | through the points |
//! | - | - |
//! | `polyline` | straight pieces; every point is a crease |
//! | `smooth` | the centripetal Catmull-Rom spline (Barry and Goldman 1988; Yuksel, Schaefer and Keyser 2011), whose segments have no cusp or loop of their own |
//! | `bezier` | cubic Bezier segments: point, control, control, point, control, control, point ... |
//!
//! The spline ends as if its first (last) segment went straight on; on the axis as if it went on as its own mirror image,
//! so that poles are round. A point written twice is a crease; a ring is smooth where it closes. Control points that would
//! cross the axis are put on it, so the radius is never negative.
//!
//! Everything is turned into Bezier segments, and these into monotone pieces ([`super::piece`]). What that rounds (f64) is
//! part of the definition: the *pieces* are the exact shape.

use std::borrow::Cow;

pub use super::piece::Piece;
use crate::lanes::Real;
use crate::math::DVec2;

/// How a profile's points are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curve {
    /// Straight pieces.
    #[default]
    Polyline,
    /// A smooth curve through all points.
    Smooth,
    /// Cubic Bezier segments, given by their control points.
    Bezier,
}

impl Curve {
    /// Names in scene files.
    pub const NAMES: &'static [(&'static str, Self)] = &[
        ("polyline", Self::Polyline),
        ("smooth", Self::Smooth),
        ("bezier", Self::Bezier),
    ];
}

/// Largest number of points of a profile.
pub const MAX_POINTS: usize = 1024;

/// What is wrong with a list of points.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// Index of the point it shows at; `None` = the list as a whole.
    pub point: Option<usize>,
    /// What is wrong and what was expected.
    pub message: Cow<'static, str>,
}

/// A checked profile.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    pieces: Vec<Piece>,
    closed: bool,
}

impl Profile {
    /// The profile through points (radius, height).
    ///
    /// ```
    /// use rastray::scene::profile::{Curve, Profile};
    /// let cone = Profile::new(Curve::Polyline, &[[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]]).unwrap();
    /// assert!(cone.is_closed() && cone.pieces().len() == 2 && cone.radius() == 1.0);
    /// let flaw = Profile::new(Curve::Polyline, &[[0.0, 0.0], [-1.0, 0.0]]).unwrap_err();
    /// assert_eq!(flaw.point, Some(1));
    /// ```
    pub fn new(curve: Curve, points: &[[f64; 2]]) -> Result<Self, Flaw> {
        check(curve, points)?;
        let points: Vec<DVec2> = points.iter().map(|p| DVec2::from_array(*p)).collect();
        let segments = match curve {
            Curve::Polyline => points.windows(2).map(Piece::line).collect(),
            Curve::Smooth => spline(&points),
            Curve::Bezier => (0..points.len() / 3)
                .map(|i| Piece::cubic([0, 1, 2, 3].map(|k| points[3 * i + k])))
                .collect(),
        };
        let mut pieces = Vec::with_capacity(segments.len());
        for segment in segments {
            segment.into_monotone(&mut pieces);
        }
        let (first, last) = (points[0], points[points.len() - 1]);
        let closed = first == last || (first.x == 0.0 && last.x == 0.0);
        if closed {
            let area: f64 = pieces.iter().map(Piece::area).sum();
            if area == 0.0 {
                return Err(Flaw::whole("it is closed but encloses no area"));
            }
            if area < 0.0 {
                pieces.reverse();
                pieces.iter_mut().for_each(Piece::reverse);
            }
        }
        Ok(Self { pieces, closed })
    }

    /// The exact shape, in order; each begins where the one before it ends.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Whether it encloses a solid: both ends are on the axis, or it is a ring.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The largest radius.
    pub fn radius(&self) -> f64 {
        self.ends().fold(0.0, |most, p| most.max(p.x))
    }

    /// Lowest and highest point.
    pub fn heights(&self) -> [f64; 2] {
        self.ends()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| {
                [low.min(p.y), high.max(p.y)]
            })
    }

    /// Ends of the pieces, which are their extremes.
    fn ends(&self) -> impl Iterator<Item = DVec2> {
        self.pieces.iter().flat_map(|p| [p.at(0.0), p.at(1.0)])
    }
}

impl Flaw {
    fn whole(message: impl Into<Cow<'static, str>>) -> Self {
        let message = message.into();
        Self {
            point: None,
            message,
        }
    }

    fn at(point: usize, message: impl Into<Cow<'static, str>>) -> Self {
        Self {
            point: Some(point),
            ..Self::whole(message)
        }
    }
}

/// Refuses lists that make no surface.
fn check(curve: Curve, points: &[[f64; 2]]) -> Result<(), Flaw> {
    let n = points.len();
    let needed = if curve == Curve::Bezier { 4 } else { 2 };
    if !(needed..=MAX_POINTS).contains(&n) {
        let message = format!("expected {needed} to {MAX_POINTS} points, found {n}");
        return Err(Flaw::whole(message));
    }
    if curve == Curve::Bezier && n % 3 != 1 {
        let message =
            format!("expected 3 n + 1 points for n Bezier segments (4, 7, 10 ...), found {n}");
        return Err(Flaw::whole(message));
    }
    for (i, [r, z]) in points.iter().enumerate() {
        if !(r.is_finite() && z.is_finite()) {
            return Err(Flaw::at(i, "expected finite numbers"));
        }
        if *r < 0.0 {
            let message = format!("expected a radius of 0 or more, found {r:?}");
            return Err(Flaw::at(i, message));
        }
    }
    if points.iter().all(|p| p[0] == 0.0) {
        return Err(Flaw::whole("all its points are on the axis"));
    }
    let (step, size) = if curve == Curve::Bezier {
        (3, 4)
    } else {
        (1, 2)
    };
    for (i, part) in points.windows(size).enumerate().step_by(step) {
        let same = part.iter().all(|p| *p == part[0]);
        if same && !(curve == Curve::Smooth && is_crease(points, i)) {
            let message = match curve {
                Curve::Polyline => "the same point twice in a row",
                Curve::Smooth => {
                    "the same point twice in a row is a crease, which needs another point on each side"
                }
                Curve::Bezier => "all four points of this segment are the same",
            };
            return Err(Flaw::at(i + size - 1, message));
        }
        if !same && part.iter().all(|p| p[0] == 0.0) {
            let message = "it lies on the axis and so does the one before it: nothing to turn";
            return Err(Flaw::at(i + size - 1, message));
        }
    }
    Ok(())
}

/// Whether points `i` and `i + 1`, which are the same, have others on both sides.
fn is_crease(points: &[[f64; 2]], i: usize) -> bool {
    let p = points[i];
    i > 0 && points[i - 1] != p && points.get(i + 2).is_some_and(|after| *after != p)
}

/// The Catmull-Rom segments through points; doubled points, and points on the axis, end one spline and begin the next.
fn spline(points: &[DVec2]) -> Vec<Piece> {
    let n = points.len();
    let largest = points
        .iter()
        .fold(0.0f64, |most, p| most.max(p.abs().max_element()));
    let (down, _) = largest.power_of_two_scale();
    let is_ring = points[0] == points[n - 1];
    let mut segments = Vec::with_capacity(n);
    let mut first = 0;
    while first + 1 < n {
        let ends = |i: usize| points[i].x == 0.0 || points[i] == points[i + 1];
        let last = (first + 1..n - 1).find(|i| ends(*i)).unwrap_or(n - 1);
        // What the curve would pass beyond its end `at`, `next` being the point before it.
        let beyond = |at: DVec2, next: DVec2, around: Option<DVec2>| match around {
            _ if at.x == 0.0 => DVec2::new(-next.x, next.y),
            Some(p) => p,
            None => 2.0 * at - next,
        };
        let run = &points[first..=last];
        let (closes, opens) = (is_ring && first == 0, is_ring && last == n - 1);
        let mut through = Vec::with_capacity(run.len() + 2);
        through.push(beyond(run[0], run[1], closes.then(|| points[n - 2])));
        through.extend(run);
        let (end, before) = (run[run.len() - 1], run[run.len() - 2]);
        through.push(beyond(end, before, opens.then(|| points[1])));
        segments.extend(through.windows(4).map(|p| catmull_rom(p, down)));
        first = last + usize::from(last + 1 < n && points[last] == points[last + 1]);
    }
    segments
}

/// The segment between the middle two of four points, with knots at the square roots of their distances.
///
/// Distances are first multiplied by `down`, the power of two that brings the whole profile near 1: so a profile twice as
/// large has pieces exactly twice as large, although the root of 2 is no power of two.
fn catmull_rom(p: &[DVec2], down: f64) -> Piece {
    let distance = |i: usize| libm::hypot(p[i + 1].x - p[i].x, p[i + 1].y - p[i].y);
    let knot = |i: usize| (distance(i) * down).sqrt();
    let (a, b, c) = (knot(0), knot(1), knot(2));
    let leave = tangent([p[0], p[1], p[2]], a, b);
    let arrive = tangent([p[1], p[2], p[3]], b, c);
    let third = b / 3.0;
    let on_this_side = |p: DVec2| DVec2::new(p.x.max(0.0), p.y);
    Piece::cubic([
        p[1],
        on_this_side(p[1] + third * leave),
        on_this_side(p[2] - third * arrive),
        p[2],
    ])
}

/// Derivative at the middle of three points whose knots are `a` and `b` apart: that of the parabola through them.
fn tangent(p: [DVec2; 3], a: f64, b: f64) -> DVec2 {
    let (before, after) = ((p[1] - p[0]) / a, (p[2] - p[1]) / b);
    (b * before + a * after) / (a + b)
}
