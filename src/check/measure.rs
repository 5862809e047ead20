//! Errors between pictures of stored values, and what counts as noise.

use super::Given;
use crate::frame::Plane;
use crate::math::color::{clamp01, linear_from_srgb, quantize8, srgb_from_linear};

/// What rounding, compression and arithmetic may leave between pictures of the same thing.
///
/// Measured: pictures of five shipped scenes at 320x240 through JPEG of qualities 95, 75 and 50 with halved chroma. With
/// red and yellow tiles (`whitted`) rmse 0.033, 0.042, 0.049 and means 0.0032, 0.0041, 0.0057; the other four at most 0.014,
/// 0.019, 0.027 and 0.0021, 0.0031, 0.0045. A light 6 % too bright there has means of 0.012.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Largest rmse.
    pub pixels: f64,
    /// Largest rmse of means of 16 x 16 pixels, which compression keeps.
    pub means: f64,
    /// The noise follows the picture, so that a mistake may seem to remove a little of it.
    pub follows: bool,
}

impl Noise {
    /// Of a file that keeps its values but for rounding, or was made from one that did not.
    pub const LOSSLESS: Self = Self {
        pixels: 0.02,
        means: 0.004,
        follows: false,
    };
    /// Of a file that does not.
    pub const LOSSY: Self = Self {
        pixels: 0.05,
        means: 0.006,
        follows: true,
    };

    /// Of a given file.
    pub(super) fn of(given: &Given) -> Self {
        if given.lossy {
            Self::LOSSY
        } else {
            Self::LOSSLESS
        }
    }

    /// Two pictures differ by no more.
    pub(super) fn hides(&self, a: &Values, b: &Values) -> bool {
        rmse(a, b) <= self.pixels && rmse_of_means(a, b) <= self.means
    }
}
/// Two pictures this near (rmse) are one: half of what 8-bit rounding leaves.
pub const SAME: f64 = 5e-4;
/// A mistake shows where it changes the picture by more (rmse).
pub(super) const SHOWS: f64 = 2e-4;

/// Finite stand-in for values without a bound: lights whose attenuation vanishes.
const MOST: f32 = 1e6;

/// A plane of stored values.
pub(super) type Values = Plane<[f32; 3]>;

/// What happens to linear values on their way into the given file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stored {
    pub(super) eight_bits: bool,
    /// Values are clamped: the file cannot hold others, or does not.
    pub(super) clamp: bool,
    pub(super) srgb: bool,
}

/// What a mistake does to the finished picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Finish {
    /// Nothing.
    #[default]
    Right,
    /// sRGB-encodes what should be stored as it is.
    Encode,
    /// Stores as they are values that should be sRGB-encoded; without `--srgb`, decodes linear ones.
    Decode,
    /// Cuts off what exceeds a step of 8 bits.
    CutOff,
}

impl Stored {
    /// As the given file holds values.
    pub(super) fn of(given: &Given, srgb: bool) -> Self {
        let mut values = given.color.data.iter().flatten();
        Self {
            eight_bits: given.eight_bits,
            clamp: given.eight_bits || values.all(|x| (0.0..=1.0).contains(x)),
            srgb,
        }
    }

    /// A linear picture as the file would hold it.
    pub(super) fn apply(&self, linear: &Values) -> Values {
        self.finish(linear, Finish::Right)
    }

    /// The same with a mistake on the way.
    pub(super) fn finish(&self, linear: &Values, finish: Finish) -> Values {
        linear.map(|c| c.map(|x| self.value(x, finish)))
    }

    fn value(&self, x: f32, finish: Finish) -> f32 {
        let mut x = if self.clamp {
            clamp01(x)
        } else {
            x.clamp(-MOST, MOST)
        };
        let curve = |x: f32, f: fn(f64) -> f64| (f(f64::from(x.abs())) as f32).copysign(x);
        let encodes = match finish {
            Finish::Encode => true,
            Finish::Decode => false,
            _ => self.srgb,
        };
        if encodes {
            x = curve(x, srgb_from_linear);
        } else if finish == Finish::Decode && !self.srgb {
            x = curve(x, linear_from_srgb);
        }
        match (self.eight_bits, finish) {
            (true, Finish::CutOff) => (x * 255.0).floor() / 255.0,
            (true, _) => f32::from(quantize8(x)) / 255.0,
            (false, _) => x,
        }
    }
}

/// How a finished picture is turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    /// The bottom row comes first.
    Rows,
    /// Left and right change places.
    Columns,
}

impl Turn {
    /// The picture turned; twice is none.
    pub(super) fn of(self, picture: &Values) -> Values {
        let (width, height) = (picture.width, picture.height);
        let from = |i: usize| match self {
            Self::Rows => (height - 1 - i / width) * width + i % width,
            Self::Columns => i / width * width + (width - 1 - i % width),
        };
        Plane {
            width,
            height,
            data: (0..width * height).map(|i| picture.data[from(i)]).collect(),
        }
    }
}

/// The smallest odd number whose square leaves at most `most` of so many pixels.
pub(super) fn odd_step(pixels: usize, most: usize) -> usize {
    (1..)
        .step_by(2)
        .find(|k| pixels <= most * k * k)
        .unwrap_or(1)
}

/// The middle pixel of each block of `step` x `step` (odd): the centres of a picture with larger pixels.
pub(super) fn every(picture: &Values, step: usize) -> Values {
    if step == 1 {
        return picture.clone();
    }
    let (width, height) = (
        (picture.width / step).max(1),
        (picture.height / step).max(1),
    );
    let place = |x: usize, size: usize| (x * step + step / 2).min(size - 1);
    let pixel = |i: usize| {
        *picture.at(
            place(i % width, picture.width),
            place(i / width, picture.height),
        )
    };
    Plane {
        width,
        height,
        data: (0..width * height).map(pixel).collect(),
    }
}

/// Mean squared difference over all pixels and channels.
pub(super) fn mse(a: &Values, b: &Values) -> f64 {
    let pairs = a.data.iter().flatten().zip(b.data.iter().flatten());
    let errors = pairs.map(|(a, b)| f64::from(*a) - f64::from(*b));
    rastray_compare::mse(std::iter::once(errors))
}

/// Its root.
pub(super) fn rmse(a: &Values, b: &Values) -> f64 {
    mse(a, b).sqrt()
}

/// [`rmse`] of the means of blocks of 16 x 16 pixels (smaller at the right and lower rim), each weighing as its pixels.
pub(super) fn rmse_of_means(a: &Values, b: &Values) -> f64 {
    const SIDE: usize = 16;
    let (width, height) = (a.width, a.height);
    let mut sum = 0.0;
    for top in (0..height).step_by(SIDE) {
        for left in (0..width).step_by(SIDE) {
            let mut difference = [0.0f64; 3];
            let (bottom, right) = ((top + SIDE).min(height), (left + SIDE).min(width));
            for y in top..bottom {
                for x in left..right {
                    let (p, q) = (a.at(x, y), b.at(x, y));
                    for (d, (p, q)) in difference.iter_mut().zip(p.iter().zip(q)) {
                        *d += f64::from(*p) - f64::from(*q);
                    }
                }
            }
            let count = ((bottom - top) * (right - left)) as f64;
            sum += difference.iter().map(|d| d * d).sum::<f64>() / count;
        }
    }
    (sum / (3 * a.data.len()).max(1) as f64).sqrt()
}

/// How sure it is that `a` is nearer to a picture than `b`, in standard deviations: the sum over blocks of 8 x 8 pixels of
/// the squares that it saves, against what such sums come to by chance.
pub(super) fn surely_nearer(given: &Values, a: &Values, b: &Values) -> f64 {
    let (width, height) = (given.width, given.height);
    let mut blocks = vec![0.0f64; width.div_ceil(8) * height.div_ceil(8)];
    let square = |p: &[f32; 3], q: &[f32; 3]| -> f64 {
        (0..3).map(|c| f64::from(p[c] - q[c]).powi(2)).sum()
    };
    for (i, g) in given.data.iter().enumerate() {
        let block = i / width / 8 * width.div_ceil(8) + i % width / 8;
        blocks[block] += square(g, &b.data[i]) - square(g, &a.data[i]);
    }
    let chance = blocks.iter().map(|s| s * s).sum::<f64>().sqrt();
    blocks.iter().sum::<f64>() / chance.max(f64::MIN_POSITIVE)
}

/// What tells `a` from `b` is larger than what tells a picture from `a`, where `a` and `b` differ: both squared, each pixel
/// weighing as the square of that difference.
pub(super) fn stands_out(given: &Values, a: &Values, b: &Values) -> bool {
    let square = |p: &[f32; 3], q: &[f32; 3]| -> f64 {
        (0..3).map(|c| f64::from(p[c] - q[c]).powi(2)).sum()
    };
    let (mut change, mut noise) = (0.0, 0.0);
    for ((g, p), q) in given.data.iter().zip(&a.data).zip(&b.data) {
        let weight = square(p, q);
        change += weight * weight;
        noise += weight * square(g, p);
    }
    change > noise
}

/// Largest difference of two values.
pub(super) fn largest(a: &Values, b: &Values) -> f64 {
    let pairs = a.data.iter().flatten().zip(b.data.iter().flatten());
    pairs
        .map(|(a, b)| f64::from((a - b).abs()))
        .fold(0.0, f64::max)
}

/// Standard deviation of all values.
pub(super) fn contrast(a: &Values) -> f64 {
    let count = (3 * a.data.len()).max(1) as f64;
    let values = || a.data.iter().flatten().map(|x| f64::from(*x));
    let mean = values().sum::<f64>() / count;
    (values().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(width: usize, height: usize) -> Values {
        let value = |i: usize| [i as f32 / 100.0, 0.5, 1.0 - i as f32 / 100.0];
        Plane {
            width,
            height,
            data: (0..width * height).map(value).collect(),
        }
    }

    #[test]
    fn every_third_pixel_is_a_centre() {
        let small = every(&ramp(9, 7), 3);
        assert_eq!((small.width, small.height), (3, 2));
        assert_eq!(small.data[0][0], 0.1); // pixel (1, 1)
        assert_eq!(small.at(2, 1)[0], 0.43); // pixel (7, 4)
        assert_eq!(odd_step(20_000, 20_000), 1);
        assert_eq!(odd_step(20_001, 20_000), 3);
        assert_eq!(odd_step(640 * 480, 20_000), 5);
    }

    #[test]
    fn means_forget_what_cancels() {
        let plain = Plane::filled(20, 20, [0.5f32; 3]);
        let mut noisy = plain.clone();
        for (i, c) in noisy.data.iter_mut().enumerate() {
            let up = (i + i / 20) % 2 == 0;
            *c = c.map(|x| if up { x + 0.01 } else { x - 0.01 });
        }
        assert!((rmse(&plain, &noisy) - 0.01).abs() < 1e-7);
        assert!(rmse_of_means(&plain, &noisy) < 1e-7);
        assert!(Noise::LOSSLESS.hides(&plain, &noisy));
        let lighter = plain.map(|c| c.map(|x| x + 0.01));
        assert!((rmse_of_means(&plain, &lighter) - 0.01).abs() < 1e-7);
        assert!(!Noise::LOSSLESS.hides(&plain, &lighter));
    }

    #[test]
    fn a_change_stands_out_from_noise_that_is_smaller_where_it_is_made() {
        let plain = Plane::filled(16, 16, [0.5f32; 3]);
        let spotted = |by: f32| {
            let mut picture = plain.clone();
            picture.data[..16].fill([0.5 + by; 3]);
            picture
        };
        let mut given = spotted(0.2);
        for (i, c) in given.data.iter_mut().enumerate() {
            *c = c.map(|x| if i % 2 == 0 { x + 0.1 } else { x - 0.1 });
        }
        assert!(stands_out(&given, &spotted(0.2), &plain));
        let faint = plain.map(|c| c.map(|x| x + 0.01));
        assert!(!stands_out(&given, &faint, &plain));
        assert!(!stands_out(&given, &plain, &plain));
    }

    #[test]
    fn turns_undo_themselves() {
        let picture = ramp(5, 3);
        for turn in [Turn::Rows, Turn::Columns] {
            assert_ne!(turn.of(&picture), picture);
            assert_eq!(turn.of(&turn.of(&picture)), picture);
        }
        assert_eq!(Turn::Rows.of(&picture).data[0], picture.data[10]);
        assert_eq!(Turn::Columns.of(&picture).data[0], picture.data[4]);
    }

    #[test]
    fn finishes_are_what_they_say() {
        let value = |stored: Stored, x, finish| stored.value(x, finish);
        let png = Stored {
            eight_bits: true,
            clamp: true,
            srgb: false,
        };
        assert_eq!(value(png, 2.0, Finish::Right), 1.0);
        assert_eq!(value(png, 0.5, Finish::Right), 128.0 / 255.0);
        assert_eq!(value(png, 0.5, Finish::CutOff), 127.0 / 255.0);
        assert_eq!(value(png, 0.5, Finish::Encode), 188.0 / 255.0);
        let srgb = Stored { srgb: true, ..png };
        assert_eq!(value(srgb, 0.5, Finish::Right), 188.0 / 255.0);
        assert_eq!(value(srgb, 0.5, Finish::Decode), 128.0 / 255.0);
        let float = Stored {
            eight_bits: false,
            clamp: false,
            srgb: false,
        };
        assert_eq!(value(float, 2.0, Finish::Right), 2.0);
        assert!((value(float, 0.5, Finish::Decode) - 0.21404).abs() < 1e-5);
    }
}
