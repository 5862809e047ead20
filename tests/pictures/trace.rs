//! The tracer against brute force, the numerics cases, and laws that every picture obeys; `tests/pictures/whitted` holds it to
//! closed forms. Most pictures here are one pixel: an orthographic camera whose single ray is known exactly.

use crate::common::precise::{Precise, assembled, follow, surfaces, tracer};
use crate::common::scale::scaled;
use crate::probe::rays;
use rastray::error::Error;
use rastray::frame::NONE;
use rastray::gl;
use rastray::lanes::Isa;
use rastray::math::{DAffine3, DMat3, DVec3};
use rastray::scene::{
    Camera, Geometry as Form, Light, LightSpace, Material, Mesh, Object, Optics, Projection, Scene,
    Shape,
};
use rastray::trace::build::Bounds;
use rastray::trace::bvh::{Bvh, Walker};
use rastray::trace::planar::Shear;
use rastray::trace::ray::Ray;
use rastray::trace::{Counters, Geometry, Options};
use serde_json::Value;
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A scene of one pixel whose ray starts at `eye` and goes towards `target`. No lights, no ambient.
fn one_ray(eye: DVec3, target: DVec3) -> Scene {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (1, 1);
    scene.light_model.ambient = [0.0; 3];
    let direction = (target - eye).normalize();
    scene.camera = Camera {
        eye,
        target,
        up: direction.any_orthonormal_vector(),
        projection: Projection::Orthographic { height: 1.0 },
        near: 1e-6,
        far: None,
    };
    scene
}

fn black() -> gl::Material {
    gl::Material {
        ambient: [0.0; 3],
        diffuse: [0.0; 3],
        ..gl::Material::default()
    }
}

/// Adds a material and says its number.
fn material(scene: &mut Scene, front: gl::Material, optics: Optics) -> usize {
    scene.materials.push(Material {
        name: format!("m{}", scene.materials.len()),
        front,
        back: None,
        optics,
    });
    scene.materials.len() - 1
}

fn glowing(scene: &mut Scene, e: f64) -> usize {
    let front = gl::Material {
        emission: [e; 3],
        ..black()
    };
    material(scene, front, Optics::default())
}

fn add(scene: &mut Scene, shape: Shape, materials: &[usize]) -> usize {
    scene.objects.push(Object {
        name: format!("o{}", scene.objects.len()),
        geometry: Form::Shape(shape),
        materials: materials.to_vec(),
        world_from_object: DAffine3::IDENTITY,
        tessellation: None,
        priority: 0,
    });
    scene.objects.len() - 1
}

fn add_mesh(scene: &mut Scene, mesh: Mesh, material: usize) {
    scene.objects.push(Object {
        name: format!("o{}", scene.objects.len()),
        geometry: Form::Mesh(Arc::new(mesh)),
        materials: vec![material],
        world_from_object: DAffine3::IDENTITY,
        tessellation: None,
        priority: 0,
    });
}

fn sphere(center: DVec3, radius: f64) -> Shape {
    Shape::Sphere { center, radius }
}

fn light(scene: &mut Scene, position: [f64; 4]) {
    let name = format!("l{}", scene.lights.len());
    let source = gl::LightSource {
        position,
        ..gl::LightSource::default()
    };
    scene.lights.push(Light {
        name,
        source,
        space: LightSpace::World,
        enabled: true,
    });
}

fn options(scene: &Scene) -> Options {
    Options::of(scene, Isa::Scalar)
}

fn try_draw<R: Precise>(
    scene: &Scene,
    geometry: Geometry,
    options: &Options,
) -> Result<(rastray::frame::Frame<R>, Counters), Box<Error>> {
    let assembly = assembled::<R>(scene, Some(16))?;
    let plan = tracer(scene, &assembly, geometry)?;
    Ok(follow(&plan, options)?)
}

/// The one pixel's green, f64, exact shapes.
fn seen(scene: &Scene) -> f64 {
    let (frame, _) = try_draw::<f64>(scene, Geometry::Exact, &options(scene)).unwrap();
    frame.color.data[0][1]
}

// ---- Shadows -----------------------------------------------------------------------------------------------------

/// A white floor y = 0 looked at straight down at (x, z); 0 where it is in shadow.
fn floor_at(x: f64, z: f64) -> Scene {
    let mut scene = one_ray(v(x, 0.5, z), v(x, 0.0, z));
    let white = material(&mut scene, gl::Material::default(), Optics::default());
    let shape = Shape::Patch {
        corner: v(-50.0, 0.0, -50.0),
        edge_u: v(0.0, 0.0, 100.0),
        edge_v: v(100.0, 0.0, 0.0),
        tiles: [1, 1],
    };
    add(&mut scene, shape, &[white]);
    scene
}

#[test]
fn rays_that_cannot_matter_are_not_cast() {
    let count = |change: fn(&mut Scene)| {
        let mut scene = floor_at(0.0, 0.0);
        light(&mut scene, [0.0, 9.0, 0.0, 1.0]);
        light(&mut scene, [0.0, -9.0, 0.0, 1.0]);
        change(&mut scene);
        try_draw::<f32>(&scene, Geometry::Exact, &options(&scene))
            .unwrap()
            .1
            .rays
    };
    let base = count(|_| {});
    assert_eq!(
        (base.primary, base.shadow),
        (1, 1),
        "only the light above faces the floor"
    );
    let dark = |s: &mut Scene| s.materials[0].front.diffuse = [0.0; 3];
    assert_eq!(count(dark).shadow, 0);
    assert_eq!(count(|s| s.lights[0].source.diffuse = [0.0; 3]).shadow, 0);
    let shiny = |s: &mut Scene| {
        s.materials[0].front.diffuse = [0.0; 3];
        s.materials[0].front.specular = [0.0, 0.0, 0.5];
    };
    assert_eq!(count(shiny).shadow, 1);
    assert_eq!((base.reflection, base.refraction), (0, 0));
}

// ---- Facing --------------------------------------------------------------------------------------------------------

#[test]
fn two_sided_lighting_flips_the_back() {
    for (two_sided, above, expected) in [
        (false, false, 0.8),
        (true, false, 0.0),
        (true, true, 0.8),
        (false, true, 0.8),
    ] {
        for geometry in [Geometry::Exact, Geometry::Mesh] {
            // Looked at from below, or above; lit from above: the front is +y.
            let mut scene = floor_at(0.0, 0.0);
            if !above {
                scene.camera.eye = v(0.0, -0.5, 0.0);
            }
            light(&mut scene, [0.0, 9.0, 0.0, 1.0]);
            scene.light_model.two_sided = two_sided;
            scene.materials[0].back = Some(gl::Material {
                emission: [0.0, 0.0, 0.125],
                ..scene.materials[0].front.clone()
            });
            let asked = Options::cast(Isa::Scalar);
            let (frame, _) = try_draw::<f64>(&scene, geometry, &asked).unwrap();
            let c = frame.color.data[0];
            assert_eq!(c[1], expected, "two-sided {two_sided}, above {above}");
            assert_eq!(c[2] - c[1], if two_sided && !above { 0.125 } else { 0.0 });
        }
    }
}

#[test]
fn a_mirrored_mesh_turns_its_facing_and_a_mirrored_shape_does_not() {
    let back_seen = |mesh: bool, geometry: Geometry| {
        let mut scene = one_ray(v(0.1, 0.2, 3.0), v(0.1, 0.2, 0.0));
        scene.light_model.two_sided = true;
        let m = glowing(&mut scene, 0.5);
        scene.materials[m].back = Some(black());
        let (corner, edge_u, edge_v) = (v(-1.0, -1.0, 0.0), v(2.0, 0.0, 0.0), v(0.0, 2.0, 0.0));
        let tiles = [1, 1];
        let shape = Shape::Patch {
            corner,
            edge_u,
            edge_v,
            tiles,
        };
        let object = add(&mut scene, shape.clone(), &[m]);
        if mesh {
            let mesh = rastray::scene::tessellate::tessellate(&shape, 4, 1);
            scene.objects[object].geometry = Form::Mesh(Arc::new(mesh));
        }
        scene.objects[object].world_from_object = DAffine3::from_scale(v(-1.0, 1.0, 1.0));
        let asked = options(&scene);
        try_draw::<f32>(&scene, geometry, &asked)
            .unwrap()
            .0
            .color
            .data[0][0]
            == 0.0
    };
    assert!(back_seen(true, Geometry::Exact) && back_seen(true, Geometry::Mesh));
    assert!(!back_seen(false, Geometry::Exact) && !back_seen(false, Geometry::Mesh));
}

// ---- Sums, order, limits -------------------------------------------------------------------------------------------

/// Everything at once: three spheres (one glass, one mirror, one stretched), a box, a mesh, a checkered floor, two lights.
/// A disk, a cylinder, a cone and a torus in the back.
fn round(radius: f64) -> [(Shape, usize); 4] {
    let (center, base) = (v(-2.5, 1.0, -1.0), v(0.5, 0.25, 2.5));
    let axis = v(0.25, 0.5, 1.0);
    let disk = Shape::Disk {
        center,
        normal: axis,
        radius,
    };
    let cylinder = Shape::Cylinder {
        base,
        top: base + axis,
        radius,
        caps: true,
    };
    let base = v(2.5, 0.25, 2.5);
    let cone = Shape::Cone {
        base,
        apex: base + axis,
        radius,
        cap: false,
    };
    let torus = Shape::Torus {
        center: v(-2.0, 0.5, 2.0),
        axis,
        major: radius,
        minor: radius / 4.0,
    };
    [(disk, 0), (cylinder, 1), (cone, 2), (torus, 3)]
}

fn busy() -> Scene {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (45, 37);
    scene.image.background = [0.1, 0.2, 0.4];
    scene.camera = Camera {
        eye: v(0.3, 2.0, 6.0),
        target: v(0.0, 0.8, 0.0),
        ..Camera::default()
    };
    let shiny = |diffuse: [f64; 3]| gl::Material {
        diffuse,
        ambient: diffuse,
        specular: [0.4; 3],
        shininess: 20.0,
        ..gl::Material::default()
    };
    let clear = Optics {
        reflection: [0.1; 3],
        transmission: [0.8, 0.85, 0.9],
        ior: 1.5,
        ..Optics::default()
    };
    let mirror = Optics {
        reflection: [0.7, 0.6, 0.5],
        ..Optics::default()
    };
    let white = material(&mut scene, shiny([0.8; 3]), Optics::default());
    let red = material(&mut scene, shiny([0.8, 0.1, 0.1]), Optics::default());
    let glass = material(&mut scene, shiny([0.02; 3]), clear);
    let silver = material(&mut scene, shiny([0.1; 3]), mirror);
    let floor = Shape::Patch {
        corner: v(-6.0, 0.0, -6.0),
        edge_u: v(0.0, 0.0, 12.0),
        edge_v: v(12.0, 0.0, 0.0),
        tiles: [12, 12],
    };
    add(&mut scene, floor, &[white, red]);
    add(&mut scene, sphere(v(-1.1, 1.0, 0.4), 1.0), &[glass]);
    add(&mut scene, sphere(v(1.2, 1.0, -0.8), 1.0), &[silver]);
    let (min, max) = (v(0.3, 0.0, 0.9), v(0.9, 0.5, 1.5));
    let cube = add(&mut scene, Shape::Box { min, max }, &[red]);
    scene.objects[cube].world_from_object = DAffine3::from_rotation_y(0.4);
    for (shape, m) in round(0.5) {
        let turned = add(&mut scene, shape, &[[red, glass, silver, white][m]]);
        scene.objects[turned].world_from_object =
            DAffine3::from_scale(v(1.0, 1.0, -1.25)) * DAffine3::from_rotation_x(0.7);
    }
    let egg = add(&mut scene, sphere(DVec3::ZERO, 0.4), &[white]);
    scene.objects[egg].world_from_object = DAffine3::from_scale_rotation_translation(
        v(1.0, 1.7, 0.6),
        glam::DQuat::from_rotation_z(0.5),
        v(-0.2, 0.7, 1.9),
    );
    let mesh = rastray::scene::tessellate::tessellate(&sphere(v(2.2, 0.5, 0.9), 0.5), 12, 1);
    add_mesh(&mut scene, mesh, glass);
    light(&mut scene, [4.0, 6.0, 5.0, 1.0]);
    light(&mut scene, [-0.3, 1.0, 0.2, 0.0]);
    scene.lights[1].source.diffuse = [0.3, 0.3, 0.35];
    scene
}

fn layers_add_up<R: Precise>(scene: &Scene) {
    for geometry in [Geometry::Exact, Geometry::Mesh] {
        let assembly = assembled::<R>(scene, Some(16)).unwrap();
        let plan = tracer(scene, &assembly, geometry).unwrap();
        let mut asked = options(scene);
        let (plain, _) = follow::<R>(&plan, &asked).unwrap();
        asked.layers = true;
        let (frame, counters) = follow::<R>(&plan, &asked).unwrap();
        assert_eq!(
            plain.color, frame.color,
            "layers change no byte of the picture"
        );
        let layers = frame.layers.unwrap();
        assert!(counters.rays.reflection > 0 && counters.rays.refraction > 0);
        for pixel in 0..frame.color.data.len() {
            assert_eq!(layers.sum(pixel), frame.color.data[pixel], "pixel {pixel}");
        }
        let rest = &layers.planes.last().unwrap().data;
        if scene.image.samples == 1 {
            assert!(rest.iter().flatten().all(|x| *x == R::ZERO));
        }
        for name in ["reflection", "refraction"] {
            let k = layers.names.iter().position(|n| n == name).unwrap();
            assert!(layers.planes[k].data.iter().any(|c| c[1] > R::ZERO));
        }
    }
}

#[test]
fn layers_add_up_to_the_picture_bit_for_bit() {
    let mut scene = busy();
    layers_add_up::<f32>(&scene);
    layers_add_up::<f64>(&scene);
    scene.image.samples = 4;
    layers_add_up::<f32>(&scene);
    scene.lights[1].source.diffuse = [-0.3, 0.2, 0.1];
    layers_add_up::<f32>(&scene);
    scene.image.samples = 1;
    layers_add_up::<f32>(&scene);
    layers_add_up::<f64>(&scene);
}

#[test]
fn threads_and_tiles_change_no_byte() {
    let mut scene = busy();
    scene.image.samples = 2;
    let draw = |threads: usize, tile: u32| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let assembly = assembled::<f32>(&scene, None).unwrap();
            let plan = tracer(&scene, &assembly, Geometry::Mesh).unwrap();
            let asked = Options {
                layers: true,
                ..options(&scene)
            };
            let drawn = plan.draw_tiles(&asked, tile).unwrap();
            (drawn.picture, drawn.counters)
        })
    };
    let first = draw(1, 16);
    for (threads, tile) in [(8, 16), (2, 1), (1, 64), (3, 7)] {
        assert_eq!(
            first,
            draw(threads, tile),
            "{threads} threads, tiles of {tile}"
        );
    }
}

#[test]
fn scaling_by_powers_of_two_changes_no_bit() {
    let reference = busy();
    let (expected, _) = try_draw::<f32>(&reference, Geometry::Mesh, &options(&reference)).unwrap();
    let (expected_exact, _) =
        try_draw::<f32>(&reference, Geometry::Exact, &options(&reference)).unwrap();
    for power in [-20, -3, 5, 26] {
        let k = libm::exp2(f64::from(power));
        let scene = scaled(&reference, k);
        let (frame, _) = try_draw::<f32>(&scene, Geometry::Mesh, &options(&scene)).unwrap();
        assert_eq!(frame.color, expected.color, "2^{power}, mesh");
        let (frame, _) = try_draw::<f32>(&scene, Geometry::Exact, &options(&scene)).unwrap();
        assert_eq!(frame.color, expected_exact.color, "2^{power}, exact");
    }
}

#[test]
fn runaway_trees_end_in_a_clear_error() {
    let mut scene = one_ray(v(0.2, 0.3, 4.0), v(0.1, 0.1, 0.0));
    let optics = Optics {
        reflection: [1.0; 3],
        transmission: [1.0; 3],
        ior: 1.1,
        ..Optics::default()
    };
    let m = material(&mut scene, black(), optics);
    for x in [-1.0, 1.0] {
        for z in [-1.5, 1.5] {
            add(&mut scene, sphere(v(x, 0.0, z), 0.9), &[m]);
        }
    }
    let (min, max) = (DVec3::splat(-3.0), DVec3::splat(3.0));
    add(&mut scene, Shape::Box { min, max }, &[m]);
    scene.trace.depth = 200;
    let error = try_draw::<f32>(&scene, Geometry::Exact, &options(&scene)).unwrap_err();
    assert!(matches!(*error, Error::Limit { .. }), "{error}");
    assert!(error.to_string().contains("pixel 0 0") && error.help().is_some());
    let secondary = Options {
        refraction: false,
        ..options(&scene)
    };
    try_draw::<f32>(&scene, Geometry::Exact, &secondary).unwrap();
}

#[test]
fn near_and_far_reject_as_clipping_does() {
    for (near, far, expected) in [
        (1.0, None, 0.5),
        (1.5, None, 0.25),
        (1.0, Some(1.2), 0.5),
        (1.3, Some(1.8), 0.0),
    ] {
        let mut scene = one_ray(v(0.0, 0.0, 2.0), DVec3::ZERO);
        let (a, b) = (glowing(&mut scene, 0.5), glowing(&mut scene, 0.25));
        for (z, m) in [(1.0, a), (0.0, b)] {
            let corner = v(-1.0, -1.0, z);
            let (edge_u, edge_v, tiles) = (v(2.0, 0.0, 0.0), v(0.0, 2.0, 0.0), [1, 1]);
            let shape = Shape::Patch {
                corner,
                edge_u,
                edge_v,
                tiles,
            };
            add(&mut scene, shape, &[m]);
        }
        (scene.camera.near, scene.camera.far) = (near, far);
        assert_eq!(seen(&scene), expected, "{near} {far:?}");
    }
}

#[test]
fn of_equal_depths_the_lowest_primitive_wins() {
    for geometry in [Geometry::Exact, Geometry::Mesh] {
        for shape in [
            sphere(DVec3::ZERO, 1.0),
            Shape::Box {
                min: DVec3::NEG_ONE,
                max: DVec3::ONE,
            },
            Shape::Patch {
                corner: v(-1.0, -1.0, 0.5),
                edge_u: v(2.0, 0.0, 0.0),
                edge_v: v(0.0, 2.0, 0.0),
                tiles: [3, 3],
            },
        ] {
            let mut scene = one_ray(v(0.17, 0.23, 4.0), v(0.17, 0.23, 0.0));
            (scene.image.width, scene.image.height) = (9, 9);
            let materials = [0.5, 0.25, 0.125].map(|e| glowing(&mut scene, e));
            for m in materials {
                add(&mut scene, shape.clone(), &[m]);
            }
            let (frame, _) = try_draw::<f32>(&scene, geometry, &options(&scene)).unwrap();
            let mut seen = 0;
            for (object, color) in frame.object.data.iter().zip(&frame.color.data) {
                assert!(*object == 0 || *object == NONE);
                assert_eq!(color[0], if *object == 0 { 0.5 } else { 0.0 });
                seen += u32::from(*object == 0);
            }
            assert!(seen > 40);
        }
    }
}

#[test]
fn empty_scenes_show_the_background_and_empty_pictures_are_refused() {
    let mut scene = one_ray(v(0.0, 0.0, 2.0), DVec3::ZERO);
    scene.image.background = [0.5; 3];
    assert_eq!(seen(&scene), 0.5);
    scene.image.width = 0;
    let error = try_draw::<f32>(&scene, Geometry::Mesh, &options(&scene)).unwrap_err();
    assert!(matches!(*error, Error::Parameter { .. }));
}

#[test]
fn poisoned_numbers_make_no_panic_and_no_nan() {
    let poison = [
        f64::NAN,
        f64::INFINITY,
        -f64::INFINITY,
        -0.0,
        1e-310,
        f64::from(f32::MAX),
        1e300,
    ];
    for x in poison {
        for place in 0..5 {
            let mut scene = busy();
            (scene.image.width, scene.image.height) = (12, 9);
            scene.trace.depth = 3;
            match place {
                0 => scene.objects[1].geometry = Form::Shape(sphere(v(x, 1.0, 0.4), 1.0)),
                1 => scene.objects[1].geometry = Form::Shape(sphere(v(-1.1, 1.0, 0.4), x)),
                2 => scene.objects[3].world_from_object.matrix3.x_axis.x = x,
                3 => {
                    scene.objects[0].geometry = Form::Shape(Shape::Patch {
                        corner: v(-6.0, 0.0, -6.0),
                        edge_u: v(0.0, x, 12.0),
                        edge_v: v(12.0, 0.0, 0.0),
                        tiles: [12, 12],
                    })
                }
                _ => scene.objects[4].world_from_object.translation.y = x,
            }
            for geometry in [Geometry::Exact, Geometry::Mesh] {
                let (frame, _) = try_draw::<f32>(&scene, geometry, &options(&scene)).unwrap();
                let finite = frame.color.data.iter().flatten().all(|c| c.is_finite());
                assert!(finite, "{x} at {place}, {geometry:?}");
            }
        }
    }
}

// ---- Hierarchy and watertightness ------------------------------------------------------------------------------------

/// A generator with a fixed seed (SplitMix64): tests repeat.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In -1..1.
    fn signed(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    fn point(&mut self) -> DVec3 {
        v(self.signed(), self.signed(), self.signed())
    }
}

/// Triangles on a coarse grid (many axis-parallel, many shared vertices), needles, and exact shapes.
fn cluttered(random: &mut Random) -> Scene {
    let mut scene = Scene::default();
    let m = glowing(&mut scene, 1.0);
    let mut mesh = Mesh::default();
    for i in 0..240 {
        let base = (random.point() * 8.0).round() / 4.0;
        let size = if i % 3 == 0 { 0.05 } else { 1.0 };
        let corners = [0; 3].map(|_| {
            let p = base + random.point() * size;
            if i % 2 == 0 {
                (p * 4.0).round() / 4.0
            } else {
                p
            }
        });
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    add_mesh(&mut scene, mesh, m);
    for i in 0..20 {
        let center = (random.point() * 8.0).round() / 4.0;
        let shape = match i % 3 {
            0 => sphere(center, 0.25),
            1 => Shape::Box {
                min: center,
                max: center + DVec3::splat(0.5),
            },
            _ => Shape::Patch {
                corner: center,
                edge_u: v(0.75, 0.0, 0.0),
                edge_v: v(0.0, 0.0, 0.5),
                tiles: [2, 2],
            },
        };
        let object = add(&mut scene, shape, &[m]);
        scene.objects[object].tessellation = Some(4);
        if i % 4 == 3 {
            let turn = DMat3::from_axis_angle(random.point().normalize(), 1.0);
            scene.objects[object].world_from_object.matrix3 =
                turn * DMat3::from_diagonal(v(1.0, 0.5, 2.0));
        }
    }
    scene
}

fn random_ray(random: &mut Random, i: usize) -> Ray {
    let grid = |p: DVec3| (p * 4.0).round() / 4.0;
    let axis = [DVec3::X, DVec3::Y, DVec3::Z][random.below(3)]
        * if random.below(2) == 0 { 1.0 } else { -1.0 };
    let mut ray = match i % 10 {
        // Axis-parallel, on the grid that many box faces lie on.
        0 => Ray::new(grid(random.point() * 3.0), axis),
        // In an axis-parallel plane of that grid.
        1 => {
            let d = random.point() * (DVec3::ONE - axis.abs());
            Ray::new(grid(random.point() * 3.0), d)
        }
        // From far away, with directions of any length.
        2 => {
            let from = random.point() * 1e5;
            Ray::new(from, (random.point() * 2.0 - from) * 1e-12)
        }
        // Aimed at grid points.
        3 => {
            let from = random.point() * 4.0;
            Ray::new(from, grid(random.point() * 2.0) - from)
        }
        _ => Ray::new(random.point() * 4.0, random.point()),
    };
    if random.below(4) == 0 {
        (ray.t_min, ray.t_max) = (0.5, 2.5);
    }
    ray
}

fn hierarchy_equals_brute_force<R: Precise>(rays: usize) {
    let mut random = Random(7);
    let mut found = 0;
    for round in 0..5 {
        let scene = cluttered(&mut random);
        let assembly = assembled::<R>(&scene, None).unwrap();
        let geometry = if round == 4 {
            Geometry::Mesh
        } else {
            Geometry::Exact
        };
        let plan = tracer(&scene, &assembly, geometry).unwrap();
        let (surfaces, mut walker) = (surfaces::<R>(&plan), Walker::default());
        for i in 0..rays / 5 {
            let ray = random_ray(&mut random, i);
            let nearest = surfaces.closest_hit(&ray, &mut walker);
            assert_eq!(nearest, surfaces.closest_hit_of_all(&ray), "{ray:?}");
            assert_eq!(
                nearest.is_some(),
                surfaces.any_hit(&ray, &mut walker),
                "{ray:?}"
            );
            let all = surfaces.crossings(&ray, &mut walker, |_| true).unwrap();
            assert_eq!(nearest.map(|h| h.t), all.first().map(|h| h.t), "{ray:?}");
            found += usize::from(nearest.is_some());
        }
        assert!(walker.work.primitive_tests > 0);
    }
    assert!(found > rays / 10 && found < rays * 9 / 10, "{found}");
}

/// What hierarchies of one width say, whatever the leaf size.
fn any_shape_of_hierarchy<const W: usize>(
    triangles: &[[DVec3; 3]],
    rays: &[Ray],
) -> Vec<Option<(f64, usize)>> {
    let mut answers = Vec::new();
    for max_leaf in [1, 4, 40] {
        let bounds: Vec<_> = triangles.iter().map(|t| Bounds::of(*t)).collect();
        let (bvh, order) = Bvh::<W>::build_with(&bounds, max_leaf);
        let mut walker = Walker::default();
        let closest = |ray: &Ray| {
            let shear = Shear::new(ray.origin, ray.direction)?;
            let mut best: Option<(f64, usize)> = None;
            bvh.traverse(ray, &mut walker, |slot, t_max, _| {
                let index = order[slot] as usize;
                let corners = triangles[index].map(|p| p.to_array());
                if let Some(hit) = shear.triangle(corners)
                    && hit.t >= ray.t_min
                    && hit.t <= *t_max
                    && best.is_none_or(|(t, i)| hit.t < t || index < i)
                {
                    best = Some((hit.t, index));
                    *t_max = hit.t;
                }
                false
            });
            best
        };
        let found: Vec<_> = rays.iter().map(closest).collect();
        assert!(
            answers.is_empty() || answers == found,
            "width {W}, leaves of {max_leaf}"
        );
        answers = found;
    }
    answers
}

/// Width, leaf size and order of the hierarchy, and brute force (NUMERICS T4).
fn widths_and_leaf_sizes(rays: usize) {
    let mut random = Random(11);
    let triangles: Vec<_> = (0..500)
        .map(|_| {
            let base = (random.point() * 8.0).round() / 4.0;
            [0; 3].map(|_| base + (random.point() * 4.0).round() / 4.0)
        })
        .collect();
    let rays: Vec<_> = (0..rays).map(|i| random_ray(&mut random, i)).collect();
    let expected: Vec<_> = rays
        .iter()
        .map(|ray| nearest_of_all(&triangles, ray))
        .collect();
    assert!(expected.iter().flatten().count() * 4 > rays.len());
    assert_eq!(any_shape_of_hierarchy::<2>(&triangles, &rays), expected);
    assert_eq!(any_shape_of_hierarchy::<4>(&triangles, &rays), expected);
    assert_eq!(any_shape_of_hierarchy::<8>(&triangles, &rays), expected);
}

/// (t, number) of the nearest hit, every triangle tested; of equal t the lowest number.
fn nearest_of_all(triangles: &[[DVec3; 3]], ray: &Ray) -> Option<(f64, usize)> {
    let shear = Shear::new(ray.origin, ray.direction)?;
    let mut best: Option<(f64, usize)> = None;
    for (index, corners) in triangles.iter().enumerate() {
        if let Some(hit) = shear.triangle(corners.map(|p| p.to_array()))
            && (ray.t_min..=ray.t_max).contains(&hit.t)
            && best.is_none_or(|(t, _)| hit.t < t)
        {
            best = Some((hit.t, index));
        }
    }
    best
}

#[test]
fn widths_and_leaf_sizes_change_no_answer() {
    widths_and_leaf_sizes(20_000);
}

/// T4 in full: cargo test --test pictures -- --ignored trace::a_million
#[test]
#[ignore = "a million rays against every triangle: a minute"]
fn a_million_rays_meet_the_same_in_every_hierarchy() {
    widths_and_leaf_sizes(1_000_000);
}

#[test]
#[ignore = "a million rays against every primitive, in both precisions: a minute"]
fn a_million_rays_meet_what_brute_force_meets() {
    hierarchy_equals_brute_force::<f32>(1_000_000);
    hierarchy_equals_brute_force::<f64>(1_000_000);
}

#[test]
fn the_hierarchy_equals_brute_force_in_f32() {
    hierarchy_equals_brute_force::<f32>(100_000);
}

#[test]
fn the_hierarchy_equals_brute_force_in_f64() {
    hierarchy_equals_brute_force::<f64>(100_000);
}

/// A closed ball of triangles with every vertex moved a little; shared vertices stay shared.
fn jittered_ball(level: u32) -> Mesh {
    let mut mesh = rastray::scene::tessellate::tessellate(&sphere(DVec3::ZERO, 1.0), level, 1);
    mesh.normals.clear();
    for p in &mut mesh.positions {
        // -0 and 0 are one place.
        let bits = (*p + DVec3::ZERO).to_array().map(f64::to_bits);
        let mut random = Random(bits[0] ^ bits[1].rotate_left(21) ^ bits[2].rotate_left(42));
        *p = (*p + random.point() * 0.02)
            .to_array()
            .map(|x| f64::from(x as f32))
            .into();
    }
    mesh
}

fn closed_meshes_do_not_leak<R: Precise>() {
    let mut scene = Scene::default();
    let m = glowing(&mut scene, 1.0);
    let mesh = jittered_ball(48);
    add_mesh(&mut scene, mesh.clone(), m);
    let assembly = assembled::<R>(&scene, None).unwrap();
    let plan = tracer(&scene, &assembly, Geometry::Mesh).unwrap();
    let (surfaces, mut walker, mut random) = (surfaces::<R>(&plan), Walker::default(), Random(3));
    let mut aimed = 0;
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|k| mesh.positions[k as usize]);
        let targets = [a, (a + b) / 2.0, b.lerp(c, 0.25), (a + b + c) / 3.0];
        for target in targets {
            // From an inner and from an outer point; dyadic coordinates make many directions exact.
            let inner = (random.point() * 32.0).round() / 64.0;
            let outer = (random.point().normalize() * 64.0).round() / 16.0;
            for (origin, inside) in [(inner, true), (outer, false)] {
                let ray = Ray::new(origin, target - origin);
                let hits = surfaces.crossings(&ray, &mut walker, |_| true).unwrap();
                let balance: i32 = hits.iter().map(|h| if h.back { 1 } else { -1 }).sum();
                assert_eq!(
                    balance,
                    i32::from(inside),
                    "triangle {i}, {ray:?}, {hits:?}"
                );
                assert_eq!(
                    surfaces.closest_hit(&ray, &mut walker).is_some(),
                    !hits.is_empty()
                );
                aimed += 1;
            }
        }
    }
    assert!(aimed > 15_000);
}

#[test]
fn closed_meshes_do_not_leak_and_edges_have_one_owner() {
    closed_meshes_do_not_leak::<f32>();
    closed_meshes_do_not_leak::<f64>();
}

/// T7: the camera inside a closed mesh sees no background.
#[test]
fn a_closed_room_shows_no_background() {
    let mut scene = Scene::default();
    let m = glowing(&mut scene, 1.0);
    add_mesh(&mut scene, jittered_ball(32), m);
    (scene.image.width, scene.image.height) = (256, 256);
    scene.camera.near = 1e-6;
    for (eye, target) in [
        (DVec3::ZERO, DVec3::X),
        (v(0.25, -0.5, 0.125), v(0.25, -0.5, 1.0)),
    ] {
        (scene.camera.eye, scene.camera.target) = (eye, target);
        scene.camera.projection = Projection::Perspective { fovy_deg: 120.0 };
        let (frame, _) = try_draw::<f32>(&scene, Geometry::Mesh, &options(&scene)).unwrap();
        assert!(frame.color.data.iter().all(|c| c[0] == 1.0));
    }
}

// ---- The numerics cases ------------------------------------------------------------------------------------------------

mod numerics {
    //! The groups of the numerics set that rays decide (`tests/reference/README.md`), answered by the conformance adapter's own code, at the bars of both
    //! precisions. Inputs are f32 numbers but where a case says otherwise.

    use super::{Value, rays, v};
    use rastray::trace::exact::unit;
    use std::collections::BTreeMap;

    struct Cases {
        cases: Vec<Value>,
        expect: Value,
        bars: Value,
    }

    fn load() -> Cases {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/tests/reference/numerics-rays.json.gz"
        );
        let bytes = std::fs::read(path).unwrap();
        let all: Value = serde_json::from_reader(flate2::read::GzDecoder::new(&bytes[..])).unwrap();
        Cases {
            cases: all["cases"].as_array().unwrap().clone(),
            expect: all["expect"].clone(),
            bars: all["bars"].clone(),
        }
    }

    fn number(x: &Value) -> f64 {
        x.as_f64().unwrap()
    }

    fn is_true(x: &Value) -> bool {
        x.as_bool().unwrap()
    }

    /// Largest difference of two vectors.
    fn farthest(a: &Value, b: &Value) -> f64 {
        (0..3).fold(0.0, |most, k| {
            let error = (number(&a[k]) - number(&b[k])).abs();
            if error <= most { most } else { error }
        })
    }

    #[derive(Debug, Default)]
    struct Errors {
        worst: BTreeMap<&'static str, f64>,
        judged: usize,
        bad: usize,
        skipped: usize,
    }

    impl Errors {
        fn add(&mut self, name: &'static str, error: f64) {
            let worst = self.worst.entry(name).or_insert(0.0);
            *worst = if error <= *worst { *worst } else { error }; // keeps NaN
        }
    }

    /// Answers the groups of a kind in both precisions and holds their worst errors to the bars. `compare` gets the case,
    /// its answer, what is expected, and whether the precision is f32.
    fn judge(kind: &str, compare: impl Fn(&Value, &Value, &Value, bool, &mut Errors)) {
        let all = load();
        let mut failures = Vec::new();
        for case in all.cases.iter().filter(|c| c["kind"] == kind) {
            let id = case["id"].as_str().unwrap();
            for precision in ["f32", "f64"] {
                let single = precision == "f32";
                let mut errors = Errors::default();
                let evals = case["evals"].as_array().unwrap();
                for (eval, expected) in evals.iter().zip(all.expect[id].as_array().unwrap()) {
                    let answer = if single {
                        rays::answer::<f32>(kind, eval.clone())
                    } else {
                        rays::answer::<f64>(kind, eval.clone())
                    };
                    let answer = answer.unwrap().unwrap();
                    compare(eval, &answer, expected, single, &mut errors);
                }
                println!("{id} {precision}: {errors:?}");
                let bars = &all.bars[id][precision];
                for (name, error) in &errors.worst {
                    let bar = bars[name].as_f64().unwrap_or(0.0);
                    if error.is_nan() || *error > bar {
                        failures.push(format!("{id} {precision}: {name} {error:e} > {bar:e}"));
                    }
                }
                if errors.bad > 0 {
                    failures.push(format!("{id} {precision}: {} wrong", errors.bad));
                }
                assert!(errors.judged > 0, "{id}");
            }
        }
        assert!(failures.is_empty(), "{failures:#?}");
    }

    #[test]
    fn rays_meet_shapes() {
        judge("ray", |_, answer, expected, single, errors| {
            let margin = if single { 2e-6 } else { 1e-14 };
            let doubtful = ["margin", "bmin"]
                .iter()
                .filter_map(|m| expected[*m].as_f64())
                .any(|m| m != 0.0 && m.abs() < margin);
            if doubtful {
                errors.skipped += 1;
                return;
            }
            errors.judged += 1;
            if answer["hit"] != expected["hit"] {
                errors.bad += 1;
            } else if is_true(&answer["hit"]) {
                let (t, p) = (number(&expected["t"]), &expected["p"]);
                let size = (0..3).fold(0.0, |most: f64, k| most.max(number(&p[k]).abs()));
                errors.add("err_t", ((number(&answer["t"]) - t) / t).abs());
                errors.add("err_p", farthest(&answer["p"], p) / size);
                errors.add("err_n", farthest(&answer["n"], &expected["n"]));
            }
        });
    }

    #[test]
    fn directions_after_refraction_and_reflection() {
        judge("refr", |eval, answer, expected, single, errors| {
            let margin = number(&expected["margin"]);
            let least = if single { 2e-6 } else { 1e-13 };
            if (single && eval["prec"] == 64) || (margin != 0.0 && margin.abs() < least) {
                errors.skipped += 1;
                return;
            }
            errors.judged += 1;
            if answer["tir"] != expected["tir"] {
                errors.bad += 1;
                return;
            }
            errors.add("err", farthest(&answer["refl"], &expected["refl"]));
            if !is_true(&answer["tir"]) {
                errors.add("err", farthest(&answer["refr"], &expected["refr"]));
            }
        });
    }

    #[test]
    fn two_hundred_interfaces() {
        judge("chain", |_, answer, expected, _, errors| {
            errors.judged += 1;
            errors.add("err", farthest(&answer["dir"], &expected["dir"]));
        });
    }

    #[test]
    fn closed_meshes_have_no_leak_and_one_owner() {
        judge("mesh", |_, answer, expected, _, errors| {
            let answers = answer.as_array().unwrap();
            for (answer, wanted) in answers.iter().zip(expected.as_array().unwrap()) {
                errors.judged += 1;
                let hits = answer["hits"].as_array().unwrap();
                let balance: i64 = hits.iter().map(|hit| hit[1].as_i64().unwrap()).sum();
                let parity = balance.abs() != i64::from(is_true(&wanted["inside"]));
                let must = is_true(&wanted["must_hit"]);
                errors.bad += usize::from(parity) + usize::from(must && hits.is_empty());
                if let (true, Some(hit)) = (must, hits.first()) {
                    let t = number(&wanted["t"]);
                    errors.add("err_t", ((number(&hit[0]) - t) / t).abs());
                }
            }
        });
    }

    #[test]
    fn spawned_rays_shadow_right() {
        judge("shadow", |_, answer, expected, _, errors| {
            errors.judged += 1;
            errors.bad += usize::from(answer["lit"] != expected["lit"]);
        });
    }

    fn far(a: rastray::math::DVec3, b: rastray::math::DVec3) -> f64 {
        (a - b).abs().max_element()
    }

    #[test]
    fn unit_vectors_survive_extremes() {
        for k in [-120, -30, 0, 30, 120] {
            let d = v(3.0, -4.0, 12.0) * libm::exp2(f64::from(k));
            assert!(far(unit(d), v(3.0, -4.0, 12.0) / 13.0) < 1e-16);
        }
    }
}
