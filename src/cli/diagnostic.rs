//! Errors and notes as text: the message, the place, the line with a caret, and what to do.

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use rastray::error::{Error, Note, Place};

/// The error without its place, which the snippet shows.
fn title(error: &Error) -> String {
    match error {
        Error::Input { message, .. } | Error::Unsupported { message, .. } => message.clone(),
        other => other.to_string(),
    }
}

/// Byte range of a place's characters within its line.
fn span(place: &Place) -> std::ops::Range<usize> {
    let at = |column: usize| {
        place
            .text
            .char_indices()
            .nth(column)
            .map_or(place.text.len(), |(byte, _)| byte)
    };
    let start = place.column.saturating_sub(1);
    at(start)..at(start + place.length)
}

/// Prints an error to standard error.
pub(crate) fn print(error: &Error) {
    let text = title(error);
    let mut group: Group<'_> = Group::with_title(Level::ERROR.primary_title(&text));
    let path;
    if let Some(place) = error.place() {
        path = place.to_string();
        if place.text.is_empty() || place.column == 0 {
            group = group.element(Origin::path(&path));
        } else {
            let caret = AnnotationKind::Primary.span(span(place));
            let snippet = Snippet::source(place.text.as_str())
                .path(place.file.as_str())
                .line_start(place.line)
                .annotation(caret);
            group = group.element(snippet);
        }
    }
    if let Some(help) = error.help() {
        group = group.element(Level::HELP.message(help));
    }
    let renderer = Renderer::styled().decor_style(DecorStyle::Ascii);
    anstream::eprintln!("{}", renderer.render(&[group]));
}

/// Prints a note to standard error.
pub(crate) fn note(note: &Note) {
    anstream::eprintln!("note: {note}");
}
