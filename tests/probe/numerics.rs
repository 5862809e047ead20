//! The cases for numerical stability, kind `light` (others are left out of the answer).

use std::io::Write;

use rastray::gl::{LightModel, LightSource, Material};
use rastray::lanes::{Isa, Real};
use rastray::lighting::{Points, Rig, Sink, shade, to_viewer};
use rastray::math::float::normalize;
use serde::Deserialize;

use super::{Failure, number};

#[derive(Deserialize)]
struct Case {
    id: String,
    kind: String,
    evals: Vec<serde_json::Value>,
}

/// One evaluation of kind `light`, eye space.
#[derive(Deserialize)]
struct Evaluation {
    v: [f64; 3],
    n: [f64; 3],
    material: CaseMaterial,
    lights: Vec<CaseLight>,
    scene_ambient: [f64; 3],
    local_viewer: bool,
}

#[derive(Deserialize)]
struct CaseMaterial {
    emission: [f64; 3],
    ambient: [f64; 3],
    diffuse: [f64; 3],
    specular: [f64; 3],
    shininess: f64,
}

#[derive(Deserialize)]
struct CaseLight {
    pos: [f64; 4],
    ambient: [f64; 3],
    diffuse: [f64; 3],
    specular: [f64; 3],
    spot_dir: [f64; 3],
    spot_exp: f64,
    spot_cutoff: f64,
    kc: f64,
    kl: f64,
    kq: f64,
}

/// Writes the answer object.
pub(crate) fn answer<R: Real>(text: &str, out: &mut impl Write) -> Result<(), Failure> {
    let cases: Vec<Case> = serde_json::from_str(text)?;
    let mut answers = serde_json::Map::new();
    for case in cases.into_iter().filter(|case| case.kind == "light") {
        let mut list = Vec::new();
        for evaluation in case.evals {
            let rgb = light::<R>(Isa::detect(), evaluation)?.map(number);
            list.push(serde_json::json!({ "rgb": rgb }));
        }
        answers.insert(case.id, list.into());
    }
    writeln!(out, "{}", serde_json::Value::from(answers))?;
    Ok(())
}

/// One evaluation at an instruction set.
pub(crate) fn light<R: Real>(isa: Isa, case: serde_json::Value) -> Result<[f64; 3], Failure> {
    let case: Evaluation = serde_json::from_value(case)?;
    let material = Material {
        emission: case.material.emission,
        ambient: case.material.ambient,
        diffuse: case.material.diffuse,
        specular: case.material.specular,
        shininess: case.material.shininess,
        ..Material::default()
    };
    let lights: Vec<LightSource> = case.lights.iter().map(source).collect();
    let model = LightModel {
        ambient: case.scene_ambient,
        local_viewer: case.local_viewer,
        ..LightModel::default()
    };
    let mut points = Points::<R>::default();
    let position = case.v.map(R::from_f64);
    let (normal, _) = normalize(case.n);
    let viewer = to_viewer(position, case.local_viewer);
    points.push(position, normal.map(R::from_f64), viewer);
    let mut out = <[Vec<R>; 3]>::default();
    let rig = Rig::new(&lights, &model);
    let signed = super::gl_lights::signed(&lights, &[&material], &model);
    let sink = Sink::Sum(&mut out);
    shade(isa, &rig, &material, &points, None, signed, sink);
    Ok(out.map(|list| list[0].to_f64()))
}

fn source(light: &CaseLight) -> LightSource {
    LightSource {
        ambient: light.ambient,
        diffuse: light.diffuse,
        specular: light.specular,
        position: light.pos,
        spot_direction: light.spot_dir,
        spot_exponent: light.spot_exp,
        spot_cutoff_deg: light.spot_cutoff,
        attenuation: [light.kc, light.kl, light.kq],
    }
}
