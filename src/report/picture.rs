//! Pictures as they are shown: 8 bits, sRGB to the viewer, with the scale of their colours where they are maps.

use rastray_compare::{Map, Scale};

use crate::error::Error;
use crate::frame::Plane;

use super::files::View;
use super::formats::{check_plane, view_byte};

/// A picture to look at: row-major, top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Red, green, blue of each pixel.
    pub pixels: Vec<[u8; 3]>,
    /// What the colours mean, where they are false colours.
    pub scale: Option<Scale>,
}

impl Picture {
    /// A linear picture clamped and rounded to 8 bits as PNG files hold it.
    pub fn from_linear(plane: &Plane<[f32; 3]>, view: View) -> Result<Self, Error> {
        check_plane(plane)?;
        Ok(Self {
            width: plane.width,
            height: plane.height,
            pixels: plane
                .data
                .iter()
                .map(|p| p.map(|x| view_byte(x, view)))
                .collect(),
            scale: None,
        })
    }

    /// A difference map with its scale.
    pub fn from_map(map: &Map) -> Self {
        Self {
            width: map.width,
            height: map.height,
            pixels: map.pixels.clone(),
            scale: Some(map.scale),
        }
    }

    /// Each pixel repeated `factor` times in both directions.
    pub fn enlarged(&self, factor: usize) -> Self {
        let factor = factor.max(1);
        let (width, height) = (self.width * factor, self.height * factor);
        let at = |i: usize| self.pixels[i / width / factor * self.width + i % width / factor];
        let pixels = (0..width * height).map(at).collect();
        Self {
            width,
            height,
            pixels,
            scale: self.scale,
        }
    }

    /// The mean of each block of `factor` x `factor` stored values, rounded; what does not fill a block is dropped.
    ///
    /// Small enough pictures, and factor 1, come back as they are.
    pub fn reduced(&self, factor: usize) -> Self {
        let (width, height) = (self.width / factor.max(1), self.height / factor.max(1));
        if factor <= 1 || width == 0 || height == 0 {
            return self.clone();
        }
        let block = |x: usize, y: usize| -> [u8; 3] {
            let mut sum = [0usize; 3];
            for row in y * factor..(y + 1) * factor {
                let start = row * self.width + x * factor;
                for pixel in &self.pixels[start..start + factor] {
                    for (s, &v) in sum.iter_mut().zip(pixel) {
                        *s += usize::from(v);
                    }
                }
            }
            let count = factor * factor;
            sum.map(|s| ((2 * s + count) / (2 * count)) as u8)
        };
        let pixels = (0..width * height)
            .map(|i| block(i % width, i / width))
            .collect();
        Self {
            width,
            height,
            pixels,
            scale: self.scale,
        }
    }

    /// Enlarged or reduced by a whole factor so that the width comes near to `width`: for overviews, never for maps.
    pub fn near_width(&self, width: usize) -> Self {
        if self.width <= width {
            self.enlarged((width / self.width.max(1)).max(1))
        } else {
            self.reduced(self.width.div_ceil(width.max(1)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Picture {
        let pixels = (0..6u8).map(|i| [i, 10 * i, 255 - i]).collect();
        Picture {
            width: 3,
            height: 2,
            pixels,
            scale: None,
        }
    }

    #[test]
    fn enlarging_and_reducing_by_the_same_factor_changes_nothing() {
        for factor in [1, 2, 5] {
            assert_eq!(picture().enlarged(factor).reduced(factor), picture());
        }
        let twice = picture().enlarged(2);
        assert_eq!((twice.width, twice.height), (6, 4));
        assert_eq!(twice.pixels[6 * 3 + 5], [5, 50, 250]);
    }

    #[test]
    fn reducing_takes_means() {
        let small = picture().reduced(2); // of pixels 0, 1, 3, 4: means 2, 20, 253
        assert_eq!(
            (small.width, small.height, small.pixels[0]),
            (1, 1, [2, 20, 253])
        );
        assert_eq!(picture().reduced(3), picture());
    }

    #[test]
    fn overviews_come_near_the_asked_width() {
        assert_eq!(picture().near_width(10).width, 9);
        assert_eq!(picture().enlarged(100).near_width(100).width, 100);
        assert_eq!(picture().enlarged(2).near_width(2).width, 2);
        assert_eq!(picture().near_width(0), picture());
    }
}
