//! Surfaces of revolution in their own space: one monotone Bezier piece of the profile, turned about the axis.
//!
//! A piece of the profile crosses the ray where it changes between within and without the ray's branch of a hyperbola in
//! the half plane (radius, height): see `hyperbola`, from which A, m, k and G are.
//!
//! *One owner.* Whether a joint is within is asked of its own coordinates, so both pieces hear the same; a point on the axis
//! never is, a point on the ray is. Each piece is crossed an odd number of times if its ends differ, else an even number:
//! a closed profile is entered as often as it is left, through joints, poles and creases too. Between its ends a piece is
//! first split where z = k (which is within if r >= m), then by the Bernstein form of G (`isolate`), of degree 6.
//!
//! *Accuracy.* Lengths are scaled by a power of two, p is the ray's point nearest to the middle of the axis, and all that
//! decides is in pairs: signs are right to about 2^-100 of the lengths squared, crossings are polished to 2^-100 of the
//! piece. Two crossings closer together than 2^-44 of a piece, in f64 parameters, may count as none (touching).
//! The point is base + z n + r e with r, z from the curve itself, and the normal that of its tangent.
//!
//! Measured (2026-11, one x86-64 thread, CPU time, dev profile at opt-level 2): 800 x 800 primary rays on a smooth vase of 8
//! points 2.5 s (46 % hit), on one of 400 points 2.7 s (51 %), on a torus 0.9 s (38 %). With roots sought in pairs from the
//! start 3.1, 3.7 and 1.3 s.

use super::exact::{Twofold, add_scaled, dot2, pairs, unit, values};
use super::hyperbola::{View, Way};
use super::isolate::{Bracket, Coefficients, Signs, halves, isolate, root};
use super::span::{Spot, unit_scale};
use crate::lanes::Real;
use crate::math::DVec3;
use crate::math::Each;
use crate::scene::profile::{Piece, Profile};

/// One piece of a profile, turned about the axis; its anchor is the axis' point at height 0.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    /// Unit direction of the axis.
    axis: [Twofold; 3],
    /// The piece, lengths times `down`.
    piece: Piece,
    /// Its polynomials r, z in powers of the parameter.
    powers: [[Twofold; 4]; 2],
    /// Powers of two that bring the whole profile to about 1, and back.
    scale: [f64; 2],
    /// Height of the middle of the profile, scaled.
    middle: f64,
}

/// A place where the ray meets the band.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crossing {
    /// Ray parameter.
    pub t: Twofold,
    /// The ray comes from behind.
    pub back: bool,
    /// Parameter of the piece.
    s: Twofold,
    /// Ray parameter counted from p, in units of the scaled direction.
    local: Twofold,
}

/// The crossings of one piece, in the order of its parameter.
#[derive(Clone, Copy, Debug, Default)]
pub struct Crossings {
    items: [Crossing; MOST],
    count: usize,
}

/// A conic crosses a cubic 6 times at most; rounding may add a pair where they touch.
const MOST: usize = 8;
/// A relative margin far above every rounding of a coarse test in f64, heights of slanting rays divided by 1/64 included.
const COARSE: f64 = 1e-11;
/// Error of Bernstein coefficients after all halvings, relative to the largest term: 512 roundings.
const ERROR: f64 = 256.0 * f64::EPSILON;

/// One side of the height k, for shallow rays: the sign of z - k there. Steep rays need none.
struct Side<'a> {
    band: &'a Band,
    view: &'a View,
    side: f64,
}

impl Band {
    /// The bands of a profile about a direction, one a piece; none where that is zero.
    ///
    /// ```
    /// use rastray::math::DVec3;
    /// use rastray::scene::profile::{Curve, Profile};
    /// use rastray::trace::revolution::Band;
    /// // A funnel from (1, 0) to (3, 2), seen from below at x = 2.
    /// let funnel = Profile::new(Curve::Polyline, &[[1.0, 0.0], [3.0, 2.0]]).unwrap();
    /// let band = Band::all(DVec3::Y, &funnel)[0];
    /// let found = band.crossings([-2.0, 5.0, 0.0].map(Into::into), DVec3::Y);
    /// assert_eq!((found[0].t.value(), found[0].back, found.len()), (6.0, false, 1));
    /// ```
    pub fn all(axis: DVec3, profile: &Profile) -> Vec<Self> {
        let Some((axis_down, _)) = unit_scale(axis) else {
            return Vec::new();
        };
        let n = pairs(axis * axis_down);
        let length = dot2(n, n).sqrt();
        let axis = n.each(|x| x / length);
        let [low, high] = profile.heights();
        let (down, up) = profile
            .radius()
            .max(low.abs())
            .max(high.abs())
            .power_of_two_scale();
        let one = |piece: &Piece| {
            let piece = Piece {
                r: piece.r.each(|x| x * down),
                z: piece.z.each(|x| x * down),
                ..*piece
            };
            Self {
                axis,
                piece,
                powers: [
                    powers(&piece.r, piece.degree),
                    powers(&piece.z, piece.degree),
                ],
                scale: [down, up],
                middle: 0.5 * (low * down) + 0.5 * (high * down),
            }
        };
        profile.pieces().iter().map(one).collect()
    }

    /// Where the ray crosses; `q` leads from its origin to the anchor.
    pub fn crossings(&self, q: [Twofold; 3], d: DVec3) -> Crossings {
        let mut found = Crossings::default();
        if let Some(view) = self.view(q, d) {
            self.cross(&view, &mut found);
        }
        found
    }

    /// The point of a crossing, by its number, from the anchor, and its normal.
    pub fn spot(&self, q: [Twofold; 3], d: DVec3, number: usize) -> Option<Spot> {
        let view = self.view(q, d)?;
        let mut found = Crossings::default();
        self.cross(&view, &mut found);
        let crossing = found.get(number)?;
        let across = add_scaled(view.across[0], crossing.local, view.across[1]);
        let (out, axis) = (unit(values(across)), values(self.axis));
        let [r, z] = self.at(crossing.s).map(Twofold::value);
        let way = self.piece.tangent(crossing.s.value().clamp(0.0, 1.0));
        Some(Spot {
            offset: (z * axis + r * out) * self.scale[1],
            normal: unit(way.y * out - way.x * axis),
        })
    }

    /// Radius and height at a parameter.
    fn at(&self, s: Twofold) -> [Twofold; 2] {
        self.powers
            .map(|c| ((c[3] * s + c[2]) * s + c[1]) * s + c[0])
    }

    fn view(&self, q: [Twofold; 3], d: DVec3) -> Option<View> {
        let (d_down, _) = unit_scale(d)?;
        let [down, up] = self.scale;
        let (q, d) = (q.each(|x| x.scaled(down)), d * d_down);
        if self.surely_missed(values(q), d) {
            return None;
        }
        let middle = self.middle * values(self.axis);
        View::new(q, d, self.axis, middle, d_down * up)
    }

    /// The ray keeps beyond doubt outside the ring that the piece lies in, or inside its hole: plain f64 with a margin.
    fn surely_missed(&self, q: DVec3, d: DVec3) -> bool {
        let n = values(self.axis);
        let start = (q + self.middle * n).dot(d) / d.length_squared();
        let p = start * d - q;
        let (height, climb) = (p.dot(n), d.dot(n));
        let (x, y) = (p - height * n, d - climb * n);
        let (a, b, c) = (y.length_squared(), x.dot(y), x.length_squared());
        let last = self.piece.degree;
        let [low, high] = [self.piece.z[0], self.piece.z[last]].each(|z| (z - height) / climb);
        // Of nearly level rays the whole line is taken, for rounding would move the ends.
        let is_level = climb.abs() * 64.0 < d.length();
        let (from, to) = if is_level {
            (f64::NEG_INFINITY, f64::INFINITY)
        } else {
            (low.min(high), low.max(high))
        };
        let doubt = COARSE * (1.0 + q.length());
        let distance = |t: f64| {
            let terms = a * t * t + 2.0 * (b * t).abs() + c + 1.0;
            ((a * t + 2.0 * b) * t + c, doubt * terms)
        };
        let [r0, r1] = [self.piece.r[0], self.piece.r[last]];
        let (least, most) = (r0.min(r1), r0.max(r1));
        let (near, error) = distance((-b / a).max(from).min(to));
        let inside = |t: f64| {
            let (far, error) = distance(t);
            far + error < least * least
        };
        near - error > most * most || (inside(from) && inside(to))
    }

    /// Splits the piece at the height k, if there is one, and finds the crossings of the parts.
    fn cross(&self, view: &View, found: &mut Crossings) {
        let n = 2 * self.piece.degree;
        let (c, error) = self.coefficients(view);
        if c[..=n].iter().all(|x| *x > error) || c[..=n].iter().all(|x| *x < -error) {
            return;
        }
        let ends = [0, self.piece.degree].each(|i| {
            let (r, z) = (self.piece.r[i], self.piece.z[i]);
            r > 0.0 && view.is_within([Twofold::from(r), Twofold::from(z)])
        });
        let mut part = |c: &Coefficients, ends: [f64; 2], positive: [bool; 2], side: f64| {
            let side = Side {
                band: self,
                view,
                side,
            };
            let whole = Bracket { ends, positive };
            isolate(&side, c, n, error, whole, &mut |bracket| {
                found.push(side.crossing(bracket));
            });
        };
        let heights = [0, self.piece.degree].each(|i| view.above(Twofold::from(self.piece.z[i])));
        let [from, to] = heights.each(|x| x.value());
        if from * to >= 0.0 || matches!(view.way, Way::Steep { .. }) {
            let side = if from != 0.0 { from } else { to };
            let side = if side == 0.0 { 0.0 } else { side.signum() };
            return part(&c, [0.0, 1.0], ends, side);
        }
        let level = self.level(view, from < 0.0);
        let within = view.room([self.at(level)[0], view.height()]) >= 0.0;
        let s = level.value().clamp(0.0, 1.0);
        let (before, after) = halves(&c, n, s);
        part(&before, [0.0, s], [ends[0], within], from.signum());
        part(&after, [s, 1.0], [within, ends[1]], to.signum());
    }

    /// The parameter at the height k, for a piece that has it between its ends.
    fn level(&self, view: &View, rises: bool) -> Twofold {
        let height = view.height().value();
        let slope = |s: f64| self.piece.tangent(s).y;
        let plain = |s: f64| (self.piece.at(s).y - height, slope(s));
        root([0.0, 1.0], rises, plain, |s| {
            (view.above(self.at(Twofold::from(s))[1]), slope(s))
        })
    }

    /// Bernstein coefficients of G, in plain f64, and a bound of their error.
    fn coefficients(&self, view: &View) -> (Coefficients, f64) {
        let Piece { degree, r, z } = self.piece;
        let [weight, square, half, rest] = view.plain();
        let height = view.height().value();
        let zeta = z.each(|z| z - height);
        // The polar form: what is squared in G is multiplied.
        let f = |i: usize, j: usize| {
            weight * r[i] * r[j] - (square * zeta[i] * zeta[j] + half * (zeta[i] + zeta[j]) + rest)
        };
        let largest = |x: &[f64; 4]| x.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let (r_most, z_most) = (largest(&r), largest(&z) + height.abs());
        let terms =
            weight * r_most * r_most + (square * z_most + 2.0 * half.abs()) * z_most + rest.abs();
        let c = if degree == 1 {
            [f(0, 0), f(0, 1), f(1, 1), 0.0, 0.0, 0.0, 0.0]
        } else {
            [
                f(0, 0),
                f(0, 1),
                (3.0 * f(1, 1) + 2.0 * f(0, 2)) / 5.0,
                (9.0 * f(1, 2) + f(0, 3)) / 10.0,
                (3.0 * f(2, 2) + 2.0 * f(1, 3)) / 5.0,
                f(2, 3),
                f(3, 3),
            ]
        };
        (c, ERROR * terms)
    }
}

/// Control points to powers of the parameter.
fn powers(c: &[f64; 4], degree: usize) -> [Twofold; 4] {
    let difference = |i: usize| Twofold::difference(c[i + 1], c[i]);
    let three = Twofold::from(3.0);
    let start = Twofold::from(c[0]);
    if degree == 1 {
        return [start, difference(0), Twofold::default(), Twofold::default()];
    }
    let [d0, d1, d2] = [difference(0), difference(1), difference(2)];
    [start, three * d0, three * (d1 - d0), (d2 - d1) - (d1 - d0)]
}

impl std::ops::Deref for Crossings {
    type Target = [Crossing];
    fn deref(&self) -> &[Crossing] {
        &self.items[..self.count]
    }
}

impl Crossings {
    /// Appends what is finite.
    fn push(&mut self, crossing: Crossing) {
        if self.count < MOST && crossing.t.value().is_finite() {
            self.items[self.count] = crossing;
            self.count += 1;
        }
    }
}

impl Signs for Side<'_> {
    fn is_positive(&self, s: f64) -> bool {
        self.view.is_within(self.band.at(Twofold::from(s)))
    }

    fn slope(&self, s: f64) -> f64 {
        let (p, way) = (self.band.piece.at(s), self.band.piece.tangent(s));
        let [weight, square, half, _] = self.view.plain();
        let zeta = p.y - self.view.height().value();
        2.0 * (weight * p.x * way.x - (square * zeta + half) * way.y)
    }
}

impl Side<'_> {
    /// What the sign says of a parameter between its ends, as a number: >= 0 within.
    fn value(&self, s: f64) -> Twofold {
        let point = self.band.at(Twofold::from(s));
        let room = self.view.square(point);
        let Way::Shallow { rise, .. } = self.view.way else {
            return room;
        };
        if self.side == 0.0 {
            // Flat, in the ray's own plane.
            return room;
        }
        let above = self.view.above(point[1]).scaled(self.side);
        if room.value() > 0.0 {
            rise * room.sqrt() - above
        } else {
            -above
        }
    }

    /// [`Self::value`] in plain f64, with its slope; that is 0 where only halving leads on.
    fn plain_value(&self, s: f64) -> (f64, f64) {
        let (p, way) = (self.band.piece.at(s), self.band.piece.tangent(s));
        let [weight, square, half, rest] = self.view.plain();
        let Way::Shallow {
            least_square, rise, ..
        } = self.view.way
        else {
            let zeta = p.y - self.view.height().value();
            let value = weight * p.x * p.x - ((square * zeta + 2.0 * half) * zeta + rest);
            return (value, self.slope(s));
        };
        let room = p.x * p.x - least_square.value();
        if self.side == 0.0 {
            return (room, 2.0 * p.x * way.x);
        }
        let above = self.side * (p.y - self.view.height().value());
        if room <= 0.0 {
            return (-above, 0.0);
        }
        let (width, rise) = (room.sqrt(), rise.value());
        let slope = rise * p.x * way.x / width - self.side * way.y;
        (rise * width - above, slope)
    }

    /// The crossing in a bracket.
    fn crossing(&self, bracket: Bracket) -> Crossing {
        let Bracket { ends, positive } = bracket;
        let plain = |s: f64| self.plain_value(s);
        let s = root(ends, !positive[0], plain, |s| {
            (self.value(s), self.plain_value(s).1)
        });
        let s = if s.value() < 0.0 {
            Twofold::default()
        } else if s.value() > 1.0 {
            Twofold::from(1.0)
        } else {
            s
        };
        let view = self.view;
        let point = self.band.at(s);
        let falls = view.climb.value() < 0.0;
        let local = match view.way {
            Way::Steep { .. } => view.above(point[1]) / view.climb,
            Way::Shallow {
                rise,
                length,
                nearest,
                ..
            } => {
                let room = view.square(point).sqrt();
                // Of two ways from the nearest point, the one that rounding harms less.
                let part = if room.value() >= (rise * point[0]).value() {
                    let part = room / length;
                    if (self.side > 0.0) == falls {
                        -part
                    } else {
                        part
                    }
                } else {
                    view.above(point[1]) / view.climb
                };
                nearest + part
            }
        };
        Crossing {
            t: (local + Twofold::from(view.start)).scaled(view.units),
            back: positive[0] != falls,
            s,
            local,
        }
    }
}
