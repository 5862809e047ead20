//! From hits to the rays of the next wave: what each hit reflects and transmits.

use super::{Passed, Tile};
use crate::error::Error;
use crate::lanes::Real;
use crate::math::DVec3;
use crate::scene::requirements::Feature;
use crate::trace::MAX_RAYS;
use crate::trace::branch::{Fork, NO_END, Path};
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
        let (touching, end) = self.passed_by(tag);
        let fork = Fork {
            path,
            touching: &touching,
            end,
            order: &self.plan.order,
            foot: &site.foot,
            skip: site.skip,
            set: site.set,
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

    /// What a ray passes with the surface that it met: clear surfaces, and the opaque hit that ends it.
    fn passed_by(&self, tag: u32) -> (Vec<Touching<'p>>, u32) {
        let first = self.passed.partition_point(|p| p.tag() < tag);
        let of_tag = self.passed[first..].iter().take_while(|p| p.tag() == tag);
        let (mut touching, mut stop) = (Vec::new(), NO_END);
        for passed in of_tag {
            match *passed {
                Passed::Opaque { end, .. } => stop = end,
                Passed::Clear {
                    object,
                    material,
                    unseen,
                    ..
                } => touching.push(Touching {
                    object,
                    unseen,
                    optics: &self.plan.scene.materials[material as usize].optics,
                }),
            }
        }
        (touching, stop)
    }
}
