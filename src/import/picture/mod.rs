//! Picture files, whoever made them, as planes of stored values.
//!
//! In: a path, or bytes with a name. Out: a [`PictureFile`]: red, green, blue as the file holds them (8-bit and 16-bit
//! values as fractions of the largest one, floats as they are), top row first, and what was assumed and left out. The first
//! bytes decide what a file is, never its name.
//!
//! | format | read by | values |
//! | - | - | - |
//! | PNG (all depths, grey, palette, alpha, interlaced) | `png` | integers |
//! | JPEG, BMP | `image` (pure Rust: zune-jpeg); BMP with channels above 8 bits: `bitmap` | 8 bits, or as many as there are |
//! | Radiance HDR | `radiance` | floats of 8-bit mantissas, exposure divided out |
//! | OpenEXR (f16, f32, u32; one layer or part of many; luminance and chroma; not deep) | `exr` | floats |
//! | PPM, PGM (text and binary, up to 16 bits), PFM | `portable`: `image` reads no PFM and leaves PNM values unscaled | integers; floats |
//!
//! Nothing is decoded: neither the sRGB curve nor a colour profile. Alpha: a picture with straight alpha (PNG, BMP) is shown
//! over black, EXR's is so already. Nothing beyond [`MAX_BYTES`] and [`MAX_PIXELS`] is taken into memory.

mod bitmap;
mod coded;
mod openexr;
mod orientation;
mod portable;
mod radiance;

use std::path::Path;

use rastray_compare::Encoding;

use super::MAX_PIXELS;
use super::text::read_limited;
use crate::error::{Error, Note, Place};
use crate::frame::Plane;

/// Largest picture file.
pub const MAX_BYTES: u64 = 1 << 30;

/// What a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Portable Network Graphics.
    Png,
    /// JPEG: lossy, 8 bits.
    Jpeg,
    /// Windows bitmap.
    Bmp,
    /// Portable pixel map: PPM, colours.
    Ppm,
    /// Portable grey map: PGM.
    Pgm,
    /// Portable float map: PFM.
    Pfm,
    /// Radiance RGBE.
    Hdr,
    /// OpenEXR.
    Exr,
}

impl PictureFormat {
    /// Every format.
    pub const ALL: [Self; 8] = [
        Self::Png,
        Self::Jpeg,
        Self::Bmp,
        Self::Ppm,
        Self::Pgm,
        Self::Pfm,
        Self::Hdr,
        Self::Exr,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::Bmp => "BMP",
            Self::Ppm => "PPM",
            Self::Pgm => "PGM",
            Self::Pfm => "PFM",
            Self::Hdr => "HDR",
            Self::Exr => "EXR",
        }
    }

    /// What a file's first bytes say; none where no picture of these kinds begins so.
    ///
    /// ```
    /// use rastray::import::picture::PictureFormat;
    /// assert_eq!(PictureFormat::of_bytes(b"P6\n2 1\n255\n"), Some(PictureFormat::Ppm));
    /// assert_eq!(PictureFormat::of_bytes(b"GIF89a"), None);
    /// ```
    pub fn of_bytes(bytes: &[u8]) -> Option<Self> {
        let starts = |magic: &[u8]| bytes.starts_with(magic);
        // The portable formats are texts: white space follows the two letters.
        let portable = bytes.get(2).is_some_and(u8::is_ascii_whitespace);
        match bytes.get(..2)? {
            b"P2" | b"P5" if portable => Some(Self::Pgm),
            b"P3" | b"P6" if portable => Some(Self::Ppm),
            b"PF" | b"Pf" if portable => Some(Self::Pfm),
            b"BM" => Some(Self::Bmp),
            b"#?" => Some(Self::Hdr),
            _ if starts(b"\x89PNG\r\n\x1a\n") => Some(Self::Png),
            _ if starts(b"\xff\xd8\xff") => Some(Self::Jpeg),
            _ if starts(b"\x76\x2f\x31\x01") => Some(Self::Exr),
            _ => None,
        }
    }
}

/// How the stored values relate to light, and how that is known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assumed {
    /// Linear or sRGB.
    pub encoding: Encoding,
    /// Why, in a few words.
    pub why: String,
}

impl Assumed {
    fn new(encoding: Encoding, why: &str) -> Self {
        Self {
            encoding,
            why: why.to_owned(),
        }
    }

    /// What unmarked 8-bit pictures are taken for.
    fn unmarked() -> Self {
        Self::new(Encoding::Srgb, "the file does not say; screens take it so")
    }
}

/// A picture as its file holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureFile {
    /// The file as the user named it.
    pub name: String,
    /// What it is.
    pub format: PictureFormat,
    /// Bits of a stored value; none for floats.
    pub bits: Option<u8>,
    /// The stored values: integers in [0, 1], floats as they are. All finite, unless [`ReadOptions::non_finite`] was asked.
    pub pixels: Plane<[f32; 3]>,
    /// How they relate to light.
    pub assumed: Assumed,
    /// What was left out or taken in a way that a reader should know: alpha, windows.
    pub notes: Vec<Note>,
}

/// How to read a picture file.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReadOptions<'a> {
    /// The layer of EXR files; without it, the picture itself.
    pub layer: Option<&'a str>,
    /// Turn and mirror the picture as its EXIF orientation says.
    pub orient: bool,
    /// Take values that are infinite or not a number.
    pub non_finite: bool,
}

/// Reads a picture file.
///
/// `layer` names the layer of EXR files, such as `diffuse.key`; without it, the picture itself.
///
/// # Errors
/// A file that cannot be read, is none of the formats, is broken or cut off, holds values that are not finite, or is
/// larger than the limits.
pub fn read(path: &Path, layer: Option<&str>) -> Result<PictureFile, Error> {
    let options = ReadOptions {
        layer,
        ..ReadOptions::default()
    };
    read_with(path, options)
}

/// Reads a picture file as [`read`] does, with options.
///
/// # Errors
/// Those of [`read`]; values that are not finite only where they are not asked for.
pub fn read_with(path: &Path, options: ReadOptions<'_>) -> Result<PictureFile, Error> {
    let name = path.display().to_string();
    if path.is_dir() {
        let error = Error::input(Place::file(name), "this is a folder, not a picture");
        return Err(error.with_help("name a picture file in it"));
    }
    if !path.exists() {
        let error = Error::parameter(name.clone(), format!("there is no file `{name}`"));
        return Err(
            error.with_help("name a picture file: PNG, JPEG, BMP, PPM, PGM, PFM, HDR or EXR")
        );
    }
    let bytes = read_limited(path, MAX_BYTES, "compare a part of the picture")?;
    decode_with(&name, &bytes, options)
}

/// The picture in a file's bytes; `name` is for messages. See [`read`].
pub fn decode(name: &str, bytes: &[u8], layer: Option<&str>) -> Result<PictureFile, Error> {
    let options = ReadOptions {
        layer,
        ..ReadOptions::default()
    };
    decode_with(name, bytes, options)
}

/// The picture in a file's bytes; `name` is for messages. See [`read_with`].
pub fn decode_with(
    name: &str,
    bytes: &[u8],
    options: ReadOptions<'_>,
) -> Result<PictureFile, Error> {
    let layer = options.layer;
    let Some(format) = PictureFormat::of_bytes(bytes) else {
        return Err(unknown(name, bytes));
    };
    if let Some(layer) = layer.filter(|_| format != PictureFormat::Exr) {
        let message = format!("{name} is {} and has no layer {layer}", format.name());
        return Err(Error::parameter("--layer", message).with_help("layers are in .exr files"));
    }
    let decoded = match format {
        PictureFormat::Png => coded::png(bytes),
        PictureFormat::Jpeg | PictureFormat::Bmp => coded::other(format, bytes),
        PictureFormat::Hdr => radiance::read(bytes),
        PictureFormat::Ppm | PictureFormat::Pgm | PictureFormat::Pfm => portable::read(bytes),
        PictureFormat::Exr => openexr::read(bytes, layer),
    };
    let Decoded {
        bits,
        mut pixels,
        orientation,
        assumed,
        mut notes,
    } = decoded.map_err(|trouble| trouble.error(name, format))?;
    if orientation != 1 {
        let how = orientation::describe(orientation);
        notes.push(if options.orient {
            pixels = orientation::upright(&pixels, orientation);
            format!("it is {how}, as its EXIF orientation {orientation} says")
        } else {
            format!(
                "its EXIF orientation {orientation} says that it is to be {how}; it is taken as stored (--orient turns it)"
            )
        });
    }
    let bad = |p: &[f32; 3]| !p.iter().all(|v| v.is_finite());
    if let Some(first) = pixels
        .data
        .iter()
        .position(bad)
        .filter(|_| !options.non_finite)
    {
        let (x, y) = (first % pixels.width, first / pixels.width);
        let count = pixels.data.iter().filter(|p| bad(p)).count();
        let message = format!(
            "{count} pixels hold a value that is infinite or not a number, the first of them {x} {y}"
        );
        return Err(Error::input(Place::file(name), message)
            .with_help("such values have no distance to others; `diff --nan` counts them and compares the rest"));
    }
    let note = |message| Note {
        place: Some(Place::file(name)),
        message,
    };
    Ok(PictureFile {
        name: name.to_owned(),
        format,
        bits,
        pixels,
        assumed,
        notes: notes.into_iter().map(note).collect(),
    })
}

/// What is wrong with a file that is no picture of the known kinds.
fn unknown(name: &str, bytes: &[u8]) -> Error {
    const OTHERS: [(&[u8], &str); 19] = [
        (b"GIF8", "this is a GIF"),
        (b"RIFF", "this is WebP or another RIFF file"),
        (b"II+\0", "this is a BigTIFF"),
        (b"MM\0+", "this is a BigTIFF"),
        (b"\0\0\0\x0cjP  ", "this is a JPEG 2000"),
        (b"\xff\x4f\xff\x51", "this is a JPEG 2000"),
        (b"\0\0\0\x0cJXL ", "this is a JPEG XL"),
        (b"\xff\x0a", "this is a JPEG XL"),
        (b"8BPS", "this is a Photoshop file"),
        (b"\0\0\x01\0", "this is an icon (ICO)"),
        (b"\xabKTX", "this is a KTX texture"),
        (b"PF4", "this is a PFM of four channels"),
        (b"II*\0", "this is a TIFF"),
        (b"MM\0*", "this is a TIFF"),
        (b"P1", "this is a PBM bitmap"),
        (b"P4", "this is a PBM bitmap"),
        (b"P7", "this is a PAM"),
        (b"qoif", "this is a QOI"),
        (b"DDS ", "this is a DDS"),
    ];
    let found = OTHERS.iter().find(|(magic, _)| bytes.starts_with(magic));
    let names = PictureFormat::ALL.map(PictureFormat::name).join(", ");
    // AVIF and HEIC: a box whose kind stands behind its length.
    let boxed = bytes.get(4..8) == Some(b"ftyp");
    let what = match found
        .map(|(_, what)| *what)
        .or(boxed.then_some("this is an AVIF, HEIC or video file"))
    {
        _ if bytes.is_empty() => "the file is empty",
        Some(what) => {
            return Error::Unsupported {
                place: Some(Box::new(Place::file(name))),
                message: format!("{what}, which is not read; expected one of {names}"),
                help: Some("save the picture as PNG, or as EXR if it holds floats".into()),
            };
        }
        None => "this is no picture in a known format",
    };
    Error::input(
        Place::file(name),
        format!("{what}; expected one of {names}"),
    )
    .with_help("save the picture as PNG, or as EXR if it holds floats")
}

/// What the formats' readers return.
struct Decoded {
    bits: Option<u8>,
    pixels: Plane<[f32; 3]>,
    /// How to hold the picture: see [`orientation`]; 1 = as stored.
    orientation: u8,
    assumed: Assumed,
    notes: Vec<String>,
}

/// Why a file was not read.
enum Trouble {
    /// It is broken or cut off.
    Broken(String),
    /// It is larger than what is taken.
    TooLarge(u64, u64),
    /// It is something that is not read here, and what to do.
    Unsupported(String, String),
}

impl Trouble {
    fn broken(reason: impl std::fmt::Display) -> Self {
        Self::Broken(reason.to_string())
    }

    fn error(self, name: &str, format: PictureFormat) -> Error {
        let format = format.name();
        match self {
            Self::Broken(reason) => Error::input(
                Place::file(name),
                format!("this {format} is broken or cut off: {reason}"),
            )
            .with_help("write or copy the file again"),
            Self::TooLarge(w, h) => Error::limit(format!(
                "{name}: {w} x {h} pixels are more than {MAX_PIXELS}"
            ))
            .with_help("compare a part of the picture"),
            Self::Unsupported(message, help) => Error::Unsupported {
                place: Some(Box::new(Place::file(name))),
                message,
                help: Some(help),
            },
        }
    }
}

/// Width and height as sizes; refuses empty and too large pictures before anything is allocated for them.
fn checked_size(width: u64, height: u64) -> Result<(usize, usize), Trouble> {
    match width.checked_mul(height) {
        Some(0) => Err(Trouble::broken("it has no pixels")),
        Some(pixels) if pixels <= MAX_PIXELS => Ok((width as usize, height as usize)),
        _ => Err(Trouble::TooLarge(width, height)),
    }
}

/// A plane of `width * height` pixels from 1 (grey), 2 (grey, alpha), 3 (colour) or 4 (colour, alpha) values each; straight
/// alpha is shown over black, which is noted unless all is opaque.
fn plane(
    size: (usize, usize),
    channels: usize,
    values: &[f32],
    notes: &mut Vec<String>,
) -> Plane<[f32; 3]> {
    let pixel = |v: &[f32]| match *v {
        [grey] => ([grey; 3], 1.0),
        [grey, alpha] => ([grey; 3], alpha),
        [r, g, b] => ([r, g, b], 1.0),
        [r, g, b, alpha] => ([r, g, b], alpha),
        _ => ([0.0; 3], 1.0),
    };
    let mut clear = 0;
    let over_black = |v: &[f32]| {
        let (color, alpha) = pixel(v);
        clear += usize::from(alpha != 1.0);
        // Opaque values stay as they are, and so do their steps.
        if alpha == 1.0 {
            color
        } else {
            color.map(|c| c * alpha)
        }
    };
    let data = values.chunks_exact(channels).map(over_black).collect();
    if clear > 0 {
        notes.push(format!(
            "{clear} pixels are not opaque; they are taken as shown over black"
        ));
    }
    Plane {
        width: size.0,
        height: size.1,
        data,
    }
}
