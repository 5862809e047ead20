//! Cases in the form of glLight, glMaterial and a vertex: transformed and lit as the renderers do it.

use rastray::gl::{
    ColorControl, ColorMaterial, ColorMaterialMode, Face, LightModel, LightSource, Material,
    SpecularModel, Tracked,
};
use rastray::lanes::{Isa, Real};
use rastray::lighting::{Illumination, Points, Rig, Sink, Visibility, shade, to_viewer};
use rastray::math::color::clamp_rgb;
use rastray::math::float::normalize;
use rastray::math::transform::{normal_matrix, rescale_factor};
use rastray::math::{DAffine3, DMat3, DMat4, DVec3, DVec4};
use rastray::scene::{Light, LightSpace, Scene};
use serde::Deserialize;
use serde_json::{Value, json};

use super::{Failure, number};

/// One case; what is left out has OpenGL's default.
#[derive(Deserialize)]
#[serde(default)]
struct Case {
    id: Value,
    form: Option<String>,
    face: String,
    modelview: [f64; 16],
    light_modelview: [f64; 16],
    vertex: [f64; 4],
    normal: [f64; 3],
    lights: Vec<CaseLight>,
    material: CaseMaterial,
    back_material: Option<CaseMaterial>,
    scene_ambient: Vec<f64>,
    local_viewer: bool,
    two_side: bool,
    separate_specular: bool,
    normalize: bool,
    rescale_normal: bool,
    color_material: Option<Tracking>,
    color: [f64; 4],
    shadow: Vec<Shadow>,
}

#[derive(Deserialize)]
#[serde(default)]
struct CaseLight {
    position: [f64; 4],
    ambient: Vec<f64>,
    diffuse: Vec<f64>,
    specular: Vec<f64>,
    spot_direction: [f64; 3],
    spot_exponent: f64,
    spot_cutoff: f64,
    attenuation: [f64; 3],
}

#[derive(Clone, Deserialize)]
#[serde(default)]
struct CaseMaterial {
    emission: Vec<f64>,
    ambient: Vec<f64>,
    diffuse: Vec<f64>,
    specular: Vec<f64>,
    shininess: f64,
}

#[derive(Deserialize)]
struct Tracking {
    face: String,
    mode: String,
}

/// S_L of a light: a number, or one a colour component.
#[derive(Clone, Copy, Deserialize)]
#[serde(untagged)]
enum Shadow {
    Grey(f64),
    Color([f64; 3]),
}

const IDENTITY: [f64; 16] = [
    1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
];

impl Default for Case {
    fn default() -> Self {
        Self {
            id: Value::Null,
            form: None,
            face: "front".into(),
            modelview: IDENTITY,
            light_modelview: IDENTITY,
            vertex: [0.0, 0.0, 0.0, 1.0],
            normal: [0.0, 0.0, 1.0],
            lights: Vec::new(),
            material: CaseMaterial::default(),
            back_material: None,
            scene_ambient: vec![0.2, 0.2, 0.2, 1.0],
            local_viewer: false,
            two_side: false,
            separate_specular: false,
            normalize: false,
            rescale_normal: false,
            color_material: None,
            color: [1.0; 4],
            shadow: Vec::new(),
        }
    }
}

impl Default for CaseLight {
    fn default() -> Self {
        let gl = LightSource::gl_default(0);
        Self {
            position: gl.position,
            ambient: gl.ambient.to_vec(),
            diffuse: gl.diffuse.to_vec(),
            specular: gl.specular.to_vec(),
            spot_direction: gl.spot_direction,
            spot_exponent: gl.spot_exponent,
            spot_cutoff: gl.spot_cutoff_deg,
            attenuation: gl.attenuation,
        }
    }
}

impl Default for CaseMaterial {
    fn default() -> Self {
        let gl = Material::default();
        Self {
            emission: gl.emission.to_vec(),
            ambient: gl.ambient.to_vec(),
            diffuse: gl.diffuse.to_vec(),
            specular: gl.specular.to_vec(),
            shininess: gl.shininess,
        }
    }
}

/// Red, green, blue of a colour with three or four components.
fn rgb(list: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|c| list.get(c).copied().unwrap_or(0.0))
}

/// Everything the equation needs, in eye space.
struct Prepared<R> {
    isa: Isa,
    rig: Rig<R>,
    material: Material,
    points: Points<R>,
    signed: bool,
}

/// Answers a line of `gl-lights`.
pub(crate) fn answer<R: Real>(line: &str) -> Result<Value, Failure> {
    answer_at::<R>(Isa::detect(), line)
}

/// Answers a line of `gl-lights` at an instruction set.
pub(crate) fn answer_at<R: Real>(isa: Isa, line: &str) -> Result<Value, Failure> {
    let case: Case = serde_json::from_str(line)?;
    let prepared = prepare::<R>(isa, &case)?;
    let (primary, secondary) = prepared.split(None);
    let sum = |a: [R; 3], b: [R; 3]| [0, 1, 2].map(|c| a[c] + b[c]);
    let clamped = clamp_rgb(sum(clamp_rgb(primary), clamp_rgb(secondary)));
    let rgba = |rgb: [R; 3], alpha: f64| {
        let [r, g, b] = rgb.map(|x| number(x.to_f64()));
        json!([r, g, b, alpha])
    };
    let alpha = prepared.material.alpha;
    Ok(json!({
        "id": case.id,
        "primary": rgba(primary, alpha),
        "secondary": rgba(secondary, 0.0),
        "final": rgba(sum(primary, secondary), alpha),
        "final_clamped": rgba(clamped, alpha.clamp(0.0, 1.0)),
    }))
}

/// Answers a line of `lighting`: every term, in f64.
pub(crate) fn terms(line: &str) -> Result<Value, Failure> {
    let case: Case = serde_json::from_str(line)?;
    let prepared = prepare::<f64>(Isa::detect(), &case)?;
    let mut given = Given(&case.shadow);
    let (primary, secondary) = prepared.split(Some(&mut given));
    let mut layers = Vec::new();
    prepared.shade(Some(&mut given), Sink::Record(&mut layers));
    let mut total = <[Vec<f64>; 3]>::default();
    prepared.shade(Some(&mut given), Sink::Sum(&mut total));
    let rgb = |layer: &[Vec<f64>; 3]| json!([0, 1, 2].map(|c| number(layer[c][0])));
    let lights: Vec<Value> = layers[2..]
        .chunks(3)
        .map(|of_light| {
            json!({
                "ambient": rgb(&of_light[0]),
                "diffuse": rgb(&of_light[1]),
                "specular": rgb(&of_light[2]),
            })
        })
        .collect();
    Ok(json!({
        "id": case.id,
        "lights": lights,
        "emission": rgb(&layers[0]),
        "scene_ambient": rgb(&layers[1]),
        "primary": primary.map(number),
        "secondary": secondary.map(number),
        "total": rgb(&total),
    }))
}

impl<R: Real> Prepared<R> {
    fn shade(&self, visibility: Option<&mut dyn Visibility<R>>, sink: Sink<'_, R>) {
        let Self {
            isa,
            rig,
            material,
            points,
            signed,
        } = self;
        shade(*isa, rig, material, points, visibility, *signed, sink);
    }

    /// GL's primary and secondary colour, unclamped.
    fn split(&self, visibility: Option<&mut dyn Visibility<R>>) -> ([R; 3], [R; 3]) {
        let (mut first, mut second) = <([Vec<R>; 3], [Vec<R>; 3])>::default();
        self.shade(visibility, Sink::Split(&mut first, &mut second));
        (
            [0, 1, 2].map(|c| first[c][0]),
            [0, 1, 2].map(|c| second[c][0]),
        )
    }
}

/// S_L as the case gives it; 1 where it gives none.
struct Given<'a>(&'a [Shadow]);
impl Visibility<f64> for Given<'_> {
    fn query(&mut self, light: usize, _: &Illumination<f64>, out: &mut [Vec<f64>; 3]) {
        if let Some(shadow) = self.0.get(light) {
            let color = match *shadow {
                Shadow::Grey(s) => [s; 3],
                Shadow::Color(color) => color,
            };
            for (list, s) in out.iter_mut().zip(color) {
                list.fill(s);
            }
        }
    }
}

/// Transforms the vertex, its normal and the lights to eye space and picks the face.
fn prepare<R: Real>(isa: Isa, case: &Case) -> Result<Prepared<R>, Failure> {
    let eye_from_object = DMat4::from_cols_array(&case.modelview);
    let eye_from_light = DMat4::from_cols_array(&case.light_modelview);
    let specular_model = match case.form.as_deref() {
        None | Some("opengl") => SpecularModel::HalfVector,
        Some("lecture") => SpecularModel::Reflection,
        Some(other) => {
            return Err(format!("form: expected opengl or lecture, found {other:?}").into());
        }
    };
    let model = LightModel {
        ambient: rgb(&case.scene_ambient),
        local_viewer: case.local_viewer,
        two_sided: case.two_side,
        color_control: if case.separate_specular {
            ColorControl::SeparateSpecular
        } else {
            ColorControl::Single
        },
        specular_model,
        normalize: case.normalize,
        rescale_normal: case.rescale_normal,
    };
    let lights: Vec<LightSource> = case
        .lights
        .iter()
        .map(|light| to_eye(light, &eye_from_light))
        .collect();
    let back = case.two_side && case.face == "back";
    let material = material(case, back)?;
    // Position: divided by w. Normal: inverse transpose, unit length and the length it enters with.
    let eye = eye_from_object * DVec4::from_array(case.vertex);
    let position = (eye.truncate() / eye.w).to_array().map(R::from_f64);
    let linear = DMat3::from_mat4(eye_from_object);
    let place = DAffine3 {
        matrix3: linear,
        translation: DVec3::ZERO,
    };
    let raw = normal_matrix(&place) * DVec3::from_array(case.normal);
    let (unit, length) = normalize(raw.to_array());
    let unit = if back { unit.map(|x| -x) } else { unit };
    let mut points = Points::default();
    let viewer = to_viewer(position, case.local_viewer);
    points.push(position, unit.map(R::from_f64), viewer);
    if !case.normalize {
        let factor = if case.rescale_normal {
            rescale_factor(&linear)
        } else {
            1.0
        };
        points.normal_length.push(R::from_f64(length * factor));
    }
    Ok(Prepared {
        isa,
        signed: signed(&lights, &[&material], &model),
        rig: Rig::new(&lights, &model),
        material,
        points,
    })
}

/// Whether the renderers would sum in f64.
pub(crate) fn signed(lights: &[LightSource], materials: &[&Material], model: &LightModel) -> bool {
    let scene = Scene {
        light_model: model.clone(),
        lights: lights
            .iter()
            .map(|source| Light {
                name: String::new(),
                source: source.clone(),
                space: LightSpace::Eye,
                enabled: true,
            })
            .collect(),
        materials: materials
            .iter()
            .map(|front| rastray::scene::Material {
                name: String::new(),
                front: (*front).clone(),
                back: None,
                optics: rastray::scene::Optics::default(),
            })
            .collect(),
        ..Scene::default()
    };
    scene.has_negative_colors()
}

fn to_eye(light: &CaseLight, eye_from_light: &DMat4) -> LightSource {
    let position = *eye_from_light * DVec4::from_array(light.position);
    let spot = DMat3::from_mat4(*eye_from_light) * DVec3::from_array(light.spot_direction);
    LightSource {
        ambient: rgb(&light.ambient),
        diffuse: rgb(&light.diffuse),
        specular: rgb(&light.specular),
        position: position.to_array(),
        spot_direction: spot.to_array(),
        spot_exponent: light.spot_exponent,
        spot_cutoff_deg: light.spot_cutoff,
        attenuation: light.attenuation,
    }
}

/// The material of the visible face, after GL_COLOR_MATERIAL (GL 2.1 section 2.14.3).
fn material(case: &Case, back: bool) -> Result<Material, Failure> {
    let given = match &case.back_material {
        Some(given) if back => given,
        _ => &case.material,
    };
    let tracked = match &case.color_material {
        None => Tracked::default(),
        Some(setting) => ColorMaterial {
            face: named(Face::NAMES, "face", &setting.face)?,
            mode: named(ColorMaterialMode::NAMES, "mode", &setting.mode)?,
        }
        .tracked(back),
    };
    let material = Material {
        emission: rgb(&given.emission),
        ambient: rgb(&given.ambient),
        diffuse: rgb(&given.diffuse),
        specular: rgb(&given.specular),
        alpha: given.diffuse.get(3).copied().unwrap_or(1.0),
        shininess: given.shininess,
        tracked,
    };
    Ok(material.with_color(case.color))
}

/// The value of a name in a table of names.
fn named<T: Copy>(table: &[(&str, T)], what: &str, name: &str) -> Result<T, Failure> {
    let found = table.iter().find(|(n, _)| *n == name);
    found
        .map(|(_, value)| *value)
        .ok_or_else(|| format!("color_material: unknown {what} {name:?}").into())
}
