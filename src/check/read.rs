//! Picture files: PNG (8 and 16 bits), Radiance HDR, OpenEXR, PFM. The ending of the name says which.
//!
//! Alpha is left out. Nothing beyond [`MAX_PIXELS`] is read into memory.

use std::path::Path;

use super::Given;
use crate::error::{Error, Place};
use crate::frame::Plane;
use crate::import::MAX_PIXELS;

/// Bytes of a file, at most: f32 with alpha of the largest picture, and its head.
const MAX_BYTES: u64 = 16 * MAX_PIXELS + (1 << 20);

/// Reads a picture file.
///
/// # Errors
/// A file that cannot be read, is none of these, is broken, or is too large.
pub fn read(path: &Path) -> Result<Given, Error> {
    let name = path.display().to_string();
    let io = |source| Error::io(name.clone(), "read", source);
    let length = std::fs::metadata(path).map_err(io)?.len();
    if length > MAX_BYTES {
        return Err(Error::limit(format!(
            "{name}: {length} bytes are more than {MAX_BYTES}"
        )));
    }
    let bytes = std::fs::read(path).map_err(io)?;
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let wrong = |why: String| {
        Error::input(Place::file(name.clone()), why)
            .with_help("write it again, or save it as an 8-bit PNG")
    };
    let given = match ending.as_deref() {
        Some("png") => decoded(&bytes, image::ImageFormat::Png).map_err(wrong)?,
        Some("hdr") => decoded(&bytes, image::ImageFormat::Hdr).map_err(wrong)?,
        Some("exr") => exr(&bytes).map_err(wrong)?,
        Some("pfm") => pfm(&bytes).map_err(wrong)?,
        other => {
            let message = match other {
                Some(other) => format!("pictures of type .{other} are not read here"),
                None => "a picture file needs an ending".to_owned(),
            };
            return Err(Error::parameter(name, message).with_help("use .png, .exr, .hdr or .pfm"));
        }
    };
    if given.color.data.is_empty() {
        return Err(wrong("a picture without pixels".to_owned()));
    }
    Ok(given)
}

/// PNG and HDR.
fn decoded(bytes: &[u8], format: image::ImageFormat) -> Result<Given, String> {
    let mut reader = image::ImageReader::with_format(std::io::Cursor::new(bytes), format);
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let picture = reader
        .decode()
        .map_err(|e| format!("not a readable picture: {e}"))?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    check_size(width, height)?;
    use image::ColorType::{L8, La8, Rgb8, Rgba8};
    let eight_bits = matches!(picture.color(), L8 | La8 | Rgb8 | Rgba8);
    let data = if eight_bits {
        let values = picture.into_rgb8();
        values
            .pixels()
            .map(|p| p.0.map(|x| f32::from(x) / 255.0))
            .collect()
    } else {
        picture.into_rgb32f().pixels().map(|p| p.0).collect()
    };
    let color = Plane {
        width,
        height,
        data,
    };
    Ok(Given {
        color,
        eight_bits,
        lossy: false,
    })
}

/// The first layer of an EXR that has R, G and B.
fn exr(bytes: &[u8]) -> Result<Given, String> {
    use exr::prelude::{MetaData, ReadChannels, ReadLayers};
    // The size first: the head alone must not make anybody take memory.
    let broken = |e: exr::error::Error| format!("not a readable EXR: {e}");
    let head = MetaData::read_from_buffered(std::io::Cursor::new(bytes), false).map_err(broken)?;
    for layer in &head.headers {
        check_size(layer.layer_size.x(), layer.layer_size.y())?;
    }
    let picture = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| Plane::filled(size.x(), size.y(), [0.0f32; 3]),
            |plane, at, (r, g, b): (f32, f32, f32)| {
                plane.data[at.y() * plane.width + at.x()] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(std::io::Cursor::new(bytes))
        .map_err(broken)?;
    let color = picture.layer_data.channel_data.pixels;
    Ok(Given {
        color,
        eight_bits: false,
        lossy: false,
    })
}

/// The HDR Shop form: `PF`, width and height, a scale whose sign is the byte order, rows from the bottom.
fn pfm(bytes: &[u8]) -> Result<Given, String> {
    let mut rest = bytes;
    let mut word = || {
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace)?;
        let word = std::str::from_utf8(&rest[start..start + length]).ok()?;
        rest = &rest[start + length + 1..];
        Some(word)
    };
    let head = || "the head of a PFM is PF, width, height, scale".to_owned();
    if word() != Some("PF") {
        return Err("not a PFM of three channels: it begins with PF".to_owned());
    }
    let size = [word(), word()].map(|w| w.and_then(|w| w.parse::<usize>().ok()));
    let ([Some(width), Some(height)], Some(Ok(scale))) = (size, word().map(str::parse::<f32>))
    else {
        return Err(head());
    };
    check_size(width, height)?;
    if rest.len() < 12 * width * height {
        return Err(format!(
            "{} bytes of values, expected {}",
            rest.len(),
            12 * width * height
        ));
    }
    let number = |b: &[u8]| {
        let b = [b[0], b[1], b[2], b[3]];
        if scale < 0.0 {
            f32::from_le_bytes(b)
        } else {
            f32::from_be_bytes(b)
        }
    };
    let pixel = |p: &[u8]| [number(&p[0..4]), number(&p[4..8]), number(&p[8..12])];
    let rows = rest[..12 * width * height].chunks_exact(12 * width).rev();
    let data = rows
        .flat_map(|row| row.chunks_exact(12).map(pixel))
        .collect();
    let color = Plane {
        width,
        height,
        data,
    };
    Ok(Given {
        color,
        eight_bits: false,
        lossy: false,
    })
}

fn check_size(width: usize, height: usize) -> Result<(), String> {
    let pixels = (width as u64).saturating_mul(height as u64);
    if pixels == 0 || pixels > MAX_PIXELS {
        return Err(format!(
            "{width}x{height}: expected 1 to {MAX_PIXELS} pixels"
        ));
    }
    Ok(())
}
