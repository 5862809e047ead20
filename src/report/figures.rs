//! Figures: labelled strips, difference maps with their legend, the equation growing term by term, contact sheets.
//!
//! In: pictures and captions. Out: pictures, to be written with [`super::formats::png_of_picture`]. Pictures keep their
//! pixels, except in overviews ([`buildup`], and [`strip`] above 1600 pixels a picture), where whole
//! blocks of pixels are averaged. Colours are magma and blue, white, orange only.

use crate::error::Error;

use super::causes::NOT_MODELLED;
use super::equation::{Form, Script, Term, pieces, runs};
use super::layout::{Cell, Chunk, GREY, INK, MARK, copy, grid, opaque, paper, room, words};
use super::picture::Picture;
use super::text::{self, Face, Span};

/// A picture with its caption.
#[derive(Clone, Copy, Debug)]
pub struct Panel<'a> {
    /// The picture; a legend is drawn beside it where it has a scale.
    pub picture: &'a Picture,
    /// What it is, in a few words.
    pub title: &'a str,
    /// What to see in it, in a sentence; may be empty.
    pub note: &'a str,
}

/// Widest picture that a strip shows pixel for pixel.
const STRIP_WIDTH: usize = 1600;
/// Width that pictures of the build-up come near to.
const BUILDUP_WIDTH: usize = 480;

/// Em size of titles for pictures of a width: a figure of three reads well at a third of its size.
fn unit_for(width: usize) -> f32 {
    (width as f32 / 24.0).round().clamp(14.0, 40.0)
}

/// Pictures side by side, such as raster | trace | difference, each with its caption below.
pub fn strip(panels: &[Panel]) -> Result<Picture, Error> {
    let small: Vec<Picture> = panels
        .iter()
        .map(|p| p.picture.reduced(p.picture.width.div_ceil(STRIP_WIDTH)))
        .collect();
    let widest = small.iter().map(|p| p.width).max().unwrap_or(0);
    let unit = unit_for(widest);
    let cells: Vec<Cell> = small
        .iter()
        .zip(panels)
        .map(|(picture, p)| captioned(picture, p.title, p.note, unit))
        .collect();
    grid(&cells, cells.len(), unit)
}

/// One picture, pixel for pixel, with its legend and caption: the form of difference maps.
pub fn map(panel: Panel) -> Result<Picture, Error> {
    let unit = unit_for(panel.picture.width);
    grid(
        &[captioned(panel.picture, panel.title, panel.note, unit)],
        1,
        unit,
    )
}

/// Two pictures side by side as one, with a little paper between them; the second is cut to the height of the first.
pub fn pair(left: &Picture, right: &Picture) -> Picture {
    let gap = (left.width / 48).max(1);
    let rows = left.pixels.chunks_exact(left.width.max(1));
    let others = right.pixels.chunks_exact(right.width.max(1));
    let mut pixels = Vec::new();
    for (a, b) in rows.zip(others) {
        pixels.extend_from_slice(a);
        pixels.extend(std::iter::repeat_n([255; 3], gap));
        pixels.extend_from_slice(b);
    }
    Picture {
        width: left.width + gap + right.width,
        height: left.height.min(right.height),
        pixels,
        scale: None,
    }
}

/// Groups of pictures below each other, each with its heading and `columns` pictures to a row.
pub fn contact_sheet(groups: &[(&str, Vec<Panel>)], columns: usize) -> Result<Picture, Error> {
    let pictures = || groups.iter().flat_map(|(_, panels)| panels);
    let unit = unit_for(pictures().map(|p| p.picture.width).max().unwrap_or(0));
    let mut rows = Vec::new();
    for (heading, panels) in groups {
        let cells: Vec<Cell> = panels
            .iter()
            .map(|p| captioned(p.picture, p.title, p.note, unit))
            .collect();
        rows.push((*heading, grid(&cells, columns, unit)?));
    }
    stacked(&rows, unit)
}

/// Pictures below each other with their headings, if they have one.
fn stacked(rows: &[(&str, Picture)], unit: f32) -> Result<Picture, Error> {
    let room = |heading: &str| match heading {
        "" => 0,
        _ => (2.0 * unit) as usize,
    };
    let width = rows.iter().map(|(_, p)| p.width).max().unwrap_or(1);
    let height = rows.iter().map(|(h, p)| room(h) + p.height).sum::<usize>();
    let mut sheet = paper(width, height.max(1))?;
    let mut y = 0;
    for (heading, picture) in rows {
        let title = Span::new(*heading, Face::SemiBold, 1.4 * unit, INK);
        text::draw(&mut sheet, &[title], 1.1 * unit, y as f32 + 1.7 * unit);
        y += room(heading);
        copy(&mut sheet, picture, 0, y);
        y += picture.height;
    }
    Ok(opaque(&sheet))
}

/// The equation growing: four steps to a row, each picture under the equation as far as it goes, the new term marked.
///
/// With the seven steps of the full equation, the first row is what the rasterizer computes, and the second what only
/// the tracer knows.
pub fn buildup(steps: &[(Term, &Picture)], form: Form) -> Result<Picture, Error> {
    let small: Vec<Picture> = steps
        .iter()
        .map(|(_, p)| p.near_width(BUILDUP_WIDTH))
        .collect();
    let widest = small.iter().map(|p| p.width).max().unwrap_or(0);
    let unit = (widest as f32 / 20.0).round().clamp(14.0, 24.0);
    let mut cells: Vec<Cell> = steps
        .iter()
        .zip(&small)
        .map(|((term, _), picture)| Cell {
            above: vec![heading(*term, unit), equation(form, *term, 0.84 * unit)],
            picture: Some(picture),
            below: Vec::new(),
        })
        .collect();
    if cells.len() % 4 == 3 {
        cells.push(buildup_note(unit));
    }
    grid(&cells, 4, unit)
}

/// What the empty place of the build-up says.
fn buildup_note(unit: f32) -> Cell<'static> {
    let text = |t: &str| words(t, Face::Regular, 0.84 * unit, GREY);
    let title = |t: &str| words(t, Face::SemiBold, 0.84 * unit, INK);
    Cell {
        below: vec![
            title("First row: local"),
            text("A surface and its lights. The rasterizer computes exactly these terms."),
            room(0.5 * unit),
            title("Second row: global"),
            text("Terms that need other surfaces. Only the tracer has them."),
            room(0.5 * unit),
            text(NOT_MODELLED),
        ],
        ..Cell::default()
    }
}

/// A picture with a title and a note below.
fn captioned<'a>(picture: &'a Picture, title: &str, note: &str, unit: f32) -> Cell<'a> {
    Cell {
        above: Vec::new(),
        picture: Some(picture),
        below: vec![
            words(title, Face::SemiBold, unit, INK),
            words(note, Face::Regular, 0.78 * unit, GREY),
        ],
    }
}

/// "+ S specular": how the term joins, and its name.
fn heading(term: Term, size: f32) -> Vec<Chunk> {
    let label = term.label();
    let (base, sub) = label.split_once('_').unwrap_or((label, ""));
    let bold = |text: &str, script| Span {
        script,
        ..Span::new(text, Face::SemiBold, size, INK)
    };
    vec![vec![
        bold(base, Script::Base),
        bold(sub, Script::Sub),
        Span::new(
            format!("  {}", term.name()),
            Face::Regular,
            0.84 * size,
            GREY,
        ),
    ]]
}

/// The equation up to a term, which is dark and marked, while the others stand back; a chunk a summand.
fn equation(form: Form, last: Term, size: f32) -> Vec<Chunk> {
    let pieces = pieces(form, last);
    let mut chunks: Vec<Chunk> = Vec::new();
    for (new, run) in runs(&pieces, true, |p| (p.term == Some(last)).then_some(MARK)) {
        for piece in run {
            let color = if new.is_some() { INK } else { GREY };
            let span = Span {
                highlight: new,
                ..Span::of_piece(piece, size, color)
            };
            match chunks.last_mut() {
                Some(chunk) if !piece.breaks => chunk.push(span),
                _ => chunks.push(vec![span]),
            }
        }
    }
    chunks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gl::SpecularModel;
    use rastray_compare::{Reduction, signed_map};

    const FORM: Form = Form {
        specular: SpecularModel::Reflection,
        mirror_is_specular: true,
    };

    fn flat(width: usize, height: usize, color: [u8; 3]) -> Picture {
        Picture {
            width,
            height,
            pixels: vec![color; width * height],
            scale: None,
        }
    }

    /// How often a colour occurs.
    fn count(picture: &Picture, color: [u8; 3]) -> usize {
        picture.pixels.iter().filter(|p| **p == color).count()
    }

    #[test]
    fn a_strip_holds_all_its_pictures_and_paper_at_its_rim() {
        let (a, b) = (flat(300, 200, [1, 2, 3]), flat(300, 200, [9, 8, 7]));
        let panel = |picture, title| Panel {
            picture,
            title,
            note: "a note",
        };
        let figure = strip(&[panel(&a, "raster"), panel(&b, "trace")]).unwrap();
        assert_eq!(count(&figure, [1, 2, 3]), 300 * 200);
        assert_eq!(count(&figure, [9, 8, 7]), 300 * 200);
        assert!(figure.pixels[..figure.width].iter().all(|p| *p == [255; 3]));
        assert!(figure.width > 600 && figure.height > 200);
    }

    #[test]
    fn a_map_keeps_its_pixels_and_shows_both_ends_of_its_scale() {
        let d: Vec<[f64; 3]> = (0..300 * 200)
            .map(|i| [f64::from(i % 300) / 300.0 - 0.5; 3])
            .collect();
        let map_picture = Picture::from_map(&signed_map(300, 200, &d, Reduction::Largest).unwrap());
        let panel = Panel {
            picture: &map_picture,
            title: "difference",
            note: "trace − raster",
        };
        let figure = map(panel).unwrap();
        let unit = unit_for(300);
        let margin = (1.1 * unit).round() as usize;
        for (i, pixel) in map_picture.pixels.iter().enumerate() {
            let at = (margin + i / 300) * figure.width + margin + i % 300;
            assert_eq!(figure.pixels[at], *pixel);
        }
        let scale = map_picture.scale.unwrap();
        assert_eq!(scale.max, 0.5);
        // The bar's last rows have the colour of the end within one step.
        let dark = scale.color(-0.5 * (1.0 - 0.5 / 100.0));
        assert!(
            figure
                .pixels
                .iter()
                .any(|p| (0..3).all(|c| p[c].abs_diff(dark[c]) <= 2))
        );
    }

    #[test]
    fn the_build_up_marks_only_what_is_new() {
        for term in Term::ALL {
            let spans: Vec<Span> = equation(FORM, term, 20.0).into_iter().flatten().collect();
            let marked: String = spans
                .iter()
                .filter(|s| s.highlight.is_some())
                .map(|s| s.text.as_str())
                .collect();
            let expected = match term {
                Term::Emission => "IE",
                Term::Ambient => "+ KA IAL",
                Term::Diffuse => "+ ΣL KD (N·L) IL",
                Term::Specular => "(+ KS (V·R)n)",
                Term::Shadow => "SL",
                Term::Reflection => "+ KS IR",
                Term::Refraction => "+ KT IT",
            };
            assert_eq!(marked, expected);
        }
    }

    #[test]
    fn the_build_up_has_seven_pictures() {
        let pictures: Vec<Picture> = (0..7).map(|i| flat(240, 160, [i, 100, 200])).collect();
        let steps: Vec<(Term, &Picture)> = Term::ALL.into_iter().zip(&pictures).collect();
        let figure = buildup(&steps, FORM).unwrap();
        for i in 0..7 {
            assert_eq!(count(&figure, [i, 100, 200]), (2 * 240) * (2 * 160));
        }
        assert!(count(&figure, MARK) > 100);
    }

    #[test]
    fn a_contact_sheet_holds_every_pair_of_every_group() {
        let (a, b) = (flat(30, 20, [1, 2, 3]), flat(30, 20, [9, 8, 7]));
        let both = pair(&a, &b);
        assert_eq!(
            (both.width, both.height, both.pixels.len()),
            (61, 20, 61 * 20)
        );
        assert_eq!(both.pixels[29..32], [[1, 2, 3], [255; 3], [9, 8, 7]]);
        let panel = Panel {
            picture: &both,
            title: "a scene",
            note: "",
        };
        let groups = [("", vec![panel; 2]), ("lecture", vec![panel; 5])];
        let sheet = contact_sheet(&groups, 3).unwrap();
        assert_eq!(count(&sheet, [1, 2, 3]), 7 * 30 * 20);
        assert_eq!(count(&sheet, [9, 8, 7]), 7 * 30 * 20);
        let plain = contact_sheet(&[("", vec![panel; 2]), ("", vec![panel; 5])], 3).unwrap();
        assert!(sheet.height > plain.height && sheet.width == plain.width);
    }

    #[test]
    fn no_pictures_make_an_empty_figure_not_a_panic() {
        assert!(strip(&[]).is_ok());
        assert!(buildup(&[], FORM).is_ok());
        assert!(contact_sheet(&[], 0).is_ok());
        assert!(contact_sheet(&[("", Vec::new())], 0).is_ok());
    }
}
