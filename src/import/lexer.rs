//! Words with their places, for the formats that are lists of words: .scn and the meshes beside it.
//!
//! In: a text. Out: words separated by white space (that of C's `isspace`), each with the bytes it stands at, and
//! numbers read from them. Line breaks are white space unless one asks for the rest of a line. What a comment is and
//! where it may stand differs between formats: the caller skips it with [`Lexer::skip_line`]. Nothing is copied, and no
//! number leaves that is not finite or that single precision cannot hold.

use std::ops::Range;

use crate::error::{Error, Place};

/// A word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Token<'a> {
    pub(crate) text: &'a str,
    /// Its first byte.
    pub(crate) start: usize,
}

impl Token<'_> {
    /// The bytes it stands at.
    pub(crate) fn span(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }
}

/// A text being read.
#[derive(Clone, Debug)]
pub(crate) struct Lexer<'a> {
    file: &'a str,
    text: &'a str,
    at: usize,
}

/// C's `isspace`.
fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r')
}

impl<'a> Lexer<'a> {
    /// Starts at the beginning of the text of a file, whose name messages use.
    pub(crate) fn new(file: &'a str, text: &'a str) -> Self {
        Self { file, text, at: 0 }
    }

    /// The next word; it stays unread.
    pub(crate) fn peek(&self) -> Option<Token<'a>> {
        self.clone().next()
    }

    /// The next word.
    pub(crate) fn next(&mut self) -> Option<Token<'a>> {
        self.skip(is_space);
        let start = self.at;
        self.skip(|byte| !is_space(byte));
        let text = &self.text[start..self.at];
        (!text.is_empty()).then_some(Token { text, start })
    }

    /// The next word of the same line.
    pub(crate) fn next_on_line(&mut self) -> Option<Token<'a>> {
        self.skip(|byte| is_space(byte) && byte != b'\n');
        match self.text.as_bytes().get(self.at) {
            None | Some(b'\n') => None,
            Some(_) => self.next(),
        }
    }

    /// Skips to the end of the line.
    pub(crate) fn skip_line(&mut self) {
        self.skip(|byte| byte != b'\n');
    }

    /// Skips to the end of the line that a word stands in: the word was a comment's first.
    pub(crate) fn skip_comment(&mut self, token: &Token<'_>) {
        self.rewind(token);
        self.skip_line();
    }

    /// Makes a word unread.
    pub(crate) fn rewind(&mut self, token: &Token<'_>) {
        self.at = token.start;
    }

    fn skip(&mut self, while_: impl Fn(u8) -> bool) {
        let rest = &self.text.as_bytes()[self.at..];
        // Every predicate here treats all bytes of a character beyond ASCII alike, so the end is a boundary.
        self.at += rest
            .iter()
            .position(|byte| !while_(*byte))
            .unwrap_or(rest.len());
    }

    /// Where a word stands.
    pub(crate) fn place(&self, token: &Token<'_>) -> Place {
        Place::span(self.file, self.text, token.span())
    }

    /// The end of the text: after its last word.
    pub(crate) fn end(&self) -> Place {
        let end = self.text.trim_end().len();
        Place::span(self.file, self.text, end..end)
    }

    /// An error about a word.
    pub(crate) fn error(&self, token: &Token<'_>, message: impl Into<String>) -> Error {
        Error::input(self.place(token), message)
    }

    /// "expected ..., found ..." about a word, or about the end of the file where there is none.
    pub(crate) fn expected(&self, what: &str, found: Option<&Token<'_>>) -> Error {
        match found {
            Some(token) => {
                let message = format!("expected {what}, found {}", quote(token.text));
                self.error(token, message)
            }
            None => {
                let message = format!("expected {what}, found the end of the file");
                Error::input(self.end(), message)
            }
        }
    }

    /// The next word, which `what` describes.
    pub(crate) fn word(&mut self, what: &str) -> Result<Token<'a>, Error> {
        self.next().ok_or_else(|| self.expected(what, None))
    }

    /// The next word as a number, with the word.
    pub(crate) fn number(&mut self, what: &str) -> Result<(f64, Token<'a>), Error> {
        let token = self.word(what)?;
        let x = match token.text.parse::<f64>() {
            Ok(x) => x,
            Err(_) => return Err(self.expected(what, Some(&token))),
        };
        if !x.is_finite() {
            let what = format!("{what}, which must be finite");
            return Err(self.expected(&what, Some(&token)));
        }
        if x.abs() > f64::from(f32::MAX) {
            let what = format!("{what} of magnitude 3.4e38 or less (single precision)");
            return Err(self.expected(&what, Some(&token)));
        }
        Ok((x, token))
    }

    /// The next word as a whole number, with the word.
    pub(crate) fn integer(&mut self, what: &str) -> Result<(i64, Token<'a>), Error> {
        let token = self.word(what)?;
        match token.text.parse::<i64>() {
            Ok(x) => Ok((x, token)),
            Err(_) => Err(self.expected(what, Some(&token))),
        }
    }
}

/// A word as messages show it: in quotes, long ones cut.
pub(crate) fn quote(word: &str) -> String {
    const MOST: usize = 40;
    match word.char_indices().nth(MOST) {
        None => format!("`{word}`"),
        Some((end, _)) => format!("`{}...`", &word[..end]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_know_their_places() {
        let text = "a  bc\r\n\tδε 1.5e0\n";
        let mut lexer = Lexer::new("x.scn", text);
        let mut found = Vec::new();
        while let Some(token) = lexer.next() {
            let place = lexer.place(&token);
            found.push((token.text, place.line, place.column, place.length));
        }
        let expected = [
            ("a", 1, 1, 1),
            ("bc", 1, 4, 2),
            ("δε", 2, 2, 2),
            ("1.5e0", 2, 5, 5),
        ];
        assert_eq!(found, expected);
        assert_eq!((lexer.end().line, lexer.end().column), (2, 10));
    }

    #[test]
    fn lines_end_where_they_end() {
        let mut lexer = Lexer::new("x.off", "1 2\r\n3 # 4\n5");
        assert_eq!(lexer.next().unwrap().text, "1");
        assert_eq!(lexer.next_on_line().unwrap().text, "2");
        assert_eq!(lexer.next_on_line(), None);
        assert_eq!(lexer.next().unwrap().text, "3");
        let comment = lexer.next().unwrap();
        lexer.skip_comment(&comment);
        assert_eq!(lexer.peek().unwrap().text, "5");
        assert_eq!(lexer.next().unwrap().text, "5");
        assert_eq!((lexer.next_on_line(), lexer.next()), (None, None));
    }

    #[test]
    fn numbers_are_finite_or_refused() {
        for (text, value) in [
            (".5", 0.5),
            ("-2.", -2.0),
            ("+1e-3", 0.001),
            ("1e-400", 0.0),
        ] {
            assert_eq!(Lexer::new("x", text).number("a number").unwrap().0, value);
        }
        for text in [
            "nan",
            "inf",
            "-infinity",
            "1e400",
            "1e39",
            "1,5",
            "0x10",
            "",
            "1.0f",
        ] {
            assert!(Lexer::new("x", text).number("a number").is_err(), "{text}");
        }
        assert!(Lexer::new("x", "1.0").integer("a number").is_err());
        assert!(
            Lexer::new("x", "99999999999999999999")
                .integer("n")
                .is_err()
        );
    }
}
