//! The portable formats: PPM and PGM as text (P3, P2) and binary (P6, P5), 1 to 16 bits; PFM in colour and grey (PF, Pf).
//!
//! PPM and PGM after the manual pages ppm(5) and pgm(5) of Netpbm: a header of words with comments, one white space, the
//! values from the top row down, two bytes each, the larger first, where the largest value is above 255. PFM after Debevec's
//! HDR Shop: a scale whose sign tells the order of the bytes (negative = smaller first), then rows from the bottom up.

use rastray_compare::Encoding;

use super::{Assumed, Decoded, Trouble, checked_size, plane};
use crate::frame::Plane;

/// A file whose first two bytes are one of the six.
pub(super) fn read(bytes: &[u8]) -> Result<Decoded, Trouble> {
    let mut words = Words { bytes, at: 2 };
    match &bytes[..2] {
        b"PF" => floats(words, 3),
        b"Pf" => floats(words, 1),
        magic => {
            let channels = if matches!(magic, b"P3" | b"P6") { 3 } else { 1 };
            let text = matches!(magic, b"P2" | b"P3");
            let size = words.size()?;
            let largest = match words.number("the largest value")? {
                n @ 1..=65535 => n as u32,
                n => {
                    return Err(Trouble::broken(format!(
                        "largest value {n}: expected 1 to 65535"
                    )));
                }
            };
            let count = size.0 * size.1 * channels;
            let values = match text {
                true => text_values(&mut words, count)?,
                false => {
                    let bytes = if largest < 256 { count } else { 2 * count };
                    binary_values(words.rest(bytes)?, count, largest)?
                }
            };
            whole_numbers(size, channels, largest, &values)
        }
    }
}

/// Values up to `largest` as fractions of it.
fn whole_numbers(
    size: (usize, usize),
    channels: usize,
    largest: u32,
    values: &[u32],
) -> Result<Decoded, Trouble> {
    if let Some(beyond) = values.iter().find(|v| **v > largest) {
        return Err(Trouble::broken(format!(
            "value {beyond} is above the largest value {largest}"
        )));
    }
    let fraction = |v: &u32| (f64::from(*v) / f64::from(largest)) as f32;
    let values: Vec<f32> = values.iter().map(fraction).collect();
    Ok(Decoded {
        bits: Some(if largest > 255 { 16 } else { 8 }),
        pixels: plane(size, channels, &values, &mut Vec::new()),
        orientation: 1,
        assumed: Assumed::unmarked(),
        notes: Vec::new(),
    })
}

fn text_values(words: &mut Words, count: usize) -> Result<Vec<u32>, Trouble> {
    // Each value takes a digit and a space, so that a short file cannot ask for much memory.
    if 2 * count > words.bytes.len() + 1 {
        return Err(Trouble::broken(format!(
            "{count} values expected, there cannot be as many"
        )));
    }
    let value = |_| {
        words
            .number("a value")
            .map(|n| n.min(u64::from(u32::MAX)) as u32)
    };
    (0..count).map(value).collect()
}

fn binary_values(data: &[u8], count: usize, largest: u32) -> Result<Vec<u32>, Trouble> {
    if largest < 256 {
        return Ok(exactly(data, count)?
            .iter()
            .map(|b| u32::from(*b))
            .collect());
    }
    let pairs = exactly(data, 2 * count)?.chunks_exact(2);
    Ok(pairs
        .map(|b| u32::from(u16::from_be_bytes([b[0], b[1]])))
        .collect())
}

/// The first `count` bytes; others may follow (a second picture).
fn exactly(data: &[u8], count: usize) -> Result<&[u8], Trouble> {
    data.get(..count)
        .ok_or_else(|| Trouble::broken(format!("{} bytes of pixels, expected {count}", data.len())))
}

/// PFM behind its magic.
fn floats(mut words: Words, channels: usize) -> Result<Decoded, Trouble> {
    let (width, height) = words.size()?;
    let scale = words.word("the scale")?;
    let scale: f64 = scale
        .parse()
        .ok()
        .filter(|s: &f64| s.is_finite() && *s != 0.0)
        .ok_or_else(|| {
            Trouble::broken(format!("scale {scale:?}: expected a number other than 0"))
        })?;
    let length = 4 * width * height * channels;
    let data = exactly(words.rest(length)?, length)?;
    let value = |b: &[u8]| {
        let b = [b[0], b[1], b[2], b[3]];
        if scale < 0.0 {
            f32::from_le_bytes(b)
        } else {
            f32::from_be_bytes(b)
        }
    };
    let rows = data.chunks_exact(4 * width * channels).rev();
    let values: Vec<f32> = rows
        .flat_map(|row| row.chunks_exact(4).map(value))
        .collect();
    let mut notes = Vec::new();
    if scale.abs() != 1.0 {
        notes.push(format!(
            "its scale of {} is not applied: values are taken as stored",
            scale.abs()
        ));
    }
    let pixels: Plane<[f32; 3]> = plane((width, height), channels, &values, &mut notes);
    Ok(Decoded {
        bits: None,
        pixels,
        orientation: 1,
        assumed: Assumed::new(Encoding::Linear, "PFM files hold light"),
        notes,
    })
}

/// The words of a header, between white space and comments.
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    /// The next word, of at most 32 bytes.
    fn word(&mut self, what: &str) -> Result<&'a str, Trouble> {
        while let Some(&byte) = self.bytes.get(self.at) {
            match byte {
                b'#' => {
                    let line = &self.bytes[self.at..];
                    self.at += line.iter().position(|b| *b == b'\n').unwrap_or(line.len());
                }
                b if b.is_ascii_whitespace() => self.at += 1,
                _ => break,
            }
        }
        let rest = &self.bytes[self.at..];
        let ends = |b: &u8| b.is_ascii_whitespace() || *b == b'#';
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        let word = std::str::from_utf8(&rest[..length.min(32)]).ok();
        match word.filter(|word| !word.is_empty() && length <= 32) {
            Some(word) => {
                self.at += length;
                Ok(word)
            }
            None if rest.is_empty() => Err(Trouble::broken(format!("it ends before {what}"))),
            None => Err(Trouble::broken(format!(
                "{what} is no number, at byte {}",
                self.at
            ))),
        }
    }

    fn number(&mut self, what: &str) -> Result<u64, Trouble> {
        let word = self.word(what)?;
        let wrong = || Trouble::broken(format!("{what}: {word:?} is no whole number"));
        let digits = word.bytes().all(|b| b.is_ascii_digit());
        word.parse().ok().filter(|_| digits).ok_or_else(wrong)
    }

    fn size(&mut self) -> Result<(usize, usize), Trouble> {
        let (width, height) = (self.number("the width")?, self.number("the height")?);
        checked_size(width, height)
    }

    /// What follows the one white space after the header, of at least so many bytes. CR LF is one where it leaves as much.
    fn rest(&self, expected: usize) -> Result<&'a [u8], Trouble> {
        match &self.bytes[self.at..] {
            [b'\r', b'\n', rest @ ..] if rest.len() >= expected => Ok(rest),
            [space, rest @ ..] if space.is_ascii_whitespace() => Ok(rest),
            _ => Err(Trouble::broken("it ends before the pixels")),
        }
    }
}
