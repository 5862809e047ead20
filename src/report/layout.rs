//! Cells in a grid: pictures, pixel for pixel, with text above and below and a legend at the right of maps.
//!
//! In: cells of one figure and its unit, the em size of titles in pixels. All distances are whole pixels made from the
//! unit, so that pictures are never resampled and figures of one width look alike. White paper, dark ink.

use rastray_compare::{Scale, ScaleKind};
use tiny_skia::{Color, Pixmap, Rect, Transform};

use crate::error::Error;

use super::numbers::tick;
use super::picture::Picture;
use super::text::{self, Face, Span};

/// Ink of titles and numbers.
pub(super) const INK: [u8; 3] = [0x1b, 0x1f, 0x24];
/// Ink of what stands back: 5.9 : 1 against white.
pub(super) const GREY: [u8; 3] = [0x5a, 0x63, 0x6e];
/// The box behind what is new.
pub(super) const MARK: [u8; 3] = [0xff, 0xe0, 0xbd];
/// Lines around pictures.
pub(super) const HAIR: [u8; 3] = [0xcf, 0xd4, 0xda];

/// Most pixels of a figure: 1 GiB of memory.
const MAX_PIXELS: usize = 1 << 28;

/// Spans that stay together on one line. A space at its start disappears at the start of a line.
pub(super) type Chunk = Vec<Span>;

/// One picture with its text. Each block of text starts on a new line.
/// Without a picture, the text below stands in the picture's place.
#[derive(Clone, Debug, Default)]
pub(super) struct Cell<'a> {
    pub(super) above: Vec<Vec<Chunk>>,
    pub(super) picture: Option<&'a Picture>,
    pub(super) below: Vec<Vec<Chunk>>,
}

/// Words of running text as chunks.
pub(super) fn words(text: &str, face: Face, size: f32, color: [u8; 3]) -> Vec<Chunk> {
    let spaced = |(i, word): (usize, &str)| {
        let text = if i == 0 {
            word.to_owned()
        } else {
            format!(" {word}")
        };
        vec![Span::new(text, face, size, color)]
    };
    text.split_whitespace().enumerate().map(spaced).collect()
}

/// A line of nothing, for a little room between blocks.
pub(super) fn room(size: f32) -> Vec<Chunk> {
    vec![vec![Span::new("", Face::Regular, size, INK)]]
}

/// Sets chunks into lines no wider than `width`; a chunk wider than that gets a line of its own.
pub(super) fn wrap(chunks: &[Chunk], width: f32) -> Vec<Vec<Span>> {
    let mut lines: Vec<Vec<Span>> = Vec::new();
    let mut used = 0.0;
    for chunk in chunks {
        let advance = text::width(chunk);
        match lines.last_mut() {
            Some(line) if used + advance <= width => {
                line.extend_from_slice(chunk);
                used += advance;
            }
            _ => {
                let mut line = chunk.clone();
                if let Some(first) = line.first_mut() {
                    first.text = first.text.trim_start().to_owned();
                }
                used = text::width(&line);
                lines.push(line);
            }
        }
    }
    lines
}

/// A cell whose text has been set.
struct SetCell<'a> {
    above: Vec<Vec<Span>>,
    picture: Option<&'a Picture>,
    below: Vec<Vec<Span>>,
}

/// Distances in whole pixels.
struct Spacing {
    unit: f32,
    margin: usize,
    gap_x: usize,
    gap_y: usize,
    /// Between a picture and the text at it.
    near: usize,
}

impl Spacing {
    fn new(unit: f32) -> Self {
        let whole = |units: f32| (units * unit).round() as usize;
        Self {
            unit,
            margin: whole(1.1),
            gap_x: whole(1.1),
            gap_y: whole(1.5),
            near: whole(0.55),
        }
    }

    /// Height of lines of text: 1.4 em each.
    fn lines(&self, lines: &[Vec<Span>]) -> usize {
        lines.iter().map(|line| self.line(line)).sum()
    }

    fn line(&self, line: &[Span]) -> usize {
        let size = line.iter().map(|s| s.size).fold(0.0, f32::max);
        (1.4 * size).round() as usize
    }

    /// Room that a picture's legend takes at its right.
    fn legend(&self, picture: &Picture) -> usize {
        let Some(scale) = &picture.scale else {
            return 0;
        };
        let label =
            |v: &f64| text::measure(&signed_tick(scale, *v), Face::Regular, self.tick_size());
        let widest = scale.ticks().iter().map(label).fold(0.0, f32::max);
        (1.6 * self.unit + widest).ceil() as usize
    }

    fn tick_size(&self) -> f32 {
        0.74 * self.unit
    }
}

/// Draws cells, `columns` to a row, into a new picture.
pub(super) fn grid(cells: &[Cell], columns: usize, unit: f32) -> Result<Picture, Error> {
    let space = Spacing::new(unit);
    let columns = columns.clamp(1, cells.len().max(1));
    let widths = column_widths(cells, columns, &space);
    let set: Vec<SetCell> = cells
        .iter()
        .enumerate()
        .map(|(i, cell)| set_cell(cell, widths[i % columns] as f32))
        .collect();
    let rows: Vec<[usize; 3]> = set
        .chunks(columns)
        .map(|row| row_heights(row, &space))
        .collect();

    let width = 2 * space.margin + widths.iter().sum::<usize>() + (columns - 1) * space.gap_x;
    let height = 2 * space.margin
        + rows.iter().flatten().sum::<usize>()
        + rows.len().saturating_sub(1) * space.gap_y;
    let mut pixmap = paper(width, height)?;

    let mut y = space.margin;
    for (row, heights) in set.chunks(columns).zip(&rows) {
        let mut x = space.margin;
        for (cell, width) in row.iter().zip(&widths) {
            draw_cell(&mut pixmap, cell, x, y, heights, &space);
            x += width + space.gap_x;
        }
        y += heights.iter().sum::<usize>() + space.gap_y;
    }
    Ok(opaque(&pixmap))
}

/// Each column is as wide as its widest picture with legend, and wide enough for a few words.
fn column_widths(cells: &[Cell], columns: usize, space: &Spacing) -> Vec<usize> {
    let mut widths = vec![(12.0 * space.unit) as usize; columns];
    for (i, cell) in cells.iter().enumerate() {
        if let Some(picture) = cell.picture {
            let column = &mut widths[i % columns];
            *column = (*column).max(picture.width + space.legend(picture));
        }
    }
    widths
}

fn set_cell<'a>(cell: &Cell<'a>, width: f32) -> SetCell<'a> {
    let set = |blocks: &[Vec<Chunk>]| blocks.iter().flat_map(|b| wrap(b, width)).collect();
    SetCell {
        above: set(&cell.above),
        picture: cell.picture,
        below: set(&cell.below),
    }
}

/// Heights of a row's text above, pictures and text below, with the distances between them.
fn row_heights(row: &[SetCell], space: &Spacing) -> [usize; 3] {
    let highest = |f: &dyn Fn(&SetCell) -> usize| row.iter().map(f).max().unwrap_or(0);
    let near = |height: usize| if height > 0 { height + space.near } else { 0 };
    let below = |c: &SetCell| space.lines(&c.below);
    [
        near(highest(&|c| space.lines(&c.above))),
        highest(&|c| c.picture.map_or_else(|| below(c), |p| p.height)),
        near(highest(&|c| c.picture.map_or(0, |_| below(c)))),
    ]
}

/// Draws a cell whose top-left corner is given.
fn draw_cell(
    pixmap: &mut Pixmap,
    cell: &SetCell,
    x: usize,
    y: usize,
    heights: &[usize; 3],
    space: &Spacing,
) {
    draw_lines(pixmap, &cell.above, x, y, space);
    let top = y + heights[0];
    let mut below = top;
    if let Some(picture) = cell.picture {
        below = top + heights[1] + space.near;
        draw_picture(pixmap, picture, x, top);
        if let Some(scale) = &picture.scale {
            draw_legend(pixmap, scale, x + picture.width, top, picture.height, space);
        }
    }
    draw_lines(pixmap, &cell.below, x, below, space);
}

fn draw_lines(pixmap: &mut Pixmap, lines: &[Vec<Span>], x: usize, y: usize, space: &Spacing) {
    let mut top = y;
    for line in lines {
        let height = space.line(line);
        text::draw(pixmap, line, x as f32, top as f32 + 0.73 * height as f32);
        top += height;
    }
}

/// Copies the pixels, unchanged, inside a hairline.
fn draw_picture(pixmap: &mut Pixmap, picture: &Picture, x: usize, y: usize) {
    fill(
        pixmap,
        [x - 1, y - 1, picture.width + 2, picture.height + 2],
        HAIR,
    );
    copy(pixmap, picture, x, y);
}

/// Copies the pixels, unchanged, to a place where they fit.
pub(super) fn copy(pixmap: &mut Pixmap, picture: &Picture, x: usize, y: usize) {
    let stride = 4 * pixmap.width() as usize;
    let data = pixmap.data_mut();
    for (row, pixels) in picture.pixels.chunks_exact(picture.width).enumerate() {
        let start = (y + row) * stride + 4 * x;
        for (to, from) in data[start..].chunks_exact_mut(4).zip(pixels) {
            to[..3].copy_from_slice(from);
            to[3] = 255;
        }
    }
}

/// The bar of a scale as high as its map, with ticks; fewer ticks where there is little room.
fn draw_legend(
    pixmap: &mut Pixmap,
    scale: &Scale,
    left: usize,
    top: usize,
    height: usize,
    space: &Spacing,
) {
    let whole = |units: f32| (units * space.unit).round() as usize;
    let (x, width) = (left + whole(0.45), whole(0.55).max(4));
    fill(pixmap, [x - 1, top - 1, width + 2, height + 2], HAIR);
    for row in 0..height {
        let part = (row as f64 + 0.5) / height as f64;
        fill(
            pixmap,
            [x, top + row, width, 1],
            scale.color(scale.max - part * (scale.max - scale.min())),
        );
    }
    let ticks = scale.ticks();
    let room = (height as f32 / (1.5 * space.tick_size())) as usize;
    let step = if room >= ticks.len() {
        1
    } else if room >= 3 {
        2
    } else {
        ticks.len() - 1
    };
    for tick in ticks.iter().step_by(step) {
        let part = (scale.max - tick) / (scale.max - scale.min());
        let at = top as f32 + (part * height as f64) as f32;
        let tick_y = (at.round() as usize).clamp(top, top + height - 1);
        fill(pixmap, [x + width + 1, tick_y, whole(0.2), 1], GREY);
        // End labels move inwards, so that they stay beside the bar.
        let size = space.tick_size();
        let (high, low) = (top as f32 + 0.73 * size, (top + height) as f32);
        let baseline = (at + 0.36 * size).min(low).max(high).round();
        let label = Span::new(signed_tick(scale, *tick), Face::Regular, size, INK);
        text::draw(pixmap, &[label], (x + width + whole(0.42)) as f32, baseline);
    }
}

/// A tick's number; on signed scales positive numbers carry their sign.
pub(super) fn signed_tick(scale: &Scale, value: f64) -> String {
    match scale.kind {
        ScaleKind::Signed if value > 0.0 => format!("+{}", tick(value)),
        _ => tick(value),
    }
}

/// Fills whole pixels `[x, y, width, height]`.
pub(super) fn fill(pixmap: &mut Pixmap, [x, y, w, h]: [usize; 4], color: [u8; 3]) {
    if let Some(rect) = Rect::from_xywh(x as f32, y as f32, w as f32, h as f32) {
        pixmap.fill_rect(rect, &text::paint(color), Transform::identity(), None);
    }
}

/// White paper.
pub(super) fn paper(width: usize, height: usize) -> Result<Pixmap, Error> {
    let too_large = || {
        Error::limit(format!("the figure would be {width} x {height} pixels"))
            .with_help("compare at a smaller --size")
    };
    let fits = width.checked_mul(height).is_some_and(|n| n <= MAX_PIXELS);
    let (Ok(w), Ok(h), true) = (u32::try_from(width), u32::try_from(height), fits) else {
        return Err(too_large());
    };
    let mut pixmap = Pixmap::new(w, h).ok_or_else(too_large)?;
    pixmap.fill(Color::WHITE);
    Ok(pixmap)
}

/// The pixels of an opaque pixmap.
pub(super) fn opaque(pixmap: &Pixmap) -> Picture {
    Picture {
        width: pixmap.width() as usize,
        height: pixmap.height() as usize,
        pixels: pixmap
            .data()
            .chunks_exact(4)
            .map(|p| [p[0], p[1], p[2]])
            .collect(),
        scale: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_keep_to_their_width_and_lose_no_word() {
        let text = "orange where the traced picture is brighter, blue where the rasterized one is";
        let chunks = words(text, Face::Regular, 16.0, INK);
        let lines = wrap(&chunks, 180.0);
        assert!(lines.len() > 2);
        assert!(lines.iter().all(|line| text::width(line) <= 180.0));
        let flat = |line: &Vec<Span>| line.iter().map(|s| s.text.as_str()).collect::<String>();
        assert_eq!(lines.iter().map(flat).collect::<Vec<_>>().join(" "), text);
        // Too narrow for any word: one word a line.
        assert_eq!(wrap(&chunks, 1.0).len(), chunks.len());
    }

    #[test]
    fn pictures_are_copied_pixel_for_pixel() {
        let pixels = (0..40 * 30)
            .map(|i| [(i % 251) as u8, (i % 7) as u8, (i / 40) as u8])
            .collect();
        let picture = Picture {
            width: 40,
            height: 30,
            pixels,
            scale: None,
        };
        let cell = Cell {
            picture: Some(&picture),
            ..Cell::default()
        };
        let figure = grid(&[cell.clone(), cell], 2, 13.0).unwrap();
        let space = Spacing::new(13.0);
        let second = space.margin + (12.0f32 * 13.0) as usize + space.gap_x;
        for left in [space.margin, second] {
            for (i, pixel) in picture.pixels.iter().enumerate() {
                let (x, y) = (left + i % 40, space.margin + i / 40);
                assert_eq!(figure.pixels[y * figure.width + x], *pixel);
            }
        }
    }

    #[test]
    fn legends_fit_small_maps_and_show_their_ends() {
        let scale = Scale {
            kind: ScaleKind::Signed,
            max: 0.5,
        };
        for height in [1, 4, 20, 200] {
            let picture = Picture {
                width: 8,
                height,
                pixels: vec![[255; 3]; 8 * height],
                scale: Some(scale),
            };
            let figure = grid(
                &[Cell {
                    picture: Some(&picture),
                    ..Cell::default()
                }],
                1,
                14.0,
            );
            let figure = figure.unwrap();
            if height == 200 {
                let bar = figure
                    .pixels
                    .iter()
                    .filter(|p| **p == scale.color(0.5 - 0.5 / 200.0))
                    .count();
                assert!(bar > 0);
            }
        }
    }

    #[test]
    fn figures_beyond_memory_are_an_error() {
        assert!(matches!(paper(1 << 20, 1 << 20), Err(Error::Limit { .. })));
        assert!(matches!(paper(usize::MAX, 2), Err(Error::Limit { .. })));
    }
}
