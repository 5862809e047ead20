//! `index.html`: a comparison on one self-contained page.
//!
//! In: one [`Report`]. Out: HTML that needs no other file and fetches nothing, so that it opens by double click: pictures,
//! type, style, script and packed layers are embedded. Light or dark follows the reader's system.
//!
//! Words, tables, small pictures and maps are plain HTML and need no script; printed, they fill two pages. The script
//! (`*.js`, one after the other in one element) adds what moves: a slider between any two pictures, differences with
//! exposure, the term mixer, and the numbers of any pixel, from the data that [`live`] packs. `view.js` draws, `mixer.js`
//! sums, `pixel.js` tells, `state.js` keeps everything in the address behind `#`.
//!
//! | file | what |
//! | - | - |
//! | `live` `mix` `codec` | pictures and layers, packed to fit |
//! | `telling` | the pixels that are explained beforehand |
//! | `head` `still` `viewer` `sections` | title and equation; what needs no script; the moving part's frame; words and tables |
//! | `parts` | what other pages use, too |

mod codec;
mod head;
pub mod live;
mod mix;
mod parts;
mod sections;
mod still;
mod telling;
mod viewer;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use maud::{Markup, PreEscaped, html};
use rastray_compare::{Map, Scale, ScaleKind};
use serde_json::{Value, json};

use crate::error::{Error, Note};
use crate::frame::Plane;

use super::document::{ARTICLE, Document};
use super::equation::{Form, Term};
use super::files::View;
use super::summary::Summary;

pub use live::Live;
pub(super) use parts::{grouped, image, legend, linear_image, map_picture, piece};
pub(super) use sections::capital;
pub(super) use telling::explained;

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
    /// What the page's script works on.
    pub live: Live,
}

/// A plane of linear values with its name.
#[derive(Clone, Debug)]
pub struct NamedPlane {
    /// Such as `specular.key`.
    pub name: String,
    /// Its values.
    pub plane: Plane<[f32; 3]>,
}

/// The script, in the order of its parts.
const SCRIPT: [&str; 6] = [
    include_str!("codec.js"),
    include_str!("state.js"),
    include_str!("view.js"),
    include_str!("mixer.js"),
    include_str!("pixel.js"),
    include_str!("main.js"),
];

/// Nothing is loaded from anywhere, and browsers hold the page to it.
const POLICY: &str = "default-src 'none'; img-src data: blob:; font-src data:; style-src 'unsafe-inline'; \
                      script-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";

impl Report {
    /// The page.
    pub fn to_html(&self) -> Result<String, Error> {
        let body = html! {
            body {
                header { (head::title(self)) }
                main {
                    (head::equation(self.form))
                    (head::symbols(self.form))
                    (still::pictures(self)?)
                    (viewer::viewer(self))
                    (still::causes(self)?)
                    (viewer::pixel())
                    (still::growth(self)?)
                    (sections::explanations(&self.summary, self.pixels()))
                    (sections::numbers(self)?)
                    (sections::agreement(&self.summary))
                    (sections::methods(&self.live))
                    (sections::work(&self.summary))
                    (sections::origin(self))
                }
                footer {
                    "Made by rastray " (env!("CARGO_PKG_VERSION")) ". Pictures show stored values as they are"
                    @if self.view == View::Srgb { ", through the sRGB view transform" }
                    "; maps are in sRGB. Type: Inter, SIL Open Font License 1.1."
                }
                (self.data())
            }
        };
        let document = Document {
            title: format!("{} · rastray compare", self.title),
            policy: Some(POLICY),
            sheets: &[ARTICLE, include_str!("live.css")],
            body,
        };
        Ok(document.into_html())
    }

    /// Pixels of the picture.
    pub(super) fn pixels(&self) -> usize {
        self.summary.size[0] * self.summary.size[1]
    }

    /// Index, packed planes and script.
    fn data(&self) -> Markup {
        let mut index = self.live.index.clone();
        if !index.is_null() {
            index["colors"] = colors();
            index["mirror"] = json!(if self.form.mirror_is_specular {
                "K_S"
            } else {
                "K_R"
            });
            let causes = &self.summary.causes;
            index["causes"] = causes
                .iter()
                .map(|c| json!({"name": c.name, "max": c.max, "pixels": c.pixels}))
                .collect();
        }
        html! {
            script type="application/json" id="index" { (PreEscaped(script_safe(&index.to_string()))) }
            @for (name, bytes) in &self.live.blobs {
                script type="application/octet-stream" id={ "blob-" (name) } { (PreEscaped(BASE64.encode(bytes))) }
            }
            script { (PreEscaped("(() => {\n\"use strict\";\n")) @for part in SCRIPT { (PreEscaped(part)) } (PreEscaped("})();\n")) }
        }
    }
}

/// JSON inside a script element: nothing in it ends the element.
fn script_safe(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// The false colours of differences: signed from -1 to 1 in 257 steps, magnitudes from 0 to 1 in 129.
fn colors() -> Value {
    let scale = |kind| Scale { kind, max: 1.0 };
    let (signed, magnitude) = (scale(ScaleKind::Signed), scale(ScaleKind::Magnitude));
    let at = |scale: &Scale, i: i32| parts::hex(scale.color(f64::from(i) / 128.0));
    let signed: Vec<String> = (-128..=128).map(|i| at(&signed, i)).collect();
    let magnitude: Vec<String> = (0..=128).map(|i| at(&magnitude, i)).collect();
    json!({"signed": signed, "magnitude": magnitude})
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::gl::SpecularModel;
    use crate::report::equation::pieces;
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
            live: Live::default(),
        }
    }

    #[test]
    fn the_page_needs_nothing_else_and_escapes_what_it_is_given() {
        let html = example().to_html().unwrap();
        assert!(html.starts_with("<!DOCTYPE html><html lang=\"en\">"));
        assert!(html.contains("<h1>glass &amp; &lt;mirror&gt;</h1>"));
        assert!(!html.contains("http://") && !html.contains("https://") && !html.contains("<link"));
        assert!(html.contains("default-src 'none'"));
        let sources = html
            .match_indices("src=\"")
            .map(|(i, _)| &html[i + 5..i + 30]);
        assert_eq!(sources.clone().count(), 3 + 8 + 7 + 1);
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
    fn names_in_the_data_end_no_script() {
        let mut report = example();
        let name = "</script><b>&amp;\u{2028}";
        report.live.index = json!({"groups": [[name]], "how": {}});
        let html = report.to_html().unwrap();
        assert!(!html.contains("</script><b>"));
        let start = html.find("id=\"index\">").unwrap() + "id=\"index\">".len();
        let end = start + html[start..].find("</script>").unwrap();
        let index: Value = serde_json::from_str(&html[start..end]).unwrap();
        assert_eq!(index["groups"][0][0], name);
        assert_eq!(index["colors"]["signed"][128], "#ffffff");
        assert_eq!(
            html.matches("<script").count(),
            html.matches("</script>").count()
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
            html.matches("<tr>").count() - 1,
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
    }
}
