//! What a tile's rays add up to: one sample of every pixel, then the mean over samples, with or without layers.
//!
//! Sums (DESIGN 1 "Colour"): a secondary hit adds weight x term, in the order of the layers, to the layer of its first
//! bounce; a miss adds weight x background. In `R`, or in f64 rounded once where some colour is negative (`signed`). The
//! picture is the sum of the layers in their order; single terms are kept only where somebody needs them.

use super::tile::TileFrame;
use crate::frame::{LayerIndex, remainder, sum_in_order};
use crate::lanes::Real;
use crate::math::Each;
use crate::sampling;

/// What is kept beside the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keep {
    /// Nothing.
    Color,
    /// The layers.
    Layers,
    /// The layers, and reflection and refraction split by light.
    Split,
}

/// The sums of one sample of every pixel.
pub(super) struct Sums<R> {
    /// Local light, added up: used where no single terms are kept.
    pub(super) local: Vec<[R; 3]>,
    /// Local light term by term: used otherwise.
    pub(super) terms: Vec<Vec<[R; 3]>>,
    /// Reflection and refraction. Values of `R`, or of f64 where colours are signed.
    bounced: [Vec<[f64; 3]>; 2],
    /// The same split by light, where asked for.
    splits: Vec<Vec<[f64; 3]>>,
    /// Secondary rays of each pixel.
    pub(super) rays: Vec<u32>,
    signed: bool,
}

impl<R: Real> Sums<R> {
    /// Nothing yet. Single terms are kept for layers, and where signed colours make their order of rounding matter.
    pub(super) fn new(pixels: usize, index: LayerIndex, keep: Keep, signed: bool) -> Self {
        let layers = keep != Keep::Color;
        let splits = if keep == Keep::Split {
            index.splits()
        } else {
            0
        };
        let terms = if layers || signed { index.local() } else { 0 };
        let black = || vec![[R::ZERO; 3]; pixels];
        Self {
            local: black(),
            terms: (0..terms).map(|_| black()).collect(),
            bounced: [vec![[0.0; 3]; pixels], vec![[0.0; 3]; pixels]],
            splits: vec![vec![[0.0; 3]; pixels]; splits],
            rays: vec![0; pixels],
            signed,
        }
    }

    /// Whether single terms are kept.
    pub(super) fn recording(&self) -> bool {
        !self.terms.is_empty()
    }

    /// Back to +0.
    pub(super) fn clear(&mut self) {
        self.local.fill([R::ZERO; 3]);
        for term in &mut self.terms {
            term.fill([R::ZERO; 3]);
        }
        for bounced in self.bounced.iter_mut().chain(&mut self.splits) {
            bounced.fill([0.0; 3]);
        }
        self.rays.fill(0);
    }

    /// Adds weight x value to reflection (0) or refraction (1) of a pixel.
    pub(super) fn add(&mut self, layer: usize, pixel: usize, weight: [f64; 3], value: [R; 3]) {
        add_weighted(&mut self.bounced[layer][pixel], weight, value, self.signed);
    }

    /// Adds the same to its part, where parts are kept.
    pub(super) fn add_split(&mut self, part: usize, pixel: usize, weight: [f64; 3], value: [R; 3]) {
        if let Some(part) = self.splits.get_mut(part) {
            add_weighted(&mut part[pixel], weight, value, self.signed);
        }
    }

    /// The parts of a pixel's reflection and refraction.
    fn parts(&self, pixel: usize) -> impl Iterator<Item = [R; 3]> {
        let parts = self.splits.iter();
        parts.map(move |part| part[pixel].each(R::from_f64))
    }

    /// The colour of a pixel's sample, and the bounced layers as they count in it.
    pub(super) fn color(&self, pixel: usize) -> ([R; 3], [[R; 3]; 2]) {
        let bounced = [0, 1].each(|k| self.bounced[k][pixel].each(R::from_f64));
        let color = if self.recording() {
            let local = self.terms.iter().map(|term| term[pixel]);
            sum_in_order(local.chain(bounced), self.signed)
        } else {
            let local = self.local[pixel];
            [0, 1, 2].each(|c| (local[c] + bounced[0][c]) + bounced[1][c])
        };
        (color, bounced)
    }
}

/// The mean over samples: summed in f64 in sample order, rounded once; one sample is passed on as it is.
pub(super) struct Mean {
    samples: u32,
    color: Vec<[f64; 3]>,
    layers: Vec<Vec<[f64; 3]>>,
    splits: Vec<Vec<[f64; 3]>>,
}

impl Mean {
    /// For a number of samples of a tile's pixels.
    pub(super) fn new<R: Real>(out: &TileFrame<R>, samples: u32) -> Self {
        let pixels = if samples == 1 { 0 } else { out.color.len() };
        let zero = || vec![[0.0; 3]; pixels];
        Self {
            samples,
            color: zero(),
            layers: out.layers.iter().map(|_| zero()).collect(),
            splits: out.splits.iter().map(|_| zero()).collect(),
        }
    }

    /// Takes one sample of every pixel.
    pub(super) fn add<R: Real>(&mut self, sums: &Sums<R>, out: &mut TileFrame<R>) {
        for pixel in 0..out.color.len() {
            let (color, bounced) = sums.color(pixel);
            if self.samples == 1 {
                out.color[pixel] = color;
            } else {
                add_to(&mut self.color[pixel], color);
            }
            if out.layers.is_empty() {
                continue;
            }
            let local = sums.terms.iter().map(|term| term[pixel]);
            for (k, value) in local.chain(bounced).enumerate() {
                if self.samples == 1 {
                    out.layers[k][pixel] = value;
                } else {
                    add_to(&mut self.layers[k][pixel], value);
                }
            }
            for (k, value) in sums.parts(pixel).enumerate() {
                if self.samples == 1 {
                    out.splits[k][pixel] = value;
                } else {
                    add_to(&mut self.splits[k][pixel], value);
                }
            }
        }
    }

    /// Leaves the means, and the remainder layer that closes their sum.
    pub(super) fn finish<R: Real>(self, out: &mut TileFrame<R>, signed: bool) {
        if self.samples == 1 {
            return;
        }
        for (color, sum) in out.color.iter_mut().zip(self.color) {
            *color = sampling::resolve(sum, self.samples);
        }
        let Some((rest, named)) = out.layers.split_last_mut() else {
            return;
        };
        for (layer, sums) in named.iter_mut().zip(&self.layers) {
            for (value, sum) in layer.iter_mut().zip(sums) {
                *value = sampling::resolve(*sum, self.samples);
            }
        }
        for (part, sums) in out.splits.iter_mut().zip(&self.splits) {
            for (value, sum) in part.iter_mut().zip(sums) {
                *value = sampling::resolve(*sum, self.samples);
            }
        }
        for (pixel, rest) in rest.iter_mut().enumerate() {
            let layers = named.iter().map(|layer| layer[pixel]);
            *rest = remainder(out.color[pixel], layers, signed);
        }
    }
}

/// Adds weight x value: in `R`, or in f64 where colours are signed.
fn add_weighted<R: Real>(sum: &mut [f64; 3], weight: [f64; 3], value: [R; 3], signed: bool) {
    for ((s, w), x) in sum.iter_mut().zip(weight).zip(value) {
        let next = if signed {
            *s + w * x.to_f64()
        } else {
            (R::from_f64(*s) + R::from_f64(w) * x).to_f64()
        };
        // Weights above 1 may grow beyond `R`: infinity times 0, or less infinity, has no value and counts as 0.
        if !next.is_nan() {
            *s = next;
        }
    }
}

fn add_to<R: Real>(sum: &mut [f64; 3], value: [R; 3]) {
    for (s, x) in sum.iter_mut().zip(value) {
        *s += x.to_f64();
    }
}
