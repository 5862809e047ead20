//! What a TOML syntax error means to whoever wrote the line: the slip by its name, and what to write instead.
//!
//! In: the text and the `toml` crate's error, whose message names the rule of the grammar that failed. Out: an error at the
//! same place; where the line shows one of the slips that people make by hand, in its words. All else keeps the message.

use crate::error::{Error, Place};

/// A syntax error, or a better word for what the file is.
pub(super) fn error(file: &str, text: &str, error: &toml::de::Error) -> Error {
    if looks_like_obj(text) {
        return Error::input(Place::file(file), "holds an OBJ mesh, not a TOML scene")
            .with_help("give it the extension .obj");
    }
    let plain = error.message().replace('\n', " ");
    let Some(span) = error.span() else {
        return Error::input(Place::file(file), plain);
    };
    let place = Place::span(file, text, span.clone());
    let slip = Slip::new(text, &span).advice(&plain);
    let (message, help) = slip.unwrap_or((plain, String::new()));
    let error = Error::input(place, message);
    if help.is_empty() {
        error
    } else {
        error.with_help(help)
    }
}

/// Message and help.
type Advice = (String, String);

fn said(message: impl Into<String>, help: impl Into<String>) -> Option<Advice> {
    Some((message.into(), help.into()))
}

/// The surroundings of an error.
struct Slip<'a> {
    /// The text before its line.
    before: &'a str,
    /// Its line.
    line: &'a str,
    /// Where it stands in the line, in bytes.
    at: usize,
    /// The text that the error covers.
    found: &'a str,
}

impl<'a> Slip<'a> {
    fn new(text: &'a str, span: &std::ops::Range<usize>) -> Self {
        let bounded = |at: usize| {
            let at = at.min(text.len());
            (0..=at)
                .rev()
                .find(|i| text.is_char_boundary(*i))
                .unwrap_or(0)
        };
        let (start, end) = (bounded(span.start), bounded(span.end.max(span.start)));
        let first = text[..start].rfind('\n').map_or(0, |i| i + 1);
        let last = text[start..].find('\n').map_or(text.len(), |i| start + i);
        Self {
            before: &text[..first],
            line: text[first..last].trim_end_matches('\r'),
            at: start - first,
            found: text[start..end].trim(),
        }
    }

    /// What the slip is; `None` where the plain message says it best.
    fn advice(&self, plain: &str) -> Option<Advice> {
        let rule = |rule: &str| plain.starts_with(rule);
        match () {
            () if rule("duplicate key") => self.twice(),
            () if rule("string values must be quoted") => self.unquoted(),
            () if rule("missing comma") => self.open_list(),
            () if rule("invalid basic string") => {
                said("the string is not closed: expected `\"`", "")
            }
            () if rule("invalid literal string") => {
                said("the string is not closed: expected `'`", "")
            }
            () if rule("unexpected key or value") => self.left_over(),
            () if rule("invalid fraction") || rule("invalid mantissa") => said(
                "a number has digits on both sides of its point",
                "write 1.0 for 1., and 0.5 for .5",
            ),
            () if rule("key with no value") => self.no_equals(),
            () if rule("unclosed table") => self.spaced_name(),
            () if rule("invalid key-value pair") && self.found.is_empty() => self.json(),
            () => None,
        }
    }

    /// The key or section stands twice: where is the first?
    fn twice(&self) -> Option<Advice> {
        let lines: Vec<_> = self.before.lines().enumerate().collect();
        if self.line.trim_start().starts_with('[') {
            let header = |line: &str| line.split('#').next().unwrap_or("").replace(' ', "");
            let name = self.line.split(['[', ']']).find(|s| !s.trim().is_empty())?;
            let mut same = lines
                .iter()
                .filter(|(_, line)| header(line) == header(self.line));
            let (index, _) = same.next()?;
            let name = name.trim();
            return said(
                format!("{name} stands twice"),
                format!(
                    "the first is in line {}; give one of them another name",
                    index + 1
                ),
            );
        }
        let key = |line: &str| line.split_once('=').map(|(key, _)| key.trim().to_owned());
        let section = lines
            .iter()
            .rev()
            .take_while(|(_, line)| !line.trim_start().starts_with('['));
        let mut same = section.filter(|(_, line)| key(line).as_deref() == Some(self.found));
        let (index, _) = same.next()?;
        said(
            format!("{} stands twice", self.found),
            format!("the first is in line {}; remove one of them", index + 1),
        )
    }

    /// A value that begins as no value does.
    fn unquoted(&self) -> Option<Advice> {
        if self.found.is_empty() {
            return said("a value is missing behind `=`", "");
        }
        if self.found.find(';') == Some(self.found.len() - 1) {
            return said("nothing follows a value on its line", "remove the `;`");
        }
        if self.found.contains(';') {
            return said("the numbers of a list are separated by commas", "");
        }
        let words: Vec<_> = self.found.split_whitespace().collect();
        let number = |word: &str| word.parse::<f64>().is_ok();
        match words[..] {
            [a, b, ..] if number(a) && number(b) => {
                said(format!("a comma is missing between {a} and {b}"), "")
            }
            [word] if !word.contains(['"', '\'', '`']) => said(
                "text stands in quotes",
                format!("write \"{word}\", if it is meant as text"),
            ),
            _ => said("text stands in quotes", ""),
        }
    }

    /// A list that runs into the next key.
    fn open_list(&self) -> Option<Advice> {
        let (key, _) = self.line.split_once('=')?;
        let name = |c: char| c.is_alphanumeric() || "_-.\"' ".contains(c);
        if self.at > self.line.find(key.trim_start())? || !key.chars().all(name) {
            return None;
        }
        let (index, _) = self
            .before
            .lines()
            .enumerate()
            .filter(|(_, line)| line.matches('[').count() > line.matches(']').count())
            .last()?;
        said(
            format!("the list that begins in line {} is not closed", index + 1),
            "put `]` at its end",
        )
    }

    /// Something behind a complete value.
    fn left_over(&self) -> Option<Advice> {
        let (before, after) = self.line.split_at_checked(self.at)?;
        let (_, value) = before.split_once('=')?;
        if value.trim_start().starts_with('(') {
            return said("a list stands in square brackets", "write [1, 2, 3]");
        }
        let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
        let mut rest = after.trim_start().chars();
        match rest.next() {
            Some(',') if digit(rest.next()) => said(
                "a decimal point is a dot",
                "write 0.5 for 0,5, and [1, 2, 3] for a list",
            ),
            Some(',' | ';') => said("nothing follows a value on its line", "remove it"),
            _ => None,
        }
    }

    /// A key without `=`.
    fn no_equals(&self) -> Option<Advice> {
        let line = self.line.trim_start();
        if line.starts_with("//") || line.starts_with("/*") {
            return said("a comment begins with `#`", "");
        }
        let rest = self.line.get(self.at..)?.trim_start();
        if line.contains(':') && !line.contains('=') {
            return said("`=` stands between a key and its value, not `:`", "");
        }
        let first = rest.chars().next()?;
        let value = first.is_ascii_digit() || "\"'[-+.".contains(first);
        if value {
            return said("`=` is missing between the key and its value", "");
        }
        None
    }

    /// A section whose name has a space.
    fn spaced_name(&self) -> Option<Advice> {
        let name = self.line.trim().strip_prefix('[')?.split(']').next()?;
        let (section, name) = name.split_once('.')?;
        if !self.line.contains(']') || !name.contains(' ') || name.contains('"') {
            return None;
        }
        said(
            "a name with a space stands in quotes",
            format!("write [{section}.\"{}\"]", name.trim()),
        )
    }

    fn json(&self) -> Option<Advice> {
        let opens = self.before.trim().is_empty() && self.line.trim_start().starts_with('{');
        opens.then(|| {
            let help = "`rastray scenes whitted` prints one to start from";
            ("holds JSON, not a TOML scene".to_owned(), help.to_owned())
        })
    }
}

/// Whether the first statement is one of OBJ's.
fn looks_like_obj(text: &str) -> bool {
    const WORDS: [&str; 9] = ["v", "vn", "vt", "f", "o", "g", "s", "usemtl", "mtllib"];
    text.lines()
        .map(str::trim)
        .find(|line| !line.is_empty() && !line.starts_with('#'))
        .is_some_and(|line| {
            let mut words = line.split_whitespace();
            words.next().is_some_and(|w| WORDS.contains(&w))
                && words.next().is_some_and(|w| !w.starts_with('='))
        })
}
