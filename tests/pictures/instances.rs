//! Meshes that several objects share: one hierarchy for all, and the same answers as copies of their own.

use std::sync::Arc;

use rastray::gl;
use rastray::lanes::Isa;
use rastray::math::{DAffine3, DMat3, DVec3};
use rastray::scene::tessellate::tessellate;
use rastray::scene::{
    Camera, Geometry as Form, Light, LightSpace, Material, Mesh, Object, Optics, Scene, Shape,
};
use rastray::trace::bvh::Walker;
use rastray::trace::ray::Ray;
use rastray::trace::{Geometry, Options};

use crate::common::precise::{Precise, assembled, follow, surfaces, tracer};
use rastray::render::{Assembled, Tracer};

/// Numbers that look random, the same in each run.
struct Random(u64);

impl Random {
    /// Uniform in -1..1.
    fn signed(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// A closed mesh with noise, so that no two of its edges are in line.
fn noisy_ball() -> Mesh {
    let shape = Shape::Sphere {
        center: DVec3::ZERO,
        radius: 1.0,
    };
    let mut mesh = tessellate(&shape, 24, 1);
    let mut random = Random(5);
    // Seam and poles repeat positions: equal places get equal noise.
    let mut known: Vec<(DVec3, DVec3)> = Vec::new();
    for p in &mut mesh.positions {
        let moved = match known.iter().find(|(q, _)| q == p) {
            Some((_, moved)) => *moved,
            None => *p * (1.0 + 0.1 * random.signed()),
        };
        known.push((*p, moved));
        *p = moved;
    }
    mesh
}

/// Rigid, stretched, mirrored and sheared places, apart from each other.
fn places() -> Vec<DAffine3> {
    let turn = DMat3::from_axis_angle(DVec3::ONE.normalize(), 0.7);
    let shear = DMat3::from_cols(
        DVec3::X,
        DVec3::new(0.5, 1.0, 0.0),
        DVec3::new(0.2, 0.1, 1.0),
    );
    let forms = [
        DMat3::IDENTITY,
        turn,
        DMat3::from_diagonal(DVec3::new(1.0, 0.3, 0.8)),
        turn * DMat3::from_diagonal(DVec3::new(-0.9, 0.9, 0.9)),
        shear,
        DMat3::from_diagonal(DVec3::new(0.01, 0.9, 0.9)),
    ];
    let place = |(i, m): (usize, &DMat3)| {
        DAffine3::from_mat3_translation(*m, DVec3::new(3.0 * i as f64 - 7.5, 0.25, -0.5))
    };
    forms.iter().enumerate().map(place).collect()
}

/// The mesh at each place; `shared` = all hold one mesh.
fn scene_of(mesh: &Mesh, places: &[DAffine3], shared: bool) -> Scene {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (480, 180);
    scene.camera = Camera {
        eye: DVec3::new(1.0, 6.0, 14.0),
        target: DVec3::ZERO,
        near: 0.1,
        ..Camera::default()
    };
    scene.materials.push(Material {
        name: "clay".into(),
        front: gl::Material::default(),
        back: None,
        optics: Optics::default(),
    });
    scene.lights.push(Light {
        name: "key".into(),
        source: gl::LightSource {
            position: [4.0, 9.0, 6.0, 1.0],
            ..gl::LightSource::default()
        },
        space: LightSpace::World,
        enabled: true,
    });
    let one = Arc::new(mesh.clone());
    for (i, place) in places.iter().enumerate() {
        let mesh = if shared {
            Arc::clone(&one)
        } else {
            Arc::new(mesh.clone())
        };
        scene.objects.push(Object {
            name: format!("copy {i}"),
            geometry: Form::Mesh(mesh),
            materials: vec![0],
            world_from_object: *place,
            tessellation: None,
            priority: 0,
        });
    }
    scene
}

fn plan<'a>(scene: &'a Scene, assembly: &'a Assembled) -> Tracer<'a> {
    tracer(scene, assembly, Geometry::Exact).expect("plans")
}

/// Random rays, and rays aimed at the places of vertices and edges' middles.
fn rays(mesh: &Mesh, places: &[DAffine3], count: usize) -> Vec<Ray> {
    let mut random = Random(11);
    let ray = |i: usize| {
        let origin = random.vector() * DVec3::new(12.0, 5.0, 5.0);
        let triangle = mesh.triangles[i * 7 % mesh.triangles.len()];
        let [a, b, _] = triangle.map(|v| mesh.positions[v as usize]);
        let place = &places[i % places.len()];
        let target = match i % 3 {
            0 => random.vector() * DVec3::new(9.0, 1.0, 1.0),
            1 => place.transform_point3(a),
            _ => place.transform_point3(a + 0.5 * (b - a)),
        };
        Ray::new(origin, target - origin)
    };
    (0..count).map(ray).collect()
}

fn answers_equal_brute_force<R: Precise>() {
    let (mesh, places) = (noisy_ball(), places());
    let scene = scene_of(&mesh, &places, true);
    let assembly = assembled::<R>(&scene, None).expect("assembles");
    let plan = plan(&scene, &assembly);
    let (surfaces, mut walker) = (surfaces::<R>(&plan), Walker::default());
    let mut found = 0;
    for ray in rays(&mesh, &places, 6000) {
        let nearest = surfaces.closest_hit(&ray, &mut walker);
        assert_eq!(nearest, surfaces.closest_hit_of_all(&ray), "{ray:?}");
        assert_eq!(nearest.is_some(), surfaces.any_hit(&ray, &mut walker));
        let all = surfaces
            .crossings(&ray, &mut walker, |_| true)
            .expect("no stop");
        assert_eq!(all.first().copied(), nearest);
        found += usize::from(nearest.is_some());
    }
    assert!(found > 3000, "{found}");
}

#[test]
fn both_levels_equal_brute_force() {
    answers_equal_brute_force::<f32>();
    answers_equal_brute_force::<f64>();
}

#[test]
fn copies_share_one_hierarchy() {
    let (mesh, places) = (noisy_ball(), places());
    let size = |places: &[DAffine3], shared: bool| {
        let scene = scene_of(&mesh, places, shared);
        let assembly = assembled::<f32>(&scene, None).expect("assembles");
        surfaces::<f32>(&plan(&scene, &assembly)).hierarchy_size()
    };
    let (one, all, own) = (
        size(&places[..1], true),
        size(&places, true),
        size(&places, false),
    );
    // One node more, with a leaf or more for the six boxes.
    assert_eq!(all.0, one.0 + 1);
    assert!(all.1 <= one.1 + places.len(), "{all:?} {one:?}");
    assert!(own.0 > 5 * one.0, "{own:?} {one:?}");
}

/// From inside each copy every ray gets out, and entering minus leaving is one; from outside it is zero.
#[test]
fn closed_copies_do_not_leak() {
    let (mesh, places) = (noisy_ball(), places());
    let scene = scene_of(&mesh, &places, true);
    let assembly = assembled::<f64>(&scene, None).expect("assembles");
    let plan = plan(&scene, &assembly);
    let mut walker = Walker::default();
    let mut balance = |ray: &Ray| -> i32 {
        let hits = surfaces::<f64>(&plan).crossings(ray, &mut walker, |_| true);
        let sign = |back: bool| if back { 1 } else { -1 };
        hits.expect("no stop")
            .iter()
            .map(|hit| sign(hit.back))
            .sum()
    };
    // A mirrored mesh shows its back outside, as in GL: inside and outside change places.
    let mirrored = |place: &DAffine3| place.matrix3.determinant() < 0.0;
    for (i, ray) in rays(&mesh, &places, 6000).into_iter().enumerate() {
        let place = &places[i % places.len()];
        let inside = Ray::new(place.translation, ray.direction);
        let expected = if mirrored(place) { -1 } else { 1 };
        assert_eq!(balance(&inside), expected, "{inside:?}");
        let outside = Ray::new(ray.origin + DVec3::Y * 30.0, ray.direction);
        assert_eq!(balance(&outside), 0, "{outside:?}");
    }
}

fn pictures_agree<R: Precise>(tolerance: f64) {
    let (mesh, places) = (noisy_ball(), places());
    let draw = |shared: bool| {
        let scene = scene_of(&mesh, &places, shared);
        let assembly = assembled::<R>(&scene, None).expect("assembles");
        let options = Options::of(&scene, Isa::Scalar);
        follow::<R>(&plan(&scene, &assembly), &options)
            .expect("draws")
            .0
    };
    let (shared, own) = (draw(true), draw(false));
    let pairs = shared.color.data.iter().zip(&own.color.data);
    let differing = pairs
        .filter(|(a, b)| (0..3).any(|k| (a[k].to_f64() - b[k].to_f64()).abs() > tolerance))
        .count();
    let covered = own.object.data.iter().filter(|o| **o != u32::MAX).count();
    assert!(covered > 1000, "{covered}");
    // At an edge, or where a shadow ends, a rounding may decide otherwise.
    assert!(differing <= 2, "{differing} of {covered}");
}

#[test]
fn shadows_and_facing_are_those_of_copies_of_their_own() {
    pictures_agree::<f32>(1e-4);
    pictures_agree::<f64>(1e-11);
}

/// A transform that would lose bits on the way back keeps triangles in world space; hits are there all the same.
#[test]
fn nearly_flat_copies_keep_triangles_of_their_own() {
    let mesh = noisy_ball();
    let flat = DAffine3::from_scale(DVec3::new(1.0, 1e-9, 1.0));
    let scene = scene_of(&mesh, &[DAffine3::IDENTITY, flat], true);
    let assembly = assembled::<f64>(&scene, None).expect("assembles");
    let plan = plan(&scene, &assembly);
    let ray = Ray::new(DVec3::new(0.1, 5.0, 0.1), DVec3::NEG_Y);
    let hits = surfaces::<f64>(&plan)
        .crossings(&ray, &mut Walker::default(), |_| true)
        .expect("no stop");
    assert_eq!(hits.len(), 4);
    let objects: Vec<u32> = hits
        .iter()
        .map(|hit| surfaces::<f64>(&plan).object(hit))
        .collect();
    assert_eq!(objects, [0, 1, 1, 0]);
}
