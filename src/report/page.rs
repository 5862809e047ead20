//! `index.html`: a comparison on one self-contained page.
//!
//! In: one [`Report`]. Out: HTML that needs no other file: pictures and type are embedded, there is no script, and
//! light or dark follows the reader's system. Headings are nested, tables have headers, and every picture has an
//! alternative text with its numbers. Legends are drawn by the page itself, so maps appear pixel for pixel without a frame.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use rastray_compare::{Map, Scale, ScaleKind};

use crate::error::{Error, Note};
use crate::frame::Plane;

use super::equation::{Form, Piece, Script, Term, pieces, plain, runs};
use super::files::View;
use super::formats::{png, png_of_picture};
use super::numbers::{count, percent, tick, value};
use super::picture::Picture;
use super::summary::Summary;
use super::{sections, text};

/// A comparison of one scene, with everything that the page and the files beside it show.
#[derive(Clone, Debug)]
pub struct Report {
    /// The scene's name.
    pub title: String,
    /// The command line that made it.
    pub command: String,
    /// How the scene's model writes the equation.
    pub form: Form,
    /// How linear values are shown.
    pub view: View,
    /// The rasterizer's picture, rung 0.
    pub raster: Plane<[f32; 3]>,
    /// The tracer's picture, rung 9.
    pub trace: Plane<[f32; 3]>,
    /// Trace minus raster, signed.
    pub difference: Map,
    /// Magnitude of the same, in false colours.
    pub error: Map,
    /// One signed map for each of `summary.causes`, in the same order.
    pub cause_maps: Vec<Map>,
    /// The layers of the traced picture, such as `diffuse.key`, in the order of their sum.
    pub terms: Vec<NamedPlane>,
    /// The picture as far as each term of the equation, in order.
    pub buildup: Vec<(Term, Plane<[f32; 3]>)>,
    /// Every number.
    pub summary: Summary,
    /// What the importer dropped, invented or doubted.
    pub notes: Vec<Note>,
    /// What was rendered how: option and value, as on the command line.
    pub settings: Vec<(String, String)>,
}

/// A plane of linear values with its name.
#[derive(Clone, Debug)]
pub struct NamedPlane {
    /// Such as `specular.key`.
    pub name: String,
    /// Its values.
    pub plane: Plane<[f32; 3]>,
}

impl NamedPlane {
    /// The largest magnitude of a value.
    fn largest(&self) -> f32 {
        let values = self.plane.data.as_flattened().iter();
        values.fold(0.0, |m: f32, v| m.max(v.abs()))
    }
}

/// Width that pictures of overviews come near to.
const OVERVIEW: usize = 480;

impl Report {
    /// The page.
    pub fn to_html(&self) -> Result<String, Error> {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="generator" content="rastray";
                    title { (self.title) " · rastray compare" }
                    style { (PreEscaped(style(include_str!("page.css")))) }
                }
                body {
                    header { (self.head()) }
                    main {
                        (self.pictures()?)
                        (sections::causes(self)?)
                        (self.growth()?)
                        (self.term_pictures()?)
                        (sections::agreement(&self.summary))
                        (sections::numbers(self)?)
                        (sections::work(&self.summary))
                        (sections::origin(self))
                    }
                    footer {
                        "Made by rastray " (env!("CARGO_PKG_VERSION")) ". Pictures show stored values as they are"
                        @if self.view == View::Srgb { ", through the sRGB view transform" }
                        "; maps are in sRGB. Type: Inter, SIL Open Font License 1.1."
                    }
                }
            }
        };
        Ok(page.into_string())
    }

    /// Pixels of the picture.
    pub(super) fn pixels(&self) -> usize {
        self.summary.size[0] * self.summary.size[1]
    }

    /// Title, result in one sentence, equation.
    fn head(&self) -> Markup {
        let [w, h] = self.summary.size;
        let whole = pieces(self.form, Term::Refraction);
        html! {
            p.kicker { "rastray compare · " (w) " × " (h) " pixels" }
            h1 { (self.title) }
            p.lead { (sections::verdict(self)) }
            div.equation {
                p.formula role="math" aria-label=(plain(&whole)) { (grouped(&whole)) }
                p.key {
                    span.local { "local" } " a surface and its lights: the rasterizer, exactly · "
                    span.global { "global" } " other surfaces too: only the tracer"
                }
            }
        }
    }

    /// Raster, trace, difference.
    fn pictures(&self) -> Result<Markup, Error> {
        let m = &self.summary.metrics;
        let differ = self.difference.summary.pixels;
        let share = percent(differ, self.pixels());
        let alt = format!(
            "Signed difference of the two pictures: {} pixels ({share}) differ, at most by {}",
            count(differ),
            value(m.max)
        );
        let mean = |p: &Plane<[f32; 3]>| format!("mean value {}", value(mean_value(p)));
        Ok(html! {
            section {
                h2 { "Two pictures of one scene" }
                div.grid.triple {
                    figure {
                        (linear_image(&self.raster, self.view, &format!("The rasterized picture, {}", mean(&self.raster)))?)
                        figcaption { strong { "raster" } "OpenGL's fixed-function lighting: every surface on its own." }
                    }
                    figure {
                        (linear_image(&self.trace, self.view, &format!("The ray traced picture, {}", mean(&self.trace)))?)
                        figcaption { strong { "trace" } "Whitted's ray tracing: shadows, mirrors and refraction." }
                    }
                    figure {
                        (map_picture(&self.difference, &alt)?)
                        figcaption {
                            strong { "difference" }
                            "trace − raster: orange where the traced picture is brighter, blue where it is darker."
                        }
                        (legend(&self.difference.scale))
                    }
                }
            }
        })
    }

    /// The equation growing.
    fn growth(&self) -> Result<Markup, Error> {
        let step = |(term, plane): &(Term, Plane<[f32; 3]>)| -> Result<Markup, Error> {
            let equation = pieces(self.form, *term);
            let alt = format!("The picture with {}", plain(&equation));
            Ok(html! {
                figure {
                    div.step {
                        strong { (label(*term)) span { (term.name()) } }
                        span.formula role="math" aria-label=(plain(&equation)) { (marked(&equation, *term)) }
                    }
                    (overview(plane, self.view, &alt)?)
                }
            })
        };
        let steps: Vec<Markup> = self.buildup.iter().map(step).collect::<Result<_, _>>()?;
        Ok(html! {
            @if !steps.is_empty() {
                section {
                    h2 { "The equation, growing" }
                    p {
                        "Up to specular, both renderers compute the same. S" sub { "L" } ", I" sub { "R" } " and I"
                        sub { "T" } " need other surfaces. " (super::causes::NOT_MODELLED)
                    }
                    div.grid.four { @for step in &steps { (step) } }
                }
            }
        })
    }

    /// The layers of the traced picture.
    fn term_pictures(&self) -> Result<Markup, Error> {
        let (shown, zero): (Vec<&NamedPlane>, Vec<&NamedPlane>) =
            self.terms.iter().partition(|term| term.largest() > 0.0);
        let pictures = shown.into_iter().map(|term| self.term_picture(term));
        let pictures: Vec<Markup> = pictures.collect::<Result<_, _>>()?;
        let zero: Vec<&str> = zero.iter().map(|term| term.name.as_str()).collect();
        Ok(html! {
            @if !self.terms.is_empty() {
                section {
                    h2 { "The terms of the traced picture" }
                    p {
                        "Their sum, in this order, is the unclamped picture. Shadows are already in diffuse and "
                        "specular. Values outside 0…1 are cut off here, not in " code { "layers.exr" } "."
                    }
                    div.grid.four { @for picture in &pictures { (picture) } }
                    @if !zero.is_empty() { p { "Zero everywhere: " (zero.join(", ")) "." } }
                }
            }
        })
    }

    fn term_picture(&self, term: &NamedPlane) -> Result<Markup, Error> {
        let largest = value(f64::from(term.largest()));
        let alt = format!("The term {}, largest value {largest}", term.name);
        Ok(html! {
            figure {
                (overview(&term.plane, self.view, &alt)?)
                figcaption { strong { (term.name) } "at most " (largest) }
            }
        })
    }
}

/// Colours on white paper; every text has at least 4.5 : 1 against what it stands on.
const LIGHT: &str = "--paper: #ffffff; --ink: #1b1f24; --grey: #59626d; --line: #e1e5e9; --tint: #f5f7f9; \
                     --local: #0364b4; --global: #964c04; --mark: #ffe0bd; --bar: #419efe;";
/// The same in the dark.
const DARK: &str = "--paper: #14171b; --ink: #e9ebee; --grey: #a4acb6; --line: #2d333a; --tint: #1c2126; \
                    --local: #80bcfe; --global: #fa9e5d; --mark: #5a3a16; --bar: #0581e6;";

/// A style sheet behind what all pages share: type, colours, the equation.
pub(super) fn style(own: &str) -> String {
    let sheet = [include_str!("base.css"), own].concat();
    sheet
        .replace("@REGULAR@", &BASE64.encode(text::REGULAR))
        .replace("@SEMIBOLD@", &BASE64.encode(text::SEMIBOLD))
        .replace("@ITALIC@", &BASE64.encode(text::ITALIC))
        .replace("@LIGHT@", LIGHT)
        .replace("@DARK@", DARK)
}

/// Mean of all values, rows top to bottom.
fn mean_value(plane: &Plane<[f32; 3]>) -> f64 {
    let values = plane.data.as_flattened();
    values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len().max(1) as f64
}

/// One piece as HTML. A line may break before a sign, not behind it.
pub(super) fn piece(p: &Piece) -> Markup {
    let inner = html! {
        @if p.variable { var { (p.text) } } @else if p.text == "+ " { "+\u{a0}" } @else { (p.text) }
    };
    match p.script {
        Script::Base => inner,
        Script::Sub => html! { sub { (inner) } },
        Script::Sup => html! { sup { (inner) } },
    }
}

/// The equation with local and global parts underlined; the signs between the summands stay plain.
pub(super) fn grouped(equation: &[Piece]) -> Markup {
    let class = |p: &Piece| {
        let global = p.term.map(Term::is_global);
        global.map(|global| if global { "global" } else { "local" })
    };
    html! {
        @for (class, run) in runs(equation, false, class) {
            @match class {
                Some(class) => span class={ "term " (class) } title=(names_of(run)) { @for p in run { (piece(p)) } },
                None => @for p in run { (piece(p)) },
            }
        }
    }
}

/// The names of the terms of a run, each once.
fn names_of(run: &[Piece]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for term in run.iter().filter_map(|p| p.term) {
        if !names.contains(&term.name()) {
            names.push(term.name());
        }
    }
    names.join(", ")
}

/// The equation with its last term marked.
fn marked(equation: &[Piece], last: Term) -> Markup {
    html! {
        @for (new, run) in runs(equation, true, |p| (p.term == Some(last)).then_some(())) {
            @if new.is_some() { span.new { @for p in run { (piece(p)) } } }
            @else { @for p in run { (piece(p)) } }
        }
    }
}

/// "+ I_R" with its subscript lowered.
pub(super) fn label(term: Term) -> Markup {
    let (base, sub) = term.label().split_once('_').unwrap_or((term.label(), ""));
    html! { (base) @if !sub.is_empty() { sub { (sub) } } }
}

/// A PNG inside the page.
pub(super) fn image(bytes: &[u8], width: usize, height: usize, alt: &str) -> Markup {
    let source = format!("data:image/png;base64,{}", BASE64.encode(bytes));
    let class = if width < 320 { "small" } else { "" };
    html! { img src=(source) width=(width) height=(height) alt=(alt) class=[(!class.is_empty()).then_some(class)]; }
}

/// A linear picture, all its pixels.
pub(super) fn linear_image(
    plane: &Plane<[f32; 3]>,
    view: View,
    alt: &str,
) -> Result<Markup, Error> {
    Ok(image(&png(plane, view)?, plane.width, plane.height, alt))
}

/// A linear picture, small.
fn overview(plane: &Plane<[f32; 3]>, view: View, alt: &str) -> Result<Markup, Error> {
    let small = Picture::from_linear(plane, view)?;
    let small = small.reduced(small.width.div_ceil(OVERVIEW));
    Ok(image(
        &png_of_picture(&small)?,
        small.width,
        small.height,
        alt,
    ))
}

/// A map without its legend.
pub(super) fn map_picture(map: &Map, alt: &str) -> Result<Markup, Error> {
    let bytes = png_of_picture(&Picture::from_map(map))?;
    Ok(image(&bytes, map.width, map.height, alt))
}

/// A scale as a bar with numbers.
pub(super) fn legend(scale: &Scale) -> Markup {
    let range = scale.max - scale.min();
    let colors: Vec<String> = (0..=24)
        .map(|i| scale.color(scale.min() + range * f64::from(i) / 24.0))
        .map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"))
        .collect();
    let signed = scale.kind == ScaleKind::Signed;
    let ends = if signed {
        "blue darker, white equal, orange brighter"
    } else {
        "black equal, light different"
    };
    html! {
        div.legend role="img" aria-label={ "Scale from " (tick(scale.min())) " to " (tick(scale.max)) ": " (ends) } {
            i style={ "background:linear-gradient(90deg," (colors.join(",")) ")" } {}
            div aria-hidden="true" {
                @for t in scale.ticks() {
                    span { @if signed && t > 0.0 { "+" } (tick(t)) }
                }
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::gl::SpecularModel;
    use crate::report::summary::tests::example as example_summary;
    use rastray_compare::{Reduction, magnitude_map, signed_map};

    /// 24 x 16 with a gradient; names that need escaping.
    pub(in crate::report) fn example() -> Report {
        let plane = |k: f32| Plane {
            width: 24,
            height: 16,
            data: (0..24 * 16)
                .map(|i| [i as f32 / 384.0 * k, 0.5 * k, 0.25])
                .collect(),
        };
        let d: Vec<[f64; 3]> = (0..24 * 16)
            .map(|i| [f64::from(i % 24 - 12) / 30.0; 3])
            .collect();
        let map = signed_map(24, 16, &d, Reduction::Largest).unwrap();
        Report {
            title: "glass & <mirror>".into(),
            command: "rastray compare 'a scene.toml' --size 24x16".into(),
            form: Form {
                specular: SpecularModel::HalfVector,
                mirror_is_specular: false,
            },
            view: View::Linear,
            raster: plane(0.5),
            trace: plane(1.0),
            difference: map.clone(),
            error: magnitude_map(24, 16, &vec![[0.25; 3]; 24 * 16], Reduction::Largest).unwrap(),
            cause_maps: vec![map; 9],
            terms: ["emission", "diffuse.a/b"]
                .map(|name| NamedPlane {
                    name: name.into(),
                    plane: plane(0.3),
                })
                .into(),
            buildup: Term::ALL.map(|t| (t, plane(0.2))).into(),
            summary: example_summary(),
            notes: vec![Note {
                place: None,
                message: "no camera: fitted one".into(),
            }],
            settings: vec![("--samples".into(), "1".into())],
        }
    }

    #[test]
    fn the_page_needs_nothing_else_and_escapes_what_it_is_given() {
        let html = example().to_html().unwrap();
        assert!(html.starts_with("<!DOCTYPE html><html lang=\"en\">"));
        assert!(html.contains("<h1>glass &amp; &lt;mirror&gt;</h1>"));
        assert!(!html.contains("http") && !html.contains("<script") && !html.contains("<link"));
        let sources = html
            .match_indices("src=\"")
            .map(|(i, _)| &html[i + 5..i + 30]);
        assert!(sources.clone().count() >= 3 + 8 + 7 + 2);
        assert!(
            sources
                .into_iter()
                .all(|s| s.starts_with("data:image/png;base64,iVB"))
        );
        assert!(
            !html.contains("base64,@"),
            "a face of the style sheet was not filled in"
        );
    }

    #[test]
    fn every_picture_has_words_and_every_table_headers() {
        let html = example().to_html().unwrap();
        let images = html.matches("<img ").count();
        assert_eq!(html.matches(" alt=\"").count(), images);
        assert!(!html.contains("alt=\"\""));
        assert_eq!(html.matches("<h1>").count(), 1);
        assert_eq!(
            html.matches("<tr>").count() - 2,
            html.matches("scope=\"row\"").count()
        );
        assert!(html.contains("the order is part of the answer"));
        assert!(html.contains("Diffuse interreflection"));
        assert!(
            html.contains("rastray compare &#39;a scene.toml&#39;")
                || html.contains("rastray compare 'a scene.toml'")
        );
    }

    #[test]
    fn one_pixel_and_no_lists_are_enough() {
        let pixel = Plane::filled(1, 1, [0.5f32; 3]);
        let map = signed_map(1, 1, &[[0.0; 3]], Reduction::Largest).unwrap();
        let mut report = Report {
            raster: pixel.clone(),
            trace: pixel,
            difference: map,
            error: magnitude_map(1, 1, &[[0.0; 3]], Reduction::Largest).unwrap(),
            cause_maps: Vec::new(),
            terms: Vec::new(),
            buildup: Vec::new(),
            notes: Vec::new(),
            settings: Vec::new(),
            ..example()
        };
        report.summary.size = [1, 1];
        report.summary.causes.clear();
        assert!(
            report
                .to_html()
                .unwrap()
                .contains("The two pictures are identical")
        );
        assert_eq!(report.files().unwrap().len(), 7);
        report.raster.width = 2;
        assert!(report.files().is_err());
    }

    #[test]
    fn a_cause_without_difference_shows_words_instead_of_a_map() {
        let html = example().to_html().unwrap();
        assert_eq!(html.matches("class=\"nothing\"").count(), 1); // clamping, in the example
        assert!(html.contains("12,345 pixels"));
    }

    #[test]
    fn the_headline_parts_local_from_global() {
        let equation = pieces(example().form, Term::Refraction);
        let html = grouped(&equation).into_string();
        assert_eq!(html.matches("class=\"term global\"").count(), 3); // S_L; K_R I_R; K_T I_T
        assert_eq!(html.matches("class=\"term local\"").count(), 4); // I_E; K_A I_AL; the sum; I_L
        let marks = marked(&pieces(example().form, Term::Ambient), Term::Ambient).into_string();
        assert!(
            marks.contains(
                "<span class=\"new\">+\u{a0}<var>K</var><sub><var>A</var></sub> <var>I</var>"
            ),
            "{marks}"
        );
    }
}
