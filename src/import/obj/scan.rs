//! The line scan of an OBJ file: statements to plain lists, every complaint with its place.
//!
//! Works on bytes, since comments and names in the wild are not always UTF-8. A line ends at a line feed that no `\`
//! precedes; such a `\` is a blank. Comments never go on, nor does a line before one that starts with a keyword. Indices
//! become 0-based; they may point forward, so they are checked at the end, and so is whether anything needs what could
//! not be read.

use std::collections::HashMap;
use std::ops::Range;

use super::names;
use super::words::{Words, line_at, place};
use crate::error::{Error, Note};
use crate::import::polygon;
use crate::import::text::decode;
use crate::math::{DVec2, DVec3};

/// No index.
pub(super) const NONE: u32 = u32::MAX;

/// Statements that draw nothing here: points, lines, free-form curves and surfaces, display attributes.
pub(super) const DROPPED: [&str; 34] = [
    "p",
    "l",
    "vp",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "mg",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "usemap",
    "maplib",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "call",
    "csh",
    "bsp",
    "bzp",
    "cdc",
    "res",
];

/// Statements that are read.
const READ: [&str; 9] = ["v", "vt", "vn", "f", "o", "g", "s", "usemtl", "mtllib"];

/// Whether a word is one of OBJ's statements.
pub(super) fn is_keyword(word: &[u8]) -> bool {
    READ.iter().chain(&DROPPED).any(|k| k.as_bytes() == word)
}

/// The most items that cannot be read before the file is refused.
const MAX_UNUSABLE: usize = 1024;

/// A vertex, texture coordinate or normal that cannot be read.
#[derive(Debug)]
pub(super) struct Unusable {
    /// `v`, `vt` or `vn`.
    pub(super) keyword: &'static str,
    pub(super) index: u32,
    pub(super) wrong: Wrong,
    /// Its numbers are there, but not all finite.
    pub(super) infinite: bool,
}

/// What is wrong, and where.
#[derive(Debug)]
pub(super) struct Wrong {
    pub(super) span: Range<usize>,
    pub(super) message: String,
    pub(super) help: Option<&'static str>,
}

/// A face: where its corners end, and where its line starts in the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) end: u32,
    pub(super) line: u32,
}

/// What holds from a face on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    pub(super) first_face: u32,
    pub(super) attributes: Attributes,
}

/// State that faces take on. Names are numbers into the scan's lists.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Attributes {
    /// `usemtl`; [`NONE`] before the first.
    pub(super) material: u32,
    /// `s`; 0 = off.
    pub(super) smoothing: u32,
    /// `o`; [`NONE`] before the first.
    pub(super) object: u32,
    /// `g`; [`NONE`] before the first.
    pub(super) group: u32,
}

/// Names in order of appearance, as their bytes.
#[derive(Debug, Default)]
pub(super) struct Interned {
    pub(super) list: Vec<Vec<u8>>,
    index: HashMap<Vec<u8>, u32>,
}

impl Interned {
    fn number(&mut self, name: Vec<u8>) -> u32 {
        let list = &mut self.list;
        *self.index.entry(name).or_insert_with_key(|name| {
            list.push(name.clone());
            list.len() as u32 - 1
        })
    }
}

/// Everything an OBJ file says.
#[derive(Debug)]
pub(super) struct Scan {
    pub(super) positions: Vec<DVec3>,
    pub(super) texcoords: Vec<DVec2>,
    pub(super) normals: Vec<DVec3>,
    /// Position of each corner.
    pub(super) corners: Vec<u32>,
    /// Texture coordinate of each corner; shorter than `corners` where the rest have none.
    pub(super) corner_texcoords: Vec<u32>,
    /// Normal of each corner; shorter than `corners` where the rest have none.
    pub(super) corner_normals: Vec<u32>,
    pub(super) faces: Vec<Face>,
    pub(super) runs: Vec<Run>,
    pub(super) materials: Interned,
    pub(super) objects: Interned,
    pub(super) groups: Interned,
    /// `mtllib` lines: the rest of the line, and its bytes in the file.
    pub(super) libraries: Vec<(Vec<u8>, Range<usize>)>,
    /// What could not be read.
    pub(super) unusable: Vec<Unusable>,
    /// Faces of fewer than three corners: how many, and the first.
    pub(super) thin: Option<(usize, Wrong)>,
    /// A `\` at a line's end that joins nothing: how many, and the first.
    pub(super) stray: Option<(usize, Range<usize>)>,
    pub(super) notes: Vec<Note>,
    /// Statements that were dropped: keyword, count, first place.
    pub(super) dropped: Vec<(String, usize, Range<usize>)>,
}

impl Scan {
    /// Takes back the corners from a number on.
    fn drop_corners(&mut self, first: usize) {
        self.corners.truncate(first);
        self.corner_texcoords.truncate(first);
        self.corner_normals.truncate(first);
    }
}

/// Scans a file.
pub(super) fn scan(file: &str, bytes: &[u8]) -> Result<Scan, Error> {
    let mut scanner = Scanner {
        file,
        bytes,
        now: Attributes {
            material: NONE,
            smoothing: 0,
            object: NONE,
            group: NONE,
        },
        scan: Scan {
            positions: Vec::new(),
            texcoords: Vec::new(),
            normals: Vec::new(),
            corners: Vec::new(),
            corner_texcoords: Vec::new(),
            corner_normals: Vec::new(),
            faces: Vec::new(),
            runs: Vec::new(),
            materials: Interned::default(),
            objects: Interned::default(),
            groups: Interned::default(),
            libraries: Vec::new(),
            unusable: Vec::new(),
            thin: None,
            stray: None,
            notes: Vec::new(),
            dropped: Vec::new(),
        },
    };
    let mut start = if bytes.starts_with(b"\xef\xbb\xbf") {
        3
    } else {
        0
    };
    while start < bytes.len() {
        let line = line_at(bytes, start, is_keyword);
        scanner.line(start..line.end)?;
        if line.stray {
            let last = start + bytes[start..line.end].trim_ascii_end().len();
            let found = &mut scanner.scan.stray;
            found.get_or_insert((0, last - 1..last)).0 += 1;
        }
        start = line.next.max(line.end + 1);
    }
    scanner.finish()
}

/// A scan under way.
pub(super) struct Scanner<'a> {
    pub(super) file: &'a str,
    pub(super) bytes: &'a [u8],
    now: Attributes,
    pub(super) scan: Scan,
}

impl Scanner<'_> {
    pub(super) fn text(&self, span: &Range<usize>) -> String {
        decode(&self.bytes[span.clone()]).into_owned()
    }

    pub(super) fn error(&self, span: Range<usize>, message: impl Into<String>) -> Error {
        Error::input(place(self.file, self.bytes, span), message)
    }

    fn line(&mut self, line: Range<usize>) -> Result<(), Error> {
        let mut words = Words::new(self.bytes, line.clone());
        let Some(keyword) = words.next() else {
            return Ok(());
        };
        match &self.bytes[keyword.clone()] {
            b"v" => self.position(keyword, words),
            b"f" => self.face(line.start, keyword, words),
            b"vn" => {
                let normal = self.numbers::<3>(&keyword, &mut words, 3);
                let index = self.scan.normals.len();
                // A normal that is not one has no length: see `build`.
                let normal = self.usable("vn", index, normal)?.unwrap_or([0.0; 3]);
                self.scan.normals.push(DVec3::from_array(normal));
                Ok(())
            }
            b"vt" => {
                let texcoord = self.numbers::<2>(&keyword, &mut words, 1);
                let index = self.scan.texcoords.len();
                let texcoord = self.usable("vt", index, texcoord)?.unwrap_or([0.0; 2]);
                self.scan.texcoords.push(DVec2::from_array(texcoord));
                Ok(())
            }
            b"usemtl" | b"o" | b"g" => {
                self.name(keyword, &words.rest());
                Ok(())
            }
            b"s" => self.smoothing(keyword, words),
            b"mtllib" => {
                let rest = words.rest();
                let name = Words::joined(self.bytes, rest.clone());
                self.scan.libraries.push((name, rest));
                Ok(())
            }
            _ => {
                self.drop(keyword);
                Ok(())
            }
        }
    }

    /// `usemtl`, `o` or `g`: names run to the end of the line.
    fn name(&mut self, keyword: Range<usize>, rest: &Range<usize>) {
        let name = Words::joined(self.bytes, rest.clone());
        let (scan, now) = (&mut self.scan, &mut self.now);
        match self.bytes[keyword.start] {
            b'u' => now.material = scan.materials.number(name),
            b'o' => now.object = scan.objects.number(names::label(&name).to_vec()),
            _ => now.group = scan.groups.number(names::label(&name).to_vec()),
        }
    }

    /// The numbers of an item, or none where they cannot be read; what needs it is told at the end.
    fn usable<const N: usize>(
        &mut self,
        keyword: &'static str,
        index: usize,
        found: Result<[f64; N], (Wrong, bool)>,
    ) -> Result<Option<[f64; N]>, Error> {
        let (wrong, infinite) = match found {
            Ok(numbers) => return Ok(Some(numbers)),
            Err(wrong) => wrong,
        };
        if self.scan.unusable.len() >= MAX_UNUSABLE {
            return Err(self.wrong(&wrong));
        }
        self.scan.unusable.push(Unusable {
            keyword,
            index: index as u32,
            wrong,
            infinite,
        });
        Ok(None)
    }

    /// What is wrong as an error.
    pub(super) fn wrong(&self, wrong: &Wrong) -> Error {
        let error = self.error(wrong.span.clone(), wrong.message.clone());
        match wrong.help {
            Some(help) => error.with_help(help),
            None => error,
        }
    }

    fn drop(&mut self, keyword: Range<usize>) {
        let name = self.text(&keyword);
        let dropped = &mut self.scan.dropped;
        match dropped.iter().position(|d| d.0 == name) {
            Some(entry) => dropped[entry].1 += 1,
            // A file of nothing but unknown words must not make a long list.
            None if dropped.len() < 64 => dropped.push((name, 1, keyword)),
            None => {}
        }
    }

    /// A finite number; else what is wrong, and whether it is only not finite.
    fn number(&self, word: Range<usize>) -> Result<f64, (Wrong, bool)> {
        let text = std::str::from_utf8(&self.bytes[word.clone()]).unwrap_or("");
        let parsed = text.parse::<f64>();
        if let Ok(x) = parsed
            && x.is_finite()
            && x.abs() <= f64::from(f32::MAX)
        {
            return Ok(x);
        }
        let found = self.text(&word);
        let infinite = parsed.is_ok();
        let what = if infinite {
            "a finite number"
        } else {
            "a number"
        };
        let comma = text.contains(',');
        let wrong = Wrong {
            span: word,
            message: format!("expected {what}, found `{found}`"),
            help: comma.then_some("write decimals with a point"),
        };
        Err((wrong, infinite))
    }

    /// Up to N numbers, at least `least`; missing ones are 0.
    fn numbers<const N: usize>(
        &self,
        keyword: &Range<usize>,
        words: &mut Words<'_>,
        least: usize,
    ) -> Result<[f64; N], (Wrong, bool)> {
        let mut numbers = [0.0; N];
        for (i, x) in numbers.iter_mut().enumerate() {
            match words.next() {
                Some(word) => *x = self.number(word)?,
                None if i < least => {
                    let name = self.text(keyword);
                    let wrong = Wrong {
                        span: keyword.clone(),
                        message: format!("`{name}` needs {least} numbers, found {i}"),
                        help: None,
                    };
                    return Err((wrong, false));
                }
                None => break,
            }
        }
        Ok(numbers)
    }

    /// `v x y z`, and what some programs put behind: a weight (4 numbers) or a colour (6 or 7).
    fn position(&mut self, keyword: Range<usize>, mut words: Words<'_>) -> Result<(), Error> {
        let position = self.numbers::<3>(&keyword, &mut words, 3);
        let index = self.scan.positions.len();
        let position = self.usable("v", index, position)?.unwrap_or([f64::NAN; 3]);
        self.scan.positions.push(DVec3::from_array(position));
        let mut extra = 0;
        let mut last = 0.0;
        for word in words {
            // They are dropped anyway, so that one of them may be anything.
            last = self.number(word).unwrap_or(0.0);
            extra += 1;
        }
        if extra == 1 && last == 1.0 {
            return Ok(()); // w = 1 says nothing
        }
        if extra > 0 {
            let what = if extra >= 3 {
                "vertex colours"
            } else {
                "vertex weights"
            };
            let known = self.scan.notes.iter().any(|n| n.message.starts_with(what));
            if !known {
                self.scan.notes.push(Note {
                    place: Some(place(self.file, self.bytes, keyword)),
                    message: format!("{what} are dropped"),
                });
            }
        }
        Ok(())
    }

    fn smoothing(&mut self, keyword: Range<usize>, mut words: Words<'_>) -> Result<(), Error> {
        let word = words.next().unwrap_or(keyword);
        let text = self.text(&word);
        self.now.smoothing = match text.as_str() {
            "off" | "s" => 0,
            "on" => 1,
            number => number.parse().map_err(|_| {
                let message = format!("expected a smoothing group or `off`, found `{number}`");
                self.error(word, message)
            })?,
        };
        Ok(())
    }

    fn face(&mut self, line: usize, keyword: Range<usize>, words: Words<'_>) -> Result<(), Error> {
        let first = self.scan.corners.len();
        for word in words {
            self.corner(word)?;
        }
        let count = self.scan.corners.len() - first;
        if count < 3 {
            let wrong = Wrong {
                span: keyword,
                message: format!("a face needs 3 corners or more, found {count}"),
                help: None,
            };
            self.scan.thin.get_or_insert((0, wrong)).0 += 1;
            self.scan.drop_corners(first);
            return Ok(());
        }
        if count > polygon::MAX_CORNERS {
            let most = polygon::MAX_CORNERS;
            let message = format!("a face of {count} corners; the most is {most}");
            return Err(self.error(keyword, message));
        }
        let scan = &mut self.scan;
        if scan
            .runs
            .last()
            .is_none_or(|run| run.attributes != self.now)
        {
            scan.runs.push(Run {
                first_face: scan.faces.len() as u32,
                attributes: self.now,
            });
        }
        scan.faces.push(Face {
            end: scan.corners.len() as u32,
            line: line as u32,
        });
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&mut self, word: Range<usize>) -> Result<(), Error> {
        let bytes = self.bytes;
        let mut parts = bytes[word.clone()].split(|b| *b == b'/');
        let (v, vt, vn) = (parts.next(), parts.next(), parts.next());
        let scan = &self.scan;
        let counts = [
            scan.positions.len(),
            scan.texcoords.len(),
            scan.normals.len(),
        ];
        let position = v.and_then(|part| index(part, counts[0]));
        let optional = |part: Option<&[u8]>, count: usize| match part {
            None | Some(b"") => Some(NONE),
            Some(part) => index(part, count),
        };
        let (texcoord, normal) = (optional(vt, counts[1]), optional(vn, counts[2]));
        let (Some(position), Some(texcoord), Some(normal), None) =
            (position, texcoord, normal, parts.next())
        else {
            return Err(self.corner_error(word));
        };
        let scan = &mut self.scan;
        let corner = scan.corners.len();
        scan.corners.push(position);
        if texcoord != NONE {
            scan.corner_texcoords.resize(corner, NONE);
            scan.corner_texcoords.push(texcoord);
        }
        if normal != NONE {
            scan.corner_normals.resize(corner, NONE);
            scan.corner_normals.push(normal);
        }
        Ok(())
    }
}

/// A 1-based or negative index as a 0-based one; `None` where it is no index at all or reaches before the first.
fn index(part: &[u8], count: usize) -> Option<u32> {
    let (digits, negative) = match part.strip_prefix(b"-") {
        Some(digits) => (digits, true),
        None => (part, false),
    };
    if digits.is_empty() || digits.len() > 10 {
        return None;
    }
    let mut value = 0u64;
    for digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = value * 10 + u64::from(digit - b'0');
    }
    if value == 0 || value >= u64::from(NONE) {
        return None;
    }
    if negative {
        (count as u64).checked_sub(value).map(|i| i as u32)
    } else {
        Some(value as u32 - 1)
    }
}
