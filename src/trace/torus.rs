//! Ring tori in their own space: up to four roots of a quartic.
//!
//! F(p) = (|p|^2 + R^2 - r^2)^2 - 4 R^2 (|p|^2 - (p.n)^2) is below 0 inside. Along p0 + s d it is a quartic in s.
//!
//! *Conditioning.* The origin is first moved to the ray's point nearest to the centre and lengths are scaled by a power of
//! two near R, so every coefficient is at most about 10 and comes in pairs: its error is near 2^-100 of R^4, for origins up
//! to 2^40 radii away still 2^-60 of it. F near the surface changes by 4 R^2 times r^2, so even a ring with r = 1e-8 R
//! keeps ten digits.
//!
//! *Roots.* They lie where the ray is inside the ball of radius 1.01 (R + r) and the slab |p.n| <= 1.01 r, at whose ends
//! F > 0. The roots of F'' split that interval where F' is monotone; its roots split it where F is; there each change of
//! sign is one root, found by Newton's method held in its bracket and polished once in pairs. So their number is even and
//! entry and exit alternate, whatever is rounded. A ray that touches has F = 0 at a root of F', which is known to about
//! 2^-50 of the interval; F is flat there, so touching is decided to about 2^-100 of R^4. No other tolerance: no epsilon.
//!
//! The point is centre + R e + r n. Checked against exact products and a scan of F (tests).

use super::cylinder::split;
use super::exact::{Twofold, dot2, pairs, unit, values};
use super::isolate::root;
use super::span::{Spot, along, unit_scale};
use crate::math::DVec3;
use crate::math::Each;

/// A ring torus; its anchor is its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// Axis, unit length within rounding.
    pub axis: DVec3,
    /// Distance of the tube's middle from the centre.
    pub major: f64,
    /// Radius of the tube, below `major`.
    pub minor: f64,
}

/// Room around the torus, so that F > 0 at its border.
const ROOM: f64 = 1.01;

/// Coefficients of s^0 .. s^4.
type Quartic = [Twofold; 5];

/// The quartic of a ray, its interval, and how to get back to the ray's own t = (s + start) * units.
struct Setup {
    quartic: Quartic,
    interval: [f64; 2],
    start: f64,
    units: f64,
}

impl Torus {
    /// Where the ray crosses the surface, in order: entry, exit, entry, exit. `q` leads from its origin to the centre.
    ///
    /// ```
    /// use rastray::{math::DVec3, trace::torus::Torus};
    /// let ring = Torus { axis: DVec3::Y, major: 2.0, minor: 0.5 };
    /// let t = ring.crossings([8.0, 0.0, 0.0].map(Into::into), DVec3::X);
    /// assert_eq!(t.map(|t| t.unwrap().value()), [5.5, 6.5, 9.5, 10.5]);
    /// ```
    pub fn crossings(&self, q: [Twofold; 3], d: DVec3) -> [Option<Twofold>; 4] {
        let mut found = [None; 4];
        let Some(setup) = self.setup(q, d) else {
            return found;
        };
        let (nodes, count) = nodes(&setup.quartic, setup.interval);
        let mut number = 0;
        let mut inside = false;
        for pair in nodes[..count].windows(2) {
            let last = pair[1] == setup.interval[1];
            // A touching point, F = 0, counts as inside; the far end is outside by construction.
            let next = !last && horner(&setup.quartic, pair[1]).value() <= 0.0;
            if next != inside && number < 4 {
                let s = monotone_root(&setup.quartic, pair[0], pair[1], inside);
                let t = (s + Twofold::from(setup.start)).scaled(setup.units);
                found[number] = Some(t).filter(|t| t.value().is_finite());
                number += 1;
            }
            inside = next;
        }
        found
    }

    fn setup(&self, q: [Twofold; 3], d: DVec3) -> Option<Setup> {
        use crate::lanes::Real;
        let (d_down, _) = unit_scale(d)?;
        let (down, _) = self.major.power_of_two_scale();
        let (big, small) = (self.major * down, self.minor * down);
        let (q, d) = (q.each(|x| x.scaled(down)), d * d_down);
        // Move to the point nearest to the centre, or near it.
        let start = values(q).dot(d) / d.length_squared();
        if !start.is_finite() {
            return None;
        }
        let p = along(q, d, Twofold::from(start));
        let d2 = pairs(d);
        let n = pairs(self.axis);
        let nn = dot2(n, n);
        let (g, h) = (
            [dot2(p, p), dot2(p, d2), dot2(d2, d2)],
            [dot2(p, n), dot2(d2, n)],
        );
        let plain = [g.each(Twofold::value), [h[0].value(), h[1].value(), 0.0]];
        let interval = room(
            ROOM * (big + small),
            ROOM * small * nn.value().sqrt(),
            plain,
        )?;
        // Coefficients of |p|^2 + R^2 - r^2 and of the distance from the axis squared.
        let (rr, ss) = (square(big), square(small));
        let e = [g[0] + rr - ss, g[1].scaled(2.0), g[2]];
        let ring = rr.scaled(4.0);
        let across = [
            g[0] - h[0] * h[0] / nn,
            (g[1] - h[0] * h[1] / nn).scaled(2.0),
            g[2] - h[1] * h[1] / nn,
        ];
        let quartic = [
            e[0] * e[0] - ring * across[0],
            (e[0] * e[1]).scaled(2.0) - ring * across[1],
            e[1] * e[1] + (e[0] * e[2]).scaled(2.0) - ring * across[2],
            (e[1] * e[2]).scaled(2.0),
            e[2] * e[2],
        ];
        let finite = quartic.iter().all(|c| c.value().is_finite());
        finite.then_some(Setup {
            quartic,
            interval,
            start,
            units: d_down / down,
        })
    }

    /// The point of a crossing, from the centre, and its normal.
    pub fn spot(&self, q: [Twofold; 3], d: DVec3, crossing: usize) -> Option<Spot> {
        let t = (*self.crossings(q, d).get(crossing)?)?;
        let axis = pairs(self.axis);
        let (height, across) = split(along(q, d, t), axis);
        // Away from the ring: the part across is longer or shorter than R.
        let distance = dot2(across, across).sqrt();
        let part = Twofold::from(1.0) - Twofold::from(self.major) / distance;
        let away = [0, 1, 2].each(|k| part * across[k] + height * axis[k]);
        let normal = unit(values(away));
        let offset = self.major * unit(values(across)) + self.minor * normal;
        Some(Spot { offset, normal })
    }
}

fn square(x: f64) -> Twofold {
    Twofold::from(x) * Twofold::from(x)
}

/// The part of the ray inside a ball and a slab about the centre, from |p|^2 = g0 + 2 g1 s + g2 s^2, p.n = h0 + h1 s.
fn room(ball: f64, slab: f64, [g, h]: [[f64; 3]; 2]) -> Option<[f64; 2]> {
    let middle = -g[1] / g[2];
    let chord = (ball * ball - g[0]) / g[2] + middle * middle;
    if !(chord > 0.0 && chord.is_finite()) {
        return None;
    }
    let half = chord.sqrt();
    let [mut low, mut high] = [middle - half, middle + half];
    if h[1] != 0.0 {
        let (a, b) = ((-slab - h[0]) / h[1], (slab - h[0]) / h[1]);
        low = low.max(a.min(b));
        high = high.min(a.max(b));
    } else if h[0].abs() > slab {
        return None;
    }
    (low < high).then_some([low, high])
}

/// The ends of the interval and the roots of F' inside, in order, and how many.
fn nodes(f: &Quartic, [low, high]: [f64; 2]) -> ([f64; 5], usize) {
    let times = |k: usize| f[k] * Twofold::from(k as f64);
    let slope: Quartic = [times(1), times(2), times(3), times(4), Twofold::default()];
    // F'' / 2 = 6 c4 s^2 + 3 c3 s + c2.
    let (a, b, c) = (
        f[4].scaled(2.0) * Twofold::from(3.0),
        f[3] * Twofold::from(1.5),
        f[2],
    );
    let mut ends = [low; 4];
    let mut count = 1;
    let discriminant = b * b - a * c;
    if discriminant.value() > 0.0 {
        let root = discriminant.sqrt();
        for s in [(-b - root) / a, (-b + root) / a].each(Twofold::value) {
            if s > ends[count - 1] && s < high {
                ends[count] = s;
                count += 1;
            }
        }
    }
    ends[count] = high;
    let mut nodes = [low; 5];
    let mut number = 1;
    for pair in ends[..=count].windows(2) {
        let [from, to] = [pair[0], pair[1]].each(|s| horner(&slope, s).value() <= 0.0);
        if from != to {
            let s = monotone_root(&slope, pair[0], pair[1], from).value();
            if s > nodes[number - 1] && s < high {
                nodes[number] = s;
                number += 1;
            }
        }
    }
    nodes[number] = high;
    (nodes, number + 1)
}

#[inline]
fn horner(f: &Quartic, s: f64) -> Twofold {
    let s = Twofold::from(s);
    (((f[4] * s + f[3]) * s + f[2]) * s + f[1]) * s + f[0]
}

/// The root between `low` and `high`, where the value is <= 0 at `low` alone if `negative`, else at `high` alone.
fn monotone_root(f: &Quartic, low: f64, high: f64, negative: bool) -> Twofold {
    let c = f.map(Twofold::value);
    let slope = |s: f64| ((4.0 * c[4] * s + 3.0 * c[3]) * s + 2.0 * c[2]) * s + c[1];
    let plain = |s: f64| {
        let value = (((c[4] * s + c[3]) * s + c[2]) * s + c[1]) * s + c[0];
        (value, slope(s))
    };
    root([low, high], negative, plain, |s| (horner(f, s), slope(s)))
}
