//! Bytes of single pictures: PNG, PFM, Radiance HDR.
//!
//! In: linear, unclamped f32, top row first. What each format does with it:
//!
//! | format | values | says which encoding it holds |
//! | - | - | - |
//! | PNG | clamped to [0, 1], round(255 x), after the view transform | text chunk `Encoding`; an `sRGB` chunk with `--srgb`, and no `gAMA` or `sRGB` chunk without (a viewer must show the stored values as they are, as OpenGL's window did) |
//! | PFM | f32 as they are, bottom row first, little endian | cannot: a note where it is not linear |
//! | HDR | 8-bit mantissas, one exponent a pixel, rounded to nearest; negative values become 0 | cannot |
//!
//! PFM: the layout of Paul Debevec's HDR Shop (`PF`, size, negative scale = little endian). HDR: Ward's RGBE through the
//! `image` crate; the rounding is done here, because that encoder truncates and takes tiny values for huge ones.

use std::borrow::Cow;

use crate::error::{Error, Note};
use crate::frame::Plane;
use crate::math::color::{quantize8, srgb_from_linear};

use super::files::{Encoded, View};
use super::picture::Picture;

/// What the text chunk of a PNG with linear values says.
pub const LINEAR_TEXT: &str = "rastray: linear values stored as displayed (no transfer function)";
/// What the text chunk of a PNG with the view transform says.
pub const SRGB_TEXT: &str = "rastray: sRGB view transform of linear values";
/// What the text chunk of figures and maps says.
pub const FIGURE_TEXT: &str = "rastray: figure or false colours, sRGB";

/// The value of a component under a view, unclamped; negative values mirror the curve.
pub fn view_value(x: f32, view: View) -> f32 {
    match view {
        View::Linear => x,
        View::Srgb => (srgb_from_linear(f64::from(x.abs())) as f32).copysign(x),
    }
}

/// The 8-bit value of a component under a view.
pub fn view_byte(x: f32, view: View) -> u8 {
    match view {
        View::Linear => quantize8(x),
        View::Srgb => quantize8(srgb_from_linear(f64::from(x).clamp(0.0, 1.0))),
    }
}

/// A PNG of a linear picture.
pub fn png(picture: &Plane<[f32; 3]>, view: View) -> Result<Vec<u8>, Error> {
    check_plane(picture)?;
    let bytes: Vec<u8> = picture
        .data
        .iter()
        .flatten()
        .map(|&x| view_byte(x, view))
        .collect();
    let text = if view == View::Srgb {
        SRGB_TEXT
    } else {
        LINEAR_TEXT
    };
    png_bytes(
        picture.width,
        picture.height,
        &bytes,
        text,
        view == View::Srgb,
    )
}

/// A PNG of an 8-bit picture, to be shown as sRGB.
pub fn png_of_picture(picture: &Picture) -> Result<Vec<u8>, Error> {
    let bytes = picture.pixels.as_flattened();
    png_bytes(picture.width, picture.height, bytes, FIGURE_TEXT, true)
}

/// The same in fewer bytes, which takes longer: for what is kept or embedded.
pub fn png_small(picture: &Picture) -> Result<Vec<u8>, Error> {
    let bytes = picture.pixels.as_flattened();
    let small = png::Compression::High;
    png_with(
        picture.width,
        picture.height,
        bytes,
        FIGURE_TEXT,
        true,
        small,
    )
}

/// A PNG file of 8-bit RGB values.
fn png_bytes(
    width: usize,
    height: usize,
    rgb: &[u8],
    encoding: &str,
    srgb: bool,
) -> Result<Vec<u8>, Error> {
    let usual = png::Compression::default();
    png_with(width, height, rgb, encoding, srgb, usual)
}

/// [`png_bytes`] with a choice between time and size.
fn png_with(
    width: usize,
    height: usize,
    rgb: &[u8],
    encoding: &str,
    srgb: bool,
    compression: png::Compression,
) -> Result<Vec<u8>, Error> {
    let (Ok(w), Ok(h)) = (u32::try_from(width), u32::try_from(height)) else {
        return Err(Error::limit(format!(
            "a picture of {width} x {height} is too large for PNG"
        )));
    };
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, w, h);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(compression);
    if srgb {
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    }
    let write = || -> Result<(), png::EncodingError> {
        encoder.add_text_chunk("Software".to_owned(), "rastray".to_owned())?;
        encoder.add_text_chunk("Encoding".to_owned(), encoding.to_owned())?;
        let mut writer = encoder.write_header()?;
        writer.write_image_data(rgb)?;
        writer.finish()
    };
    write().map_err(|e| {
        Error::limit(format!(
            "cannot write {width} x {height} pixels as PNG: {e}"
        ))
    })?;
    Ok(file)
}

/// A portable float map: exact values, bottom row first.
pub fn pfm(picture: &Plane<[f32; 3]>, view: View) -> Result<Encoded, Error> {
    check_plane(picture)?;
    let mut bytes = format!("PF\n{} {}\n-1.0\n", picture.width, picture.height).into_bytes();
    bytes.reserve(12 * picture.data.len());
    for row in picture.data.chunks_exact(picture.width).rev() {
        for &value in row.as_flattened() {
            bytes.extend_from_slice(&view_value(value, view).to_le_bytes());
        }
    }
    let notes = match view {
        View::Linear => Vec::new(),
        View::Srgb => vec![note(
            "the file holds sRGB values, which PFM has no way to say",
        )],
    };
    Ok(Encoded { bytes, notes })
}

/// A Radiance picture, with notes on what it loses.
pub fn hdr(picture: &Plane<[f32; 3]>, view: View) -> Result<Encoded, Error> {
    check_plane(picture)?;
    let shown: Vec<[f32; 3]> = picture
        .data
        .iter()
        .map(|p| p.map(|x| view_value(x, view)))
        .collect();
    let pixels: Vec<image::Rgb<f32>> = shown.iter().map(|p| image::Rgb(rgbe_round(*p))).collect();
    let mut bytes = Vec::new();
    image::codecs::hdr::HdrEncoder::new(&mut bytes)
        .encode(&pixels, picture.width, picture.height)
        .map_err(|e| Error::limit(format!("cannot write the picture as HDR: {e}")))?;
    let mut notes = vec![note(
        "HDR keeps 8 bits of the brightest channel of each pixel: values are off by up to 1/256 of it; \
         use .exr or .pfm for exact values",
    )];
    let negative = shown.iter().flatten().filter(|x| **x < 0.0).count();
    if negative > 0 {
        notes.push(note(format!(
            "HDR holds no negative values: {negative} became 0"
        )));
    }
    if view == View::Srgb {
        notes.push(note(
            "the file holds sRGB values, which HDR has no way to say",
        ));
    }
    Ok(Encoded { bytes, notes })
}

/// The nearest colour that RGBE holds: mantissas of 8 bits under the exponent of the largest channel.
///
/// Relative to the largest channel the error is at most 1/256. Colours below 2^-119 become black, and those beyond the
/// format's end take its largest value.
fn rgbe_round(color: [f32; 3]) -> [f32; 3] {
    let positive = color.map(|x| x.clamp(0.0, RGBE_MAX));
    let largest = positive.iter().fold(0.0f32, |m, &x| m.max(x));
    if largest < RGBE_MIN {
        return [0.0; 3];
    }
    let exponent = (largest.to_bits() >> 23) as i32 - 127;
    let mut step = power_of_two(exponent - 7);
    if (largest / step).round() > 255.0 {
        // Rounding carries into the next exponent.
        step *= 2.0;
    }
    positive.map(|x| (x / step).round() * step)
}

/// 255 * 2^119, the largest value of the format that f32 also reads back.
const RGBE_MAX: f32 = 255.0 * ((1u128 << 119) as f32);
/// 2^-119: below, the mantissa step would leave the normal numbers.
const RGBE_MIN: f32 = 1.0 / ((1u128 << 119) as f32);

/// 2^e for a normal result (-126..=127).
fn power_of_two(e: i32) -> f32 {
    f32::from_bits(((e + 127) as u32) << 23)
}

/// A note without a place.
fn note<'a>(message: impl Into<Cow<'a, str>>) -> Note {
    Note {
        place: None,
        message: message.into().into_owned(),
    }
}

/// Refuses planes whose size and data disagree, and empty ones.
pub(super) fn check_plane<T>(plane: &Plane<T>) -> Result<(), Error> {
    let (w, h) = (plane.width, plane.height);
    if w == 0 || h == 0 || w.checked_mul(h) != Some(plane.data.len()) {
        let message = format!(
            "{} pixels given for a picture of {w} x {h}",
            plane.data.len()
        );
        return Err(Error::parameter("picture", message));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 x 2, all channels different, some outside [0, 1].
    fn plane() -> Plane<[f32; 3]> {
        let data = (0..6).map(|i| [i as f32 / 8.0, -0.25 + i as f32, 1.0 / (1.0 + i as f32)]);
        Plane {
            width: 3,
            height: 2,
            data: data.collect(),
        }
    }

    fn decode_png(bytes: &[u8]) -> (Vec<u8>, png::Info<'static>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        (pixels, reader.info().clone())
    }

    #[test]
    fn png_holds_gls_bytes_and_says_so() {
        let (pixels, info) = decode_png(&png(&plane(), View::Linear).unwrap());
        let expected: Vec<u8> = plane()
            .data
            .iter()
            .flatten()
            .map(|&x| quantize8(x))
            .collect();
        assert_eq!(pixels, expected);
        assert_eq!((info.width, info.height), (3, 2));
        assert!(info.srgb.is_none() && info.source_gamma.is_none());
        let texts = &info.uncompressed_latin1_text;
        assert!(
            texts
                .iter()
                .any(|t| t.keyword == "Encoding" && t.text == LINEAR_TEXT)
        );
    }

    #[test]
    fn srgb_png_is_encoded_and_marked() {
        let grey = Plane::filled(1, 1, [0.5f32, 0.0, 1.0]);
        let (pixels, info) = decode_png(&png(&grey, View::Srgb).unwrap());
        assert_eq!(pixels, [188, 0, 255]); // 1.055 * 0.5^(1/2.4) - 0.055 = 0.73536; * 255 = 187.5...
        assert!(info.srgb.is_some());
        assert!(
            info.uncompressed_latin1_text
                .iter()
                .any(|t| t.text == SRGB_TEXT)
        );
    }

    #[test]
    fn float_views_go_on_beyond_the_unit_interval() {
        assert_eq!(view_value(-0.5, View::Srgb), -view_value(0.5, View::Srgb));
        assert!(view_value(4.0, View::Srgb) > 1.8); // 1.055 * 4^(1/2.4) - 0.055 = 1.8248
        assert!(view_value(4.0, View::Srgb) < 1.85);
        assert_eq!(view_value(7.5, View::Linear), 7.5);
    }

    #[test]
    fn pfm_is_exact_and_upside_down() {
        let bytes = pfm(&plane(), View::Linear).unwrap().bytes;
        let header = b"PF\n3 2\n-1.0\n";
        assert_eq!(&bytes[..header.len()], header);
        let values: Vec<f32> = bytes[header.len()..]
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect();
        let rows: Vec<f32> = plane()
            .data
            .chunks(3)
            .rev()
            .flatten()
            .flatten()
            .copied()
            .collect();
        assert_eq!(values, rows);
    }

    #[test]
    fn hdr_reads_back_within_what_it_says() {
        let mut picture = Plane {
            width: 16,
            height: 4,
            data: Vec::new(),
        };
        for i in 0..64 {
            let x = power_of_two(i - 32) * (1.0 + i as f32 / 64.0);
            picture.data.push([x, x * 0.3, -x]);
        }
        picture.data[0] = [1e-40, 0.0, 0.0];
        picture.data[1] = [0.999_999_94, 0.5, 0.0];
        picture.data[2] = [f32::MAX, 1.0, 0.0];
        let encoded = hdr(&picture, View::Linear).unwrap();
        let read = image::load_from_memory_with_format(&encoded.bytes, image::ImageFormat::Hdr);
        let read = read.unwrap().into_rgb32f();
        for (i, (got, asked)) in read.pixels().zip(&picture.data).enumerate() {
            let largest = asked[0].min(RGBE_MAX);
            for c in 0..3 {
                let expected = asked[c].clamp(0.0, RGBE_MAX);
                assert!(
                    (got[c] - expected).abs() <= largest / 256.0 + 1e-39,
                    "{i}: {got:?} {asked:?}"
                );
            }
        }
        assert_eq!(read.get_pixel(1, 0).0, [1.0, 0.5, 0.0]);
        assert!(
            encoded
                .notes
                .iter()
                .any(|n| n.message.contains("61 became 0")),
            "{:?}",
            encoded.notes
        );
    }

    #[test]
    fn rgbe_rounding_is_idempotent() {
        for i in 1..2000 {
            let x = i as f32 * 0.37;
            let once = rgbe_round([x, x / 3.0, x / 700.0]);
            assert_eq!(rgbe_round(once), once);
        }
    }

    #[test]
    fn a_plane_that_lies_about_its_size_is_an_error() {
        let plane = Plane {
            width: 3,
            height: 3,
            data: vec![[0.0f32; 3]; 8],
        };
        assert!(png(&plane, View::Linear).is_err());
        assert!(pfm(&plane, View::Linear).is_err());
        assert!(
            hdr(
                &Plane {
                    width: 0,
                    height: 0,
                    data: vec![]
                },
                View::Linear
            )
            .is_err()
        );
    }
}
