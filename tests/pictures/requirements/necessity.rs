//! Nothing reported is superfluous: on a scene built to show every feature, a plan without one draws another picture. And
//! nothing unreported was needed: a plan of everything but that draws the same.

use rastray::frame::Frame;
use rastray::gl::{self, ShadeModel};
use rastray::lanes::Isa;
use rastray::math::{DAffine3, DVec3};
use rastray::render::{Rasterizer, Tracer};
use rastray::scene::requirements::{Feature, Mode, Requirements};
use rastray::scene::{
    Geometry, Light, LightSpace, Material, Object, Optics, Projection, Scene, Shape,
};
use rastray::{raster, trace};

use crate::common::precise::{assembled, follow, rasterize};

/// One picture at a precision of f32, with requirements of the caller's. Normals are made unit by the assembly.
pub(crate) fn draw(scene: &Scene, mode: Mode, needs: &Requirements) -> Frame<f32> {
    let mut lengths = scene.clone();
    lengths.light_model.normalize &= needs.has(Feature::Normalize);
    let assembly = assembled::<f32>(&lengths, Some(16)).expect("a small scene");
    let isa = Isa::detect();
    if mode == Mode::Raster {
        let plan = Rasterizer::with_requirements(scene, &assembly, needs);
        let (shading, clamp, layers) = (scene.raster.shading, false, false);
        let options = raster::Options {
            shading,
            clamp,
            layers,
            isa,
        };
        return rasterize(&plan, &options).expect("drawn").0;
    }
    let geometry = trace::Geometry::Exact;
    let plan = Tracer::with_requirements(scene, &assembly, geometry, needs.clone());
    let plan = plan.expect("a picture with pixels");
    let drawn = follow(&plan, &trace::Options::of(scene, isa));
    drawn.expect("traced").0
}

pub(crate) fn bits(frame: &Frame<f32>) -> Vec<u32> {
    let color = frame.color.data.iter().flatten();
    color
        .chain(&frame.depth.data)
        .map(|x| x.to_bits())
        .collect()
}

fn object(name: &str, shape: Shape, material: usize, place: DAffine3) -> Object {
    Object {
        name: name.into(),
        geometry: Geometry::Shape(shape),
        materials: vec![material],
        world_from_object: place,
        tessellation: None,
        priority: 0,
    }
}

fn light(name: &str, source: gl::LightSource) -> Light {
    let (name, space, enabled) = (name.into(), LightSpace::World, true);
    Light {
        name,
        source,
        space,
        enabled,
    }
}

/// A wall seen from behind, a stretched shiny ball that mirrors, and one of glass, under a spot and a distant light.
fn everything() -> Scene {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (48, 36);
    scene.camera.eye = DVec3::new(0.0, 0.0, 6.0);
    scene.camera.target = DVec3::ZERO;
    assert!(matches!(
        scene.camera.projection,
        Projection::Perspective { .. }
    ));
    scene.raster.shading = ShadeModel::Gouraud;
    scene.light_model.local_viewer = true;
    scene.light_model.two_sided = true;
    let shiny = gl::Material {
        emission: [0.05, 0.0, 0.02],
        specular: [0.5; 3],
        shininess: 20.0,
        ..gl::Material::default()
    };
    let mirror = Optics {
        reflection: [0.25; 3],
        ..Optics::default()
    };
    let glass = Optics {
        transmission: [0.75; 3],
        ior: 1.5,
        ..Optics::default()
    };
    let plain = gl::Material {
        diffuse: [0.2, 0.7, 0.3],
        ..gl::Material::default()
    };
    for (front, optics) in [
        (shiny.clone(), mirror),
        (shiny, glass),
        (plain.clone(), Optics::default()),
    ] {
        let back = Some(gl::Material {
            diffuse: [0.7, 0.3, 0.1],
            ..front.clone()
        });
        scene.materials.push(Material {
            name: "m".into(),
            front,
            back,
            optics,
        });
    }
    let ball = |x: f64| Shape::Sphere {
        center: DVec3::new(x, 0.0, 0.0),
        radius: 0.9,
    };
    let stretched = DAffine3::from_scale(DVec3::new(1.0, 1.5, 0.5));
    scene.objects.push(object("ball", ball(-1.0), 0, stretched));
    scene
        .objects
        .push(object("glass", ball(1.0), 1, DAffine3::IDENTITY));
    let wall = Shape::Patch {
        corner: DVec3::new(-4.0, -3.0, -2.0),
        edge_u: DVec3::new(0.0, 6.0, 0.0),
        edge_v: DVec3::new(8.0, 0.0, 0.0),
        tiles: [1, 1],
    };
    scene
        .objects
        .push(object("wall", wall, 2, DAffine3::IDENTITY));
    scene.lights.push(light(
        "spot",
        gl::LightSource {
            position: [0.5, 2.0, 5.0, 1.0],
            ambient: [0.1; 3],
            attenuation: [1.0, 0.0, 0.02],
            spot_direction: [0.0, -0.3, -1.0],
            spot_cutoff_deg: 25.0,
            spot_exponent: 3.0,
            ..gl::LightSource::default()
        },
    ));
    scene.lights.push(light(
        "sun",
        gl::LightSource {
            position: [-1.0, 1.0, 1.0, 0.0],
            diffuse: [0.4; 3],
            specular: [0.4; 3],
            ..gl::LightSource::default()
        },
    ));
    scene
}

#[test]
fn every_reported_feature_shows_in_some_pixel() {
    let scene = everything();
    for mode in [Mode::Raster, Mode::Trace] {
        let needs = Requirements::of(&scene, mode);
        let expected = if mode == Mode::Trace {
            Feature::NAMES.len()
        } else {
            Feature::NAMES.len() - 4
        };
        assert_eq!(
            needs.iter().count(),
            expected,
            "the scene shows every feature"
        );
        let all = bits(&draw(&scene, mode, &needs));
        for (feature, _) in needs.iter() {
            let less = bits(&draw(&scene, mode, &needs.without(feature)));
            // The tracer's normals are unit whatever the flag says: the rasterizer shows that feature.
            let shows = (mode, feature) != (Mode::Trace, Feature::Normalize);
            assert_eq!(all != less, shows, "{mode:?} without {}", feature.name());
        }
    }
}

/// The scene without what asks for a feature.
fn stripped(feature: Feature) -> Scene {
    let mut scene = everything();
    let mut each = |change: &dyn Fn(&mut gl::Material)| {
        for material in &mut scene.materials {
            change(&mut material.front);
            material.back.iter_mut().for_each(change);
        }
    };
    match feature {
        Feature::Ambient => each(&|m| m.ambient = [0.0; 3]),
        Feature::Diffuse => each(&|m| m.diffuse = [0.0; 3]),
        Feature::Emission => each(&|m| m.emission = [0.0; 3]),
        Feature::Specular => each(&|m| m.specular = [0.0; 3]),
        Feature::HalfVector => each(&|m| m.shininess = 0.0),
        Feature::Pow => each(&|m| m.shininess = 1.0),
        Feature::Normal | Feature::Normalize | Feature::ShadowRays => each(&|m| {
            (m.diffuse, m.specular) = ([0.0; 3], [0.0; 3]);
        }),
        Feature::Attenuation => scene.lights[0].source.attenuation = [1.0, 0.0, 0.0],
        Feature::Spot => scene.lights[0].source.spot_cutoff_deg = 180.0,
        Feature::SpotPow => scene.lights[0].source.spot_exponent = 0.0,
        Feature::LightVector => drop(scene.lights.remove(0)),
        Feature::TwoSide => scene.light_model.two_sided = false,
        Feature::ViewVector => scene.light_model.local_viewer = false,
        Feature::ReflectionRays => scene.materials[0].optics.reflection = [0.0; 3],
        Feature::RefractionRays => scene.materials[1].optics.transmission = [0.0; 3],
        Feature::Tir => scene.materials[1].optics.ior = 1.0,
    }
    scene
}

#[test]
fn no_unreported_feature_shows_in_any_bit() {
    for (name, feature) in Feature::NAMES {
        let scene = stripped(*feature);
        for mode in [Mode::Raster, Mode::Trace] {
            let needs = Requirements::of(&scene, mode);
            assert!(!needs.has(*feature), "{mode:?}: {name} is still needed");
            let full = Requirements::full(&scene);
            let all = bits(&draw(&scene, mode, &full));
            for (absent, _) in needs.absent() {
                // Where normals light nothing, whether they are unit cannot show; elsewhere the flag decides, not the list.
                let less = bits(&draw(&scene, mode, &full.without(absent)));
                assert!(
                    all == less,
                    "{mode:?}, no {name}: everything but {} differs",
                    absent.name()
                );
            }
            assert!(
                all == bits(&draw(&scene, mode, &needs)),
                "{mode:?}, no {name}: required and full differ"
            );
        }
    }
}

/// Culling is the rasterizer's. Where only back faces are lit, the tracer needs the lights all the same.
#[test]
fn rays_meet_back_faces_whatever_is_culled() {
    let mut scene = everything();
    for material in &mut scene.materials {
        let black = [0.0; 3];
        let front = &mut material.front;
        (front.ambient, front.diffuse, front.specular) = (black, black, black);
    }
    let seen = |scene: &Scene| {
        let needs = Requirements::of(scene, Mode::Trace);
        let shadows = needs.has(Feature::ShadowRays) && needs.has(Feature::TwoSide);
        (shadows, bits(&draw(scene, Mode::Trace, &needs)))
    };
    let open = seen(&scene);
    scene.raster.cull = rastray::scene::Cull::Back;
    assert!(open.0 && open == seen(&scene));
    assert!(!Requirements::of(&scene, Mode::Raster).has(Feature::Diffuse));
}
