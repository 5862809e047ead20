//! The filters of FLIP, one-dimensional: contrast sensitivity, and the detectors of edges and points.

use std::f64::consts::PI;

use crate::filter::Band;

/// Contrast sensitivity as sums of Gaussians a sqrt(pi/b) exp(-pi^2 x^2 / b), x in degrees (FLIP-2020, table 1): the
/// achromatic, red-green and blue-yellow channel. A second Gaussian with a = 0 is left out.
const ACHROMATIC: [f64; 2] = [1.0, 0.0047];
const RED_GREEN: [f64; 2] = [1.0, 0.0053];
const BLUE_YELLOW: [[f64; 2]; 2] = [[34.1, 0.04], [13.5, 0.025]];

/// Width of the edges and points that are found, in degrees of visual angle (FLIP-2020, section 4.2).
const FEATURE_WIDTH: f64 = 0.082;

/// All filters for a number of pixels per degree.
pub(super) struct Kernels {
    achromatic: Vec<f64>,
    red_green: Vec<f64>,
    /// Share and taps of each Gaussian.
    blue_yellow: [(f64, Vec<f64>); 2],
    gaussian: Vec<f64>,
    first_derivative: Vec<f64>,
    second_derivative: Vec<f64>,
}

impl Kernels {
    pub(super) fn new(ppd: f64) -> Self {
        // Three standard deviations of the widest Gaussian, for all channels alike.
        let widest = (BLUE_YELLOW[0][1] / (2.0 * PI * PI)).sqrt();
        let reach = (3.0 * widest * ppd).ceil();
        let sensitivity = |b: f64| taps(reach, |x| libm::exp(-PI * PI * (x / ppd) * (x / ppd) / b));
        let one = |[_, b]: [f64; 2]| normalized(&sensitivity(b));
        // In two dimensions each Gaussian weighs its factor times the square of its sum.
        let weights = BLUE_YELLOW.map(|[a, b]| {
            let sum: f64 = sensitivity(b).iter().sum();
            a * (PI / b).sqrt() * sum * sum
        });
        let total = weights[0] + weights[1];
        let sigma = 0.5 * FEATURE_WIDTH * ppd;
        let reach = (3.0 * sigma).ceil();
        let bell = |x: f64| libm::exp(-x * x / (2.0 * sigma * sigma));
        Self {
            achromatic: one(ACHROMATIC),
            red_green: one(RED_GREEN),
            blue_yellow: std::array::from_fn(|i| (weights[i] / total, one(BLUE_YELLOW[i]))),
            gaussian: normalized(&taps(reach, bell)),
            first_derivative: balanced(&taps(reach, |x| -x * bell(x))),
            second_derivative: balanced(&taps(reach, |x| {
                (x * x / (sigma * sigma) - 1.0) * bell(x)
            })),
        }
    }

    /// Rows that the filters reach above and below.
    pub(super) fn margin(&self) -> usize {
        self.achromatic.len().max(self.gaussian.len()) / 2
    }

    /// YCxCz as the eye resolves it: each channel filtered by its contrast sensitivity.
    pub(super) fn sensed(&self, [y, cx, cz]: &[Band; 3]) -> [Vec<f64>; 3] {
        let same = |band: &Band, taps: &[f64]| band.filtered(taps, taps);
        let [wide, narrow] = &self.blue_yellow;
        let mut blue_yellow = same(cz, &wide.1);
        for (sum, v) in blue_yellow.iter_mut().zip(same(cz, &narrow.1)) {
            *sum = wide.0 * *sum + narrow.0 * v;
        }
        [
            same(y, &self.achromatic),
            same(cx, &self.red_green),
            blue_yellow,
        ]
    }

    /// Strength of edges and of points in the achromatic channel (FLIP-2020, section 4.2).
    pub(super) fn features(&self, achromatic: &Band) -> [Vec<f64>; 2] {
        [&self.first_derivative, &self.second_derivative].map(|detector| {
            let across = achromatic.filtered(detector, &self.gaussian);
            let along = achromatic.filtered(&self.gaussian, detector);
            let pairs = across.iter().zip(along);
            pairs.map(|(a, b)| (a * a + b * b).sqrt()).collect()
        })
    }
}

/// Values of `f` at -reach, ..., reach.
fn taps(reach: f64, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let reach = reach as i64;
    (-reach..=reach).map(|x| f(x as f64)).collect()
}

/// Scaled to the sum 1.
fn normalized(taps: &[f64]) -> Vec<f64> {
    let sum: f64 = taps.iter().sum();
    taps.iter().map(|t| t / sum).collect()
}

/// The positive taps scaled to the sum 1 and the negative ones to -1, so that a feature's strength is its contrast.
fn balanced(taps: &[f64]) -> Vec<f64> {
    let positive: f64 = taps.iter().filter(|t| **t > 0.0).sum();
    let negative: f64 = taps.iter().filter(|t| **t < 0.0).sum();
    let scale = |t: &f64| {
        if *t > 0.0 {
            t / positive
        } else {
            t / -negative
        }
    };
    taps.iter().map(scale).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_keep_what_is_constant() {
        let kernels = Kernels::new(67.02);
        assert_eq!((kernels.achromatic.len(), kernels.gaussian.len()), (21, 19));
        let sum = |taps: &[f64]| taps.iter().sum::<f64>();
        for taps in [&kernels.achromatic, &kernels.red_green, &kernels.gaussian] {
            assert!((sum(taps) - 1.0).abs() < 1e-14);
        }
        let [wide, narrow] = &kernels.blue_yellow;
        assert!((wide.0 + narrow.0 - 1.0).abs() < 1e-14);
        for detector in [&kernels.first_derivative, &kernels.second_derivative] {
            assert!(sum(detector).abs() < 1e-14);
            let positive: f64 = detector.iter().filter(|t| **t > 0.0).sum();
            assert!((positive - 1.0).abs() < 1e-14);
        }
    }
}
