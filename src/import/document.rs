//! A TOML document as a tree that remembers where every key and value stands.
//!
//! In: the text of a scene file, the files that it includes (see `include`) and the `--set KEY=VALUE` overrides. Out: a
//! [`Node`] tree in file order, included materials first, overrides applied, so that the reader meets all alike. Spans
//! count in one address space: the file's text first, then each included file's, then the text of each override;
//! [`Document::place`] turns a span into file:line:column, or into the override's own words.
//! The grammar is the `toml` crate's (spanned, TOML 1.1); what its numbers, keys and tables mean is `native`'s business.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::text::Home;
use super::{include, names, syntax};
use crate::error::{Error, Place};

/// A value and where it stands.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// Bytes in the document's address space.
    pub(crate) span: Range<usize>,
    /// What stands there.
    pub(crate) value: Value,
}

/// A key and where it stands.
#[derive(Clone, Debug)]
pub(crate) struct Key {
    pub(crate) name: String,
    pub(crate) span: Range<usize>,
}

/// The kinds of value that a scene file can hold.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Text(String),
    /// A whole number; one beyond 128 bits is a float.
    Integer(i128),
    Float(f64),
    Bool(bool),
    Date,
    List(Vec<Node>),
    Table(Vec<(Key, Node)>),
}

impl Value {
    /// What an error message calls it.
    pub(crate) fn describe(&self) -> String {
        match self {
            Self::Text(text) if text.chars().count() <= 40 => format!("the string {text:?}"),
            Self::Text(_) => "a string".into(),
            Self::Integer(x) => x.to_string(),
            Self::Float(x) => format!("{x:?}"),
            Self::Bool(x) => x.to_string(),
            Self::Date => "a date".into(),
            Self::List(items) if items.is_empty() => "an empty list".into(),
            Self::List(items) => format!("a list of {}", items.len()),
            Self::Table(_) => "a table".into(),
        }
    }
}

/// Where a text comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    /// The scene file.
    File,
    /// A file that it includes.
    Included,
    /// Made by an importer: its lines are no lines of the file.
    Made,
    /// An override, as the user wrote it.
    Set,
}

/// A text of the document.
#[derive(Debug)]
struct Source {
    /// Its address.
    base: usize,
    origin: Origin,
    file: String,
    text: String,
}

/// A parsed document.
#[derive(Debug)]
pub(crate) struct Document {
    sources: Vec<Source>,
    /// The next free address.
    end: usize,
    pub(crate) root: Node,
}

impl Document {
    /// Parses a file's text, reads what it includes from its home, and applies overrides.
    pub(crate) fn parse(
        file: &str,
        text: String,
        home: &Home,
        sets: &[String],
    ) -> Result<Self, Error> {
        let mut document = Self::new();
        document.root = document.add(Origin::File, file, text)?;
        include::resolve(&mut document, home)?;
        document.apply_all(sets)?;
        Ok(document)
    }

    /// Parses the text that an importer made of a file, and applies overrides.
    pub(crate) fn made(file: &str, text: String, sets: &[String]) -> Result<Self, Error> {
        let mut document = Self::new();
        document.root = document.add(Origin::Made, file, text)?;
        document.apply_all(sets)?;
        Ok(document)
    }

    fn new() -> Self {
        Self {
            sources: Vec::new(),
            end: 0,
            root: node(0..0, Value::Table(Vec::new())),
        }
    }

    /// Parses an included file's text; its root is not part of the document's.
    pub(super) fn add_included(&mut self, file: &str, text: String) -> Result<Node, Error> {
        self.add(Origin::Included, file, text)
    }

    fn add(&mut self, origin: Origin, file: &str, text: String) -> Result<Node, Error> {
        let base = self.end;
        let root = match DeTable::parse(&text) {
            Ok(table) => {
                let span = shift(table.span(), base);
                node(span, table_value(table.into_inner(), base))
            }
            Err(error) => return Err(syntax::error(file, &text, &error)),
        };
        self.push(origin, file, text);
        Ok(root)
    }

    /// Gives a text an address.
    fn push(&mut self, origin: Origin, file: &str, text: String) {
        let base = self.end;
        self.end += text.len() + 3;
        self.sources.push(Source {
            base,
            origin,
            file: file.to_owned(),
            text,
        });
    }

    fn source(&self, span: &Range<usize>) -> Option<&Source> {
        let sources = self.sources.iter().rev();
        sources.into_iter().find(|s| span.start >= s.base)
    }

    /// Where a span stands.
    pub(crate) fn place(&self, span: &Range<usize>) -> Place {
        let Some(source) = self.source(span) else {
            return self.whole();
        };
        let Source {
            base, file, text, ..
        } = source;
        match source.origin {
            Origin::Set => Place::file(format!("--set {text}")),
            Origin::Made => Place::file(file),
            Origin::File | Origin::Included => {
                Place::span(file, text, span.start - base..span.end - base)
            }
        }
    }

    /// Whether a span stands in an included file.
    pub(crate) fn is_included(&self, span: &Range<usize>) -> bool {
        let source = self.source(span);
        source.is_some_and(|s| s.origin == Origin::Included)
    }

    /// The file as a whole.
    pub(crate) fn whole(&self) -> Place {
        Place::file(self.sources.first().map_or("", |s| s.file.as_str()))
    }

    /// An error about the text at a span.
    pub(crate) fn error(&self, span: &Range<usize>, message: impl Into<String>) -> Error {
        Error::input(self.place(span), message)
    }

    fn apply_all(&mut self, sets: &[String]) -> Result<(), Error> {
        for set in sets {
            let base = self.end;
            self.push(Origin::Set, "", set.clone());
            self.apply(set, base)?;
        }
        Ok(())
    }

    fn apply(&mut self, set: &str, base: usize) -> Result<(), Error> {
        let refuse = |message: String| Error::input(Place::file(format!("--set {set}")), message);
        let (path, value) = parse_set(set, base).map_err(|m| refuse(m).with_help(SET_HELP))?;
        let (last, sections) = path.split_last().ok_or_else(|| refuse("no key".into()))?;
        let mut table = &mut self.root;
        for (depth, key) in sections.iter().enumerate() {
            let Value::Table(entries) = &mut table.value else {
                let inside = path_name(&path[..depth]);
                return Err(refuse(format!(
                    "`{inside}` is not a table, so it has no `{}`",
                    key.name
                )));
            };
            let found = entries.iter().position(|(k, _)| k.name == key.name);
            let index = match found {
                Some(index) => index,
                None if depth == 1 && NAMED.contains(&path[0].name.as_str()) => {
                    return Err(unknown_name(refuse, &path[0].name, &key.name, entries));
                }
                None => {
                    entries.push((key.clone(), node(key.span.clone(), Value::Table(vec![]))));
                    entries.len() - 1
                }
            };
            table = &mut entries[index].1;
        }
        let Value::Table(entries) = &mut table.value else {
            let inside = path_name(sections);
            return Err(refuse(format!(
                "`{inside}` is not a table, so it has no `{}`",
                last.name
            )));
        };
        match entries.iter_mut().find(|(k, _)| k.name == last.name) {
            Some(entry) => *entry = (last.clone(), value),
            None => entries.push((last.clone(), value)),
        }
        Ok(())
    }
}

/// Sections whose entries have names of the user's own.
const NAMED: [&str; 3] = ["light", "material", "object"];

const SET_HELP: &str =
    "write KEY=VALUE, for example material.red.shininess=64 or camera.eye=[0,2,7]";

fn unknown_name(
    refuse: impl Fn(String) -> Error,
    section: &str,
    name: &str,
    entries: &[(Key, Node)],
) -> Error {
    let known: Vec<&str> = entries.iter().map(|(k, _)| k.name.as_str()).collect();
    let error = refuse(format!("there is no {section} called `{name}`"));
    names::with_advice(error, name, &known)
}

fn path_name(path: &[Key]) -> String {
    let names: Vec<&str> = path.iter().map(|k| k.name.as_str()).collect();
    names.join(".")
}

/// The path of keys and the value of an override. A value that is not TOML is taken as a bare word.
fn parse_set(set: &str, base: usize) -> Result<(Vec<Key>, Node), String> {
    let (key, value) = set.split_once('=').ok_or("there is no `=`")?;
    let value = value.trim();
    let text = format!("{key} = 0");
    let table = DeTable::parse(&text).map_err(|e| e.message().to_owned())?;
    let mut path = Vec::new();
    let mut root = table_value(table.into_inner(), base);
    while let Value::Table(mut entries) = root {
        // A key with a line break would hold more than one path.
        let (Some((key, next)), true) = (entries.pop(), entries.is_empty()) else {
            return Err("expected one KEY=VALUE".into());
        };
        path.push(key);
        root = next.value;
    }
    let bare = |c: char| c.is_alphanumeric() || " _-+./\\:".contains(c);
    let value = match DeValue::parse(value) {
        Ok(parsed) => value_node(parsed, base + key.len() + 1),
        Err(_) if !value.is_empty() && value.chars().all(bare) => {
            let start = base + key.len() + 1;
            node(start..start + value.len(), Value::Text(value.to_owned()))
        }
        Err(error) => return Err(error.message().replace('\n', " ")),
    };
    Ok((path, value))
}

fn node(span: Range<usize>, value: Value) -> Node {
    Node { span, value }
}

fn table_value(table: DeTable<'_>, base: usize) -> Value {
    let mut entries: Vec<(Key, Node)> = table
        .into_iter()
        .map(|(key, value)| {
            let span = shift(key.span(), base);
            let name = key.into_inner().into_owned();
            (Key { name, span }, value_node(value, base))
        })
        .collect();
    // The parser sorts keys by name; the file's order is that of their places.
    entries.sort_by_key(|(key, _)| key.span.start);
    Value::Table(entries)
}

fn value_node(value: Spanned<DeValue<'_>>, base: usize) -> Node {
    let span = shift(value.span(), base);
    let value = match value.into_inner() {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Integer(x) => match i128::from_str_radix(x.as_str(), x.radix()) {
            Ok(whole) => Value::Integer(whole),
            Err(_) => Value::Float(x.as_str().parse().unwrap_or(f64::INFINITY)),
        },
        // A literal beyond f64 becomes infinite here and is refused as such.
        DeValue::Float(x) => Value::Float(x.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(x) => Value::Bool(x),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(items) => {
            Value::List(items.into_iter().map(|x| value_node(x, base)).collect())
        }
        DeValue::Table(table) => table_value(table, base),
    };
    node(span, value)
}

fn shift(span: Range<usize>, base: usize) -> Range<usize> {
    span.start + base..span.end + base
}
