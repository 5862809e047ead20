//! An input of a scene taken to an extreme.

use super::needles;
use crate::error::Error;
use crate::math::{DAffine3, DMat3, DVec2, DVec3};
use crate::render::{Assembled, Precision, Tracer};
use crate::scene::assembly::object_mesh;
use crate::scene::requirements::Model;
use crate::scene::{Geometry, LightSpace, Projection, Scene, Shape};
use crate::trace;
use crate::trace::ray::Ray;

/// What is done to a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// This exponent for every material with a specular colour.
    Shininess(f64),
    /// The whole scene this much larger.
    Scale(f64),
    /// The first point light at this distance before the surface in the picture's middle, scene units.
    LightDistance(f64),
    /// One distant light, degrees above the horizontal, on surfaces that have some gloss.
    Grazing(f64),
    /// Near and far plane, scene units; an infinite far plane is none.
    NearFar(f64, f64),
    /// Objects that are not flat, pressed along (1, 1, 1) to this fraction.
    Squash(f64),
    /// The same, sheared: x grows by this much times y.
    Shear(f64),
    /// The full vertical angle in degrees, around a straight outline near the picture's middle.
    FieldOfView(f64),
    /// Triangles of this length over width.
    Needles(f64),
}

impl Change {
    /// The setting in a few words.
    pub fn label(self) -> String {
        let plain = |x: f64| {
            if x == 0.0 || (1e-3..1e4).contains(&x) {
                format!("{x}")
            } else {
                format!("{x:e}")
            }
        };
        match self {
            Self::Shininess(s) => format!("exponent {}", plain(s)),
            Self::Scale(s) => format!("x {}", plain(s)),
            Self::LightDistance(0.0) => "on the surface".into(),
            Self::LightDistance(d) => format!("{} away", plain(d)),
            Self::Grazing(degrees) => format!("{} degrees", plain(degrees)),
            Self::NearFar(near, far) if far.is_finite() => {
                format!("{} to {}", plain(near), plain(far))
            }
            Self::NearFar(near, _) => format!("{} to infinity", plain(near)),
            Self::Squash(k) => format!("to {}", plain(k)),
            Self::Shear(k) => format!("shear {}", plain(k)),
            Self::FieldOfView(degrees) => format!("{} degrees", plain(degrees)),
            Self::Needles(aspect) => format!("aspect {}", plain(aspect)),
        }
    }

    /// Changes the scene.
    ///
    /// # Errors
    /// What planning a render of the scene refuses, where the change depends on what is seen.
    pub fn apply(self, scene: &mut Scene) -> Result<(), Error> {
        match self {
            Self::Shininess(s) => shininess(scene, s),
            Self::Scale(s) => scale(scene, s),
            Self::LightDistance(d) => light_distance(scene, d)?,
            Self::Grazing(degrees) => grazing(scene, degrees),
            Self::NearFar(near, far) => {
                scene.camera.near = near;
                scene.camera.far = far.is_finite().then_some(far);
            }
            Self::Squash(k) => {
                let third = (1.0 - k) / 3.0;
                let slanting = DMat3::from_cols_array(&[third; 9]);
                deform(scene, DMat3::IDENTITY - slanting);
            }
            Self::Shear(k) => {
                let mut shear = DMat3::IDENTITY;
                shear.y_axis.x = k;
                deform(scene, shear);
            }
            Self::FieldOfView(fovy_deg) => {
                scene.camera.target = outline(scene)?;
                scene.camera.projection = Projection::Perspective { fovy_deg };
            }
            Self::Needles(aspect) => needles::split(scene, aspect),
        }
        Ok(())
    }
}

fn shininess(scene: &mut Scene, exponent: f64) {
    for material in &mut scene.materials {
        for side in material.back.iter_mut().chain([&mut material.front]) {
            if side.specular != [0.0; 3] {
                side.shininess = exponent;
            }
        }
    }
}

fn scale(scene: &mut Scene, s: f64) {
    let camera = &mut scene.camera;
    (camera.eye, camera.target) = (camera.eye * s, camera.target * s);
    (camera.near, camera.far) = (camera.near * s, camera.far.map(|far| far * s));
    if let Projection::Orthographic { height } = &mut camera.projection {
        *height *= s;
    }
    for light in &mut scene.lights {
        let source = &mut light.source;
        if source.position[3] != 0.0 {
            source.position[..3].iter_mut().for_each(|x| *x *= s);
            source.attenuation[1] /= s;
            source.attenuation[2] /= s * s;
        }
    }
    for object in &mut scene.objects {
        let larger = DAffine3::from_scale(DVec3::splat(s));
        object.world_from_object = larger * object.world_from_object;
    }
}

/// Hands the true shapes of a scene to a question.
fn with_shapes<T>(scene: &Scene, ask: impl FnOnce(&Tracer<'_>) -> T) -> Result<T, Error> {
    let assembled = Assembled::unchecked(scene, Some(8), Precision::F64)?;
    let tracer = Tracer::new(scene, &assembled, trace::Geometry::Exact, Model::Required)?;
    Ok(ask(&tracer))
}

/// The ray through a place of the picture, 0 to 1 rightwards and downwards; world space.
fn ray_through(scene: &Scene, place: DVec2) -> Ray {
    let (camera, image) = (&scene.camera, &scene.image);
    let pixels = DVec2::new(f64::from(image.width), f64::from(image.height));
    let (origin, direction) = camera.primary_ray(place * pixels, image.width, image.height);
    let world_from_eye = camera.eye_from_world_rotation().transpose();
    Ray::new(
        camera.eye + world_from_eye * origin,
        world_from_eye * direction,
    )
}

/// The object that a ray meets, and how far along.
fn seen(shapes: &Tracer<'_>, ray: &Ray) -> Option<(u32, f64)> {
    let met = shapes.meets(ray)?;
    Some((met.object, met.t))
}

fn light_distance(scene: &mut Scene, distance: f64) -> Result<(), Error> {
    // The middle of a pixel, so that some pixel shows the very place.
    let middle = |n: u32| (f64::from(n / 2) + 0.5) / f64::from(n);
    let image = &scene.image;
    let ray = ray_through(scene, DVec2::new(middle(image.width), middle(image.height)));
    let place = with_shapes(scene, |shapes| {
        let foot = shapes.meets(&ray)?.foot;
        let towards = -foot.normal.dot(ray.direction);
        Some(foot.point + foot.normal * distance.copysign(distance * towards))
    })?;
    let lights = scene.lights.iter_mut();
    let mut points = lights.filter(|l| l.source.position[3] != 0.0 && l.space == LightSpace::World);
    if let (Some(place), Some(light)) = (place, points.next()) {
        light.source.position = place.extend(1.0).to_array();
    }
    Ok(())
}

fn grazing(scene: &mut Scene, degrees: f64) {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    for (i, light) in scene.lights.iter_mut().enumerate() {
        light.enabled = i == 0;
        light.space = LightSpace::World;
        // From the front and the left, so that both grounds and walls show it.
        light.source.position = [-0.8 * cos, sin, 0.6 * cos, 0.0];
        light.source.diffuse = [1.0; 3];
    }
    // Where light just does not reach, a highlight ends at once: the model's own jump, and the hardest place to decide.
    for material in &mut scene.materials {
        if material.front.specular == [0.0; 3] {
            (material.front.specular, material.front.shininess) = ([0.3; 3], 5.0);
        }
    }
}

/// Multiplies the places of objects that are not flat by a matrix, around the middle of each.
fn deform(scene: &mut Scene, matrix: DMat3) {
    for object in &mut scene.objects {
        if matches!(&object.geometry, Geometry::Shape(Shape::Patch { .. })) {
            continue;
        }
        let mesh = object_mesh(object, Some(8));
        let world = |p: &DVec3| object.world_from_object.transform_point3(*p);
        let low = mesh
            .positions
            .iter()
            .map(world)
            .fold(DVec3::INFINITY, DVec3::min);
        let high = mesh
            .positions
            .iter()
            .map(world)
            .fold(DVec3::NEG_INFINITY, DVec3::max);
        let middle = 0.5 * (low + high);
        let about = DAffine3::from_mat3_translation(matrix, middle - matrix * middle);
        object.world_from_object = about * object.world_from_object;
    }
}

/// A point on the outline of a flat object, near the picture's middle: found between two pixels, then by halving. Flat, so
/// that triangles have the same outline as the true shape.
fn outline(scene: &Scene) -> Result<DVec3, Error> {
    const STEPS: usize = 64;
    let found = with_shapes(scene, |shapes| {
        let at = |place: DVec2| seen(shapes, &ray_through(scene, place));
        let step = |i: usize| (i as f64 + 0.5) / STEPS as f64;
        let along = |across: f64| {
            let pairs = (0..STEPS - 1).map(|i| [step(i), step(i + 1)]);
            pairs.flat_map(move |[a, b]| {
                let row = [DVec2::new(a, across), DVec2::new(b, across)];
                [row, [DVec2::new(across, a), DVec2::new(across, b)]]
            })
        };
        let pairs = [0.5, 0.06, 0.94].into_iter().flat_map(along);
        let outlines = pairs.filter_map(|[a, b]| {
            let nearer = nearer([a, b], at)?;
            let flat = is_flat(scene, nearer.1.0) && at(a).map(|s| s.0) != at(b).map(|s| s.0);
            flat.then_some([a, b])
        });
        let off = |[a, _]: &[DVec2; 2]| (*a - DVec2::splat(0.5)).length();
        let [mut from, mut to] = outlines.min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let first = at(from).map(|seen| seen.0);
        for _ in 0..60 {
            let middle = 0.5 * (from + to);
            if at(middle).map(|seen| seen.0) == first {
                from = middle;
            } else {
                to = middle;
            }
        }
        let (place, (_, t)) = nearer([from, to], at)?;
        let ray = ray_through(scene, place);
        Some(ray.origin + t * ray.direction)
    })?;
    Ok(found.unwrap_or(scene.camera.target))
}

/// The place that sees the nearer object of two, and what it sees: whose outline runs between them.
fn nearer(
    places: [DVec2; 2],
    at: impl Fn(DVec2) -> Option<(u32, f64)>,
) -> Option<(DVec2, (u32, f64))> {
    let seen = places
        .into_iter()
        .filter_map(|place| Some((place, at(place)?)));
    seen.min_by(|a, b| a.1.1.total_cmp(&b.1.1))
}

fn is_flat(scene: &Scene, object: u32) -> bool {
    match &scene.objects[object as usize].geometry {
        Geometry::Shape(shape) => shape.is_flat(),
        Geometry::Mesh(_) => true,
    }
}
