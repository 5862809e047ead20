//! The program as a user meets it: the examples of `--help` run, errors have their place and exit code, nothing is left
//! half-written.

use std::path::Path;
use std::process::{Command, Output};

use crate::common::program::{rastray, text};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn ok(folder: &Path, args: &[&str]) -> String {
    let output = rastray(folder, args);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{args:?}: {}",
        text(&output.stderr)
    );
    text(&output.stdout)
}

/// The error text of a run that must fail with exit code 2 and write nothing.
fn error(folder: &Path, args: &[&str]) -> String {
    let before = std::fs::read_dir(folder).expect("readable").count();
    let output = rastray(folder, args);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
    assert!(!message.contains("panicked"), "{args:?}: {message}");
    assert_eq!(
        std::fs::read_dir(folder).expect("readable").count(),
        before,
        "{args:?} left files"
    );
    message
}

/// The program itself, and its commands.
const COMMANDS: [&str; 12] = [
    "",
    "render",
    "compare",
    "explain",
    "diff",
    "check",
    "trade",
    "inspect",
    "scenes",
    "lecture",
    "schema",
    "completions",
];

#[test]
fn every_example_of_the_help_runs() {
    let folder = folder();
    std::fs::write(
        folder.path().join("mine.toml"),
        ok(folder.path(), &["scenes", "whitted"]),
    )
    .expect("writable");
    for (name, more) in [
        ("expected.png", &[][..]),
        ("mine.png", &[]),
        ("expected.exr", &["--layers"]),
        ("mine.exr", &["--layers"]),
    ] {
        let args = ["render", "whitted", "--size", "64x48", "-o", name];
        ok(folder.path(), &[&args[..], more].concat());
    }
    let (mut ran, mut sheets) = (0, 0);
    for command in COMMANDS {
        let mut args: Vec<&str> = command.split_whitespace().collect();
        args.push("--help");
        let help = ok(folder.path(), &args);
        for line in help
            .lines()
            .filter_map(|line| line.trim().strip_prefix("rastray "))
        {
            // Comments follow two spaces; a redirection belongs to the shell.
            let line = line.split("   ").next().unwrap_or(line);
            let line = line.split(" > ").next().unwrap_or(line);
            // Quotes too: brackets mean something to some shells.
            let words = line.split_whitespace().map(|word| word.trim_matches('\''));
            let mut args: Vec<&str> = words.collect();
            if args.is_empty() || args[0].starts_with(['<', '[']) {
                continue;
            }
            // A minute's work on a small machine; it has a test of its own, with one sample.
            if args.contains(&"--contact-sheet") {
                sheets += 1;
                continue;
            }
            // A watch would not end, and nothing should be shown here: both have tests of their own.
            args.retain(|arg| !matches!(*arg, "--watch" | "--open"));
            // Small pictures: what is tested is that the line works.
            if matches!(args[0], "render" | "compare" | "lecture") && !args.contains(&"--size") {
                args.extend(["--size", "64x48"]);
            }
            if args.contains(&"--extremes") {
                args.extend(["--size", "8x6"]);
            } else if args[0] == "trade" {
                args.extend(["--size", "16x12", "--ideal-samples", "4"]);
                if !args.contains(&"--budget") {
                    args.extend(["--budget", "1"]);
                }
            }
            ok(folder.path(), &args);
            ran += 1;
        }
    }
    assert!(ran >= 20 && sheets == 1, "only {ran} examples found");
}

#[test]
fn short_help_fits_one_screen() {
    let folder = folder();
    for command in &COMMANDS[1..] {
        let lines = ok(folder.path(), &[command, "-h"]).lines().count();
        assert!(lines <= 40, "{command} -h has {lines} lines");
    }
    assert!(ok(folder.path(), &["-h"]).lines().count() <= 24);
}

#[test]
fn compare_writes_every_file() {
    let folder = folder();
    let json = ok(
        folder.path(),
        &[
            "compare", "whitted", "--size", "96x72", "--json", "-o", "out",
        ],
    );
    let out = folder.path().join("out");
    for file in [
        "raster.png",
        "trace.png",
        "difference.png",
        "side-by-side.png",
        "buildup.png",
        "layers.exr",
        "summary.json",
        "index.html",
        "terms",
        "causes",
    ] {
        assert!(out.join(file).exists(), "{file} is missing");
    }
    assert_eq!(
        std::fs::read_dir(out.join("causes"))
            .expect("a folder")
            .count(),
        9
    );
    let summary: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let stored = std::fs::read_to_string(out.join("summary.json")).expect("readable");
    assert_eq!(
        summary,
        serde_json::from_str::<serde_json::Value>(&stored).expect("JSON")
    );
    assert_eq!(summary["residual_max"], 0.0);
    assert_eq!(summary["causes"].as_array().expect("a list").len(), 9);
    for key in ["mse", "rmse", "mae", "max", "p50", "p95", "p99", "psnr"] {
        assert!(summary["metrics"][key].is_number(), "{key}");
    }
    for part in ["metrics", "silhouette", "interior"] {
        assert!(summary[part]["ssim"].is_number(), "{part}");
        for key in ["mean", "median", "max"] {
            assert!(summary[part]["flip"][key].is_number(), "{part}, {key}");
        }
    }
    // The two parts make up the whole.
    let mse = |part: &str| summary[part]["mse"].as_f64().expect("a number");
    let (low, high) = (
        mse("interior").min(mse("silhouette")),
        mse("interior").max(mse("silhouette")),
    );
    assert!((low..=high).contains(&mse("metrics")));
    let leftovers = std::fs::read_dir(&out)
        .expect("a folder")
        .flatten()
        .filter(|entry| entry.file_name().to_string_lossy().contains("tmp"));
    assert_eq!(leftovers.count(), 0, "temporary files are left");
}

#[test]
fn pictures_are_the_same_bytes_for_any_thread_count() {
    let folder = folder();
    for (threads, name) in [("1", "a.png"), ("2", "b.png"), ("8", "c.png")] {
        let args = [
            "render", "whitted", "--mode", "trace", "--size", "80x60", "-j", threads, "-o", name,
        ];
        ok(folder.path(), &args);
    }
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("written");
    assert!(read("a.png") == read("b.png") && read("a.png") == read("c.png"));
}

#[test]
fn required_and_full_models_give_the_same_bytes() {
    let folder = folder();
    for scene in ["whitted", "highlight", "lights", "two-sided", "vase"] {
        for mode in ["raster", "trace"] {
            for model in ["required", "full"] {
                let name = format!("{scene}-{mode}-{model}.pfm");
                let args = [
                    "render", scene, "--mode", mode, "--size", "60x45", "--model", model, "-o",
                ];
                ok(folder.path(), &[&args[..], &[&name]].concat());
            }
            let read = |model| {
                let name = format!("{scene}-{mode}-{model}.pfm");
                std::fs::read(folder.path().join(name)).expect("written")
            };
            assert!(read("required") == read("full"), "{scene}, {mode}");
        }
    }
}

#[test]
fn picture_on_standard_output() {
    let folder = folder();
    let output = rastray(
        folder.path(),
        &["render", "whitted", "--size", "32x24", "-o", "-"],
    );
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(&output.stdout[..8], b"\x89PNG\r\n\x1a\n");
}

#[test]
fn bad_flags_are_named() {
    let folder = folder();
    for (args, wanted) in [
        (&["render", "whitted", "--size", "0x10"][..], "--size"),
        (&["render", "whitted", "--size", "99999x99999"], "--size"),
        (&["render", "whitted", "--size", "banana"], "640x480"),
        (&["render", "whitted", "--samples", "0"], "--samples"),
        (
            &["render", "whitted", "--tessellation", "2"],
            "--tessellation",
        ),
        (&["render", "whitted", "--snap", "9"], "8, 12 or exact"),
        (&["render", "whitted", "--isa", "mmx"], "--isa"),
        (&["render", "whitted", "-o", "picture.bmp"], ".png"),
        (&["render", "whitted", "-o", "picture"], ".png"),
        (&["render", "whitted", "--layers", "-o", "a.png"], ".exr"),
        (
            &["render", "whitted", "-o", "no/such/folder/a.png"],
            "no/such/folder",
        ),
        (&["render", "wihtted"], "whitted"),
        (&["render", "missing.toml"], "missing.toml"),
        (&["render", "whitted", "--set", "trace.dpeth=1"], "depth"),
        (&["render", "whitted", "--set", "nonsense"], "KEY=VALUE"),
        (&["scenes", "wihtted"], "whitted"),
        (
            &["compare", "whitted", "--max-error", "1e-4"],
            "--against opengl",
        ),
        (&["compare", "whitted", "--driver-info"], "--against opengl"),
        (&["render", "whitted", "-o", "a.gif"], "--turntable"),
        (&["render", "whitted", "--turntable", "0"], "1 to 10000"),
        (&["render", "whitted", "--turntable", "10001"], "1 to 10000"),
        (
            &["render", "whitted", "--turntable", "2", "-o", "-"],
            "one picture",
        ),
        (
            &[
                "render",
                "whitted",
                "--turntable",
                "2",
                "-o",
                "a.gif",
                "--fps",
                "51",
            ],
            "--fps",
        ),
        (
            &["render", "whitted", "--turntable", "9999", "-o", "a.gif"],
            "--size",
        ),
        (
            &[
                "render",
                "whitted",
                "--turntable",
                "2",
                "--layers",
                "-o",
                "a.gif",
            ],
            ".exr",
        ),
        (
            &["render", "whitted", "--vary", "trace.depth=0..3"],
            "KEY=A..B:N",
        ),
        (
            &["render", "whitted", "--vary", "trace.depth=0-3:2"],
            "KEY=A..B:N",
        ),
        (
            &["render", "whitted", "--vary", "trace.depth=0..3:0"],
            "1 to 10000",
        ),
        (
            &["render", "whitted", "--vary", "trace.dpeth=0..3:2"],
            "depth",
        ),
        (
            &[
                "render",
                "whitted",
                "--vary",
                "material.mirror.shininess=1..-5:3",
            ],
            "--vary material.mirror.shininess=-5.0",
        ),
        (&["render", "whitted", "--open", "-o", "-"], "--open"),
        (&["render", "whitted", "--watch"], "rastray scenes whitted"),
        (&["compare", "whitted", "--watch"], "rastray scenes whitted"),
        (&["completions", "bsh"], "bash"),
        (&["lecture", "wihtted"], "whitted"),
        (&["lecture", "--size", "9"], "--size"),
        (&["lecture", "--samples", "0"], "--samples"),
        (&["scenes", "--contact-sheet", "a.exr"], ".png"),
        (&["scenes", "--contact-sheet", "no/a.png"], "no/a.png"),
        (
            &["scenes", "whitted", "--contact-sheet", "a.png"],
            "--contact-sheet",
        ),
    ] {
        let message = error(folder.path(), args);
        assert!(
            message.contains(wanted),
            "{args:?} should name {wanted}:\n{message}"
        );
    }
}

#[test]
fn errors_show_the_line_with_a_caret() {
    let folder = folder();
    let scene = "[object.ball]\nshape = \"sphere\"\nradius = \"big\"\n";
    std::fs::write(folder.path().join("bad.toml"), scene).expect("writable");
    let message = error(folder.path(), &["render", "bad.toml"]);
    assert!(message.contains("bad.toml:3:10"), "{message}");
    assert!(message.contains("radius = \"big\""), "{message}");
    assert!(message.contains("^^^^^"), "{message}");
}

#[test]
fn inspect_names_features_and_reasons() {
    let folder = folder();
    let json = ok(folder.path(), &["inspect", "whitted", "--json"]);
    let report: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let features: Vec<&str> = report["features"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|f| f.as_str())
        .collect();
    for wanted in [
        "diffuse",
        "reflection_rays",
        "refraction_rays",
        "shadow_rays",
    ] {
        assert!(features.contains(&wanted), "{wanted} in {features:?}");
        assert!(
            report["why"][wanted]
                .as_str()
                .is_some_and(|why| !why.is_empty())
        );
    }
    // What is absent says what that saves; together they are every feature.
    let saves = report["saves"].as_object().expect("an object");
    assert!(
        saves["spot"]
            .as_str()
            .is_some_and(|text| text.contains("cone"))
    );
    assert_eq!(features.len() + saves.len(), 18);
    let text = ok(folder.path(), &["inspect", "whitted"]);
    assert!(text.contains("Requires") && text.contains("Does without"));
}

#[test]
fn outputs_that_cannot_be_written_are_told_before_the_work() {
    let folder = folder();
    std::fs::write(folder.path().join("file"), "x").expect("writable");
    // So large that drawing first would take minutes.
    let big = ["--size", "8192x8192", "--samples", "4096"];
    for (command, output, wanted) in [
        ("render", "missing/a.png", "there is no folder missing"),
        ("render", "file/a.png", "file is a file"),
        ("compare", "file", "expected a folder"),
        ("compare", "file/a", "expected a folder"),
    ] {
        let args = [&[command, "whitted", "-o", output], &big[..]].concat();
        let message = error(folder.path(), &args);
        assert!(message.contains(wanted), "{message}");
    }
    let args = ["render", "whitted", "--stats", "missing/s.json"];
    let message = error(folder.path(), &[&args, &big[..]].concat());
    assert!(message.contains("--stats: missing/s.json"), "{message}");
}

/// The values of a picture, none of which may be NaN.
fn values(folder: &Path, args: &[&str]) -> Vec<f32> {
    ok(
        folder,
        &[args, &["--size", "16x12", "-o", "a.pfm"]].concat(),
    );
    let bytes = std::fs::read(folder.join("a.pfm")).expect("written");
    let values: Vec<f32> = bytes[bytes.len() - 16 * 12 * 12..]
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect();
    assert!(values.iter().all(|x| !x.is_nan()), "{args:?}");
    values
}

/// Infinite intensities and weights that grow without bound are defined, and leave no NaN (numerics: "times 0 -> 0").
#[test]
fn infinite_light_leaves_no_nan() {
    let folder = folder();
    let scene = "[camera]\neye = [0, 0, 0.2]\ntarget = [0.1, 0.2, -1]\nnear = 0.001\n\
        [light.key]\nposition = [0, 0, 0.5]\n[material.mirror]\ncolor = 0.1\nreflection = 1\n\
        [object.a]\nshape = \"plane\"\ncenter = [0, 0, -1]\nnormal = [0, 0, 1]\nmaterial = \"mirror\"\nsize = 1000\n\
        [object.b]\nshape = \"plane\"\ncenter = [0, 0, 1]\nnormal = [0, 0, -1]\nmaterial = \"mirror\"\nsize = 1000\n";
    std::fs::write(folder.path().join("mirrors.toml"), scene).expect("writable");
    let traced = [
        "render",
        "mirrors.toml",
        "--mode",
        "trace",
        "--depth",
        "2000",
    ];
    for weight in ["1e3", "1e30", "-2"] {
        let set = format!("material.mirror.reflection={weight}");
        for precision in ["f32", "f64"] {
            let args = ["--precision", precision, "--set", &set];
            values(folder.path(), &[&traced, &args[..]].concat());
        }
    }
    for shading in ["flat", "gouraud", "phong"] {
        let args = [
            "--shading",
            shading,
            "--set",
            "light.key.attenuation=[0,0,0]",
        ];
        let drawn = values(
            folder.path(),
            &[&["render", "mirrors.toml"], &args[..]].concat(),
        );
        assert!(drawn.contains(&f32::INFINITY), "{shading}");
    }
    let set = "light.key.attenuation=[0,0,0]";
    let args = ["compare", "mirrors.toml", "--size", "16x12", "--set", set];
    ok(folder.path(), &args);
}

#[test]
fn what_exceeds_memory_or_precision_is_refused() {
    let folder = folder();
    let args = ["compare", "whitted", "--size", "16384x8192"];
    assert!(error(folder.path(), &args).contains("layers of 16384x8192 pixels"));
    let scene = "[object.ball]\nshape = \"sphere\"\nradius = 3e38\n\
        transform = [{ scale = 1e10 }]\n[camera]\neye = [0, 0, 5]\nnear = 1\n";
    std::fs::write(folder.path().join("huge.toml"), scene).expect("writable");
    let message = error(folder.path(), &["render", "huge.toml"]);
    assert!(
        message.contains("object ball: reaches farther"),
        "{message}"
    );
    assert!(message.contains("--precision f64"), "{message}");
    ok(
        folder.path(),
        &["render", "huge.toml", "--precision", "f64"],
    );
}

/// Names in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("readable").flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn a_turntable_writes_numbered_files_and_begins_with_the_plain_picture() {
    let folder = folder();
    let size = ["--size", "40x30"];
    for (scene, output) in [("whitted", "turn.png"), ("highlight", "turn.exr")] {
        let args = ["render", scene, "--turntable", "3", "-o", output];
        ok(folder.path(), &[&args[..], &size].concat());
        let plain = format!("plain-{output}");
        ok(
            folder.path(),
            &[&["render", scene, "-o", &plain][..], &size].concat(),
        );
        let read = |name: &str| std::fs::read(folder.path().join(name)).expect("written");
        let frame = |i: u32| read(&output.replace('.', &format!("-{i:04}.")));
        assert!(frame(1) == read(&plain), "{scene}: frame 1");
        assert!(frame(1) != frame(2) && frame(2) != frame(3) && frame(3) != frame(1));
    }
    assert_eq!(names(folder.path()).len(), 8);
}

#[test]
fn varied_frames_are_what_set_gives() {
    let folder = folder();
    let common = ["render", "whitted", "--mode", "trace", "--size", "40x30"];
    let vary = ["--vary", "trace.depth=0..4:3"];
    ok(folder.path(), &[&common[..], &vary].concat());
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("written");
    for (i, depth) in [0, 2, 4].into_iter().enumerate() {
        let set = format!("trace.depth={depth}");
        let args = ["--set", &set, "-o", "one.png"];
        ok(folder.path(), &[&common[..], &args].concat());
        let frame = format!("whitted-{:04}.png", i + 1);
        assert!(read(&frame) == read("one.png"), "depth {depth}");
    }
    // The json report has one entry a frame, and is all that standard output holds.
    let json = ok(folder.path(), &[&common[..], &vary, &["--json"]].concat());
    let report: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(report["frames"].as_array().map(Vec::len), Some(3));
}

#[test]
fn a_gif_shows_the_frames_and_repeats() {
    let folder = folder();
    let output = folder.path().join("turn.gif");
    let args = [
        "render",
        "whitted",
        "--turntable",
        "5",
        "--fps",
        "10",
        "--size",
        "40x30",
        "-o",
        "turn.gif",
    ];
    ok(folder.path(), &args);
    assert_eq!(names(folder.path()), ["turn.gif"]);
    let first = std::fs::read(&output).expect("written");
    let mut decoder = gif::DecodeOptions::new();
    decoder.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = decoder.read_info(&first[..]).expect("a GIF");
    assert_eq!((decoder.width(), decoder.height()), (40, 30));
    let mut frames = 0;
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        assert_eq!(frame.delay, 10);
        frames += 1;
    }
    assert_eq!(frames, 5);
    assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
    // Same bytes for any thread count.
    ok(folder.path(), &[&args[..], &["-j", "1"]].concat());
    assert!(first == std::fs::read(&output).expect("written"));
}

/// Built without it, the program still knows the option, and says how to get it.
#[cfg(not(feature = "opengl"))]
#[test]
fn opengl_says_how_to_get_it() {
    let folder = folder();
    for args in [
        &["render", "whitted", "--mode", "opengl"][..],
        &["compare", "whitted", "--against", "opengl"],
    ] {
        let message = error(folder.path(), args);
        assert!(message.contains("--features opengl"), "{message}");
    }
}

#[test]
fn completions_know_the_commands() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = ok(folder.path(), &["completions", shell]);
        for word in ["compare", "turntable"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
}

#[test]
fn scenes_are_listed_in_columns() {
    let folder = folder();
    let list = ok(folder.path(), &["scenes"]);
    let json = ok(folder.path(), &["scenes", "--json"]);
    let scenes: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let scenes = scenes.as_array().expect("a list");
    assert!(scenes.len() >= 5);
    let mut columns = std::collections::BTreeSet::new();
    for scene in scenes {
        let (name, title) = (&scene["name"], &scene["title"]);
        let (name, title) = (name.as_str().expect("text"), title.as_str().expect("text"));
        assert!(!name.contains('/'), "{name} is no stem");
        let line = list
            .lines()
            .find(|line| line.trim_start().starts_with(&format!("{name} ")))
            .unwrap_or_else(|| panic!("{name} is not listed"));
        let column = line.find(title).expect("its title");
        let indent = line.len() - line.trim_start().len();
        columns.insert(column - indent);
    }
    assert_eq!(columns.len(), 1, "titles stand in one column:\n{list}");
}

/// A run with a viewer of ours in the place of the system's.
#[cfg(all(unix, not(target_os = "macos")))]
fn with_viewer(folder: &Path, script: Option<&str>, args: &[&str]) -> Output {
    use std::os::unix::fs::PermissionsExt;
    let bin = folder.join("bin");
    std::fs::create_dir_all(&bin).expect("writable");
    if let Some(script) = script {
        let path = bin.join("xdg-open");
        std::fs::write(&path, format!("#!/bin/sh\n{script}\n")).expect("writable");
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).expect("allowed");
    }
    Command::new(env!("CARGO_BIN_EXE_rastray"))
        .current_dir(folder)
        .args(args)
        .env("NO_COLOR", "1")
        .env("PATH", &bin)
        .output()
        .expect("the program starts")
}

#[cfg(all(unix, not(target_os = "macos")))]
#[test]
fn open_shows_the_result_and_never_fails_the_run() {
    let folder = folder();
    let args = ["render", "whitted", "--size", "16x12", "--open", "-o"];
    let run = |script, output| with_viewer(folder.path(), script, &[&args[..], &[output]].concat());
    // None is installed.
    let without = run(None, "a.png");
    assert_eq!(without.status.code(), Some(0), "{}", text(&without.stderr));
    assert!(text(&without.stderr).contains("xdg-open is not installed"));
    assert!(text(&without.stderr).contains("a.png"));
    // One that finds nothing to show it with.
    let failing = run(Some("exit 3"), "b.png");
    assert_eq!(failing.status.code(), Some(0));
    assert!(text(&failing.stderr).contains("no viewer"));
    // One that works: it is given the whole path, even of a name that looks like a flag.
    let working = run(Some("echo \"$1\" > shown"), "./-c.png");
    assert_eq!(working.status.code(), Some(0), "{}", text(&working.stderr));
    let shown = std::fs::read_to_string(folder.path().join("shown")).expect("it ran");
    assert!(Path::new(shown.trim()).is_absolute() && shown.trim().ends_with("-c.png"));
    for picture in ["a.png", "b.png", "-c.png"] {
        assert!(folder.path().join(picture).is_file());
    }
}

#[test]
fn a_watch_draws_again_and_survives_a_broken_file() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    use std::sync::mpsc;
    use std::time::Duration;

    let folder = folder();
    let scene = "[object.ball]\nshape = \"sphere\"\n";
    let mine = folder.path().join("mine.toml");
    std::fs::write(&mine, scene).expect("writable");
    let mut child = Command::new(env!("CARGO_BIN_EXE_rastray"))
        .current_dir(folder.path())
        .args(["render", "mine.toml", "--size", "16x12", "--watch"])
        .env("NO_COLOR", "1")
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let stderr = BufReader::new(child.stderr.take().expect("piped"));
    let (sender, lines) = mpsc::channel();
    std::thread::spawn(move || {
        for line in stderr.lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                break;
            }
        }
    });
    // The lines up to one that begins the wait for a change.
    let until_watching = || {
        let mut said = String::new();
        while !said.contains("watching") {
            match lines.recv_timeout(Duration::from_secs(60)) {
                Ok(line) => said += &(line + "\n"),
                Err(_) => break,
            }
        }
        said
    };
    let picture = || std::fs::read(folder.path().join("mine.png")).expect("written");
    let first = until_watching();
    let plain = picture();
    std::fs::write(&mine, "[camera\n").expect("writable");
    let broken = until_watching();
    let kept = picture();
    let brighter = format!("{scene}[image]\nbackground = 0.5\n");
    std::fs::write(&mine, brighter).expect("writable");
    let mended = until_watching();
    let changed = picture();
    child.kill().expect("it still runs");
    child.wait().expect("it ends");
    assert!(first.contains("mine.png"), "{first}");
    assert!(broken.contains("mine.toml:1:"), "{broken}");
    assert!(kept == plain);
    assert!(mended.contains("mine.png"), "{mended}");
    assert!(changed != plain);
}

/// Width and height of a PNG, from its header.
fn png_size(path: &Path) -> (u32, u32) {
    let bytes = std::fs::read(path).expect("written");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    (number(16), number(20))
}

#[test]
fn a_lecture_leaves_what_it_promises() {
    let folder = folder();
    let mine = "# Is 100% of a_b & <c> here? Yes, K_D is.\n#\n# Look.\n#\n# term: diffuse, spot cutoff\n\n\
                [light.key]\nposition = [1, 2, 3]\n[object.ball]\nshape = \"sphere\"\n";
    std::fs::write(folder.path().join("my scene.toml"), mine).expect("writable");
    let args = [
        "lecture",
        "14-shadow",
        "my scene.toml",
        "--size",
        "96x54",
        "-o",
        "deck",
    ];
    ok(folder.path(), &args);
    let deck = folder.path().join("deck");
    let mut wanted = vec![
        "figures.md".into(),
        "figures.tex".into(),
        "index.html".into(),
    ];
    for scene in ["14-shadow", "my_scene"] {
        for kind in ["raster", "trace", "difference", "equation"] {
            let name = format!("{scene}-{kind}.png");
            assert_eq!(png_size(&deck.join(&name)), (96, 54), "{name}");
            wanted.push(name);
        }
    }
    wanted.sort();
    assert_eq!(names(&deck), wanted);
    let read = |name: &str| std::fs::read_to_string(deck.join(name)).expect("written");
    let (md, tex, page) = (read("figures.md"), read("figures.tex"), read("index.html"));
    for picture in wanted.iter().filter(|name| name.ends_with(".png")) {
        assert!(md.contains(&format!("]({picture})")), "{picture}");
        assert!(tex.contains(&format!("{{{picture}}}")), "{picture}");
    }
    assert!(tex.contains("Is 100\\% of a\\_b \\& \\textless{}c\\textgreater{} here?"));
    assert!(
        tex.contains("\\rastraylit{S_{L}}") && tex.contains("\\rastraylit{K_{D} (N \\cdot L)}")
    );
    assert!(page.contains("Is 100% of a_b &amp; &lt;c&gt; here?"));
    assert!(!page.contains("http") && page.matches("src=\"data:image/png").count() == 6);
}

#[test]
fn the_pictures_of_a_lecture_are_those_of_render() {
    let folder = folder();
    let size = ["--size", "64x36", "--samples", "4"];
    ok(
        folder.path(),
        &[&["lecture", "15-mirror"][..], &size].concat(),
    );
    for mode in ["raster", "trace"] {
        let render = ["render", "15-mirror", "--mode", mode, "-o", "a.png"];
        ok(folder.path(), &[&render[..], &size].concat());
        let read = |name: &str| std::fs::read(folder.path().join(name)).expect("written");
        assert!(read("a.png") == read(&format!("lecture/15-mirror-{mode}.png")));
    }
    // Again into the same folder: the same files, and nothing beside them.
    let before = names(&folder.path().join("lecture"));
    ok(
        folder.path(),
        &[&["lecture", "15-mirror"][..], &size].concat(),
    );
    assert_eq!(names(&folder.path().join("lecture")), before);
    assert_eq!(before.len(), 7);
}

#[test]
fn a_wrong_term_has_its_place_and_leaves_nothing() {
    let folder = folder();
    let scene = "# Why? So.\n# term: diffuse, glow\n[object.ball]\nshape = \"sphere\"\n";
    std::fs::write(folder.path().join("bad.toml"), scene).expect("writable");
    // The scene before it is not drawn either.
    let message = error(folder.path(), &["lecture", "01-point-light", "bad.toml"]);
    assert!(message.contains("bad.toml:2:18"), "{message}");
    assert!(
        message.contains("^^^^") && message.contains("shininess"),
        "{message}"
    );
}

#[test]
fn the_contact_sheet_holds_all_scenes() {
    let folder = folder();
    let quick = ["scenes", "--contact-sheet", "a.png", "--samples", "1"];
    ok(folder.path(), &quick);
    let (width, height) = png_size(&folder.path().join("a.png"));
    assert!(
        (1500..1700).contains(&width) && height > 1500,
        "{width} x {height}"
    );
    assert_eq!(names(folder.path()), ["a.png"]);
}

/// Names of files are bytes on Unix; the command line that a page shows is text.
#[cfg(unix)]
#[test]
fn a_name_that_is_no_unicode_does_not_stop_a_page() {
    use std::os::unix::ffi::OsStrExt;
    let folder = folder();
    let at = folder.path();
    let small = ["--size", "8x6", "-o", "a.png"];
    ok(at, &[&["render", "two-sided"], &small[..]].concat());
    for words in [
        &["diff", "a.png", "a.png"][..],
        &["compare", "two-sided", "--size", "8x6"],
    ] {
        let name = std::ffi::OsStr::from_bytes(b"out\xff");
        let output = Command::new(env!("CARGO_BIN_EXE_rastray"))
            .current_dir(at)
            .args(words)
            .arg("-o")
            .arg(name)
            .output()
            .expect("the program starts");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let page = std::fs::read_to_string(at.join(name).join("index.html")).expect("a page");
        assert!(page.contains("-o 'out\u{fffd}'"), "{words:?}");
    }
}
