//! Pictures: pixel planes, the frame that a renderer fills, and the layers of the equation.
//!
//! Row 0 is the top row. Colours are linear and unclamped until somebody clamps them by name. `R` is the precision of
//! the render; files hold f32.

use crate::error::Error;
use crate::lanes::Real;

/// The most pixels that the layers of one picture may have together: 3 GiB in f32.
pub const MAX_LAYER_PIXELS: u64 = 1 << 28;

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

    /// Whether some colour is not a number. None may leave a renderer; infinities are legal where an attenuation is 0.
    pub fn has_nan(&self) -> bool {
        self.color
            .data
            .iter()
            .flatten()
            .any(|x| x.to_f64().is_nan())
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
    /// Reflection and refraction once more, split by what lit them: for each of the two one plane a light, then one of what
    /// no light made (emission, scene ambient, background), at [`LayerIndex::split`]. Not further summands: they add up to
    /// the two layers within rounding. Empty unless asked for ([`crate::trace::Plan::draw_split`]).
    pub splits: Vec<Plane<[R; 3]>>,
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
    /// The part of reflection (`branch` 0) or refraction (1) that a light made; `self.lights` = what none made.
    pub fn split(self, branch: usize, light: usize) -> usize {
        branch * (self.lights + 1) + light
    }
    /// How many parts there are.
    pub fn splits(self) -> usize {
        2 * (self.lights + 1)
    }
    /// Whether layers and parts together stay within [`MAX_LAYER_PIXELS`].
    pub fn splits_fit(self, width: u32, height: u32) -> bool {
        let pixels = u64::from(width) * u64::from(height);
        let planes = (self.count() + self.splits()) as u64;
        planes.saturating_mul(pixels) <= MAX_LAYER_PIXELS
    }
    /// Which light a local layer belongs to; `self.lights` = none.
    pub fn light_of(self, layer: usize) -> usize {
        if layer < self.light(0) {
            self.lights
        } else {
            (layer - self.light(0)) / 3
        }
    }

    /// Refuses layers that would fill the memory.
    ///
    /// # Errors
    /// [`Error::Limit`] beyond [`MAX_LAYER_PIXELS`].
    pub fn check_size(self, width: u32, height: u32) -> Result<(), Error> {
        let pixels = u64::from(width) * u64::from(height);
        if (self.count() as u64).saturating_mul(pixels) <= MAX_LAYER_PIXELS {
            return Ok(());
        }
        Err(Error::limit(format!(
            "{} lights make {} layers of {width}x{height} pixels, more than {MAX_LAYER_PIXELS} pixels together",
            self.lights,
            self.count()
        ))
        .with_help("draw it smaller, with --size, or disable lights"))
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
            splits: Vec::new(),
        }
    }

    /// The layers as files hold them.
    pub fn to_f32(&self) -> Layers<f32> {
        self.convert(Real::to_f32)
    }

    /// The layers in f64, exact.
    pub fn to_f64(&self) -> Layers<f64> {
        self.convert(Real::to_f64)
    }

    fn convert<T>(&self, number: impl Fn(R) -> T) -> Layers<T> {
        let convert = |planes: &[Plane<[R; 3]>]| {
            let planes = planes.iter();
            planes.map(|plane| plane.map(|c| c.map(&number))).collect()
        };
        Layers {
            names: self.names.clone(),
            planes: convert(&self.planes),
            signed: self.signed,
            splits: convert(&self.splits),
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

/// The remainder layer of a pixel: added last, it makes the sum of `layers` in their order the picture, bit for bit.
///
/// The sum is [`sum_in_order`]'s. +0 where the layers alone give the picture; else the difference rounded to `R`, or a
/// neighbour of it. One of them closes the sum wherever the picture is not far smaller than the difference, as rounding
/// leaves it. Where terms of both signs cancel to a picture finer than any `R` can make of their sum, the sum stays off
/// by at most the rounding of the difference. Never NaN.
pub fn remainder<R: Real>(
    picture: [R; 3],
    layers: impl Iterator<Item = [R; 3]>,
    signed: bool,
) -> [R; 3] {
    let sum = if signed {
        sum_in_order(layers.map(|layer| layer.map(Real::to_f64)), true)
    } else {
        sum_in_order(layers, false).map(Real::to_f64)
    };
    [0, 1, 2].map(|c| difference(picture[c], sum[c]))
}

/// One component of [`remainder`].
fn difference<R: Real>(picture: R, sum: f64) -> R {
    // A sum of two f32 in f64, rounded, is their f32 sum (53 >= 2 x 24 + 2), so this is the last addition in `R`, too.
    let closes = |x: R| R::from_f64(sum + x.to_f64()) == picture;
    if closes(R::ZERO) {
        return R::ZERO;
    }
    let guess = R::from_f64(picture.to_f64() - sum);
    let (mut up, mut down) = (guess, guess);
    for _ in 0..4 {
        if let Some(found) = [up, down].into_iter().find(|x| closes(*x)) {
            return found;
        }
        (up, down) = (up.next_up(), down.next_down());
    }
    if guess.is_finite() { guess } else { R::ZERO }
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
        let lights: Vec<usize> = (0..index.local()).map(|k| index.light_of(k)).collect();
        assert_eq!(lights, [2, 2, 0, 0, 0, 1, 1, 1]);
        assert_eq!(index.split(1, index.lights) + 1, index.splits());
    }

    #[test]
    fn layers_have_a_limit() {
        assert!(LayerIndex { lights: 10 }.check_size(1920, 1080).is_ok());
        // 9 layers of 2^25 pixels are more than 2^28, 8 would not be.
        let error = LayerIndex { lights: 2 }.check_size(1 << 13, 1 << 12);
        assert!(matches!(error, Err(Error::Limit { .. })));
        let lights = u32::MAX as usize;
        assert!(
            LayerIndex { lights }
                .check_size(u32::MAX, u32::MAX)
                .is_err()
        );
    }

    #[test]
    fn signed_sums_survive_cancellation() {
        let values = [[1e8f32; 3], [1.0; 3], [-1e8; 3]];
        assert_eq!(sum_in_order(values.into_iter(), true), [1.0; 3]);
        assert_eq!(sum_in_order(values.into_iter(), false), [0.0; 3]);
    }

    #[test]
    fn remainder_closes_plain_sums() {
        for (picture, sum) in [
            (0.3f32, 0.299_999_95f32),
            (1e-10, 1.9e-10),
            (1.0, 1.000_000_1),
            (5.0, 0.0),
        ] {
            let layers = [[sum; 3]];
            let rest = remainder([picture; 3], layers.into_iter(), false);
            assert_eq!(sum + rest[0], picture);
        }
        let whole = remainder([0.3f32; 3], [[0.1; 3], [0.2; 3]].into_iter(), false);
        assert_eq!(whole[0].to_bits(), (0.3f32 - (0.1f32 + 0.2)).to_bits());
        assert_eq!(
            remainder([1.0f32; 3], [[1.0; 3]].into_iter(), true),
            [0.0; 3]
        );
    }

    /// Layers of both signs, each rounded once, and the picture rounded from their exact sum: what several samples leave.
    #[test]
    fn remainder_closes_signed_sums() {
        let mut state = 1u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut closed = 0;
        for round in 0..20_000 {
            let mut exact: Vec<f64> = (0..7).map(|_| random()).collect();
            // Every other round the terms cancel to a small part of themselves.
            if round % 2 == 1 {
                let rest: f64 = exact[..6].iter().sum();
                exact[6] = random() * 2f64.powi(-(round % 20)) - rest;
            }
            let picture = [exact.iter().sum::<f64>() as f32; 3];
            let mut layers: Vec<[f32; 3]> = exact.iter().map(|x| [*x as f32; 3]).collect();
            let rest = remainder(picture, layers.iter().copied(), true);
            layers.push(rest);
            let sum = sum_in_order(layers.iter().copied(), true);
            if rest[0].abs() < picture[0].abs() {
                assert_eq!(sum, picture, "round {round}");
            } else {
                let off = (sum[0] - picture[0]).abs();
                assert!(off <= rest[0].abs() * f32::EPSILON, "round {round}: {off}");
            }
            closed += usize::from(sum == picture && rest != [0.0; 3]);
        }
        assert!(closed > 5_000, "only {closed} rounds needed a remainder");
    }

    #[test]
    fn remainder_of_what_cannot_be_closed_is_the_nearest_and_finite() {
        // 1 + 2^-52 as a sum of f32 layers; no f32 takes it to 2^-60.
        let layers = [[1.0f32; 3], [2f32.powi(-52); 3]];
        let rest = remainder([2f32.powi(-60); 3], layers.into_iter(), true);
        assert_eq!(rest, [-1.0; 3]);
        let infinite = [[f32::INFINITY; 3]];
        for picture in [1.0, f32::INFINITY] {
            for signed in [false, true] {
                assert_eq!(
                    remainder([picture; 3], infinite.into_iter(), signed),
                    [0.0; 3]
                );
            }
        }
    }
}
