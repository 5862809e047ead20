//! The rasterizer against independent truth: extreme cases for numerical stability (kinds raster, near, persp, depth) and
//! scenes drawn by real OpenGL (`tests/reference/README.md`). Goes through the conformance adapter's own code.

use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::common::precise::Precise;
use crate::probe::{gl_scene, numerics};
use rastray::gl::ShadeModel;
use rastray::lanes::Real;
use rastray::render::Precision;
use rastray::scene::{Projection, Snap};
use serde_json::Value;

fn unpack(path: &Path) -> Vec<u8> {
    let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut unpacked = Vec::new();
    flate2::read::GzDecoder::new(&bytes[..])
        .read_to_end(&mut unpacked)
        .expect("reference data unpacks");
    unpacked
}

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

// ---- numerical stability ------------------------------------------------------------------------------------------

/// The evaluations of one kind: group, input, expected answer, bars of the group.
fn cases(kind: &str) -> Vec<(String, Value, Value, Value)> {
    let text = unpack(&repository().join("tests/reference/numerics-raster.json.gz"));
    let data: Value = serde_json::from_slice(&text).expect("JSON");
    let mut found = Vec::new();
    for case in data["cases"].as_array().expect("a list") {
        if case["kind"] == kind {
            let id = case["id"].as_str().expect("an id");
            let inputs = case["evals"].as_array().expect("a list");
            let answers = data["expect"][id].as_array().expect("a list");
            for (input, answer) in inputs.iter().zip(answers) {
                let bars = data["bars"][id].clone();
                found.push((id.to_owned(), input.clone(), answer.clone(), bars));
            }
        }
    }
    assert!(!found.is_empty(), "no case of kind {kind}");
    found
}

/// The pixels (x, y) of a list of runs.
fn pixels(runs: &Value) -> BTreeSet<(i64, i64)> {
    let runs = runs.as_array().expect("a list").iter();
    runs.flat_map(|run| {
        let at = |i: usize| run[i].as_i64().expect("an integer");
        (at(1)..=at(2)).map(move |x| (x, at(0)))
    })
    .collect()
}

#[test]
fn coverage_is_the_rational_answer() {
    for (snap, key) in [
        (Snap::Bits8, "8"),
        (Snap::Bits12, "12"),
        (Snap::Exact, "exact"),
    ] {
        for (id, input, expected, _) in cases("raster") {
            let answer = numerics::raster(input.clone(), snap).expect("an answer");
            let found = answer["tris"].as_array().expect("a list");
            for (i, found) in found.iter().enumerate() {
                // Null: the same as with 8 bits.
                let stated = [&expected[key][i], &expected["8"][i]];
                let stated = stated.into_iter().find(|x| !x.is_null()).expect("one");
                let (found, stated) = (pixels(found), pixels(stated));
                let wrong = found.symmetric_difference(&stated).count();
                assert_eq!(wrong, 0, "{id}, {key}: {}", input["tris"][i]);
            }
        }
    }
}

#[test]
fn near_clipped_coverage_differs_at_outlines_only() {
    for snap in [Snap::Bits8, Snap::Bits12, Snap::Exact] {
        for (_, input, expected, _) in cases("near") {
            let answer = numerics::near(input.clone(), snap).expect("an answer");
            let may = expected["may"].as_array().expect("a list").iter();
            let at = |p: &Value, i: usize| p[i].as_i64().expect("an integer");
            let may: BTreeSet<_> = may.map(|p| (at(p, 0), at(p, 1))).collect();
            let (found, stated) = (pixels(&answer["runs"]), pixels(&expected["runs"]));
            let mut wrong = found.symmetric_difference(&stated);
            assert!(wrong.all(|p| may.contains(p)), "{input}, {snap:?}");
        }
    }
}

fn interpolation<R: Real>() {
    for (id, input, expected, bars) in cases("persp") {
        let attribute = input["attr"].as_array().expect("a list").iter();
        let scale = attribute.fold(0.0f64, |m, x| m.max(x.as_f64().expect("a number").abs()));
        let answer = numerics::persp::<R>(input.clone()).expect("an answer");
        let found = answer["v"].as_array().expect("a list");
        let stated = expected["v"].as_array().expect("a list");
        assert_eq!(found.len(), stated.len());
        let bar = |key: &str| bars[R::NAME][key].as_f64().expect("a bar");
        for (found, stated) in found.iter().zip(stated) {
            let [value, w] = [0, 1].map(|i| found[i].as_f64().expect("not edge-on"));
            let [exact, exact_w] = [0, 1].map(|i| stated[i].as_f64().expect("a number"));
            let error = (value - exact).abs() / scale;
            assert!(error <= bar("err_attr"), "{id}: {error:e}");
            let error = (w - exact_w).abs() / exact_w.abs();
            assert!(error <= bar("err_w"), "{id}: {error:e}");
        }
    }
}

#[test]
fn interpolation_stays_within_the_bars() {
    interpolation::<f32>();
    interpolation::<f64>();
}

#[test]
fn depth_order_is_right() {
    for (id, input, expected, _) in cases("depth") {
        let answer = numerics::depth(input.clone()).expect("an answer");
        assert_eq!(answer["closer"], expected["closer"], "{id}: {input}");
    }
}

// ---- real OpenGL --------------------------------------------------------------------------------------------------

fn floats(bytes: &[u8]) -> Vec<f32> {
    let words = bytes.chunks_exact(4);
    words
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect()
}

fn integers(bytes: &[u8]) -> Vec<i32> {
    let words = bytes.chunks_exact(4);
    words
        .map(|b| i32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect()
}

/// How a picture differs from a driver's.
#[derive(Debug, Default)]
struct Difference {
    covered: usize,
    coverage: usize,
    counts: usize,
    same_triangle: usize,
    color_max: f64,
    color_sum: f64,
    depth_max: f64,
    background: f64,
}

impl Difference {
    fn of(ours: &gl_scene::Buffers, stem: &Path) -> Self {
        let file = |suffix: &str| {
            let name = stem.file_name().and_then(|n| n.to_str()).expect("a name");
            unpack(&stem.with_file_name(format!("{name}.{suffix}.gz")))
        };
        let (rgba, depth) = (floats(&file("rgba.f32")), floats(&file("depth.f32")));
        let (prim, count) = (integers(&file("prim.i32")), file("count.u8"));
        assert_eq!(prim.len(), ours.prim.len());
        let mut found = Self::default();
        for i in 0..prim.len() {
            let theirs = &rgba[4 * i..4 * i + 4];
            let color = ours.rgba[i].iter().zip(theirs);
            let color: Vec<f64> = color.map(|(a, b)| f64::from((a - b).abs())).collect();
            let largest = color.iter().fold(0.0f64, |m, x| m.max(*x));
            let depth = f64::from((ours.depth[i] - depth[i]).abs());
            found.covered += usize::from(prim[i] >= 0);
            found.counts += usize::from(ours.count[i] != count[i]);
            if (prim[i] >= 0) != (ours.prim[i] >= 0) {
                found.coverage += 1;
            } else if prim[i] < 0 {
                found.background = found.background.max(largest).max(depth);
            } else if prim[i] == ours.prim[i] {
                found.same_triangle += 1;
                found.color_max = found.color_max.max(largest);
                found.color_sum += (color[0] + color[1] + color[2]) / 3.0;
                found.depth_max = found.depth_max.max(depth);
            }
        }
        found
    }

    fn check(&self, scene: &str, what: &str) {
        println!("{what}: {self:?}");
        let thin = scene == "slivers";
        let pixels = if thin || scene == "fill_rule" {
            (self.covered * 3).div_ceil(1000)
        } else {
            2
        };
        assert!(self.covered > 1000, "{what}");
        assert!(self.coverage <= pixels, "{what}: {self:?}");
        assert!(self.counts <= pixels.max(2), "{what}: {self:?}");
        let bar = if thin { 1e-3 } else { 5e-5 };
        assert!(self.color_max <= bar, "{what}: {self:?}");
        let mean = self.color_sum / self.same_triangle as f64;
        assert!(mean <= 2e-6, "{what}: mean {mean:e}");
        assert!(self.depth_max <= 5e-6, "{what}: {self:?}");
        assert_eq!(self.background, 0.0, "{what}");
    }
}

/// Every scene of a folder against every driver whose pictures are there; returns how many pictures.
fn compare_folder<R: Precise>(folder: &Path) -> usize {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    entries.sort();
    let mut compared = 0;
    for path in &entries {
        let name = path.file_name().and_then(|n| n.to_str()).expect("a name");
        let Some(scene) = name.strip_suffix(".json.gz") else {
            continue;
        };
        let text = String::from_utf8(unpack(path)).expect("text");
        for mode in ["flat", "smooth", "phong"] {
            for driver in ["llvmpipe", "softpipe"] {
                let stem = folder.join(format!("{scene}.{mode}.{driver}"));
                let first = folder.join(format!("{scene}.{mode}.{driver}.prim.i32.gz"));
                if !first.exists() {
                    continue;
                }
                let shading = gl_scene::shading(mode).expect("a mode");
                let ours = gl_scene::draw(&text, folder, shading, R::PRECISION, Snap::Bits8)
                    .unwrap_or_else(|e| panic!("{name}: {e}"));
                let what = format!("{scene}.{mode} {driver} {}", R::NAME);
                Difference::of(&ours, &stem).check(scene, &what);
                compared += 1;
            }
        }
    }
    compared
}

#[test]
fn scenes_look_as_opengl_draws_them() {
    let folder = repository().join("tests/reference/gl-scenes");
    assert_eq!(compare_folder::<f32>(&folder), 11);
    assert_eq!(compare_folder::<f64>(&folder), 11);
}

#[test]
fn all_scenes_look_as_both_drivers_draw_them() {
    let folder = repository().join("../shared/gl/scenes");
    if !folder.is_dir() {
        println!("skipped: {} is absent", folder.display());
        return;
    }
    assert_eq!(compare_folder::<f32>(&folder), 44);
}

/// A mesh with everything that a modelview may be, drawn through gluPerspective's matrix and through the camera that the
/// matrix is of.
#[test]
fn a_matrix_projection_is_the_cameras() {
    let folder = repository().join("tests/reference/gl-scenes");
    let text = unpack(&folder.join("two_sided.json.gz"));
    let mut json: Value = serde_json::from_slice(&text).expect("JSON");
    json["modelview"][0] = (-1.3).into();
    json["meshes"][0]["modelview"][5] = 0.4.into();
    let of = |key: &str| json["projection"][key].as_f64().expect("a number");
    let (fovy_deg, near, far) = (of("fovy"), of("near"), of("far"));
    let case: gl_scene::Case = serde_json::from_value(json).expect("a scene");
    let mut scene = case.record(&folder).expect("recorded");
    let shading = gl_scene::shading("phong").expect("a mode");
    let matrix = case
        .buffers(&scene, shading, Precision::F64)
        .expect("drawn");
    assert!(matches!(scene.camera.projection, Projection::Matrix { .. }));
    scene.camera.projection = Projection::Perspective { fovy_deg };
    (scene.camera.near, scene.camera.far) = (near, Some(far));
    let camera = case
        .buffers(&scene, shading, Precision::F64)
        .expect("drawn");
    assert!(camera.prim.iter().filter(|p| **p >= 0).count() > 1000);
    assert_eq!(camera.prim, matrix.prim);
    for (a, b) in camera.rgba.iter().zip(&matrix.rgba) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6));
    }
    for (a, b) in camera.depth.iter().zip(&matrix.depth) {
        assert!((a - b).abs() < 1e-6);
    }
}

/// What GL refuses is said, and where.
#[test]
fn values_that_gl_refuses_name_their_mesh() {
    let text = r#"{"width": 4, "height": 4, "meshes": [{}, {"material": {"shininess": 300}}]}"#;
    let single = Precision::F32;
    let drawn = gl_scene::draw(text, repository(), ShadeModel::Flat, single, Snap::Bits8);
    let error = drawn.err().expect("shininess is 128 at most").to_string();
    assert!(
        error.contains("mesh 1") && error.contains("InvalidValue"),
        "{error}"
    );
}

#[test]
fn without_a_depth_test_the_last_triangle_shows() {
    let folder = repository().join("tests/reference/gl-scenes");
    let text = unpack(&folder.join("depth_planes.json.gz"));
    let mut scene: Value = serde_json::from_slice(&text).expect("JSON");
    scene["depth_test"] = false.into();
    let shading = gl_scene::shading("flat").expect("a mode");
    let draw = |scene: &Value| {
        let (text, single) = (scene.to_string(), Precision::F32);
        gl_scene::draw(&text, &folder, shading, single, Snap::Bits8).expect("drawn")
    };
    let all = draw(&scene);
    assert!(all.depth.iter().all(|z| *z == 1.0), "no depth is written");
    // The same with the last mesh alone: where it covers, it is what shows.
    let meshes = scene["meshes"].as_array().expect("a list").clone();
    let before: usize = meshes[..meshes.len() - 1]
        .iter()
        .map(|m| m["indices"].as_array().expect("a list").len() / 3)
        .sum();
    scene["meshes"] = Value::Array(meshes[meshes.len() - 1..].to_vec());
    let last = draw(&scene);
    let mut covered = 0;
    for (all, last) in all.prim.iter().zip(&last.prim) {
        if *last >= 0 {
            assert_eq!(*all, last + before as i32);
            covered += 1;
        }
    }
    assert!(covered > 100, "{covered}");
    assert!(all.count.iter().any(|n| *n > 1));
}
