//! The pictures of a slide that are drawn: the difference with its legend, and the equation.
//!
//! White paper, as all figures. Distances are in units of 1/1920 of the width or 1/1080 of the height, whichever is
//! smaller, so that a slide of another size is the same slide.

use rastray_compare::Scale;
use tiny_skia::Pixmap;

use crate::error::Error;

use super::super::equation::{Script, runs};
use super::super::layout::{Chunk, GREY, HAIR, INK, MARK, fill, opaque, paper, signed_tick, wrap};
use super::super::picture::Picture;
use super::super::text::{self, Face, Span};
use super::super::{prose, topic::Topic};
use super::Slide;

/// Distances of a picture of some size.
fn unit(width: usize, height: usize) -> f32 {
    (width as f32 / 1920.0).min(height as f32 / 1080.0)
}

/// The map with its legend over the corner that has least to show; every other pixel is the map's.
pub(super) fn with_legend(map: &Picture) -> Result<Picture, Error> {
    let Some(scale) = map.scale else {
        return Ok(map.clone());
    };
    let u = unit(map.width, map.height);
    let whole = |units: f32| (units * u).round() as usize;
    let (width, height, rim) = (whole(560.0), whole(132.0), whole(32.0));
    if width < 16 || width + rim > map.width || height + rim > map.height {
        return Ok(map.clone());
    }
    let legend = legend(&scale, width, height, u)?;
    let (right, bottom) = (map.width - width - rim, map.height - height - rim);
    let corners = [(right, bottom), (rim, bottom), (right, rim), (rim, rim)];
    let hidden = |&(x, y): &(usize, usize)| -> usize {
        let rows = map.pixels.chunks_exact(map.width).skip(y).take(height);
        let ink = |p: &[u8; 3]| p.iter().map(|v| 255 - usize::from(*v)).sum::<usize>();
        rows.flat_map(|row| &row[x..x + width]).map(ink).sum()
    };
    // The first of equals.
    let place = corners.iter().copied().min_by_key(hidden);
    let (x, y) = place.unwrap_or((right, bottom));
    let mut picture = map.clone();
    let rows = picture.pixels.chunks_exact_mut(map.width).skip(y);
    for (row, from) in rows.zip(legend.pixels.chunks_exact(width)) {
        row[x..x + width].copy_from_slice(from);
    }
    Ok(picture)
}

/// A bar with numbers under it and its meaning above it, on white paper.
fn legend(scale: &Scale, width: usize, height: usize, u: f32) -> Result<Picture, Error> {
    let whole = |units: f32| (units * u).round() as usize;
    let mut pixmap = paper(width, height)?;
    fill(&mut pixmap, [0, 0, width, height], HAIR);
    fill(&mut pixmap, [1, 1, width - 2, height - 2], [255; 3]);
    let (left, bar, top) = (whole(52.0), width - 2 * whole(52.0), whole(56.0));
    let title = [
        Span::new("trace − raster", Face::SemiBold, 26.0 * u, INK),
        Span::new(
            "   blue darker, orange brighter",
            Face::Regular,
            22.0 * u,
            GREY,
        ),
    ];
    text::draw(&mut pixmap, &title, left as f32, 40.0 * u);
    for column in 0..bar {
        let part = (column as f64 + 0.5) / bar as f64;
        let value = scale.min() + part * (scale.max - scale.min());
        let high = whole(26.0).max(1);
        fill(
            &mut pixmap,
            [left + column, top, 1, high],
            scale.color(value),
        );
    }
    for tick in scale.ticks() {
        let part = (tick - scale.min()) / (scale.max - scale.min());
        let label = Span::new(signed_tick(scale, tick), Face::Regular, 24.0 * u, INK);
        let x = left as f32 + part as f32 * bar as f32 - 0.5 * label.width();
        text::draw(&mut pixmap, &[label], x, 112.0 * u);
    }
    Ok(opaque(&pixmap))
}

/// The question, the whole equation with the scene's terms lit, and the answer.
pub(super) fn equation(slide: &Slide, width: usize, height: usize) -> Result<Picture, Error> {
    let u = unit(width, height);
    let mut pixmap = paper(width, height)?;
    let margin = 110.0 * u;
    let page = Page {
        left: margin,
        width: width as f32 - 2.0 * margin,
    };
    let (h, left) = (height as f32, page.left);
    let kicker = Span::new(&slide.stem, Face::Regular, 30.0 * u, GREY);
    text::draw(&mut pixmap, &[kicker], left, 104.0 * u);
    let title = match slide.head.question.as_str() {
        "" => &slide.stem,
        question => question,
    };
    let room = 0.24 * h;
    let title = |size| prose::chunks(title, Face::SemiBold, size, INK);
    page.paragraph(&mut pixmap, title, 68.0 * u, room, Some(124.0 * u));
    equation_lines(&mut pixmap, slide, &page, 0.5 * h, u);
    let answer = |size| prose::chunks(&slide.head.answer, Face::Regular, size, INK);
    let room = 0.24 * h;
    let bottom = h - 90.0 * u;
    page.paragraph_above(&mut pixmap, answer, 42.0 * u, room, bottom);
    Ok(opaque(&pixmap))
}

/// Where text stands, in pixels.
struct Page {
    left: f32,
    width: f32,
}

impl Page {
    /// Text as large as fits in a height, but not larger than asked; where even half of it does not, lines are dropped.
    fn set(
        &self,
        chunks: impl Fn(f32) -> Vec<Chunk>,
        size: f32,
        room: f32,
    ) -> (f32, Vec<Vec<Span>>) {
        let fits = |size: f32| {
            let lines = wrap(&chunks(size), self.width);
            (lines.len() as f32 * 1.3 * size <= room).then_some((size, lines))
        };
        let tries = (0..=10).map(|i| size * (1.0 - 0.05 * i as f32));
        tries.into_iter().find_map(fits).unwrap_or_else(|| {
            let size = 0.5 * size;
            let mut lines = wrap(&chunks(size), self.width);
            lines.truncate((room / (1.3 * size)) as usize);
            if let Some(last) = lines.last_mut().and_then(|line| line.last_mut()) {
                last.text += " …";
            }
            (size, lines)
        })
    }

    /// Text below a height.
    fn paragraph(
        &self,
        pixmap: &mut Pixmap,
        chunks: impl Fn(f32) -> Vec<Chunk>,
        size: f32,
        room: f32,
        top: Option<f32>,
    ) {
        let (size, lines) = self.set(chunks, size, room);
        for (i, line) in lines.iter().enumerate() {
            let baseline = top.unwrap_or(0.0) + (i as f32 * 1.3 + 1.0) * size;
            text::draw(pixmap, line, self.left, baseline);
        }
    }

    /// Text that ends at a height.
    fn paragraph_above(
        &self,
        pixmap: &mut Pixmap,
        chunks: impl Fn(f32) -> Vec<Chunk>,
        size: f32,
        room: f32,
        bottom: f32,
    ) {
        let (size, lines) = self.set(chunks, size, room);
        for (i, line) in lines.iter().rev().enumerate() {
            let baseline = bottom - (i as f32 * 1.3 + 0.3) * size;
            text::draw(pixmap, line, self.left, baseline);
        }
    }

    /// Spans in the middle of the line.
    fn centred(&self, pixmap: &mut Pixmap, spans: &[Span], baseline: f32) {
        let x = self.left + 0.5 * (self.width - text::width(spans));
        text::draw(pixmap, spans, x, baseline);
    }
}

/// The words of the topics, the equation, and the lines about light sources, around a height.
fn equation_lines(pixmap: &mut Pixmap, slide: &Slide, page: &Page, middle: f32, u: f32) {
    let lines = slide.topics.lines(slide.form);
    let spans = |line: usize, size: f32| -> Vec<Span> {
        // Without a topic nothing stands back.
        let plain = if slide.topics.0.is_empty() { INK } else { GREY };
        let lit = |p: &_| slide.topics.lit(p).then_some(MARK);
        let runs = runs(&lines[line], false, lit);
        let runs = runs.into_iter().flat_map(|(mark, run)| {
            let color = if mark.is_some() { INK } else { plain };
            run.iter().map(move |piece| Span {
                highlight: mark,
                ..Span::of_piece(piece, size, color)
            })
        });
        runs.collect()
    };
    let natural = text::width(&spans(0, 100.0)) / 100.0;
    let size = (76.0 * u).min(page.width / natural.max(1.0));
    let baseline = middle + (if lines.len() > 1 { 0.0 } else { 0.3 }) * size;
    page.centred(
        pixmap,
        &topic_line(&slide.topics.0, page.width, 40.0 * u),
        baseline - 1.9 * size,
    );
    page.centred(pixmap, &spans(0, size), baseline);
    for line in 1..lines.len() {
        let at = baseline + (0.2 + 1.5 * line as f32) * size;
        page.centred(pixmap, &spans(line, 0.8 * size), at);
    }
}

/// "+ D diffuse   + S specular", no wider than there is room.
fn topic_line(topics: &[Topic], room: f32, size: f32) -> Vec<Span> {
    let set = |size: f32| -> Vec<Span> {
        let mut spans = Vec::new();
        for (i, topic) in topics.iter().enumerate() {
            let gap = if i > 0 { "     " } else { "" };
            spans.push(Span::new(gap, Face::Regular, size, GREY));
            for (text, script) in label_parts(topic.label()) {
                let bold = Span::new(text, Face::SemiBold, size, INK);
                spans.push(Span { script, ..bold });
            }
            let name = format!("  {}", topic.name());
            spans.push(Span::new(name, Face::Regular, size, GREY));
        }
        spans
    };
    let width = text::width(&set(size)).max(1.0);
    set(size * (room / width).min(1.0))
}

/// A label with what stands behind an underscore lowered.
pub(super) fn label_parts(label: &str) -> Vec<(&str, Script)> {
    match label.split_once('_') {
        Some((base, sub)) => vec![(base, Script::Base), (sub, Script::Sub)],
        None => vec![(label, Script::Base)],
    }
}
