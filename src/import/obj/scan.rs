//! The line scan of an OBJ file: statements to plain lists, every complaint with its place.
//!
//! Works on bytes, since comments and names in the wild are not always UTF-8. A line ends at a line feed that no `\`
//! precedes; such a `\` is a blank. Indices become 0-based; they may point forward, so they are checked at the end.

use std::collections::HashMap;
use std::ops::Range;

use crate::error::{Error, Note, Place};
use crate::import::polygon;
use crate::math::{DVec2, DVec3};

/// No index.
pub(super) const NONE: u32 = u32::MAX;

/// Statements that draw nothing here: points, lines, free-form curves and surfaces, display attributes.
const DROPPED: [&str; 34] = [
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

/// A face: where its corners end, and where its line starts in the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) end: u32,
    line: u32,
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

/// Names in order of appearance.
#[derive(Debug, Default)]
pub(super) struct Interned {
    pub(super) list: Vec<String>,
    index: HashMap<String, u32>,
}

impl Interned {
    fn number(&mut self, name: String) -> u32 {
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
    pub(super) libraries: Vec<(String, Range<usize>)>,
    pub(super) notes: Vec<Note>,
    /// Statements that were dropped: keyword, count, first place.
    dropped: Vec<(String, usize, Range<usize>)>,
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
        let end = line_end(bytes, start);
        scanner.line(start..end)?;
        start = end + 1;
    }
    scanner.finish()
}

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

struct Scanner<'a> {
    file: &'a str,
    bytes: &'a [u8],
    now: Attributes,
    scan: Scan,
}

impl Scanner<'_> {
    fn text(&self, span: &Range<usize>) -> String {
        String::from_utf8_lossy(&self.bytes[span.clone()]).into_owned()
    }

    fn error(&self, span: Range<usize>, message: impl Into<String>) -> Error {
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
                let normal = self.numbers::<3>(&keyword, &mut words, 3)?;
                self.scan.normals.push(DVec3::from_array(normal));
                Ok(())
            }
            b"vt" => {
                let texcoord = self.numbers::<2>(&keyword, &mut words, 1)?;
                self.scan.texcoords.push(DVec2::from_array(texcoord));
                Ok(())
            }
            b"usemtl" => {
                let name = self.text(&words.rest());
                self.now.material = self.scan.materials.number(name);
                Ok(())
            }
            b"o" => {
                let name = self.text(&words.rest());
                self.now.object = self.scan.objects.number(name);
                Ok(())
            }
            b"g" => {
                let name = self.text(&words.rest());
                self.now.group = self.scan.groups.number(name);
                Ok(())
            }
            b"s" => self.smoothing(keyword, words),
            b"mtllib" => {
                let rest = words.rest();
                let name = self.text(&rest);
                self.scan.libraries.push((name, rest));
                Ok(())
            }
            _ => {
                self.drop(keyword);
                Ok(())
            }
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

    /// A finite number.
    fn number(&self, word: Range<usize>) -> Result<f64, Error> {
        let text = std::str::from_utf8(&self.bytes[word.clone()]).unwrap_or("");
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() && x.abs() <= f64::from(f32::MAX) => Ok(x),
            Ok(_) => {
                let found = self.text(&word);
                Err(self.error(word, format!("expected a finite number, found `{found}`")))
            }
            Err(_) => {
                let found = self.text(&word);
                let comma = text.contains(',');
                let error = self.error(word, format!("expected a number, found `{found}`"));
                Err(if comma {
                    error.with_help("write decimals with a point")
                } else {
                    error
                })
            }
        }
    }

    /// Up to N numbers, at least `least`; missing ones are 0.
    fn numbers<const N: usize>(
        &self,
        keyword: &Range<usize>,
        words: &mut Words<'_>,
        least: usize,
    ) -> Result<[f64; N], Error> {
        let mut numbers = [0.0; N];
        for (i, x) in numbers.iter_mut().enumerate() {
            match words.next() {
                Some(word) => *x = self.number(word)?,
                None if i < least => {
                    let name = self.text(keyword);
                    let message = format!("`{name}` needs {least} numbers, found {i}");
                    return Err(self.error(keyword.clone(), message));
                }
                None => break,
            }
        }
        Ok(numbers)
    }

    /// `v x y z`, and what some programs put behind: a weight (4 numbers) or a colour (6 or 7).
    fn position(&mut self, keyword: Range<usize>, mut words: Words<'_>) -> Result<(), Error> {
        let position = self.numbers::<3>(&keyword, &mut words, 3)?;
        self.scan.positions.push(DVec3::from_array(position));
        let mut extra = 0;
        let mut last = 0.0;
        for word in words {
            last = self.number(word)?;
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
            let message = format!("a face needs 3 corners or more, found {count}");
            return Err(self.error(keyword, message));
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

    fn corner_error(&self, word: Range<usize>) -> Error {
        let text = self.text(&word);
        let scan = &self.scan;
        let lists = [
            ("vertex", scan.positions.len()),
            ("texture coordinate", scan.texcoords.len()),
            ("normal", scan.normals.len()),
        ];
        for (part, (name, count)) in text.split('/').zip(lists) {
            let message = match part.parse::<i64>() {
                Ok(0) => format!("{name} 0: indices count from 1"),
                Ok(i) if i < 0 => format!("{name} {i}: there are only {count} so far"),
                Ok(i) if i >= i64::from(NONE) => format!("{name} {i} is out of range"),
                _ => continue,
            };
            return self.error(word, message);
        }
        let message = format!("expected a corner v, v/vt, v//vn or v/vt/vn, found `{text}`");
        self.error(word, message)
    }

    fn finish(mut self) -> Result<Scan, Error> {
        if self.scan.faces.is_empty() {
            return Err(self.no_face());
        }
        self.check_indices()?;
        for (name, count, span) in std::mem::take(&mut self.scan.dropped) {
            let known = DROPPED.contains(&name.as_str());
            let what = if known {
                "is not drawn"
            } else {
                "is no OBJ statement"
            };
            let message = match count {
                1 => format!("`{name}` {what}: dropped"),
                _ => format!("`{name}` {what}: dropped {count} times"),
            };
            self.scan.notes.push(Note {
                place: Some(place(self.file, self.bytes, span)),
                message,
            });
        }
        Ok(self.scan)
    }

    /// The file draws nothing: what to say depends on what it holds instead.
    fn no_face(&self) -> Error {
        let strange = self
            .scan
            .dropped
            .iter()
            .find(|d| !DROPPED.contains(&d.0.as_str()));
        match strange {
            Some((name, _, span)) if self.scan.positions.is_empty() => {
                let message =
                    format!("expected an OBJ statement (v, vt, vn, f, ...), found `{name}`");
                self.error(span.clone(), message)
            }
            _ => Error::input(Place::file(self.file), "the mesh has no face"),
        }
    }

    fn check_indices(&self) -> Result<(), Error> {
        let scan = &self.scan;
        let lists: [(&str, &[u32], usize); 3] = [
            ("vertex", &scan.corners, scan.positions.len()),
            (
                "texture coordinate",
                &scan.corner_texcoords,
                scan.texcoords.len(),
            ),
            ("normal", &scan.corner_normals, scan.normals.len()),
        ];
        for (name, indices, count) in lists {
            let beyond = |i: &u32| *i != NONE && *i as usize >= count;
            if let Some(corner) = indices.iter().position(beyond) {
                let message = format!(
                    "{name} {}: there are only {count}",
                    u64::from(indices[corner]) + 1
                );
                return Err(self.error(self.corner_span(corner), message));
            }
        }
        Ok(())
    }

    /// Where a corner stands: its face's line is read again.
    fn corner_span(&self, corner: usize) -> Range<usize> {
        let faces = &self.scan.faces;
        let face = faces.partition_point(|f| f.end as usize <= corner);
        let first = face.checked_sub(1).map_or(0, |f| faces[f].end as usize);
        let start = faces[face].line as usize;
        let mut words = Words::new(self.bytes, start..line_end(self.bytes, start));
        words.nth(corner - first + 1).unwrap_or(start..start + 1)
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
