//! Animated GIF of pictures of one size: one palette for all frames, so that what stands still does not flicker.
//!
//! In: 8-bit pictures and frames a second. Out: the bytes of a GIF that repeats for ever. Each frame after the first holds
//! only the rectangle that changed. No dithering: a pixel has the palette's nearest colour ([`super::palette`]).
//! GIF89a counts time in 1/100 s: delays are rounded so that their sum keeps the asked rate.

use gif::{DisposalMethod, Encoder, Frame, Repeat};
use rayon::prelude::*;

use crate::error::Error;

use super::palette::{Histogram, Palette};
use super::picture::Picture;

/// Most pixels of all frames together: they are held in memory, at 3 bytes each.
pub const MAX_PIXELS: u64 = 1 << 28;
/// Frames a second that viewers honour.
pub const RATES: std::ops::RangeInclusive<u32> = 1..=50;

/// The GIF of some pictures.
///
/// # Errors
/// No picture, pictures of different sizes, sides above 65,535, or a rate outside [`RATES`].
pub fn gif(pictures: &[Picture], frames_per_second: u32) -> Result<Vec<u8>, Error> {
    let (width, height) = size(pictures)?;
    if !RATES.contains(&frames_per_second) {
        let message = format!(
            "{frames_per_second}: expected {} to {}",
            RATES.start(),
            RATES.end()
        );
        return Err(Error::parameter("--fps", message));
    }
    let mut histogram = Histogram::default();
    pictures.iter().for_each(|p| histogram.add(&p.pixels));
    let palette = histogram.palette();
    let indexed: Vec<Vec<u8>> = pictures
        .par_iter()
        .map(|picture| picture.pixels.iter().map(|p| palette.index(*p)).collect())
        .collect();
    let frames: Vec<Frame<'static>> = (0..indexed.len())
        .into_par_iter()
        .map(|i| {
            let before = i.checked_sub(1).map(|i| indexed[i].as_slice());
            let mut frame = changed(before, &indexed[i], width, height);
            frame.delay = delay(i as u64, u64::from(frames_per_second));
            frame.make_lzw_pre_encoded();
            frame
        })
        .collect();
    assemble(width, height, &palette, &frames).map_err(|e| {
        Error::limit(format!(
            "cannot write {width} x {height} pixels as GIF: {e}"
        ))
    })
}

/// The size that all pictures share.
fn size(pictures: &[Picture]) -> Result<(u16, u16), Error> {
    let Some(first) = pictures.first() else {
        return Err(Error::parameter("pictures", "a GIF needs at least one"));
    };
    let fits = |p: &Picture| {
        (p.width, p.height) == (first.width, first.height) && p.pixels.len() == p.width * p.height
    };
    if let Some(other) = pictures.iter().find(|p| !fits(p)) {
        let message = format!(
            "{} x {} beside {} x {}: a GIF has one size",
            other.width, other.height, first.width, first.height
        );
        return Err(Error::parameter("pictures", message));
    }
    match (u16::try_from(first.width), u16::try_from(first.height)) {
        (Ok(w @ 1..), Ok(h @ 1..)) => Ok((w, h)),
        _ => Err(Error::limit(format!(
            "a picture of {} x {} does not fit into a GIF: its sides end at 65,535",
            first.width, first.height
        ))),
    }
}

/// Hundredths of a second from frame `i` to the next, rounded so that the errors do not add up.
fn delay(i: u64, rate: u64) -> u16 {
    let at = |i: u64| (200 * i + rate) / (2 * rate);
    (at(i + 1) - at(i)) as u16
}

/// The rectangle of a frame that differs from the one before; one pixel where nothing does.
fn changed(before: Option<&[u8]>, now: &[u8], width: u16, height: u16) -> Frame<'static> {
    let w = usize::from(width);
    let (mut left, mut right) = (w, 0);
    let (mut top, mut bottom) = (usize::from(height), 0);
    for (y, row) in now.chunks_exact(w).enumerate() {
        let differs = |x: &usize| before.is_none_or(|b| b[y * w + x] != row[*x]);
        let Some(first) = (0..w).find(differs) else {
            continue;
        };
        let last = (first..w).rev().find(differs).unwrap_or(first);
        left = left.min(first);
        right = right.max(last);
        top = top.min(y);
        bottom = y;
    }
    if left == w {
        (left, right, top, bottom) = (0, 0, 0, 0);
    }
    let mut part = Vec::with_capacity((right - left + 1) * (bottom - top + 1));
    for row in now.chunks_exact(w).take(bottom + 1).skip(top) {
        part.extend_from_slice(&row[left..=right]);
    }
    Frame {
        // All are below the picture's size, which fits.
        left: left as u16,
        top: top as u16,
        width: (right - left + 1) as u16,
        height: (bottom - top + 1) as u16,
        buffer: part.into(),
        dispose: DisposalMethod::Keep,
        ..Frame::default()
    }
}

fn assemble(
    width: u16,
    height: u16,
    palette: &Palette,
    frames: &[Frame<'static>],
) -> Result<Vec<u8>, gif::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height, palette.colors.as_flattened())?;
    if frames.len() > 1 {
        encoder.set_repeat(Repeat::Infinite)?;
    }
    for frame in frames {
        encoder.write_lzw_pre_encoded_frame(frame)?;
    }
    drop(encoder);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(f: impl Fn(usize) -> [u8; 3]) -> Picture {
        Picture {
            width: 9,
            height: 5,
            pixels: (0..45).map(f).collect(),
            scale: None,
        }
    }

    /// Every frame as it is shown, and the delays.
    fn decode(bytes: &[u8]) -> (Vec<Vec<[u8; 3]>>, Vec<u16>) {
        let mut decoder = gif::DecodeOptions::new().read_info(bytes).unwrap();
        let palette: Vec<[u8; 3]> = decoder
            .global_palette()
            .unwrap()
            .as_chunks::<3>()
            .0
            .to_vec();
        let w = usize::from(decoder.width());
        let mut screen = vec![[0; 3]; w * usize::from(decoder.height())];
        let (mut shown, mut delays) = (Vec::new(), Vec::new());
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            for (i, index) in frame.buffer.iter().enumerate() {
                let (fw, left, top) = (frame.width, frame.left, frame.top);
                let x = usize::from(left) + i % usize::from(fw);
                let y = usize::from(top) + i / usize::from(fw);
                screen[y * w + x] = palette[usize::from(*index)];
            }
            shown.push(screen.clone());
            delays.push(frame.delay);
        }
        (shown, delays)
    }

    #[test]
    fn frames_come_back_as_they_were() {
        let pictures = [
            picture(|i| [i as u8, 0, 200]),
            picture(|i| [if i == 22 { 99 } else { i as u8 }, 0, 200]),
            picture(|i| [if i == 22 { 99 } else { i as u8 }, 0, 200]),
            picture(|i| [0, i as u8, 200]),
        ];
        let bytes = gif(&pictures, 12).unwrap();
        let (shown, delays) = decode(&bytes);
        for (shown, picture) in shown.iter().zip(&pictures) {
            assert_eq!(*shown, picture.pixels);
        }
        assert_eq!(shown.len(), 4);
        assert_eq!(delays, [8, 9, 8, 8]);
        assert_eq!(bytes, gif(&pictures, 12).unwrap());
        let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
        while decoder.read_next_frame().unwrap().is_some() {}
        assert_eq!(decoder.repeat(), Repeat::Infinite);
    }

    #[test]
    fn delays_keep_the_rate() {
        for rate in RATES {
            let total: u64 = (0..u64::from(rate))
                .map(|i| u64::from(delay(i, u64::from(rate))))
                .sum();
            assert_eq!(total, 100, "{rate} frames a second");
        }
    }

    #[test]
    fn wrong_pictures_are_errors() {
        assert!(gif(&[], 12).is_err());
        assert!(gif(&[picture(|_| [0; 3])], 0).is_err());
        assert!(gif(&[picture(|_| [0; 3])], 51).is_err());
        let other = picture(|_| [0; 3]).enlarged(2);
        assert!(gif(&[picture(|_| [0; 3]), other], 12).is_err());
    }
}
