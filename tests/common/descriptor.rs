//! The abstract scenes of `tests/reference/requirements.json`: lights, materials and flags, without shapes. Here they
//! become scenes, whose requirements the library says.
//!
//! Five of a descriptor's facts have no place in a scene of this program, and are heeded here: lighting can be off; shadows
//! are an option of the render; normals may be known to be unit already; a tracer may drop back faces (ours never does);
//! a material may have a texture.

use rastray::gl;
use rastray::math::DAffine3;
use rastray::scene::requirements::{Feature, Mode, Requirements};
use rastray::scene::{Cull, Geometry, Light, LightSpace, Material, Object, Optics, Scene, Shape};
use serde_json::Value;

/// The sorted names of the features that a descriptor needs.
pub(crate) fn required(v: &Value) -> Result<Vec<&'static str>, String> {
    let mode = match v["mode"].as_str() {
        Some("trace") => Mode::Trace,
        Some("raster") => Mode::Raster,
        _ => {
            return Err(format!(
                "mode: expected raster or trace, found {}",
                v["mode"]
            ));
        }
    };
    let scene = scene(v, mode)?;
    let requirements = Requirements::of(&scene, mode);
    let (lighting, shadows) = (flag(v, "lighting")?, flag(v, "shadows")?);
    let unit = flag(v, "normals_unit")?;
    let heeded = |feature: &Feature| match feature {
        Feature::ReflectionRays | Feature::RefractionRays | Feature::Tir => true,
        Feature::ShadowRays => lighting && shadows,
        Feature::Normalize => lighting && !unit,
        _ => lighting,
    };
    let features = requirements.iter().map(|(feature, _)| feature);
    let mut names: Vec<_> = features.filter(heeded).map(Feature::name).collect();
    for m in list(v, "materials")? {
        if flag(m, "used")? && flag(m, "texture")? && !names.contains(&"texture") {
            names.push("texture");
        }
    }
    names.sort_unstable();
    Ok(names)
}

/// The descriptor as a scene: a sphere for each used material.
pub(crate) fn scene(v: &Value, mode: Mode) -> Result<Scene, String> {
    let mut scene = Scene::default();
    scene.light_model.ambient = rgb(&v["scene_ambient"])?;
    scene.light_model.local_viewer = flag(v, "local_viewer")?;
    scene.light_model.normalize = flag(v, "normalize")?;
    let culled = flag(v, "cull_back")?;
    scene.raster.cull = if culled { Cull::Back } else { Cull::None };
    // Two sides of which one is never seen are one.
    scene.light_model.two_sided = flag(v, "two_side")? && !(culled && mode == Mode::Trace);
    scene.trace.depth = number(v, "max_depth")? as u32;
    for light in list(v, "lights")? {
        scene.lights.push(light_of(light)?);
    }
    let back = flag(v, "back_material")?;
    for m in list(v, "materials")? {
        if flag(m, "used")? {
            scene.objects.push(sphere(scene.materials.len()));
        }
        scene.materials.push(material(m, back)?);
    }
    Ok(scene)
}

fn sphere(material: usize) -> Object {
    let (center, radius) = (Default::default(), 1.0);
    Object {
        name: "o".into(),
        geometry: Geometry::Shape(Shape::Sphere { center, radius }),
        materials: vec![material],
        world_from_object: DAffine3::IDENTITY,
        tessellation: None,
        priority: 0,
    }
}

fn list<'a>(v: &'a Value, key: &str) -> Result<&'a Vec<Value>, String> {
    v[key]
        .as_array()
        .ok_or_else(|| format!("{key}: expected a list"))
}

fn number(v: &Value, key: &str) -> Result<f64, String> {
    v[key]
        .as_f64()
        .ok_or_else(|| format!("{key}: expected a number, found {}", v[key]))
}

fn flag(v: &Value, key: &str) -> Result<bool, String> {
    v[key]
        .as_bool()
        .ok_or_else(|| format!("{key}: expected true or false, found {}", v[key]))
}

fn numbers<const N: usize>(v: &Value) -> Result<[f64; N], String> {
    let list = v.as_array().into_iter().flatten().filter_map(Value::as_f64);
    let list: Vec<f64> = list.collect();
    list.try_into()
        .map_err(|_| format!("expected {N} numbers, found {v}"))
}

fn rgb(v: &Value) -> Result<[f64; 3], String> {
    numbers(v)
}

fn material(v: &Value, back: bool) -> Result<Material, String> {
    let front = gl::Material {
        emission: rgb(&v["emission"])?,
        ambient: rgb(&v["ambient"])?,
        diffuse: rgb(&v["diffuse"])?,
        specular: rgb(&v["specular"])?,
        shininess: number(v, "shininess")?,
        ..gl::Material::default()
    };
    let optics = Optics {
        reflection: [number(v, "mirror")?; 3],
        transmission: [number(v, "transmit")?; 3],
        ior: number(v, "ior")?,
        ..Optics::default()
    };
    Ok(Material {
        name: "m".into(),
        back: back.then(|| front.clone()),
        front,
        optics,
    })
}

fn light_of(v: &Value) -> Result<Light, String> {
    let source = gl::LightSource {
        position: numbers(&v["pos"])?,
        ambient: rgb(&v["ambient"])?,
        diffuse: rgb(&v["diffuse"])?,
        specular: rgb(&v["specular"])?,
        attenuation: [number(v, "kc")?, number(v, "kl")?, number(v, "kq")?],
        spot_cutoff_deg: number(v, "spot_cutoff")?,
        spot_exponent: number(v, "spot_exp")?,
        ..gl::LightSource::default()
    };
    Ok(Light {
        name: "l".into(),
        source,
        space: LightSpace::World,
        enabled: flag(v, "on")?,
    })
}
