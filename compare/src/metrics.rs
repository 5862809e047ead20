//! Numbers from two pictures: see the crate head for what each means and when it misleads.

use std::ops::Range;

use crate::flip::{FlipMap, FlipSummary, Viewing, flip};
use crate::ssim::{SsimMap, ssim};
use crate::stats::{self, mean, percentile, rmse};
use crate::view::check_shape;
use crate::{CompareError, ImageView};

/// The distance of two pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// Mean structural similarity; none where no window of 11 x 11 pixels has its middle here.
    pub ssim: Option<f64>,
    /// What somebody sees who flips between the two.
    pub flip: FlipSummary,
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

/// `test - reference` per value, in f64: exact for two f32 of similar size, and rounded once from the fractions that
/// they stand for where both pictures hold whole 255ths or 65535ths.
pub fn differences(test: &ImageView, reference: &ImageView) -> Result<Vec<[f64; 3]>, CompareError> {
    test.check_comparable(reference)?;
    let pairs = test.pixels().iter().zip(reference.pixels());
    let error = error(test, reference);
    Ok(pairs.map(|(t, r)| error(t, r)).collect())
}

/// A test picture held against the reference: every map once, and numbers of the whole or of a part.
#[derive(Clone, Debug)]
pub struct Comparison<'a> {
    test: ImageView<'a>,
    reference: ImageView<'a>,
    ssim: SsimMap,
    flip: FlipMap,
}

impl<'a> Comparison<'a> {
    /// Compares two pictures of one size and encoding.
    ///
    /// # Errors
    /// Other sizes or encodings, and a number of pixels per degree outside 1 to 1000.
    pub fn new(
        test: &ImageView<'a>,
        reference: &ImageView<'a>,
        viewing: Viewing,
    ) -> Result<Self, CompareError> {
        Ok(Self {
            test: *test,
            reference: *reference,
            ssim: ssim(test, reference)?,
            flip: flip(test, reference, viewing)?,
        })
    }

    /// The similarity of each window.
    pub fn ssim(&self) -> &SsimMap {
        &self.ssim
    }

    /// The FLIP error of each pixel.
    pub fn flip(&self) -> &FlipMap {
        &self.flip
    }

    /// The numbers of the whole picture.
    pub fn metrics(&self) -> Metrics {
        self.numbers(|_| true, self.ssim.mean(), self.flip.summary())
    }

    /// The numbers of the pixels where the mask is set; none where it is set nowhere. The mask is row-major, top row first.
    ///
    /// Errors are those of the pixels of the mask alone; windows of SSIM and filters of FLIP reach beyond it.
    ///
    /// ```
    /// use rastray_compare::{Comparison, Encoding, ImageView, Viewing};
    /// let (a, b) = ([[0.0; 3]; 4], [[0.0; 3], [0.5; 3], [0.0; 3], [0.0; 3]]);
    /// let view = |p| ImageView::new(2, 2, p, Encoding::Linear).unwrap();
    /// let both = Comparison::new(&view(&b), &view(&a), Viewing::default()).unwrap();
    /// let part = both.metrics_in(&[true, true, false, false]).unwrap().unwrap();
    /// assert_eq!((part.mse, both.metrics().mse), (0.125, 0.0625));
    /// assert_eq!(both.metrics_in(&[false; 4]), Ok(None));
    /// ```
    ///
    /// # Errors
    /// A mask of another number of pixels.
    pub fn metrics_in(&self, mask: &[bool]) -> Result<Option<Metrics>, CompareError> {
        check_shape(self.test.width(), self.test.height(), mask.len())?;
        if !mask.contains(&true) {
            return Ok(None);
        }
        let (ssim, flip) = (self.ssim.mean_in(mask), self.flip.summary_in(mask));
        Ok(Some(self.numbers(|pixel| mask[pixel], ssim, flip)))
    }

    /// Measures the pixels that are picked, of which there is at least one.
    fn numbers(
        &self,
        picked: impl Fn(usize) -> bool,
        ssim: Option<f64>,
        flip: FlipSummary,
    ) -> Metrics {
        let width = self.test.width();
        let error = error(&self.test, &self.reference);
        let (test, reference) = (self.test.pixels(), self.reference.pixels());
        let (mut errors, mut rows) = (Vec::new(), Vec::new());
        for y in 0..self.test.height() {
            let start = errors.len();
            let row = (y * width..(y + 1) * width).filter(|i| picked(*i));
            errors.extend(row.flat_map(|i| error(&test[i], &reference[i]).map(f64::abs)));
            rows.push(start..errors.len());
        }
        let row = |range: &Range<usize>| errors[range.clone()].iter();
        let mse = stats::mse(rows.iter().map(|range| row(range).copied()));
        let mae = mean(rows.iter().map(|range| row(range).copied()));
        Metrics {
            mse,
            rmse: mse.sqrt(),
            mae,
            max: errors.iter().copied().fold(0.0, f64::max),
            p50: percentile(&mut errors, 50),
            p95: percentile(&mut errors, 95),
            p99: percentile(&mut errors, 99),
            psnr: (mse > 0.0).then(|| -10.0 * libm::log10(mse)),
            ssim,
            flip,
        }
    }
}

/// `test - reference` of a pixel: see [`differences`].
fn error(test: &ImageView, reference: &ImageView) -> impl Fn(&[f32; 3], &[f32; 3]) -> [f64; 3] {
    let [a, b] = test.values(reference);
    move |t, r| std::array::from_fn(|c| a(t[c]) - b(r[c]))
}

/// Measures a test picture against the reference, looked at from the usual distance.
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
    Ok(Comparison::new(test, reference, Viewing::default())?.metrics())
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
    let rows = differences.chunks(width);
    let mut sum = [0.0; 3];
    for row in rows.clone() {
        for (channel, total) in sum.iter_mut().enumerate() {
            *total += row.iter().fold(0.0, |s, d| s + d[channel]);
        }
    }
    Ok(StepSummary {
        rmse: rmse(rows.map(|row| row.as_flattened().iter().copied())),
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
    fn the_direction_of_the_comparison_changes_only_signs() {
        let a: Vec<[f32; 3]> = (0..12)
            .map(|i| [i as f32 / 16.0, 0.5, 1.0 - i as f32 / 32.0])
            .collect();
        let b: Vec<[f32; 3]> = a.iter().rev().copied().collect();
        let (a, b) = (view(4, &a), view(4, &b));
        assert_eq!(metrics(&a, &b).unwrap(), metrics(&b, &a).unwrap());
        assert_eq!(metrics(&a, &b).unwrap().ssim, None); // smaller than a window
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
