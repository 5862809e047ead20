//! Shadow rays: the S_L that the lighting equation asks for, one light over many points.
//!
//! A point light is shadowed by what lies strictly between it and the point, a directional one by anything ahead; the
//! light itself is taken from the scene in world space and f64, so that "between" is decided on the numbers of the file.
//! `opaque`: 0 or 1. `filtered`: the product of K_T over every surface crossed, straight through, in order of distance (a
//! glass ball counts twice, once an interface, as its transmission does). No ray is cast for a light whose diffuse and
//! specular products with the material are 0, nor where the light does not face the point.

use super::Counters;
use super::bvh::Walker;
use super::faults::Faults;
use super::media::{Medium, Order};
use super::ray::{Hit, Ray};
use super::record::{Record, ShadowRecord};
use super::surface::{Site, Surfaces};
use crate::gl;
use crate::lanes::Real;
use crate::lighting::{Illumination, Visibility};
use crate::math::DVec3;
use crate::scene::{LightSpace, Scene, Shadow};

/// Where a light is, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lamp {
    /// At a point.
    Point(DVec3),
    /// Infinitely far in a direction (towards the light).
    Direction(DVec3),
}

/// The enabled lights in file order.
pub(super) fn lamps(scene: &Scene) -> Vec<Lamp> {
    let world_from_eye = scene.camera.eye_from_world_rotation().transpose();
    let place = |light: &crate::scene::Light| {
        let [x, y, z, w] = light.source.position;
        let xyz = DVec3::new(x, y, z);
        match (light.space, w == 0.0) {
            (LightSpace::World, true) => Lamp::Direction(xyz),
            (LightSpace::World, false) => Lamp::Point(xyz / w),
            (LightSpace::Eye, true) => Lamp::Direction(world_from_eye * xyz),
            (LightSpace::Eye, false) => Lamp::Point(world_from_eye * (xyz / w) + scene.camera.eye),
        }
    };
    scene.enabled_lights().map(place).collect()
}

/// The ray from a hit towards a light.
pub(super) fn shadow_ray<R>(site: &Site<R>, lamp: Lamp) -> Ray {
    let foot = &site.foot;
    let towards = match lamp {
        Lamp::Point(p) => p - foot.point,
        Lamp::Direction(d) => d,
    };
    let origin = foot.spawn(towards);
    let ray = match lamp {
        Lamp::Point(p) => Ray::towards(origin, p),
        Lamp::Direction(d) => Ray::new(origin, d),
    };
    let inside = foot.normal.dot(towards) < 0.0;
    Ray {
        skip: site.skip[usize::from(inside)],
        set: site.set[usize::from(inside)],
        ..ray
    }
}

/// Answers the equation's question for the points of one batch.
pub(super) struct Shadows<'s, 'a, R> {
    pub(super) surfaces: &'s Surfaces<'a, R>,
    pub(super) scene: &'s Scene,
    pub(super) lamps: &'s [Lamp],
    /// Of each, the faces whose planes it lies in.
    pub(super) lamp_planes: &'s [Vec<(u32, u32)>],
    /// What orders the solids.
    pub(super) order: &'s Order,
    /// GL source of each lamp, for its colours.
    pub(super) sources: &'s [gl::LightSource],
    pub(super) material: &'s gl::Material,
    /// Mistakes asked for.
    pub(super) faults: &'s Faults,
    /// `--model full`: rays are cast even where no product can show them.
    pub(super) ask_all: bool,
    /// Sites of the queue; `tags` says which one each point of the batch is.
    pub(super) sites: &'s [Option<Site<R>>],
    pub(super) tags: &'s [u32],
    pub(super) walker: &'s mut Walker,
    pub(super) counters: &'s mut Counters,
    /// Who listens, if anybody does.
    pub(super) record: Option<&'s mut Record<R>>,
}

impl<R: Real> Visibility<R> for Shadows<'_, '_, R> {
    fn query(&mut self, light: usize, illumination: &Illumination<R>, out: &mut [Vec<R>; 3]) {
        if !self.ask_all && !casts_shadows(self.material, &self.sources[light]) {
            return;
        }
        let lamp = self.lamps[light];
        if self.faults.never_blocks(lamp) {
            return;
        }
        for (i, &tag) in self.tags.iter().enumerate() {
            let (true, Some(site)) = (illumination.facing[i], &self.sites[tag as usize]) else {
                continue;
            };
            let mut ray = shadow_ray(site, lamp);
            self.faults.shadow_ray(&mut ray, &site.foot, lamp);
            self.counters.rays.shadow += 1;
            let way = Way {
                surfaces: self.surfaces,
                scene: self.scene,
                faults: self.faults,
                order: self.order,
                planes: &self.lamp_planes[light],
                lamp,
                ray,
            };
            let lit = way.light_through(self.walker);
            if let Some(record) = self.record.as_deref_mut() {
                let crossed = way.crossed(lit);
                record.shadow(tag, light, ShadowRecord { ray, lit, crossed });
            }
            for (channel, s) in out.iter_mut().zip(lit) {
                channel[i] = R::from_f64(s);
            }
        }
    }
}

/// From a point to a light.
struct Way<'s, 'a, R> {
    surfaces: &'s Surfaces<'a, R>,
    scene: &'s Scene,
    faults: &'s Faults,
    order: &'s Order,
    /// Faces whose planes the lamp lies in.
    planes: &'s [(u32, u32)],
    lamp: Lamp,
    ray: Ray,
}

/// Curved faces are asked where they are beside a light only if they are met in the last 2^-20 of the way: what lies at the
/// light seems to be there, and a grazing ray errs by far less.
const NEAR_LIGHT: f64 = 1.0 - 1.0 / (1 << 20) as f64;

impl<R: Real> Way<'_, '_, R> {
    /// Whether a hit lies strictly between the point and the light: a face that the light lies on does not. A plane through the
    /// light is met there or nowhere; a curved face where the hit is the light's place, as far as can be told.
    fn is_between(&self, hit: &Hit) -> bool {
        let Lamp::Point(light) = self.lamp else {
            return true;
        };
        if !self.planes.is_empty() && self.planes.binary_search(&self.surfaces.face(hit)).is_ok() {
            return false;
        }
        if hit.t < NEAR_LIGHT || hit.t >= 1.0 || self.surfaces.is_flat(hit) {
            return true;
        }
        let foot = self.surfaces.site_with(&self.ray, hit, None, false).foot;
        // The transforms that placed shape and light may round as often as those of faces in contact.
        let size = foot.point.abs().max(light.abs()).max_element() + foot.scale;
        let doubt = foot.bound() + 16.0 * f64::EPSILON * size;
        (light - foot.point).dot(foot.normal).abs() > doubt
    }

    fn transmission(&self, hit: &Hit) -> [f64; 3] {
        let material = self.surfaces.material(&self.ray, hit);
        self.scene.materials[material as usize].optics.transmission
    }

    fn light_through(&self, walker: &mut Walker) -> [f64; 3] {
        let opaque = self.scene.trace.shadow == Shadow::Opaque;
        if self.order.prioritized {
            return self.light_by_priority(walker);
        }
        if opaque {
            let (surfaces, ray) = (self.surfaces, &self.ray);
            let blocked = self
                .faults
                .any_hit(surfaces, ray, walker, |hit| self.is_between(hit));
            return [if blocked { 0.0 } else { 1.0 }; 3];
        }
        let clear = |hit: &Hit| self.transmission(hit).iter().any(|k| *k != 0.0);
        let keep = |hit: &Hit| clear(hit) || !self.is_between(hit);
        let found = self.surfaces.crossings(&self.ray, walker, keep);
        found.map_or([0.0; 3], |hits| self.filtered(hits.iter()))
    }

    /// K_T of every hit between, in order.
    fn filtered<'h>(&self, hits: impl Iterator<Item = &'h Hit>) -> [f64; 3] {
        hits.filter(|hit| self.is_between(hit))
            .fold([1.0; 3], |s, hit| {
                let k = self.transmission(hit);
                [s[0] * k[0], s[1] * k[1], s[2] * k[2]]
            })
    }

    /// The same where solids have priorities: surfaces inside a solid of a higher one are not there. A place is inside the
    /// solids that the way crosses an odd number of times beyond it.
    fn light_by_priority(&self, walker: &mut Walker) -> [f64; 3] {
        let endless = Ray {
            t_max: f64::INFINITY,
            ..self.ray
        };
        let all = self.surfaces.crossings(&endless, walker, |_| true);
        let all = all.unwrap_or_default();
        let medium = |hit: &Hit| {
            let material = self.surfaces.material(&self.ray, hit) as usize;
            let optics = &self.scene.materials[material].optics;
            let solid = optics.is_transmissive() && !optics.thin;
            solid.then(|| self.order.medium(self.surfaces.object(hit), optics.ior))
        };
        let media: Vec<Option<Medium>> = all.iter().map(medium).collect();
        let is_there = |at: usize| {
            let Some(own) = media[at] else { return true };
            let higher = media[at + 1..].iter().flatten();
            let higher = higher.filter(|m| m.priority > own.priority);
            let mut around: Vec<u32> = Vec::new();
            for m in higher {
                match around.iter().position(|object| *object == m.object) {
                    Some(found) => {
                        around.swap_remove(found);
                    }
                    None => around.push(m.object),
                }
            }
            around.is_empty()
        };
        let there = all
            .iter()
            .enumerate()
            .filter(|(i, hit)| hit.t <= self.ray.t_max && self.is_between(hit) && is_there(*i));
        let there: Vec<Hit> = there.map(|(_, hit)| *hit).collect();
        match self.scene.trace.shadow {
            Shadow::Opaque if there.is_empty() => [1.0; 3],
            Shadow::Opaque => [0.0; 3],
            Shadow::Filtered => self.filtered(there.iter()),
        }
    }

    /// What took light from the ray: the nearest blocker, or every filter that it crosses up to the first that blocks.
    fn crossed(&self, lit: [f64; 3]) -> Vec<(u32, f64)> {
        let mut walker = Walker::default();
        let all = self.surfaces.crossings(&self.ray, &mut walker, |_| true);
        let hits = all.unwrap_or_default();
        let mut hits = hits.iter().filter(|hit| self.is_between(hit));
        let name = |hit: &Hit| (self.surfaces.object(hit), hit.t);
        if self.scene.trace.shadow == Shadow::Opaque {
            let blocked = lit == [0.0; 3];
            return hits
                .next()
                .filter(|_| blocked)
                .map(name)
                .into_iter()
                .collect();
        }
        let mut found = Vec::new();
        for hit in hits {
            found.push(name(hit));
            let material = &self.scene.materials[self.surfaces.material(&self.ray, hit) as usize];
            if lit == [0.0; 3] && !material.optics.is_transmissive() {
                break;
            }
        }
        found
    }
}

/// Whether S_L of this light can matter to this material.
fn casts_shadows(material: &gl::Material, light: &gl::LightSource) -> bool {
    let product = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).any(|(a, b)| a * b != 0.0);
    product(&material.diffuse, &light.diffuse) || product(&material.specular, &light.specular)
}
