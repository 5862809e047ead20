//! Attributes at a sample: perspective-correct weights from the unsnapped triangle.
//!
//! The weight of corner i is e_i / (e_0 + e_1 + e_2) with e_i = (h_j x h_k) . (X, Y, 1), h = (x, y, w) the homogeneous corners
//! and (X, Y, 1) the sample's own ray: the place where that ray meets the triangle (GL 2.1 section 3.5.1's quotient, with the
//! division by w left out on both sides). So both renderers weigh the same numbers, nothing is anchored at a far pixel, and
//! clipped corners, w <= 0 included, need no care.
//!
//! A sample that lies outside the exact triangle and is its own only because vertices were snapped (by at most half a
//! unit of the snap) is extrapolated to, as GL does, as long as no weight falls below -1/16. On slivers and at the horizon
//! GL leaves the range of the corners without bound, and may divide by 0; there the attributes are those of the nearest
//! place of the triangle's outline in the picture.

use crate::lanes::Real;
use crate::math::Each;

/// Least weight of a corner outside the triangle. A sample lies at most 1/256 px outside, so only triangles that are
/// lower than 1/16 px anywhere fall below.
const EXTRAPOLATED: f64 = -1.0 / 16.0;

/// One triangle's constants.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Weights {
    /// Corners, scaled by a common power of two.
    corner: [[f64; 3]; 3],
    /// Normals of the planes through the origin and the side opposite each corner, turned so that inside is positive.
    side: [[f64; 3]; 3],
}

impl Weights {
    /// Prepares a triangle of homogeneous corners (x, y, w).
    pub(super) fn new(corners: [[f64; 3]; 3]) -> Self {
        let mut largest = 0.0f64;
        for h in &corners {
            largest = largest.max(h[0].abs()).max(h[1].abs()).max(h[2].abs());
        }
        let (down, _) = largest.power_of_two_scale();
        let [a, b, c] = corners;
        let scaled = |h: [f64; 3]| [h[0] * down, h[1] * down, h[2] * down];
        let corner = [scaled(a), scaled(b), scaled(c)];
        let [a, b, c] = corner;
        let first = cross(b, c);
        let side = if dot(first, a) >= 0.0 {
            [first, cross(c, a), cross(a, b)]
        } else {
            [cross(c, b), cross(a, c), cross(b, a)]
        };
        Self { corner, side }
    }

    /// Weights at a ray, finite, sum 1 within rounding; none below -1/16.
    #[inline]
    pub(super) fn at(&self, ray: [f64; 2]) -> [f64; 3] {
        let e = self.edges(ray);
        let sum = e[0] + e[1] + e[2];
        let least = EXTRAPOLATED * sum;
        let inside = e[0] >= least && e[1] >= least && e[2] >= least;
        if inside && sum > 0.0 && sum < f64::INFINITY {
            return [e[0] / sum, e[1] / sum, e[2] / sum];
        }
        self.nearest(ray, e)
    }

    /// [`Weights::at`] held to `near <= distance <= far`, for corners at these distances: a sample that only the snapping of
    /// a clipped side gave to the triangle moves to that side.
    #[inline]
    pub(super) fn between(
        &self,
        ray: [f64; 2],
        distance: [f64; 3],
        [near, far]: [f64; 2],
    ) -> [f64; 3] {
        let b = self.at(ray);
        let found = mix(b, distance);
        let bound = if found < near {
            near
        } else if found > far {
            far
        } else {
            return b;
        };
        // The plane distance = bound meets the picture in the line m . (X, Y, 1) = 0; take the foot on it.
        let mut m = [0.0; 3];
        for (side, d) in self.side.iter().zip(distance) {
            for (sum, n) in m.iter_mut().zip(side) {
                *sum += n * (d - bound);
            }
        }
        let step = (m[0] * ray[0] + m[1] * ray[1] + m[2]) / (m[0] * m[0] + m[1] * m[1]);
        let foot = [ray[0] - m[0] * step, ray[1] - m[1] * step];
        if foot.iter().all(|x| x.is_finite()) {
            self.at(foot)
        } else {
            b
        }
    }

    /// The weights of the window at the same place: what leaving out the division by w amounts to. b_i = (l_i / w_i) / sum,
    /// so l_i is b_i w_i / sum; triangles that reach behind the eye have none, and keep `b`.
    pub(super) fn affine(&self, b: [f64; 3]) -> [f64; 3] {
        let w = [self.corner[0][2], self.corner[1][2], self.corner[2][2]];
        let l = [b[0] * w[0], b[1] * w[1], b[2] * w[2]];
        let sum = l[0] + l[1] + l[2];
        if w.iter().all(|w| *w > 0.0) && sum > 0.0 {
            l.map(|l| l / sum)
        } else {
            b
        }
    }

    /// Weights on the triangle's whole plane, without the rule for samples outside; `None` where they have no value.
    pub(super) fn on_plane(&self, ray: [f64; 2]) -> Option<[f64; 3]> {
        let e = self.edges(ray);
        let b = e.each(|x| x / (e[0] + e[1] + e[2]));
        b.iter().all(|x| x.is_finite()).then_some(b)
    }

    #[inline(always)]
    fn edges(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let [p, q, r] = &self.side;
        [
            p[0] * x + p[1] * y + p[2],
            q[0] * x + q[1] * y + q[2],
            r[0] * x + r[1] * y + r[2],
        ]
    }

    /// Weights of the nearest place of the outline in the picture.
    #[cold]
    fn nearest(&self, ray: [f64; 2], e: [f64; 3]) -> [f64; 3] {
        let mut best = (f64::INFINITY, [1.0 / 3.0; 3]);
        let mut offer = |distance: f64, weights: [f64; 3]| {
            if distance < best.0 && weights.iter().all(|x| x.is_finite()) {
                best = (distance, weights);
            }
        };
        for i in 0..3 {
            // The corner itself, where it lies before the eye.
            let h = self.corner[i];
            if h[2] > 0.0 {
                let (dx, dy) = (h[0] / h[2] - ray[0], h[1] / h[2] - ray[1]);
                let mut weights = [0.0; 3];
                weights[i] = 1.0;
                offer((dx * dx + dy * dy).sqrt(), weights);
            }
            // The foot of the perpendicular on the side opposite it, where it lies between the side's ends.
            let n = self.side[i];
            let length2 = n[0] * n[0] + n[1] * n[1];
            let step = e[i] / length2;
            let mut foot = self.edges([ray[0] - n[0] * step, ray[1] - n[1] * step]);
            foot[i] = 0.0;
            let sum = foot[0] + foot[1] + foot[2];
            if foot.iter().all(|x| *x >= 0.0) && sum > 0.0 {
                offer(e[i].abs() / length2.sqrt(), foot.each(|x| x / sum));
            }
        }
        best.1
    }
}

/// The weighted sum as c + b (c' - c) + b' (c'' - c), c the value of largest weight: exact where the three are equal, and
/// good where one is huge and hardly counts.
#[inline(always)]
pub(super) fn mix<R: Real>(b: [f64; 3], c: [R; 3]) -> f64 {
    let [c0, c1, c2] = [c[0].to_f64(), c[1].to_f64(), c[2].to_f64()];
    if b[0] >= b[1] && b[0] >= b[2] {
        c0 + b[1] * (c1 - c0) + b[2] * (c2 - c0)
    } else if b[1] >= b[2] {
        c1 + b[2] * (c2 - c1) + b[0] * (c0 - c1)
    } else {
        c2 + b[0] * (c0 - c2) + b[1] * (c1 - c2)
    }
}

/// [`mix`] of each of three components, rounded once.
#[inline(always)]
pub(super) fn mix3<R: Real>(b: [f64; 3], c: [[R; 3]; 3]) -> [R; 3] {
    // Written out: closures given to array::map are not inlined here.
    let [p, q, r] = c;
    [
        R::from_f64(mix(b, [p[0], q[0], r[0]])),
        R::from_f64(mix(b, [p[1], q[1], r[1]])),
        R::from_f64(mix(b, [p[2], q[2], r[2]])),
    ]
}

/// [`mix3`] of colours, which may be infinite (a light whose attenuation vanishes): infinity times weight 0 is 0, and what
/// has no value, infinity less infinity, is the corner of largest weight.
#[inline(always)]
pub(super) fn mix_colors<R: Real>(b: [f64; 3], c: [[R; 3]; 3]) -> [R; 3] {
    let mixed = mix3(b, c);
    if mixed[0].is_finite() && mixed[1].is_finite() && mixed[2].is_finite() {
        mixed
    } else {
        mix_infinite(b, c)
    }
}

#[cold]
fn mix_infinite<R: Real>(b: [f64; 3], c: [[R; 3]; 3]) -> [R; 3] {
    let largest = (1..3).fold(0, |i, k| if b[k] > b[i] { k } else { i });
    [0, 1, 2].each(|channel| {
        let corner = [0, 1, 2].each(|i| c[i][channel].to_f64());
        let weighted = (0..3).filter(|i| b[*i] != 0.0).map(|i| b[i] * corner[i]);
        let sum: f64 = weighted.sum();
        if corner.iter().all(|x| x.is_finite()) {
            R::from_f64(mix(b, corner))
        } else if sum.is_nan() {
            c[largest][channel]
        } else {
            R::from_f64(sum)
        }
    })
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn infinite_colours_mix_without_nan() {
        let inf = f32::INFINITY;
        let mix = |b, c: [f32; 3]| mix_colors(b, c.map(|x| [x, 0.5, x]));
        let third = [0.25, 0.25, 0.5];
        assert_eq!(mix(third, [inf, inf, inf]), [inf, 0.5, inf]);
        assert_eq!(mix(third, [inf, 1.0, 2.0]), [inf, 0.5, inf]);
        assert_eq!(mix([0.0, 0.5, 0.5], [inf, 1.0, 2.0]), [1.5, 0.5, 1.5]);
        assert_eq!(mix(third, [inf, 1.0, -inf]), [-inf, 0.5, -inf]);
        assert_eq!(mix(third, [1.0, 2.0, 3.0]), [2.25, 0.5, 2.25]);
    }
}
