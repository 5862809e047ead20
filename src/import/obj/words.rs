//! Logical lines and their words, as byte ranges of a file that need not be UTF-8.

use std::ops::Range;

use crate::error::Place;

/// The end of the logical line that starts at `start`: a line feed without a `\` before it, or the file's end.
pub(super) fn line_end(bytes: &[u8], start: usize) -> usize {
    let mut from = start;
    loop {
        let Some(length) = bytes[from..].iter().position(|b| *b == b'\n') else {
            return bytes.len();
        };
        let end = from + length;
        let line = bytes[start..end]
            .strip_suffix(b"\r")
            .unwrap_or(&bytes[start..end]);
        if !line.ends_with(b"\\") {
            return end;
        }
        from = end + 1;
    }
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
    let text = |range: Range<usize>| String::from_utf8_lossy(&bytes[range]).into_owned();
    Place {
        file: file.to_owned(),
        line: bytes[..line_start].iter().filter(|b| **b == b'\n').count() + 1,
        column: text(line_start..start).chars().count() + 1,
        length: text(start..end).chars().count().max(1),
        text: text(line_start..line_end).trim_end_matches('\r').to_owned(),
    }
}
