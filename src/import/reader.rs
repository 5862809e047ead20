//! Typed getters over a document's sections: every error has its place, what was found and what was expected.
//!
//! A [`Section`] is a table together with the rows of `keys` that belong to it. Opening one refuses unknown keys (with
//! the nearest known one) and keys that this version does not support; a getter looks up the key's kind and checks it.

use std::ops::Range as Span;

use super::document::{Document, Key, Node, Value};
use super::keys::{KeyInfo, Kind, Range};
use super::names;
use crate::error::Error;
use crate::math::DVec3;
use crate::math::color::Rgb;

/// A table of the document and the keys that it may hold.
pub(crate) struct Section<'a> {
    pub(crate) document: &'a Document,
    /// How messages call it: "material.red".
    pub(crate) path: String,
    /// Where it stands: its key in the header.
    pub(crate) span: Span<usize>,
    entries: &'a [(Key, Node)],
    keys: Vec<&'static KeyInfo>,
}

impl<'a> Section<'a> {
    /// Opens a table under the rows of `keys`.
    pub(crate) fn open(
        document: &'a Document,
        path: impl Into<String>,
        span: Span<usize>,
        node: &'a Node,
        keys: &[&'static [KeyInfo]],
    ) -> Result<Self, Error> {
        let path = path.into();
        let entries = table(document, node, &path)?;
        let keys: Vec<&KeyInfo> = keys.iter().flat_map(|rows| rows.iter()).collect();
        for (key, value) in entries {
            match keys.iter().find(|k| k.name == key.name) {
                Some(KeyInfo {
                    kind: Kind::Unsupported(reason),
                    ..
                }) => {
                    return Err(unsupported(
                        document,
                        value,
                        &format!("`{}`", key.name),
                        reason,
                    ));
                }
                Some(_) => {}
                None => return Err(unknown_key(document, &path, key, &keys)),
            }
        }
        Ok(Self {
            document,
            path,
            span,
            entries,
            keys,
        })
    }

    /// The value of a key.
    pub(crate) fn get(&self, name: &str) -> Option<&'a Node> {
        debug_assert!(
            self.keys.iter().any(|k| k.name == name),
            "{name} has no row"
        );
        let found = self.entries.iter().find(|(key, _)| key.name == name);
        found.map(|(_, node)| node)
    }

    /// Whether a key is there.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    fn kind(&self, name: &str) -> Kind {
        let row = self.keys.iter().find(|k| k.name == name);
        row.map_or(Kind::Text, |row| row.kind)
    }

    /// An error about the section as a whole.
    pub(crate) fn error(&self, message: impl std::fmt::Display) -> Error {
        let message = format!("{}: {message}", self.path);
        self.document.error(&self.span, message)
    }

    /// An error about the value of a key (or about the section where the key is not there).
    pub(crate) fn error_at(&self, name: &str, message: impl std::fmt::Display) -> Error {
        let span = self.get(name).map_or(&self.span, |node| &node.span);
        self.document.error(span, format!("{name}: {message}"))
    }

    /// "expected ..., found ..." for a value.
    pub(crate) fn mismatch(&self, name: &str, node: &Node, expected: &str) -> Error {
        mismatch(self.document, name, node, expected)
    }

    /// A number in the key's range.
    pub(crate) fn number(&self, name: &str) -> Result<Option<f64>, Error> {
        let Some(node) = self.get(name) else {
            return Ok(None);
        };
        let Kind::Number(range) = self.kind(name) else {
            return Err(self.error(format!("{name} is no number")));
        };
        self.number_of(name, node, range).map(Some)
    }

    /// A number in a range.
    pub(crate) fn number_of(&self, name: &str, node: &Node, range: Range) -> Result<f64, Error> {
        number(self.document, name, node, range)
    }

    /// A whole number, which may be negative, in the key's range.
    pub(crate) fn signed(&self, name: &str) -> Result<Option<i32>, Error> {
        let Some(node) = self.get(name) else {
            return Ok(None);
        };
        let Kind::Signed(low, high) = self.kind(name) else {
            return Err(self.error(format!("{name} is no whole number")));
        };
        match &node.value {
            Value::Integer(x) if (i128::from(low)..=i128::from(high)).contains(x) => {
                Ok(Some(*x as i32))
            }
            _ => {
                let expected = format!("a whole number from {low} to {high}");
                Err(self.mismatch(name, node, &expected))
            }
        }
    }

    /// A whole number in the key's range.
    pub(crate) fn integer(&self, name: &str) -> Result<Option<u32>, Error> {
        let Some(node) = self.get(name) else {
            return Ok(None);
        };
        let Kind::Integer(low, high) = self.kind(name) else {
            return Err(self.error(format!("{name} is no whole number")));
        };
        self.integer_of(name, node, low, high).map(Some)
    }

    /// A whole number in a range.
    pub(crate) fn integer_of(
        &self,
        name: &str,
        node: &Node,
        low: u32,
        high: u32,
    ) -> Result<u32, Error> {
        let expected = if high == u32::MAX {
            format!("a whole number, {low} or more")
        } else {
            format!("a whole number from {low} to {high}")
        };
        match &node.value {
            Value::Integer(x) if (i128::from(low)..=i128::from(high)).contains(x) => Ok(*x as u32),
            _ => Err(self.mismatch(name, node, &expected)),
        }
    }

    /// true or false.
    pub(crate) fn bool(&self, name: &str) -> Result<Option<bool>, Error> {
        match self.get(name) {
            None => Ok(None),
            Some(Node {
                value: Value::Bool(x),
                ..
            }) => Ok(Some(*x)),
            Some(node) => Err(self.mismatch(name, node, "true or false")),
        }
    }

    /// A string.
    pub(crate) fn text(&self, name: &str) -> Result<Option<&'a str>, Error> {
        match self.get(name) {
            None => Ok(None),
            Some(Node {
                value: Value::Text(x),
                ..
            }) => Ok(Some(x)),
            Some(node) => Err(self.mismatch(name, node, "a string")),
        }
    }

    /// One of the names of a table.
    pub(crate) fn choice<T: Copy>(
        &self,
        name: &str,
        table: &[(&'static str, T)],
    ) -> Result<Option<T>, Error> {
        let Some(node) = self.get(name) else {
            return Ok(None);
        };
        let known: Vec<&str> = table.iter().map(|(n, _)| *n).collect();
        let expected = format!("one of {}", names::list(&known, "and"));
        let Value::Text(text) = &node.value else {
            return Err(self.mismatch(name, node, &expected));
        };
        match table.iter().find(|(n, _)| n == text) {
            Some((_, value)) => Ok(Some(*value)),
            None => {
                let error = self.mismatch(name, node, &expected);
                Err(names::with_closest(error, text, &known))
            }
        }
    }

    /// A colour: a number is a grey.
    pub(crate) fn color(&self, name: &str) -> Result<Option<Rgb>, Error> {
        let Some(node) = self.get(name) else {
            return Ok(None);
        };
        let expected = "a colour: a number (grey) or [red, green, blue]";
        match &node.value {
            Value::List(_) => self.array(name, node, expected).map(Some),
            Value::Integer(_) | Value::Float(_) => {
                let grey = self.number_of(name, node, Range::Any)?;
                Ok(Some([grey; 3]))
            }
            _ => Err(self.mismatch(name, node, expected)),
        }
    }

    /// Three numbers.
    pub(crate) fn vector(&self, name: &str) -> Result<Option<DVec3>, Error> {
        match self.get(name) {
            None => Ok(None),
            Some(node) => self.vector_of(name, node).map(Some),
        }
    }

    /// Three numbers that are not all zero.
    pub(crate) fn direction(&self, name: &str) -> Result<Option<DVec3>, Error> {
        match self.vector(name)? {
            Some(DVec3::ZERO) => {
                Err(self.error_at(name, "expected a direction, found the zero vector"))
            }
            other => Ok(other),
        }
    }

    /// Three numbers from a node.
    pub(crate) fn vector_of(&self, name: &str, node: &Node) -> Result<DVec3, Error> {
        let xyz = self.array(name, node, "three numbers, [x, y, z]")?;
        Ok(DVec3::from_array(xyz))
    }

    /// Exactly N finite numbers.
    pub(crate) fn array<const N: usize>(
        &self,
        name: &str,
        node: &Node,
        expected: &str,
    ) -> Result<[f64; N], Error> {
        let Value::List(items) = &node.value else {
            return Err(self.mismatch(name, node, expected));
        };
        if items.len() != N {
            return Err(self.mismatch(name, node, expected));
        }
        let mut numbers = [0.0; N];
        for (x, item) in numbers.iter_mut().zip(items) {
            *x = self.number_of(name, item, Range::Any)?;
        }
        Ok(numbers)
    }

    /// Sixteen finite numbers, in a row or as four rows of four.
    pub(crate) fn rows(&self, name: &str, node: &Node, expected: &str) -> Result<[f64; 16], Error> {
        match &node.value {
            Value::List(rows) if rows.iter().any(|row| matches!(row.value, Value::List(_))) => {
                if rows.len() != 4 {
                    return Err(self.mismatch(name, node, expected));
                }
                let mut numbers = [0.0; 16];
                for (four, row) in numbers.chunks_exact_mut(4).zip(rows) {
                    four.copy_from_slice(&self.array::<4>(name, row, "a row of four numbers")?);
                }
                Ok(numbers)
            }
            _ => self.array(name, node, expected),
        }
    }

    /// The items of a list.
    pub(crate) fn list(&self, name: &str, expected: &str) -> Result<Option<&'a [Node]>, Error> {
        match self.get(name) {
            None => Ok(None),
            Some(Node {
                value: Value::List(items),
                ..
            }) => Ok(Some(items)),
            Some(node) => Err(self.mismatch(name, node, expected)),
        }
    }

    /// The key and value of a table that must have exactly one entry.
    pub(crate) fn only(&self) -> Result<&'a (Key, Node), Error> {
        match self.entries {
            [one] => Ok(one),
            _ => {
                let known: Vec<&str> = self.keys.iter().map(|k| k.name).collect();
                let found = self.entries.len();
                let expected = names::list(&known, "or");
                Err(self.error(format!(
                    "expected exactly one of {expected}, found {found} keys"
                )))
            }
        }
    }
}

/// The entries of a table.
pub(crate) fn table<'a>(
    document: &Document,
    node: &'a Node,
    path: &str,
) -> Result<&'a [(Key, Node)], Error> {
    match &node.value {
        Value::Table(entries) => Ok(entries),
        _ => Err(mismatch(document, path, node, "a table")),
    }
}

/// "expected ..., found ...".
pub(crate) fn mismatch(document: &Document, name: &str, node: &Node, expected: &str) -> Error {
    let found = node.value.describe();
    document.error(
        &node.span,
        format!("{name}: expected {expected}, found {found}"),
    )
}

/// A finite number in a range. Numbers that single precision cannot hold are refused, since the picture would be
/// infinite.
fn number(document: &Document, name: &str, node: &Node, range: Range) -> Result<f64, Error> {
    let x = match &node.value {
        Value::Float(x) => *x,
        Value::Integer(x) => *x as f64,
        _ => return Err(mismatch(document, name, node, &range.words())),
    };
    if !x.is_finite() {
        return Err(mismatch(document, name, node, "a finite number"));
    }
    if x.abs() > f64::from(f32::MAX) {
        let expected = "a number of magnitude 3.4e38 or less (single precision)";
        return Err(mismatch(document, name, node, expected));
    }
    if !range.holds(x) {
        return Err(mismatch(document, name, node, &range.words()));
    }
    Ok(x)
}

fn unknown_key(document: &Document, path: &str, key: &Key, keys: &[&KeyInfo]) -> Error {
    let known: Vec<&str> = keys.iter().map(|k| k.name).collect();
    let error = document.error(&key.span, format!("{path} has no key `{}`", key.name));
    names::with_advice(error, &key.name, &known)
}

/// [`Error::Unsupported`] at a value.
pub(crate) fn unsupported(document: &Document, node: &Node, what: &str, reason: &str) -> Error {
    Error::Unsupported {
        place: Some(Box::new(document.place(&node.span))),
        message: format!("{what} is not supported: {reason}"),
        help: None,
    }
}
