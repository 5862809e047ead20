//! Notes that only the whole scene can tell, about what is legal and seldom meant: planes with two owners, lights that light
//! nothing or everything without end, a camera so far away that f32 tells little apart.

use super::Reader;
use crate::math::DVec3;
use crate::scene::assembly::object_mesh;
use crate::scene::contact::{Contacts, Detail};
use crate::scene::fit::Bounds;
use crate::scene::{Geometry, Light, LightSpace, Mesh, Object, Scene, Shadow, Shape};

/// Pairs of objects that are named; more are counted.
const NAMED: usize = 8;

/// Distances of the eye beyond this many times the scene's size leave f32 fewer than 13 of its 24 digits for the scene.
const FAR: f64 = 2048.0;

impl Reader<'_> {
    /// Adds the notes.
    pub(super) fn doubts(&mut self) {
        let scene = &self.scene;
        let mut found = coplanar(scene);
        found.extend(scene.enabled_lights().filter_map(without_attenuation));
        found.extend(lights_inside(scene));
        found.extend(far_away(scene));
        for message in found {
            self.note(None, message);
        }
    }
}

fn coplanar(scene: &Scene) -> Vec<String> {
    let pairs = Contacts::of(scene, Detail::Exact).coplanar;
    let name = |object: u32| &scene.objects[object as usize].name;
    let named = pairs.iter().take(NAMED).map(|pair| {
        let (owner, other) = (name(pair.owner), name(pair.other));
        format!(
            "objects {owner} and {other} lie in one plane and overlap there: {owner}, the first in the file, is seen"
        )
    });
    let mut found: Vec<String> = named.collect();
    if pairs.len() > NAMED {
        let more = pairs.len() - NAMED;
        found.push(format!(
            "{more} more pairs of objects lie in one plane: of each the first in the file is seen"
        ));
    }
    found
}

fn without_attenuation(light: &Light) -> Option<String> {
    let source = &light.source;
    (source.position[3] != 0.0 && source.attenuation == [0.0; 3]).then(|| {
        format!(
            "light {}: attenuation 0, 0, 0 divides by 0: what it lights is infinitely bright; OpenGL's default is 1, 0, 0",
            light.name
        )
    })
}

/// Lights inside solids that block them.
fn lights_inside(scene: &Scene) -> Vec<String> {
    let blocks = |object: &Object| {
        let mut optics = object.materials.iter().map(|m| &scene.materials[*m].optics);
        scene.trace.shadow == Shadow::Opaque || !optics.any(|o| o.is_transmissive())
    };
    let mut found = Vec::new();
    for light in scene.enabled_lights() {
        let Some(place) = place(scene, light) else {
            continue;
        };
        let around = scene
            .objects
            .iter()
            .filter(|o| blocks(o) && holds(o, place));
        found.extend(around.map(|object| {
            format!(
                "light {} lies inside object {}, which blocks it: traced, it lights nothing outside",
                light.name, object.name
            )
        }));
    }
    found
}

/// Where a light is; `None` for directional ones.
fn place(scene: &Scene, light: &Light) -> Option<DVec3> {
    let [x, y, z, w] = light.source.position;
    let p = DVec3::new(x, y, z) / w;
    let camera = &scene.camera;
    let world = match light.space {
        LightSpace::World => p,
        LightSpace::Eye => camera.eye_from_world_rotation().transpose() * p + camera.eye,
    };
    (w != 0.0 && world.is_finite()).then_some(world)
}

/// Whether a solid holds a point.
fn holds(object: &Object, point: DVec3) -> bool {
    let inside = |b: Bounds| point.cmpgt(b.min).all() && point.cmplt(b.max).all();
    if !Bounds::of_object(object).is_some_and(inside) {
        return false;
    }
    let place = &object.world_from_object;
    let p = place.inverse().transform_point3(point);
    let along = |from: DVec3, to: DVec3| {
        let axis = to - from;
        let height = (p - from).dot(axis) / axis.length_squared();
        (height, (p - from - height * axis).length())
    };
    match &object.geometry {
        Geometry::Shape(Shape::Sphere { center, radius }) => (p - *center).length() < *radius,
        Geometry::Shape(Shape::Box { min, max }) => p.cmpgt(*min).all() && p.cmplt(*max).all(),
        Geometry::Shape(Shape::Cylinder {
            base,
            top,
            radius,
            caps,
        }) => {
            let (height, across) = along(*base, *top);
            *caps && height > 0.0 && height < 1.0 && across < *radius
        }
        Geometry::Shape(Shape::Cone {
            base,
            apex,
            radius,
            cap,
        }) => {
            let (height, across) = along(*base, *apex);
            *cap && height > 0.0 && across < (1.0 - height) * radius
        }
        Geometry::Shape(shape) => shape.is_closed() && surrounds(&object_mesh(object, None), p),
        Geometry::Mesh(mesh) => mesh.is_closed() && surrounds(mesh, p),
    }
}

/// Whether the triangles of a closed mesh go around a point: the solid angles that they are seen under add up to a whole
/// sphere, or to nothing (van Oosterom and Strackee 1983).
fn surrounds(mesh: &Mesh, p: DVec3) -> bool {
    let angle = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize] - p);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * libm::atan2(a.dot(b.cross(c)), below)
    };
    let whole: f64 = mesh.triangles.iter().map(angle).sum();
    whole.abs() > std::f64::consts::TAU
}

fn far_away(scene: &Scene) -> Option<String> {
    let bounds = Bounds::of_objects(&scene.objects)?;
    let (away, size) = (bounds.distance(scene.camera.eye), bounds.diagonal());
    (size > 0.0 && away > FAR * size && away.is_finite()).then(|| {
        format!(
            "the camera is {:.0} times the scene's size away from it: in f32, places in the picture and of lights are known to \
             {:.0e} of that size; `--precision f64` tells them apart",
            away / size,
            away / size / f64::from(1 << 24)
        )
    })
}
