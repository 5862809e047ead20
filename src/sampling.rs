//! Where the samples of a pixel lie: the same places in both renderers, on multiples of 1/256 pixel.

use crate::lanes::Real;

/// Sub-pixel steps a pixel.
pub const SUBPIXEL: u32 = 256;

/// How samples are spread over a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pattern {
    /// A regular grid, as square as the number of samples allows.
    #[default]
    Grid,
    /// One hashed place in each cell of that grid; the seed is the pixel and the sample index.
    Jitter,
}

impl Pattern {
    /// The one table of names: command line, scene file and reports.
    pub const NAMES: &[(&'static str, Self)] = &[("grid", Self::Grid), ("jitter", Self::Jitter)];
}

/// The largest number of samples a pixel.
pub const MAX_SAMPLES: u32 = 4096;

/// Columns and rows of the sample grid: the most square factorisation with columns >= rows.
pub fn grid_shape(samples: u32) -> (u32, u32) {
    let samples = samples.max(1);
    let rows = (1..=samples.isqrt())
        .rev()
        .find(|r| samples.is_multiple_of(*r))
        .unwrap_or(1);
    (samples / rows, rows)
}

/// Place of sample `index` of pixel (x, y) inside the pixel, in 1/256 pixel from its top-left corner, each in 0..256.
///
/// One sample lies at the centre, (128, 128), for the grid; jitter moves it, too.
///
/// ```
/// use rastray::sampling::{Pattern, position};
/// assert_eq!(position(Pattern::Grid, 1, 0, 0, 0), (128, 128));
/// assert_eq!(position(Pattern::Grid, 4, 7, 9, 3), (192, 192));
/// ```
pub fn position(pattern: Pattern, samples: u32, x: u32, y: u32, index: u32) -> (u32, u32) {
    seeded_position(pattern, samples, [x, y], index, 0)
}

/// [`position`] with another seed of the jitter: places that have nothing to do with those of another seed. A grid has none.
///
/// ```
/// use rastray::sampling::{Pattern, position, seeded_position};
/// let at = |seed| seeded_position(Pattern::Jitter, 1, [7, 9], 0, seed);
/// assert_eq!(at(0), position(Pattern::Jitter, 1, 7, 9, 0));
/// assert_ne!(at(0), at(1));
/// ```
pub fn seeded_position(
    pattern: Pattern,
    samples: u32,
    [x, y]: [u32; 2],
    index: u32,
    seed: u32,
) -> (u32, u32) {
    let (columns, rows) = grid_shape(samples);
    let cell = |i: u32, n: u32| (i * SUBPIXEL / n, (i + 1) * SUBPIXEL / n);
    let (left, right) = cell(index % columns, columns);
    let (top, bottom) = cell(index / columns, rows);
    match pattern {
        Pattern::Grid => (u32::midpoint(left, right), u32::midpoint(top, bottom)),
        Pattern::Jitter => {
            let h = hash(x, y, index, seed);
            let pick = |low: u32, high: u32, bits: u32| {
                let span = u64::from((high - low).max(1));
                (low + ((u64::from(bits) * span) >> 32) as u32).min(SUBPIXEL - 1)
            };
            (
                pick(left, right, h as u32),
                pick(top, bottom, (h >> 32) as u32),
            )
        }
    }
}

/// The box filter: the mean of the samples' colours, summed in f64 in sample order and rounded once.
pub fn resolve<R: Real>(sum: [f64; 3], samples: u32) -> [R; 3] {
    sum.map(|x| R::from_f64(x / f64::from(samples)))
}

/// A 64-bit hash of pixel, sample index and seed (the finaliser of SplitMix64, Steele et al. 2014).
fn hash(x: u32, y: u32, index: u32, seed: u32) -> u64 {
    let mut z = (u64::from(x) << 32 | u64::from(y)).wrapping_add(
        u64::from(index)
            .wrapping_add(1)
            .wrapping_mul(0x9e37_79b9_7f4a_7c15),
    );
    // An odd factor spreads the seed over all bits; seed 0 changes none.
    z ^= u64::from(seed).wrapping_mul(0xd1b5_4a32_d192_ed03);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_stay_in_their_cells() {
        for samples in [1, 2, 3, 4, 7, 16, 64, 4096] {
            let (columns, rows) = grid_shape(samples);
            assert_eq!(columns * rows, samples);
            for pattern in [Pattern::Grid, Pattern::Jitter] {
                for index in 0..samples {
                    let (px, py) = position(pattern, samples, 3, 5, index);
                    assert!(px < SUBPIXEL && py < SUBPIXEL);
                    assert!(px >= index % columns * SUBPIXEL / columns);
                    assert!(py >= index / columns * SUBPIXEL / rows);
                }
            }
        }
    }

    #[test]
    fn jitter_differs_between_pixels_and_repeats() {
        let a = position(Pattern::Jitter, 4, 1, 2, 0);
        assert_eq!(a, position(Pattern::Jitter, 4, 1, 2, 0));
        let others = (0..50)
            .filter(|&x| position(Pattern::Jitter, 4, x, 2, 0) == a)
            .count();
        assert!(others < 10);
    }
}
