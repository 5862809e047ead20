//! Separable filters over bands of rows.
//!
//! A picture is worked through in bands of [`BAND_ROWS`] rows, each with the rows above and below that its filters reach:
//! memory stays small however large the picture, bands run side by side, and no result depends on where a band begins,
//! because every pixel's sum runs over the same taps in the same order. Beyond the rim the nearest pixel is repeated.

use std::ops::Range;

use rayon::prelude::*;

/// Rows of a band: few enough to share among cores, many against the 2 x 10 rows that FLIP's filters reach beyond it.
const BAND_ROWS: usize = 48;

/// Runs `work` over the bands of a picture's rows side by side and joins their results from the top down.
pub(crate) fn in_bands<T: Send>(
    height: usize,
    work: impl Fn(Range<usize>) -> Vec<T> + Sync,
) -> Vec<T> {
    let bands = (0..height.div_ceil(BAND_ROWS)).into_par_iter();
    let parts: Vec<Vec<T>> = bands
        .map(|i| work(i * BAND_ROWS..((i + 1) * BAND_ROWS).min(height)))
        .collect();
    parts.into_iter().flatten().collect()
}

/// One channel of a band of rows with `margin` rows more above and below.
pub(crate) struct Band {
    width: usize,
    height: usize,
    margin: usize,
    values: Vec<f64>,
}

impl Band {
    /// The channels of rows `rows` of a picture of `size` with `margin` more on either side; `row(y)` gives the pixels
    /// of row `y`.
    pub(crate) fn channels<const N: usize, R: Iterator<Item = [f64; N]>>(
        size: (usize, usize),
        rows: Range<usize>,
        margin: usize,
        row: impl Fn(usize) -> R,
    ) -> [Self; N] {
        let height = rows.len();
        let mut bands = std::array::from_fn(|_| Self {
            width: size.0,
            height,
            margin,
            values: Vec::with_capacity(size.0 * (height + 2 * margin)),
        });
        for y in rows.start..rows.end + 2 * margin {
            for pixel in row(y.saturating_sub(margin).min(size.1 - 1)) {
                for (band, v) in bands.iter_mut().zip(pixel) {
                    band.values.push(v);
                }
            }
        }
        bands
    }

    /// The same band with every value mapped.
    pub(crate) fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        Self {
            values: self.values.iter().map(|v| f(*v)).collect(),
            ..*self
        }
    }

    /// The band's rows, filtered along x, then along y. Taps are of odd number, the middle one on the pixel; the vertical
    /// ones reach no farther than the margin.
    pub(crate) fn filtered(&self, along_x: &[f64], along_y: &[f64]) -> Vec<f64> {
        let reach = along_y.len() / 2;
        debug_assert!(reach <= self.margin);
        let width = self.width;
        let rows = self.height + 2 * reach;
        let first = (self.margin - reach) * width;
        let source = &self.values[first..first + rows * width];
        let mut blurred = vec![0.0; rows * width];
        let mut padded = Vec::new();
        for (row, out) in source.chunks(width).zip(blurred.chunks_mut(width)) {
            pad(row, along_x.len() / 2, &mut padded);
            for (k, &tap) in along_x.iter().enumerate() {
                add_scaled(out, &padded[k..k + width], tap);
            }
        }
        let mut result = vec![0.0; self.height * width];
        for (y, out) in result.chunks_mut(width).enumerate() {
            for (k, &tap) in along_y.iter().enumerate() {
                let start = (y + k) * width;
                add_scaled(out, &blurred[start..start + width], tap);
            }
        }
        result
    }
}

/// `row` with its first and last value repeated `reach` times.
fn pad(row: &[f64], reach: usize, padded: &mut Vec<f64>) {
    padded.clear();
    padded.extend(std::iter::repeat_n(row[0], reach));
    padded.extend_from_slice(row);
    padded.extend(std::iter::repeat_n(row[row.len() - 1], reach));
}

fn add_scaled(sum: &mut [f64], values: &[f64], tap: f64) {
    for (s, v) in sum.iter_mut().zip(values) {
        *s += tap * v;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_joined_in_order() {
        let rows = in_bands(1000, |rows| rows.collect());
        assert_eq!(rows, (0..1000).collect::<Vec<_>>());
    }

    /// Against the plain double sum with repeated rims, whatever rows the band holds.
    #[test]
    fn a_band_is_filtered_as_the_whole_picture() {
        let (width, height) = (7, 9);
        let value = |x: usize, y: usize| ((x * 31 + y * 17) % 23) as f64;
        let (along_x, along_y) = ([0.5, 1.0, -2.0, 0.25, 3.0], [1.0, -0.5, 2.0]);
        let expected = |x: usize, y: usize| {
            let at = |i: usize, k: usize, reach: usize, end: usize| {
                (i + k).saturating_sub(reach).min(end - 1)
            };
            let mut sum = 0.0;
            for (j, wy) in along_y.iter().enumerate() {
                for (k, wx) in along_x.iter().enumerate() {
                    sum += wy * wx * value(at(x, k, 2, width), at(y, j, 1, height));
                }
            }
            sum
        };
        for rows in [0..9, 0..1, 3..5, 8..9] {
            let [band] = Band::channels((width, height), rows.clone(), 3, |y| {
                (0..width).map(move |x| [value(x, y)])
            });
            let found = band.filtered(&along_x, &along_y);
            for (i, found) in found.iter().enumerate() {
                let (x, y) = (i % width, rows.start + i / width);
                assert!((found - expected(x, y)).abs() < 1e-10, "{x} {y}");
            }
        }
    }
}
