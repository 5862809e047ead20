//! Pieces of a profile: Bezier curves of degree 1 or 3 in the half plane (radius, height), monotone in both.
//!
//! A segment becomes pieces whose control points rise or fall in both coordinates: it is cut where a derivative is 0, with
//! the tangent set exactly there, then halved as long as it takes. So ends are extremes, and a height has one parameter. A
//! zero of a derivative within 2^-30 of a segment's end is no place to cut; putting the control points in order changes less
//! than f64 can tell. Plain f64; the ends are exact.

use crate::math::DVec2;

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

/// The part of a segment at either end within which no zero of a derivative is looked for.
const NO_CUT: f64 = 1.0 / (1u64 << 30) as f64;
/// Halvings of a part whose control points are not in order.
const HALVINGS: u32 = 8;

impl Piece {
    pub(super) fn line(ends: &[DVec2]) -> Self {
        Self {
            degree: 1,
            r: [ends[0].x, ends[1].x, 0.0, 0.0],
            z: [ends[0].y, ends[1].y, 0.0, 0.0],
        }
    }

    pub(super) fn cubic(p: [DVec2; 4]) -> Self {
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
    pub(super) fn area(&self) -> f64 {
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

    pub(super) fn reverse(&mut self) {
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
    pub(super) fn into_monotone(self, out: &mut Vec<Self>) {
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
