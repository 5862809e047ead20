//! Pictures: pixel planes, the frame that a renderer fills, and the layers of the equation.
//!
//! Row 0 is the top row. Colours are linear and unclamped until somebody clamps them by name. `R` is the precision of
//! the render; files hold f32.

use crate::lanes::Real;

/// A rectangle of values, row-major, top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane<T> {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// `width * height` values.
    pub data: Vec<T>,
}

impl<T: Clone> Plane<T> {
    /// A plane filled with one value.
    pub fn filled(width: usize, height: usize, value: T) -> Self {
        Self {
            width,
            height,
            data: vec![value; width * height],
        }
    }
}

impl<T> Plane<T> {
    /// The value of a pixel, counted from the top-left.
    pub fn at(&self, x: usize, y: usize) -> &T {
        &self.data[y * self.width + x]
    }

    /// The same rectangle with every value mapped.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Plane<U> {
        Plane {
            width: self.width,
            height: self.height,
            data: self.data.iter().map(f).collect(),
        }
    }
}

/// No triangle, no object: the pixel shows the background.
pub const NONE: u32 = u32::MAX;

/// What a renderer leaves: one value a pixel in each plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame<R> {
    /// Linear colour. Clamped only where the render options asked for GL's clamp.
    pub color: Plane<[R; 3]>,
    /// Distance from the eye along -z of what is seen at the first sample; +infinity where nothing is.
    pub depth: Plane<R>,
    /// Number of the primitive seen at the first sample, in file order; [`NONE`] where nothing is.
    pub primitive: Plane<u32>,
    /// Number of the object seen at the first sample; [`NONE`] where nothing is.
    pub object: Plane<u32>,
    /// The terms of the equation, if they were asked for.
    pub layers: Option<Layers<R>>,
}

impl<R: Real> Frame<R> {
    /// A frame that shows nothing.
    pub fn empty(width: usize, height: usize) -> Self {
        Self {
            color: Plane::filled(width, height, [R::ZERO; 3]),
            depth: Plane::filled(width, height, R::INFINITY),
            primitive: Plane::filled(width, height, NONE),
            object: Plane::filled(width, height, NONE),
            layers: None,
        }
    }

    /// The colours as a file holds them: f32.
    pub fn color_f32(&self) -> Plane<[f32; 3]> {
        self.color.map(|c| c.map(Real::to_f32))
    }
}

/// The layers of a picture, in the one stated order of their sum: emission (the background where nothing is hit),
/// scene ambient, then per light ambient, diffuse, specular, then reflection, refraction, remainder.
///
/// Summing them in this order, starting from +0, gives the unclamped picture bit for bit: with additions in `R` where
/// every colour of the scene is non-negative, in f64 rounded once where some are negative (`signed`).
/// The remainder is +0 for one sample and per-fragment lighting.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers<R> {
    /// Names in order: `emission`, `ambient`, then for each light `ambient.NAME`, `diffuse.NAME`, `specular.NAME`,
    /// then `reflection`, `refraction`, `remainder`.
    pub names: Vec<String>,
    /// One plane a name.
    pub planes: Vec<Plane<[R; 3]>>,
    /// Some colour of the scene is negative: the sum runs in f64.
    pub signed: bool,
}

/// Positions of the layers for a number of lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerIndex {
    /// How many lights the scene has, disabled ones not counted.
    pub lights: usize,
}

impl LayerIndex {
    /// Emission, and the background where nothing is hit.
    pub const EMISSION: usize = 0;
    /// Scene ambient times material ambient.
    pub const AMBIENT: usize = 1;
    /// Ambient of one light; diffuse is the next layer, specular the one after.
    pub fn light(self, light: usize) -> usize {
        2 + 3 * light
    }
    /// What the primary hits' own terms take: emission to the last light's specular.
    pub fn local(self) -> usize {
        2 + 3 * self.lights
    }
    /// What arrives by the first mirror bounce.
    pub fn reflection(self) -> usize {
        self.local()
    }
    /// What arrives by the first transmission.
    pub fn refraction(self) -> usize {
        self.local() + 1
    }
    /// Picture minus the sum of the other layers: rounding of Gouraud interpolation and of the mean over samples.
    pub fn remainder(self) -> usize {
        self.local() + 2
    }
    /// How many layers there are.
    pub fn count(self) -> usize {
        self.local() + 3
    }
}

impl<R: Real> Layers<R> {
    /// Layers of +0 for a scene with these lights.
    pub fn zero(light_names: &[String], width: usize, height: usize, signed: bool) -> Self {
        let mut names = vec!["emission".to_owned(), "ambient".to_owned()];
        for light in light_names {
            for term in ["ambient", "diffuse", "specular"] {
                names.push(format!("{term}.{light}"));
            }
        }
        names.extend(["reflection", "refraction", "remainder"].map(String::from));
        let planes = names
            .iter()
            .map(|_| Plane::filled(width, height, [R::ZERO; 3]))
            .collect();
        Self {
            names,
            planes,
            signed,
        }
    }

    /// The layers as files hold them.
    pub fn to_f32(&self) -> Layers<f32> {
        let planes = self
            .planes
            .iter()
            .map(|plane| plane.map(|c| c.map(Real::to_f32)))
            .collect();
        Layers {
            names: self.names.clone(),
            planes,
            signed: self.signed,
        }
    }

    /// The sum of one pixel's layers in the stated order.
    pub fn sum(&self, pixel: usize) -> [R; 3] {
        let values = self.planes.iter().map(|plane| plane.data[pixel]);
        sum_in_order(values, self.signed)
    }
}

/// Sums colours in the given order from +0: in `R`, or in f64 rounded once where `signed`.
pub fn sum_in_order<R: Real>(values: impl Iterator<Item = [R; 3]>, signed: bool) -> [R; 3] {
    if signed {
        let mut sum = [0.0f64; 3];
        for v in values {
            for (s, x) in sum.iter_mut().zip(v) {
                *s += x.to_f64();
            }
        }
        sum.map(R::from_f64)
    } else {
        let mut sum = [R::ZERO; 3];
        for v in values {
            for (s, x) in sum.iter_mut().zip(v) {
                *s += x;
            }
        }
        sum
    }
}

/// What has to be added, last, to `sum` so that the result is `picture` bit for bit.
///
/// The plain difference is exact where the two are within a factor of 2 (Sterbenz), as rounding leaves sums of
/// non-negative terms. Where terms of both signs cancel to less than their rounding, a neighbouring number is tried; if
/// the picture is finer than any sum with `sum` can be, the nearest is returned.
pub fn remainder<R: Real>(picture: R, sum: R) -> R {
    let guess = picture - sum;
    if sum + guess == picture {
        return guess;
    }
    let (mut up, mut down) = (guess, guess);
    for _ in 0..4 {
        up = up.next_up();
        down = down.next_down();
        if sum + up == picture {
            return up;
        }
        if sum + down == picture {
            return down;
        }
    }
    guess
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_in_the_stated_order() {
        let layers = Layers::<f32>::zero(&["key".into(), "fill".into()], 1, 1, false);
        let index = LayerIndex { lights: 2 };
        assert_eq!(layers.names[index.light(1) + 1], "diffuse.fill");
        assert_eq!(layers.names[index.reflection()], "reflection");
        assert_eq!(layers.names[index.remainder()], "remainder");
        assert_eq!(layers.names.len(), index.count());
    }

    #[test]
    fn signed_sums_survive_cancellation() {
        let values = [[1e8f32; 3], [1.0; 3], [-1e8; 3]];
        assert_eq!(sum_in_order(values.into_iter(), true), [1.0; 3]);
        assert_eq!(sum_in_order(values.into_iter(), false), [0.0; 3]);
    }

    #[test]
    fn remainder_closes_the_sum() {
        for (picture, sum) in [
            (0.3f32, 0.299_999_95f32),
            (1e-10, 1.9e-10),
            (1.0, 1.000_000_1),
            (5.0, 0.0),
        ] {
            assert_eq!(sum + remainder(picture, sum), picture);
        }
    }
}
