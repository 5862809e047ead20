//! Shading of a wave: its hits by surface, then the sums that they go to.

use super::{Terms, Tile};
use crate::frame::LayerIndex;
use crate::gl;
use crate::lanes::Real;
use crate::lighting::{Batch, Sink, Visibility, shade};
use crate::math::Each;
use crate::scene::requirements::Feature;
use crate::trace::branch::{Branch, Path};
use crate::trace::shadow::Shadows;
use crate::trace::surface::Site;

impl<'p, 'a, R: Real> Tile<'p, 'a, R> {
    /// Primary hits: their terms are the picture's own; misses show the background.
    pub(super) fn add_local(&mut self, paths: &[Path], sites: &[Option<Site<R>>]) {
        let background = self
            .plan
            .scene
            .background()
            .map(|x| R::ZERO + R::from_f64(x));
        for (path, _) in paths.iter().zip(sites).filter(|(_, site)| site.is_none()) {
            let pixel = path.pixel as usize;
            self.sums.local[pixel] = background;
            if let Some(emission) = self.sums.terms.get_mut(LayerIndex::EMISSION) {
                emission[pixel] = background;
            }
        }
        let batches = std::mem::take(&mut self.batches);
        for batch in batches.iter() {
            let terms = self.shade(batch, sites, self.sums.recording());
            for (slot, &tag) in batch.tags.iter().enumerate() {
                let pixel = paths[tag as usize].pixel as usize;
                for (k, term) in terms.iter().enumerate() {
                    let value = [term[0][slot], term[1][slot], term[2][slot]];
                    if self.sums.recording() {
                        self.sums.terms[k][pixel] = value;
                    } else {
                        self.sums.local[pixel] = value;
                    }
                }
            }
        }
        self.batches = batches;
    }

    /// Secondary hits and misses: weight x term, in the order of the wave.
    pub(super) fn add_bounced(&mut self, paths: &[Path], sites: &[Option<Site<R>>]) {
        let batches = std::mem::take(&mut self.batches);
        let mut shaded: Vec<Terms<R>> = Vec::new();
        let mut places = vec![(0u32, 0u32); paths.len()];
        for (number, batch) in batches.iter().enumerate() {
            shaded.push(self.shade(batch, sites, true));
            for (slot, &tag) in batch.tags.iter().enumerate() {
                places[tag as usize] = (number as u32, slot as u32);
            }
        }
        self.batches = batches;
        let background = self.plan.scene.background().each(R::from_f64);
        let index = LayerIndex {
            lights: self.plan.lamps.len(),
        };
        for (i, path) in paths.iter().enumerate() {
            let layer = usize::from(path.branch == Branch::Refraction);
            let pixel = path.pixel as usize;
            if sites[i].is_none() {
                let part = index.split(layer, index.lights);
                self.sums.add(layer, pixel, path.weight, background);
                self.sums.add_split(part, pixel, path.weight, background);
                continue;
            }
            let (number, slot) = (places[i].0 as usize, places[i].1 as usize);
            for (k, term) in shaded[number].iter().enumerate() {
                let value = [term[0][slot], term[1][slot], term[2][slot]];
                let part = index.split(layer, index.light_of(k));
                self.sums.add(layer, pixel, path.weight, value);
                self.sums.add_split(part, pixel, path.weight, value);
            }
        }
    }

    /// Asks the equation for a batch: every term where `record`, else one sum.
    fn shade(&mut self, batch: &Batch<R>, sites: &[Option<Site<R>>], record: bool) -> Terms<R> {
        let plan = self.plan;
        let material = plan.material(batch.surface);
        // Where terms follow the vertex colour, any light that it reflects may be shadowed.
        let white = material
            .tracked
            .any()
            .then(|| material.with_color(gl::CURRENT_COLOR));
        let mut shadows = Shadows {
            surfaces: &plan.surfaces,
            scene: plan.scene,
            lamps: &plan.lamps,
            lamp_planes: &plan.lamp_planes,
            order: &plan.order,
            sources: &plan.sources,
            material: white.as_ref().unwrap_or(material),
            faults: &plan.faults,
            ask_all: plan.needs.is_full(),
            sites,
            tags: &batch.tags,
            walker: &mut self.walker,
            counters: &mut self.counters,
            record: self.record.as_deref_mut(),
        };
        let wanted = self.options.shadows && plan.needs.has(Feature::ShadowRays);
        let visibility = wanted.then_some(&mut shadows as &mut dyn Visibility<R>);
        let (isa, rig) = (self.options.isa, &plan.rig);
        let mut terms = Vec::new();
        let mut sum = [Vec::new(), Vec::new(), Vec::new()];
        let sink = if record {
            Sink::Record(&mut terms)
        } else {
            Sink::Sum(&mut sum)
        };
        let counted = shade(
            isa,
            rig,
            material,
            &batch.points,
            visibility,
            self.signed,
            sink,
        );
        self.counters.lighting += counted;
        if let Some(listener) = &mut self.record {
            listener.shaded(batch, &terms);
        }
        if record { terms } else { vec![sum] }
    }
}
