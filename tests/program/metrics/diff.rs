//! `rastray diff` as a user meets it: what it says, writes and returns.

use std::path::Path;

use serde_json::Value;

use crate::common::program::{rastray, text};

/// Runs and returns what it said on standard output.
fn run(folder: &Path, args: &[&str], code: i32) -> String {
    let output = rastray(folder, args);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
    assert!(!said.contains("panicked"), "{said}");
    let out = text(&output.stdout);
    if code == 2 { said } else { out }
}

/// A folder with two pictures of a scene, as PNG and as EXR with layers.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (mode, name) in [("raster", "a"), ("trace", "b")] {
        for ending in ["png", "exr"] {
            let file = format!("{name}.{ending}");
            let mut args = vec![
                "render", "whitted", "--size", "64x48", "--mode", mode, "-o", &file,
            ];
            args.extend((ending == "exr").then_some("--layers"));
            run(folder.path(), &args, 0);
        }
    }
    folder
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

#[test]
fn thresholds_decide_the_exit_code() {
    let folder = folder();
    let at = folder.path();
    let numbers = json(&run(at, &["diff", "a.png", "b.png", "--json"], 0));
    let number = |key: &str| numbers["metrics"][key].as_f64().expect("a number");
    let (max, psnr) = (number("max"), number("psnr"));
    let flip = numbers["metrics"]["flip"]["mean"]
        .as_f64()
        .expect("a number");
    for (flag, found, worse) in [
        ("--max-error", max, -1.0),
        ("--min-psnr", psnr, 1.0),
        ("--max-flip", flip, -1.0),
    ] {
        let exact = found.to_string();
        run(at, &["diff", "a.png", "b.png", flag, &exact], 0);
        let tight = (found + 1e-6 * worse).to_string();
        let output = rastray(at, &["diff", "a.png", "b.png", flag, &tight]);
        assert_eq!(output.status.code(), Some(1), "{flag}");
        let said = text(&output.stderr);
        assert!(said.contains(flag) && said.contains(&exact), "{said}");
    }
    // The same picture passes everything, and says that it is the same.
    std::fs::copy(at.join("a.png"), at.join("same.jpg")).expect("a copy");
    let strict = ["--max-error", "0", "--min-psnr", "1000", "--max-flip", "0"];
    let text = run(
        at,
        &[&["diff", "a.png", "same.jpg"], &strict[..]].concat(),
        0,
    );
    assert!(text.contains("The pictures are the same"), "{text}");
    let same = json(&run(at, &["diff", "a.png", "same.jpg", "--json"], 0));
    assert_eq!(
        (&same["metrics"]["psnr"], &same["pixels_differing"]),
        (&Value::Null, &Value::from(0))
    );
    assert_eq!(same["b"]["format"], "PNG");
}

#[test]
fn the_folder_holds_figures_numbers_and_a_page_of_its_own() {
    let folder = folder();
    let at = folder.path();
    let printed = run(
        at,
        &[
            "diff",
            "a.png",
            "b.png",
            "-o",
            "out/of/it",
            "--json",
            "-j",
            "1",
        ],
        0,
    );
    let out = at.join("out/of/it");
    let mut names: Vec<String> = std::fs::read_dir(&out)
        .expect("a folder")
        .map(|e| {
            e.expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    let expected = [
        "difference.png",
        "error.png",
        "flip.png",
        "index.html",
        "side-by-side.png",
        "summary.json",
    ];
    assert_eq!(names, expected);
    let stored = std::fs::read_to_string(out.join("summary.json")).expect("readable");
    assert_eq!(printed, stored);
    let page = std::fs::read_to_string(out.join("index.html")).expect("readable");
    assert!(page.contains("data:image/png;base64,"));
    for outside in ["src=\"http", "href=\"http", "url(http", "<script"] {
        assert!(!page.contains(outside), "{outside}");
    }
    // The same bytes for any number of threads.
    run(at, &["diff", "a.png", "b.png", "-o", "again", "-j", "3"], 0);
    for name in &expected[..3] {
        let read = |folder: &Path| std::fs::read(folder.join(name)).expect("readable");
        assert!(read(&out) == read(&at.join("again")), "{name}");
    }
}

#[test]
fn floats_are_compared_as_light_and_layers_by_name() {
    let folder = folder();
    let at = folder.path();
    let found = json(&run(at, &["diff", "a.exr", "b.exr", "--json"], 0));
    assert_eq!(found["flip"]["form"], "HDR");
    assert!(found["flip"]["exposures"][2].as_u64().expect("a count") >= 2);
    // A picture of 8 bits has no light beyond white.
    let found = json(&run(at, &["diff", "a.png", "b.exr", "--json"], 0));
    assert_eq!(
        (found["flip"]["form"].as_str(), found["a"]["bits"].as_u64()),
        (Some("LDR"), Some(8))
    );
    let layer = json(&run(
        at,
        &["diff", "a.exr", "b.exr", "--layer", "reflection", "--json"],
        0,
    ));
    assert!(layer["metrics"]["max"].as_f64().expect("a number") > 0.1);
    let text = run(at, &["diff", "a.exr", "b.exr"], 0);
    for wanted in [
        "assumed linear",
        "HDR-FLIP",
        "exposures",
        "ssim",
        "of 3,072 pixels",
    ] {
        assert!(text.contains(wanted), "{wanted}:\n{text}");
    }
}

#[test]
fn another_encoding_is_found_and_undone() {
    let folder = folder();
    let at = folder.path();
    let render = [
        "render", "whitted", "--size", "64x48", "--mode", "trace", "--srgb", "-o", "srgb.png",
    ];
    run(at, &render, 0);
    let text = run(at, &["diff", "b.png", "srgb.png"], 0);
    assert!(
        text.contains("assumed linear (rastray wrote it and says so)"),
        "{text}"
    );
    assert!(text.contains("Compare again with --decode b"), "{text}");
    let found = json(&run(
        at,
        &["diff", "b.png", "srgb.png", "--decode", "b", "--json"],
        0,
    ));
    // Half a step of 8 bits, at most 4.5 times as large where the curve is steep for the decoded one.
    assert!(
        found["metrics"]["rmse"].as_f64().expect("a number") < 1.0 / 255.0,
        "{found}"
    );
}

#[test]
fn wrong_input_is_an_error_with_its_reason() {
    let folder = folder();
    let at = folder.path();
    run(
        at,
        &["render", "whitted", "--size", "32x24", "-o", "small.png"],
        0,
    );
    std::fs::write(at.join("text.png"), "no picture").expect("writable");
    let png = std::fs::read(at.join("a.png")).expect("readable");
    std::fs::write(at.join("cut.png"), &png[..png.len() / 2]).expect("writable");
    for (args, wanted) in [
        (
            &["a.png", "small.png"][..],
            "small.png is 32 x 24 pixels, but a.png is 64 x 48",
        ),
        (&["a.png", "text.png"], "no picture in a known format"),
        (&["a.png", "cut.png"], "broken or cut off"),
        (&["a.png", "missing.png"], "missing.png"),
        (&["a.png", "."], "is a folder"),
        (&["a.png", "b.png", "--max-error", "nan"], "--max-error"),
        (&["a.png", "b.png", "--max-flip=-1"], "--max-flip"),
        (&["a.png", "b.png", "--ppd", "0"], "--ppd"),
        (&["a.png", "b.png", "--layer", "reflection"], "--layer"),
        (
            &["a.exr", "b.exr", "--layer", "reflexion"],
            "choose a layer with --layer: ",
        ),
        (&["a.png", "b.png", "--open"], "-o FOLDER"),
        (&["a.png", "b.png", "-o", "a.png"], "expected a folder"),
    ] {
        let said = run(at, &[&["diff"], args].concat(), 2);
        assert!(
            said.contains(wanted),
            "{args:?} should say {wanted}:\n{said}"
        );
    }
}
