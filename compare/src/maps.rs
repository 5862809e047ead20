//! Difference maps: one false colour a pixel, with the scale that gave it.
//!
//! A pixel has three differences and a map one colour, so something must be chosen: see [`Reduction`]. The default,
//! [`Reduction::Largest`], is the only one under which a pixel is coloured as "no difference" exactly when it has none.

use crate::metrics::check_finite;
use crate::scale::{Scale, ScaleKind};
use crate::view::luma;
use crate::{CompareError, FlipMap, StepSummary, summarize};

/// How the three channel differences of a pixel become one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reduction {
    /// The difference of largest magnitude, with its sign (the first such channel wins). Hides nothing; a pixel that
    /// is redder and darker shows only the stronger of the two.
    #[default]
    Largest,
    /// The mean of the three. A change of hue at equal sum shows as no difference.
    Mean,
    /// .2126 R + .7152 G + .0722 B: change of luma. A change in blue hardly shows.
    Luma,
}

impl Reduction {
    /// One number for three differences.
    pub fn apply(self, d: [f64; 3]) -> f64 {
        match self {
            Self::Largest => d[1..]
                .iter()
                .fold(d[0], |m, &v| if v.abs() > m.abs() { v } else { m }),
            Self::Mean => (d[0] + d[1] + d[2]) / 3.0,
            Self::Luma => luma(d),
        }
    }
}

/// A false-colour picture: RGB8 to be shown as sRGB, row-major, top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// One colour a pixel.
    pub pixels: Vec<[u8; 3]>,
    /// What the colours mean.
    pub scale: Scale,
    /// The numbers of the same differences.
    pub summary: StepSummary,
}

/// Blue where the difference is negative, white where there is none, orange where it is positive.
///
/// ```
/// use rastray_compare::{Reduction, signed_map};
/// let map = signed_map(2, 1, &[[0.0; 3], [0.1, 0.3, 0.0]], Reduction::Largest).unwrap();
/// assert_eq!(map.pixels[0], [255, 255, 255]);
/// assert_eq!(map.scale.max, 0.5);
/// ```
pub fn signed_map(
    width: usize,
    height: usize,
    differences: &[[f64; 3]],
    reduction: Reduction,
) -> Result<Map, CompareError> {
    map(width, height, differences, ScaleKind::Signed, |d| {
        reduction.apply(d)
    })
}

/// Magma: the magnitude of the difference, black where there is none.
///
/// The reduction is applied to the absolute differences, so that opposite signs cannot cancel.
pub fn magnitude_map(
    width: usize,
    height: usize,
    differences: &[[f64; 3]],
    reduction: Reduction,
) -> Result<Map, CompareError> {
    map(width, height, differences, ScaleKind::Magnitude, |d| {
        reduction.apply(d.map(f64::abs))
    })
}

/// Magma from 0 to 1, the same scale for every pair of pictures: how FLIP is shown by its authors.
///
/// The summary is that of the FLIP values, one a pixel.
pub fn flip_map(errors: &FlipMap) -> Result<Map, CompareError> {
    let scale = Scale {
        kind: ScaleKind::Magnitude,
        max: 1.0,
    };
    let values: Vec<f64> = errors.values.iter().copied().map(f64::from).collect();
    let (width, height) = (errors.width, errors.height);
    let alike: Vec<[f64; 3]> = values.iter().map(|v| [*v; 3]).collect();
    Ok(Map {
        width,
        height,
        pixels: values.iter().map(|v| scale.color(*v)).collect(),
        scale,
        summary: summarize(width, height, &alike)?,
    })
}

/// Reduces every pixel, fits the scale to the largest result and colours.
fn map(
    width: usize,
    height: usize,
    differences: &[[f64; 3]],
    kind: ScaleKind,
    reduce: impl Fn([f64; 3]) -> f64,
) -> Result<Map, CompareError> {
    check_finite(width, height, differences)?;
    let values: Vec<f64> = differences.iter().map(|&d| reduce(d)).collect();
    let largest = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let scale = Scale::fitting(kind, largest);
    let pixels = values.iter().map(|&v| scale.color(v)).collect();
    Ok(Map {
        width,
        height,
        pixels,
        scale,
        summary: summarize(width, height, differences)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reductions_are_what_they_say() {
        let d = [0.25, -0.5, 0.5];
        assert_eq!(Reduction::Largest.apply(d), -0.5);
        assert_eq!(Reduction::Mean.apply(d), 0.25 / 3.0);
        assert_eq!(Reduction::Luma.apply([1.0, 0.0, 0.0]), 0.2126);
        assert!((Reduction::Luma.apply([1.0; 3]) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_map_is_white_exactly_where_nothing_differs() {
        let d = [
            [0.0; 3],
            [0.0, 0.0, -1e-9],
            [1.0, 0.0, 0.0],
            [0.1, -0.1, 0.0],
        ];
        let map = signed_map(2, 2, &d, Reduction::Largest).unwrap();
        let white: Vec<bool> = map.pixels.iter().map(|p| *p == [255; 3]).collect();
        assert_eq!(white, [true, false, false, false]);
        assert_eq!(map.pixels[2], map.scale.color(1.0));
        // The mean cannot see the last pixel: its changes cancel.
        assert_eq!(
            signed_map(2, 2, &d, Reduction::Mean).unwrap().pixels[3],
            [255; 3]
        );
        // As magnitudes they do not cancel.
        let magnitude = magnitude_map(2, 2, &d, Reduction::Mean).unwrap();
        assert_ne!(magnitude.pixels[3], magnitude.pixels[0]);
    }

    #[test]
    fn no_difference_at_all_is_a_plain_map() {
        let map = signed_map(3, 1, &[[0.0; 3]; 3], Reduction::Largest).unwrap();
        assert!(map.pixels.iter().all(|p| *p == [255; 3]));
        assert_eq!((map.scale.max, map.summary.pixels), (1.0, 0));
        assert!(signed_map(3, 1, &[[f64::INFINITY; 3]; 3], Reduction::Largest).is_err());
    }
}
