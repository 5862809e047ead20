//! PSNR, SSIM and FLIP against `tests/reference/metrics.json`: scikit-image and the program of FLIP's authors, see
//! `tests/reference/metrics.py`, whose pictures are made again here.
//!
//! Bars: PSNR 1e-6 dB, SSIM 2e-5, FLIP (mean, median, max of the map) 1e-4. The packages compute FLIP in f32.

use std::path::{Path, PathBuf};

use rastray_compare::{Comparison, DynamicRange, Encoding, ImageView, Viewing};
use serde_json::Value;

type Pixels = Vec<[f32; 3]>;

/// 32 bits that look random.
fn noise(x: i64, y: i64, c: i64, seed: i64) -> i64 {
    let mut h =
        (x * 374_761_393 + y * 668_265_263 + c * 2_246_822_519 + seed * 3_266_489_917) as u32;
    h ^= h >> 13;
    h = h.wrapping_mul(1_274_126_177);
    i64::from(h ^ (h >> 16))
}

fn gradient(x: i64, y: i64, c: i64) -> i64 {
    (2 * x + y * (c + 1) - 40 * c).clamp(0, 255)
}

fn blocks(x: i64, y: i64, c: i64) -> i64 {
    noise(x / 7, y / 5, c, 3) % 256
}

fn lines(x: i64, y: i64, c: i64) -> i64 {
    let line = x % 9 == 4 || (x + 2 * y) % 23 == 0;
    if line { 20 } else { 200 + 20 * c }
}

fn light(x: i64, y: i64, c: i64) -> i64 {
    let lit = (x - 20) * (x - 20) + (y - 15) * (y - 15) < 30;
    x / 4 + y / 3 + if lit { 640 } else { 0 } / (c + 1)
}

fn spark(x: i64, y: i64, c: i64) -> i64 {
    let lit = (x / 6 + y / 6) % 4 == 0;
    if lit { noise(x, y, c, 5) % 100 } else { 0 }
}

/// Whole numbers for (x, y, channel).
type Formula = fn(i64, i64, i64) -> i64;

/// The reference and the test picture of a case.
fn formulas(name: &str) -> [Formula; 2] {
    match name {
        "gradient and noise" => [gradient, |x, y, c| {
            (gradient(x, y, c) + noise(x, y, c, 1) % 13 - 6).clamp(0, 255)
        }],
        "blocks and blocks one pixel aside" | "the same from near" | "the same from afar" => {
            [blocks, |x, y, c| blocks(x + 1, y, c)]
        }
        "lines and lines with gaps" => [lines, |x, y, c| {
            let gap = y / 16 == 2 && x > 30;
            if gap { 230 } else { lines(x, y, c) }
        }],
        "colours turned" => [blocks, |x, y, c| blocks(x, y, (c + 1) % 3)],
        "two noises" => [
            |x, y, c| noise(x, y, c, 7) % 256,
            |x, y, c| noise(x, y, c, 8) % 256,
        ],
        "one step brighter" => [gradient, |x, y, c| (gradient(x, y, c) + 1).clamp(0, 255)],
        "one window" => [gradient, |x, y, c| {
            (gradient(x, y, c) + 20 * (x % 2)).clamp(0, 255)
        }],
        "smaller than a window" => [gradient, |x, y, c| (gradient(x, y, c) + 9).clamp(0, 255)],
        "lamps and dimmer lamps" => [light, |x, y, c| light(x, y, c) * 7 / 8 + 1],
        "sparks on black" => [spark, |x, y, c| spark(x, y, c) + (x * y) % 3],
        _ => panic!("no formula for {name}: metrics.json and this file do not belong together"),
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference")
}

fn file(name: &str) -> Pixels {
    let picture = image::open(folder().join(name))
        .expect("a readable PNG")
        .into_rgb8();
    picture
        .pixels()
        .map(|p| p.0.map(|v| f32::from(v) / 255.0))
        .collect()
}

/// The pictures of a case: reference and test.
fn pictures(case: &Value, width: usize, height: usize) -> [Pixels; 2] {
    if let Some(files) = case["files"].as_array() {
        return [0, 1].map(|i| file(files[i].as_str().expect("a name")));
    }
    let scale = if case["kind"] == "ldr" { 255.0 } else { 16.0 };
    formulas(case["name"].as_str().expect("a name")).map(|f| {
        let pixel = |i: usize| {
            let (x, y) = ((i % width) as i64, (i / width) as i64);
            [0, 1, 2].map(|c| (f(x, y, c) as f64 / scale) as f32)
        };
        (0..width * height).map(pixel).collect()
    })
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

/// The largest gap to the reference, for PSNR, SSIM, the three FLIP numbers, and FLIP at single pixels.
fn gaps(case: &Value) -> [f64; 4] {
    let [width, height] = [0, 1].map(|i| number(&case["size"][i]) as usize);
    let both = pictures(case, width, height);
    let [reference, test] = [0, 1]
        .map(|i| ImageView::new(width, height, &both[i], Encoding::Linear).expect("a picture"));
    let low = case["kind"] == "ldr";
    let viewing = Viewing {
        ppd: number(&case["ppd"]),
        range: if low {
            DynamicRange::Low
        } else {
            DynamicRange::High
        },
    };
    let measured = Comparison::new(&test, &reference, viewing).expect("comparable");
    let (m, name) = (measured.metrics(), &case["name"]);
    let gap = |mine: Option<f64>, theirs: &Value| match (mine, theirs) {
        (_, Value::Null) => 0.0,
        (Some(mine), theirs) => (mine - number(theirs)).abs(),
        _ => panic!("{name}: {theirs} expected"),
    };
    assert_eq!(m.ssim.is_none(), width.min(height) < 11, "{name}");
    let flip = [
        (m.flip.mean, "mean"),
        (m.flip.median, "median"),
        (m.flip.max, "max"),
    ];
    let flip = flip.map(|(mine, key)| gap(Some(mine), &case["flip"][key]));
    let points = case["flip_at"].as_array().expect("points");
    assert!(!points.is_empty());
    let at = points.iter().map(|point| {
        let [x, y] = [0, 1].map(|i| number(&point[i]) as usize);
        gap(
            Some(f64::from(measured.flip().values[y * width + x])),
            &point[2],
        )
    });
    if let Some(exposures) = case["exposures"].as_array() {
        let mine = measured
            .flip()
            .exposures
            .expect("exposures of a float picture");
        assert!(
            (mine.start - number(&exposures[0])).abs() < 1e-5,
            "{name}: {mine:?}"
        );
        assert!(
            (mine.stop - number(&exposures[1])).abs() < 1e-5,
            "{name}: {mine:?}"
        );
        assert_eq!(mine.count as f64, number(&exposures[2]), "{name}");
    }
    let psnr = if low { gap(m.psnr, &case["psnr"]) } else { 0.0 };
    [
        psnr,
        gap(m.ssim, &case["ssim"]),
        flip.into_iter().fold(0.0, f64::max),
        at.fold(0.0, f64::max),
    ]
}

#[test]
fn psnr_ssim_and_flip_are_those_of_independent_packages() {
    let text = std::fs::read_to_string(folder().join("metrics.json")).expect("readable");
    let data: Value = serde_json::from_str(&text).expect("JSON");
    let cases = data["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 14);
    for case in cases {
        let [psnr, ssim, flip, at] = gaps(case);
        println!(
            "{}: PSNR {psnr:.1e} SSIM {ssim:.1e} FLIP {flip:.1e}, at pixels {at:.1e}",
            case["name"]
        );
        assert!(psnr <= 1e-6, "{}: PSNR is off by {psnr}", case["name"]);
        assert!(ssim <= 2e-5, "{}: SSIM is off by {ssim}", case["name"]);
        assert!(flip <= 1e-4, "{}: FLIP is off by {flip}", case["name"]);
        assert!(
            at <= 1e-4,
            "{}: FLIP is off by {at} at a pixel",
            case["name"]
        );
    }
}
