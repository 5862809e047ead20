//! The rasterizer's routines against the reference cases of the numerics guide (kinds raster, near, persp, depth).
//!
//! The cases lie outside the repository; where they are absent the test says that it was skipped.

use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Path, PathBuf};

use rastray::raster::{Run, coverage, coverage_clip_space, depth_key, perspective_weights};
use rastray::scene::Snap;
use serde_json::Value;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/numerics")
}

fn load(name: &str) -> Option<Value> {
    let file = std::fs::File::open(folder().join(name)).ok()?;
    let mut text = String::new();
    if name.ends_with(".gz") {
        let mut reader = flate2::read::GzDecoder::new(file);
        reader.read_to_string(&mut text).expect("readable");
    } else {
        std::io::BufReader::new(file)
            .read_to_string(&mut text)
            .expect("readable");
    }
    Some(serde_json::from_str(&text).expect("JSON"))
}

/// The evaluations of one kind: group, input, expected answer.
fn cases(kind: &str) -> Vec<(String, Value, Value)> {
    let (Some(cases), Some(expect)) = (load("cases.json.gz"), load("expect.json.gz")) else {
        println!("skipped: {} is absent", folder().display());
        return Vec::new();
    };
    let mut found = Vec::new();
    for case in cases.as_array().expect("a list") {
        if case["kind"] == kind {
            let id = case["id"].as_str().expect("an id");
            let inputs = case["evals"].as_array().expect("a list");
            let answers = expect[id].as_array().expect("a list");
            for (input, answer) in inputs.iter().zip(answers) {
                found.push((id.to_owned(), input.clone(), answer.clone()));
            }
        }
    }
    assert!(!found.is_empty(), "no case of kind {kind}");
    found
}

fn numbers<const N: usize>(v: &Value) -> [f64; N] {
    let list: Vec<f64> = v
        .as_array()
        .expect("a list")
        .iter()
        .map(|x| x.as_f64().expect("a number"))
        .collect();
    list.try_into().expect("the right length")
}

fn triangle<const N: usize>(v: &Value) -> [[f64; N]; 3] {
    [numbers(&v[0]), numbers(&v[1]), numbers(&v[2])]
}

fn pixels(runs: &[Run]) -> BTreeSet<(i64, i64)> {
    let row = |run: &Run| (run.x0..=run.x1).map(|x| (run.y, x)).collect::<Vec<_>>();
    runs.iter().flat_map(row).collect()
}

fn runs(v: &Value) -> Vec<Run> {
    let list = v.as_array().expect("a list");
    list.iter()
        .map(|run| {
            let [y, x0, x1] = numbers(run).map(|x| x as i64);
            Run { y, x0, x1 }
        })
        .collect()
}

fn size(v: &Value) -> [u32; 2] {
    numbers(&v["size"]).map(|x| x as u32)
}

#[test]
fn coverage_is_the_rational_answer() {
    for (snap, key) in [(Snap::Bits8, "8"), (Snap::Bits12, "12")] {
        for (id, input, answer) in cases("raster") {
            let origin: [f64; 2] = numbers(&input["origin"]);
            let triangles = input["tris"].as_array().expect("a list");
            for (i, t) in triangles.iter().enumerate() {
                let got = coverage(triangle(t), origin.map(|x| x as i64), size(&input), snap);
                let stated = &answer[key][i];
                let expected = if stated.is_null() {
                    &answer["8"][i]
                } else {
                    stated
                };
                let expected = pixels(&runs(expected));
                let wrong = pixels(&got).symmetric_difference(&expected).count();
                assert_eq!(wrong, 0, "{id}, {key} bits, triangle {i}: {t}");
            }
        }
    }
}

#[test]
fn near_clipped_coverage_differs_at_outlines_only() {
    for (_, input, answer) in cases("near") {
        let got = coverage_clip_space(triangle(&input["clip"]), size(&input), Snap::Bits8);
        let may = answer["may"].as_array().expect("a list");
        let may: BTreeSet<(i64, i64)> = may
            .iter()
            .map(|p| {
                let [x, y] = numbers(p).map(|x| x as i64);
                (y, x)
            })
            .collect();
        let expected = pixels(&runs(&answer["runs"]));
        let wrong: Vec<_> = pixels(&got)
            .symmetric_difference(&expected)
            .filter(|p| !may.contains(p))
            .copied()
            .collect();
        assert!(wrong.is_empty(), "{input}: {wrong:?}");
    }
}

#[test]
fn interpolation_stays_within_the_f64_bar() {
    let (mut worst_attribute, mut worst_w) = (0.0f64, 0.0f64);
    for (_, input, answer) in cases("persp") {
        let clip: [[f64; 4]; 3] = triangle(&input["clip"]);
        let corners = clip.map(|[x, y, _, w]| [x, y, w]);
        let attribute: [f64; 3] = numbers(&input["attr"]);
        let largest = attribute.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let [width, height] = size(&input).map(f64::from);
        let places = input["px"].as_array().expect("a list");
        for (place, expected) in places.iter().zip(answer["v"].as_array().expect("a list")) {
            let [x, y]: [f64; 2] = numbers(place);
            let ndc = [
                (2.0 * (x + 0.5) - width) / width,
                (height - 2.0 * (y + 0.5)) / height,
            ];
            let b = perspective_weights(corners, ndc).expect("not edge-on");
            let sum = |v: [f64; 3]| b[0] * v[0] + b[1] * v[1] + b[2] * v[2];
            let [value, w] = numbers(expected);
            worst_attribute = worst_attribute.max((sum(attribute) - value).abs() / largest);
            worst_w = worst_w.max((sum(corners.map(|h| h[2])) - w).abs() / w.abs());
        }
    }
    println!("attribute {worst_attribute:e}, w {worst_w:e}");
    if let Some(bars) = load("bars.json") {
        let bar = |key: &str| {
            bars["bars"]["raster/persp"]["f64"][key]
                .as_f64()
                .expect("a bar")
        };
        assert!(worst_attribute <= bar("err_attr"), "{worst_attribute:e}");
        assert!(worst_w <= bar("err_w"), "{worst_w:e}");
    }
}

#[test]
fn depth_order_is_right() {
    for (id, input, answer) in cases("depth") {
        let [a, b] = ["z1", "z2"].map(|k| depth_key(input[k].as_f64().expect("a distance")));
        let closer = i64::from(a > b) + 2 * i64::from(b > a);
        assert_eq!(Some(closer), answer["closer"].as_i64(), "{id}: {input}");
    }
}
