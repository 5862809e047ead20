//! PNG, JPEG and BMP through the packages that know them.

use std::io::Cursor;

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use rastray_compare::Encoding;

use super::{Assumed, Decoded, PictureFormat, Trouble, bitmap, checked_size, orientation, plane};
use crate::import::MAX_PIXELS;

/// What this program's own files say of themselves, in the text chunk `Encoding`.
const OWN_LINEAR: &str = "rastray: linear";
const OWN_SRGB: &str = "rastray: sRGB";

/// A PNG of any colour type and depth; of an animation, the first frame.
pub(super) fn png(bytes: &[u8]) -> Result<Decoded, Trouble> {
    // Text and profiles beside the pixels; `image data` is checked by its size first.
    let limits = png::Limits { bytes: 64 << 20 };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(Trouble::broken)?;
    let (width, height) = reader.info().size();
    let size = checked_size(width.into(), height.into())?;
    let length = reader.output_buffer_size();
    let mut buffer = vec![0; length.ok_or(Trouble::TooLarge(width.into(), height.into()))?];
    let output = reader.next_frame(&mut buffer).map_err(Trouble::broken)?;
    let mut notes = Vec::new();
    if reader.info().animation_control.is_some() {
        notes.push("of this animation the first frame is taken".to_owned());
    } else {
        // Text may follow the pixels, and the end must be there.
        reader.finish().map_err(Trouble::broken)?;
    }
    let wide = output.bit_depth == png::BitDepth::Sixteen;
    let values: Vec<f32> = if wide {
        let pairs = buffer.chunks_exact(2);
        let value = |b: &[u8]| u16::from_be_bytes([b[0], b[1]]);
        pairs.map(|b| f32::from(value(b)) / 65535.0).collect()
    } else {
        buffer.iter().map(|b| f32::from(*b) / 255.0).collect()
    };
    let pixels = plane(size, output.color_type.samples(), &values, &mut notes);
    Ok(Decoded {
        bits: Some(if wide { 16 } else { 8 }),
        pixels,
        orientation: reader
            .info()
            .exif_metadata
            .as_deref()
            .map_or(1, orientation::of_exif),
        assumed: png_encoding(reader.info()),
        notes,
    })
}

/// What the chunks say, the most definite first.
fn png_encoding(info: &png::Info) -> Assumed {
    let mut texts = info.uncompressed_latin1_text.iter();
    let own = texts.find(|t| t.keyword == "Encoding");
    let says = |start| own.is_some_and(|t| t.text.starts_with(start));
    let gamma = info.gamma().map(|g| g.into_value());
    match gamma {
        _ if says(OWN_LINEAR) => Assumed::new(Encoding::Linear, "rastray wrote it and says so"),
        _ if says(OWN_SRGB) => Assumed::new(Encoding::Srgb, "rastray wrote it and says so"),
        _ if info.srgb.is_some() => Assumed::new(Encoding::Srgb, "its sRGB chunk says so"),
        _ if info.icc_profile.is_some() => {
            Assumed::new(Encoding::Srgb, "it has a colour profile, which is not read")
        }
        Some(gamma) if (gamma - 1.0).abs() < 0.01 => {
            Assumed::new(Encoding::Linear, "its gAMA chunk says so")
        }
        Some(gamma) => Assumed {
            encoding: Encoding::Srgb,
            why: format!("its gAMA chunk says {gamma:.3}, and sRGB is near 0.455"),
        },
        None => Assumed::unmarked(),
    }
}

/// JPEG and BMP.
pub(super) fn other(format: PictureFormat, bytes: &[u8]) -> Result<Decoded, Trouble> {
    let known = match format {
        PictureFormat::Jpeg => ImageFormat::Jpeg,
        _ => ImageFormat::Bmp,
    };
    if known == ImageFormat::Jpeg {
        refuse_jpeg_kinds(bytes)?;
        // The decoder fills what is missing with grey.
        if !ends_as_jpeg(bytes) {
            return Err(Trouble::broken("its end mark is missing"));
        }
    } else if let Some(deep) = bitmap::deep(bytes)? {
        return Ok(deep);
    }
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(16 * MAX_PIXELS);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), known);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(|e| refused(format, e))?;
    let (width, height) = decoder.dimensions();
    let size = checked_size(width.into(), height.into())?;
    // Data that cannot be read say nothing.
    let exif = decoder.exif_metadata().ok().flatten();
    let picture = DynamicImage::from_decoder(decoder).map_err(|e| refused(format, e))?;
    let mut notes = Vec::new();
    let (channels, values) = if picture.color().has_alpha() {
        (4, fractions(&picture.into_rgba8()))
    } else {
        (3, fractions(&picture.into_rgb8()))
    };
    let pixels = plane(size, channels, &values, &mut notes);
    Ok(Decoded {
        bits: Some(8),
        pixels,
        orientation: exif.as_deref().map_or(1, orientation::of_exif),
        assumed: Assumed::unmarked(),
        notes,
    })
}

/// Why the package refused a file: its kind, or what is in it.
fn refused(format: PictureFormat, error: image::ImageError) -> Trouble {
    match error {
        image::ImageError::Unsupported(what) => {
            let message = format!(
                "this {} is of a kind that is not read: {what}",
                format.name()
            );
            Trouble::Unsupported(message, "save the picture as PNG".into())
        }
        error => Trouble::broken(error),
    }
}

/// Refuses the kinds of JPEG that hardly anything reads, by the mark before the size (ITU-T T.81, table B.1).
fn refuse_jpeg_kinds(bytes: &[u8]) -> Result<(), Trouble> {
    let mut at = 2;
    while let Some(&[0xff, mark, high, low, precision, ..]) = bytes.get(at..) {
        if mark == 0xff {
            at += 1;
            continue;
        }
        let frame = matches!(mark, 0xc0..=0xcf) && !matches!(mark, 0xc4 | 0xc8 | 0xcc);
        if mark == 0xda || frame && mark <= 0xc2 && precision == 8 {
            return Ok(());
        }
        if frame {
            let kind = match mark {
                0xc0..=0xc2 => format!("a JPEG of {precision} bits a value"),
                0xc3 => "a lossless JPEG".to_owned(),
                0xc5..=0xc7 => "a hierarchical JPEG".to_owned(),
                _ => "a JPEG with arithmetic coding".to_owned(),
            };
            let message = format!("this is {kind}, which is not read");
            return Err(Trouble::Unsupported(
                message,
                "save the picture as PNG".into(),
            ));
        }
        at += 2 + usize::from(u16::from_be_bytes([high, low]));
    }
    Ok(())
}

fn fractions(bytes: &[u8]) -> Vec<f32> {
    bytes.iter().map(|b| f32::from(*b) / 255.0).collect()
}

/// Whether the end mark is there; zeros may follow it.
fn ends_as_jpeg(bytes: &[u8]) -> bool {
    let end = bytes.iter().rposition(|b| *b != 0).map_or(0, |i| i + 1);
    bytes[..end].ends_with(&[0xff, 0xd9])
}
