//! The equation against independent truth, at every instruction set of this machine: OpenGL cases and extreme cases
//! for numerical stability (`tests/reference/README.md`). Goes through the conformance adapter's own code.

use std::io::Read;

use crate::probe::{gl_lights, numerics};
use rastray::gl::{LightSource, SpecularModel};
use rastray::lanes::{Isa, Real};
use rastray::lighting::plain::lit;
use rastray::lighting::{Illumination, Visibility};
use rastray::math::DVec3;
use serde_json::Value;

fn as_f64(value: &Value) -> f64 {
    match value {
        Value::String(word) => word.parse().expect("nan, inf or -inf"),
        other => other.as_f64().expect("a number"),
    }
}

fn reference(name: &str) -> String {
    let path = format!("{}/tests/reference/{name}", env!("CARGO_MANIFEST_DIR"));
    let bytes = std::fs::read(&path).expect("reference data");
    let mut text = String::new();
    flate2::read::GzDecoder::new(&bytes[..])
        .read_to_string(&mut text)
        .expect("reference data unpacks");
    text
}

/// Largest error over max(1, magnitude), and of the clamped colour, over the cases of a class.
#[derive(Default, Debug)]
struct Worst {
    cases: usize,
    relative: f64,
    clamped: f64,
    nan: usize,
}

fn gl_cases<R: Real>(isa: Isa, text: &str, class: &str) -> Worst {
    let mut worst = Worst::default();
    for line in text.lines() {
        let case: Value = serde_json::from_str(line).expect("a case");
        if case["class"] != class {
            continue;
        }
        worst.cases += 1;
        let answer = gl_lights::answer_at::<R>(isa, line).expect("an answer");
        let scale = case["magnitude"].as_f64().unwrap_or(1.0).max(1.0);
        for (key, components) in [
            ("primary", 4),
            ("secondary", 3),
            ("final", 4),
            ("final_clamped", 4),
        ] {
            for c in 0..components {
                let found = as_f64(&answer[key][c]);
                let exact = as_f64(&case["spec"][key][c]);
                worst.nan += usize::from(found.is_nan());
                let error = if found == exact {
                    0.0
                } else {
                    (found - exact).abs()
                };
                if key == "final_clamped" {
                    worst.clamped = worst.clamped.max(error);
                } else {
                    worst.relative = worst.relative.max(error / scale);
                }
            }
        }
    }
    println!("{} {} {class}: {worst:?}", R::NAME, isa.name());
    worst
}

fn gl_plain<R: Real>(bar: f64) {
    let text = reference("gl-lights.jsonl.gz");
    for isa in Isa::available() {
        let worst = gl_cases::<R>(isa, &text, "plain");
        assert_eq!(worst.cases, 2094);
        assert!(worst.relative <= bar, "{}: {}", isa.name(), worst.relative);
        assert!(worst.clamped <= 3e-5, "{}: {}", isa.name(), worst.clamped);
        assert_eq!(worst.nan, 0);
    }
}

#[test]
fn gl_plain_cases_f32() {
    gl_plain::<f32>(2e-5);
}

/// The bar asked for is 1e-6; what is reached is 2e-14, and the test keeps it.
#[test]
fn gl_plain_cases_f64() {
    gl_plain::<f64>(1e-13);
}

/// Where Mesa differs from the specification, the specification holds; long normals and the ends of f32 need f64.
#[test]
fn gl_other_defined_cases() {
    let text = reference("gl-lights.jsonl.gz");
    let isa = Isa::detect();
    for class in ["mesa_differs", "f32_range", "long_normal"] {
        let worst = gl_cases::<f64>(isa, &text, class);
        assert!(
            worst.cases > 0 && worst.relative <= 1e-12 && worst.nan == 0,
            "{class}"
        );
        let worst = gl_cases::<f32>(isa, &text, class);
        // A long normal's power may leave f32: then it is infinite, and 1 after the clamp.
        assert!(worst.clamped <= 3e-5 && worst.nan == 0, "{class}");
        assert!(class == "long_normal" || worst.relative <= 2e-5, "{class}");
    }
}

/// Undefined and edge cases: no NaN in any component, in either precision.
#[test]
fn gl_undefined_cases_have_values() {
    let text = reference("gl-lights.jsonl.gz");
    for class in ["undefined", "edge"] {
        for isa in Isa::available() {
            assert_eq!(gl_cases::<f32>(isa, &text, class).nan, 0);
            assert_eq!(gl_cases::<f64>(isa, &text, class).nan, 0);
        }
    }
}

/// S_L that differs from light to light, and by colour: 1, then coloured, then 0, and again.
struct Shadows;

impl Shadows {
    const S_L: [[f64; 3]; 3] = [[1.0; 3], [0.25, 0.5, 0.75], [0.0; 3]];

    fn of(light: usize) -> [f64; 3] {
        Self::S_L[light % Self::S_L.len()]
    }
}

impl Visibility<f64> for Shadows {
    fn query(&mut self, light: usize, _: &Illumination<f64>, out: &mut [Vec<f64>; 3]) {
        for (list, s) in out.iter_mut().zip(Self::of(light)) {
            list.fill(s);
        }
    }
}

/// What the equation needs for a line of the OpenGL cases.
fn prepared(line: &str) -> gl_lights::Prepared<f64> {
    let case: gl_lights::Case = serde_json::from_str(line).expect("a case");
    gl_lights::prepare(Isa::detect(), &case).expect("a case")
}

/// Primary and secondary colour by the plain equation.
fn plain_answer(
    given: &gl_lights::Prepared<f64>,
    lights: &[(&LightSource, [f64; 3])],
) -> [[f64; 3]; 2] {
    let at = |list: &[Vec<f64>; 3]| DVec3::new(list[0][0], list[1][0], list[2][0]);
    let length = given.points.normal_length.first().copied().unwrap_or(1.0);
    let (v, n) = (
        at(&given.points.position),
        at(&given.points.normal) * length,
    );
    lit(v, n, &given.material, &given.model, lights)
}

/// Largest difference between the plain equation and the lanes over the plain cases, relative to the sum of the absolute
/// values of the terms: in one specular model, lit or with S_L.
fn plain_against_lanes(text: &str, specular_model: SpecularModel, shadowed: bool) -> f64 {
    let (mut worst, mut cases) = (0.0f64, 0);
    for line in text.lines() {
        let case: Value = serde_json::from_str(line).expect("a case");
        if case["class"] != "plain" {
            continue;
        }
        cases += 1;
        let mut given = prepared(line);
        given.model.specular_model = specular_model;
        let numbered = given.lights.iter().enumerate();
        let lights: Vec<_> = numbered
            .map(|(i, light)| (light, if shadowed { Shadows::of(i) } else { [1.0; 3] }))
            .collect();
        let plain = plain_answer(&given, &lights);
        let mut shadows = Shadows;
        let hook: Option<&mut dyn Visibility<f64>> =
            if shadowed { Some(&mut shadows) } else { None };
        let (first, second) = given.split(hook);
        let scale = case["magnitude"].as_f64().expect("a number");
        for (a, b) in plain.iter().flatten().zip(first.iter().chain(&second)) {
            let error = (a - b).abs();
            assert!(error.is_finite(), "{line}");
            worst = worst.max(if error == 0.0 { 0.0 } else { error / scale });
        }
    }
    assert_eq!(cases, 2094);
    worst
}

/// `lighting/plain.rs`, the equation to be read, is the equation that is computed.
#[test]
fn plain_equation_is_that_of_the_lanes() {
    let text = reference("gl-lights.jsonl.gz");
    for specular_model in [SpecularModel::HalfVector, SpecularModel::Reflection] {
        for shadowed in [false, true] {
            let worst = plain_against_lanes(&text, specular_model, shadowed);
            println!("{specular_model:?} shadowed {shadowed}: {worst:e}");
            assert!(worst < 2e-14, "{specular_model:?} {shadowed}: {worst:e}");
        }
    }
}

/// The plain equation against the reference's own evaluation, also where Mesa differs from the specification.
#[test]
fn plain_equation_is_that_of_the_specification() {
    let text = reference("gl-lights.jsonl.gz");
    for class in ["plain", "mesa_differs", "f32_range"] {
        let mut worst = 0.0f64;
        for line in text.lines() {
            let case: Value = serde_json::from_str(line).expect("a case");
            if case["class"] != class {
                continue;
            }
            let given = prepared(line);
            let lights: Vec<_> = given.lights.iter().map(|light| (light, [1.0; 3])).collect();
            let [primary, secondary] = plain_answer(&given, &lights);
            let scale = case["magnitude"].as_f64().expect("a number");
            for c in 0..3 {
                for (key, found) in [("primary", primary), ("secondary", secondary)] {
                    let error = (found[c] - as_f64(&case["spec"][key][c])).abs();
                    assert!(error.is_finite(), "{line}");
                    worst = worst.max(if error == 0.0 { 0.0 } else { error / scale });
                }
            }
        }
        println!("{class}: {worst:e}");
        assert!(worst < 1e-13, "{class}: {worst:e}");
    }
}

/// The error measure of the numerics set: relative to max(|exact|, 1e-6); clamped groups after the clamp.
fn error(found: [f64; 3], exact: &Value, clamped: bool) -> f64 {
    let exact = if clamped {
        &exact["clamped"]
    } else {
        &exact["rgb"]
    };
    let mut worst = 0.0f64;
    for (c, x) in found.into_iter().enumerate() {
        let y = exact[c].as_f64().expect("an exact value");
        assert!(!x.is_nan());
        worst = worst.max(if clamped {
            (x.clamp(0.0, 1.0) - y).abs()
        } else {
            (x - y).abs() / y.abs().max(1e-6)
        });
    }
    worst
}

fn numerics_groups<R: Real>(margin: f64) {
    let data: Value = serde_json::from_str(&reference("numerics-light.json.gz")).expect("JSON");
    let groups = data["cases"].as_array().expect("a list");
    assert_eq!(groups.len(), 11);
    for isa in Isa::available() {
        for group in groups {
            let id = group["id"].as_str().expect("a name");
            let clamped = group["clamp"].as_bool().expect("a flag");
            let bar = data["bars"][id][R::NAME].as_f64().expect("a bar");
            let mut worst = 0.0f64;
            for (i, case) in group["evals"]
                .as_array()
                .expect("a list")
                .iter()
                .enumerate()
            {
                let exact = &data["expect"][id][i];
                let spot = exact["spot_margin"].as_f64().unwrap_or(0.0);
                if spot != 0.0 && spot.abs() < margin {
                    continue;
                }
                let found = numerics::light::<R>(isa, case.clone()).expect("an answer");
                worst = worst.max(error(found, exact, clamped));
            }
            println!(
                "{} {} {id}: {worst:.2e} (bar {bar:.0e})",
                R::NAME,
                isa.name()
            );
            assert!(worst <= bar, "{id} at {}: {worst:e} > {bar:e}", isa.name());
        }
    }
}

#[test]
fn numerics_light_groups_f32() {
    numerics_groups::<f32>(2e-6);
}

#[test]
fn numerics_light_groups_f64() {
    numerics_groups::<f64>(1e-14);
}

/// The adapter's `lighting`: a light straight above, shadowed by a half; the lecture's form at the mirror angle.
#[test]
fn lighting_terms_of_the_adapter() {
    let line = r#"{"id": 1, "normal": [0, 0, 1], "vertex": [0, 0, -1, 1],
        "lights": [{"position": [0, 0, 1, 0], "ambient": [0.5, 0.5, 0.5, 1], "diffuse": [1, 1, 1, 1], "specular": [1, 1, 1, 1]}],
        "material": {"ambient": [0.5, 0.5, 0.5, 1], "diffuse": [0.5, 0.25, 0, 1], "specular": [1, 1, 1, 1], "shininess": 3},
        "scene_ambient": [0, 0, 0, 1], "shadow": [0.5], "separate_specular": true}"#;
    for form in ["opengl", "lecture"] {
        let line = line.replacen('{', &format!(r#"{{"form": "{form}","#), 1);
        let answer = gl_lights::terms(&line).expect("an answer");
        assert_eq!(
            answer["lights"][0]["ambient"],
            serde_json::json!([0.25, 0.25, 0.25])
        );
        assert_eq!(
            answer["lights"][0]["diffuse"],
            serde_json::json!([0.25, 0.125, 0.0])
        );
        assert_eq!(
            answer["lights"][0]["specular"],
            serde_json::json!([0.5, 0.5, 0.5])
        );
        assert_eq!(answer["primary"], serde_json::json!([0.5, 0.375, 0.25]));
        assert_eq!(answer["secondary"], serde_json::json!([0.5, 0.5, 0.5]));
        assert_eq!(answer["total"], serde_json::json!([1.0, 0.875, 0.75]));
    }
}
