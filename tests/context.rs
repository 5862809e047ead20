//! Fixed-function GL against its specification: projection matrices, vertex colours, and the program-facing context.

use std::sync::Arc;

use rastray::decompose::{Options, decompose};
use rastray::frame::{Frame, NONE};
use rastray::gl::{self, LightSource, ShadeModel};
use rastray::lanes::Isa;
use rastray::math::{DAffine3, DMat4, DVec2, DVec3};
use rastray::scene::assembly::Assembly;
use rastray::scene::requirements::Model;
use rastray::scene::{
    Camera, Cull, Geometry, Light, LightSpace, Material, Mesh, Object, Optics, Projection, Scene,
    Shape,
};
use rastray::{raster, trace};

// ---- scenes with a projection matrix --------------------------------------------------------------------------------

/// A camera at the origin that looks down -z.
fn eye_camera(projection: Projection) -> Camera {
    Camera {
        eye: DVec3::ZERO,
        target: DVec3::NEG_Z,
        up: DVec3::Y,
        projection,
        near: 1.0,
        far: Some(20.0),
    }
}

/// Two coloured triangles that cross the near plane and each other, and a ball.
fn sample_scene(projection: Projection) -> Scene {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (96, 64);
    scene.camera = eye_camera(projection);
    scene.lights.push(Light {
        name: "key".into(),
        source: LightSource {
            position: [1.0, 2.0, 3.0, 0.0],
            ..LightSource::default()
        },
        space: LightSpace::Eye,
        enabled: true,
    });
    scene.light_model.two_sided = true;
    let tracked = gl::ColorMaterial::default().tracked(false);
    scene.materials.push(Material {
        name: "tracks".into(),
        front: gl::Material {
            tracked,
            specular: [0.5; 3],
            shininess: 8.0,
            ..gl::Material::default()
        },
        back: Some(gl::Material {
            diffuse: [0.1, 0.2, 0.9],
            ..gl::Material::default()
        }),
        optics: Optics::default(),
    });
    let mesh = Mesh {
        positions: [
            [-3.0, -1.0, 0.5],
            [3.0, -1.0, -2.0],
            [0.0, 2.0, -9.0],
            [-2.0, 0.0, -9.0],
            [2.0, -1.5, -3.0],
            [2.0, 2.0, -6.0],
        ]
        .map(DVec3::from_array)
        .to_vec(),
        colors: vec![
            [1.0, 0.0, 0.0, 1.0],
            [0.0, 1.0, 0.0, 1.0],
            [0.0, 0.0, 1.0, 1.0],
            [1.0, 1.0, 0.0, 1.0],
            [0.0, 1.0, 1.0, 1.0],
            [1.0, 0.0, 1.0, 1.0],
        ],
        triangles: vec![[0, 1, 2], [5, 4, 3]],
        ..Mesh::default()
    };
    let ball = Shape::Sphere {
        center: DVec3::new(-1.0, 0.5, -4.0),
        radius: 0.8,
    };
    for geometry in [Geometry::Mesh(Arc::new(mesh)), Geometry::Shape(ball)] {
        scene.objects.push(Object {
            name: format!("object {}", scene.objects.len()),
            geometry,
            materials: vec![0],
            world_from_object: DAffine3::IDENTITY,
            tessellation: Some(12),
        });
    }
    scene
}

fn rasterized(scene: &Scene) -> Frame<f64> {
    let assembly = Assembly::new(scene, None).unwrap();
    let options = raster::Options {
        shading: ShadeModel::Phong,
        clamp: false,
        layers: false,
        isa: Isa::detect(),
    };
    let plan = raster::Plan::new(scene, &assembly, Model::Required);
    plan.draw(&options).unwrap().0
}

fn cast(scene: &Scene) -> Frame<f64> {
    let assembly = Assembly::new(scene, None).unwrap();
    let plan = trace::Plan::new(scene, &assembly, trace::Geometry::Mesh, Model::Required).unwrap();
    plan.draw(&trace::Options::cast(Isa::detect())).unwrap().0
}

/// Projection matrices of every form, all of which see the sample scene.
fn matrices() -> Vec<(&'static str, DMat4)> {
    let aspect = 1.5;
    let view = |p: Projection| eye_camera(p).clip_from_eye(aspect);
    let perspective = view(Projection::Perspective { fovy_deg: 60.0 });
    let ortho = view(Projection::Orthographic { height: 5.0 });
    let shift = DMat4::from_translation(DVec3::new(0.25, -0.125, 0.0));
    vec![
        ("perspective", perspective),
        ("scaled", perspective * 7.0),
        ("off centre", shift * perspective),
        ("orthographic", ortho),
        (
            "behind the eye",
            ortho * DMat4::from_translation(DVec3::NEG_Z * 3.0),
        ),
        (
            "turned",
            perspective * DMat4::from_rotation_y(0.2) * DMat4::from_rotation_x(0.1),
        ),
        (
            "mirrored",
            DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)) * perspective,
        ),
        (
            "farthest first",
            DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0)) * perspective,
        ),
    ]
}

#[test]
fn both_renderers_see_the_same_through_any_matrix() {
    for (name, matrix) in matrices() {
        let scene = sample_scene(Projection::Matrix(matrix));
        let options = Options {
            level: None,
            isa: Isa::detect(),
            model: Model::Required,
            shadows: true,
            reflection: true,
            refraction: true,
        };
        let ladder = decompose::<f64>(&scene, &options, &|_| {}).unwrap();
        let agreement = ladder.agreement;
        assert_eq!(ladder.residual_max, 0.0, "{name}");
        assert!(agreement.interior_max <= 1e-9, "{name}: {agreement:?}");
        assert_eq!(agreement.coverage.raster_only, 0, "{name}: {agreement:?}");
        assert_eq!(agreement.coverage.trace_only, 0, "{name}: {agreement:?}");
        assert!(agreement.coverage.both > 1000, "{name}: {agreement:?}");
    }
}

#[test]
fn a_matrix_draws_what_the_camera_in_words_draws() {
    for projection in [
        Projection::Perspective { fovy_deg: 60.0 },
        Projection::Orthographic { height: 5.0 },
    ] {
        let words = sample_scene(projection);
        let matrix = eye_camera(projection).clip_from_eye(1.5);
        let numbers = sample_scene(Projection::Matrix(matrix));
        for (a, b) in [
            (rasterized(&words), rasterized(&numbers)),
            (cast(&words), cast(&numbers)),
        ] {
            assert_eq!(a.primitive, b.primitive);
            let pairs = a
                .color
                .data
                .iter()
                .flatten()
                .zip(b.color.data.iter().flatten());
            let largest = pairs.fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(largest < 1e-9, "{projection:?}: {largest:e}");
        }
    }
}

#[test]
fn a_matrix_without_inverse_shows_nothing() {
    let flat = DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let scene = sample_scene(Projection::Matrix(flat));
    for frame in [rasterized(&scene), cast(&scene)] {
        assert!(frame.primitive.data.iter().all(|p| *p == NONE));
    }
}

#[test]
fn depth_reversed_shows_the_farthest_and_mirroring_turns_facing() {
    let perspective = matrices()[0].1;
    let [near, far] =
        [perspective, matrices()[7].1].map(|m| rasterized(&sample_scene(Projection::Matrix(m))));
    let deeper = near.depth.data.iter().zip(&far.depth.data);
    assert!(deeper.clone().all(|(n, f)| n <= f) && deeper.clone().any(|(n, f)| n < f));
    // Culling back faces of the mirror image leaves what culling front faces leaves of the picture, column for column.
    let culled = |matrix, cull| {
        let mut scene = sample_scene(Projection::Matrix(matrix));
        scene.objects.truncate(1);
        scene.raster.cull = cull;
        rasterized(&scene).primitive
    };
    let picture = culled(perspective, Cull::Front);
    let mirror = culled(matrices()[6].1, Cull::Back);
    let row =
        |plane: &rastray::frame::Plane<u32>, y: usize| plane.data[y * 96..(y + 1) * 96].to_vec();
    let mut different = 0;
    for y in 0..64 {
        let mut turned = row(&mirror, y);
        turned.reverse();
        different += turned
            .iter()
            .zip(row(&picture, y))
            .filter(|(a, b)| **a != *b)
            .count();
    }
    assert!(different == 0 && picture.data.contains(&1), "{different}");
    assert!(Camera::default().ray_range(DVec2::ZERO, 1, 1)[1].is_infinite());
}
