//! A page of text: headings, rows of numbers in columns, sentences, all within a width, with escape codes for colours (which
//! whoever prints it strips where there is no terminal).

use anstyle::{AnsiColor, RgbColor, Style};

use super::bytes;
use crate::math::color::Rgb;

/// Widest page.
const WIDEST: usize = 110;
/// Narrowest page.
const NARROWEST: usize = 60;
/// Columns of a number.
const NUMBER: usize = 9;

pub(super) const HEADING: Style = Style::new().bold().underline();
pub(super) const STRONG: Style = Style::new().bold();
pub(super) const NAME: Style = AnsiColor::Cyan.on_default();
pub(super) const FAINT: Style = Style::new().dimmed();
pub(super) const MARK: Style = AnsiColor::Yellow.on_default();

/// Text in a style.
pub(super) fn styled(style: Style, text: impl std::fmt::Display) -> String {
    format!("{style}{text}{style:#}")
}

/// A patch of a colour, two characters wide.
pub(super) fn swatch(color: Rgb) -> String {
    let [r, g, b] = bytes(color);
    styled(Style::new().bg_color(Some(RgbColor(r, g, b).into())), "  ")
}

/// Characters of a text, escape codes not counted.
pub(super) fn length(text: &str) -> usize {
    let mut count = 0;
    let mut escape = false;
    for c in text.chars() {
        match (escape, c) {
            (false, '\u{1b}') => escape = true,
            (true, 'm') => escape = false,
            (false, _) => count += 1,
            _ => {}
        }
    }
    count
}

/// A number in a column.
pub(super) fn cell(x: f64) -> String {
    let text = if x == 0.0 {
        "0".to_owned()
    } else if x.abs() < 5e-7 {
        "0.0000".to_owned()
    } else if x.is_finite() && !(5e-5..1e5).contains(&x.abs()) {
        format!("{x:.1e}")
    } else {
        format!("{x:.4}")
    };
    format!("{text:>NUMBER$}")
}

/// Three numbers in columns.
pub(super) fn cells(color: Rgb) -> String {
    color.map(cell).concat()
}

/// The page.
pub(super) struct Sheet {
    text: String,
    width: usize,
}

impl Sheet {
    /// An empty page for a terminal of so many columns, or for a file.
    pub(super) fn new(columns: Option<usize>) -> Self {
        Self {
            text: String::new(),
            width: columns.unwrap_or(WIDEST).clamp(NARROWEST, WIDEST),
        }
    }

    pub(super) fn finish(self) -> String {
        self.text
    }

    /// A line as it is.
    pub(super) fn line(&mut self, line: &str) {
        self.text += line.trim_end();
        self.text.push('\n');
    }

    pub(super) fn blank(&mut self) {
        self.text.push('\n');
    }

    pub(super) fn heading(&mut self, text: &str) {
        self.blank();
        self.line(&styled(HEADING, text));
    }

    /// A sentence, broken between words; lines after the first are indented by `hang` more.
    pub(super) fn sentence(&mut self, indent: usize, hang: usize, text: &str) {
        let lines = broken(text, self.width.saturating_sub(indent + hang));
        for (i, line) in lines.iter().enumerate() {
            let space = if i == 0 { indent } else { indent + hang };
            self.line(&format!("{:space$}{line}", ""));
        }
    }

    /// The heads of three columns of numbers behind a label of `label` characters.
    pub(super) fn columns(&mut self, label: usize, working: &str) {
        let names = format!("{:>NUMBER$}{:>NUMBER$}{:>NUMBER$}", "red", "green", "blue");
        let line = format!("{:label$}{names}   {working}", "");
        self.line(&styled(FAINT, line.trim_end()));
    }

    /// A label, three numbers, and how they came about.
    pub(super) fn row(&mut self, label: (usize, &str), color: Rgb, working: &str) {
        let (width, name) = label;
        let pad = width.saturating_sub(length(name));
        let start = format!("{name}{:pad$}{}", "", cells(color));
        let indent = width + 3 * NUMBER + 3;
        // Beside the numbers where that leaves room to read, else below.
        let room = self.width.saturating_sub(indent);
        let beside = room >= 30;
        let (room, indent) = if beside {
            (room, indent)
        } else {
            (self.width - 6, 6)
        };
        let lines = broken(working, room);
        let mut lines = lines.iter().filter(|line| !line.is_empty());
        if beside {
            let first = lines.next().map_or(String::new(), |l| styled(FAINT, l));
            self.line(&format!("{start}   {first}"));
        } else {
            self.line(&start);
        }
        for line in lines {
            self.line(&format!("{:indent$}{}", "", styled(FAINT, line)));
        }
    }
}

/// Words in lines of at most `room` characters.
fn broken(text: &str, room: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut used = 0;
    for word in text.split(' ') {
        let more = length(word);
        if used > 0 && used + 1 + more > room {
            lines.push(String::new());
            used = 0;
        }
        if let Some(line) = lines.last_mut() {
            if used > 0 {
                line.push(' ');
                used += 1;
            }
            line.push_str(word);
            used += more;
        }
    }
    lines
}
