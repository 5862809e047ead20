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
use super::ray::{Foot, Hit, Ray};
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
pub(super) fn shadow_ray(foot: &Foot, skip: [u32; 2], lamp: Lamp) -> Ray {
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
        skip: skip[usize::from(inside)],
        ..ray
    }
}

/// Answers the equation's question for the points of one batch.
pub(super) struct Shadows<'s, 'a, R> {
    pub(super) surfaces: &'s Surfaces<'a, R>,
    pub(super) scene: &'s Scene,
    pub(super) lamps: &'s [Lamp],
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
            let mut ray = shadow_ray(&site.foot, site.skip, lamp);
            self.faults.shadow_ray(&mut ray, &site.foot, lamp);
            self.counters.rays.shadow += 1;
            let lit = self.light_through(&ray);
            if let Some(record) = self.record.as_deref_mut() {
                let crossed = crossed(self.surfaces, self.scene, &ray, lit);
                record.shadow(tag, light, ShadowRecord { ray, lit, crossed });
            }
            for (channel, s) in out.iter_mut().zip(lit) {
                channel[i] = R::from_f64(s);
            }
        }
    }
}

impl<R: Real> Shadows<'_, '_, R> {
    fn light_through(&mut self, ray: &Ray) -> [f64; 3] {
        if self.scene.trace.shadow == Shadow::Opaque {
            let blocked = self.faults.any_hit(self.surfaces, ray, self.walker);
            return [if blocked { 0.0 } else { 1.0 }; 3];
        }
        let (surfaces, materials) = (self.surfaces, &self.scene.materials);
        let k_t = |hit: &_| {
            materials[surfaces.material(ray, hit) as usize]
                .optics
                .transmission
        };
        let clear = |hit: &_| k_t(hit).iter().any(|k| *k != 0.0);
        surfaces
            .crossings(ray, self.walker, clear)
            .map_or([0.0; 3], |hits| {
                hits.iter().fold([1.0; 3], |s, hit| {
                    let k = k_t(hit);
                    [s[0] * k[0], s[1] * k[1], s[2] * k[2]]
                })
            })
    }
}

/// What took light from a shadow ray: the nearest blocker, or every filter that it crosses up to the first that blocks.
fn crossed<R: Real>(
    surfaces: &Surfaces<'_, R>,
    scene: &Scene,
    ray: &Ray,
    lit: [f64; 3],
) -> Vec<(u32, f64)> {
    let name = |hit: &Hit| (surfaces.object(hit), hit.t);
    let mut walker = Walker::default();
    if scene.trace.shadow == Shadow::Opaque {
        let nearest = surfaces.closest_hit(ray, &mut walker);
        return nearest.iter().map(name).collect();
    }
    let all = surfaces.crossings(ray, &mut walker, |_| true);
    let mut found = Vec::new();
    for hit in all.unwrap_or_default() {
        found.push(name(&hit));
        let material = &scene.materials[surfaces.material(ray, &hit) as usize];
        if lit == [0.0; 3] && !material.optics.is_transmissive() {
            break;
        }
    }
    found
}

/// Whether S_L of this light can matter to this material.
fn casts_shadows(material: &gl::Material, light: &gl::LightSource) -> bool {
    let product = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).any(|(a, b)| a * b != 0.0);
    product(&material.diffuse, &light.diffuse) || product(&material.specular, &light.specular)
}
