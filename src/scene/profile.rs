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
//! Everything is turned into Bezier segments, and these into pieces whose control points rise or fall in both
//! coordinates: cut where a derivative is 0, with its tangent set exactly there, then halved as long as it takes. What that
//! rounds (f64) is part of the definition: the *pieces* are the exact shape. A zero of a derivative within 2^-30 of a
//! segment's end is no place to cut; moving the control points in order changes less than f64 can tell.

use std::borrow::Cow;

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

/// A stretch of profile that is monotone in radius and in height: a Bezier curve of degree 1 or 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// 1 or 3; its `degree` + 1 first control points count, the others are 0.
    pub degree: usize,
    /// Radii of the control points, >= 0, rising or falling.
    pub r: [f64; 4],
    /// Heights of the control points, rising or falling.
    pub z: [f64; 4],
}

/// A checked profile.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    pieces: Vec<Piece>,
    closed: bool,
}

/// The part of a segment at either end within which no zero of a derivative is looked for.
const NO_CUT: f64 = 1.0 / (1u64 << 30) as f64;
/// Halvings of a part whose control points are not in order.
const HALVINGS: u32 = 8;

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
        segments.extend(through.windows(4).map(catmull_rom));
        first = last + usize::from(last + 1 < n && points[last] == points[last + 1]);
    }
    segments
}

/// The segment between the middle two of four points, with knots at the square roots of their distances.
fn catmull_rom(p: &[DVec2]) -> Piece {
    let knot = |i: usize| libm::hypot(p[i + 1].x - p[i].x, p[i + 1].y - p[i].y).sqrt();
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

impl Piece {
    fn line(ends: &[DVec2]) -> Self {
        Self {
            degree: 1,
            r: [ends[0].x, ends[1].x, 0.0, 0.0],
            z: [ends[0].y, ends[1].y, 0.0, 0.0],
        }
    }

    fn cubic(p: [DVec2; 4]) -> Self {
        Self {
            degree: 3,
            r: p.map(|p| p.x),
            z: p.map(|p| p.y),
        }
    }

    /// The point (radius, height) at a parameter in 0..=1; the ends are exact.
    pub fn at(&self, s: f64) -> DVec2 {
        if s == 1.0 {
            return DVec2::new(self.r[self.degree], self.z[self.degree]);
        }
        DVec2::new(
            bezier(&self.r[..=self.degree], s),
            bezier(&self.z[..=self.degree], s),
        )
    }

    /// Derivative at a parameter; where the curve stands still, the way to the next control point that is elsewhere.
    pub fn tangent(&self, s: f64) -> DVec2 {
        let n = self.degree;
        let slope = |c: &[f64; 4]| {
            let d = [0, 1, 2].map(|i| c[i + 1] - c[i]);
            n as f64 * bezier(&d[..n], s)
        };
        let found = DVec2::new(slope(&self.r), slope(&self.z));
        if found != DVec2::ZERO {
            return found;
        }
        let control = |i: usize| DVec2::new(self.r[i], self.z[i]);
        let way = |from: usize, to: usize| control(to) - control(from);
        let at_start = (1..=n).map(|i| way(0, i));
        let at_end = (0..n).rev().map(|i| way(i, n));
        let elsewhere = |d: &DVec2| *d != DVec2::ZERO;
        let found = if s < 0.5 {
            at_start.clone().find(elsewhere)
        } else {
            at_end.clone().find(elsewhere)
        };
        found.unwrap_or(DVec2::ZERO)
    }

    /// The largest second derivative is at most this long.
    pub fn bend(&self) -> f64 {
        if self.degree < 3 {
            return 0.0;
        }
        let second = |c: &[f64; 4], i: usize| c[i] - 2.0 * c[i + 1] + c[i + 2];
        let at = |i: usize| 6.0 * DVec2::new(second(&self.r, i), second(&self.z, i)).length();
        at(0).max(at(1))
    }

    /// Least and greatest value of `a` radius + `b` height on the piece.
    pub fn extremes(&self, a: f64, b: f64) -> [f64; 2] {
        let values = [0, 1, 2, 3].map(|i| a * self.r[i] + b * self.z[i]);
        let values = &values[..=self.degree];
        let (mut low, mut high) = (values[0], values[self.degree]);
        if high < low {
            (low, high) = (high, low);
        }
        for s in stops(values) {
            let x = bezier(values, s);
            (low, high) = (low.min(x), high.max(x));
        }
        [low, high]
    }

    /// Integral of the radius over the height.
    fn area(&self) -> f64 {
        let n = self.degree;
        let choose: [[f64; 4]; 6] = [
            [1.0, 0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0, 0.0],
            [1.0, 2.0, 1.0, 0.0],
            [1.0, 3.0, 3.0, 1.0],
            [0.0; 4],
            [1.0, 5.0, 10.0, 10.0],
        ];
        let all = |k: usize| choose[2 * n - 1][k.min(2 * n - 1 - k)];
        let mut sum = 0.0;
        for i in 0..=n {
            for j in 0..n {
                let weight = choose[n][i] * choose[n - 1][j] / all(i + j);
                sum += weight * self.r[i] * (self.z[j + 1] - self.z[j]);
            }
        }
        sum / 2.0
    }

    fn reverse(&mut self) {
        self.r[..=self.degree].reverse();
        self.z[..=self.degree].reverse();
    }

    /// The two parts before and after a parameter.
    fn cut(&self, s: f64) -> [Self; 2] {
        let cut = |c: &[f64; 4]| {
            let (mut before, mut after, mut row) = (*c, *c, *c);
            for level in 1..=self.degree {
                for i in 0..=self.degree - level {
                    row[i] = between(row[i], row[i + 1], s);
                }
                before[level] = row[0];
                after[self.degree - level] = row[self.degree - level];
            }
            [before, after]
        };
        let ([r0, r1], [z0, z1]) = (cut(&self.r), cut(&self.z));
        let part = |r, z| Self { r, z, ..*self };
        [part(r0, z0), part(r1, z1)]
    }

    /// Appends the monotone pieces of a segment.
    fn into_monotone(self, out: &mut Vec<Self>) {
        let n = self.degree;
        let mut places: Vec<(f64, bool)> = stops(&self.r[..=n])
            .map(|s| (s, true))
            .chain(stops(&self.z[..=n]).map(|s| (s, false)))
            .filter(|(s, _)| *s > NO_CUT && *s < 1.0 - NO_CUT)
            .collect();
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut rest, mut done) = (self, 0.0);
        for (s, of_r) in places {
            let [mut before, mut after] = rest.cut((s - done) / (1.0 - done));
            let still = |piece: &mut Self, from: usize, to: usize| {
                let c = if of_r { &mut piece.r } else { &mut piece.z };
                c[to] = c[from];
            };
            still(&mut before, 3, 2);
            still(&mut after, 0, 1);
            before.into_ordered(HALVINGS, out);
            (rest, done) = (after, s);
        }
        rest.into_ordered(HALVINGS, out);
    }

    /// Appends the parts of a monotone stretch whose control points are in order, too.
    fn into_ordered(mut self, halvings: u32, out: &mut Vec<Self>) {
        let n = self.degree;
        let ordered = |c: &[f64; 4]| {
            let (low, high) = (c[0].min(c[n]), c[0].max(c[n]));
            let mut ordered = *c;
            for i in 1..n {
                // Towards the far end, and never back.
                let (from, to) = (ordered[i - 1], c[n]);
                ordered[i] = c[i].clamp(low, high).clamp(from.min(to), from.max(to));
            }
            ordered
        };
        let (r, z) = (ordered(&self.r), ordered(&self.z));
        if halvings > 0 && (r, z) != (self.r, self.z) {
            for half in self.cut(0.5) {
                half.into_ordered(halvings - 1, out);
            }
            return;
        }
        (self.r, self.z) = (r, z);
        let stays = r[0] == r[n] && z[0] == z[n];
        let on_axis = r[0] == 0.0 && r[n] == 0.0;
        if !stays && !on_axis {
            out.push(self);
        }
    }
}

/// a + s (b - a), exact at both ends and where they are equal.
fn between(a: f64, b: f64, s: f64) -> f64 {
    if s == 1.0 { b } else { a + s * (b - a) }
}

/// A Bezier polynomial at a parameter (de Casteljau).
fn bezier(c: &[f64], s: f64) -> f64 {
    let mut row = [0.0; 4];
    row[..c.len()].copy_from_slice(c);
    for level in 1..c.len() {
        for i in 0..c.len() - level {
            row[i] = between(row[i], row[i + 1], s);
        }
    }
    row[0]
}

/// Where a cubic Bezier polynomial stands still, inside 0..1; a line does nowhere.
fn stops(c: &[f64]) -> impl Iterator<Item = f64> {
    let roots = match *c {
        [c0, c1, c2, c3] => {
            // d0 (1-s)^2 + 2 d1 s (1-s) + d2 s^2 = square s^2 + 2 half s + d0
            let (d0, d1, d2) = (c1 - c0, c2 - c1, c3 - c2);
            let (square, half) = (d0 - 2.0 * d1 + d2, d1 - d0);
            let root = (half * half - square * d0).sqrt();
            let sum = if half < 0.0 {
                root - half
            } else {
                -half - root
            };
            [sum / square, d0 / sum]
        }
        _ => [f64::NAN; 2],
    };
    roots.into_iter().filter(|s| *s > 0.0 && *s < 1.0)
}
