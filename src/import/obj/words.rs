//! Logical lines and their words, as byte ranges of a file that need not be UTF-8.

use std::ops::Range;

use crate::error::Place;
use crate::import::text::decode;

/// A logical line: physical ones that `\` joins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line {
    /// Where it ends.
    pub(super) end: usize,
    /// Where the next one starts.
    pub(super) next: usize,
    /// Its last `\` joins nothing, since the next line starts with a keyword: names end with one now and then, as
    /// folders do, and as the second byte of characters of Shift-JIS.
    pub(super) stray: bool,
}

/// The logical line that starts at `start`. Every physical one ends with a line feed. Comments never go on.
pub(super) fn line_at(bytes: &[u8], start: usize, is_keyword: fn(&[u8]) -> bool) -> Line {
    let mut from = start;
    loop {
        let feed = bytes[from..].iter().position(|b| *b == b'\n');
        let end = feed.map_or(bytes.len(), |length| from + length);
        let next = (end + 1).min(bytes.len());
        let line = bytes[from..end].strip_suffix(b"\r");
        let line = line.unwrap_or(&bytes[from..end]);
        let mut stray = false;
        if line.ends_with(b"\\") && comment(line).is_none() {
            let first = Words::new(bytes, next..bytes.len()).on_this_line();
            match first {
                Some(word) if is_keyword(&bytes[word.clone()]) => stray = true,
                Some(_) => {
                    from = next;
                    continue;
                }
                None => {}
            }
        }
        return Line { end, next, stray };
    }
}

/// Where the comment of a line starts: at a `#` that begins a word.
pub(super) fn comment(line: &[u8]) -> Option<usize> {
    let starts = |i: &usize| line[*i] == b'#' && (*i == 0 || line[*i - 1].is_ascii_whitespace());
    (0..line.len()).find(starts)
}

/// The words of a logical line, as byte ranges of the file.
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    end: usize,
}

impl<'a> Words<'a> {
    pub(super) fn new(bytes: &'a [u8], line: Range<usize>) -> Self {
        Self {
            bytes,
            at: line.start,
            end: line.end,
        }
    }

    /// The first word, where it stands on the physical line.
    fn on_this_line(mut self) -> Option<Range<usize>> {
        let start = self.at;
        let word = self.next()?;
        let between = &self.bytes[start..word.start];
        (!between.contains(&b'\n')).then_some(word)
    }

    /// The bytes of a range, with a blank for each line that ends in it.
    pub(super) fn joined(bytes: &[u8], range: Range<usize>) -> Vec<u8> {
        let mut text = Vec::with_capacity(range.len());
        for byte in &bytes[range] {
            match byte {
                b'\n' => {
                    while matches!(text.last(), Some(b'\r' | b'\\')) {
                        text.pop();
                    }
                    text.push(b' ');
                }
                byte => text.push(*byte),
            }
        }
        text
    }

    fn is_blank(&self, at: usize) -> bool {
        let b = self.bytes[at];
        b.is_ascii_whitespace() || b == 0x0b || b == b'\\' && self.continues(at)
    }

    /// Whether the `\` at a byte is followed by the line's end.
    fn continues(&self, at: usize) -> bool {
        let rest = &self.bytes[at + 1..self.end];
        rest.is_empty() || rest.starts_with(b"\n") || rest.starts_with(b"\r")
    }

    /// The rest of the line without blanks at its ends.
    pub(super) fn rest(&self) -> Range<usize> {
        let (mut start, mut end) = (self.at, self.end);
        while start < end && self.is_blank(start) {
            start += 1;
        }
        while end > start && self.is_blank(end - 1) {
            end -= 1;
        }
        start..end
    }
}

impl Iterator for Words<'_> {
    type Item = Range<usize>;

    fn next(&mut self) -> Option<Range<usize>> {
        while self.at < self.end && self.is_blank(self.at) {
            self.at += 1;
        }
        // A comment ends the line.
        if self.at >= self.end || self.bytes[self.at] == b'#' {
            self.at = self.end;
            return None;
        }
        let start = self.at;
        while self.at < self.end && !self.is_blank(self.at) {
            self.at += 1;
        }
        Some(start..self.at)
    }
}

/// The place of a byte range of a file that need not be UTF-8.
pub(super) fn place(file: &str, bytes: &[u8], span: Range<usize>) -> Place {
    let start = span.start.min(bytes.len());
    let line_start = bytes[..start]
        .iter()
        .rposition(|b| *b == b'\n')
        .map_or(0, |i| i + 1);
    let line_end = bytes[start..]
        .iter()
        .position(|b| *b == b'\n')
        .map_or(bytes.len(), |i| start + i);
    let end = span.end.clamp(start, line_end);
    let text = |range: Range<usize>| decode(&bytes[range]).into_owned();
    Place {
        file: file.to_owned(),
        line: bytes[..line_start].iter().filter(|b| **b == b'\n').count() + 1,
        column: text(line_start..start).chars().count() + 1,
        length: text(start..end).chars().count().max(1),
        text: text(line_start..line_end).trim_end_matches('\r').to_owned(),
    }
}
