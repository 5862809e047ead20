//! The cases for numerical stability, kinds `light`, `raster`, `near`, `persp` and `depth`; those of rays stand in `rays`.
//!
//! Coverage is decided on the vertices as given, whatever the precision; interpolated values are rounded to it.

use std::io::Write;

use rastray::gl::{LightModel, LightSource, Material};
use rastray::lanes::{Isa, Real};
use rastray::lighting::{Points, Rig, Sink, shade, to_viewer};
use rastray::math::float::normalize;
use rastray::raster::{Run, coverage, coverage_clip_space, depth_key, perspective_weights};
use rastray::scene::Snap;
use serde::Deserialize;
use serde_json::{Value, json};

use super::{Failure, number};

#[derive(Deserialize)]
struct Case {
    id: String,
    kind: String,
    evals: Vec<Value>,
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

/// One evaluation of kind `raster`, pixel frame.
#[derive(Deserialize)]
struct Triangles {
    tris: Vec<[[f64; 2]; 3]>,
    origin: [i64; 2],
    size: [u32; 2],
}

/// One evaluation of kind `near` or `persp`: a triangle in clip space.
#[derive(Deserialize)]
struct ClipTriangle {
    clip: [[f64; 4]; 3],
    size: [u32; 2],
    #[serde(default)]
    attr: [f64; 3],
    #[serde(default)]
    px: Vec<[f64; 2]>,
}

/// One evaluation of kind `depth`: two distances along -z.
#[derive(Deserialize)]
struct Distances {
    z1: f64,
    z2: f64,
}

/// Answers an evaluation of a kind; `None` where it does not know the kind.
type Other = fn(&str, Value) -> Result<Option<Value>, Failure>;

/// Writes the answer object; `other` answers the kinds that are not this module's, and kinds that it does not know are left out.
pub(crate) fn answer<R: Real>(
    text: &str,
    snap: Snap,
    other: Other,
    out: &mut impl Write,
) -> Result<(), Failure> {
    let cases: Vec<Case> = serde_json::from_str(text)?;
    let mut answers = serde_json::Map::new();
    for case in cases {
        let evaluate = |evaluation: Value| -> Result<Option<Value>, Failure> {
            Ok(Some(match case.kind.as_str() {
                "light" => {
                    let rgb = light::<R>(Isa::detect(), evaluation)?.map(number);
                    json!({ "rgb": rgb })
                }
                "raster" => raster(evaluation, snap)?,
                "near" => near(evaluation, snap)?,
                "persp" => persp::<R>(evaluation)?,
                "depth" => depth(evaluation)?,
                kind => return other(kind, evaluation),
            }))
        };
        let list: Result<Option<Vec<Value>>, Failure> =
            case.evals.into_iter().map(evaluate).collect();
        if let Some(list) = list? {
            answers.insert(case.id, list.into());
        }
    }
    writeln!(out, "{}", Value::from(answers))?;
    Ok(())
}

/// Runs as the answers write them.
fn runs(list: &[Run]) -> Vec<[i64; 3]> {
    list.iter().map(|run| [run.y, run.x0, run.x1]).collect()
}

/// The pixels of each triangle.
pub(crate) fn raster(case: Value, snap: Snap) -> Result<Value, Failure> {
    let case: Triangles = serde_json::from_value(case)?;
    let cover = |t: &[[f64; 2]; 3]| runs(&coverage(*t, case.origin, case.size, snap));
    let tris: Vec<_> = case.tris.iter().map(cover).collect();
    let snap = match snap {
        Snap::Bits8 => json!(8),
        Snap::Bits12 => json!(12),
        Snap::Exact => json!("exact"),
    };
    Ok(json!({ "snap": snap, "tris": tris }))
}

/// The pixels of a triangle that may cross the near plane.
pub(crate) fn near(case: Value, snap: Snap) -> Result<Value, Failure> {
    let case: ClipTriangle = serde_json::from_value(case)?;
    Ok(json!({ "runs": runs(&coverage_clip_space(case.clip, case.size, snap)) }))
}

/// An attribute and w at pixel centres; null where the triangle is seen edge-on.
pub(crate) fn persp<R: Real>(case: Value) -> Result<Value, Failure> {
    let case: ClipTriangle = serde_json::from_value(case)?;
    let corners = case.clip.map(|[x, y, _, w]| [x, y, w]);
    let [width, height] = case.size.map(f64::from);
    let at = |&[x, y]: &[f64; 2]| {
        let ndc = [
            (2.0 * (x + 0.5) - width) / width,
            (height - 2.0 * (y + 0.5)) / height,
        ];
        let b = perspective_weights(corners, ndc)?;
        let sum = |v: [f64; 3]| R::from_f64(b[0] * v[0] + b[1] * v[1] + b[2] * v[2]).to_f64();
        Some([sum(case.attr), sum(corners.map(|h| h[2]))].map(number))
    };
    let v: Vec<_> = case.px.iter().map(at).collect();
    Ok(json!({ "v": v }))
}

/// Which of two distances is closer; 0 = neither.
pub(crate) fn depth(case: Value) -> Result<Value, Failure> {
    let case: Distances = serde_json::from_value(case)?;
    let (first, second) = (depth_key(case.z1), depth_key(case.z2));
    let closer = i32::from(first > second) + 2 * i32::from(second > first);
    Ok(json!({ "closer": closer }))
}

/// One evaluation at an instruction set.
pub(crate) fn light<R: Real>(isa: Isa, case: Value) -> Result<[f64; 3], Failure> {
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
