//! `index.html` of two pictures: one self-contained page.

use maud::{Markup, html};
use rastray_compare::Map;

use super::{DIFFERENCE_NOTE, Diff, ERROR_NOTE, FLIP_NOTE, Side};
use crate::error::Error;
use crate::report::document::{ARTICLE, Document};
use crate::report::files::View;
use crate::report::numbers::value;
use crate::report::page::{legend, linear_image, map_picture};

impl Diff {
    /// The page: both pictures, the maps, the numbers, what was assumed.
    pub(super) fn to_html(&self) -> Result<String, Error> {
        let summary = &self.summary;
        let [w, h] = summary.size;
        let body = html! {
            body {
                header {
                    p.kicker { "rastray diff · " (w) " × " (h) " pixels" }
                    h1 { (short(&summary.b)) " against " (short(&summary.a)) }
                    p.lead { (summary.verdict()) }
                    @if let Some(advice) = summary.advice() { p { strong { (advice) } } }
                }
                main {
                    (self.pictures()?)
                    (self.maps()?)
                    (self.numbers())
                    (self.origin())
                }
                footer {
                    "Made by rastray " (env!("CARGO_PKG_VERSION")) ". Pictures show stored values as they are, limited to \
                     0…1; maps are in sRGB. Type: Inter, SIL Open Font License 1.1."
                }
            }
        };
        let document = Document {
            title: format!(
                "{} against {} · rastray diff",
                short(&summary.b),
                short(&summary.a)
            ),
            policy: None,
            sheets: &[ARTICLE],
            body,
        };
        Ok(document.into_html())
    }

    /// A | difference | B.
    fn pictures(&self) -> Result<Markup, Error> {
        let summary = &self.summary;
        let picture = |plane, which: &str, what: &str, side: &Side| -> Result<Markup, Error> {
            let alt = format!("{which}, {what}: {}", side.file);
            Ok(html! {
                figure {
                    (linear_image(plane, View::Linear, &alt)?)
                    figcaption { strong { (which) } (short(side)) ", " (what) }
                }
            })
        };
        Ok(html! {
            section.grid.three {
                (picture(&self.a, "A", "the reference", &summary.a)?)
                (map_figure(&self.difference, "difference", DIFFERENCE_NOTE)?)
                (picture(&self.b, "B", "the test", &summary.b)?)
            }
        })
    }

    fn maps(&self) -> Result<Markup, Error> {
        Ok(html! {
            section {
                h2 { "Where it matters" }
                p { "The same difference without its sign, and as a viewer would see it." }
                div.grid.three {
                    (map_figure(&self.error, "error", ERROR_NOTE)?)
                    (map_figure(&self.flip, "FLIP", FLIP_NOTE)?)
                }
            }
        })
    }

    fn numbers(&self) -> Markup {
        html! {
            section {
                h2 { "The difference in numbers" }
                p {
                    "B against A, over all pixels and channels, on the values as stored"
                    @for (side, name) in [(&self.summary.a, "A"), (&self.summary.b, "B")] {
                        @if side.decoded { ", those of " (name) " decoded from sRGB" }
                    }
                    "."
                }
                div.scroll {
                    table {
                        thead { tr {
                            th scope="col" { "metric" } th.number scope="col" { "value" }
                            th scope="col" { "what it means" }
                        } }
                        tbody {
                            @for [name, number, meaning] in self.summary.rows() {
                                tr { th scope="row" { (name) } td.number { (number) } td.text { (meaning) } }
                            }
                        }
                    }
                }
            }
        }
    }

    /// What was assumed, and how it was made.
    fn origin(&self) -> Markup {
        let summary = &self.summary;
        let r = &summary.readings;
        html! {
            section {
                h2 { "What was assumed" }
                dl {
                    dt { "A" } dd { (summary.a.describe()) }
                    dt { "B" } dd { (summary.b.describe()) }
                    dt { "other readings" }
                    dd {
                        "rmse as stored " (value(r.as_stored)) "; with A decoded from sRGB " (value(r.a_decoded))
                        "; with B decoded from sRGB " (value(r.b_decoded))
                    }
                    @for note in &summary.notes { dt { "note" } dd { (note) } }
                }
                h2 { "How this was made" }
                pre { code { (self.command) } }
            }
        }
    }
}

/// The file's name without its folders.
fn short(side: &Side) -> &str {
    side.file.rsplit(['/', '\\']).next().unwrap_or(&side.file)
}

fn map_figure(map: &Map, title: &str, note: &str) -> Result<Markup, Error> {
    let largest = map.summary.max;
    let alt = format!(
        "{title}: at most {}, scale to {}",
        value(largest),
        value(map.scale.max)
    );
    Ok(html! {
        figure {
            (map_picture(map, &alt)?)
            figcaption { strong { (title) } (note) }
            (legend(&map.scale))
        }
    })
}
