//! `index.html`: the deck on one self-contained page.
//!
//! A slide a scene behind a title slide with the questions. Arrow keys, space, Page Up and Down, Home, End, clicks and
//! swipes move; the place is in the address behind `#`. Pictures stand side by side, or one fills the slide (keys 1, 2, 3,
//! 0), or the traced one is wiped over the rasterized one (W). Without scripts, and printed, the slides follow each other,
//! one a page. Nothing is loaded from anywhere: pictures, type, style and script are in the file.

use maud::{Markup, PreEscaped, html};

use super::super::document::Document;
use super::super::equation::{Form, Piece, Script, Term, pieces, plain, runs};
use super::super::folder::{RASTER_NOTE, TRACE_NOTE};
use super::super::page::{grouped, image, legend, piece};
use super::super::prose;
use super::super::topic::Topics;
use super::slide::label_parts;
use super::{Deck, Entry, KINDS};

/// The keys, as the title slide and the buttons tell them.
const KEYS: [(&str, &str); 9] = [
    ("← →", "slides"),
    ("0", "side by side"),
    ("1", "raster"),
    ("2", "trace"),
    ("3", "difference"),
    ("W", "wipe"),
    ("N", "notes"),
    ("L", "light or dark"),
    ("F", "full screen"),
];

/// The ways to look at a slide's pictures: value, what the button says, key.
const VIEWS: [(&str, &str, &str); 5] = [
    ("all", "side by side", "0"),
    ("raster", "raster", "1"),
    ("trace", "trace", "2"),
    ("difference", "difference", "3"),
    ("wipe", "wipe", "W"),
];

impl Deck {
    /// The page.
    pub(super) fn to_html(&self) -> String {
        let count = self.entries.len();
        let body = html! {
            body data-view="all" {
                main {
                    (self.first())
                    @for (i, entry) in self.entries.iter().enumerate() { (slide(entry, i + 1, count)) }
                }
                (bar())
                p.spoken #spoken aria-live="polite" {}
                script { (PreEscaped(include_str!("deck.js"))) }
            }
        };
        let document = Document {
            title: format!("{} · rastray lecture", title(count)),
            policy: None,
            sheets: &[include_str!("deck.css")],
            body,
        };
        document.into_html()
    }

    /// The title slide: the equation, and all questions.
    fn first(&self) -> Markup {
        let form = self.entries.first().map(|entry| entry.form);
        html! {
            section.slide.first #start aria-label="Contents" {
                header {
                    p.kicker { "rastray lecture" }
                    h1 tabindex="-1" { (title(self.entries.len())) }
                }
                @if let Some(form) = form { (whole(form)) }
                nav aria-label="Slides" {
                    ol style={ "--rows:" (self.entries.len().div_ceil(2)) } {
                        @for entry in &self.entries {
                            li { a href={ "#" (entry.stem) } {
                                span { (prose::html(entry.title())) }
                                span.about { (about(&entry.topics)) }
                            } }
                        }
                    }
                }
                p.keys { @for (key, what) in KEYS { span { kbd { (key) } " " (what) } " " } }
                p.made { "Made by rastray " (env!("CARGO_PKG_VERSION")) ": " code { (self.command) }
                    ". Type: Inter, SIL Open Font License 1.1." }
            }
        }
    }
}

/// What the deck is called.
fn title(slides: usize) -> String {
    match slides {
        1 => "One equation, one question".to_owned(),
        n => format!("One equation, {n} questions"),
    }
}

/// The words of one or two topics, else their number.
fn about(topics: &Topics) -> String {
    match topics.0.len() {
        0..=2 => topics.names(),
        n => format!("{n} terms"),
    }
}

/// The whole equation, local and global parts underlined.
fn whole(form: Form) -> Markup {
    let whole = pieces(form, Term::Refraction);
    html! {
        div.equation {
            p.formula role="math" aria-label=(plain(&whole)) { (grouped(&whole)) }
            p.key {
                span.local { "local" } " a surface and its lights: the rasterizer, exactly · "
                span.global { "global" } " other surfaces too: only the tracer"
            }
        }
    }
}

/// A slide.
fn slide(entry: &Entry, number: usize, count: usize) -> Markup {
    let label = format!("Slide {number} of {count}: {}", entry.title());
    html! {
        section.slide id=(entry.stem) aria-roledescription="slide" aria-label=(label) {
            header {
                p.kicker { (number) " / " (count) " · " (entry.stem) }
                h2 tabindex="-1" { (prose::html(entry.title())) }
            }
            div.pictures {
                @for (i, kind) in KINDS.iter().enumerate() { (picture(entry, i, kind)) }
            }
            div.equation {
                @if !entry.topics.0.is_empty() { p.topics { (labels(&entry.topics)) } }
                @for line in entry.topics.lines(entry.form) {
                    p.formula role="math" aria-label=(plain(&line)) { (lit(&line, &entry.topics)) }
                }
            }
            @if !entry.head.answer.is_empty() { p.answer { (prose::html(&entry.head.answer)) } }
            @if !entry.head.paragraphs.is_empty() {
                aside.notes aria-label="Notes" {
                    @for paragraph in &entry.head.paragraphs { p { (prose::html(paragraph)) } }
                }
            }
        }
    }
}

/// One of the three pictures with its caption.
fn picture(entry: &Entry, index: usize, kind: &str) -> Markup {
    let note = match index {
        0 => format!("{RASTER_NOTE}."),
        1 => format!("{TRACE_NOTE}."),
        _ => format!("{}.", entry.numbers),
    };
    let alt = format!("{} ({kind}). {note}", entry.title());
    html! {
        @if let Some((bytes, width, height)) = entry.pictures.get(index) {
            figure class=(kind) style={ "--ratio:" (width) "/" (height) } {
                (image(bytes, *width, *height, &alt))
                figcaption { strong { (kind) } span { (note) } }
                @if index == 2 { (legend(&entry.scale)) }
            }
        }
    }
}

/// "+ D diffuse".
fn labels(topics: &Topics) -> Markup {
    html! {
        @for topic in &topics.0 {
            span {
                strong {
                    @for (text, script) in label_parts(topic.label()) {
                        @if script == Script::Sub { sub { (text) } } @else { (text) }
                    }
                }
                " " (topic.name())
            }
            " "
        }
    }
}

/// The equation with what is lit marked, and the rest standing back where anything is.
fn lit(line: &[Piece], topics: &Topics) -> Markup {
    html! {
        @for (new, run) in runs(line, false, |p| topics.lit(p).then_some(())) {
            @if new.is_some() { mark.new { @for p in run { (piece(p)) } } }
            @else if topics.0.is_empty() { @for p in run { (piece(p)) } }
            @else { span.dim { @for p in run { (piece(p)) } } }
        }
    }
}

/// The buttons below all slides; the script shows them.
fn bar() -> Markup {
    let key = |key: &str| format!("Key {key}");
    html! {
        nav.bar #bar aria-label="Controls" hidden {
            button #back aria-label="Previous slide" title="Keys ← and Page Up" { "←" }
            span #place {}
            button #next aria-label="Next slide" title="Keys → and space" { "→" }
            span.views role="group" aria-label="Pictures" {
                @for (view, says, shortcut) in VIEWS {
                    button data-view=(view) aria-pressed="false" title=(key(shortcut)) { (says) }
                }
            }
            label.wiper { span { "raster" } input #wipe type="range" min="0" max="100" value="50"
                aria-label="How much of the raster is shown"; span { "trace" } }
            span.rest {}
            button #notes aria-pressed="false" title=(key("N")) { "notes" }
            button #theme title=(key("L")) { "light / dark" }
            button #full title=(key("F")) { "full screen" }
        }
    }
}
