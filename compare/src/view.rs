//! Borrowed pictures: what every measurement reads, and what can be wrong with it.

use std::fmt;

/// How the stored values relate to light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Proportional to intensity.
    Linear,
    /// Encoded with the sRGB transfer function (IEC 61966-2-1).
    Srgb,
}

impl Encoding {
    /// `linear` or `sRGB`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Srgb => "sRGB",
        }
    }
}

/// A borrowed picture: row-major, top row first, red, green, blue. Every value is finite and there is at least one.
#[derive(Clone, Copy, Debug)]
pub struct ImageView<'a> {
    width: usize,
    height: usize,
    pixels: &'a [[f32; 3]],
    encoding: Encoding,
    /// The stored values are whole multiples of 1/255 or 1/65535, rounded to f32.
    levels: Option<u16>,
}

impl<'a> ImageView<'a> {
    /// A view of `width * height` pixels; refuses a wrong count, an empty picture and numbers that are not finite.
    ///
    /// ```
    /// use rastray_compare::{Encoding, ImageView};
    /// let pixels = [[0.0, 0.5, 1.0]; 6];
    /// let view = ImageView::new(3, 2, &pixels, Encoding::Linear).unwrap();
    /// assert_eq!((view.width(), view.height()), (3, 2));
    /// assert!(ImageView::new(4, 2, &pixels, Encoding::Linear).is_err());
    /// ```
    pub fn new(
        width: usize,
        height: usize,
        pixels: &'a [[f32; 3]],
        encoding: Encoding,
    ) -> Result<Self, CompareError> {
        check_shape(width, height, pixels.len())?;
        if let Some(i) = pixels.iter().position(|p| !p.iter().all(|v| v.is_finite())) {
            let (x, y) = (i % width, i / width);
            return Err(CompareError::NotFinite { x, y });
        }
        Ok(Self {
            width,
            height,
            pixels,
            encoding,
            levels: levels(pixels),
        })
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The pixels, row by row from the top.
    pub fn pixels(&self) -> &'a [[f32; 3]] {
        self.pixels
    }

    /// How the values are encoded.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// What turns a stored value of either picture into the number that it stands for: where both hold whole 255ths or
    /// 65535ths, exactly that fraction, since a difference of one step is not large against the rounding of f32.
    pub(crate) fn values(&self, other: &ImageView) -> [impl Fn(f32) -> f64 + Copy; 2] {
        let both = self.levels.zip(other.levels);
        [both.map(|b| b.0), both.map(|b| b.1)].map(|levels| {
            let levels = levels.map(f64::from);
            move |v: f32| match levels {
                Some(n) => (f64::from(v) * n).round() / n,
                None => f64::from(v),
            }
        })
    }

    /// Refuses a picture of another size or encoding.
    pub(crate) fn check_comparable(&self, other: &ImageView) -> Result<(), CompareError> {
        let (a, b) = ((self.width, self.height), (other.width, other.height));
        if a != b {
            return Err(CompareError::Size {
                test: a,
                reference: b,
            });
        }
        if self.encoding != other.encoding {
            let (test, reference) = (self.encoding, other.encoding);
            return Err(CompareError::Encoding { test, reference });
        }
        Ok(())
    }
}

/// The number of steps between 0 and 1 on which all values lie, of those that files have; none for floats.
fn levels(pixels: &[[f32; 3]]) -> Option<u16> {
    let on_step = |v: f32, n: f64| {
        let step = (f64::from(v) * n).round();
        (0.0..=n).contains(&step) && (step / n) as f32 == v
    };
    let all = |n: &u16| {
        pixels
            .as_flattened()
            .iter()
            .all(|v| on_step(*v, f64::from(*n)))
    };
    [255, 65535].into_iter().find(all)
}

/// .2126 R + .7152 G + .0722 B: luma of stored values, luminance of linear ones (weights of ITU-R BT.709 and sRGB).
pub(crate) fn luma([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Refuses pictures without pixels and pixel counts that do not fit the size.
pub(crate) fn check_shape(width: usize, height: usize, pixels: usize) -> Result<(), CompareError> {
    if width == 0 || height == 0 {
        return Err(CompareError::Empty);
    }
    if width.checked_mul(height) != Some(pixels) {
        return Err(CompareError::PixelCount {
            width,
            height,
            pixels,
        });
    }
    Ok(())
}

/// Why two pictures cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CompareError {
    /// A picture without pixels has no metrics.
    Empty,
    /// The number of pixels is not width times height.
    PixelCount {
        /// Width stated.
        width: usize,
        /// Height stated.
        height: usize,
        /// Pixels given.
        pixels: usize,
    },
    /// The pictures differ in size; nothing is ever resized.
    Size {
        /// Width and height of the picture that is judged.
        test: (usize, usize),
        /// Width and height of the picture that is trusted.
        reference: (usize, usize),
    },
    /// One picture holds linear values, the other sRGB.
    Encoding {
        /// Of the picture that is judged.
        test: Encoding,
        /// Of the picture that is trusted.
        reference: Encoding,
    },
    /// A value is infinite or not a number.
    NotFinite {
        /// Column, from the left.
        x: usize,
        /// Row, from the top.
        y: usize,
    },
    /// FLIP knows nothing of such a screen.
    PixelsPerDegree {
        /// Pixels per degree of visual angle that were asked for.
        ppd: f64,
    },
}

impl fmt::Display for CompareError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "the picture has no pixels"),
            Self::PixelCount {
                width,
                height,
                pixels,
            } => {
                write!(
                    f,
                    "{pixels} pixels given for a picture of {width} x {height}"
                )
            }
            Self::Size { test, reference } => write!(
                f,
                "the pictures differ in size: {} x {} and {} x {}",
                test.0, test.1, reference.0, reference.1
            ),
            Self::Encoding { test, reference } => write!(
                f,
                "one picture holds {} values, the other {} values",
                test.name(),
                reference.name()
            ),
            Self::NotFinite { x, y } => {
                write!(
                    f,
                    "pixel {x} {y} holds a value that is infinite or not a number"
                )
            }
            Self::PixelsPerDegree { ppd } => {
                write!(f, "{ppd} pixels per degree: expected 1 to 1000")
            }
        }
    }
}

impl std::error::Error for CompareError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_files_are_exact() {
        let steps =
            |n: u32| -> Vec<[f32; 3]> { (0..=n).map(|k| [k as f32 / n as f32; 3]).collect() };
        let (eight, sixteen) = (steps(255), steps(65535));
        let mut float = eight.clone();
        float[7][1] = f32::from_bits(float[7][1].to_bits() + 1);
        let view = |p| ImageView::new(1, <[_]>::len(p), p, Encoding::Linear).unwrap();
        let (eight, sixteen, float) = (view(&eight), view(&sixteen), view(&float));
        assert_eq!(
            (eight.levels, sixteen.levels, float.levels),
            (Some(255), Some(65535), None)
        );
        let [a, b] = eight.values(&sixteen);
        for k in 0..=255 {
            let v = eight.pixels()[k][0];
            assert_eq!(
                (a(v), b(sixteen.pixels()[257 * k][0])),
                (k as f64 / 255.0, k as f64 / 255.0)
            );
        }
        // Against floats, values are what they are.
        let [a, _] = eight.values(&float);
        assert_eq!(a(eight.pixels()[7][0]), f64::from(eight.pixels()[7][0]));
    }

    #[test]
    fn a_view_refuses_what_cannot_be_measured() {
        let mut pixels = vec![[0.0f32; 3]; 6];
        let new = |w, h, p: &[[f32; 3]]| ImageView::new(w, h, p, Encoding::Linear).map(|_| ());
        assert_eq!(new(0, 6, &[]), Err(CompareError::Empty));
        assert!(new(usize::MAX, 2, &pixels).is_err());
        pixels[4][2] = f32::NAN;
        assert_eq!(
            new(3, 2, &pixels),
            Err(CompareError::NotFinite { x: 1, y: 1 })
        );
        pixels[4][2] = f32::NEG_INFINITY;
        assert_eq!(
            new(3, 2, &pixels),
            Err(CompareError::NotFinite { x: 1, y: 1 })
        );
    }
}
