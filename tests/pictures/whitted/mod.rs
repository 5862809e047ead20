//! Whitted's light transport against closed forms: every check of the Whitted sheet (section 5), and what follows from its
//! sections 1, 2 and 4. Scenes are texts, imported and drawn as a user's are, each at the scales 1e-3, 1 and 1e3.
//!
//! How a picture tells where a ray went: the ray ends on a *map*, a mesh whose vertex colours are its vertices'
//! positions, emitted (`color_material = { mode = "emission" }`). Colours are unclamped and the tracer interpolates them
//! linearly, so the pixel's colour IS the place where the ray landed. Scaling a scene scales lengths, not colours: the place
//! is always told in the units of the text.
//!
//! A ray is known by two landings: [`assert_ray`] draws the scene in a small and in a large room of maps, and both
//! landings must lie on the line that the formula gives.
//!
//! Tolerances. In f64 every interface rounds a point and a direction to a few units in the last place, and so does the
//! map; [`LANDING`] is 64 times 2^-53 of the distance, where formulas are well-conditioned, and a test says by how much more
//! they amplify where they are not. In f32 colours, lights and meshes' vertices are f32; rays are not.

mod contacts;
mod edges;
mod glass;
mod media;
mod mirrors;
mod shares;

use crate::common::precise::{Precise, assembled, follow, tracer};
use crate::common::{scale, text};
use rastray::frame::Frame;
use rastray::lanes::Isa;
use rastray::math::DVec3;
use rastray::scene::Scene;
use rastray::trace::{Geometry, Options};

/// Every scene is drawn at each of these.
const SCALES: [f64; 3] = [1e-3, 1.0, 1e3];
/// Half the side of the rooms that tell where a ray goes.
const ROOMS: [f64; 2] = [20.0, 60.0];
/// How far a landing may lie from its line, relative to the room.
const LANDING: f64 = 64.0 * UNIT;
/// The rounding of one operation in f64.
const UNIT: f64 = f64::EPSILON / 2.0;
/// The same in f32: for colours and vertices.
const UNIT_F32: f64 = 1.0 / 16_777_216.0;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A list as scene files write it.
fn list(v: DVec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

/// One pixel, whose ray starts at `eye` and goes in a direction; no ambient light.
fn one_ray(eye: DVec3, direction: DVec3) -> String {
    let up = direction.normalize().any_orthonormal_vector();
    format!(
        "[image]\nwidth = 1\nheight = 1\n[light_model]\nambient = 0\n\
         [camera]\neye = {}\ntarget = {}\nup = {}\northographic = 1\nnear = 1e-6\n",
        list(eye),
        list(eye + 4.0 * direction.normalize()),
        list(up)
    )
}

/// A clear material, black but for what it lets through.
fn glass(name: &str, ior: f64) -> String {
    format!("[material.{name}]\ncolor = 0\ntransmission = 1\nior = {ior:?}\n")
}

/// A perfect mirror.
const MIRROR: &str = "[material.mirror]\ncolor = 0\nreflection = 1\n";

fn ball(name: &str, center: DVec3, radius: f64, material: &str) -> String {
    format!(
        "[object.{name}]\nshape = \"sphere\"\ncenter = {}\nradius = {radius:?}\nmaterial = \"{material}\"\n",
        list(center)
    )
}

fn cuboid(name: &str, min: DVec3, max: DVec3, material: &str) -> String {
    format!(
        "[object.{name}]\nshape = \"box\"\nmin = {}\nmax = {}\nmaterial = \"{material}\"\n",
        list(min),
        list(max)
    )
}

/// A parallelogram; its front is the side of u x v.
fn quad(name: &str, corner: DVec3, u: DVec3, v: DVec3, material: &str) -> String {
    format!(
        "[object.{name}]\nshape = \"quad\"\ncorner = {}\nedge_u = {}\nedge_v = {}\nmaterial = \"{material}\"\n",
        list(corner),
        list(u),
        list(v)
    )
}

/// A mesh of flat faces.
fn mesh(name: &str, positions: &[DVec3], faces: &str, material: &str) -> String {
    let positions: Vec<String> = positions.iter().map(|p| list(*p)).collect();
    format!(
        "[object.{name}]\nmaterial = \"{material}\"\npositions = [{}]\nindices = {faces}\n",
        positions.join(", ")
    )
}

/// The six walls of a cube about the origin, each point emitting its own place.
fn room(half: f64) -> String {
    let corners: Vec<DVec3> = (0..8)
        .map(|i| {
            let side = |bit: u32| if i >> bit & 1 == 1 { half } else { -half };
            v(side(0), side(1), side(2))
        })
        .collect();
    let colors: Vec<String> = corners.iter().map(|p| list(*p)).collect();
    let faces =
        "[[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]";
    format!(
        "[material.map]\ncolor = 0\ncolor_material = {{ mode = \"emission\" }}\n{}colors = [{}]\n",
        mesh("room", &corners, faces, "map"),
        colors.join(", ")
    )
}

/// The scene of a text at a scale.
fn stage(text: &str, k: f64) -> Scene {
    let imported = text::import(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    scale::scaled(&imported.scene, k)
}

fn draw<R: Precise>(scene: &Scene, geometry: Geometry, layers: bool) -> Frame<R> {
    let options = Options {
        layers,
        ..Options::of(scene, Isa::Scalar)
    };
    let assembly = assembled::<R>(scene, None).expect("a small scene");
    let plan = tracer(scene, &assembly, geometry).expect("a plan");
    follow(&plan, &options).expect("a picture").0
}

/// The one pixel's colour, on the true shapes, in f64.
fn seen(text: &str, k: f64) -> DVec3 {
    DVec3::from_array(
        draw::<f64>(&stage(text, k), Geometry::Exact, false)
            .color
            .data[0],
    )
}

/// The one pixel's colour at every scale, which must be this, to `tolerance` relative to each channel.
fn assert_seen(text: &str, expected: [f64; 3], tolerance: f64) {
    for k in SCALES {
        let found = seen(text, k);
        for (found, expected) in found.to_array().into_iter().zip(expected) {
            assert!(
                (found - expected).abs() <= tolerance * expected.abs(),
                "scale {k}: {found:e}, not {expected:e}\n{text}"
            );
        }
    }
}

/// How far a landing lies from a line, relative to the room.
fn off_line(landing: DVec3, half: f64, origin: DVec3, direction: DVec3) -> f64 {
    let along = landing - origin;
    if along.dot(direction) <= 0.0 {
        return f64::INFINITY;
    }
    let wall = (landing.abs().max_element() - half).abs();
    wall.max(along.cross(direction.normalize()).length()) / half
}

/// Asserts that the pixel's ray leaves the stage along a line: at every scale and in both precisions, its landings in two
/// rooms are there. `conditioning` says by how much the formula itself amplifies rounding.
fn assert_ray(text: &str, origin: DVec3, direction: DVec3, conditioning: f64) {
    assert_ray_on(
        text,
        &[Geometry::Exact],
        origin,
        direction,
        [conditioning; 2],
    );
}

/// [`assert_ray`] on these geometries, with the conditioning in f64 and in f32.
fn assert_ray_on(
    text: &str,
    geometries: &[Geometry],
    origin: DVec3,
    direction: DVec3,
    conditioning: [f64; 2],
) {
    for half in ROOMS {
        let text = format!("{text}{}", room(half));
        for k in SCALES {
            let scene = stage(&text, k);
            for &geometry in geometries {
                let double = DVec3::from_array(draw::<f64>(&scene, geometry, false).color.data[0]);
                let off = off_line(double, half, origin, direction);
                assert!(
                    off <= LANDING * conditioning[0],
                    "scale {k}, {geometry:?}: {double} is off by {off:e}\n{text}"
                );
                let single = draw::<f32>(&scene, geometry, false).color.data[0].map(f64::from);
                let off = off_line(DVec3::from_array(single), half, origin, direction);
                let bar = LANDING * conditioning[0] + 4.0 * UNIT_F32 * conditioning[1];
                assert!(
                    off <= bar,
                    "scale {k}, {geometry:?}, f32: off by {off:e}\n{text}"
                );
            }
        }
    }
}

/// The map itself: a ray that meets nothing lands on its own line, and one that is square to a wall at its own place.
#[test]
fn a_map_tells_where_a_ray_lands() {
    let (eye, along) = (v(0.3, -0.2, 0.7), v(-0.4, 0.9, -1.3));
    assert_ray(&one_ray(eye, along), eye, along, 1.0);
    let text = format!(
        "{}{}",
        one_ray(v(1.0, 2.0, 0.0), v(0.0, 0.0, -1.0)),
        room(8.0)
    );
    assert_seen(&text, [1.0, 2.0, -8.0], 8.0 * LANDING);
}
