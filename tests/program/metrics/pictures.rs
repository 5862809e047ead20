//! Picture files: every format gives back what was written, and damaged ones are errors, never panics.

use std::io::Cursor;

use rastray::error::Error;
use rastray::frame::Plane;
use rastray::import::picture::{MAX_BYTES, PictureFile, PictureFormat, decode};
use rastray::report::files::View;
use rastray::report::formats;
use rastray::report::layered::{NamedLayer, exr};
use rastray_compare::Encoding;

const W: usize = 7;
const H: usize = 5;

/// 8-bit values, all different from their neighbours.
fn byte(x: usize, y: usize, c: usize) -> u8 {
    ((x * 37 + y * 91 + c * 53) % 256) as u8
}

fn bytes() -> Vec<u8> {
    let pixel = |i: usize| [0, 1, 2].map(|c| byte(i % W, i / W, c));
    (0..W * H).flat_map(pixel).collect()
}

/// The same as fractions.
fn fractions() -> Vec<[f32; 3]> {
    let pixel = |i: usize| [0, 1, 2].map(|c| f32::from(byte(i % W, i / W, c)) / 255.0);
    (0..W * H).map(pixel).collect()
}

fn floats() -> Plane<[f32; 3]> {
    let data = (0..W * H).map(|i| [i as f32 * 0.3, -(i as f32) / 7.0, 1e3 / (1.0 + i as f32)]);
    Plane {
        width: W,
        height: H,
        data: data.collect(),
    }
}

/// A PNG of raw samples, in the given form.
fn png(color: png::ColorType, depth: png::BitDepth, data: &[u8], palette: bool) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, W as u32, H as u32);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if palette {
        encoder.set_palette(vec![10, 20, 30, 200, 100, 50, 0, 0, 0, 255, 255, 255]);
        encoder.set_trns(vec![255, 128]);
    }
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(data).expect("pixels");
    writer.finish().expect("an end");
    file
}

/// Smooth values, which JPEG keeps nearly.
fn smooth() -> Vec<u8> {
    let pixel = |i: usize| [0, 1, 2].map(|c| (40 + 12 * (i % W) + 9 * (i / W) + 20 * c) as u8);
    (0..W * H).flat_map(pixel).collect()
}

fn image_file(format: image::ImageFormat, pixels: Vec<u8>) -> Vec<u8> {
    let picture = image::RgbImage::from_raw(W as u32, H as u32, pixels).expect("a picture");
    let mut file = Cursor::new(Vec::new());
    picture.write_to(&mut file, format).expect("written");
    file.into_inner()
}

/// One file of each kind, with its name.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    let rgb = bytes();
    let text: Vec<String> = rgb.iter().map(u8::to_string).collect();
    let sixteen: Vec<u8> = rgb.iter().flat_map(|b| [*b, *b]).collect();
    let plane = floats();
    let layer = NamedLayer {
        name: "diffuse.key".into(),
        plane: &plane,
    };
    let portable = |head: &str, data: &[u8]| [head.as_bytes(), data].concat();
    vec![
        (
            "PNG, 8 bits",
            png(png::ColorType::Rgb, png::BitDepth::Eight, &rgb, false),
        ),
        (
            "PNG, 16 bits",
            png(png::ColorType::Rgb, png::BitDepth::Sixteen, &sixteen, false),
        ),
        (
            "PNG, palette",
            png(
                png::ColorType::Indexed,
                png::BitDepth::Eight,
                &[1; W * H],
                true,
            ),
        ),
        ("BMP", image_file(image::ImageFormat::Bmp, bytes())),
        ("JPEG", image_file(image::ImageFormat::Jpeg, smooth())),
        ("PPM, binary", portable("P6 # a comment\n7 5\n255\n", &rgb)),
        (
            "PPM, text",
            format!("P3\n7 5 255\n{}\n", text.join(" ")).into_bytes(),
        ),
        ("PPM, 16 bits", portable("P6\n7 5\n65535\n", &sixteen)),
        ("PGM", portable("P5\n7 5\n255\n", &rgb[..W * H])),
        (
            "PFM",
            formats::pfm(&plane, View::Linear).expect("PFM").bytes,
        ),
        (
            "HDR",
            formats::hdr(&plane, View::Linear).expect("HDR").bytes,
        ),
        (
            "EXR",
            exr(Some(&plane), View::Linear, &[layer]).expect("EXR"),
        ),
    ]
}

fn read(name: &str, bytes: &[u8]) -> PictureFile {
    decode(name, bytes, None).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn every_format_gives_back_what_was_written() {
    for (name, bytes) in files() {
        let found = read(name, &bytes);
        assert_eq!((found.pixels.width, found.pixels.height), (W, H), "{name}");
        assert!(
            name.starts_with(found.format.name()),
            "{name}: {:?}",
            found.format
        );
        let float = matches!(
            found.format,
            PictureFormat::Pfm | PictureFormat::Hdr | PictureFormat::Exr
        );
        assert_eq!(found.bits.is_none(), float, "{name}");
        assert_eq!(found.assumed.encoding == Encoding::Linear, float, "{name}");
        let largest = |expected: &[[f32; 3]]| {
            let pairs = found
                .pixels
                .data
                .as_flattened()
                .iter()
                .zip(expected.as_flattened());
            pairs.fold(0.0, |m: f32, (a, b)| m.max((a - b).abs()))
        };
        match name {
            "PGM" | "PNG, palette" => {}
            // 8-bit mantissas; negative values are 0. Quantized and smoothed.
            "HDR" => assert!(found.pixels.data[0] == [0.0, 0.0, 1000.0]),
            "JPEG" => {
                let smooth: Vec<[f32; 3]> = smooth()
                    .chunks(3)
                    .map(|p| [0, 1, 2].map(|c| f32::from(p[c]) / 255.0))
                    .collect();
                assert!(largest(&smooth) < 0.06, "{}", largest(&smooth));
            }
            _ if float => assert_eq!(found.pixels, floats(), "{name}"),
            _ => assert_eq!(found.pixels.data, fractions(), "{name}"),
        }
    }
}

#[test]
fn grey_palettes_and_alpha_become_colours() {
    let grey = png(
        png::ColorType::Grayscale,
        png::BitDepth::Two,
        &[0b00_01_10_11, 0b11_10_01_00].repeat(H),
        false,
    );
    let found = read("grey", &grey);
    let row: Vec<f32> = found.pixels.data[..W].iter().map(|p| p[0] * 3.0).collect();
    assert_eq!(row, [0.0, 1.0, 2.0, 3.0, 3.0, 2.0, 1.0]);
    let palette = png(
        png::ColorType::Indexed,
        png::BitDepth::Eight,
        &[[1, 0, 2, 3, 1, 1, 0]; H].concat(),
        true,
    );
    let found = read("palette", &palette);
    let half = |v: f32| v / 255.0 * (128.0 / 255.0);
    assert_eq!(found.pixels.data[0], [half(200.0), half(100.0), half(50.0)]);
    assert_eq!(
        found.pixels.data[1],
        [10.0 / 255.0, 20.0 / 255.0, 30.0 / 255.0]
    );
    assert_eq!(found.pixels.data[3], [1.0; 3]);
    assert!(
        found.notes[0].message.contains("15 pixels are not opaque"),
        "{:?}",
        found.notes
    );
    let opaque: Vec<u8> = bytes()
        .chunks(3)
        .flat_map(|p| [p[0], p[1], p[2], 255])
        .collect();
    let found = read(
        "alpha",
        &png(png::ColorType::Rgba, png::BitDepth::Eight, &opaque, false),
    );
    assert_eq!((found.pixels.data, found.notes.len()), (fractions(), 0));
}

#[test]
fn portable_maps_of_any_largest_value_and_either_order_of_bytes() {
    let found = read("a.pgm", b"P2 # few\n3 1\n# levels\n15\n0 5 15\n");
    assert_eq!(
        found.pixels.data,
        [[0.0; 3], [(5.0f64 / 15.0) as f32; 3], [1.0; 3]]
    );
    let found = read("a.pgm", b"P5 2 1 1000 \x03\xe8\x01\xf4");
    assert_eq!(found.pixels.data, [[1.0; 3], [0.5; 3]]);
    let (big, little) = (0.1f32.to_be_bytes(), 0.1f32.to_le_bytes());
    for (head, value) in [("Pf\n1 1\n1.0\n", big), ("Pf\n1 1\n-1\n", little)] {
        let found = read("a.pfm", &[head.as_bytes(), &value].concat());
        assert_eq!(found.pixels.data, [[0.1; 3]]);
    }
}

#[test]
fn own_files_say_what_they_hold() {
    let plane = floats();
    for (view, encoding) in [
        (View::Linear, Encoding::Linear),
        (View::Srgb, Encoding::Srgb),
    ] {
        let png = read("a.png", &formats::png(&plane, view).expect("PNG"));
        assert_eq!(png.assumed.encoding, encoding, "{}", png.assumed.why);
        assert!(png.assumed.why.contains("rastray"), "{}", png.assumed.why);
        let exr = read("a.exr", &exr(Some(&plane), view, &[]).expect("EXR"));
        assert_eq!(exr.assumed.encoding, encoding, "{}", exr.assumed.why);
    }
}

#[test]
fn layers_of_exr_files_are_chosen_by_name() {
    let (plane, other) = (floats(), floats().map(|p| p.map(|v| v + 1.0)));
    let layer = NamedLayer {
        name: "diffuse.key".into(),
        plane: &other,
    };
    let bytes = exr(Some(&plane), View::Linear, &[layer]).expect("EXR");
    assert_eq!(read("a.exr", &bytes).pixels, plane);
    let found = decode("a.exr", &bytes, Some("diffuse.key")).expect("a layer");
    assert_eq!(found.pixels, other);
    let error = decode("a.exr", &bytes, Some("diffuse.kee")).expect_err("no layer");
    assert!(
        error.help().expect("advice").contains("diffuse.key"),
        "{error}"
    );
    assert!(decode("a.pfm", b"Pf 1 1 1 0000", Some("x")).is_err());
}

#[test]
fn exr_windows_and_grey_are_understood() {
    use exr::prelude::{
        Encoding, Image, IntegerBounds, Layer, LayerAttributes, SpecificChannels, Vec2,
        WritableImage, f16,
    };
    // 2 x 2 pixels of data whose corner lies at (1, -1) of a picture of 3 x 3.
    let channels = SpecificChannels::build()
        .with_channel::<f16>("Y")
        .with_pixel_fn(|at: Vec2<usize>| (f16::from_f32((1 + at.x() + 2 * at.y()) as f32),));
    let mut layer = Layer::new(
        Vec2(2, 2),
        LayerAttributes::default(),
        Encoding::FAST_LOSSLESS,
        channels,
    );
    layer.attributes.layer_position = Vec2(1, -1);
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = IntegerBounds::new(Vec2(0, 0), Vec2(3, 3));
    let mut file = Cursor::new(Vec::new());
    image
        .write()
        .non_parallel()
        .to_buffered(&mut file)
        .expect("written");
    let found = read("window.exr", &file.into_inner());
    let grey: Vec<f32> = found.pixels.data.iter().map(|p| p[1]).collect();
    assert_eq!(grey, [0.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(
        found.notes[0].message.contains("3 x 3"),
        "{:?}",
        found.notes
    );
}

#[test]
fn cut_files_are_errors() {
    for (name, bytes) in files() {
        // What is missing must be more than the last digits of a text, or the padding of a row.
        let spare = if matches!(name, "PPM, text" | "BMP") {
            4
        } else {
            1
        };
        for end in (0..bytes.len() - spare)
            .step_by(1 + bytes.len() / 400)
            .chain([bytes.len() - spare])
        {
            let error = match decode(name, &bytes[..end], None) {
                Err(error) => error.to_string(),
                Ok(_) => panic!(
                    "{name}: {end} of {} bytes are taken for a picture",
                    bytes.len()
                ),
            };
            assert!(error.contains(name), "{error}");
        }
    }
}

/// Repeatable bytes.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end
    }
}

#[test]
fn damaged_files_never_panic() {
    let mut random = Random(1);
    let (mut read, mut refused) = (0, 0);
    for (name, bytes) in files() {
        for _ in 0..600 {
            let mut bytes = bytes.clone();
            for _ in 0..1 + random.below(4) {
                // Heads are short and decide most.
                let end = if random.below(2) == 0 {
                    bytes.len().min(80)
                } else {
                    bytes.len()
                };
                let at = random.below(end);
                match random.below(3) {
                    0 => bytes[at] = random.below(256) as u8,
                    1 => bytes[at] ^= 1 << random.below(8),
                    _ => bytes.insert(at, random.below(256) as u8),
                }
            }
            match decode(name, &bytes, None) {
                Ok(picture) => {
                    assert!(picture.pixels.data.iter().flatten().all(|v| v.is_finite()));
                    read += 1;
                }
                Err(error) => {
                    assert!(!error.to_string().is_empty());
                    refused += 1;
                }
            }
        }
    }
    assert!(
        read > 100 && refused > 1000,
        "{read} read, {refused} refused"
    );
}

#[test]
fn giants_are_refused_before_they_are_unpacked() {
    let mut giant = png(png::ColorType::Rgb, png::BitDepth::Eight, &bytes(), false);
    giant[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]); // 65536 x 65536
    let crc = crc(&giant[12..29]);
    giant[29..33].copy_from_slice(&crc.to_be_bytes());
    let mut bitmap = image_file(image::ImageFormat::Bmp, bytes());
    bitmap[18..22].copy_from_slice(&65_000u32.to_le_bytes());
    bitmap[22..26].copy_from_slice(&65_000u32.to_le_bytes());
    for (name, bytes) in [
        ("png", giant),
        ("bmp", bitmap),
        ("ppm", b"P6 100000 100000 255 abc".to_vec()),
        ("text", b"P3 11000 11000 255 1 2 3".to_vec()),
        ("pfm", b"PF 4000000000 4000000000 -1 abc".to_vec()),
        (
            "hdr",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\nabc".to_vec(),
        ),
    ] {
        let error = decode(name, &bytes, None).expect_err(name);
        assert!(
            matches!(error, Error::Limit { .. } | Error::Input { .. }),
            "{name}: {error}"
        );
        println!("{error}");
    }
    assert_eq!(MAX_BYTES, 1 << 30);
}

/// CRC-32 as PNG has it, bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            (c >> 1) ^ (0xedb8_8320 & (c & 1).wrapping_neg())
        })
    };
    !bytes.iter().fold(u32::MAX, step)
}

#[test]
fn other_files_and_values_without_distance_are_named() {
    for (bytes, wanted) in [
        (&b"GIF89a"[..], "this is a GIF"),
        (b"", "the file is empty"),
        (
            b"hello, world",
            "no picture in a known format; expected one of PNG",
        ),
        (b"P4 1 1 x", "PBM"),
        (b"P3 1 1 255 1 2 300", "above the largest value 255"),
        (b"P3 1 1 255 1 -2 3", "no whole number"),
        (b"P6 0 5 255 ", "has no pixels"),
        (b"P6 1 1 70000 abcdef", "1 to 65535"),
        (b"PF 1 1 0 abcdabcdabcd", "other than 0"),
    ] {
        let error = decode("x", bytes, None).expect_err("refused").to_string();
        assert!(error.contains(wanted), "{error}");
    }
    let mut plane = floats();
    plane.data[W + 2][1] = f32::NAN;
    let bytes = formats::pfm(&plane, View::Linear).expect("PFM").bytes;
    let error = decode("a.pfm", &bytes, None)
        .expect_err("refused")
        .to_string();
    assert!(
        error.contains("1 pixels") && error.contains("2 1"),
        "{error}"
    );
}
