//! Numbers from two pictures: see the crate head for what each means and when it misleads.

use crate::view::check_shape;
use crate::{CompareError, ImageView};

/// The distance of two pictures, over all channels of all pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metrics {
    /// Mean squared error.
    pub mse: f64,
    /// Root of the mean squared error.
    pub rmse: f64,
    /// Mean absolute error.
    pub mae: f64,
    /// Largest absolute error.
    pub max: f64,
    /// Median of the absolute errors of single values (pixel channels), nearest rank.
    pub p50: f64,
    /// 95th percentile of the same.
    pub p95: f64,
    /// 99th percentile of the same.
    pub p99: f64,
    /// 10 log10(1/mse) in dB; none where the pictures are identical.
    pub psnr: Option<f64>,
}

/// One step of a chain of pictures, in short: what `causes` says of each cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSummary {
    /// Root of the mean squared difference over all values.
    pub rmse: f64,
    /// Largest absolute difference of a value.
    pub max: f64,
    /// Pixels of which at least one channel differs at all.
    pub pixels: usize,
    /// Sum of the differences over all pixels, signed, per channel.
    pub sum: [f64; 3],
}

/// `test - reference` per value, in f64 (exact for two f32 of similar size).
pub fn differences(test: &ImageView, reference: &ImageView) -> Result<Vec<[f64; 3]>, CompareError> {
    test.check_comparable(reference)?;
    let pairs = test.pixels().iter().zip(reference.pixels());
    Ok(pairs
        .map(|(t, r)| std::array::from_fn(|c| f64::from(t[c]) - f64::from(r[c])))
        .collect())
}

/// Measures a test picture against the reference.
///
/// ```
/// use rastray_compare::{Encoding, ImageView, metrics};
/// let (black, grey) = ([[0.0; 3]; 4], [[0.1; 3]; 4]);
/// let view = |p| ImageView::new(2, 2, p, Encoding::Linear).unwrap();
/// let m = metrics(&view(&grey), &view(&black)).unwrap();
/// assert!((m.rmse - 0.1).abs() < 1e-8);
/// assert!((m.psnr.unwrap() - 20.0).abs() < 1e-6);
/// assert_eq!(metrics(&view(&grey), &view(&grey)).unwrap().psnr, None);
/// ```
pub fn metrics(test: &ImageView, reference: &ImageView) -> Result<Metrics, CompareError> {
    let differences = differences(test, reference)?;
    let values = 3.0 * differences.len() as f64;
    let width = test.width();
    let mse = sum_in_rows(&differences, width, |d| d * d) / values;
    let mut errors: Vec<f64> = differences.as_flattened().iter().map(|d| d.abs()).collect();
    Ok(Metrics {
        mse,
        rmse: mse.sqrt(),
        mae: sum_in_rows(&differences, width, f64::abs) / values,
        max: errors.iter().copied().fold(0.0, f64::max),
        p50: percentile(&mut errors, 50),
        p95: percentile(&mut errors, 95),
        p99: percentile(&mut errors, 99),
        psnr: (mse > 0.0).then(|| -10.0 * libm::log10(mse)),
    })
}

/// How many pixels differ in at least one channel.
pub fn pixels_differing(test: &ImageView, reference: &ImageView) -> Result<usize, CompareError> {
    test.check_comparable(reference)?;
    Ok(test
        .pixels()
        .iter()
        .zip(reference.pixels())
        .filter(|(t, r)| t != r)
        .count())
}

/// Sums up the differences of one step (`after - before` of each value) of a picture of this size.
///
/// ```
/// use rastray_compare::summarize;
/// let step = summarize(2, 1, &[[0.0, 0.0, 0.0], [0.5, -0.25, 0.0]]).unwrap();
/// assert_eq!((step.pixels, step.max, step.sum), (1, 0.5, [0.5, -0.25, 0.0]));
/// ```
pub fn summarize(
    width: usize,
    height: usize,
    differences: &[[f64; 3]],
) -> Result<StepSummary, CompareError> {
    check_finite(width, height, differences)?;
    let values = 3.0 * differences.len() as f64;
    let mut sum = [0.0; 3];
    for row in differences.chunks(width) {
        for (channel, total) in sum.iter_mut().enumerate() {
            *total += row.iter().fold(0.0, |s, d| s + d[channel]);
        }
    }
    Ok(StepSummary {
        rmse: (sum_in_rows(differences, width, |d| d * d) / values).sqrt(),
        max: differences
            .as_flattened()
            .iter()
            .fold(0.0, |m, d| m.max(d.abs())),
        pixels: differences.iter().filter(|d| **d != [0.0; 3]).count(),
        sum,
    })
}

/// Refuses differences that do not fill the picture or are not finite.
pub(crate) fn check_finite(
    width: usize,
    height: usize,
    differences: &[[f64; 3]],
) -> Result<(), CompareError> {
    check_shape(width, height, differences.len())?;
    match differences
        .iter()
        .position(|d| !d.iter().all(|v| v.is_finite()))
    {
        Some(i) => Err(CompareError::NotFinite {
            x: i % width,
            y: i / width,
        }),
        None => Ok(()),
    }
}

/// Sum of `f` over all values: each row left to right, then the rows from top to bottom.
fn sum_in_rows(differences: &[[f64; 3]], width: usize, f: impl Fn(f64) -> f64) -> f64 {
    let row_sum = |row: &[[f64; 3]]| row.as_flattened().iter().fold(0.0, |s, &d| s + f(d));
    differences
        .chunks(width)
        .fold(0.0, |s, row| s + row_sum(row))
}

/// Nearest-rank percentile: the smallest value that at least `percent` % of the values do not exceed.
fn percentile(values: &mut [f64], percent: usize) -> f64 {
    let rank = (values.len() as u128 * percent as u128)
        .div_ceil(100)
        .max(1) as usize;
    *values.select_nth_unstable_by(rank - 1, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Encoding;

    fn view(width: usize, pixels: &[[f32; 3]]) -> ImageView<'_> {
        ImageView::new(width, pixels.len() / width, pixels, Encoding::Linear).unwrap()
    }

    #[test]
    fn known_errors_give_known_numbers() {
        // Errors of the six values: 0.5, -0.25, 0, 0, 1, -1 (all exact in f32).
        let reference = [[0.5, 0.5, 0.0], [0.0, 0.0, 1.0]];
        let test = [[1.0, 0.25, 0.0], [0.0, 1.0, 0.0]];
        let m = metrics(&view(2, &test), &view(2, &reference)).unwrap();
        let mse = (0.25 + 0.0625 + 1.0 + 1.0) / 6.0;
        assert_eq!(m.mse, mse);
        assert_eq!(m.rmse, mse.sqrt());
        assert_eq!(m.mae, (0.5 + 0.25 + 1.0 + 1.0) / 6.0);
        assert_eq!(m.max, 1.0);
        // Sorted: 0 0 .25 .5 1 1; ranks ceil(3), ceil(5.7), ceil(5.94).
        assert_eq!((m.p50, m.p95, m.p99), (0.25, 1.0, 1.0));
        assert!((m.psnr.unwrap() - 10.0 * (1.0 / mse).log10()).abs() < 1e-12);
    }

    #[test]
    fn percentiles_are_nearest_rank() {
        let mut values: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(percentile(&mut values, 50), 50.0);
        assert_eq!(percentile(&mut values, 95), 95.0);
        assert_eq!(percentile(&mut values, 99), 99.0);
        assert_eq!(percentile(&mut [7.0], 50), 7.0);
    }

    #[test]
    fn the_direction_of_the_comparison_changes_only_signs() {
        let a: Vec<[f32; 3]> = (0..12)
            .map(|i| [i as f32 / 16.0, 0.5, 1.0 - i as f32 / 32.0])
            .collect();
        let b: Vec<[f32; 3]> = a.iter().rev().copied().collect();
        let (a, b) = (view(4, &a), view(4, &b));
        assert_eq!(metrics(&a, &b).unwrap(), metrics(&b, &a).unwrap());
        let negated = differences(&b, &a)
            .unwrap()
            .into_iter()
            .map(|d| d.map(|v| 0.0 - v));
        assert!(differences(&a, &b).unwrap().into_iter().eq(negated));
    }

    #[test]
    fn identical_pictures_have_no_psnr_and_no_error() {
        let a = [[0.25, 3.5, -1.0]; 9];
        let m = metrics(&view(3, &a), &view(3, &a)).unwrap();
        assert_eq!(
            (m.mse, m.rmse, m.mae, m.max, m.p99, m.psnr),
            (0.0, 0.0, 0.0, 0.0, 0.0, None)
        );
        assert_eq!(pixels_differing(&view(3, &a), &view(3, &a)), Ok(0));
    }

    #[test]
    fn sizes_and_encodings_must_match() {
        let a = [[0.0; 3]; 6];
        let wrong = metrics(&view(3, &a), &view(2, &a));
        assert_eq!(
            wrong,
            Err(CompareError::Size {
                test: (3, 2),
                reference: (2, 3)
            })
        );
        let srgb = ImageView::new(3, 2, &a, Encoding::Srgb).unwrap();
        assert!(matches!(
            metrics(&view(3, &a), &srgb),
            Err(CompareError::Encoding { .. })
        ));
    }

    #[test]
    fn steps_add_up() {
        // Two steps in multiples of 2^-10: their sums add to the sum of the whole, exactly.
        let step = |k: i32| -> Vec<[f64; 3]> {
            (0..20)
                .map(|i| [f64::from(i * k), f64::from(k - i), f64::from(i % 3)].map(|v| v / 1024.0))
                .collect()
        };
        let (first, second) = (step(3), step(-5));
        let whole: Vec<[f64; 3]> = first
            .iter()
            .zip(&second)
            .map(|(a, b)| std::array::from_fn(|c| a[c] + b[c]))
            .collect();
        let sum = |d: &[[f64; 3]]| summarize(5, 4, d).unwrap().sum;
        for c in 0..3 {
            assert_eq!(sum(&first)[c] + sum(&second)[c], sum(&whole)[c]);
        }
        // 0..20 times 3 in the first channel: 3 * 190 / 1024.
        assert_eq!(sum(&first)[0], 570.0 / 1024.0);
        assert_eq!(summarize(5, 4, &first).unwrap().pixels, 20);
        assert_eq!(
            summarize(5, 4, &[[f64::NAN; 3]; 20]),
            Err(CompareError::NotFinite { x: 0, y: 0 })
        );
    }
}
