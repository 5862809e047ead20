//! Errors and notes as text: the message, the place, the line with a caret, and what to do; broken to the terminal's width.

use std::ops::Range;

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use anstyle::{AnsiColor, Style};
use rastray::error::{Error, Note, Place};
use rastray::report::lines::wrap;

/// The error without its place, which the snippet shows.
fn title(error: &Error) -> String {
    match error {
        Error::Input { message, .. } | Error::Unsupported { message, .. } => message.clone(),
        other => other.to_string(),
    }
}

/// The part of a place's line that fits into `room` characters, with the caret's bytes in it.
fn excerpt(place: &Place, room: usize) -> (String, Range<usize>) {
    const CUT: &str = "...";
    let line: Vec<char> = place.text.chars().collect();
    let caret = place.column.saturating_sub(1).min(line.len());
    let caret_end = (caret + place.length).min(line.len());
    // The start of the line stays where the caret is well inside; else the caret moves to a third.
    let cut = line.len() > room;
    let from = if cut && caret + room / 3 > room {
        caret - room / 3
    } else {
        0
    };
    let to = if cut {
        line.len().min(from + room - 2 * CUT.len())
    } else {
        line.len()
    };
    let text = |range: Range<usize>| -> String { line[range].iter().collect() };
    let before = if from > 0 { CUT } else { "" };
    let after = if to < line.len() { CUT } else { "" };
    let start = before.len() + text(from..caret.min(to)).len();
    let end = before.len() + text(from..caret_end.clamp(caret.min(to), to)).len();
    (format!("{before}{}{after}", text(from..to)), start..end)
}

/// Widest text: longer lines are hard to read.
const WIDEST: usize = 100;
/// How much of a source line goes into a file or a pipe.
const PIPED: usize = 200;
/// Narrower terminals are taken for this wide.
const NARROWEST: usize = 40;

/// Columns of a terminal; `None` where the stream is a file or a pipe, which have no width.
#[cfg(unix)]
pub(super) fn width(stream: impl std::os::fd::AsFd) -> Option<usize> {
    let size = terminal_size::terminal_size_of(stream);
    size.map(|(width, _)| usize::from(width.0).clamp(NARROWEST, WIDEST))
}

/// Columns of a terminal; `None` where the stream is a file or a pipe, which have no width.
#[cfg(windows)]
pub(super) fn width(stream: impl std::os::windows::io::AsHandle) -> Option<usize> {
    let size = terminal_size::terminal_size_of(stream);
    size.map(|(width, _)| usize::from(width.0).clamp(NARROWEST, WIDEST))
}

const RED: Style = AnsiColor::BrightRed.on_default().bold();
const GREEN: Style = AnsiColor::BrightGreen.on_default().bold();
const BLUE: Style = AnsiColor::BrightBlue.on_default().bold();
const BOLD: Style = Style::new().bold();

/// An error as text, with escape codes for colours.
fn render(error: &Error, width: Option<usize>) -> String {
    match error.place() {
        Some(place) if !place.text.is_empty() && place.column > 0 => {
            with_snippet(error, place, width)
        }
        place => without_snippet(error, place, width),
    }
}

/// Title, the line with a caret, advice.
fn with_snippet(error: &Error, place: &Place, width: Option<usize>) -> String {
    let text = wrap(&title(error), width, "error: ".len());
    let margin = place.line.to_string().len() + " | ".len();
    let room = width.unwrap_or(PIPED) - margin;
    let (line, caret) = excerpt(place, room);
    let caret = AnnotationKind::Primary.span(caret);
    let snippet = Snippet::source(line.as_str())
        .path(place.file.as_str())
        .line_start(place.line)
        .annotation(caret);
    let mut group: Group<'_> =
        Group::with_title(Level::ERROR.primary_title(&text)).element(snippet);
    let help = error
        .help()
        .map(|help| wrap(help, width, margin + "= help: ".len()));
    if let Some(help) = &help {
        group = group.element(Level::HELP.message(help));
    }
    // The line is cut already; the renderer's own cut can leave more than the width.
    let renderer = Renderer::styled()
        .decor_style(DecorStyle::Ascii)
        .term_width(4 * PIPED);
    renderer.render(&[group])
}

/// Title, file or flag, advice: in the same style.
fn without_snippet(error: &Error, place: Option<&Place>, width: Option<usize>) -> String {
    let part = |text: &str, indent: usize| {
        wrap(text, width, indent).replace('\n', &format!("\n{:indent$}", ""))
    };
    let text = part(&title(error), "error: ".len());
    let mut all = format!("{RED}error{RED:#}{BOLD}: {text}{BOLD:#}");
    if let Some(place) = place {
        all += &if place.file.starts_with("--") {
            let flag = part(&place.file, "  = in: ".len());
            format!("\n  {BLUE}={BLUE:#} {BOLD}in{BOLD:#}: {flag}")
        } else {
            format!("\n {BLUE}-->{BLUE:#} {place}")
        };
    }
    if let Some(help) = error.help() {
        let help = part(help, "  = help: ".len());
        all += &format!("\n  {BLUE}={BLUE:#} {BOLD}help{BOLD:#}: {help}");
    }
    all
}

/// Prints an error to standard error.
pub(crate) fn print(error: &Error) {
    anstream::eprintln!("{}", render(error, width(std::io::stderr())));
}

/// Prints a note to standard error.
pub(crate) fn note(note: &Note) {
    const LABEL: &str = "note: ";
    let text = wrap(&note.to_string(), width(std::io::stderr()), LABEL.len());
    let text = text.replace('\n', &format!("\n{:1$}", "", LABEL.len()));
    anstream::eprintln!("{GREEN}note{GREEN:#}: {text}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_line_is_wider_than_the_terminal() {
        let source = format!("eye = [0, ä{}, 2]\n", ", 5".repeat(60));
        for (start, end) in [(0, 3), (6, 150), (90, 93), (188, 189), (190, 191)] {
            let place = Place::span("scene.toml", &source, start..end);
            let error = Error::input(place, "eye: expected three numbers, ".repeat(6))
                .with_help("write three numbers in brackets, ".repeat(6));
            for width in [40, 60, 100] {
                let text = plain(&error, Some(width));
                for line in text.lines() {
                    assert!(line.chars().count() <= width, "{width}: {line}");
                }
                assert!(text.contains('^'), "{text}");
            }
        }
    }

    fn plain(error: &Error, width: Option<usize>) -> String {
        anstream::adapter::strip_str(&render(error, width)).to_string()
    }

    #[test]
    fn the_caret_stays_under_its_word() {
        let source = format!("{}here = 1{}", "x ".repeat(100), " y".repeat(100));
        let place = Place::span("a.toml", &source, 200..204);
        for room in [30, 57, 194] {
            let (text, caret) = excerpt(&place, room);
            assert_eq!(&text[caret], "here", "{text}");
            assert!(text.len() <= room);
        }
    }

    #[test]
    fn errors_without_a_line_look_the_same() {
        let error = Error::input(Place::file("--set a.b=1"), "there is no a").with_help("try b");
        let text = "error: there is no a\n  = in: --set a.b=1\n  = help: try b";
        assert_eq!(plain(&error, Some(80)), text);
        let error = Error::input(Place::file("a.toml"), "word ".repeat(12).trim_end());
        let text = "error: word word word word word word\n       word word word word word word\n --> a.toml";
        assert_eq!(plain(&error, Some(40)), text);
    }
}
