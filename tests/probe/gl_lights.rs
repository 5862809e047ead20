//! Cases in the form of glLight, glMaterial and a vertex: set through the library's fixed-function context, transformed and
//! lit as the renderers do it. Precision and clamps are this adapter's.

use rastray::context::{
    Capability, Context, GlError, LightModelParameter, LightParameter, MAX_LIGHTS,
    MaterialParameter, PrimitiveMode,
};
use rastray::gl::{
    ColorControl, ColorMaterialMode, Face, LightModel, LightSource, Material, SpecularModel,
};
use rastray::lanes::{Isa, Real};
use rastray::lighting::{Illumination, Points, Rig, Sink, Visibility, shade, to_viewer};
use rastray::math::color::clamp_rgb;
use rastray::scene::assembly::Assembly;
use rastray::scene::{Light, LightSpace, Scene};
use serde::Deserialize;
use serde_json::{Value, json};

use super::{Failure, number};

/// One case; what is left out has OpenGL's default.
#[derive(Deserialize)]
#[serde(default)]
pub(crate) struct Case {
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
pub(crate) struct CaseLight {
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
pub(crate) struct CaseMaterial {
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

pub(crate) const IDENTITY: [f64; 16] = [
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

impl CaseLight {
    /// With every number rounded to f32, as OpenGL takes it.
    pub(crate) fn rounded(&self) -> Self {
        let single = |x: f64| f64::from(x as f32);
        let list = |v: &[f64]| v.iter().copied().map(single).collect();
        Self {
            position: self.position.map(single),
            ambient: list(&self.ambient),
            diffuse: list(&self.diffuse),
            specular: list(&self.specular),
            spot_direction: self.spot_direction.map(single),
            spot_exponent: single(self.spot_exponent),
            spot_cutoff: single(self.spot_cutoff),
            attenuation: self.attenuation.map(single),
        }
    }
}

impl CaseMaterial {
    /// With every number rounded to f32, as OpenGL takes it.
    pub(crate) fn rounded(&self) -> Self {
        let single = |x: f64| f64::from(x as f32);
        let list = |v: &[f64]| v.iter().copied().map(single).collect();
        Self {
            emission: list(&self.emission),
            ambient: list(&self.ambient),
            diffuse: list(&self.diffuse),
            specular: list(&self.specular),
            shininess: single(self.shininess),
        }
    }
}

/// Red, green, blue of a colour with three or four components.
pub(crate) fn rgb(list: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|c| list.get(c).copied().unwrap_or(0.0))
}

/// Everything the equation needs, in eye space.
pub(crate) struct Prepared<R> {
    pub(crate) isa: Isa,
    pub(crate) lights: Vec<LightSource>,
    pub(crate) model: LightModel,
    pub(crate) material: Material,
    pub(crate) points: Points<R>,
    pub(crate) signed: bool,
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
        let rig = Rig::new(&self.lights, &self.model);
        let (material, points) = (&self.material, &self.points);
        shade(
            self.isa,
            &rig,
            material,
            points,
            visibility,
            self.signed,
            sink,
        );
    }

    /// GL's primary and secondary colour, unclamped.
    pub(crate) fn split(&self, visibility: Option<&mut dyn Visibility<R>>) -> ([R; 3], [R; 3]) {
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

/// Sets GL's state through the library's context, draws the vertex, and takes it from there as the renderers do.
pub(crate) fn prepare<R: Real>(isa: Isa, case: &Case) -> Result<Prepared<R>, Failure> {
    let mut scene = record(case)?;
    scene.light_model.specular_model = match case.form.as_deref() {
        None | Some("opengl") => SpecularModel::HalfVector,
        Some("lecture") => SpecularModel::Reflection,
        Some(other) => {
            return Err(format!("form: expected opengl or lecture, found {other:?}").into());
        }
    };
    let assembly = Assembly::<R>::new(&scene, None)?;
    let back = case.two_side && case.face == "back";
    let drawn = &scene.materials[assembly.material[0] as usize];
    let material = match &drawn.back {
        Some(material) if back => material.clone(),
        _ => drawn.front.clone(),
    };
    let vertex = assembly.triangles[0][0];
    let position = assembly.vertex_eye(vertex);
    let normal = assembly.vertex_normal(vertex);
    let normal = if back { normal.map(|x| -x) } else { normal };
    let mut points = Points::default();
    points.push(position, normal, to_viewer(position, case.local_viewer));
    let length = assembly.normal_length.get(vertex as usize);
    points.normal_length.extend(length);
    Ok(Prepared {
        isa,
        signed: scene.has_negative_colors(),
        lights: scene.lights_eye(),
        model: scene.light_model,
        material,
        points,
    })
}

/// The case as a fixed-function program: one triangle, all of whose corners are the vertex.
fn record(case: &Case) -> Result<Scene, Failure> {
    let mut gl = Context::new(1, 1);
    gl.load_matrix(&case.light_modelview);
    gl.enable(Capability::Lighting);
    for (number, light) in case.lights.iter().enumerate() {
        set_light(&mut gl, number, light);
    }
    gl.light_model(LightModelParameter::Ambient(rgba(&case.scene_ambient)));
    gl.light_model(LightModelParameter::LocalViewer(case.local_viewer));
    gl.light_model(LightModelParameter::TwoSide(case.two_side));
    let control = if case.separate_specular {
        ColorControl::SeparateSpecular
    } else {
        ColorControl::Single
    };
    gl.light_model(LightModelParameter::ColorControl(control));
    for (on, capability) in [
        (case.normalize, Capability::Normalize),
        (case.rescale_normal, Capability::RescaleNormal),
    ] {
        if on {
            gl.enable(capability);
        }
    }
    set_material(&mut gl, Face::FrontAndBack, &case.material);
    if let Some(back) = &case.back_material {
        set_material(&mut gl, Face::Back, back);
    }
    let [r, g, b, a] = case.color;
    gl.color4(r, g, b, a);
    if let Some(setting) = &case.color_material {
        let face = named(Face::NAMES, "color_material face", &setting.face)?;
        gl.color_material(
            face,
            named(
                ColorMaterialMode::NAMES,
                "color_material mode",
                &setting.mode,
            )?,
        );
        gl.enable(Capability::ColorMaterial);
    }
    gl.load_matrix(&case.modelview);
    let [nx, ny, nz] = case.normal;
    gl.normal3(nx, ny, nz);
    gl.begin(PrimitiveMode::Triangles);
    // The equation asks where the vertex is, not whether GL would clip it: w < 0 is the same place.
    let [x, y, z, w] = case.vertex.map(|c| c * case.vertex[3].signum());
    for _ in 0..3 {
        gl.vertex4(x, y, z, w);
    }
    gl.end();
    let mut scene = gl.scene()?;
    if gl.get_error() == Some(GlError::InvalidValue) {
        beyond_gl(case, &mut scene)?;
    }
    Ok(scene)
}

/// glLight for every parameter, and switches the light on.
pub(crate) fn set_light(gl: &mut Context, number: usize, light: &CaseLight) {
    use LightParameter as L;
    let [constant, linear, quadratic] = light.attenuation;
    gl.enable(Capability::Light(number));
    for parameter in [
        L::Ambient(rgba(&light.ambient)),
        L::Diffuse(rgba(&light.diffuse)),
        L::Specular(rgba(&light.specular)),
        L::Position(light.position),
        L::SpotDirection(light.spot_direction),
        L::SpotExponent(light.spot_exponent),
        L::SpotCutoff(light.spot_cutoff),
        L::ConstantAttenuation(constant),
        L::LinearAttenuation(linear),
        L::QuadraticAttenuation(quadratic),
    ] {
        gl.light(number, parameter);
    }
}

/// glMaterial for every parameter of a face.
pub(crate) fn set_material(gl: &mut Context, face: Face, material: &CaseMaterial) {
    use MaterialParameter as M;
    for parameter in [
        M::Emission(rgba(&material.emission)),
        M::Ambient(rgba(&material.ambient)),
        M::Diffuse(rgba(&material.diffuse)),
        M::Specular(rgba(&material.specular)),
        M::Shininess(material.shininess),
    ] {
        gl.material(face, parameter);
    }
}

/// Values that GL refuses and this program evaluates: put into the scene as they are.
fn beyond_gl(case: &Case, scene: &mut Scene) -> Result<(), Failure> {
    if case.lights.len() > MAX_LIGHTS {
        return Err(format!("{} lights, more than {MAX_LIGHTS}", case.lights.len()).into());
    }
    for (light, given) in scene.lights.iter_mut().zip(&case.lights) {
        light.source.spot_exponent = given.spot_exponent;
        light.source.spot_cutoff_deg = given.spot_cutoff;
        light.source.attenuation = given.attenuation;
    }
    let back = case.back_material.as_ref().unwrap_or(&case.material);
    for material in &mut scene.materials {
        material.front.shininess = case.material.shininess;
        let side = material.back.get_or_insert_with(|| material.front.clone());
        side.shininess = back.shininess;
    }
    Ok(())
}

/// A colour with three or four components; alpha 1 where there is none.
pub(crate) fn rgba(list: &[f64]) -> [f64; 4] {
    let [r, g, b] = rgb(list);
    [r, g, b, list.get(3).copied().unwrap_or(1.0)]
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

/// The value of a name in a table of names.
pub(crate) fn named<T: Copy>(table: &[(&str, T)], what: &str, name: &str) -> Result<T, Failure> {
    let found = table.iter().find(|(n, _)| *n == name);
    found
        .map(|(_, value)| *value)
        .ok_or_else(|| format!("{what}: unknown value {name:?}").into())
}
