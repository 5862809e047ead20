//! `Requirements`: the lists of 16 abstract scenes (`tests/reference/requirements.json`, computed for this project), what
//! a list may depend on, and that plans follow it: nothing needed is left out, nothing left out was needed.
//! The scenes that others wrote take part where the optional shared folder is present.

mod necessity;
mod plans;
mod properties;

use crate::common::descriptor;
use rastray::gl;
use rastray::math::DAffine3;
use rastray::scene::requirements::{Feature, Mode, Requirements};
use rastray::scene::{Geometry, Light, LightSpace, Material, Object, Optics, Scene};
use serde_json::Value;

#[test]
fn the_sixteen_descriptors() {
    let text = include_str!("../../reference/requirements.json");
    let scenes: Vec<Value> = serde_json::from_str(text).expect("reference data");
    assert_eq!(scenes.len(), 16);
    for v in &scenes {
        let found = descriptor::required(v).expect("a descriptor");
        let wanted: Vec<&str> = v["required"]
            .as_array()
            .expect("required")
            .iter()
            .filter_map(Value::as_str)
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
        priority: 0,
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
