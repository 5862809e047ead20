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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
        }
    }
}

impl std::error::Error for CompareError {}

#[cfg(test)]
mod tests {
    use super::*;

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
