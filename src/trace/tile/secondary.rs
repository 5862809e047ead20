//! From hits to the rays of the next wave: surfaces that touch, and what each hit reflects and transmits.

use super::Tile;
use crate::error::Error;
use crate::lanes::Real;
use crate::math::DVec3;
use crate::scene::requirements::Feature;
use crate::trace::MAX_RAYS;
use crate::trace::branch::{Fork, Path};
use crate::trace::faults::Normals;
use crate::trace::ray::Hit;
use crate::trace::surface::Site;
use crate::trace::touch::Touching;

impl<'p, 'a, R: Real> Tile<'p, 'a, R> {
    /// Which secondary rays are cast: those asked for that the scene has a use for.
    pub(super) fn wanted(&self) -> [bool; 2] {
        let needs = &self.plan.needs;
        [
            self.options.reflection && needs.has(Feature::ReflectionRays),
            self.options.refraction && needs.has(Feature::RefractionRays),
        ]
    }

    /// Adds the secondary rays of a hit to the next wave.
    pub(super) fn fork(
        &mut self,
        tag: u32,
        path: &Path,
        site: &Site<R>,
        next: &mut Vec<Path>,
    ) -> Result<(), Error> {
        let optics = &self.plan.scene.materials[site.material as usize].optics;
        if !optics.is_mirror() && !optics.is_transmissive() {
            return Ok(());
        }
        let touching = self.touching_of(tag);
        let fork = Fork {
            path,
            touching: &touching,
            foot: &site.foot,
            skip: site.skip,
            normal_world: self.rotation.transpose() * DVec3::from_array(site.normal_eye),
            object: site.object,
            optics,
            settings: &self.plan.scene.trace,
            wanted: self.wanted(),
            bends: self.plan.needs.has(Feature::Tir),
            faults: &self.plan.faults,
        };
        let forked = fork.branches(&mut self.media);
        if let Some(record) = &mut self.record {
            record.fork(tag, &forked);
        }
        let (reflection, refraction) = (forked.reflection, forked.refraction);
        self.counters.rays.reflection += u64::from(reflection.is_some());
        self.counters.rays.refraction += u64::from(refraction.is_some());
        let before = next.len();
        next.extend([reflection, refraction].into_iter().flatten());
        let rays = &mut self.sums.rays[path.pixel as usize];
        *rays += (next.len() - before) as u32;
        if *rays > MAX_RAYS {
            let (x, y) = self.pixel_place(path.pixel);
            return Err(Error::limit(format!(
                "pixel {x} {y}: more than {MAX_RAYS} secondary rays for one sample"
            ))
            .with_help("lower the depth, or raise trace.weight_cutoff"));
        }
        Ok(())
    }

    /// What a ray meets where surfaces touch (`touch`): the opaque one that the solid it is in stands on, else the one it met;
    /// then those that it passes with it are kept for [`Self::fork`].
    pub(super) fn settle(&mut self, tag: u32, path: &Path, hit: &Hit, site: Site<R>) -> Site<R> {
        let materials = &self.plan.scene.materials;
        let clear = |site: &Site<R>| materials[site.material as usize].optics.is_transmissive();
        // Normals that `check` bends are those of the surface met.
        let bent = self.plan.faults.normals != Normals::Right;
        if bent || !self.wanted()[1] || !clear(&site) {
            return site;
        }
        let surfaces = &self.plan.surfaces;
        let others = surfaces.touching(&path.ray, hit, &site.foot, &mut self.walker);
        let passed = others.iter().take_while(|other| clear(other)).count();
        if passed < others.len() && self.media.hold(path.media, site.object) {
            return others[passed];
        }
        let kept = others[..passed].iter().map(|other| (tag, *other));
        self.touching.extend(kept);
        site
    }

    /// What a ray passes with the surface that it met.
    fn touching_of(&self, tag: u32) -> Vec<Touching<'p>> {
        let first = self.touching.partition_point(|(t, _)| *t < tag);
        let of_tag = self.touching[first..].iter().take_while(|(t, _)| *t == tag);
        let plan = self.plan;
        of_tag
            .map(|(_, site)| Touching {
                object: site.object,
                optics: &plan.scene.materials[site.material as usize].optics,
                foot: site.foot,
                skip: site.skip,
            })
            .collect()
    }
}
