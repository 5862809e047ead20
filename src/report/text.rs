//! Type as outlines: an embedded free font (Inter, see `fonts/README.md`), drawn as filled paths.
//!
//! In: text in spans of one face, size and colour. Out: widths in pixels and paths on a pixmap; baselines are given in
//! pixels from the top. Pairs are kerned from the font's GPOS table; there is no other shaping, so that scripts that
//! need it, and characters that the font lacks, show an empty box. No system font is ever looked at: same text, same
//! outlines everywhere.

use std::sync::OnceLock;

use tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, Transform};
use ttf_parser::gpos::{PairAdjustment, PositioningSubtable};
use ttf_parser::{GlyphId, OutlineBuilder};

use super::equation::{Piece, Script};

/// The bytes of the embedded faces, for pages that embed them too.
pub const REGULAR: &[u8] = include_bytes!("fonts/inter-regular.ttf");
/// See [`REGULAR`].
pub const SEMIBOLD: &[u8] = include_bytes!("fonts/inter-semibold.ttf");
/// See [`REGULAR`].
pub const ITALIC: &[u8] = include_bytes!("fonts/inter-italic.ttf");

/// The faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// For running text and numbers.
    Regular,
    /// For titles and what is new.
    SemiBold,
    /// For variables.
    Italic,
}

impl Face {
    /// The parsed font; none only if the embedded bytes were damaged, and then nothing is drawn.
    fn font(self) -> Option<&'static ttf_parser::Face<'static>> {
        static FONTS: OnceLock<[Option<ttf_parser::Face<'static>>; 3]> = OnceLock::new();
        let parse = |bytes| ttf_parser::Face::parse(bytes, 0).ok();
        let fonts = FONTS.get_or_init(|| [REGULAR, SEMIBOLD, ITALIC].map(parse));
        fonts[self as usize].as_ref()
    }
}

/// Text of one style.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// The characters.
    pub text: String,
    /// The face.
    pub face: Face,
    /// Em size in pixels of text on the line; scripts shrink it.
    pub size: f32,
    /// Ink, sRGB.
    pub color: [u8; 3],
    /// A soft box behind the span, sRGB.
    pub highlight: Option<[u8; 3]>,
    /// On the line, lowered or raised.
    pub script: Script,
}

impl Span {
    /// Plain text on the line.
    pub fn new(text: impl Into<String>, face: Face, size: f32, color: [u8; 3]) -> Self {
        let text = text.into();
        Self {
            text,
            face,
            size,
            color,
            highlight: None,
            script: Script::Base,
        }
    }

    /// A piece of the equation.
    pub fn of_piece(piece: &Piece, size: f32, color: [u8; 3]) -> Self {
        let face = if piece.variable {
            Face::Italic
        } else {
            Face::Regular
        };
        Self {
            script: piece.script,
            ..Self::new(piece.text, face, size, color)
        }
    }

    /// The em size drawn.
    fn drawn_size(&self) -> f32 {
        match self.script {
            Script::Base => self.size,
            Script::Sub | Script::Sup => 0.68 * self.size,
        }
    }

    /// How far below the line's baseline this span's lies.
    fn shift(&self) -> f32 {
        match self.script {
            Script::Base => 0.0,
            Script::Sub => 0.2 * self.size,
            Script::Sup => -0.36 * self.size,
        }
    }

    /// The advance width in pixels.
    pub fn width(&self) -> f32 {
        measure(&self.text, self.face, self.drawn_size())
    }
}

/// The advance width of a text in pixels.
///
/// ```
/// use rastray::report::text::{Face, measure};
/// let one = measure("0", Face::Regular, 20.0);
/// assert!(one > 5.0 && one < 20.0);
/// assert!((measure("000", Face::Regular, 20.0) - 3.0 * one).abs() < 1e-3);
/// ```
pub fn measure(text: &str, face: Face, size: f32) -> f32 {
    let mut end = 0.0;
    place(text, face, size, |_, _, x| end = x);
    end
}

/// The advance width of spans set one after the other.
pub fn width(spans: &[Span]) -> f32 {
    spans.iter().map(Span::width).sum()
}

/// Draws spans one after the other from `x`, on a baseline; returns where the pen ends.
pub fn draw(pixmap: &mut Pixmap, spans: &[Span], x: f32, baseline: f32) -> f32 {
    draw_highlights(pixmap, spans, x, baseline);
    let mut pen = x;
    for span in spans {
        let mut outline = Outline {
            builder: PathBuilder::new(),
            x: 0.0,
            y: 0.0,
            scale: 1.0,
        };
        let size = span.drawn_size();
        let mut start = 0.0;
        place(&span.text, span.face, size, |font, glyph, end| {
            outline.scale = size / f32::from(font.units_per_em());
            (outline.x, outline.y) = (pen + start, baseline + span.shift());
            // An outline with nothing in it (a space) draws nothing.
            font.outline_glyph(glyph, &mut outline);
            start = end;
        });
        if let Some(path) = outline.builder.finish() {
            let paint = paint(span.color);
            pixmap.fill_path(
                &path,
                &paint,
                FillRule::Winding,
                Transform::identity(),
                None,
            );
        }
        pen += start;
    }
    pen
}

/// One rounded box behind each run of highlighted spans.
fn draw_highlights(pixmap: &mut Pixmap, spans: &[Span], x: f32, baseline: f32) {
    let mut pen = x;
    for run in spans.chunk_by(|a, b| a.highlight == b.highlight) {
        let run_width = width(run);
        if let (Some(color), Some(size)) = (
            run[0].highlight,
            run.iter().map(|s| s.size).reduce(f32::max),
        ) {
            let pad = 0.09 * size;
            let area = [
                pen - pad,
                baseline - 0.96 * size,
                run_width + 2.0 * pad,
                1.34 * size,
            ];
            fill_rounded(pixmap, area, 0.2 * size, color);
        }
        pen += run_width;
    }
}

/// Fills a rectangle `[x, y, width, height]` with rounded corners.
pub(super) fn fill_rounded(pixmap: &mut Pixmap, area: [f32; 4], radius: f32, color: [u8; 3]) {
    let [x, y, w, h] = area;
    let r = radius.min(w / 2.0).min(h / 2.0).max(0.0);
    let mut path = PathBuilder::new();
    let (right, bottom) = (x + w, y + h);
    path.move_to(x + r, y);
    path.line_to(right - r, y);
    path.quad_to(right, y, right, y + r);
    path.line_to(right, bottom - r);
    path.quad_to(right, bottom, right - r, bottom);
    path.line_to(x + r, bottom);
    path.quad_to(x, bottom, x, bottom - r);
    path.line_to(x, y + r);
    path.quad_to(x, y, x + r, y);
    path.close();
    if let Some(path) = path.finish() {
        pixmap.fill_path(
            &path,
            &paint(color),
            FillRule::Winding,
            Transform::identity(),
            None,
        );
    }
}

/// Solid ink.
pub(super) fn paint(color: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(Color::from_rgba8(color[0], color[1], color[2], 255));
    paint.anti_alias = true;
    paint
}

/// Calls `each(font, glyph, pen after it)` for the characters of a text, kerned.
fn place(
    text: &str,
    face: Face,
    size: f32,
    mut each: impl FnMut(&ttf_parser::Face<'static>, GlyphId, f32),
) {
    let Some(font) = face.font() else { return };
    let scale = size / f32::from(font.units_per_em());
    let mut pen = 0i32;
    let mut glyphs = text
        .chars()
        .map(|c| font.glyph_index(c).unwrap_or_default())
        .peekable();
    while let Some(glyph) = glyphs.next() {
        pen += i32::from(font.glyph_hor_advance(glyph).unwrap_or(0));
        if let Some(&next) = glyphs.peek() {
            pen += kerning(font, glyph, next);
        }
        each(font, glyph, pen as f32 * scale);
    }
}

/// The change of a glyph's advance before another, in font units (OpenType GPOS pair adjustment; first match wins).
fn kerning(font: &ttf_parser::Face, left: GlyphId, right: GlyphId) -> i32 {
    let Some(gpos) = font.tables().gpos else {
        return 0;
    };
    for lookup in gpos.lookups {
        for subtable in lookup.subtables.into_iter::<PositioningSubtable>() {
            let PositioningSubtable::Pair(pair) = subtable else {
                continue;
            };
            let Some(index) = pair.coverage().get(left) else {
                continue;
            };
            let found = match pair {
                PairAdjustment::Format1 { sets, .. } => sets.get(index).and_then(|s| s.get(right)),
                PairAdjustment::Format2 {
                    classes, matrix, ..
                } => matrix.get((classes.0.get(left), classes.1.get(right))),
            };
            if let Some((first, _)) = found {
                return i32::from(first.x_advance);
            }
        }
    }
    0
}

/// Glyph outlines, y up in font units, as path segments, y down in pixels.
struct Outline {
    builder: PathBuilder,
    x: f32,
    y: f32,
    scale: f32,
}

impl Outline {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + x * self.scale, self.y - y * self.scale)
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.builder.move_to(x, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.builder.line_to(x, y);
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.builder.quad_to(x1, y1, x, y);
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.builder.cubic_to(x1, y1, x2, y2, x, y);
    }
    fn close(&mut self) {
        self.builder.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_of_the_figures_is_in_every_face() {
        let needed =
            "ABCXYZabcxyz0123456789.,:;()[]+-−×·=≤≥≈≠Σ∑∞→←°%‰µäöüßéñαβγηθλπσω₀₁₂⁰⁷⁻n–—…“”‘’";
        for face in [Face::Regular, Face::SemiBold, Face::Italic] {
            let font = face.font().expect("the embedded font parses");
            for c in needed.chars() {
                assert!(font.glyph_index(c).is_some(), "{c} is missing in {face:?}");
            }
        }
    }

    #[test]
    fn widths_scale_with_the_size_and_kerning_closes_av() {
        let at = |text, size| measure(text, Face::Regular, size);
        assert!((at("rastray", 40.0) - 2.0 * at("rastray", 20.0)).abs() < 1e-3);
        assert!(at("AV", 100.0) < at("A", 100.0) + at("V", 100.0));
        assert_eq!(at("", 20.0), 0.0);
    }

    #[test]
    fn ink_stays_between_its_edges() {
        let mut pixmap = Pixmap::new(200, 60).unwrap();
        let span = Span::new("Hig", Face::SemiBold, 30.0, [10, 20, 30]);
        let end = draw(&mut pixmap, std::slice::from_ref(&span), 20.0, 40.0);
        assert_eq!(end, 20.0 + span.width());
        let inked: Vec<(u32, u32)> = (0..200 * 60)
            .map(|i| (i % 200, i / 200))
            .filter(|&(x, y)| pixmap.pixel(x, y).is_some_and(|p| p.alpha() > 0))
            .collect();
        assert!(!inked.is_empty());
        assert!(inked.iter().all(|&(x, _)| x >= 20 && (x as f32) < end));
        // The g goes below the baseline, the H reaches about 0.73 em above it.
        let (top, bottom) = (inked[0].1, inked[inked.len() - 1].1);
        assert!(
            (16..=20).contains(&top) && (44..=48).contains(&bottom),
            "{top} {bottom}"
        );
    }

    #[test]
    fn an_unknown_character_is_a_box_not_a_panic() {
        assert!(measure("\u{4e2d}\u{1F4A1}", Face::Regular, 20.0) > 10.0);
    }
}
