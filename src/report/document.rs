//! The shell of every page: one self-contained HTML document, its head and its style sheet.
//!
//! In: a title, a body, the style sheets of the page. Out: a document that needs no other file: type is in its sheet, light or
//! dark follows the reader's system. `base.css` is part of all: type, colours, the equation; [`ARTICLE`] is that of pages that
//! are read from top to bottom, all but the deck's slides.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::text;

/// The style sheet of pages that are read from top to bottom.
pub(super) const ARTICLE: &str = include_str!("article.css");

/// Colours on white paper; every text has at least 4.5 : 1 against what it stands on.
const LIGHT: &str = "--paper: #ffffff; --ink: #1b1f24; --grey: #59626d; --line: #e1e5e9; --tint: #f5f7f9; \
                     --local: #0364b4; --global: #964c04; --mark: #ffe0bd; --bar: #419efe;";
/// The same in the dark.
const DARK: &str = "--paper: #14171b; --ink: #e9ebee; --grey: #a4acb6; --line: #2d333a; --tint: #1c2126; \
                    --local: #80bcfe; --global: #fa9e5d; --mark: #5a3a16; --bar: #0581e6;";

/// A page.
pub(super) struct Document<'a> {
    /// What the window is called.
    pub(super) title: String,
    /// Its content security policy, where it has scripts to hold to one.
    pub(super) policy: Option<&'a str>,
    /// Style sheets behind `base.css`, in order.
    pub(super) sheets: &'a [&'a str],
    /// The element `body`.
    pub(super) body: Markup,
}

impl Document<'_> {
    /// The page's text.
    pub(super) fn into_html(self) -> String {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    @if let Some(policy) = self.policy { meta http-equiv="Content-Security-Policy" content=(policy); }
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="generator" content="rastray";
                    title { (self.title) }
                    style { (PreEscaped(sheet(self.sheets))) }
                }
                (self.body)
            }
        };
        page.into_string()
    }
}

/// `base.css` and what follows it, with type and colours in their places.
fn sheet(own: &[&str]) -> String {
    let all = include_str!("base.css").to_owned() + &own.concat();
    all.replace("@REGULAR@", &BASE64.encode(text::REGULAR))
        .replace("@SEMIBOLD@", &BASE64.encode(text::SEMIBOLD))
        .replace("@ITALIC@", &BASE64.encode(text::ITALIC))
        .replace("@LIGHT@", LIGHT)
        .replace("@DARK@", DARK)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(title: &str, policy: Option<&str>) -> String {
        let document = Document {
            title: title.to_owned(),
            policy,
            sheets: &[ARTICLE, ".own { color: red; }"],
            body: html! { body { p { "text" } } },
        };
        document.into_html()
    }

    #[test]
    fn a_document_is_whole_and_its_title_escaped() {
        let html = page("a < b & \"c\"", None);
        assert!(
            html.starts_with("<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\">")
        );
        assert!(html.contains("<title>a &lt; b &amp; &quot;c&quot;</title>"));
        assert!(
            html.ends_with(".own { color: red; }</style></head><body><p>text</p></body></html>")
        );
        assert!(!html.contains("Content-Security-Policy"));
        assert!(page("a", Some("default-src 'none'")).contains(
            "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'\">"
        ));
    }

    #[test]
    fn nothing_is_left_to_be_filled_in_or_fetched() {
        let all = sheet(&[
            ARTICLE,
            include_str!("deck/deck.css"),
            include_str!("atlas.css"),
        ]);
        for name in ["REGULAR", "SEMIBOLD", "ITALIC", "LIGHT", "DARK"] {
            assert!(!all.contains(&format!("@{name}@")), "{name}");
        }
        assert!(!all.contains("url(http") && !all.contains("@import"));
    }
}
