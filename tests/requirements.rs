//! `Requirements` against the 16 abstract scenes of `tests/reference/requirements.json` (computed for this project;
//! format: the `requirements.json` section of the numerics readme, restated by the fields read below).

use rastray::gl;
use rastray::math::DAffine3;
use rastray::scene::requirements::{Feature, Mode, Requirements};
use rastray::scene::{Cull, Geometry, Light, LightSpace, Material, Object, Optics, Scene, Shape};
use serde_json::Value;

fn rgb(v: &Value) -> [f64; 3] {
    [0, 1, 2].map(|i| v[i].as_f64().expect("a colour component"))
}

fn number(v: &Value, key: &str) -> f64 {
    v[key].as_f64().unwrap_or_else(|| panic!("{key} in {v}"))
}

fn flag(v: &Value, key: &str) -> bool {
    v[key].as_bool().unwrap_or_else(|| panic!("{key} in {v}"))
}

fn material(v: &Value, back: bool) -> Material {
    let front = gl::Material {
        emission: rgb(&v["emission"]),
        ambient: rgb(&v["ambient"]),
        diffuse: rgb(&v["diffuse"]),
        specular: rgb(&v["specular"]),
        shininess: number(v, "shininess"),
        ..gl::Material::default()
    };
    let optics = Optics {
        reflection: [number(v, "mirror"); 3],
        transmission: [number(v, "transmit"); 3],
        ior: number(v, "ior"),
        ..Optics::default()
    };
    Material {
        name: "m".into(),
        back: back.then(|| front.clone()),
        front,
        optics,
    }
}

fn light(v: &Value) -> Light {
    let p = &v["pos"];
    let source = gl::LightSource {
        position: [0, 1, 2, 3].map(|i| p[i].as_f64().expect("a coordinate")),
        ambient: rgb(&v["ambient"]),
        diffuse: rgb(&v["diffuse"]),
        specular: rgb(&v["specular"]),
        attenuation: [number(v, "kc"), number(v, "kl"), number(v, "kq")],
        spot_cutoff_deg: number(v, "spot_cutoff"),
        spot_exponent: number(v, "spot_exp"),
        ..gl::LightSource::default()
    };
    Light {
        name: "l".into(),
        source,
        space: LightSpace::World,
        enabled: flag(v, "on"),
    }
}

fn scene(v: &Value) -> Scene {
    let list = |key: &str| v[key].as_array().expect(key).clone();
    let mut scene = Scene::default();
    scene.light_model.ambient = rgb(&v["scene_ambient"]);
    scene.light_model.local_viewer = flag(v, "local_viewer");
    scene.light_model.two_sided = flag(v, "two_side");
    scene.light_model.normalize = flag(v, "normalize");
    scene.raster.cull = if flag(v, "cull_back") {
        Cull::Back
    } else {
        Cull::None
    };
    scene.trace.depth = number(v, "max_depth") as u32;
    scene.lights = list("lights").iter().map(light).collect();
    for m in list("materials") {
        if flag(&m, "used") {
            scene.objects.push(Object {
                name: "o".into(),
                geometry: Geometry::Shape(Shape::Sphere {
                    center: Default::default(),
                    radius: 1.0,
                }),
                materials: vec![scene.materials.len()],
                world_from_object: DAffine3::IDENTITY,
                tessellation: None,
            });
        }
        scene.materials.push(material(&m, flag(v, "back_material")));
    }
    scene
}

#[test]
fn the_sixteen_descriptors() {
    let text = include_str!("reference/requirements.json");
    let scenes: Vec<Value> = serde_json::from_str(text).expect("reference data");
    assert_eq!(scenes.len(), 16);
    for v in &scenes {
        let mode = if v["mode"] == "trace" {
            Mode::Trace
        } else {
            Mode::Raster
        };
        let requirements = Requirements::of(&scene(v), mode);
        // Three facts of the descriptors have no place in a scene file: lighting is always on, shadows are a render
        // option, and normals are never known to be exactly unit length after the rotation to eye space.
        assert!(
            flag(v, "lighting"),
            "{}: lighting off is not a scene",
            v["name"]
        );
        let found: Vec<&str> = requirements
            .iter()
            .map(|(feature, _)| feature)
            .filter(|f| *f != Feature::ShadowRays || flag(v, "shadows"))
            .filter(|f| *f != Feature::Normalize || !flag(v, "normals_unit"))
            .map(Feature::name)
            .collect();
        let wanted: Vec<&str> = v["required"]
            .as_array()
            .expect("required")
            .iter()
            .filter_map(Value::as_str)
            .filter(|name| *name != "texture")
            .collect();
        assert_eq!(found, wanted, "{}", v["name"]);
    }
}

#[test]
fn names_are_sorted_and_match_their_features() {
    for (i, (name, feature)) in Feature::NAMES.iter().enumerate() {
        assert_eq!(*feature as usize, i);
        assert_eq!(feature.name(), *name);
    }
    assert!(Feature::NAMES.is_sorted());
}

#[test]
fn unused_materials_and_dead_lights_ask_for_nothing() {
    let mut scene = Scene::default();
    let shiny = gl::Material {
        specular: [1.0; 3],
        shininess: 9.0,
        ..gl::Material::default()
    };
    let optics = Optics {
        reflection: [1.0; 3],
        ..Optics::default()
    };
    scene.materials.push(Material {
        name: "unused".into(),
        front: shiny,
        back: None,
        optics,
    });
    let dark = gl::LightSource {
        diffuse: [0.0; 3],
        specular: [0.0; 3],
        ..Default::default()
    };
    let (name, space, enabled) = ("dark".into(), LightSpace::World, true);
    scene.lights.push(Light {
        name,
        source: dark,
        space,
        enabled,
    });
    let requirements = Requirements::of(&scene, Mode::Trace);
    assert_eq!(requirements.iter().count(), 0);
    assert_eq!(requirements.live_lights, [false]);
}

#[test]
fn terms_that_follow_vertex_colours_are_needed_whatever_the_material_says() {
    let mut scene = Scene::default();
    scene.lights.push(Light {
        name: "key".into(),
        source: gl::LightSource::default(),
        space: LightSpace::World,
        enabled: true,
    });
    let black = gl::Material {
        ambient: [0.0; 3],
        diffuse: [0.0; 3],
        ..gl::Material::default()
    };
    scene.materials.push(Material {
        name: "m".into(),
        front: black,
        back: None,
        optics: Optics::default(),
    });
    scene.objects.push(Object {
        name: "o".into(),
        geometry: Geometry::Mesh(std::sync::Arc::default()),
        materials: vec![0],
        world_from_object: DAffine3::IDENTITY,
        tessellation: None,
    });
    let features = |scene: &Scene| -> Vec<&str> {
        let needs = Requirements::of(scene, Mode::Raster);
        needs.iter().map(|(f, _)| f.name()).collect()
    };
    assert_eq!(features(&scene), [""; 0]);
    for (mode, expected) in [
        (gl::ColorMaterialMode::Emission, &["emission"][..]),
        (gl::ColorMaterialMode::Ambient, &["ambient"]),
        (
            gl::ColorMaterialMode::Diffuse,
            &["diffuse", "normal", "normalize"],
        ),
        (
            gl::ColorMaterialMode::Specular,
            &["normal", "normalize", "specular"],
        ),
    ] {
        let face = gl::Face::Front;
        scene.materials[0].front.tracked = gl::ColorMaterial { face, mode }.tracked(false);
        assert_eq!(features(&scene), expected, "{mode:?}");
    }
}
