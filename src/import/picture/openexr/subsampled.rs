//! Luminance-chroma files with chroma of every other pixel, which the package `exr` refuses: one part of scan lines,
//! uncompressed, RLE, ZIPS or ZIP. After "OpenEXR File Layout" (Academy Software Foundation).

use std::io::Read;

use super::luminance::{self, fill_in, weights};
use super::{Trouble, checked_size};
use crate::frame::Plane;

/// Whether the version field says tiles, deep data or several parts.
const UNUSUAL: u32 = 0x1a00;

/// What the header says of a channel.
struct Channel {
    name: String,
    /// 0 = u32, 1 = f16, 2 = f32.
    kind: u32,
    step: [usize; 2],
}

/// A window, in pixels: left, top, width, height.
pub(super) type Window = (i64, i64, usize, usize);

/// What is needed of a header.
#[derive(Default)]
struct Header {
    channels: Vec<Channel>,
    compression: u8,
    data: Option<Window>,
    display: Option<Window>,
    primaries: Option<[[f64; 2]; 4]>,
}

/// A picture: its pixels, their window, and the picture's.
pub(super) struct Found {
    pub(super) pixels: Plane<[f32; 3]>,
    pub(super) data: Window,
    pub(super) display: Window,
}

/// The bytes of a file, from the front.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Trouble> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or_else(ends)?;
        self.0 = rest;
        Ok(taken)
    }

    fn int(&mut self) -> Result<i32, Trouble> {
        let b = self.take(4)?;
        Ok(i32::from_le_bytes([b[0], b[1], b[2], b[3]]))
    }

    fn float(&mut self) -> Result<f64, Trouble> {
        Ok(f64::from(f32::from_bits(self.int()? as u32)))
    }

    /// A text that a zero ends.
    fn text(&mut self) -> Result<String, Trouble> {
        let end = self
            .0
            .iter()
            .take(256)
            .position(|b| *b == 0)
            .ok_or_else(ends)?;
        let text = String::from_utf8_lossy(&self.0[..end]).into_owned();
        self.0 = &self.0[end + 1..];
        Ok(text)
    }

    fn window(&mut self) -> Result<Window, Trouble> {
        let [left, top, right, bottom] =
            [self.int()?, self.int()?, self.int()?, self.int()?].map(i64::from);
        let side = |low: i64, high: i64| u64::try_from(high - low + 1).unwrap_or(0);
        let (width, height) = checked_size(side(left, right), side(top, bottom))?;
        Ok((left, top, width, height))
    }
}

fn ends() -> Trouble {
    Trouble::broken("it ends too early")
}

fn unsupported(what: &str) -> Trouble {
    let message = format!("this EXR has subsampled chroma and {what}, which is not read");
    Trouble::Unsupported(
        message,
        "write it with ZIP compression, or as R, G and B".into(),
    )
}

/// Reads a file whose chroma is subsampled.
pub(super) fn read(bytes: &[u8]) -> Result<Found, Trouble> {
    let mut rest = Bytes(bytes);
    rest.take(4)?;
    if rest.int()? as u32 & UNUSUAL != 0 {
        return Err(unsupported("tiles, deep data or several parts"));
    }
    let header = header(&mut rest)?;
    let (Some(data), Some(display)) = (header.data, header.display) else {
        return Err(Trouble::broken("a window is missing"));
    };
    let find = |name: &str, step: usize| {
        let found = header
            .channels
            .iter()
            .position(|c| c.name == name && c.step == [step; 2]);
        found.ok_or_else(|| unsupported("channels other than Y, RY and BY at half size"))
    };
    let [y, ry, by] = [find("Y", 1)?, find("RY", 2)?, find("BY", 2)?];
    let planes = planes(&mut rest, &header, data)?;
    let (_, _, width, height) = data;
    let [ry, by] = [ry, by].map(|channel| fill_in(&planes[channel], width, height));
    let yw = header.primaries.and_then(weights);
    let yw = yw.unwrap_or_else(luminance::default_weights);
    let luma = planes[y].iter().zip(ry.iter().zip(&by));
    let pixels = luma
        .map(|(y, (ry, by))| luminance::rgb(*y, *ry, *by, yw))
        .collect();
    let pixels = Plane {
        width,
        height,
        data: pixels,
    };
    Ok(Found {
        pixels,
        data,
        display,
    })
}

fn header(rest: &mut Bytes<'_>) -> Result<Header, Trouble> {
    let mut header = Header::default();
    loop {
        let name = rest.text()?;
        if name.is_empty() {
            return Ok(header);
        }
        rest.text()?;
        let size = usize::try_from(rest.int()?).map_err(|_| ends())?;
        let mut value = Bytes(rest.take(size)?);
        match name.as_str() {
            "channels" => header.channels = channels(&mut value)?,
            "compression" => header.compression = value.take(1)?[0],
            "dataWindow" => header.data = Some(value.window()?),
            "displayWindow" => header.display = Some(value.window()?),
            "chromaticities" => {
                let mut primaries = [[0.0; 2]; 4];
                for x in primaries.as_flattened_mut() {
                    *x = value.float()?;
                }
                header.primaries = Some(primaries);
            }
            _ => {}
        }
    }
}

fn channels(value: &mut Bytes<'_>) -> Result<Vec<Channel>, Trouble> {
    let mut channels = Vec::new();
    loop {
        let name = value.text()?;
        if name.is_empty() {
            return Ok(channels);
        }
        let kind = value.int()? as u32;
        value.take(4)?;
        let step = [value.int()?, value.int()?].map(|s| usize::try_from(s).unwrap_or(0));
        if kind > 2 || step.contains(&0) {
            return Err(Trouble::broken(format!(
                "channel {name} is of no known kind"
            )));
        }
        channels.push(Channel { name, kind, step });
    }
}

impl Channel {
    fn bytes(&self) -> usize {
        if self.kind == 1 { 2 } else { 4 }
    }

    fn value(&self, b: &[u8]) -> f32 {
        match (self.kind, b) {
            (1, [a, b]) => half::f16::from_le_bytes([*a, *b]).to_f32(),
            (0, [a, b, c, d]) => u32::from_le_bytes([*a, *b, *c, *d]) as f32,
            (_, [a, b, c, d]) => f32::from_le_bytes([*a, *b, *c, *d]),
            _ => 0.0,
        }
    }

    /// How many samples a line has; none where it is left out.
    fn samples(&self, (left, _, width, _): Window, y: i64) -> usize {
        let step = self.step.map(|s| s as i64);
        if y.rem_euclid(step[1]) != 0 {
            return 0;
        }
        (left..left + width as i64)
            .filter(|x| x.rem_euclid(step[0]) == 0)
            .count()
    }
}

/// The samples of each channel.
fn planes(rest: &mut Bytes<'_>, header: &Header, data: Window) -> Result<Vec<Vec<f32>>, Trouble> {
    let lines = match header.compression {
        0..=2 => 1,
        3 => 16,
        _ => return Err(unsupported("a compression other than ZIP, ZIPS or RLE")),
    };
    let (_, top, _, height) = data;
    let blocks = height.div_ceil(lines);
    rest.take(8 * blocks)?;
    let mut parts: Vec<Option<Vec<u8>>> = vec![None; blocks];
    for _ in 0..blocks {
        // Blocks may stand in any order.
        let y = i64::from(rest.int()?) - top;
        let size = usize::try_from(rest.int()?).map_err(|_| ends())?;
        let part = rest.take(size)?;
        let block = usize::try_from(y).ok().filter(|y| y % lines == 0);
        let slot = block.and_then(|y| parts.get_mut(y / lines));
        *slot.ok_or_else(|| Trouble::broken("a block lies outside"))? = Some(part.to_vec());
    }
    let mut planes: Vec<Vec<f32>> = header.channels.iter().map(|_| Vec::new()).collect();
    for (block, part) in parts.into_iter().enumerate() {
        let first = top + (block * lines) as i64;
        let rows = first..(first + lines as i64).min(top + height as i64);
        let counts = |y: i64| {
            header
                .channels
                .iter()
                .map(move |c| c.samples(data, y) * c.bytes())
        };
        let expected: usize = rows.clone().flat_map(counts).sum();
        let part = part.ok_or_else(|| Trouble::broken("a block is missing"))?;
        let raw = unpacked(part, expected, header.compression)?;
        let mut raw = Bytes(&raw);
        for y in rows {
            for (channel, plane) in header.channels.iter().zip(&mut planes) {
                let bytes = raw.take(channel.samples(data, y) * channel.bytes())?;
                plane.extend(
                    bytes
                        .chunks_exact(channel.bytes())
                        .map(|b| channel.value(b)),
                );
            }
        }
    }
    Ok(planes)
}

/// A block as it was before compression.
fn unpacked(part: Vec<u8>, expected: usize, compression: u8) -> Result<Vec<u8>, Trouble> {
    if part.len() == expected || compression == 0 {
        // Blocks that compression does not shorten are stored as they are.
        return Ok(part);
    }
    let mut bytes = Vec::new();
    if compression == 1 {
        let mut rest = Bytes(&part);
        while let [code, ..] = *rest.0 {
            rest.take(1)?;
            match code as i8 {
                count @ ..0 => bytes.extend(rest.take(usize::from(count.unsigned_abs()))?),
                count => bytes.extend(std::iter::repeat_n(rest.take(1)?[0], count as usize + 1)),
            }
        }
    } else {
        let unzip = flate2::read::ZlibDecoder::new(&part[..]);
        let limit = expected as u64 + 1;
        unzip
            .take(limit)
            .read_to_end(&mut bytes)
            .map_err(Trouble::broken)?;
    }
    if bytes.len() != expected {
        return Err(ends());
    }
    // Differences to values, then the halves of the block are merged, byte by byte.
    for i in 1..bytes.len() {
        bytes[i] = bytes[i].wrapping_add(bytes[i - 1]).wrapping_sub(128);
    }
    let (even, odd) = bytes.split_at(bytes.len().div_ceil(2));
    let merged = (0..bytes.len()).map(|i| if i % 2 == 0 { even[i / 2] } else { odd[i / 2] });
    Ok(merged.collect())
}
