//! Picture files of kinds that are met less often, each with the values that must come out, and those that are not read.

use rastray::error::Error;
use rastray::frame::Plane;
use rastray::import::picture::{PictureFile, ReadOptions, decode, decode_with};
use rastray::report::diff::{Diff, Options, Which};

/// 3 x 2 RGBE pixels: 1 2 3 over 4 5 6 in red, halves of them in green, 0 in blue.
const PIXELS: [[u8; 4]; 6] = [
    [32, 16, 0, 130],
    [64, 32, 0, 130],
    [96, 48, 0, 130],
    [128, 64, 0, 130],
    [160, 80, 0, 130],
    [192, 96, 0, 130],
];

fn hdr(header: &str, resolution: &str, pixels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = format!("{header}\n\n{resolution}\n").into_bytes();
    bytes.extend(pixels.as_flattened());
    bytes
}

fn read(bytes: &[u8]) -> PictureFile {
    decode("a", bytes, None).unwrap_or_else(|e| panic!("{e}"))
}

/// The red values, row by row.
fn reds(file: &PictureFile) -> String {
    let rows = file.pixels.data.chunks(file.pixels.width);
    let row = |row: &[[f32; 3]]| row.iter().map(|p| p[0].to_string()).collect::<String>();
    rows.map(row).collect::<Vec<_>>().join("/")
}

fn notes(file: &PictureFile) -> String {
    file.notes
        .iter()
        .map(|n| n.message.clone())
        .collect::<Vec<_>>()
        .join("\n")
}

fn refused(bytes: &[u8], layer: Option<&str>) -> (String, String) {
    match decode("a", bytes, layer) {
        Err(Error::Unsupported { message, help, .. }) => (message, help.unwrap_or_default()),
        other => panic!("{other:?}"),
    }
}

#[test]
fn hdr_exposure_is_divided_out() {
    for (header, factors) in [
        ("#?RADIANCE\nFORMAT=32-bit_rle_rgbe", [1.0, 1.0, 1.0]),
        ("#?RGBE\nFORMAT=32-bit_rle_rgbe", [1.0, 1.0, 1.0]),
        ("#?RGBE", [1.0, 1.0, 1.0]),
        (
            "#?RADIANCE\nEXPOSURE=4\nFORMAT=32-bit_rle_rgbe",
            [4.0, 4.0, 4.0],
        ),
        (
            "#?RADIANCE\nEXPOSURE=2.0\n# x\nFORMAT=32-bit_rle_rgbe\nEXPOSURE= 0.25",
            [0.5, 0.5, 0.5],
        ),
        ("#?RADIANCE\nCOLORCORR= 2 4 8\nEXPOSURE=2", [4.0, 8.0, 16.0]),
    ] {
        for header in [header.to_owned(), header.replace('\n', "\r\n")] {
            let file = read(&hdr(&header, "-Y 2 +X 3", &PIXELS));
            for (i, pixel) in file.pixels.data.iter().enumerate() {
                let red = i as f64 / 2.0 + 0.5;
                let expected = [red / factors[0], red / 2.0 / factors[1], 0.0].map(|x| x as f32);
                assert_eq!(*pixel, expected, "{header}");
            }
            assert_eq!(
                notes(&file).contains("exposure"),
                factors[0] != 1.0,
                "{header}"
            );
        }
    }
    assert!(
        decode(
            "a",
            &hdr("#?RADIANCE\nEXPOSURE=0", "-Y 2 +X 3", &PIXELS),
            None
        )
        .is_err()
    );
}

#[test]
fn hdr_axes_go_either_way() {
    // Values 1 to 6 in the order of the file.
    let pixels: Vec<[u8; 4]> = (1..=6u8).map(|i| [i, 0, 0, 136]).collect();
    for (resolution, expected) in [
        ("-Y 2 +X 3", "123/456"),
        ("-Y 2 -X 3", "321/654"),
        ("+Y 2 +X 3", "456/123"),
        ("+Y 2 -X 3", "654/321"),
        ("+X 3 -Y 2", "135/246"),
        ("+X 3 +Y 2", "246/135"),
        ("-X 3 -Y 2", "531/642"),
        ("-X 3 +Y 2", "642/531"),
    ] {
        let file = read(&hdr("#?RADIANCE", resolution, &pixels));
        assert_eq!(reds(&file), expected, "{resolution}");
    }
    for resolution in ["-Y 2 -Y 3", "-Y 2", "-Y two +X 3", "-Y 2 +Z 3"] {
        assert!(decode("a", &hdr("#?RADIANCE", resolution, &pixels), None).is_err());
    }
}

#[test]
fn hdr_runs_are_of_two_kinds() {
    // New: a run of 8 in red, bytes in green, runs in blue and the exponent.
    let mut new = b"#?RADIANCE\n\n-Y 1 +X 8\n\x02\x02\x00\x08".to_vec();
    new.extend([
        136, 128, 8, 1, 2, 3, 4, 5, 6, 7, 8, 132, 0, 132, 9, 136, 136,
    ]);
    let file = read(&new);
    let green: Vec<f32> = file.pixels.data.iter().map(|p| p[1]).collect();
    assert_eq!(green, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    assert_eq!(reds(&file), "128".repeat(8));
    assert_eq!((file.pixels.data[3][2], file.pixels.data[4][2]), (0.0, 9.0));
    // Old: a pixel repeated four more times.
    let old = [[7, 0, 0, 136], [1, 1, 1, 4], [9, 0, 0, 136]];
    assert_eq!(reds(&read(&hdr("#?RADIANCE", "-Y 1 +X 6", &old))), "777779");
    for cut in 30..new.len() {
        assert!(decode("a", &new[..cut], None).is_err());
    }
    let (message, help) = refused(
        &hdr("#?RADIANCE\nFORMAT=32-bit_rle_xyze", "-Y 2 +X 3", &PIXELS),
        None,
    );
    assert!(
        message.contains("XYZ") && help.contains("convert"),
        "{message}"
    );
}

#[test]
fn bitmaps_may_have_ten_bits() {
    for (masks, down) in [
        ([0x3ff0_0000u32, 0x000f_fc00, 0x0000_03ff], true),
        ([0x0000_03ff, 0x000f_fc00, 0x3ff0_0000], false),
        ([0xffc0_0000, 0x003f_f000, 0x0000_07fe], true),
    ] {
        let values = [
            [0u32, 1023, 512],
            [1, 2, 3],
            [341, 682, 1000],
            [1023, 0, 77],
        ];
        let mut bytes = b"BM".to_vec();
        let height: i32 = if down { -2 } else { 2 };
        for word in [
            70,
            0,
            66,
            40,
            2,
            height as u32,
            0x0020_0001,
            3,
            16,
            0,
            0,
            0,
            0,
        ] {
            bytes.extend(u32::to_le_bytes(word));
        }
        bytes.extend(masks.iter().flat_map(|m| m.to_le_bytes()));
        let place =
            |v: &[u32; 3]| -> u32 { (0..3).map(|c| v[c] << masks[c].trailing_zeros()).sum() };
        let rows: Vec<u32> = values.iter().map(place).collect();
        let order = if down { [0, 1, 2, 3] } else { [2, 3, 0, 1] };
        bytes.extend(order.iter().flat_map(|i| rows[*i].to_le_bytes()));
        let file = read(&bytes);
        assert_eq!(file.bits, Some(10));
        for (pixel, values) in file.pixels.data.iter().zip(values) {
            assert_eq!(*pixel, values.map(|v| (f64::from(v) / 1023.0) as f32));
        }
        assert!(decode("a", &bytes[..bytes.len() - 1], None).is_err());
    }
}

#[test]
fn headers_may_end_with_two_bytes() {
    for (header, pixels) in [
        ("P6\r\n2 1\r\n255\r\n", &[10u8, 13, 10, 4, 5, 6][..]),
        ("P6\n2 1\n255\n", &[10, 13, 10, 4, 5, 6]),
        // One white space, and the first value is a line feed.
        ("P6\n2 1\n255\r", &[10, 13, 10, 4, 5, 6]),
    ] {
        let file = read(&[header.as_bytes(), pixels].concat());
        let first = file.pixels.data[0].map(|v| (v * 255.0).round() as u8);
        assert_eq!(first, [10, 13, 10], "{header:?}");
    }
    let values: Vec<u8> = [1.5f32, -2.0, 3.25]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let file = read(&[&b"PF\r\n1 1\r\n-1.0\r\n"[..], &values].concat());
    assert_eq!(file.pixels.data, [[1.5, -2.0, 3.25]]);
    let file = read(&[&b"P5\r\n1 2\r\n65535\r\n"[..], &[1, 0, 0, 1]].concat());
    assert_eq!(file.pixels.data[0][0], 256.0 / 65535.0);
}

/// A TIFF with nothing but an orientation.
fn exif(number: u8) -> Vec<u8> {
    let mut bytes = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0".to_vec();
    bytes.extend([number, 0, 0, 0, 0, 0, 0, 0]);
    bytes
}

#[test]
fn exif_orientation_is_noted_and_followed() {
    let expected = [
        "", "123/456", "321/654", "654/321", "456/123", "14/25/36", "41/52/63", "63/52/41",
        "36/25/14",
    ];
    for number in 1..=8u8 {
        let mut bytes = Vec::new();
        let mut info = png::Info::with_size(3, 2);
        info.color_type = png::ColorType::Grayscale;
        info.bit_depth = png::BitDepth::Eight;
        info.exif_metadata = Some(exif(number).into());
        let encoder = png::Encoder::with_info(&mut bytes, info).expect("an encoder");
        let mut writer = encoder.write_header().expect("a header");
        writer
            .write_image_data(&[1, 2, 3, 4, 5, 6])
            .expect("pixels");
        writer.finish().expect("an end");
        let options = |orient| ReadOptions {
            orient,
            ..ReadOptions::default()
        };
        for orient in [false, true] {
            let mut file = decode_with("a.png", &bytes, options(orient)).expect("a picture");
            file.pixels = file.pixels.map(|p| p.map(|v| (v * 255.0).round()));
            let at = if orient { number } else { 1 };
            assert_eq!(reds(&file), expected[usize::from(at)], "{number} {orient}");
            assert_eq!(notes(&file).contains("EXIF"), number != 1);
            assert_eq!(notes(&file).contains("--orient"), number != 1 && !orient);
        }
    }
    // A JPEG with the same data behind its first mark.
    let grey = image::GrayImage::from_fn(16, 8, |x, _| image::Luma([if x < 8 { 0 } else { 255 }]));
    let mut plain = std::io::Cursor::new(Vec::new());
    grey.write_to(&mut plain, image::ImageFormat::Jpeg)
        .expect("a JPEG");
    let data = [&b"Exif\0\0"[..], &exif(6)].concat();
    let mut bytes = b"\xff\xd8\xff\xe1".to_vec();
    bytes.extend((data.len() as u16 + 2).to_be_bytes());
    bytes.extend(&data);
    bytes.extend(&plain.into_inner()[2..]);
    let options = ReadOptions {
        orient: true,
        ..ReadOptions::default()
    };
    let file = decode_with("a.jpg", &bytes, options).expect("a picture");
    assert_eq!((file.pixels.width, file.pixels.height), (8, 16));
    assert!(file.pixels.data[0][0] < 0.1 && file.pixels.data[127][0] > 0.9);
}

/// Name and view of a part, and its channels, each of one value.
type Part<'a> = (&'a str, &'a str, &'a [(&'a str, f32)]);

/// An EXR of parts.
fn parts(parts: &[Part<'_>]) -> Vec<u8> {
    use exr::prelude::*;
    let layers = parts.iter().map(|(name, view, channels)| {
        let channels = channels
            .iter()
            .map(|(name, value)| AnyChannel::new(*name, FlatSamples::F32(vec![*value; 6])));
        let mut attributes = LayerAttributes::named(*name);
        if !view.is_empty() {
            attributes.view_name = Some(Text::from(*view));
        }
        Layer::new(
            (3, 2),
            attributes,
            Encoding::UNCOMPRESSED,
            AnyChannels::sort(channels.collect()),
        )
    });
    let layers: Vec<_> = layers.collect();
    let size = IntegerBounds::from_dimensions((3, 2));
    let image = Image::from_layers(ImageAttributes::new(size), layers);
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).expect("an EXR");
    bytes.into_inner()
}

#[test]
fn exr_parts_and_views_are_layers() {
    let rgb: [(&str, f32); 3] = [("R", 1.0), ("G", 2.0), ("B", 3.0)];
    let other: [(&str, f32); 4] = [("R", 4.0), ("G", 5.0), ("B", 6.0), ("spot.R", 7.0)];
    let bytes = parts(&[
        ("depth", "", &[("Z", 9.0)]),
        ("beauty", "left", &rgb),
        ("second", "right", &other),
    ]);
    let first = |layer: Option<&str>| decode("a", &bytes, layer).map(|f| f.pixels.data[5]);
    for (layer, expected) in [
        (None, [1.0, 2.0, 3.0]),
        (Some("beauty"), [1.0, 2.0, 3.0]),
        (Some("left"), [1.0, 2.0, 3.0]),
        (Some("second"), [4.0, 5.0, 6.0]),
        (Some("right"), [4.0, 5.0, 6.0]),
        (Some("spot"), [7.0, 0.0, 0.0]),
        (Some("second.spot"), [7.0, 0.0, 0.0]),
        (Some("depth"), [9.0; 3]),
    ] {
        assert_eq!(first(layer).expect("a picture"), expected, "{layer:?}");
    }
    let file = read(&bytes);
    assert!(
        notes(&file).contains("of its 3 parts, beauty is taken; --layer chooses: depth, second"),
        "{}",
        notes(&file)
    );
    let (_, help) = refused(&bytes, Some("middle"));
    assert!(
        help.contains("depth, beauty, left, second, right, spot"),
        "{help}"
    );
    // Some of the colours.
    for (channels, expected, note) in [
        (
            &[("R", 1.5f32), ("G", 2.5)][..],
            [1.5, 2.5, 0.0],
            "no channel B",
        ),
        (&[("G", 2.5)], [0.0, 2.5, 0.0], "no channel R and no B"),
        (&[("Y", 0.5)], [0.5; 3], ""),
    ] {
        let file = read(&parts(&[("only", "", channels)]));
        assert_eq!(file.pixels.data[0], expected);
        assert!(notes(&file).contains(note), "{}", notes(&file));
    }
}

#[test]
fn exr_luminance_and_chroma_are_colours() {
    // Y of 0.2 0.4 0.8 under BT.709, and the relative differences.
    let [r, g, b] = [0.2f64, 0.4, 0.8];
    let y = 0.212639 * r + 0.715169 * g + 0.072192 * b;
    let (ry, by) = ((r - y) / y, (b - y) / y);
    let file = read(&parts(&[(
        "grey",
        "",
        &[("Y", y as f32), ("RY", ry as f32), ("BY", by as f32)],
    )]));
    for (found, expected) in file.pixels.data[3].iter().zip([r, g, b]) {
        assert!(
            (f64::from(*found) - expected).abs() < 1e-5,
            "{:?}",
            file.pixels.data[3]
        );
    }
    // The same with chroma of every other pixel, written by hand: 4 x 4, no compression.
    let attribute = |name: &str, kind: &str, value: &[u8]| {
        let size = (value.len() as u32).to_le_bytes();
        [name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &size, value].concat()
    };
    let words = |values: &[i32]| {
        values
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect::<Vec<u8>>()
    };
    let channel =
        |name: &str, step: i32| [name.as_bytes(), b"\0", &words(&[2, 0, step, step])].concat();
    let window = words(&[0, 0, 3, 3]);
    let mut bytes = b"\x76\x2f\x31\x01\x02\0\0\0".to_vec();
    let channels = [channel("BY", 2), channel("RY", 2), channel("Y", 1), vec![0]].concat();
    bytes.extend(attribute("channels", "chlist", &channels));
    bytes.extend(attribute("compression", "compression", &[0]));
    bytes.extend(attribute("dataWindow", "box2i", &window));
    bytes.extend(attribute("displayWindow", "box2i", &window));
    bytes.extend(attribute("lineOrder", "lineOrder", &[0]));
    bytes.extend(attribute("pixelAspectRatio", "float", &1f32.to_le_bytes()));
    bytes.extend(attribute("screenWindowCenter", "v2f", &[0; 8]));
    bytes.extend(attribute("screenWindowWidth", "float", &1f32.to_le_bytes()));
    bytes.push(0);
    bytes.extend([0; 32]); // offsets, which nothing needs
    for line in 0..4 {
        let samples = |value: f64, n: usize| vec![(value as f32).to_le_bytes(); n].concat();
        let chroma = if line % 2 == 0 {
            [samples(by, 2), samples(ry, 2)].concat()
        } else {
            Vec::new()
        };
        let data = [chroma, samples(y, 4)].concat();
        bytes.extend(words(&[line, data.len() as i32]));
        bytes.extend(data);
    }
    let file = read(&bytes);
    for pixel in &file.pixels.data {
        for (found, expected) in pixel.iter().zip([r, g, b]) {
            assert!((f64::from(*found) - expected).abs() < 1e-5, "{pixel:?}");
        }
    }
    assert!(notes(&file).contains("chroma"));
    for cut in 1..bytes.len() {
        assert!(decode("a", &bytes[..cut], None).is_err(), "{cut}");
    }
    // PIZ.
    let at = bytes
        .windows(12)
        .position(|w| w == b"compression\0")
        .expect("it is there")
        + 12
        + 12
        + 4;
    bytes[at] = 4;
    let (message, help) = refused(&bytes, None);
    assert!(
        message.contains("compression") && help.contains("ZIP"),
        "{message} {help}"
    );
}

#[test]
fn what_is_not_read_is_called_that() {
    let bmp = |compression: u8| {
        let mut bytes = b"BM".to_vec();
        bytes.extend([0; 12]);
        bytes.extend([
            40,
            0,
            0,
            0,
            1,
            0,
            0,
            0,
            1,
            0,
            0,
            0,
            1,
            0,
            24,
            0,
            compression,
            0,
            0,
            0,
        ]);
        bytes.extend([0; 40]);
        bytes
    };
    let jpeg = |mark: u8, bits: u8| {
        let mut bytes = b"\xff\xd8\xff\xe0\0\x04ab\xff".to_vec();
        bytes.extend([mark, 0, 11, bits, 0, 8, 0, 8, 1, 1, 0x11, 0, 0xff, 0xd9]);
        bytes
    };
    for (bytes, what) in [
        (jpeg(0xc1, 12), "a JPEG of 12 bits a value"),
        (jpeg(0xc3, 8), "a lossless JPEG"),
        (jpeg(0xc9, 8), "a JPEG with arithmetic coding"),
        (bmp(4), "a JPEG inside a BMP"),
        (bmp(5), "a PNG inside a BMP"),
        (b"GIF89a".to_vec(), "this is a GIF"),
        (b"\0\0\0\x1cftypavif".to_vec(), "AVIF"),
        (b"\0\0\0\x0cJXL \r\n\x87\n".to_vec(), "JPEG XL"),
        (b"II*\0".to_vec(), "TIFF"),
        (b"P7\n".to_vec(), "PAM"),
    ] {
        let (message, help) = refused(&bytes, None);
        assert!(message.contains(what), "{message}");
        assert!(
            message.contains("not read") && !message.contains("broken"),
            "{message}"
        );
        assert!(help.contains("PNG"), "{help}");
    }
}

fn pfm(values: &[f32]) -> Vec<u8> {
    let mut bytes = format!("Pf\n{} 1\n-1.0\n", values.len()).into_bytes();
    bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

fn diff(a: &[u8], b: &[u8], decoded: Option<Which>) -> Diff {
    let options = ReadOptions {
        non_finite: true,
        ..ReadOptions::default()
    };
    let [a, b] = [a, b].map(|bytes| decode_with("a", bytes, options).expect("a picture"));
    let options = Options {
        ppd: 67.02,
        decode: decoded,
    };
    Diff::new(a, b, options, String::new()).expect("a comparison")
}

#[test]
fn values_that_are_not_finite_are_counted() {
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    assert!(decode("a", &pfm(&[0.5, nan]), None).is_err());
    let a = pfm(&[0.5, nan, inf, 0.25, nan]);
    for (b, counts, differing, max) in [
        (pfm(&[0.5, nan, inf, 0.25, -nan]), [3, 3, 0], 0, 0.0),
        (pfm(&[0.5, nan, -inf, 0.25, nan]), [3, 3, 1], 1, 0.0),
        (pfm(&[0.5, 0.0, inf, 0.75, nan]), [3, 2, 1], 2, 0.5),
        (pfm(&[0.5, inf, nan, 0.25, 1.0]), [3, 2, 3], 3, 0.0),
    ] {
        let found = diff(&a, &b, None).summary;
        let counted = found.non_finite.expect("counts");
        assert_eq!([counted.a, counted.b, counted.differing], counts);
        assert_eq!(
            (found.pixels_differing, found.metrics.max),
            (differing, max)
        );
        assert!(found.verdict().contains("NaN"), "{}", found.verdict());
    }
    let fine = pfm(&[0.5, 0.25]);
    assert_eq!(diff(&fine, &fine, None).summary.non_finite, None);
}

#[test]
fn decoding_reaches_flip() {
    let pgm = |f: &dyn Fn(usize) -> f64| {
        let mut bytes = b"P5 32 16 255\n".to_vec();
        bytes.extend((0..512).map(|i| (f(i) * 255.0).round() as u8));
        bytes
    };
    let srgb = |x: f64| {
        if x <= 0.003_130_8 {
            12.92 * x
        } else {
            1.055 * x.powf(1.0 / 2.4) - 0.055
        }
    };
    let light = |i: usize| i as f64 / 511.0;
    let (linear, encoded) = (pgm(&light), pgm(&|i| srgb(light(i))));
    let mean = |d: &Diff| d.summary.metrics.flip.mean;
    let as_stored = mean(&diff(&linear, &encoded, None));
    let decoded = mean(&diff(&linear, &encoded, Some(Which::B)));
    assert!(as_stored > 0.1 && decoded < 0.05, "{as_stored} {decoded}");
    // Both hold light now, which FLIP sees as a screen shows it: as if both files held sRGB values.
    let darker = pgm(&|i| light(i) * 0.8);
    let shown = pgm(&|i| srgb((light(i) * 0.8 * 255.0).round() / 255.0));
    let asked = mean(&diff(&darker, &encoded, Some(Which::B)));
    let as_srgb = mean(&diff(&shown, &encoded, None));
    assert!((asked - as_srgb).abs() < 0.01, "{asked} {as_srgb}");
    let plane: Plane<[f32; 3]> = read(&linear).pixels;
    assert_eq!(plane.width, 32);
}
