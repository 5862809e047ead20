//! Radiance HDR (RGBE): `#?RADIANCE` and `#?RGBE`, flat and run-length coded (old and new), all eight orders of the axes.
//!
//! After the Radiance manual (File Formats, Ward 1994): the header's EXPOSURE and COLORCORR lines, which multiply up, say
//! by what the pixels were multiplied, so they are divided by it. Not read: XYZE. The package `image` reads neither the
//! second magic, nor exposures, nor other axes than -Y +X.

use rastray_compare::Encoding;

use super::{Assumed, Decoded, Trouble, checked_size, orientation, plane};

/// A file that starts with `#?`.
pub(super) fn read(bytes: &[u8]) -> Result<Decoded, Trouble> {
    let mut rest = bytes;
    let mut notes = Vec::new();
    let divisor = header(&mut rest, &mut notes)?;
    let (length, count, order) = axes(line(&mut rest)?)?;
    checked_size(length as u64, count as u64)?;
    let mut values = Vec::new();
    for _ in 0..count {
        for [r, g, b, e] in scanline(&mut rest, length)? {
            let value = |m: u8, c: usize| {
                let m = if e == 0 { 0.0 } else { f64::from(m) };
                (libm::ldexp(m, i32::from(e) - 136) / divisor[c]) as f32
            };
            values.extend([value(r, 0), value(g, 1), value(b, 2)]);
        }
    }
    let stored = plane((length, count), 3, &values, &mut notes);
    Ok(Decoded {
        bits: None,
        pixels: orientation::upright(&stored, order),
        orientation: 1,
        assumed: Assumed::new(Encoding::Linear, "HDR files hold light"),
        notes,
    })
}

/// The next line, without its end.
fn line<'a>(rest: &mut &'a [u8]) -> Result<&'a [u8], Trouble> {
    let end = rest.iter().position(|b| *b == b'\n');
    let end = end.ok_or_else(|| Trouble::broken("it ends in its header"))?;
    let line = &rest[..end];
    *rest = &rest[end + 1..];
    Ok(line.strip_suffix(b"\r").unwrap_or(line))
}

/// Reads up to the empty line; returns what to divide by.
fn header(rest: &mut &[u8], notes: &mut Vec<String>) -> Result<[f64; 3], Trouble> {
    let mut divisor = [1.0; 3];
    line(rest)?;
    loop {
        let line = line(rest)?;
        if line.is_empty() {
            break;
        }
        let text = String::from_utf8_lossy(line);
        let Some((key, value)) = text.split_once('=') else {
            continue;
        };
        let numbers: Vec<f64> = value
            .split_whitespace()
            .filter_map(|w| w.parse().ok())
            .collect();
        let usable = |x: &f64| x.is_finite() && *x > 0.0;
        let wrong = || {
            Trouble::broken(format!(
                "{key} {:?}: expected numbers above 0",
                value.trim()
            ))
        };
        match (key.trim(), &numbers[..]) {
            ("EXPOSURE", [x]) if usable(x) => divisor = divisor.map(|d| d * x),
            ("COLORCORR", [r, g, b]) if [r, g, b].into_iter().all(usable) => {
                divisor = [divisor[0] * r, divisor[1] * g, divisor[2] * b];
            }
            ("EXPOSURE" | "COLORCORR", _) => return Err(wrong()),
            ("FORMAT", _) if value.trim() == "32-bit_rle_xyze" => {
                let message = "this HDR holds XYZ colours (32-bit_rle_xyze), which are not read";
                let help = "convert it to RGBE, for example with `ra_xyze -r`";
                return Err(Trouble::Unsupported(message.into(), help.into()));
            }
            ("FORMAT", _) if value.trim() != "32-bit_rle_rgbe" => {
                let message = format!(
                    "this HDR is of the format {}, which is not read",
                    value.trim()
                );
                return Err(Trouble::Unsupported(
                    message,
                    "write it as 32-bit_rle_rgbe".into(),
                ));
            }
            ("PRIMARIES", _) => notes.push("its primaries are not read".to_owned()),
            _ => {}
        }
    }
    if divisor != [1.0; 3] {
        let [r, g, b] = divisor;
        let by = if r == g && g == b {
            format!("{r}")
        } else {
            format!("{r} {g} {b}")
        };
        notes.push(format!(
            "its values are divided by {by}, the exposure that its header states"
        ));
    }
    Ok(divisor)
}

/// The length of a scan line, how many there are, and how to hold the picture: see [`orientation`].
fn axes(line: &[u8]) -> Result<(usize, usize, u8), Trouble> {
    let text = String::from_utf8_lossy(line);
    let words: Vec<&str> = text.split_whitespace().collect();
    let wrong = || {
        Trouble::broken(format!(
            "resolution {text:?}: expected such as -Y 480 +X 640"
        ))
    };
    let [slow, count, fast, length] = words[..] else {
        return Err(wrong());
    };
    // Y goes up, X to the right; the first axis is that of the scan lines.
    let order = match (slow, fast) {
        ("-Y", "+X") => 1,
        ("-Y", "-X") => 2,
        ("+Y", "-X") => 3,
        ("+Y", "+X") => 4,
        ("+X", "-Y") => 5,
        ("-X", "-Y") => 6,
        ("-X", "+Y") => 7,
        ("+X", "+Y") => 8,
        _ => return Err(wrong()),
    };
    let number = |word: &str| word.parse::<u32>().map_err(|_| wrong());
    Ok((number(length)? as usize, number(count)? as usize, order))
}

/// The pixels of the next scan line.
fn scanline(rest: &mut &[u8], length: usize) -> Result<Vec<[u8; 4]>, Trouble> {
    if let [2, 2, high @ 0..128, low, ..] = **rest
        && usize::from(u16::from_be_bytes([high, low])) == length
        && (8..0x8000).contains(&length)
    {
        *rest = &rest[4..];
        let mut pixels = vec![[0; 4]; length];
        for channel in 0..4 {
            coded(rest, &mut pixels, channel)?;
        }
        return Ok(pixels);
    }
    // Pixels as they are; 1 1 1 n repeats the one before n times, with bytes of n from the lowest up.
    let mut pixels: Vec<[u8; 4]> = Vec::new();
    let mut shift = 0;
    while pixels.len() < length {
        let [r, g, b, e, ..] = **rest else {
            return Err(ends());
        };
        *rest = &rest[4..];
        if let ([1, 1, 1], Some(last)) = ([r, g, b], pixels.last().copied()) {
            let count = usize::from(e) << shift;
            if shift > 16 || pixels.len() + count > length {
                return Err(Trouble::broken("a run is longer than its line"));
            }
            pixels.resize(pixels.len() + count, last);
            shift += 8;
        } else {
            pixels.push([r, g, b, e]);
            shift = 0;
        }
    }
    Ok(pixels)
}

/// One channel of a scan line: runs (above 128) and bytes as they are.
fn coded(rest: &mut &[u8], pixels: &mut [[u8; 4]], channel: usize) -> Result<(), Trouble> {
    let mut at = 0;
    while at < pixels.len() {
        let (code, run) = match **rest {
            [code @ 129..=255, _, ..] => (usize::from(code) - 128, true),
            [code @ 1..=128, ..] => (usize::from(code), false),
            [0, ..] => return Err(Trouble::broken("a run of no pixels")),
            _ => return Err(ends()),
        };
        let bytes = if run { 1 } else { code };
        let (values, behind) = rest[1..].split_at_checked(bytes).ok_or_else(ends)?;
        let Some(part) = pixels.get_mut(at..at + code) else {
            return Err(Trouble::broken("a run is longer than its line"));
        };
        for (i, pixel) in part.iter_mut().enumerate() {
            pixel[channel] = values[if run { 0 } else { i }];
        }
        (at, *rest) = (at + code, behind);
    }
    Ok(())
}

fn ends() -> Trouble {
    Trouble::broken("it ends before its last pixel")
}
