//! The trade as a whole: slopes that theory predicts, measured through the library on scenes with closed forms; runs
//! that are interrupted and go on; the command.
//!
//! Slopes and figures: numerics guide, section 6, with its own measurements (`trade.json`). What one picture's order tests
//! show already (`tests/pictures/agreement.rs`: diffuse and specular orders and constants on meshes) is not repeated; here the
//! slopes are those that a page prints.

use std::time::Duration;

use crate::common::program::{rastray, text};

use rastray::gl::{self, LightSource, ShadeModel};
use rastray::lanes::Isa;
use rastray::math::{DAffine3, DVec3};
use rastray::render::Renderer;
use rastray::sampling::Pattern;
use rastray::scene::{
    Geometry, Light, LightSpace, Material, Object, Optics, Projection, Scene, Shape,
};
use rastray::trade::axis::{Axis, LEVELS, axes};
use rastray::trade::draw::{Ready, Shot};
use rastray::trade::finding::{AxisFinding, Curve, Point, finding};
use rastray::trade::fit::{Power, falling};
use rastray::trade::journal::Journal;
use rastray::trade::measure::{Judge, judge};
use rastray::trade::run::{Options, run};
use rastray::trade::setting::Setting;
use rastray::trade::truth::{LEAST_WEIGHT, Truth};

/// A scene of one shape in a square picture, seen along -z without perspective; `height` units are in view.
fn one(shape: Shape, material: gl::Material, optics: Optics, size: u32, height: f64) -> Scene {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (size, size);
    scene.camera.eye = DVec3::new(0.0, 0.0, 5.0);
    scene.camera.target = DVec3::ZERO;
    scene.camera.projection = Projection::Orthographic { height };
    scene.light_model.ambient = [0.0; 3];
    scene.light_model.local_viewer = false;
    scene.materials.push(Material {
        name: "it".into(),
        front: material,
        back: None,
        optics,
    });
    scene.objects.push(Object {
        name: "it".into(),
        geometry: Geometry::Shape(shape),
        materials: vec![0],
        world_from_object: DAffine3::IDENTITY,
        tessellation: None,
        priority: 0,
    });
    scene
}

fn ball() -> Shape {
    Shape::Sphere {
        center: DVec3::ZERO,
        radius: 1.0,
    }
}

/// The middle of a lit unit sphere, which fills the picture: |x|, |y| < 0.55.
fn lit(to_light: [f64; 3], specular: Option<f64>) -> Scene {
    let strength = |on: bool| [f64::from(u8::from(on)); 3];
    let material = gl::Material {
        ambient: [0.0; 3],
        diffuse: strength(specular.is_none()),
        specular: strength(specular.is_some()),
        shininess: specular.unwrap_or(0.0),
        ..gl::Material::default()
    };
    let mut scene = one(ball(), material, Optics::default(), 120, 1.1);
    let [x, y, z] = to_light;
    scene.lights.push(Light {
        name: "it".into(),
        source: LightSource {
            position: [x, y, z, 0.0],
            diffuse: [1.0; 3],
            specular: [1.0; 3],
            ..LightSource::default()
        },
        space: LightSpace::World,
        enabled: true,
    });
    scene
}

/// White on black, nothing to shade: only edges.
fn glowing(shape: Shape, optics: Optics, size: u32, height: f64) -> Scene {
    let material = gl::Material {
        emission: [1.0; 3],
        ambient: [0.0; 3],
        diffuse: [0.0; 3],
        ..gl::Material::default()
    };
    one(shape, material, optics, size, height)
}

/// An axis of a scene, measured.
fn measured(scene: &Scene, name: &str, ideal: u32) -> AxisFinding {
    let found = axes(scene, ideal)
        .into_iter()
        .find(|axis| axis.name == name);
    let axis: Axis = found.expect("an axis of the scene");
    let mut judge = Judge::new(scene, Isa::detect());
    let mut journal = Journal::in_memory();
    for (_, setting) in axis.series.iter().flat_map(|s| &s.settings) {
        let setting = setting.plain(scene);
        let measured = judge.measure(&setting, &[axis.truth]).expect("draws");
        journal.keep(measured).expect("in memory");
    }
    let pixels = f64::from(scene.image.width * scene.image.height);
    finding(scene, &axis, &journal, pixels)
}

fn curve<'a>(finding: &'a AxisFinding, name: &str) -> &'a Curve {
    let found = finding.curves.iter().find(|c| c.name == name);
    found.expect("a series of the axis")
}

/// The slope of some error over the finest three levels, positive where it falls.
fn slope(curve: &Curve, error: impl Fn(&Point) -> f64) -> f64 {
    let points: Vec<(f64, f64)> = curve.points.iter().map(|p| (p.knob, error(p))).collect();
    let fit = Power::through(&points[points.len() - 3..]).expect("errors");
    -fit.slope
}

fn near(what: &str, found: f64, expected: f64, within: f64) {
    println!("{what}: {found:.3}, expected {expected} +- {within}");
    assert!(
        (found - expected).abs() <= within,
        "{what}: {found}, not {expected}"
    );
}

#[test]
fn a_lit_sphere_has_the_slopes_of_the_guide() {
    let scene = lit([0.48, 0.36, 0.8], None);
    let found = measured(&scene, "shading and tessellation", 16);
    for (name, order, within) in [
        ("flat", 1.0, 0.15),
        ("gouraud", 2.0, 0.12),
        ("phong", 2.0, 0.15),
    ] {
        let curve = curve(&found, name);
        near(name, curve.slope.expect("falls"), order, within);
        near(
            &format!("{name} mean"),
            slope(curve, |p| p.error.mean),
            order,
            0.15,
        );
        assert_eq!(curve.as_predicted, Some(true), "{name}");
    }
    // What a digit costs is told, and more where the error falls slower.
    let price = |name| curve(&found, name).price.expect("falls");
    assert!(
        price("flat") > price("gouraud"),
        "{} {}",
        price("flat"),
        price("gouraud")
    );
}

#[test]
fn a_terminator_slows_the_root_mean_square() {
    let found = measured(
        &lit([0.97, 0.1, 0.22], None),
        "shading and tessellation",
        16,
    );
    let gouraud = curve(&found, "gouraud");
    let rmse = gouraud.slope.expect("falls");
    println!("rmse {rmse}");
    assert!((1.4..=2.0).contains(&rmse), "{rmse}");
    near("mean", slope(gouraud, |p| p.error.mean), 2.0, 0.15);
    near("max", slope(gouraud, |p| p.error.max), 1.0, 0.35);
}

#[test]
fn highlights_fall_as_squares_once_the_triangles_resolve_them() {
    for exponent in [32.0, 128.0] {
        let found = measured(
            &lit([0.48, 0.36, 0.8], Some(exponent)),
            "shading and tessellation",
            16,
        );
        for name in ["gouraud", "phong"] {
            near(
                &format!("{name} {exponent}"),
                curve(&found, name).slope.expect("falls"),
                2.0,
                0.15,
            );
        }
    }
    // Saturated while an edge is longer than 2/sqrt(n): 16 slices have edges of 0.4.
    let found = measured(
        &lit([0.48, 0.36, 0.8], Some(512.0)),
        "shading and tessellation",
        16,
    );
    let coarse = &curve(&found, "gouraud").points[1];
    assert_eq!(coarse.knob, 16.0);
    assert!(coarse.error.max > 0.9, "{}", coarse.error.max);
}

#[test]
fn silhouettes_lose_the_area_of_their_polygon() {
    let scene = glowing(ball(), Optics::default(), 128, 2.2);
    let area = |setting: Setting| -> f64 {
        let setting = Setting {
            samples: 64,
            pattern: Pattern::Grid,
            ..setting
        };
        let drawn = Ready::new(&scene, &setting, Isa::detect())
            .draw()
            .expect("draws");
        drawn.color.data.iter().map(|c| c[0]).sum()
    };
    let disk = area(Setting::by(Renderer::Cast, &scene));
    // 2 pi^2 / (3 N^2) of the disk; the guide measured 0.0255, 0.006413, 0.001606.
    for (slices, deficit) in [(16, 0.0255), (32, 0.006_413), (64, 0.001_606)] {
        let mesh = area(Setting::of(&scene).shaded(ShadeModel::Flat, slices));
        let found = 1.0 - mesh / disk;
        near(&format!("{slices} slices"), found / deficit, 1.0, 0.05);
    }
    // So one sample a pixel is wrong in a share of 1/N^2 of the pixels, and the root of that falls as 1/N.
    let found = measured(&scene, "shading and tessellation", 16);
    assert!(found.curves.iter().all(|c| c.points.len() == LEVELS.len()));
}

#[test]
fn samples_have_the_slopes_of_their_patterns() {
    // Off the grid of pixels, so that no edge falls on a rule.
    let shape = Shape::Sphere {
        center: DVec3::new(0.013, 0.021, 0.0),
        radius: 0.87,
    };
    let scene = glowing(shape, Optics::default(), 64, 2.0);
    let found = measured(&scene, "samples", 512);
    for name in ["grid", "jitter"] {
        near(name, curve(&found, name).slope.expect("falls"), 0.75, 0.1);
        assert_eq!(curve(&found, name).as_predicted, Some(true));
    }
    // Random places: the mean of pictures of one jittered sample, a seed each.
    let truth = Truth::Ideal(512)
        .draw(&scene, Isa::detect())
        .expect("draws");
    let setting = Setting {
        pattern: Pattern::Jitter,
        ..Setting::by(Renderer::Trace, &scene)
    };
    let mut sum: Option<Shot> = None;
    let mut errors = Vec::new();
    for seed in 1..=64 {
        let mut seeded = scene.clone();
        seeded.image.seed = seed;
        let drawn = Ready::new(&seeded, &setting, Isa::detect())
            .draw()
            .expect("draws");
        let total = match sum.take() {
            None => drawn,
            Some(mut total) => {
                for (t, d) in total.color.data.iter_mut().zip(&drawn.color.data) {
                    *t = [0, 1, 2].map(|c| t[c] + d[c]);
                }
                total
            }
        };
        if [1, 4, 16, 64].contains(&seed) {
            let mut mean = total.clone();
            mean.color = mean.color.map(|c| c.map(|x| x / f64::from(seed)));
            let accuracy = judge(&mean, &truth).expect("one size");
            errors.push((f64::from(seed), accuracy.silhouette.rmse));
        }
        sum = Some(total);
    }
    let fit = Power::through(falling(&errors, 4)).expect("falls");
    near("random", -fit.slope, 0.5, 0.06);
}

/// Inside a box of mirrors that glow with 1 and pass on k, a picture of depth D is the sum of k^i up to D: what is missing
/// is k^(D+1) / (1 - k).
#[test]
fn recursion_leaves_the_rest_of_the_geometric_series() {
    for k in [0.25f64, 0.5, 0.9] {
        let room = Shape::Box {
            min: DVec3::new(-3.0, -4.0, -7.0),
            max: DVec3::new(5.0, 6.0, 8.0),
        };
        let optics = Optics {
            reflection: [k; 3],
            ..Optics::default()
        };
        let mut scene = glowing(room, optics, 12, 2.0);
        scene.camera.projection = Projection::Perspective { fovy_deg: 70.0 };
        let found = measured(&scene, "recursion depth", 16);
        let trace = curve(&found, "trace");
        let drawn = Truth::Full.draw(&scene, Isa::detect()).expect("draws");
        let end = Truth::Full
            .end(&scene, &drawn, Isa::detect())
            .expect("draws");
        let left = Some(k.powi(129)).filter(|left| *left >= LEAST_WEIGHT);
        assert_eq!(end.depth, 128);
        assert_eq!(end.weight_left.is_some(), left.is_some(), "{k}: {end:?}");
        if let (Some(found), Some(left)) = (end.weight_left, left) {
            near("weight left", found / left, 1.0, 1e-9);
        }
        for point in &trace.points {
            let rest = k.powf(point.knob + 1.0) / (1.0 - k);
            // The truth stops at weights of 1e-7, or at generation 128, and says so.
            let left = (1e-7f64).max(k.powi(129)) / (1.0 - k);
            let off = (point.error.rmse - rest).abs();
            assert!(
                off <= left + 1e-5 * rest,
                "{k}, depth {}: {}",
                point.knob,
                point.error.rmse
            );
        }
        // What the truth leaves out is up to 2 % of the least error, at k = 0.25.
        near(
            &format!("mirror {k}"),
            trace.slope.expect("falls"),
            k,
            3e-3 * k,
        );
        assert_eq!(trace.as_predicted, Some(true));
    }
}

/// A scene that is quick to measure whole.
fn quick() -> Scene {
    let mut scene = rastray::import::load("15-mirror", &Default::default())
        .expect("shipped")
        .scene;
    (scene.image.width, scene.image.height) = (24, 18);
    scene
}

#[test]
fn an_interrupted_run_goes_on_to_the_same_end() {
    let scene = quick();
    let options = |seconds: f64| Options {
        isa: Isa::detect(),
        budget: Duration::from_secs_f64(seconds),
        ideal_samples: 8,
        times: false,
    };
    let mut whole = Journal::in_memory();
    let outcome = run(&scene, &options(600.0), &mut whole, &|_, _, _| {}).expect("runs");
    assert_eq!(outcome.measured, outcome.tasks.len());
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("journal.jsonl");
    // A budget of a nanosecond measures one setting a run.
    for n in 1..4 {
        let mut journal = Journal::open(&path, &scene, Isa::detect()).expect("opens");
        let outcome = run(&scene, &options(1e-9), &mut journal, &|_, _, _| {}).expect("runs");
        assert!(
            outcome.measured >= 1 && journal.measured.len() <= n,
            "run {n}"
        );
    }
    let mut journal = Journal::open(&path, &scene, Isa::detect()).expect("opens");
    run(&scene, &options(600.0), &mut journal, &|_, _, _| {}).expect("runs");
    assert_eq!(journal.measured, whole.measured);
}

const SMALL: [&str; 8] = [
    "trade",
    "15-mirror",
    "--size",
    "24x18",
    "--ideal-samples",
    "8",
    "--budget",
    "600",
];

#[test]
fn the_command_leaves_a_folder_whose_answers_can_be_typed() {
    let folder = tempfile::tempdir().expect("a folder");
    let args = [&SMALL[..], &["--no-times", "--json"]].concat();
    let output = rastray(folder.path(), &args);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let out = folder.path().join("15-mirror-trade");
    for file in [
        "index.html",
        "trade.csv",
        "trade.json",
        "plot.svg",
        "plot.png",
        "journal.jsonl",
    ] {
        assert!(out.join(file).is_file(), "{file}");
    }
    let trade: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(trade["settings"], trade["measured"]);
    // One mirror: no ray is left.
    assert_eq!(trade["truth"]["depth"], 128);
    assert!(trade["truth"]["weight_left"].is_null());
    let rows = trade["rows"].as_array().expect("rows");
    let csv = std::fs::read_to_string(out.join("trade.csv")).expect("written");
    assert_eq!(csv.lines().count(), rows.len() + 1);
    // Each answer's flags draw a picture whose counters are those of the row.
    for answer in trade["answers"].as_array().expect("answers") {
        let row = &rows[answer["row"].as_u64().expect("in reach") as usize];
        let flags = row["arguments"].as_str().expect("flags");
        let words: Vec<&str> = flags.split_whitespace().collect();
        let line = [
            &["render", "15-mirror", "--size", "24x18", "-q", "--json"][..],
            &words,
        ]
        .concat();
        let drawn = rastray(folder.path(), &line);
        let stats: serde_json::Value = serde_json::from_slice(&drawn.stdout).expect("JSON");
        assert_eq!(
            stats["counters"]["rays"]["reflection"],
            row["counts"]["reflection"]
        );
        assert_eq!(
            stats["counters"]["primitive_tests"],
            row["counts"]["primitive_tests"]
        );
    }
    // Another size is another trade, and it is said.
    let args = [
        &SMALL[..2],
        &["--size", "20x15"],
        &SMALL[4..],
        &["--no-times"],
    ]
    .concat();
    let again = rastray(folder.path(), &args);
    assert!(
        text(&again.stderr).contains("starts again"),
        "{}",
        text(&again.stderr)
    );
}

#[test]
fn what_is_not_measured_yet_is_not_out_of_reach() {
    let folder = tempfile::tempdir().expect("a folder");
    let args = [&SMALL[..6], &["--budget", "1e-9", "--no-times"]].concat();
    let output = rastray(folder.path(), &args);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    assert!(said.starts_with("1 of "), "{said}");
    assert!(
        said.contains("error below 1/255, judged at 24 x 18"),
        "{said}"
    );
    assert!(said.contains("Not reached by the 1 of "), "{said}");
    assert!(!said.contains("Out of reach"), "{said}");
    assert!(
        said.contains("`rastray render 15-mirror --error 1/255` judges"),
        "{said}"
    );
}

#[test]
fn extremes_say_their_result_and_print_their_json() {
    let folder = tempfile::tempdir().expect("a folder");
    let line = ["trade", "--extremes", "--size", "8x6"];
    let plain = rastray(folder.path(), &line);
    assert_eq!(plain.status.code(), Some(0), "{}", text(&plain.stderr));
    assert!(
        text(&plain.stdout).contains("figures agree within the bar"),
        "{}",
        text(&plain.stdout)
    );
    let json = rastray(folder.path(), &[&line[..], &["--json"]].concat());
    let file = std::fs::read(folder.path().join("extremes/extremes.json")).expect("written");
    assert_eq!(json.stdout, file);
    assert!(folder.path().join("extremes/extremes.csv").is_file());
}

#[test]
fn times_are_kept_with_their_rounds() {
    let folder = tempfile::tempdir().expect("a folder");
    let known = rastray(folder.path(), &[&SMALL[..], &["--no-times", "-q"]].concat());
    assert_eq!(known.status.code(), Some(0), "{}", text(&known.stderr));
    // All of the budget goes to times; a slow machine needs more of it for the first.
    let timed = ["2", "8", "32", "128"].iter().find_map(|budget| {
        let args = [&SMALL[..6], &["--budget", budget, "--json"]].concat();
        let output = rastray(folder.path(), &args);
        let trade: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let rows = trade["rows"].as_array().expect("rows");
        let times = rows
            .iter()
            .map(|r| r["time"].clone())
            .filter(|t| !t.is_null());
        let times: Vec<serde_json::Value> = times.collect();
        (!times.is_empty()).then_some(times)
    });
    for time in timed.expect("times") {
        assert!(time["rounds"].as_u64().expect("a count") >= 6);
        // A number, or why there is none; never both.
        assert_ne!(
            time["ns_per_pixel"].is_null(),
            time["inconclusive"].is_null(),
            "{time}"
        );
    }
}

#[test]
fn render_picks_a_setting_and_says_what_is_out_of_reach() {
    let folder = tempfile::tempdir().expect("a folder");
    let render = |more: &[&str]| {
        let args = [
            &["render", "15-mirror", "--size", "32x24", "-o", "a.pfm"][..],
            more,
        ]
        .concat();
        rastray(folder.path(), &args)
    };
    let picked = render(&["--error", "1/255"]);
    assert_eq!(picked.status.code(), Some(0), "{}", text(&picked.stderr));
    assert!(
        text(&picked.stderr).contains("picked of"),
        "{}",
        text(&picked.stderr)
    );
    let bytes = std::fs::read(folder.path().join("a.pfm")).expect("written");
    assert_eq!(
        render(&["--error", "1/255"]).stderr,
        picked.stderr,
        "deterministic"
    );
    assert_eq!(
        std::fs::read(folder.path().join("a.pfm")).expect("written"),
        bytes
    );
    for (wrong, says) in [
        (["--error", "0"], "expected a number above 0"),
        (["--time", "0"], "expected milliseconds"),
        (["--time", "0.000001"], "out of reach"),
    ] {
        let output = render(&wrong);
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
        assert!(
            text(&output.stderr).contains(says),
            "{}",
            text(&output.stderr)
        );
    }
    let both = render(&["--error", "0.1", "--mode", "trace"]);
    assert_eq!(both.status.code(), Some(2));
}

#[test]
fn wrong_flags_leave_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    for (args, says) in [
        (&["trade"][..], "none is named"),
        (&["trade", "whitted", "--budget", "0"], "--budget"),
        (&["trade", "whitted", "--budget", "-1"], "expected seconds"),
        (&["trade", "whitted", "--extremes"], "leave out whitted"),
        (&["trade", "--extremes", "--verify"], "--verify"),
        (
            &["trade", "whitted", "--ideal-samples", "1"],
            "--ideal-samples",
        ),
        (&["trade", "whited"], "did you mean `whitted`?"),
    ] {
        let output = rastray(folder.path(), args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(
            text(&output.stderr).contains(says),
            "{}",
            text(&output.stderr)
        );
    }
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("readable").count(),
        0
    );
}
