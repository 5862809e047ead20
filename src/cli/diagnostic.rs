//! Errors and notes as text: the message, the place, the line with a caret, and what to do; broken to the terminal's width.

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

/// Widest text: longer lines are hard to read.
const WIDEST: usize = 100;
/// Narrower terminals are taken for this wide.
const NARROWEST: usize = 40;

/// Columns that messages have; `None` where they go into a file or a pipe, which have no width.
fn width() -> Option<usize> {
    let size = terminal_size::terminal_size_of(std::io::stderr());
    size.map(|(width, _)| usize::from(width.0).clamp(NARROWEST, WIDEST))
}

/// Breaks text between words into lines of `width` characters, the first of them `indent` shorter.
fn wrap(text: &str, width: Option<usize>, indent: usize) -> String {
    let Some(width) = width else {
        return text.to_owned();
    };
    let room = width.saturating_sub(indent).max(1);
    let mut lines = vec![String::new()];
    let mut length = 0;
    for word in text.split(' ') {
        let more = word.chars().count();
        if length > 0 && length + 1 + more > room {
            lines.push(String::new());
            length = 0;
        }
        if let Some(line) = lines.last_mut() {
            if length > 0 {
                line.push(' ');
                length += 1;
            }
            line.push_str(word);
            length += more;
        }
    }
    lines.join("\n")
}

/// An error as text, with escape codes for colours.
fn render(error: &Error, width: Option<usize>) -> String {
    let text = wrap(&title(error), width, "error: ".len());
    let mut group: Group<'_> = Group::with_title(Level::ERROR.primary_title(&text));
    let path;
    let mut margin = 3;
    if let Some(place) = error.place() {
        path = place.to_string();
        if place.text.is_empty() || place.column == 0 {
            group = group.element(Origin::path(&path));
        } else {
            margin += place.line.to_string().len();
            let caret = AnnotationKind::Primary.span(span(place));
            let snippet = Snippet::source(place.text.as_str())
                .path(place.file.as_str())
                .line_start(place.line)
                .annotation(caret);
            group = group.element(snippet);
        }
    }
    let help = error
        .help()
        .map(|help| wrap(help, width, margin + "= help: ".len()));
    if let Some(help) = &help {
        group = group.element(Level::HELP.message(help));
    }
    let mut renderer = Renderer::styled().decor_style(DecorStyle::Ascii);
    if let Some(width) = width {
        renderer = renderer.term_width(width);
    }
    renderer.render(&[group])
}

/// Prints an error to standard error.
pub(crate) fn print(error: &Error) {
    anstream::eprintln!("{}", render(error, width()));
}

/// Prints a note to standard error.
pub(crate) fn note(note: &Note) {
    const LABEL: &str = "note: ";
    let style = anstyle::AnsiColor::BrightGreen.on_default().bold();
    let text = wrap(&note.to_string(), width(), LABEL.len());
    let text = text.replace('\n', "\n      ");
    anstream::eprintln!("{style}note{style:#}: {text}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_broken_between_words() {
        let text = "one two three four";
        assert_eq!(wrap(text, None, 7), text);
        assert_eq!(wrap(text, Some(100), 7), text);
        assert_eq!(wrap(text, Some(14), 4), "one two\nthree four");
        // A word that is too long stands alone.
        assert_eq!(
            wrap("a longerthanthat b", Some(10), 4),
            "a\nlongerthanthat\nb"
        );
        assert_eq!(wrap("", Some(10), 4), "");
    }

    #[test]
    fn no_line_is_wider_than_the_terminal() {
        let source = format!("[camera]\neye = [0, 1{}, 2]\n", ", 5".repeat(60));
        let place = Place::span("scene.toml", &source, 15..150);
        let error = Error::input(place, "eye: expected three numbers, ".repeat(6))
            .with_help("write three numbers in brackets, ".repeat(6));
        for width in [40, 60, 100] {
            let text = anstream::adapter::strip_str(&render(&error, Some(width))).to_string();
            for line in text.lines() {
                assert!(line.chars().count() <= width, "{width}: {line}");
            }
        }
    }
}
