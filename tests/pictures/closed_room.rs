//! Closed rooms (NUMERICS section 5, T7): a ray from inside a closed surface always meets it, and crosses it once more
//! outwards than inwards. And what that exactness costs.
//!
//! Rooms are closed meshes made here (sphere, torus, a bottle of revolution closed at both ends, a noisy icosphere with
//! needles, the same as an instance) and the exact shapes, placed as they are and under a transform. Rays start at points
//! known to be inside: random ones in all directions, a tenth of them axis-parallel; and aimed ones at vertices, needle
//! tips, middles of edges and points on edges, half of them axis-parallel with two coordinates equal to the target's.
//!
//! A *leak* is a ray that `closest_hit` or `any_hit` lets out; a *parity error* one whose `crossings` are not an odd number,
//! one more outwards than inwards, each counted once.
//!
//! The long form, 1e7 random and 1e5 aimed rays a room (and precision, for meshes), and the cost, on a machine that is
//! otherwise idle:
//!
//! ```text
//! cargo test --release --test pictures -- --ignored --nocapture closed_room::long_form
//! cargo test --release --test pictures -- --ignored --nocapture closed_room::cost   (needs RASTRAY_MESH=FILE.obj)
//! ```

use std::sync::Arc;
use std::time::Instant;

use crate::common::precise::{Precise, assembled, surfaces, tracer};
use crate::common::random::Random;
use rastray::math::{DAffine3, DMat3, DVec3};
use rastray::render::Assembled;
use rastray::scene::assembly::object_mesh;
use rastray::scene::profile::{Curve, Profile};
use rastray::scene::tessellate::tessellate;
use rastray::scene::{Geometry as Form, Material, Mesh, Object, Optics, Scene, Shape};
use rastray::trace::Geometry;
use rastray::trace::bvh::{Bvh, Walker};
use rastray::trace::planar::{PlanarHit, Shear};
use rastray::trace::ray::Ray;
use rayon::prelude::*;

// ---- Rooms ---------------------------------------------------------------------------------------------------------

/// A closed surface and points inside it.
struct Room {
    name: String,
    /// One object, or two that share a mesh.
    scene: Scene,
    /// World places that rays are aimed at: corners of triangles on, or near, the surface.
    targets: Vec<[DVec3; 3]>,
    /// Tips that rays are aimed at.
    tips: Vec<DVec3>,
    inside: Inside,
    place: DAffine3,
    /// How much more often a ray from inside meets backs than fronts: 1, or -1 where a mesh is mirrored, as in GL.
    balance: i32,
}

/// Points inside a room, in its own space.
#[derive(Clone)]
struct Inside {
    /// A random one.
    sample: Arc<dyn Fn(&mut Random) -> DVec3 + Send + Sync>,
    /// Says true of points inside alone.
    holds: Arc<dyn Fn(DVec3) -> bool + Send + Sync>,
}

fn inside(
    sample: impl Fn(&mut Random) -> DVec3 + Send + Sync + 'static,
    holds: impl Fn(DVec3) -> bool + Send + Sync + 'static,
) -> Inside {
    Inside {
        sample: Arc::new(sample),
        holds: Arc::new(holds),
    }
}

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Turned, stretched and moved.
fn askew() -> DAffine3 {
    let turn = DMat3::from_axis_angle(v(0.36, 0.48, 0.8), 0.7);
    DAffine3 {
        matrix3: turn * DMat3::from_diagonal(v(1.25, 0.5, -0.75)),
        translation: v(0.25, -3.5, 1.75),
    }
}

fn scene_of(geometry: Form, places: &[DAffine3]) -> Scene {
    let mut scene = Scene::default();
    (scene.camera.eye, scene.camera.target) = (DVec3::ZERO, DVec3::X);
    scene.materials.push(Material {
        name: "m".into(),
        front: rastray::gl::Material::default(),
        back: None,
        optics: Optics::default(),
    });
    scene.objects = places
        .iter()
        .map(|place| Object {
            name: "o".into(),
            geometry: geometry.clone(),
            materials: vec![0],
            world_from_object: *place,
            tessellation: None,
            priority: 0,
        })
        .collect();
    scene
}

/// Every position as f32 holds it, so that rays can be aimed at what both precisions store.
fn rounded(mut mesh: Mesh) -> Mesh {
    for p in &mut mesh.positions {
        *p = p.to_array().map(|x| f64::from(x as f32) + 0.0).into();
    }
    mesh.normals.clear();
    mesh
}

fn corners(mesh: &Mesh, place: &DAffine3) -> Vec<[DVec3; 3]> {
    let corner = |i: u32| place.transform_point3(mesh.positions[i as usize]);
    mesh.triangles.iter().map(|t| t.map(corner)).collect()
}

fn mesh_room(name: &str, mesh: Mesh, tips: Vec<DVec3>, inside: Inside) -> Room {
    let mesh = rounded(mesh);
    Room {
        name: name.into(),
        targets: corners(&mesh, &DAffine3::IDENTITY),
        tips,
        scene: scene_of(Form::Mesh(Arc::new(mesh)), &[DAffine3::IDENTITY]),
        inside,
        place: DAffine3::IDENTITY,
        balance: 1,
    }
}

fn sphere() -> (Shape, Inside) {
    let (center, radius) = (DVec3::ZERO, 1.0);
    let sample = |r: &mut Random| r.direction() * r.next() * 0.98;
    let holds = |p: DVec3| p.length() < 0.98;
    (Shape::Sphere { center, radius }, inside(sample, holds))
}

fn torus() -> (Shape, Inside) {
    let (major, minor) = (1.0, 0.4);
    let shape = Shape::Torus {
        center: DVec3::ZERO,
        axis: DVec3::Y,
        major,
        minor,
    };
    let ring = move |p: DVec3| v(p.x, 0.0, p.z).normalize_or(DVec3::X) * major;
    let sample = move |r: &mut Random| ring(r.direction()) + 0.9 * minor * r.next() * r.direction();
    let holds = move |p: DVec3| (p - ring(p)).length() < 0.9 * minor;
    (shape, inside(sample, holds))
}

fn bottle() -> (Shape, Inside) {
    let points = [
        [0.0, 0.0],
        [0.9, 0.0],
        [0.9, 0.0],
        [1.0, 0.4],
        [0.95, 1.2],
        [0.45, 1.9],
        [0.32, 2.4],
        [0.32, 2.9],
        [0.32, 2.9],
        [0.0, 3.0],
    ];
    let profile = Profile::new(Curve::Smooth, &points).expect("a profile");
    assert!(profile.is_closed());
    let shape = Shape::Revolution {
        base: DVec3::ZERO,
        axis: DVec3::Y,
        profile: Arc::new(profile),
    };
    // The belly, and the neck down to the bottom.
    let holds = |p: DVec3| {
        let radius = p.x.hypot(p.z);
        (radius < 0.8 && 0.05 < p.y && p.y < 1.2) || (radius < 0.28 && 0.05 < p.y && p.y < 2.85)
    };
    let sample = move |r: &mut Random| loop {
        let p = v(r.next(), 1.5 + 1.5 * r.next(), r.next());
        if holds(p) {
            return p;
        }
    };
    (shape, inside(sample, holds))
}

fn cuboid() -> (Shape, Inside) {
    let (min, max) = (v(-1.0, -0.75, -0.375), v(0.9, 0.8, 0.625));
    let (middle, half) = ((min + max) / 2.0, 0.99 * (max - min) / 2.0);
    let sample = move |r: &mut Random| middle + half * r.vector();
    let holds = move |p: DVec3| (p - middle).abs().cmplt(half).all();
    (Shape::Box { min, max }, inside(sample, holds))
}

/// Points about a segment: within `radius(s)` of its point at s, 0.02 < s < 0.98.
fn about(base: DVec3, top: DVec3, radius: fn(f64) -> f64) -> Inside {
    let axis = top - base;
    let holds = move |p: DVec3| {
        let s = (p - base).dot(axis) / axis.length_squared();
        0.02 < s && s < 0.98 && (p - base - s * axis).length() < 0.97 * radius(s)
    };
    let sample = move |r: &mut Random| loop {
        let p = base + (0.5 + 0.5 * r.next()) * axis + r.vector();
        if holds(p) {
            return p;
        }
    };
    inside(sample, holds)
}

fn cylinder() -> (Shape, Inside) {
    let (base, top) = (v(0.1, -1.0, 0.2), v(-0.2, 1.1, 0.3));
    let shape = Shape::Cylinder {
        base,
        top,
        radius: 0.6,
        caps: true,
    };
    (shape, about(base, top, |_| 0.6))
}

fn cone() -> (Shape, Inside) {
    let (base, apex) = (v(0.0, -1.0, 0.0), v(0.2, 1.25, -0.1));
    let shape = Shape::Cone {
        base,
        apex,
        radius: 0.8,
        cap: true,
    };
    (shape, about(base, apex, |s| 0.8 * (1.0 - s)))
}

/// An octahedron whose faces are cut in four, on the unit sphere; shared vertices are shared.
fn globe(cuts: u32) -> Mesh {
    let mut points = vec![
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        -DVec3::X,
        -DVec3::Y,
        -DVec3::Z,
    ];
    let mut triangles = Vec::new();
    for [a, b, c] in [[0, 1, 2], [0, 2, 4], [0, 4, 5], [0, 5, 1]] {
        let other = |i: u32| (i + 3) % 6;
        triangles.push([a, b, c]);
        // The opposite face, seen from the other side.
        triangles.push([other(a), other(c), other(b)]);
    }
    for _ in 0..cuts {
        let mut known = std::collections::HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let mut middle = |a: u32, b: u32| {
                *known.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    points.push((points[a as usize] + points[b as usize]).normalize());
                    points.len() as u32 - 1
                })
            };
            let (x, y, z) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, x, z], [b, y, x], [c, z, y], [x, y, z]]);
        }
        triangles = finer;
    }
    Mesh {
        positions: points,
        triangles,
        ..Mesh::default()
    }
}

/// A globe with every vertex moved in or out by up to a tenth, and one in 23 drawn out to a needle's tip.
fn needles() -> (Mesh, Vec<DVec3>, Inside) {
    let mut mesh = globe(4);
    let (mut random, mut tips) = (Random(23), Vec::new());
    for (i, p) in mesh.positions.iter_mut().enumerate() {
        let is_tip = i % 23 == 7;
        *p *= if is_tip {
            5.0 + 3.0 * random.next()
        } else {
            1.0 + 0.1 * random.next()
        };
        if is_tip {
            tips.push(*p);
        }
    }
    let mesh = rounded(mesh);
    let tips: Vec<DVec3> = tips
        .iter()
        .map(|p| p.to_array().map(|x| f64::from(x as f32)).into())
        .collect();
    // The surface is a height above the unit sphere, at least 0.9 at its vertices: inside are the ball below 0.85 and the
    // way from the middle to each tip.
    let needles = tips.clone();
    let sample = move |r: &mut Random| {
        if r.next() < 0.0 {
            return r.direction() * r.next() * 0.85;
        }
        let tip = needles[(r.next().abs() * needles.len() as f64) as usize];
        tip * 0.999 * r.next().abs()
    };
    (mesh, tips, inside(sample, |p| p.length() < 0.85))
}

fn mesh_rooms() -> Vec<Room> {
    let tessellated = |name: &str, (shape, inside): (Shape, Inside)| {
        mesh_room(name, tessellate(&shape, 96, 1), Vec::new(), inside)
    };
    let (mesh, tips, inside) = needles();
    let mut rooms = vec![
        tessellated("sphere", sphere()),
        tessellated("torus", torus()),
        tessellated("bottle", bottle()),
        mesh_room("needles", mesh.clone(), tips.clone(), inside.clone()),
    ];
    let place = askew();
    // Beyond the reach of the needles.
    let elsewhere = DAffine3::from_translation(v(40.0, 1.0, -3.0));
    rooms.push(Room {
        name: "needles, instanced".into(),
        targets: corners(&mesh, &place),
        tips: tips.iter().map(|p| place.transform_point3(*p)).collect(),
        scene: scene_of(Form::Mesh(Arc::new(mesh)), &[place, elsewhere]),
        inside,
        place,
        balance: -1,
    });
    rooms
}

fn exact_rooms() -> Vec<Room> {
    let shapes = [
        ("sphere", sphere()),
        ("torus", torus()),
        ("bottle", bottle()),
        ("box", cuboid()),
        ("cylinder", cylinder()),
        ("cone", cone()),
    ];
    let mut rooms = Vec::new();
    for (name, (shape, inside)) in shapes {
        for (place, how) in [(DAffine3::IDENTITY, ""), (askew(), ", askew")] {
            let scene = scene_of(Form::Shape(shape.clone()), &[place]);
            let mesh = object_mesh(&scene.objects[0], Some(48));
            rooms.push(Room {
                name: format!("exact {name}{how}"),
                targets: corners(&mesh, &place),
                tips: Vec::new(),
                scene,
                inside: inside.clone(),
                place,
                balance: 1,
            });
        }
    }
    rooms
}

// ---- Rays ------------------------------------------------------------------------------------------------------------

const AXES: [DVec3; 6] = [
    DVec3::X,
    DVec3::NEG_X,
    DVec3::Y,
    DVec3::NEG_Y,
    DVec3::Z,
    DVec3::NEG_Z,
];

impl Room {
    fn point(&self, random: &mut Random) -> DVec3 {
        self.place.transform_point3((self.inside.sample)(random))
    }

    fn holds(&self, world: DVec3) -> bool {
        (self.inside.holds)(self.place.inverse().transform_point3(world))
    }

    fn random_ray(&self, random: &mut Random, i: usize) -> Ray {
        let direction = if i.is_multiple_of(10) {
            AXES[i / 10 % 6]
        } else {
            random.direction()
        };
        Ray::new(self.point(random), direction)
    }

    fn aimed_ray(&self, random: &mut Random, i: usize) -> Ray {
        let number = (random.next().abs() * self.targets.len() as f64) as usize;
        let [a, b, c] = self.targets[number];
        let target = match i % 4 {
            0 => a,
            1 => (a + b) / 2.0,
            2 => b.lerp(c, random.next().abs()),
            _ if self.tips.is_empty() => (a + b + c) / 3.0,
            _ => self.tips[(random.next().abs() * self.tips.len() as f64) as usize],
        };
        // Two coordinates equal to the target's, where such a point is inside.
        for _ in 0..if (i / 4).is_multiple_of(2) { 8 } else { 0 } {
            let mut origin = target.to_array();
            let axis = (random.next().abs() * 3.0) as usize;
            origin[axis] = self.point(random).to_array()[axis];
            let origin = DVec3::from_array(origin);
            if self.holds(origin) {
                return Ray::new(origin, target - origin);
            }
        }
        // Else from a point that f32 can hold, so that most directions are exact.
        let origin = self.point(random).to_array().map(|x| f64::from(x as f32));
        let origin = DVec3::from_array(origin);
        Ray::new(origin, target - origin)
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Tally {
    rays: u64,
    leaks: u64,
    parity: u64,
    most_crossings: usize,
}

impl Tally {
    fn and(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            leaks: self.leaks + other.leaks,
            parity: self.parity + other.parity,
            most_crossings: self.most_crossings.max(other.most_crossings),
        }
    }
}

/// Rays that one task shoots.
const CHUNK: usize = 5000;

fn shoot<R: Precise>(room: &Room, random: usize, aimed: usize) -> Tally {
    let assembly = assembled::<R>(&room.scene, None).expect("a small scene");
    let plan = tracer(&room.scene, &assembly, Geometry::Exact).expect("a plan");
    let surfaces = surfaces::<R>(&plan);
    let chunk = |number: usize| {
        let (mut numbers, mut walker) = (Random(number as u64), Walker::default());
        let mut tally = Tally::default();
        for i in number * CHUNK..(number + 1) * CHUNK {
            let ray = if i < random {
                room.random_ray(&mut numbers, i)
            } else {
                room.aimed_ray(&mut numbers, i)
            };
            let nearest = surfaces.closest_hit(&ray, &mut walker);
            let any = surfaces.any_hit(&ray, &mut walker);
            let hits = surfaces
                .crossings(&ray, &mut walker, |_| true)
                .expect("nothing stops it");
            let balance: i32 = hits.iter().map(|h| if h.back { 1 } else { -1 }).sum();
            let (leak, odd) = (nearest.is_none() || !any, hits.len() % 2 == 1);
            let parity = !odd || balance != room.balance;
            if (leak || parity) && tally.leaks + tally.parity < 2 {
                println!("{}: {ray:?}: {nearest:?}, {any}, {hits:?}", room.name);
            }
            assert_eq!(nearest.as_ref(), hits.first(), "{}: {ray:?}", room.name);
            tally.rays += 1;
            tally.leaks += u64::from(leak);
            tally.parity += u64::from(parity);
            tally.most_crossings = tally.most_crossings.max(hits.len());
        }
        tally
    };
    let chunks = (random + aimed).div_ceil(CHUNK);
    let tallies = (0..chunks).into_par_iter().map(chunk);
    tallies.reduce(Tally::default, Tally::and)
}

fn closed<R: Precise>(rooms: &[Room], random: usize, aimed: usize) {
    let mut all = Tally::default();
    for room in rooms {
        let start = Instant::now();
        let found = shoot::<R>(room, random, aimed);
        let bits = std::mem::size_of::<R>() * 8;
        println!(
            "{} f{bits}: {} rays, {} leaks, {} parity errors, up to {} crossings, {:.1} s",
            room.name,
            found.rays,
            found.leaks,
            found.parity,
            found.most_crossings,
            start.elapsed().as_secs_f64()
        );
        all = all.and(found);
    }
    assert!(all.rays >= (rooms.len() * (random + aimed)) as u64);
    assert_eq!((all.leaks, all.parity), (0, 0), "of {} rays", all.rays);
}

#[test]
fn closed_meshes_let_no_ray_out_in_f32() {
    closed::<f32>(&mesh_rooms(), 50_000, 10_000);
}

#[test]
fn closed_meshes_let_no_ray_out_in_f64() {
    closed::<f64>(&mesh_rooms(), 50_000, 10_000);
}

/// An exact shape is the same in both precisions.
#[test]
fn closed_shapes_let_no_ray_out() {
    closed::<f64>(&exact_rooms(), 20_000, 10_000);
}

#[test]
#[ignore = "1e7 random and 1e5 aimed rays a mesh and precision, in release"]
fn long_form_of_meshes_in_f32() {
    closed::<f32>(&mesh_rooms(), 10_000_000, 100_000);
}

#[test]
#[ignore = "1e7 random and 1e5 aimed rays a mesh and precision, in release"]
fn long_form_of_meshes_in_f64() {
    closed::<f64>(&mesh_rooms(), 10_000_000, 100_000);
}

#[test]
#[ignore = "1e7 random and 1e5 aimed rays a shape, in release"]
fn long_form_of_shapes() {
    closed::<f64>(&exact_rooms(), 10_000_000, 100_000);
}

// ---- What exactness costs ---------------------------------------------------------------------------------------------

/// A triangle test, made ready for one ray.
trait Kernel: Sized {
    fn new(ray: &Ray) -> Option<Self>;
    fn triangle(&self, corners: [[f64; 3]; 3]) -> Option<PlanarHit>;
}

impl Kernel for Shear {
    #[inline]
    fn new(ray: &Ray) -> Option<Self> {
        Shear::new(ray.origin, ray.direction)
    }

    #[inline]
    fn triangle(&self, corners: [[f64; 3]; 3]) -> Option<PlanarHit> {
        Shear::triangle(self, corners)
    }
}

/// The plain test of Moeller and Trumbore (1997) in f64: it leaks at edges and knows no owner. Here to be measured against.
struct Plain {
    origin: DVec3,
    direction: DVec3,
}

impl Kernel for Plain {
    #[inline]
    fn new(ray: &Ray) -> Option<Self> {
        Some(Self {
            origin: ray.origin,
            direction: ray.direction,
        })
    }

    #[inline]
    fn triangle(&self, corners: [[f64; 3]; 3]) -> Option<PlanarHit> {
        let [a, b, c] = corners.map(DVec3::from_array);
        let (ab, ac) = (b - a, c - a);
        let p = self.direction.cross(ac);
        let det = ab.dot(p);
        if det == 0.0 {
            return None;
        }
        let inverse = 1.0 / det;
        let s = self.origin - a;
        let u = s.dot(p) * inverse;
        if !(0.0..=1.0).contains(&u) {
            return None;
        }
        let q = s.cross(ab);
        let v = self.direction.dot(q) * inverse;
        if !(v >= 0.0 && u + v <= 1.0) {
            return None;
        }
        let t = ac.dot(q) * inverse;
        let (uv, back) = ([u, v], det < 0.0);
        Some(PlanarHit { t, uv, back })
    }
}

/// The renderer's traversal of triangles with one kernel or the other; all else is the same.
struct Bench {
    bvh: Bvh,
    order: Vec<u32>,
    corners: Vec<[[f32; 3]; 3]>,
    eye: DVec3,
}

impl Bench {
    fn new(scene: &Scene, assembly: &Assembled) -> Self {
        let eye = scene.camera.eye;
        let corners_of = |t: &[u32; 3]| t.map(|i| assembly.vertex_from_eye(i).map(|x| x as f32));
        let world = |p: [f32; 3]| DVec3::from_array(p.map(f64::from)) + eye;
        let bounds: Vec<_> = assembly
            .triangles()
            .iter()
            .map(|t| rastray::trace::build::Bounds::of(corners_of(t).map(world)))
            .collect();
        let (bvh, order) = Bvh::build(&bounds);
        let corners = order
            .iter()
            .map(|i| corners_of(&assembly.triangles()[*i as usize]))
            .collect();
        Self {
            bvh,
            order,
            corners,
            eye,
        }
    }

    #[inline(never)]
    fn closest<K: Kernel>(&self, rays: &[Ray], walker: &mut Walker) -> Vec<(f64, u32)> {
        let one = |ray: &Ray| {
            let mut best = (f64::INFINITY, u32::MAX);
            let Some(kernel) = K::new(ray) else {
                return best;
            };
            self.bvh.traverse(ray, walker, |slot, t_max, _| {
                let item = self.order[slot];
                if item == ray.skip {
                    return false;
                }
                if let Some(hit) = kernel.triangle(self.world(slot))
                    && hit.t >= ray.t_min
                    && hit.t <= *t_max
                    && (hit.t < best.0 || (hit.t == best.0 && item < best.1))
                {
                    best = (hit.t, item);
                    *t_max = hit.t;
                }
                false
            });
            best
        };
        rays.iter().map(one).collect()
    }

    #[inline(never)]
    fn any<K: Kernel>(&self, rays: &[Ray], walker: &mut Walker) -> Vec<(f64, u32)> {
        let one = |ray: &Ray| {
            let Some(kernel) = K::new(ray) else {
                return (0.0, 0);
            };
            let met = self.bvh.traverse(ray, walker, |slot, _, _| {
                self.order[slot] != ray.skip
                    && kernel
                        .triangle(self.world(slot))
                        .is_some_and(|hit| hit.t >= ray.t_min && hit.t <= ray.t_max)
            });
            (0.0, u32::from(met))
        };
        rays.iter().map(one).collect()
    }

    #[inline]
    fn world(&self, slot: usize) -> [[f64; 3]; 3] {
        let eye = self.eye;
        self.corners[slot].map(|[x, y, z]| {
            [
                f64::from(x) + eye.x,
                f64::from(y) + eye.y,
                f64::from(z) + eye.z,
            ]
        })
    }
}

/// Seconds that this thread has been on a processor, where the system says so (Linux): other programs do not count then.
fn processor_seconds() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = status.split(' ').next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

/// Seconds of a call, of this thread's processor time where that is known, and what it found.
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let (start, before) = (Instant::now(), processor_seconds());
    let found = work();
    let seconds = match (before, processor_seconds()) {
        (Some(before), Some(after)) => after - before,
        _ => start.elapsed().as_secs_f64(),
    };
    (seconds, found)
}

/// Prints the ratio of two kernels on one set of rays: A B B A, median and range of the rounds.
fn compare(
    name: &str,
    rounds: usize,
    rays: &[Ray],
    exact: impl Fn(&[Ray]) -> Vec<(f64, u32)>,
    plain: impl Fn(&[Ray]) -> Vec<(f64, u32)>,
) {
    let (found, judged) = (exact(rays), plain(rays));
    let hits = found.iter().filter(|f| f.1 != u32::MAX && f.1 != 0).count();
    let differ = found
        .iter()
        .zip(&judged)
        .filter(|(a, b)| a.1 != b.1)
        .count();
    let mut ratios = Vec::new();
    let mut seconds = [f64::INFINITY; 2];
    for _ in 0..rounds {
        let (a, _) = timed(|| exact(rays));
        let (b, _) = timed(|| plain(rays));
        let (c, _) = timed(|| plain(rays));
        let (d, last) = timed(|| exact(rays));
        assert_eq!(last.len(), rays.len());
        ratios.push((a + d) / (b + c));
        seconds = [seconds[0].min(a).min(d), seconds[1].min(b).min(c)];
    }
    ratios.sort_by(f64::total_cmp);
    let rate = |s: f64| rays.len() as f64 / s / 1e6;
    println!(
        "{name}: {} rays, {hits} hits, {differ} answers differ; exact {:.3}, plain {:.3} million rays a second; \
         time ratio median {:.3}, range {:.3} to {:.3} of {rounds}, of the fastest {:.3}",
        rays.len(),
        rate(seconds[0]),
        rate(seconds[1]),
        ratios[rounds / 2],
        ratios[0],
        ratios[rounds - 1],
        seconds[0] / seconds[1]
    );
}

/// Exact decisions against plain ones, on the mesh that RASTRAY_MESH names (the dragon, in what is recorded).
#[test]
#[ignore = "a measurement on a mesh that RASTRAY_MESH names, for an idle machine"]
fn cost() {
    let file = std::env::var("RASTRAY_MESH").expect("RASTRAY_MESH names an .obj file");
    let scene = rastray::import::load(&file, &Default::default())
        .expect("a mesh")
        .scene;
    let assembly = assembled::<f32>(&scene, None).expect("triangles");
    let plan = tracer(&scene, &assembly, Geometry::Exact).expect("a plan");
    let bench = Bench::new(&scene, &assembly);
    let camera = &scene.camera;
    let world_from_eye = camera.eye_from_world_rotation().transpose();
    const SIDE: u32 = 400;
    let primary: Vec<Ray> = (0..SIDE * SIDE)
        .map(|i| {
            let place = [i % SIDE, i / SIDE].map(|x| f64::from(x) + 0.5);
            let (o, d) = camera.primary_ray(place.into(), SIDE, SIDE);
            Ray::new(camera.eye + world_from_eye * o, world_from_eye * d)
        })
        .collect();
    // From every point seen, one ray in a random direction: incoherent, as secondary and shadow rays are.
    let mut random = Random(5);
    let secondary: Vec<Ray> = bench
        .closest::<Shear>(&primary, &mut Walker::default())
        .iter()
        .zip(&primary)
        .filter(|(found, _)| found.1 != u32::MAX)
        .map(|(found, ray)| Ray {
            skip: found.1,
            ..Ray::new(ray.origin + found.0 * ray.direction, random.direction())
        })
        .collect();
    let rounds = 21;
    let work = |f: &dyn Fn(&mut Walker) -> Vec<(f64, u32)>| f(&mut Walker::default());
    for (name, rays) in [("primary", &primary), ("secondary", &secondary)] {
        compare(
            &format!("{name}, closest hit"),
            rounds,
            rays,
            |rays| work(&|w| bench.closest::<Shear>(rays, w)),
            |rays| work(&|w| bench.closest::<Plain>(rays, w)),
        );
    }
    compare(
        "secondary, any hit",
        rounds,
        &secondary,
        |rays| work(&|w| bench.any::<Shear>(rays, w)),
        |rays| work(&|w| bench.any::<Plain>(rays, w)),
    );
    // The renderer's own function, which knows other surfaces too, beside the same traversal here.
    let surfaces = surfaces::<f32>(&plan);
    compare(
        "primary, the renderer's closest hit against the traversal here",
        rounds,
        &primary,
        |rays| {
            work(&|w| {
                let one = |ray: &Ray| surfaces.closest_hit(ray, w);
                let found = rays.iter().map(one);
                found
                    .map(|hit| hit.map_or((f64::INFINITY, u32::MAX), |h| (h.t, h.primitive)))
                    .collect()
            })
        },
        |rays| work(&|w| bench.closest::<Shear>(rays, w)),
    );
}
