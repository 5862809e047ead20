//! How error and cost depend on a knob: slopes on doubly logarithmic paper, and what they mean in words.

use serde::Serialize;

/// A straight line through points on doubly logarithmic paper: y = c x^slope.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Power {
    /// The exponent.
    pub slope: f64,
    /// ln c.
    pub intercept: f64,
    /// Points that it goes through.
    pub points: usize,
}

impl Power {
    /// The least squares line through points of positive coordinates; `None` for fewer than two different x.
    ///
    /// ```
    /// use rastray::trade::fit::Power;
    /// let fit = Power::through(&[(1.0, 3.0), (10.0, 300.0)]).unwrap();
    /// assert!((fit.slope - 2.0).abs() < 1e-12 && (fit.at(2.0) - 12.0).abs() < 1e-9);
    /// assert!(Power::through(&[(1.0, 3.0), (1.0, 4.0)]).is_none());
    /// ```
    pub fn through(points: &[(f64, f64)]) -> Option<Self> {
        let usable = |(x, y): &&(f64, f64)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite();
        let logs: Vec<(f64, f64)> = points
            .iter()
            .filter(usable)
            .map(|(x, y)| (x.ln(), y.ln()))
            .collect();
        let n = logs.len() as f64;
        let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / n;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let squares: f64 = logs.iter().map(|p| (p.0 - x) * (p.0 - x)).sum();
        if logs.len() < 2 || squares <= 0.0 {
            return None;
        }
        let products: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        let slope = products / squares;
        Some(Self {
            slope,
            intercept: y - slope * x,
            points: logs.len(),
        })
    }

    /// The line's value.
    pub fn at(&self, x: f64) -> f64 {
        (self.intercept + self.slope * x.ln()).exp()
    }

    /// Where the line has a value; `None` where it is level.
    pub fn solve(&self, y: f64) -> Option<f64> {
        (self.slope != 0.0).then(|| ((y.ln() - self.intercept) / self.slope).exp())
    }
}

/// Errors below this are those of rounding in f32, which no other knob lowers.
pub const ROUNDING: f64 = 3e-7;

/// The last `most` points of a series that is still falling: what a slope is fitted to. `points` are (knob, error), the knob
/// rising. A point belongs to the fall while it is at least a tenth lower than the one before and above [`ROUNDING`].
pub fn falling(points: &[(f64, f64)], most: usize) -> &[(f64, f64)] {
    let falls = |pair: &&[(f64, f64)]| pair[1].1 < 0.9 * pair[0].1 && pair[1].1 > ROUNDING;
    // The end of the last run of falls, so that a bump at coarse settings does not hide the fall behind it.
    let pairs: Vec<bool> = points.windows(2).map(|pair| falls(&pair)).collect();
    let Some(last) = pairs.iter().rposition(|f| *f) else {
        return &[];
    };
    let first = pairs[..=last]
        .iter()
        .rposition(|f| !*f)
        .map_or(0, |i| i + 1);
    let run = &points[first..=last + 1];
    &run[run.len().saturating_sub(most)..]
}

/// How many times the cost of a tenth of the error: 10^-slope of cost over error along an axis. `points` are (cost, error).
pub fn price_of_a_digit(points: &[(f64, f64)]) -> Option<f64> {
    let swapped: Vec<(f64, f64)> = points.iter().map(|(cost, error)| (*error, *cost)).collect();
    let fit = Power::through(&swapped)?;
    (fit.slope < 0.0).then(|| 10f64.powf(-fit.slope))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_found_and_solved() {
        let points: Vec<_> = (1..6).map(|i| f64::from(1 << i)).collect();
        let law: Vec<_> = points.iter().map(|x| (*x, 0.5 * x.powf(-1.5))).collect();
        let fit = Power::through(&law).expect("a line");
        assert!((fit.slope + 1.5).abs() < 1e-12, "{fit:?}");
        assert!((fit.solve(fit.at(7.0)).expect("falls") - 7.0).abs() < 1e-9);
        assert!(Power::through(&[(1.0, 0.0), (2.0, 1.0)]).is_none());
    }

    #[test]
    fn only_the_fall_is_fitted() {
        // A bump, a fall of four points, a floor.
        let points = [
            (1.0, 0.1),
            (2.0, 0.2),
            (4.0, 0.05),
            (8.0, 0.0125),
            (16.0, 0.003),
            (32.0, 0.003),
        ];
        assert_eq!(falling(&points, 3), &points[2..5]);
        assert_eq!(falling(&points, 9), &points[1..5]);
        assert!(falling(&[(1.0, 1.0), (2.0, 1.0)], 3).is_empty());
        assert!(falling(&[(1.0, 1e-8), (2.0, 1e-9)], 3).is_empty());
    }

    #[test]
    fn a_digit_has_its_price() {
        // error = cost^-1/2: a tenth of the error costs 100 times as much.
        let points: Vec<_> = (0..4).map(|i| (4f64.powi(i), 0.5f64.powi(i))).collect();
        assert!((price_of_a_digit(&points).expect("falls") - 100.0).abs() < 1e-9);
        assert!(price_of_a_digit(&[(1.0, 1.0), (2.0, 2.0)]).is_none());
    }
}
