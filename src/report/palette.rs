//! Palettes: up to 256 colours that stand for all colours of some pictures.
//!
//! In: 8-bit colours, counted as they come, so that any number of pictures needs the same memory. Out: a palette, and the
//! entry nearest to a colour. Up to 256 different colours are kept exactly. More are gathered in cells of 4 x 4 x 4
//! values, which are split into 256 boxes, each time the one with the largest squared error, where that error falls most
//! (the greedy rule of Wu, "Efficient Statistical Computations for Optimal Color Quantization", Graphics Gems II, 1991);
//! four rounds of k-means then move the boxes' means. Integers and f64 sums in a fixed order: same colours, same palette.
//!
//! A crate would do it: `quantette` needs a newer compiler, and `color_quant` (NeuQuant) neither takes pictures one by one
//! nor keeps flat colours such as a black background.

use std::collections::BTreeMap;

/// Most colours of a palette.
pub const MAX_COLORS: usize = 256;

/// Bits of each channel that cells tell apart.
const CELL_BITS: u32 = 6;
const CELLS: usize = 1 << (3 * CELL_BITS);
/// Rounds of k-means after the splits.
const ROUNDS: usize = 4;

/// How many pixels had which colour.
#[derive(Clone, Debug)]
pub struct Histogram {
    /// Count, and sums of red, green and blue, of each cell.
    cells: Vec<[u64; 4]>,
    /// The different colours, until there are too many.
    exact: Option<BTreeMap<[u8; 3], u8>>,
}

impl Default for Histogram {
    fn default() -> Self {
        Self {
            cells: vec![[0; 4]; CELLS],
            exact: Some(BTreeMap::new()),
        }
    }
}

/// The number of the cell that a colour lies in.
fn cell_of(color: [u8; 3]) -> usize {
    let [r, g, b] = color.map(|v| usize::from(v >> (8 - CELL_BITS)));
    (r << (2 * CELL_BITS)) | (g << CELL_BITS) | b
}

impl Histogram {
    /// Counts the pixels of a picture.
    pub fn add(&mut self, pixels: &[[u8; 3]]) {
        for pixel in pixels {
            let cell = &mut self.cells[cell_of(*pixel)];
            cell[0] += 1;
            for (sum, v) in cell[1..].iter_mut().zip(pixel) {
                *sum += u64::from(*v);
            }
        }
        let Some(exact) = &mut self.exact else {
            return;
        };
        for pixel in pixels {
            exact.entry(*pixel).or_insert(0);
            if exact.len() > MAX_COLORS {
                self.exact = None;
                return;
            }
        }
    }

    /// The palette of everything that was counted.
    pub fn palette(&self) -> Palette {
        if let Some(exact) = &self.exact {
            let numbered = exact.keys().enumerate().map(|(i, c)| (*c, i as u8));
            return Palette {
                colors: exact.keys().copied().collect(),
                exact: numbered.collect(),
                nearest: Vec::new(),
            };
        }
        let cells = self.occupied();
        let mut means = split_into_boxes(&cells);
        for _ in 0..ROUNDS {
            move_means(&cells, &mut means);
        }
        let colors: Vec<[u8; 3]> = means
            .iter()
            .map(|m| m.map(|x| x.round().clamp(0.0, 255.0) as u8))
            .collect();
        let mut nearest_of = vec![0; CELLS];
        for cell in &cells {
            nearest_of[cell_of(cell.mean.map(|x| x as u8))] = nearest(&means, cell.mean) as u8;
        }
        Palette {
            colors,
            exact: BTreeMap::new(),
            nearest: nearest_of,
        }
    }

    fn occupied(&self) -> Vec<Cell> {
        let cell = |[n, r, g, b]: &[u64; 4]| Cell {
            weight: *n as f64,
            mean: [r, g, b].map(|sum| *sum as f64 / *n as f64),
        };
        self.cells.iter().filter(|c| c[0] > 0).map(cell).collect()
    }
}

/// Up to [`MAX_COLORS`] colours.
#[derive(Clone, Debug)]
pub struct Palette {
    /// The colours.
    pub colors: Vec<[u8; 3]>,
    /// The entry of each colour, where all are kept.
    exact: BTreeMap<[u8; 3], u8>,
    /// The entry of each cell, otherwise.
    nearest: Vec<u8>,
}

impl Palette {
    /// The entry that stands for a colour that was counted.
    pub fn index(&self, color: [u8; 3]) -> u8 {
        let cell = || self.nearest.get(cell_of(color)).copied().unwrap_or(0);
        self.exact.get(&color).copied().unwrap_or_else(cell)
    }
}

/// An occupied cell: how many pixels, and their mean colour.
#[derive(Clone, Copy, Debug)]
struct Cell {
    weight: f64,
    mean: [f64; 3],
}

/// Weight, weighted sum and weighted sum of squares of some cells.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    weight: f64,
    sum: [f64; 3],
    squares: f64,
}

impl Moments {
    fn of(cells: &[Cell]) -> Self {
        let mut all = Self::default();
        cells.iter().for_each(|c| all.add(c));
        all
    }

    fn add(&mut self, cell: &Cell) {
        self.weight += cell.weight;
        for (sum, x) in self.sum.iter_mut().zip(cell.mean) {
            *sum += cell.weight * x;
            self.squares += cell.weight * x * x;
        }
    }

    /// |sum|^2 / weight: what the mean explains of the squares.
    fn explained(&self) -> f64 {
        let square: f64 = self.sum.iter().map(|x| x * x).sum();
        if self.weight > 0.0 {
            square / self.weight
        } else {
            0.0
        }
    }

    /// Squared distance to the mean, summed.
    fn error(&self) -> f64 {
        self.squares - self.explained()
    }

    fn mean(&self) -> [f64; 3] {
        self.sum.map(|x| x / self.weight)
    }
}

/// Splits the box with the largest error until there are enough; the means of the boxes.
fn split_into_boxes(cells: &[Cell]) -> Vec<[f64; 3]> {
    let mut cells = cells.to_vec();
    let whole = Moments::of(&cells);
    let mut boxes = vec![(0..cells.len(), whole)];
    while boxes.len() < MAX_COLORS {
        let worst = boxes
            .iter()
            .enumerate()
            .filter(|(_, (range, _))| range.len() > 1)
            .max_by(|(_, (_, a)), (_, (_, b))| a.error().total_cmp(&b.error()));
        let Some((number, _)) = worst else {
            break;
        };
        let (range, _) = boxes.swap_remove(number);
        let middle = range.start + split(&mut cells[range.clone()]);
        for part in [range.start..middle, middle..range.end] {
            let moments = Moments::of(&cells[part.clone()]);
            boxes.push((part, moments));
        }
    }
    boxes.iter().map(|(_, moments)| moments.mean()).collect()
}

/// Sorts two or more cells along the best channel and returns where the best split is.
fn split(cells: &mut [Cell]) -> usize {
    let whole = Moments::of(cells);
    let mut best = (f64::NEG_INFINITY, 0, 1);
    for channel in 0..3 {
        sort(cells, channel);
        let mut low = Moments::default();
        for i in 0..cells.len() - 1 {
            low.add(&cells[i]);
            if cells[i].mean[channel] == cells[i + 1].mean[channel] {
                continue;
            }
            let high = Moments {
                weight: whole.weight - low.weight,
                sum: [0, 1, 2].map(|c| whole.sum[c] - low.sum[c]),
                squares: 0.0,
            };
            let explained = low.explained() + high.explained();
            if explained > best.0 {
                best = (explained, channel, i + 1);
            }
        }
    }
    sort(cells, best.1);
    best.2
}

fn sort(cells: &mut [Cell], channel: usize) {
    cells.sort_by(|a, b| a.mean[channel].total_cmp(&b.mean[channel]));
}

/// Each mean moves to the mean of the cells that are nearest to it.
fn move_means(cells: &[Cell], means: &mut [[f64; 3]]) {
    let mut sums = vec![Moments::default(); means.len()];
    for cell in cells {
        sums[nearest(means, cell.mean)].add(cell);
    }
    for (mean, moments) in means.iter_mut().zip(&sums) {
        if moments.weight > 0.0 {
            *mean = moments.mean();
        }
    }
}

/// The first of the nearest means.
fn nearest(means: &[[f64; 3]], color: [f64; 3]) -> usize {
    let distance = |m: &[f64; 3]| -> f64 {
        let d = [0, 1, 2].map(|c| m[c] - color[c]);
        d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    };
    let mut best = (f64::INFINITY, 0);
    for (i, mean) in means.iter().enumerate() {
        let d = distance(mean);
        if d < best.0 {
            best = (d, i);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colours_are_kept_exactly() {
        let pixels: Vec<[u8; 3]> = (0..=255).map(|i| [i, 255 - i, i / 2]).collect();
        let mut histogram = Histogram::default();
        histogram.add(&pixels);
        let palette = histogram.palette();
        assert_eq!(palette.colors.len(), 256);
        for pixel in pixels {
            assert_eq!(palette.colors[usize::from(palette.index(pixel))], pixel);
        }
    }

    #[test]
    fn many_colours_are_near_and_flat_ones_stay() {
        // Half the picture is black; the rest is a plane of 128 x 128 colours, which 256 boxes of 8 x 8 can cover.
        let ramp: Vec<[u8; 3]> = (0..128 * 128u32)
            .map(|i| [(i % 128) as u8 + 100, (i / 128) as u8 + 100, 60])
            .collect();
        let mut histogram = Histogram::default();
        histogram.add(&vec![[0; 3]; ramp.len()]);
        histogram.add(&ramp);
        let palette = histogram.palette();
        assert!(palette.colors.len() <= MAX_COLORS);
        assert_eq!(palette.colors[usize::from(palette.index([0; 3]))], [0; 3]);
        let off = |pixel: &[u8; 3]| -> u32 {
            let found = palette.colors[usize::from(palette.index(*pixel))];
            let d = [0, 1, 2].map(|c| u32::from(found[c].abs_diff(pixel[c])));
            d.map(|x| x * x).iter().sum()
        };
        let mean = ramp.iter().map(|p| f64::from(off(p))).sum::<f64>() / ramp.len() as f64;
        // Squares of side 8 have a mean squared error of (64 - 1) / 6 = 10.5; cells of 4 cost a little more.
        assert!(mean < 14.0, "mean squared error {mean}");
    }

    #[test]
    fn one_colour_and_none_are_palettes_too() {
        assert!(Histogram::default().palette().colors.is_empty());
        let mut histogram = Histogram::default();
        histogram.add(&[[7, 8, 9]; 4]);
        assert_eq!(histogram.palette().colors, [[7, 8, 9]]);
    }
}
