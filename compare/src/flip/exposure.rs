//! Exposures of HDR-FLIP and its tone mapper.
//!
//! FLIP-2021 = Andersson, Nilsson, Shirley, Akenine-Möller: "Visualizing Errors in Rendered High Dynamic Range Images",
//! Eurographics short papers 2021. A float picture is looked at under several exposures, from one that shows its
//! brightest pixel below white to one that shows its darker half as bright; an error counts that shows in any of them.

use crate::ImageView;
use crate::view::luma;

/// Coefficients of the rational curve (a x^2 + b x + c) / (d x^2 + e x + f) by which Narkowicz ("ACES filmic tone mapping
/// curve", 2015) approximates ACES, with his exposure of 0.6 within: the default of FLIP-2021.
const ACES: [f64; 6] = [
    0.6 * 0.6 * 2.51,
    0.6 * 0.03,
    0.0,
    0.6 * 0.6 * 2.43,
    0.6 * 0.59,
    0.14,
];

/// The tone-mapped value that the first exposure gives the brightest pixel, and the last one the median (FLIP-2021,
/// section 3).
const TARGET: f64 = 0.85;

/// Luminances below this count as this: what float pictures call black has no exposure.
const DARKEST: f64 = f32::EPSILON as f64;

/// The exposures that a float picture was looked at under, as powers of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The shortest: its tone-mapped picture shows the reference's brightest pixel at 0.85.
    pub start: f64,
    /// The longest: it shows the reference's median luminance at 0.85.
    pub stop: f64,
    /// How many, evenly from `start` to `stop`, both included; at least 2.
    pub count: usize,
}

impl Exposures {
    /// Chosen by the luminances of the reference, as FLIP-2021 says.
    pub(super) fn of(reference: &ImageView) -> Self {
        let mut luminances: Vec<f32> = reference
            .pixels()
            .iter()
            .map(|p| luma(p.map(|v| f64::from(v.max(0.0)))).max(DARKEST) as f32)
            .collect();
        let brightest = luminances.iter().copied().fold(0.0, f32::max);
        let middle = luminances.len() / 2;
        let median = *luminances.select_nth_unstable_by(middle, f32::total_cmp).1;
        let target = inverse_tone_map(TARGET);
        let start = libm::log2(target / f64::from(brightest));
        let stop = libm::log2(target / f64::from(median));
        Self {
            start,
            stop,
            count: ((stop - start).ceil() as usize).max(2),
        }
    }

    /// The factors 2^exposure.
    pub(super) fn factors(&self) -> Vec<f64> {
        let step = (self.stop - self.start) / (self.count - 1) as f64;
        let exposures = (0..self.count).map(|i| self.start + i as f64 * step);
        exposures.map(libm::exp2).collect()
    }
}

/// The curve, limited to [0, 1]; light is never negative.
pub(super) fn tone_map(x: f64) -> f64 {
    let [a, b, c, d, e, f] = ACES;
    // Beyond 2^64 the curve is a/d to the last bit, and squares stay finite.
    let x = x.clamp(0.0, 18_446_744_073_709_551_616.0);
    (((a * x + b) * x + c) / ((d * x + e) * x + f)).clamp(0.0, 1.0)
}

/// The larger x at which the curve takes a value below a/d: the root of a quadratic.
fn inverse_tone_map(value: f64) -> f64 {
    let [a, b, c, d, e, f] = ACES;
    let (a, b, c) = (a - value * d, b - value * e, c - value * f);
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Encoding;

    fn exposures(greys: &[f32]) -> Exposures {
        let pixels: Vec<[f32; 3]> = greys.iter().map(|g| [*g; 3]).collect();
        let view = ImageView::new(greys.len(), 1, &pixels, Encoding::Linear).unwrap();
        Exposures::of(&view)
    }

    #[test]
    fn the_brightest_and_the_median_are_shown_alike() {
        let found = exposures(&[0.25, 4.0, 0.5]);
        let factors = found.factors();
        assert_eq!((found.count, factors.len()), (3, 3));
        for (factor, value) in [(factors[0], 4.0), (factors[2], 0.5)] {
            assert!((tone_map(factor * value) - 0.85).abs() < 1e-7);
        }
    }

    #[test]
    fn one_luminance_and_none_have_exposures_too() {
        assert_eq!(exposures(&[3.0; 5]).count, 2);
        let black = exposures(&[0.0, -1.0]);
        assert!(black.count == 2 && black.start == black.stop && black.start.is_finite());
        let widest = exposures(&[f32::MAX, 0.0, 0.0]);
        assert!(widest.count < 160, "{widest:?}");
        assert!(widest.factors().iter().all(|f| f.is_finite() && *f > 0.0));
    }

    #[test]
    fn the_curve_ends_at_white() {
        assert_eq!(tone_map(f64::INFINITY), 1.0);
        assert_eq!((tone_map(-3.0), tone_map(0.0)), (0.0, 0.0));
        assert!(
            (1..100).all(|i| tone_map(f64::from(i) / 50.0) > tone_map(f64::from(i - 1) / 50.0))
        );
    }
}
