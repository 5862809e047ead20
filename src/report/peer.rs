//! The rasterizer against the system's OpenGL: the files of `compare --against opengl`, as bytes with their names.
//!
//! `raster.png opengl.png difference.png side-by-side.png summary.json index.html`. Pictures are GL's: clamped, 8 bits. The
//! agreement is measured in float, once unclamped and once with GL's clamps.

use maud::{Markup, html};
use rastray_compare::Map as Difference;
use rayon::prelude::*;
use serde::Serialize;

use super::document::{ARTICLE, Document};
use super::figures::{Panel, strip};
use super::files::View;
use super::folder::File;
use super::formats::{png, png_of_picture};
use super::numbers::{count, value};
use super::page::{legend, linear_image, map_picture};
use super::picture::Picture;
use super::summary::Metrics;
use crate::error::{Error, Note};
use crate::frame::Plane;
use crate::peers::agreement::{Agreement, Reasons, SAME};
use crate::peers::opengl::Info;

/// Every number of the comparison: `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct PeerSummary {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The driver.
    pub driver: Info,
    /// What of GL lit the unclamped and the clamped picture.
    pub method: Both<String>,
    /// The rasterizer's picture (test) against the driver's (reference), 8-bit values as fractions of 255.
    pub metrics: Metrics,
    /// How well they agree at pixel centres, in float.
    pub agreement: Both<Agreement>,
    /// Triangles drawn.
    pub triangles: usize,
    /// Wall-clock seconds of both renderers.
    pub seconds: Seconds,
}

/// The same without and with GL's clamps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Both<T> {
    /// No clamp anywhere.
    pub unclamped: T,
    /// GL's clamps: at vertices (or fragments), and after the colour sum.
    pub clamped: T,
}

/// Wall-clock seconds, all pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seconds {
    /// Of the rasterizer.
    pub raster: f64,
    /// Of the driver.
    pub opengl: f64,
}

/// A comparison of one scene with everything that its folder shows.
#[derive(Clone, Debug)]
pub struct PeerReport {
    /// The scene's name.
    pub title: String,
    /// The command line that made it.
    pub command: String,
    /// How linear values are shown.
    pub view: View,
    /// The rasterizer's picture, clamped.
    pub raster: Plane<[f32; 3]>,
    /// The driver's picture, clamped.
    pub opengl: Plane<[f32; 3]>,
    /// Raster minus OpenGL, signed, all pixels.
    pub difference: Difference,
    /// Magnitude of the same where both show the same triangle.
    pub same_triangle: Difference,
    /// Every number.
    pub summary: PeerSummary,
    /// What the importer dropped, invented or doubted.
    pub notes: Vec<Note>,
    /// What was rendered how.
    pub settings: Vec<(String, String)>,
}

const DIFFERENCE_NOTE: &str =
    "raster − OpenGL, all pixels: orange where rastray is brighter, blue where the driver is";
const SAME_NOTE: &str = "magnitude of the difference where both show the same triangle: rounding, on a scale of its own";

impl PeerSummary {
    /// The file's text.
    ///
    /// # Errors
    /// [`Error::Limit`] where a number is not one that JSON can hold.
    pub fn to_json(&self) -> Result<String, Error> {
        serde_json::to_string_pretty(self)
            .map(|text| text + "\n")
            .map_err(|e| Error::limit(format!("cannot write summary.json: {e}")))
    }

    /// The result in a few lines.
    pub fn to_text(&self) -> String {
        let mut text = format!(
            "{} · OpenGL {}\n",
            self.driver.renderer, self.driver.version
        );
        for (name, method, a) in [
            (
                "unclamped",
                &self.method.unclamped,
                &self.agreement.unclamped,
            ),
            ("clamped", &self.method.clamped, &self.agreement.clamped),
        ] {
            let c = &a.same_triangle;
            text += &format!("  {name}, {method}\n");
            text += &format!(
                "    same triangle  {} pixels, colour error max {:.2e}, mean {:.2e}, over {SAME:.0e}: {}; {} at a jump, max {:.2e}\n",
                count(c.pixels),
                c.max,
                c.mean,
                c.over,
                c.jump_pixels,
                c.jump_max,
            );
            text += &format!("    other triangle {}\n", reasons(&a.other_triangle));
            text += &format!(
                "    covered by one {} (rastray {}, driver {})\n",
                reasons(&a.one_only),
                a.raster_only,
                a.peer_only
            );
        }
        text
    }
}

/// "3 pixels: 2 at an edge, 1 at a tie of depths, 0 unexplained".
fn reasons(r: &Reasons) -> String {
    format!(
        "{} pixels: {} at an edge, {} at a tie of depths, {} unexplained",
        count(r.pixels),
        r.edge,
        r.depth_tie,
        r.unexplained
    )
}

impl PeerReport {
    /// All files, encoded in parallel.
    ///
    /// # Errors
    /// Pictures that are too large to encode.
    pub fn files(&self) -> Result<Vec<File>, Error> {
        type Encode = fn(&PeerReport) -> Result<Vec<u8>, Error>;
        let jobs: [(&str, Encode); 6] = [
            ("raster.png", |r| png(&r.raster, r.view)),
            ("opengl.png", |r| png(&r.opengl, r.view)),
            ("difference.png", |r| {
                png_of_picture(&r.difference_figure()?)
            }),
            ("side-by-side.png", |r| png_of_picture(&r.side_by_side()?)),
            ("summary.json", |r| {
                r.summary.to_json().map(String::into_bytes)
            }),
            ("index.html", |r| r.to_html().map(String::into_bytes)),
        ];
        jobs.into_par_iter()
            .map(|(name, encode)| {
                encode(self).map(|bytes| File {
                    name: name.to_owned(),
                    bytes,
                })
            })
            .collect()
    }

    fn side_by_side(&self) -> Result<Picture, Error> {
        let raster = Picture::from_linear(&self.raster, self.view)?;
        let opengl = Picture::from_linear(&self.opengl, self.view)?;
        let difference = Picture::from_map(&self.difference);
        let driver = &self.summary.driver.renderer;
        strip(&[
            panel(&raster, "rastray", "the software rasterizer"),
            panel(&opengl, "OpenGL", driver),
            panel(&difference, "difference", DIFFERENCE_NOTE),
        ])
    }

    fn difference_figure(&self) -> Result<Picture, Error> {
        let all = Picture::from_map(&self.difference);
        let same = Picture::from_map(&self.same_triangle);
        strip(&[
            panel(&all, "difference", DIFFERENCE_NOTE),
            panel(&same, "same triangle", SAME_NOTE),
        ])
    }

    /// The page: pictures, maps, numbers, how it was made.
    fn to_html(&self) -> Result<String, Error> {
        let [w, h] = self.summary.size;
        let driver = &self.summary.driver;
        let body = html! {
            body {
                header {
                    p.kicker { "rastray compare --against opengl · " (w) " × " (h) " pixels" }
                    h1 { (self.title) }
                    p.lead { (self.verdict()) }
                }
                main {
                    (self.pictures()?)
                    (self.numbers())
                    section {
                        h2 { "The driver" }
                        dl {
                            dt { "renderer" } dd { (driver.renderer) }
                            dt { "version" } dd { (driver.version) }
                            dt { "vendor" } dd { (driver.vendor) }
                            dt { "GLSL" } dd { (driver.shading_language) }
                            dt { "EGL platform" } dd { (driver.platform) }
                            dt { "lights" } dd { (driver.max_lights) }
                            dt { "sub-pixel bits" } dd { (driver.subpixel_bits) }
                        }
                        h2 { "How this was made" }
                        pre { code { (self.command) } }
                        dl { @for (name, setting) in &self.settings { dt { (name) } dd { (setting) } } }
                        @if !self.notes.is_empty() {
                            h2 { "Notes on the scene" }
                            ul { @for note in &self.notes { li { (note.to_string()) } } }
                        }
                    }
                }
                footer { "Made by rastray " (env!("CARGO_PKG_VERSION")) ". Type: Inter, SIL Open Font License 1.1." }
            }
        };
        let document = Document {
            title: format!("{} · rastray against OpenGL", self.title),
            policy: None,
            sheets: &[ARTICLE],
            body,
        };
        Ok(document.into_html())
    }

    /// The result in two sentences.
    fn verdict(&self) -> String {
        let a = &self.summary.agreement.unclamped;
        let unexplained = a.other_triangle.unexplained + a.one_only.unexplained;
        format!(
            "Where rastray and {} show the same triangle, their unclamped colours differ by at most {}, on average by {}. \
             {} pixels show another triangle or are covered by one only; {} of them for no known reason.",
            self.summary.driver.renderer,
            value(a.same_triangle.max),
            value(a.same_triangle.mean),
            count(a.other_triangle.pixels + a.one_only.pixels),
            count(unexplained),
        )
    }

    fn pictures(&self) -> Result<Markup, Error> {
        let driver = &self.summary.driver.renderer;
        Ok(html! {
            section {
                h2 { "One scene, two OpenGLs" }
                div.grid.triple {
                    figure {
                        (linear_image(&self.raster, self.view, "The scene as rastray rasterizes it")?)
                        figcaption { strong { "rastray" } "the software rasterizer" }
                    }
                    figure {
                        (linear_image(&self.opengl, self.view, "The scene as the driver draws it")?)
                        figcaption { strong { "OpenGL" } (driver) }
                    }
                    figure {
                        (map_picture(&self.difference, "Signed difference of the two pictures")?)
                        figcaption { strong { "difference" } (DIFFERENCE_NOTE) }
                        (legend(&self.difference.scale))
                    }
                    figure {
                        (map_picture(&self.same_triangle, "Magnitude of the difference on the same triangle")?)
                        figcaption { strong { "same triangle" } (SAME_NOTE) }
                        (legend(&self.same_triangle.scale))
                    }
                }
            }
        })
    }

    /// The agreement as a table, unclamped beside clamped.
    fn numbers(&self) -> Markup {
        let both = &self.summary.agreement;
        let row = |name: &str, f: &dyn Fn(&Agreement) -> String| -> [String; 3] {
            [name.to_owned(), f(&both.unclamped), f(&both.clamped)]
        };
        let rows = [
            row("same triangle, pixels", &|a| count(a.same_triangle.pixels)),
            row("colour error, max", &|a| value(a.same_triangle.max)),
            row("colour error, mean", &|a| value(a.same_triangle.mean)),
            row("pixels over 5 × 10⁻⁵", &|a| {
                count(a.same_triangle.over)
            }),
            row("lit at a jump of the model, pixels", &|a| {
                count(a.same_triangle.jump_pixels)
            }),
            row("colour error there, max", &|a| {
                value(a.same_triangle.jump_max)
            }),
            row("window depth error, max", &|a| value(a.depth_max)),
            row("another triangle", &|a| reasons(&a.other_triangle)),
            row("covered by one only", &|a| reasons(&a.one_only)),
        ];
        html! {
            section {
                h2 { "In numbers" }
                p {
                    "Errors are relative to the larger of 1 and the value. OpenGL leaves open who owns a pixel centre on an "
                    "edge, and every driver snaps vertices its own way: pixels at an edge are no one's error."
                }
                div.scroll {
                    table {
                        thead { tr { th {} th { "unclamped" } th { "with GL's clamps" } } }
                        tbody {
                            tr {
                                th scope="row" { "lit by" }
                                td { (self.summary.method.unclamped) } td { (self.summary.method.clamped) }
                            }
                            @for [name, unclamped, clamped] in &rows {
                                tr { th scope="row" { (name) } td { (unclamped) } td { (clamped) } }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn panel<'a>(picture: &'a Picture, title: &'a str, note: &'a str) -> Panel<'a> {
    Panel {
        picture,
        title,
        note,
    }
}
