//! Errors by who is at fault, each with its place and what to do about it.
//!
//! An [`Error`] says what is wrong, where (file:line:column, or the flag), what was expected, and what to do.
//! Nothing here prints: `cli` turns an error into text, with the line and a caret where a [`Place`] has one.

use std::fmt;

/// A place in an input file. Lines and columns count from 1, columns in characters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file as the user named it.
    pub file: String,
    /// Line, from 1; 0 where only the file is known.
    pub line: usize,
    /// Column in characters, from 1; 0 where only the line is known.
    pub column: usize,
    /// How many characters the caret underlines (at least 1).
    pub length: usize,
    /// The text of that line, for the caret display; empty where it is not known.
    pub text: String,
}

impl Place {
    /// The file as a whole.
    pub fn file(file: impl Into<String>) -> Self {
        Self {
            file: file.into(),
            line: 0,
            column: 0,
            length: 1,
            text: String::new(),
        }
    }

    /// The place of a byte range in `source`, the whole text of `file`.
    pub fn span(file: impl Into<String>, source: &str, span: std::ops::Range<usize>) -> Self {
        let start = (0..=span.start.min(source.len()))
            .rev()
            .find(|&i| source.is_char_boundary(i))
            .unwrap_or(0);
        let line_start = source[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = source[start..]
            .find('\n')
            .map_or(source.len(), |i| start + i);
        let end = (start..=span.end.clamp(start, line_end))
            .rev()
            .find(|&i| source.is_char_boundary(i))
            .unwrap_or(start);
        let text = source[line_start..line_end].trim_end_matches('\r');
        // What is wrong may be a carriage return that the line is shown without.
        let column = source[line_start..start].chars().count();
        let column = column.min(text.chars().count());
        Self {
            file: file.into(),
            line: source[..start].matches('\n').count() + 1,
            column: column + 1,
            length: source[start..end].chars().count().max(1),
            text: text.to_owned(),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.line, self.column) {
            (0, _) => write!(f, "{}", self.file),
            (line, 0) => write!(f, "{}:{line}", self.file),
            (line, column) => write!(f, "{}:{line}:{column}", self.file),
        }
    }
}

/// What went wrong, by who is at fault.
#[derive(Debug)]
pub enum Error {
    /// The input file says something that is wrong.
    Input {
        /// Where (boxed: errors are passed on often and looked at once).
        place: Box<Place>,
        /// What is wrong and what was expected, one sentence, without the place.
        message: String,
        /// What to do about it, where there is more to say than the message does.
        help: Option<String>,
    },
    /// The input is legal, but asks for something that rastray does not do.
    Unsupported {
        /// Where.
        place: Option<Box<Place>>,
        /// What is not supported.
        message: String,
        /// What to do instead.
        help: Option<String>,
    },
    /// A flag or an argument of a library call is wrong.
    Parameter {
        /// The flag or argument, as the user writes it.
        name: String,
        /// What is wrong and what was expected.
        message: String,
        /// What to do about it.
        help: Option<String>,
    },
    /// The work would exceed a stated limit (pixels, memory, rays).
    Limit {
        /// What exceeds which limit.
        message: String,
        /// What to do about it.
        help: Option<String>,
    },
    /// The system refused to read or write.
    Io {
        /// The file or folder.
        path: String,
        /// What was tried: "read", "write", "create".
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
}

impl Error {
    /// An [`Error::Input`] at a place.
    pub fn input(place: Place, message: impl Into<String>) -> Self {
        Self::Input {
            place: Box::new(place),
            message: message.into(),
            help: None,
        }
    }

    /// An [`Error::Parameter`] for a flag or argument.
    pub fn parameter(name: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Parameter {
            name: name.into(),
            message: message.into(),
            help: None,
        }
    }

    /// An [`Error::Limit`].
    pub fn limit(message: impl Into<String>) -> Self {
        Self::Limit {
            message: message.into(),
            help: None,
        }
    }

    /// An [`Error::Io`] for a path.
    pub fn io(path: impl Into<String>, action: &'static str, source: std::io::Error) -> Self {
        Self::Io {
            path: path.into(),
            action,
            source,
        }
    }

    /// The same error with a line of advice.
    pub fn with_help(mut self, advice: impl Into<String>) -> Self {
        match &mut self {
            Self::Input { help, .. }
            | Self::Unsupported { help, .. }
            | Self::Parameter { help, .. }
            | Self::Limit { help, .. } => *help = Some(advice.into()),
            Self::Io { .. } => {}
        }
        self
    }

    /// The place of the error, where it has one.
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::Input { place, .. } => Some(place),
            Self::Unsupported { place, .. } => place.as_deref(),
            _ => None,
        }
    }

    /// The advice, where there is some.
    pub fn help(&self) -> Option<&str> {
        match self {
            Self::Input { help, .. }
            | Self::Unsupported { help, .. }
            | Self::Parameter { help, .. }
            | Self::Limit { help, .. } => help.as_deref(),
            Self::Io { .. } => None,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input { place, message, .. } => write!(f, "{place}: {message}"),
            Self::Unsupported {
                place: Some(place),
                message,
                ..
            } => write!(f, "{place}: {message}"),
            Self::Unsupported {
                place: None,
                message,
                ..
            } => write!(f, "{message}"),
            Self::Parameter { name, message, .. } => write!(f, "{name}: {message}"),
            Self::Limit { message, .. } => write!(f, "{message}"),
            Self::Io {
                path,
                action,
                source,
            } => write!(f, "cannot {action} {path}: {source}"),
        }
    }
}

impl std::error::Error for Error {}

/// Something the importer dropped, invented or doubts; never fatal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Where, if the note is about a place in a file.
    pub place: Option<Place>,
    /// One sentence.
    pub message: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => write!(f, "{}", self.message),
        }
    }
}
