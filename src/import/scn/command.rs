//! The command words of a .scn file, and reading their arguments.

use crate::error::Error;
use crate::import::lexer::{Lexer, Token};
use crate::import::names;
use crate::math::DVec3;
use crate::math::color::Rgb;

/// Each command with its arguments, as messages show it.
#[rustfmt::skip] // a table
const COMMANDS: &[(&str, &str)] = &[
    ("tri", "tri m  x1 y1 z1  x2 y2 z2  x3 y3 z3"),
    ("box", "box m  x1 y1 z1  x2 y2 z2"),
    ("sphere", "sphere m  cx cy cz  r"),
    ("cylinder", "cylinder m  cx cy cz  r h"),
    ("cone", "cone m  cx cy cz  r h"),
    ("circle", "circle m  cx cy cz  nx ny nz  r"),
    ("mesh", "mesh m  file"),
    ("line", "line m  x1 y1 z1  x2 y2 z2"),
    ("begin", "begin m  a00 a01 a02 a03  a10 a11 a12 a13  a20 a21 a22 a23  a30 a31 a32 a33"),
    ("group", "group name m  a00 a01 a02 a03  a10 a11 a12 a13  a20 a21 a22 a23  a30 a31 a32 a33"),
    ("end", "end"),
    ("material", "material ka.rgb kd.rgb ks.rgb kt.rgb e.rgb n ir texture, 17 numbers and a file name or 0"),
    ("dir_light", "dir_light r g b  dx dy dz"),
    ("point_light", "point_light r g b  px py pz  ca la qa"),
    ("spot_light", "spot_light r g b  px py pz  dx dy dz  ca la qa  sc sd"),
    ("area_light", "area_light r g b  px py pz  dx dy dz  radius  ca la qa"),
    ("rect_light", "rect_light r g b  px py pz  a1x a1y a1z  a2x a2y a2z  l1 l2  ca la qa"),
    ("camera", "camera ex ey ez  tx ty tz  ux uy uz  xfov near far"),
    ("include", "include file"),
    ("background", "background r g b"),
    ("ambient", "ambient r g b"),
];

/// A command under reading: its word is read, its arguments are to come.
#[derive(Debug)]
pub(super) struct Command<'l, 'a> {
    pub(super) lexer: &'l mut Lexer<'a>,
    pub(super) token: Token<'a>,
    /// Its word.
    pub(super) word: &'static str,
    usage: &'static str,
}

impl<'l, 'a> Command<'l, 'a> {
    /// The command that a word stands for.
    pub(super) fn find(lexer: &'l mut Lexer<'a>, token: Token<'a>) -> Result<Self, Error> {
        match COMMANDS.iter().find(|(word, _)| *word == token.text) {
            Some((word, usage)) => Ok(Self {
                lexer,
                token,
                word,
                usage,
            }),
            None => Err(unknown(lexer, &token)),
        }
    }

    /// An error about one of the command's words, with how the command is written.
    pub(super) fn error(&self, token: &Token<'_>, message: impl std::fmt::Display) -> Error {
        let message = format!("{}: {message}", self.word);
        self.lexer.error(token, message).with_help(self.usage())
    }

    fn usage(&self) -> String {
        format!("it is written `{}`", self.usage)
    }

    /// Reads again what did not read well, now saying what it was to be.
    fn explain<T>(
        &mut self,
        before: Lexer<'a>,
        name: &str,
        kind: &str,
        read: impl Fn(&mut Lexer<'a>, &str) -> Result<T, Error>,
    ) -> Error {
        let found = before.peek();
        *self.lexer = before;
        let what = format!("{kind} for {name} of `{}`", self.word);
        let error = match read(self.lexer, &what) {
            Err(error) => error,
            Ok(_) => self.error(&self.token, "cannot be read"),
        };
        error.with_help(match found {
            Some(token) if token.text.starts_with('#') => {
                "a comment may stand between commands, not inside one".into()
            }
            Some(token) if token.text.contains(',') => {
                "numbers are separated by blanks, and have a decimal point".into()
            }
            _ => self.usage(),
        })
    }

    /// The next argument, a number.
    pub(super) fn number(&mut self, name: &str) -> Result<(f64, Token<'a>), Error> {
        let before = self.lexer.clone();
        // What a number is for is put into words only where it cannot be read.
        let found = self.lexer.number("");
        found.map_err(|_| self.explain(before, name, "a number", |l, what| l.number(what)))
    }

    /// Numbers, each with its word.
    pub(super) fn numbers<const N: usize>(
        &mut self,
        name: &str,
    ) -> Result<([f64; N], [Token<'a>; N]), Error> {
        let mut numbers = [0.0; N];
        let mut tokens = [self.token; N];
        for (number, token) in numbers.iter_mut().zip(&mut tokens) {
            (*number, *token) = self.number(name)?;
        }
        Ok((numbers, tokens))
    }

    /// The next argument, a number above 0.
    pub(super) fn positive(&mut self, name: &str) -> Result<f64, Error> {
        let (x, token) = self.number(name)?;
        if x > 0.0 {
            return Ok(x);
        }
        Err(self.error(&token, format!("expected {name} to be above 0, found {x}")))
    }

    /// A point.
    pub(super) fn vector(&mut self, name: &str) -> Result<DVec3, Error> {
        Ok(DVec3::from_array(self.numbers(name)?.0))
    }

    /// Three numbers that are not all zero, with the first one's word.
    pub(super) fn direction(&mut self, name: &str) -> Result<(DVec3, Token<'a>), Error> {
        let (xyz, [first, ..]) = self.numbers::<3>(name)?;
        let direction = DVec3::from_array(xyz);
        // A direction is made unit length; squares that vanish or overflow leave it none.
        if direction.length_squared().is_normal() {
            return Ok((direction, first));
        }
        let message = format!("expected a direction for {name}, found {xyz:?}");
        Err(self.error(&first, message))
    }

    /// A colour.
    pub(super) fn color(&mut self, name: &str) -> Result<Rgb, Error> {
        Ok(self.numbers(name)?.0)
    }

    /// The next argument, a material number.
    pub(super) fn integer(&mut self, name: &str) -> Result<(i64, Token<'a>), Error> {
        let before = self.lexer.clone();
        let found = self.lexer.integer("");
        found.map_err(|_| self.explain(before, name, "a whole number", |l, what| l.integer(what)))
    }

    /// The next argument, a name.
    pub(super) fn name(&mut self, name: &str) -> Result<Token<'a>, Error> {
        let before = self.lexer.clone();
        let found = self.lexer.word("");
        found.map_err(|_| self.explain(before, name, "a word", |l, what| l.word(what)))
    }
}

/// The error for a word that is no command.
fn unknown(lexer: &Lexer<'_>, token: &Token<'_>) -> Error {
    let word = token.text;
    let refuse = |message: String, help: &str| Error::Unsupported {
        place: Some(Box::new(lexer.place(token))),
        message,
        help: Some(help.into()),
    };
    if word.starts_with("particle") {
        let message = format!("`{word}`: particle scenes are not imported");
        return refuse(
            message,
            "remove the particle commands; the rest of the scene can be drawn",
        );
    }
    if word == "obb" {
        return refuse(
            "`obb`: oriented boxes are not imported".into(),
            "write a box inside a group: begin -1, a rotation matrix, box, end",
        );
    }
    if word.parse::<f64>().is_ok() {
        return lexer
            .expected("a command", Some(token))
            .with_help("the command before it has fewer arguments, or this one lost its word");
    }
    let known: Vec<&str> = COMMANDS.iter().map(|(word, _)| *word).collect();
    let error = lexer.expected("a command", Some(token));
    names::with_advice(error, word, &known)
}
