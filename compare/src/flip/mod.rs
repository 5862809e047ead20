//! FLIP: what somebody sees who flips between two pictures on a screen.
//!
//! FLIP-2020 (see [`color`]) models a viewer: pictures are filtered by the eye's contrast sensitivity at the distance at
//! which they are looked at (`ppd`, pixels per degree), colours are compared in a space of equal steps, and a difference
//! weighs more at edges and points, which the eye looks for. 0 = not seen, 1 = the largest difference there is. FLIP-2021
//! (see [`exposure`]) takes the largest error under several exposures of a float picture.
//!
//! Everything runs in f64 and pixel by pixel in one order: same bytes for any number of threads.
//!
//! Measured (2026-11, 1024 x 768, release, processor time of one thread): LDR-FLIP 0.47 s, HDR-FLIP as much for each exposure;
//! SSIM 0.06 s. A float picture that is black in half of its pixels has some 24 exposures, by FLIP-2021's rule.

mod color;
mod exposure;
mod kernel;

use std::ops::Range;

use color::Colors;
pub use exposure::Exposures;
use exposure::tone_map;
use kernel::Kernels;

use crate::filter::{Band, in_bands};
use crate::stats::{mean, percentile};
use crate::{CompareError, ImageView};

/// Pixels per degree of a picture looked at from 0.7 m on a screen 0.7 m and 3840 pixels wide (FLIP-2020, section 5).
pub const DEFAULT_PPD: f64 = 67.02;
/// Pixels per degree that are taken: fewer resolve nothing, more than 16 times the eye's own resolution say nothing.
const PPD_RANGE: std::ops::RangeInclusive<f64> = 1.0..=1000.0;
/// Weight of features (FLIP-2020, section 4.2): their contrast to this power.
const Q_F: f64 = 0.5;

/// What kind of picture is looked at, and from where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewing {
    /// Pixels per degree of visual angle: how large a pixel is seen.
    pub ppd: f64,
    /// Which of the two forms of FLIP.
    pub range: DynamicRange,
}

impl Default for Viewing {
    /// An 8-bit picture from the usual distance, [`DEFAULT_PPD`].
    fn default() -> Self {
        Self {
            ppd: DEFAULT_PPD,
            range: DynamicRange::Low,
        }
    }
}

/// Which form of FLIP suits a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DynamicRange {
    /// LDR-FLIP: values in [0, 1], clamped and rounded to 8 bits, shown by a display as sRGB.
    Low,
    /// HDR-FLIP: values proportional to light, without an upper limit; negative ones count as 0.
    High,
}

/// The error of each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct FlipMap {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// One value in [0, 1] a pixel, row-major, top row first.
    pub values: Vec<f32>,
    /// The exposures of HDR-FLIP; none for LDR-FLIP.
    pub exposures: Option<Exposures>,
}

/// FLIP over many pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FlipSummary {
    /// Mean error.
    pub mean: f64,
    /// Median error (nearest rank): half of the pixels have no larger one.
    pub median: f64,
    /// Largest error.
    pub max: f64,
}

impl FlipMap {
    /// The numbers of the whole picture.
    pub fn summary(&self) -> FlipSummary {
        summary(self.values.chunks(self.width).map(|row| row.iter()))
    }

    /// The numbers of the pixels where the mask is set; at least one must be, and it has as many pixels as the picture.
    pub(crate) fn summary_in(&self, mask: &[bool]) -> FlipSummary {
        let rows = self.values.chunks(self.width).zip(mask.chunks(self.width));
        summary(rows.map(|(row, mask)| {
            let pairs = row.iter().zip(mask);
            pairs.filter(|(_, m)| **m).map(|(v, _)| v)
        }))
    }
}

fn summary<'a, R: Iterator<Item = &'a f32>>(rows: impl Iterator<Item = R>) -> FlipSummary {
    let rows: Vec<Vec<f64>> = rows
        .map(|row| row.copied().map(f64::from).collect())
        .collect();
    let mean = mean(rows.iter().map(|row| row.iter().copied()));
    let mut values = rows.concat();
    FlipSummary {
        mean,
        median: percentile(&mut values, 50),
        max: values.iter().copied().fold(0.0, f64::max),
    }
}

/// The FLIP error of each pixel; HDR-FLIP chooses its exposures by the reference.
///
/// ```
/// use rastray_compare::{Encoding, ImageView, Viewing, flip};
/// let (black, white) = ([[0.0; 3]; 4], [[1.0; 3]; 4]);
/// let view = |p| ImageView::new(2, 2, p, Encoding::Linear).unwrap();
/// let error = flip(&view(&white), &view(&black), Viewing::default()).unwrap().summary();
/// assert!(error.mean > 0.96 && error.mean < 0.98); // green against blue is the 1
/// ```
///
/// # Errors
/// Pictures that cannot be compared, and a number of pixels per degree outside 1 to 1000.
pub fn flip(
    test: &ImageView,
    reference: &ImageView,
    viewing: Viewing,
) -> Result<FlipMap, CompareError> {
    test.check_comparable(reference)?;
    if !PPD_RANGE.contains(&viewing.ppd) {
        return Err(CompareError::PixelsPerDegree { ppd: viewing.ppd });
    }
    let eye = Eye {
        colors: Colors::new(),
        kernels: Kernels::new(viewing.ppd),
    };
    let (width, height) = (test.width(), test.height());
    let (values, exposures) = match viewing.range {
        DynamicRange::Low => {
            let shown = display_table();
            let show = |v: f32| shown[(v.clamp(0.0, 1.0) * 255.0).round() as usize];
            (
                in_bands(height, |rows| eye.errors(test, reference, rows, show)),
                None,
            )
        }
        DynamicRange::High => {
            let exposures = Exposures::of(reference);
            let factors = exposures.factors();
            let work = |rows: Range<usize>| eye.worst(test, reference, rows, &factors);
            (in_bands(height, work), Some(exposures))
        }
    };
    Ok(FlipMap {
        width,
        height,
        values,
        exposures,
    })
}

/// Linear values of the 256 values of a display (sRGB, IEC 61966-2-1).
fn display_table() -> [f64; 256] {
    std::array::from_fn(|i| {
        let v = i as f64 / 255.0;
        if v <= 0.04045 {
            v / 12.92
        } else {
            libm::pow((v + 0.055) / 1.055, 2.4)
        }
    })
}

/// The model of the viewer.
struct Eye {
    colors: Colors,
    kernels: Kernels,
}

/// A band as it is seen.
struct Seen {
    /// L*a*b* with Hunt's effect.
    color: Vec<[f64; 3]>,
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl Eye {
    /// The largest error of each pixel of the rows under exposures by these factors.
    fn worst(
        &self,
        test: &ImageView,
        reference: &ImageView,
        rows: Range<usize>,
        factors: &[f64],
    ) -> Vec<f32> {
        let mut worst = vec![0.0f32; rows.len() * test.width()];
        for factor in factors {
            let show = |v: f32| tone_map(factor * f64::from(v));
            let errors = self.errors(test, reference, rows.clone(), show);
            for (w, error) in worst.iter_mut().zip(errors) {
                *w = w.max(error);
            }
        }
        worst
    }

    /// The error of each pixel of the rows; `show` makes a stored value linear, in [0, 1].
    fn errors(
        &self,
        test: &ImageView,
        reference: &ImageView,
        rows: Range<usize>,
        show: impl Fn(f32) -> f64 + Copy,
    ) -> Vec<f32> {
        let [a, b] = [test, reference].map(|image| self.see(image, rows.clone(), show));
        let error = |i: usize| {
            let color = self.colors.difference(a.color[i], b.color[i]);
            let edge = (a.edges[i] - b.edges[i]).abs();
            let point = (a.points[i] - b.points[i]).abs();
            // FLIP-2020, section 4.2: the stronger feature, in [0, 1].
            let feature = libm::pow(std::f64::consts::FRAC_1_SQRT_2 * edge.max(point), Q_F);
            // Section 4.3: features raise the colour's error.
            libm::pow(color, 1.0 - feature.min(1.0)) as f32
        };
        (0..a.color.len()).map(error).collect()
    }

    fn see(&self, image: &ImageView, rows: Range<usize>, show: impl Fn(f32) -> f64 + Copy) -> Seen {
        let (size, margin) = ((image.width(), image.height()), self.kernels.margin());
        let opponent = |y: usize| {
            let row = &image.pixels()[y * size.0..(y + 1) * size.0];
            row.iter().map(move |p| self.colors.opponent(p.map(show)))
        };
        let bands = Band::channels(size, rows.clone(), margin, opponent);
        let [y, cx, cz] = self.kernels.sensed(&bands);
        let color = (0..y.len())
            .map(|i| self.colors.seen([y[i], cx[i], cz[i]]))
            .collect();
        // Features are found in relative luminance.
        let luminance = bands[0].map(|v| (v + 16.0) / 116.0);
        let [edges, points] = self.kernels.features(&luminance);
        Seen {
            color,
            edges,
            points,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Encoding;

    fn pixels(width: usize, height: usize, f: impl Fn(usize, usize) -> [f32; 3]) -> Vec<[f32; 3]> {
        (0..width * height)
            .map(|i| f(i % width, i / width))
            .collect()
    }

    fn view(width: usize, pixels: &[[f32; 3]]) -> ImageView<'_> {
        ImageView::new(width, pixels.len() / width, pixels, Encoding::Linear).unwrap()
    }

    fn viewing(range: DynamicRange) -> Viewing {
        Viewing {
            range,
            ..Viewing::default()
        }
    }

    #[test]
    fn what_is_the_same_has_no_error() {
        let p = pixels(40, 60, |x, y| {
            [x as f32 / 40.0, y as f32 / 60.0, ((x * y) % 7) as f32]
        });
        for range in [DynamicRange::Low, DynamicRange::High] {
            let map = flip(&view(40, &p), &view(40, &p), viewing(range)).unwrap();
            assert!(map.values.iter().all(|v| *v == 0.0));
        }
    }

    #[test]
    fn an_error_stays_where_the_eye_can_see_it() {
        let reference = pixels(61, 61, |_, _| [0.5; 3]);
        let mut test = reference.clone();
        test[30 * 61 + 30] = [1.0, 0.0, 0.0];
        let map = flip(&view(61, &test), &view(61, &reference), Viewing::default()).unwrap();
        let at = |x: usize, y: usize| map.values[y * 61 + x];
        assert!(at(30, 30) > at(33, 30) && at(33, 30) > 0.0);
        // The widest filter reaches 10 pixels.
        assert!(at(41, 30) == 0.0 && at(30, 19) == 0.0);
        // Turned by a quarter it is the same picture.
        for (x, y) in [(31, 30), (34, 28), (25, 37)] {
            assert!((at(x, y) - at(60 - y, x)).abs() < 1e-6);
        }
    }

    #[test]
    fn every_float_has_a_finite_error() {
        let odd = [
            0.0,
            -1.0,
            f32::MAX,
            -f32::MAX,
            f32::MIN_POSITIVE,
            1e-45,
            1e20,
        ];
        let a = pixels(9, 5, |x, y| [odd[(x + y) % 7], odd[x % 7], odd[y % 7]]);
        let b = pixels(9, 5, |x, y| [odd[(x * y) % 7], odd[(x + 1) % 7], 0.5]);
        let black = pixels(9, 5, |_, _| [0.0; 3]);
        for (test, reference) in [(&a, &b), (&b, &a), (&a, &black), (&black, &a)] {
            for range in [DynamicRange::Low, DynamicRange::High] {
                let map = flip(&view(9, test), &view(9, reference), viewing(range)).unwrap();
                assert!(
                    map.values.iter().all(|v| (0.0..=1.0).contains(v)),
                    "{range:?}"
                );
            }
        }
    }

    #[test]
    fn a_wrong_distance_is_refused() {
        let p = [[0.0; 3]; 4];
        for ppd in [0.0, -1.0, 0.5, 1001.0, f64::NAN, f64::INFINITY] {
            let asked = Viewing {
                ppd,
                ..Viewing::default()
            };
            assert!(flip(&view(2, &p), &view(2, &p), asked).is_err(), "{ppd}");
        }
    }

    #[test]
    fn threads_change_no_bit() {
        let a = pixels(50, 150, |x, y| {
            [(x % 9) as f32 / 9.0, (y % 11) as f32 / 8.0, 0.3]
        });
        let b = pixels(50, 150, |x, y| {
            [(x % 8) as f32 / 9.0, (y % 11) as f32 / 8.0, 0.4]
        });
        for range in [DynamicRange::Low, DynamicRange::High] {
            let with = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .unwrap();
                pool.install(|| flip(&view(50, &a), &view(50, &b), viewing(range)).unwrap())
            };
            assert_eq!(with(1), with(3));
        }
    }

    /// `cargo test -p rastray-compare --release -- --ignored --nocapture speed`
    #[test]
    #[ignore = "a measurement"]
    fn speed_of_1024_by_768() {
        let picture = |seed: usize| {
            pixels(1024, 768, |x, y| {
                [x, y, x + y].map(|v| ((v * seed) % 251) as f32 / 250.0)
            })
        };
        let (a, b) = (picture(3), picture(5));
        for range in [DynamicRange::Low, DynamicRange::High] {
            let start = std::time::Instant::now();
            let map = flip(&view(1024, &a), &view(1024, &b), viewing(range)).unwrap();
            println!(
                "{range:?}: {:?}, {:?}, {:?}",
                start.elapsed(),
                map.summary(),
                map.exposures
            );
        }
        let start = std::time::Instant::now();
        let found = crate::ssim(&view(1024, &a), &view(1024, &b)).unwrap();
        println!("SSIM: {:?}, {:?}", start.elapsed(), found.mean());
    }
}
