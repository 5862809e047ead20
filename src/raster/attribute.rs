//! Attributes at a sample: perspective-correct weights from the unsnapped triangle.
//!
//! The weight of corner i is e_i / (e_0 + e_1 + e_2) with e_i = (h_j x h_k) . (X, Y, 1), h = (x, y, w) the homogeneous corners
//! and (X, Y, 1) the sample's own ray: the place where that ray meets the triangle (GL 2.1 section 3.5.1's quotient, with the
//! division by w left out on both sides). So both renderers weigh the same numbers, nothing is anchored at a far pixel, and
//! clipped corners, w <= 0 included, need no care.
//!
//! A sample that lies outside the exact triangle and is its own only because vertices were snapped (by at most half a
//! unit of the snap) takes the attributes of the nearest place of the triangle's outline in the picture. GL would
//! extrapolate; on slivers and at the horizon that leaves the range of the corners without bound, and may divide by 0.

use crate::lanes::Real;

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
        let largest = corners.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
        let (down, _) = largest.power_of_two_scale();
        let corner = corners.map(|h| h.map(|x| x * down));
        let [a, b, c] = corner;
        let side = [cross(b, c), cross(c, a), cross(a, b)];
        let inside = dot(side[0], a);
        let side = if inside < 0.0 {
            side.map(|n| n.map(|x| -x))
        } else {
            side
        };
        Self { corner, side }
    }

    /// Weights at a ray, finite, sum 1 within rounding; none negative.
    pub(super) fn at(&self, ray: [f64; 2]) -> [f64; 3] {
        let e = self.edges(ray);
        let sum = e[0] + e[1] + e[2];
        if e.iter().all(|x| *x >= 0.0) && sum > 0.0 && sum < f64::INFINITY {
            return e.map(|x| x / sum);
        }
        self.nearest(ray, e)
    }

    /// [`Weights::at`] held to `near <= distance <= far`, for corners at these distances: a sample that only the snapping of
    /// a clipped side gave to the triangle moves to that side.
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

    /// Weights on the triangle's whole plane, without the rule for samples outside; `None` where they have no value.
    pub(super) fn on_plane(&self, ray: [f64; 2]) -> Option<[f64; 3]> {
        let e = self.edges(ray);
        let b = e.map(|x| x / (e[0] + e[1] + e[2]));
        b.iter().all(|x| x.is_finite()).then_some(b)
    }

    fn edges(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        self.side.map(|n| n[0] * x + n[1] * y + n[2])
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
                offer(e[i].abs() / length2.sqrt(), foot.map(|x| x / sum));
            }
        }
        best.1
    }
}

/// The weighted sum as c + b (c' - c) + b' (c'' - c), c the value of largest weight: exact where the three are equal, and
/// good where one is huge and hardly counts.
#[inline(always)]
pub(super) fn mix<R: Real>(b: [f64; 3], c: [R; 3]) -> f64 {
    let c = c.map(Real::to_f64);
    let from = |i: usize, j: usize, k: usize| c[i] + b[j] * (c[j] - c[i]) + b[k] * (c[k] - c[i]);
    if b[0] >= b[1] && b[0] >= b[2] {
        from(0, 1, 2)
    } else if b[1] >= b[2] {
        from(1, 2, 0)
    } else {
        from(2, 0, 1)
    }
}

/// [`mix`] of each of three components, rounded once.
#[inline(always)]
pub(super) fn mix3<R: Real>(b: [f64; 3], c: [[R; 3]; 3]) -> [R; 3] {
    [0, 1, 2].map(|k| R::from_f64(mix(b, [c[0][k], c[1][k], c[2][k]])))
}

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
