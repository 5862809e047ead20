//! How far a picture is from the truth: rmse, mean, 99 % and largest error of linear values, interior and silhouette apart.
//!
//! Values are compared before any clamp, in f64, channel by channel. Both are limited to |x| <= 2^20 first, as the ladder's
//! are, so that an infinite highlight gives a large number instead of none. Silhouettes are set apart because they drown
//! everything else: one pixel at an edge that shows the other surface is off by as much as the surfaces differ.

use rastray_compare::{CompareError, Encoding, ImageView, Viewing, flip, rmse};
use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::frame::Plane;
use crate::math::color::quantize8;

/// The largest magnitude that is compared.
const LIMIT: f64 = 1_048_576.0;

/// Errors of the values of some pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Root of the mean square.
    pub rmse: f64,
    /// Mean magnitude.
    pub mean: f64,
    /// Magnitude that 99 % of the values do not exceed.
    pub p99: f64,
    /// Largest magnitude.
    pub max: f64,
    /// Pixels.
    pub pixels: usize,
}

impl Errors {
    /// Of some colour differences; all 0 where there is none.
    pub fn of(differences: impl Iterator<Item = [f64; 3]>) -> Self {
        let mut sizes: Vec<f64> = differences.flatten().map(f64::abs).collect();
        if sizes.is_empty() {
            return Self::default();
        }
        let n = sizes.len();
        let rmse = rmse(std::iter::once(sizes.iter().copied()));
        let sum: f64 = sizes.iter().sum();
        // The smallest value that at least 99 % do not exceed.
        let rank = (n * 99).div_ceil(100).clamp(1, n) - 1;
        let (_, p99, rest) = sizes.select_nth_unstable_by(rank, f64::total_cmp);
        let (p99, max) = (*p99, rest.iter().copied().fold(*p99, f64::max));
        Self {
            rmse,
            mean: sum / n as f64,
            p99,
            max,
            pixels: n / 3,
        }
    }
}

/// The error of a picture, everywhere and apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// All pixels.
    pub all: Errors,
    /// Pixels away from silhouettes.
    pub interior: Errors,
    /// Pixels at silhouettes.
    pub silhouette: Errors,
    /// Pixels of curved shapes, away from silhouettes.
    pub curved: Errors,
    /// Mean FLIP error of the 8-bit picture at 67 pixels a degree.
    pub flip: f64,
}

impl Accuracy {
    /// Of a picture against the truth of the same size; `silhouette` and `curved` say which pixels are.
    ///
    /// # Errors
    /// [`Error::Limit`] where FLIP refuses the pictures.
    pub fn of(
        picture: &Plane<[f64; 3]>,
        truth: &Plane<[f64; 3]>,
        silhouette: &Plane<bool>,
        curved: &Plane<bool>,
    ) -> Result<Self, Error> {
        let differences = || picture.data.iter().zip(&truth.data).map(difference);
        let of = |at: bool| {
            let chosen = differences()
                .zip(&silhouette.data)
                .filter(move |(_, s)| **s == at);
            Errors::of(chosen.map(|(d, _)| d))
        };
        let masks = || silhouette.data.iter().zip(&curved.data);
        let round = differences().zip(masks()).filter(|(_, (s, c))| !**s && **c);
        Ok(Self {
            all: Errors::of(differences()),
            interior: of(false),
            silhouette: of(true),
            curved: Errors::of(round.map(|(d, _)| d)),
            flip: mean_flip(picture, truth)?,
        })
    }
}

/// Mean FLIP error of the 8-bit pictures at the default distance.
fn mean_flip(picture: &Plane<[f64; 3]>, truth: &Plane<[f64; 3]>) -> Result<f64, Error> {
    // Files hold f32: rounded to it first, so that a value at the border of two steps shows alike in both precisions.
    let step = |x: f64| f32::from(quantize8(x as f32)) / 255.0;
    let stored = |plane: &Plane<[f64; 3]>| plane.map(|c| c.map(step));
    let (a, b) = (stored(picture), stored(truth));
    let fail = |e| Error::limit(format!("cannot compare the pictures: {e}"));
    let map = flip(
        &view_of(&a).map_err(fail)?,
        &view_of(&b).map_err(fail)?,
        Viewing::default(),
    )
    .map_err(fail)?;
    Ok(map.summary().mean)
}

/// Values are displayed as they are stored, as GL's are: taken as sRGB, like those of any PNG.
fn view_of(plane: &Plane<[f32; 3]>) -> Result<ImageView<'_>, CompareError> {
    ImageView::new(plane.width, plane.height, &plane.data, Encoding::Srgb)
}

fn difference((a, b): (&[f64; 3], &[f64; 3])) -> [f64; 3] {
    [0, 1, 2].map(|c| a[c].clamp(-LIMIT, LIMIT) - b[c].clamp(-LIMIT, LIMIT))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_the_definitions() {
        // 300 values: 297 of 0, then 1, 2, 2.
        let mut list = vec![[0.0; 3]; 99];
        list.push([1.0, -2.0, 2.0]);
        let errors = Errors::of(list.into_iter());
        assert_eq!(errors.rmse, (9.0f64 / 300.0).sqrt());
        assert_eq!(errors.mean, 5.0 / 300.0);
        assert_eq!((errors.p99, errors.max, errors.pixels), (0.0, 2.0, 100));
        assert_eq!(Errors::of(std::iter::empty()), Errors::default());
        assert_eq!(Errors::of([[3.0; 3]].into_iter()).p99, 3.0);
    }

    #[test]
    fn silhouettes_are_apart_and_infinities_are_large() {
        let plane = |x: [f64; 2]| Plane {
            width: 2,
            height: 1,
            data: x.map(|v| [v; 3]).to_vec(),
        };
        let (test, truth) = (plane([1.0, f64::INFINITY]), plane([0.5, f64::INFINITY]));
        let mask = Plane {
            width: 2,
            height: 1,
            data: vec![false, true],
        };
        let of = |truth| Accuracy::of(&test, truth, &mask, &mask).expect("small pictures");
        let a = of(&truth);
        assert_eq!((a.interior.max, a.silhouette.max), (0.5, 0.0));
        let far = of(&plane([0.5, 0.0]));
        assert!(far.flip > a.flip && a.flip > 0.0);
        assert_eq!(far.silhouette.max, LIMIT);
    }
}
