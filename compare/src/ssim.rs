//! SSIM: how alike two pictures are in brightness, contrast and structure, window by window.
//!
//! Wang, Bovik, Sheikh, Simoncelli: "Image Quality Assessment: From Error Visibility to Structural Similarity", IEEE
//! Trans. Image Processing 13(4), 2004, equation 13, on the luma of the stored values; Gaussian windows of 11 x 11 pixels
//! with sigma = 1.5, weights of sum 1; C1 = .01^2 and C2 = .03^2 for values in [0, 1]. Only windows that lie inside the
//! picture count, as in the authors' own program.

use crate::filter::{Band, in_bands};
use crate::stats::mean;
use crate::view::luma;
use crate::{CompareError, ImageView};

/// Pixels of a window beside its middle one.
const REACH: usize = 5;
const SIGMA: f64 = 1.5;
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// The similarity of each window.
#[derive(Clone, Debug, PartialEq)]
pub struct SsimMap {
    /// Width of the pictures in pixels.
    pub width: usize,
    /// Height of the pictures.
    pub height: usize,
    /// One value in [-1, 1] for each pixel that is the middle of a window inside the picture, row-major, top row first: `width - 10` by
    /// `height - 10`, none where the picture is smaller than a window.
    pub values: Vec<f32>,
}

impl SsimMap {
    /// The mean over all windows; none where the picture is smaller than a window.
    pub fn mean(&self) -> Option<f64> {
        (!self.values.is_empty()).then(|| mean(self.rows().map(|row| row.copied().map(f64::from))))
    }

    /// The mean over the windows in whose middle the mask, of the pictures' size, is set; none where there is none.
    pub(crate) fn mean_in(&self, mask: &[bool]) -> Option<f64> {
        let inner = |row: usize| {
            let start = (row + REACH) * self.width + REACH;
            &mask[start..start + self.width - 2 * REACH]
        };
        let picked = |(y, row): (usize, std::slice::Iter<f32>)| -> Vec<f64> {
            let pairs = row.zip(inner(y)).filter(|(_, m)| **m);
            pairs.map(|(v, _)| f64::from(*v)).collect()
        };
        let rows: Vec<Vec<f64>> = self.rows().enumerate().map(picked).collect();
        let any = rows.iter().any(|row| !row.is_empty());
        any.then(|| mean(rows.iter().map(|row| row.iter().copied())))
    }

    fn rows(&self) -> impl Iterator<Item = std::slice::Iter<'_, f32>> {
        // A picture narrower than a window has no values, and chunks of no length are not allowed.
        let width = self.width.saturating_sub(2 * REACH).max(1);
        self.values.chunks(width).map(|row| row.iter())
    }
}

/// The similarity of the windows of two pictures: 1 where they are the same.
///
/// Values beyond [0, 1] are measured as they are, though the constants are meant for a range of 1.
///
/// ```
/// use rastray_compare::{Encoding, ImageView, ssim};
/// let (grey, white) = ([[0.5; 3]; 144], [[1.0; 3]; 144]);
/// let view = |p| ImageView::new(12, 12, p, Encoding::Linear).unwrap();
/// let found = ssim(&view(&white), &view(&grey)).unwrap().mean().unwrap();
/// // Without structure only brightness is left: (2 * 1 * .5 + C1) / (1 + .25 + C1).
/// assert!((found - 1.0001 / 1.2501).abs() < 1e-7);
/// ```
pub fn ssim(test: &ImageView, reference: &ImageView) -> Result<SsimMap, CompareError> {
    test.check_comparable(reference)?;
    let (width, height) = (test.width(), test.height());
    let fits = width > 2 * REACH && height > 2 * REACH;
    let weights = window();
    let row = |y: usize| {
        let row = y * width..(y + 1) * width;
        let pairs = test.pixels()[row.clone()]
            .iter()
            .zip(&reference.pixels()[row]);
        pairs.map(|(a, b)| {
            let [a, b] = [a, b].map(|p| luma(p.map(f64::from)));
            [a, b, a * a, b * b, a * b]
        })
    };
    let band = |inner: std::ops::Range<usize>| -> Vec<f32> {
        // Row y of the map is the window around row y + REACH.
        let rows = inner.start + REACH..inner.end + REACH;
        let bands = Band::channels((width, height), rows, REACH, row);
        let [a, b, aa, bb, ab] = bands.map(|band| band.filtered(&weights, &weights));
        let inside = |i: &usize| (REACH..width - REACH).contains(&(i % width));
        let index = (0..a.len()).filter(inside);
        index
            .map(|i| similarity(a[i], b[i], aa[i], bb[i], ab[i]) as f32)
            .collect()
    };
    let values = if fits {
        in_bands(height - 2 * REACH, band)
    } else {
        Vec::new()
    };
    Ok(SsimMap {
        width,
        height,
        values,
    })
}

/// Equation 13 from the weighted means of a, b, a^2, b^2 and a b in a window.
fn similarity(a: f64, b: f64, aa: f64, bb: f64, ab: f64) -> f64 {
    // Rounding may take variances below 0, and a covariance beyond what they allow.
    let (var_a, var_b) = ((aa - a * a).max(0.0), (bb - b * b).max(0.0));
    let most = var_a.sqrt() * var_b.sqrt();
    // Where both are the same, so is every bit, and the root must not change it.
    let covariance = if aa == bb && bb == ab {
        var_a
    } else {
        (ab - a * b).clamp(-most, most)
    };
    let brightness = (2.0 * a * b + C1) / (a * a + b * b + C1);
    let structure = (2.0 * covariance + C2) / (var_a + var_b + C2);
    (brightness * structure).clamp(-1.0, 1.0)
}

/// Weights of the window along one axis, of sum 1.
fn window() -> [f64; 2 * REACH + 1] {
    let weights: [f64; 2 * REACH + 1] = std::array::from_fn(|i| {
        let x = i as f64 - REACH as f64;
        libm::exp(-x * x / (2.0 * SIGMA * SIGMA))
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|w| w / sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Encoding;

    fn view(width: usize, pixels: &[[f32; 3]]) -> ImageView<'_> {
        ImageView::new(width, pixels.len() / width, pixels, Encoding::Linear).unwrap()
    }

    fn checks(width: usize, height: usize, low: f32, high: f32) -> Vec<[f32; 3]> {
        let at = |i: usize| {
            if (i % width + i / width).is_multiple_of(2) {
                low
            } else {
                high
            }
        };
        (0..width * height).map(|i| [at(i); 3]).collect()
    }

    #[test]
    fn the_same_is_one_and_the_inverse_is_near_minus_one() {
        let (a, b) = (checks(30, 20, 0.0, 1.0), checks(30, 20, 1.0, 0.0));
        let map = ssim(&view(30, &a), &view(30, &a)).unwrap();
        assert_eq!((map.values.len(), map.mean()), (20 * 10, Some(1.0)));
        let found = ssim(&view(30, &b), &view(30, &a)).unwrap().mean().unwrap();
        // Means of .5 and variances of .25 within 1e-4, covariance -.25: (-.5 + C2) / (.5 + C2).
        assert!((found - (-0.4991 / 0.5009)).abs() < 1e-3, "{found}");
    }

    #[test]
    fn small_pictures_have_no_window_and_masks_pick_windows_by_their_middle() {
        for (width, height) in [(10, 40), (40, 10), (1, 1)] {
            let p = vec![[0.3; 3]; width * height];
            assert_eq!(
                ssim(&view(width, &p), &view(width, &p)).unwrap().mean(),
                None
            );
        }
        let (a, mut b) = (vec![[0.5; 3]; 30 * 30], vec![[0.5; 3]; 30 * 30]);
        b[2 * 30 + 20] = [1.0; 3]; // reaches windows around columns 15 to 25, rows up to 7
        let map = ssim(&view(30, &b), &view(30, &a)).unwrap();
        let mask = |f: &dyn Fn(usize, usize) -> bool| -> Vec<bool> {
            (0..900).map(|i| f(i % 30, i / 30)).collect()
        };
        assert_eq!(map.mean_in(&mask(&|_, y| y >= 8)), Some(1.0));
        assert_eq!(map.mean_in(&mask(&|x, _| x < 15)), Some(1.0));
        assert!(map.mean_in(&mask(&|x, y| x == 20 && y == 5)).unwrap() < 0.999);
        assert_eq!(map.mean_in(&mask(&|_, y| y < 5)), None);
        assert_eq!(map.mean_in(&mask(&|_, _| true)), map.mean());
    }

    #[test]
    fn huge_values_stay_in_range() {
        let a: Vec<[f32; 3]> = (0..400)
            .map(|i| [if i % 3 == 0 { f32::MAX } else { 1e30 }; 3])
            .collect();
        let b: Vec<[f32; 3]> = (0..400)
            .map(|i| [if i % 5 == 0 { -f32::MAX } else { 1e-30 }; 3])
            .collect();
        assert_eq!(
            ssim(&view(20, &a), &view(20, &a)).unwrap().mean(),
            Some(1.0)
        );
        let map = ssim(&view(20, &a), &view(20, &b)).unwrap();
        assert!(map.values.iter().all(|v| (-1.0..=1.0).contains(v)));
    }
}
