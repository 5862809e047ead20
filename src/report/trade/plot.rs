//! Plots of lines, dots and words, described once and drawn twice: as SVG, whose colours follow the page, and as pixels.
//!
//! Coordinates are in pixels of the plot, y down. An [`Ink`] is a role, not a colour: on a page it is a variable of the style
//! sheet, in a file of its own a class with a light and a dark colour, in a PNG the light one. Series differ in
//! shape as well as in colour (blue, orange, grey), so that they can be told apart without seeing colours.

use std::fmt::Write as _;

use maud::{Escaper, html};
use tiny_skia::{FillRule, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

use crate::error::Error;
use crate::report::layout::{opaque, paper};
use crate::report::picture::Picture;
use crate::report::text::{self, Face, Span};

/// What something is drawn for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ink {
    /// Words and axes.
    Text,
    /// What stands back.
    Grey,
    /// Rules of the grid.
    Line,
    /// First series.
    First,
    /// Second series.
    Second,
    /// What is covered by something in front.
    Paper,
}

impl Ink {
    /// Name in the style sheet, colour on white, colour on black.
    const ALL: [(Self, &'static str, [u8; 3], [u8; 3]); 6] = [
        (Self::Text, "ink", [0x1b, 0x1f, 0x24], [0xe9, 0xeb, 0xee]),
        (Self::Grey, "grey", [0x59, 0x62, 0x6d], [0xa4, 0xac, 0xb6]),
        (Self::Line, "line", [0xe1, 0xe5, 0xe9], [0x2d, 0x33, 0x3a]),
        (Self::First, "local", [0x03, 0x64, 0xb4], [0x80, 0xbc, 0xfe]),
        (
            Self::Second,
            "global",
            [0x96, 0x4c, 0x04],
            [0xfa, 0x9e, 0x5d],
        ),
        (Self::Paper, "paper", [0xff, 0xff, 0xff], [0x14, 0x17, 0x1b]),
    ];

    fn entry(self) -> (Self, &'static str, [u8; 3], [u8; 3]) {
        Self::ALL[self as usize]
    }

    /// `var(--local)`: the page's own colour.
    fn variable(self) -> String {
        format!("var(--{})", self.entry().1)
    }
}

/// The form of a dot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    Circle,
    Square,
    Diamond,
}

/// Where text stands beside its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Something drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Mark {
    Line {
        points: Vec<[f32; 2]>,
        ink: Ink,
        width: f32,
        dashed: bool,
    },
    Dot {
        at: [f32; 2],
        shape: Shape,
        ink: Ink,
        radius: f32,
        filled: bool,
        /// What a pointer over it is told.
        title: String,
    },
    Text(Words),
}

/// Words at a place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Words {
    pub(super) at: [f32; 2],
    pub(super) text: String,
    pub(super) ink: Ink,
    pub(super) size: f32,
    pub(super) anchor: Anchor,
    /// A quarter turn to the left.
    pub(super) upright: bool,
}

/// A plot.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plot {
    pub(super) width: f32,
    pub(super) height: f32,
    /// What it shows, for those who cannot see it.
    pub(super) description: String,
    pub(super) marks: Vec<Mark>,
}

impl Shape {
    /// Corners around a place; none for the circle.
    fn corners(self, [x, y]: [f32; 2], r: f32) -> Vec<[f32; 2]> {
        match self {
            Self::Circle => Vec::new(),
            Self::Square => {
                let r = 0.88 * r;
                vec![
                    [x - r, y - r],
                    [x + r, y - r],
                    [x + r, y + r],
                    [x - r, y + r],
                ]
            }
            Self::Diamond => {
                let r = 1.25 * r;
                vec![[x, y - r], [x + r, y], [x, y + r], [x - r, y]]
            }
        }
    }
}

impl Plot {
    /// SVG for inside a page: colours are the page's variables.
    pub(super) fn inline(&self) -> String {
        self.svg("")
    }

    /// SVG as a file of its own: light or dark with the reader's system.
    pub(super) fn file(&self) -> String {
        let sheet = |dark: bool| -> String {
            let color = |(_, name, light, night): &(Ink, &str, [u8; 3], [u8; 3])| {
                let [r, g, b] = if dark { night } else { light };
                format!("--{name}:#{r:02x}{g:02x}{b:02x};")
            };
            Ink::ALL.iter().map(color).collect()
        };
        let style = format!(
            "<style>svg{{{}background:var(--paper);font-family:Inter,system-ui,sans-serif}}@media(prefers-color-scheme:dark){{svg{{{}}}}}</style>",
            sheet(false),
            sheet(true)
        );
        self.svg(&style)
    }

    fn svg(&self, style: &str) -> String {
        let (w, h) = (self.width, self.height);
        let label = escaped(&self.description);
        let elements: String = self.marks.iter().map(element).collect();
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" role=\"img\" aria-label=\"{label}\">{style}{elements}</svg>"
        )
    }

    /// Pixels, `scale` to a unit, on white.
    ///
    /// # Errors
    /// [`Error::Limit`] where it would be too large.
    pub(super) fn picture(&self, scale: f32) -> Result<Picture, Error> {
        let whole = |x: f32| (x * scale).ceil() as usize;
        let mut pixmap = paper(whole(self.width), whole(self.height))?;
        for mark in &self.marks {
            draw(&mut pixmap, mark, scale);
        }
        Ok(opaque(&pixmap))
    }
}

/// A mark as an element of SVG.
fn element(mark: &Mark) -> String {
    match mark {
        Mark::Line {
            points,
            ink,
            width,
            dashed,
        } => {
            let dash = if *dashed {
                " stroke-dasharray=\"5 4\""
            } else {
                ""
            };
            let (points, ink) = (places(points), ink.variable());
            format!(
                "<polyline points=\"{points}\" fill=\"none\" stroke=\"{ink}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"{dash}/>"
            )
        }
        Mark::Dot {
            at: [x, y],
            shape,
            ink,
            radius,
            filled,
            title,
        } => {
            let fill = if *filled { *ink } else { Ink::Paper }.variable();
            let corners = shape.corners([*x, *y], *radius);
            let (name, form) = if corners.is_empty() {
                (
                    "circle",
                    format!("cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\""),
                )
            } else {
                ("polygon", format!("points=\"{}\"", places(&corners)))
            };
            let (ink, title) = (ink.variable(), escaped(title));
            format!(
                "<{name} {form} fill=\"{fill}\" stroke=\"{ink}\" stroke-width=\"1.4\"><title>{title}</title></{name}>"
            )
        }
        Mark::Text(words) => words.element(),
    }
}

impl Words {
    fn element(&self) -> String {
        let [x, y] = self.at;
        let anchor = match self.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let turn = if self.upright {
            format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"")
        } else {
            String::new()
        };
        let (size, ink, text) = (self.size, self.ink.variable(), escaped(&self.text));
        format!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{ink}\"{turn}>{text}</text>"
        )
    }

    fn draw(&self, pixmap: &mut Pixmap, scale: f32) {
        let span = Span::new(
            self.text.as_str(),
            Face::Regular,
            self.size * scale,
            self.ink.entry().2,
        );
        let back = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * span.width(),
            Anchor::End => span.width(),
        };
        let [x, y] = self.at.map(|v| v * scale);
        if self.upright {
            write_upright(pixmap, &span, x, y + back);
        } else {
            text::draw(pixmap, &[span], x - back, y);
        }
    }
}

/// Text as SVG holds it.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    // Writing to a String never fails.
    let _ = Escaper::new(&mut out).write_str(text);
    out
}

fn places(points: &[[f32; 2]]) -> String {
    let texts: Vec<String> = points
        .iter()
        .map(|[x, y]| format!("{x:.1},{y:.1}"))
        .collect();
    texts.join(" ")
}

/// Draws a mark on a pixmap.
fn draw(pixmap: &mut Pixmap, mark: &Mark, scale: f32) {
    let whole = Transform::identity();
    match mark {
        Mark::Line {
            points,
            ink,
            width,
            dashed,
        } => {
            let pattern = StrokeDash::new(vec![5.0 * scale, 4.0 * scale], 0.0);
            let stroke = Stroke {
                width: width * scale,
                dash: pattern.filter(|_| *dashed),
                ..Stroke::default()
            };
            if let Some(path) = outline(points, scale, false) {
                pixmap.stroke_path(&path, &text::paint(ink.entry().2), &stroke, whole, None);
            }
        }
        Mark::Dot {
            at: [x, y],
            shape,
            ink,
            radius,
            filled,
            ..
        } => {
            let corners = shape.corners([*x, *y], *radius);
            let path = if corners.is_empty() {
                PathBuilder::from_circle(x * scale, y * scale, radius * scale)
            } else {
                outline(&corners, scale, true)
            };
            let stroke = Stroke {
                width: 1.4 * scale,
                ..Stroke::default()
            };
            if let Some(path) = path {
                let inside = if *filled { *ink } else { Ink::Paper };
                let paint = text::paint(inside.entry().2);
                pixmap.fill_path(&path, &paint, FillRule::Winding, whole, None);
                pixmap.stroke_path(&path, &text::paint(ink.entry().2), &stroke, whole, None);
            }
        }
        Mark::Text(words) => words.draw(pixmap, scale),
    }
}

/// A path through points; none through fewer than two.
fn outline(points: &[[f32; 2]], scale: f32, close: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (i, [x, y]) in points.iter().enumerate() {
        if i == 0 {
            path.move_to(x * scale, y * scale);
        } else {
            path.line_to(x * scale, y * scale);
        }
    }
    if close {
        path.close();
    }
    path.finish()
}

/// Text that runs upwards from a place: set on paper of its own, then turned.
fn write_upright(pixmap: &mut Pixmap, span: &Span, x: f32, y: f32) {
    let (w, h) = (
        span.width().ceil() as usize + 2,
        (1.4 * span.size).ceil() as usize,
    );
    let Ok(mut line) = paper(w, h) else {
        return;
    };
    text::draw(&mut line, std::slice::from_ref(span), 0.0, 0.75 * h as f32);
    let left = (x - 0.75 * h as f32) as i32;
    // (column, row) of the line lies at (left + row, y - column).
    let turn = Transform::from_row(0.0, -1.0, 1.0, 0.0, left as f32, y);
    let paint = tiny_skia::PixmapPaint {
        blend_mode: tiny_skia::BlendMode::Multiply,
        ..tiny_skia::PixmapPaint::default()
    };
    pixmap.draw_pixmap(0, 0, line.as_ref(), &paint, turn, None);
}

/// An axis on doubly logarithmic paper: values to pixels, and ticks at powers of ten.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LogScale {
    /// Decimal logarithms of the ends.
    pub(super) low: f64,
    pub(super) high: f64,
    /// Their pixels.
    pub(super) from: f32,
    pub(super) to: f32,
}

impl LogScale {
    /// Around some values, with a little room; a decade at least. Values that are not positive and finite do not count.
    pub(super) fn around(values: impl Iterator<Item = f64>, from: f32, to: f32) -> Self {
        let logs = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
        let (low, high) = if low <= high {
            (low, high)
        } else {
            (-1.0, 0.0)
        };
        let room = (0.06 * (high - low))
            .max((1.0 - (high - low)) / 2.0)
            .max(0.06);
        Self {
            low: low - room,
            high: high + room,
            from,
            to,
        }
    }

    /// The pixel of a value, limited to the scale.
    pub(super) fn place(&self, value: f64) -> f32 {
        let part = (value.log10() - self.low) / (self.high - self.low);
        self.from + (self.to - self.from) * part.clamp(0.0, 1.0) as f32
    }

    /// Powers of ten on the scale, every second or third where there are many.
    pub(super) fn decades(&self) -> Vec<i32> {
        let (first, last) = (self.low.ceil() as i32, self.high.floor() as i32);
        let step = ((last - first) / 9 + 1).max(1);
        (first..=last).filter(|d| d.rem_euclid(step) == 0).collect()
    }

    /// Fine ticks (1, 2, 5 times a power of ten) where there are fewer than three decades.
    pub(super) fn ticks(&self) -> Vec<f64> {
        let decades = self.decades();
        if decades.len() > 3 {
            return decades.iter().map(|d| 10f64.powi(*d)).collect();
        }
        let (first, last) = (self.low.floor() as i32, self.high.ceil() as i32);
        let fine = (first..=last).flat_map(|d| [1.0, 2.0, 5.0].map(|m| m * 10f64.powi(d)));
        fine.filter(|v| (self.low..=self.high).contains(&v.log10()))
            .collect()
    }
}

/// The plot as part of a page.
pub(super) fn figure(plot: &Plot) -> maud::Markup {
    html! { div.plot { (maud::PreEscaped(plot.inline())) } }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Plot {
        Plot {
            width: 120.0,
            height: 80.0,
            description: "a < b".into(),
            marks: vec![
                Mark::Line {
                    points: vec![[0.0, 0.0], [100.0, 60.0]],
                    ink: Ink::Second,
                    width: 2.0,
                    dashed: true,
                },
                Mark::Dot {
                    at: [60.0, 40.0],
                    shape: Shape::Square,
                    ink: Ink::First,
                    radius: 5.0,
                    filled: true,
                    title: "x & y".into(),
                },
                Mark::Text(Words {
                    at: [10.0, 60.0],
                    text: "error".into(),
                    ink: Ink::Text,
                    size: 12.0,
                    anchor: Anchor::Middle,
                    upright: true,
                }),
            ],
        }
    }

    #[test]
    fn svg_is_escaped_and_follows_the_page() {
        let inline = example().inline();
        assert!(inline.contains("aria-label=\"a &lt; b\"") && inline.contains("x &amp; y"));
        assert!(inline.contains("var(--local)") && !inline.contains("<style"));
        assert!(example().file().contains("prefers-color-scheme:dark"));
    }

    #[test]
    fn pixels_show_the_marks() {
        let picture = example().picture(2.0).expect("small");
        assert_eq!((picture.width, picture.height), (240, 160));
        let at = |x: usize, y: usize| picture.pixels[y * 240 + x];
        assert_eq!(at(120, 80), Ink::First.entry().2);
        // Upright text stands left of its place, along it.
        let dark = |p: &[u8; 3]| p[0] < 100;
        let near = (0..160).any(|y| (0..28).any(|x| dark(&at(x, y))));
        assert!(near);
    }

    #[test]
    fn scales_hold_their_values() {
        let scale = LogScale::around([1e-3, 1.0, 0.0, f64::INFINITY].into_iter(), 0.0, 100.0);
        assert!(scale.place(1e-3) > 0.0 && scale.place(1.0) < 100.0);
        assert!(scale.place(0.0) == 0.0 && scale.decades() == [-3, -2, -1, 0]);
        let narrow = LogScale::around([2.0].into_iter(), 0.0, 100.0);
        assert_eq!(narrow.place(2.0), 50.0);
        assert!(narrow.ticks().contains(&2.0));
        let many = LogScale::around([1e-16, 1.0].into_iter(), 0.0, 1.0);
        assert!(many.decades().len() <= 10);
    }
}
