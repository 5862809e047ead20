//! The media that primary rays start in, where the camera stands inside something transmissive.
//!
//! A primary ray counts from the near plane on: what lies between it and the eye is cut away, as clipping cuts it. So the
//! ray starts in the media around its *near point*, whatever the projection: the eye's for a perspective view inside one
//! medium, a point's own for each ray of an orthographic view, and the inside of a solid that the near plane cuts open.
//!
//! A point's media are the list that a ray would have which came to it against the view direction from infinitely far away,
//! by the list rule of whitted.md section 2 ([`super::media`]). So of nested solids the innermost is the last, every solid
//! around the point is in the list once (its surface is crossed an odd number of times, by the exact functions), and a ray
//! that goes straight on ends in air. Where solids overlap without one being inside the other, the one entered last on that
//! way counts.
//!
//! What counts: closed shapes ([`Shape::is_closed`](crate::scene::Shape::is_closed)) and closed meshes
//! ([`Mesh::is_closed`](crate::scene::Mesh::is_closed)) with a material that is transmissive and not thin; its first such
//! material gives the index. A sheet, an open tube or a set of Bezier patches has no inside here: rays enter it where they
//! cross it, as before. Only objects whose bounds reach the near plane's part in the picture are looked at, so where no
//! transmissive solid is near the camera this costs nothing; else one walk of [`Surfaces::crossings`] a primary ray whose
//! near point is in their bounds. Those walks count as work, not as rays.
//! Left out: a closed mesh of which only some faces are thin or opaque counts every face.

use super::bvh::Walker;
use super::media::{AIR, Media, MediaId, Medium, Order};
use super::ray::{Hit, Ray};
use super::surface::Surfaces;
use crate::lanes::Real;
use crate::math::Each;
use crate::math::{DVec2, DVec3};
use crate::scene::fit::Bounds;
use crate::scene::{Geometry, Object, Scene};

/// The solids that primary rays may start in.
#[derive(Clone, Debug)]
pub(super) struct Inside {
    solids: Vec<Solid>,
    /// The view direction, world space.
    forward: DVec3,
}

/// A closed object of a transmissive material.
#[derive(Clone, Copy, Debug)]
struct Solid {
    object: u32,
    ior: f64,
    bounds: Bounds,
}

impl Inside {
    /// The solids of a scene that reach the near plane's part in the picture.
    pub(super) fn new(scene: &Scene) -> Self {
        let forward = scene.camera.target - scene.camera.eye;
        Self::reaching(scene, near_points(scene), forward)
    }

    /// The solids that a ray of the caller's may start in.
    pub(super) fn around(scene: &Scene, ray: &Ray) -> Self {
        let point = ray.origin + ray.t_min * ray.direction;
        let near = point.is_finite().then_some(Bounds {
            min: point,
            max: point,
        });
        Self::reaching(scene, near, ray.direction)
    }

    fn reaching(scene: &Scene, near: Option<Bounds>, forward: DVec3) -> Self {
        let solid = |(index, object): (usize, &Object)| {
            let mut optics = object.materials.iter().map(|m| &scene.materials[*m].optics);
            let ior = optics.find(|o| o.is_transmissive() && !o.thin)?.ior;
            let bounds = Bounds::of_object(object)?;
            let reaches = near.is_some_and(|near| meet(&bounds, &near));
            let number = index as u32;
            (reaches && is_closed(object)).then_some(Solid {
                object: number,
                ior,
                bounds,
            })
        };
        Self {
            solids: scene.objects.iter().enumerate().filter_map(solid).collect(),
            forward,
        }
    }

    /// The media that a primary ray starts in.
    #[inline]
    pub(super) fn media<R: Real>(
        &self,
        ray: &Ray,
        surfaces: &Surfaces<'_, R>,
        order: &Order,
        walker: &mut Walker,
        media: &mut Media,
    ) -> MediaId {
        if self.solids.is_empty() {
            return AIR;
        }
        let near = ray.origin + ray.t_min * ray.direction;
        if !self.solids.iter().any(|solid| holds(&solid.bounds, near)) {
            return AIR;
        }
        let ahead = Ray::new(near, self.forward);
        let mut hits = surfaces
            .crossings(&ahead, walker, |_| true)
            .unwrap_or_default();
        // From far away back to the near point, all that touch at one place at once.
        let mut list = AIR;
        while let Some(last) = hits.pop() {
            let mut together = vec![last];
            hits.retain(|hit| {
                let touches = surfaces.same_place(&ahead, &last, hit);
                if touches {
                    together.push(*hit);
                }
                !touches
            });
            let solid = |hit: &Hit| {
                let object = surfaces.object(hit);
                let solid = self.solids.iter().find(|solid| solid.object == object)?;
                Some(order.medium(object, solid.ior))
            };
            let solids: Vec<Medium> = together.iter().filter_map(solid).collect();
            list = media.pass(list, &solids).media;
        }
        list
    }
}

fn is_closed(object: &Object) -> bool {
    match &object.geometry {
        Geometry::Shape(shape) => shape.is_closed(),
        Geometry::Mesh(mesh) => mesh.is_closed(),
    }
}

/// The box around the near points of the picture's corners, world space: it holds those of all pixels, since they lie in a
/// plane. `None` where they are not finite.
fn near_points(scene: &Scene) -> Option<Bounds> {
    let (image, camera) = (&scene.image, &scene.camera);
    let world_from_eye = camera.eye_from_world_rotation().transpose();
    let (width, height) = (f64::from(image.width), f64::from(image.height));
    let corners = [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]];
    let near = corners.each(|corner| {
        let place = DVec2::from_array(corner);
        let (origin, direction) = camera.primary_ray(place, image.width, image.height);
        let [t_min, _] = camera.ray_range(place, image.width, image.height);
        camera.eye + world_from_eye * (origin + t_min * direction)
    });
    let finite = near.iter().all(|p| p.is_finite());
    let all = near.each(|p| Bounds { min: p, max: p });
    let all = all.into_iter().reduce(|a, b| a.union(&b))?;
    finite.then_some(all)
}

fn meet(a: &Bounds, b: &Bounds) -> bool {
    a.min.cmple(b.max).all() && b.min.cmple(a.max).all()
}

fn holds(bounds: &Bounds, p: DVec3) -> bool {
    bounds.min.cmple(p).all() && p.cmple(bounds.max).all()
}
