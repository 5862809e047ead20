//! What a ray meets: the nearest hit, or the event of all that touch there ([`crate::trace::touch`]).

use super::{Passed, Tile};
use crate::lanes::Real;
use crate::scene::requirements::Feature;
use crate::trace::branch::{Branch, NO_END, Path};
use crate::trace::faults::Normals;
use crate::trace::media::{MediaId, Medium};
use crate::trace::ray::Hit;
use crate::trace::surface::Site;
use crate::trace::touch::Event;

impl<'p, 'a, R: Real> Tile<'p, 'a, R> {
    /// The hit that is seen. Of surfaces that are not there, since they lie inside a solid of a higher priority, only the
    /// media behind them stay: the ray itself goes on, and no generation is spent.
    pub(super) fn find(&mut self, tag: u32, path: &mut Path) -> Option<(Hit, Site<R>)> {
        loop {
            if path.end != NO_END {
                let (hit, scale) = self.ends[path.end as usize];
                return Some((hit, self.site_of(path, &hit, scale)));
            }
            let surfaces = &self.plan.surfaces;
            let faults = &self.plan.faults;
            let hit = faults.closest_hit(surfaces, &path.ray, &mut self.walker)?;
            let site = self.site_of(path, &hit, 0.0);
            let event = self.event_at(path, &hit, &site);
            if self.plan.order.prioritized
                && let Some(media) = self.passes_unseen(path, &hit, &event)
            {
                let hits = event
                    .as_ref()
                    .map_or(std::slice::from_ref(&hit), |e| &e.hits);
                let farthest = hits.iter().map(|hit| hit.t).fold(hit.t, f64::max);
                path.media = media;
                path.ray.t_min = farthest.next_up();
                continue;
            }
            return Some(match event {
                None => (hit, site),
                Some(event) => self.settle(tag, path, (hit, site), event),
            });
        }
    }

    /// What is at a hit of a path, its error bound widened.
    fn site_of(&self, path: &Path, hit: &Hit, scale: f64) -> Site<R> {
        let primary = path.branch == Branch::Primary;
        let eye_ray = self.eye_rays.get(path.pixel as usize).copied();
        let eye_ray = eye_ray.filter(|_| primary);
        let normal = self.wants_normals();
        let surfaces = &self.plan.surfaces;
        let mut site = surfaces.site_with(&path.ray, hit, eye_ray, normal);
        site.foot.scale += scale;
        site
    }

    /// Without shading and without secondary rays nothing asks for the shading normal.
    pub(super) fn wants_normals(&self) -> bool {
        self.plan.needs.has(Feature::Normal) || self.wanted().contains(&true)
    }

    fn is_clear(&self, material: u32) -> bool {
        let materials = &self.plan.scene.materials;
        materials[material as usize].optics.is_transmissive()
    }

    /// What else the ray meets there.
    fn event_at(&mut self, path: &Path, hit: &Hit, site: &Site<R>) -> Option<Event> {
        let plan = self.plan;
        if plan.faults.misses_the_nearest() {
            return None;
        }
        // Normals that `check` bends are those of the surface met.
        let bent = plan.faults.normals != Normals::Right;
        let doubtful = !bent && self.wanted()[1] && self.is_clear(site.material);
        let walker = &mut self.walker;
        plan.surfaces
            .event(&path.ray, (hit, site), doubtful, walker)
    }

    /// The one that is seen of all; what the ray passes with it is kept for [`Self::fork`].
    fn settle(
        &mut self,
        tag: u32,
        path: &Path,
        (hit, site): (Hit, Site<R>),
        event: Event,
    ) -> (Hit, Site<R>) {
        let media = self.media_across(path, &event.hits);
        let there: Vec<Hit> = event
            .hits
            .iter()
            .filter(|hit| !self.hides(media, path, hit))
            .copied()
            .collect();
        let seen = there.first().copied().unwrap_or(hit);
        let site = if seen == hit {
            let mut site = site;
            site.foot.scale += event.scale;
            site
        } else {
            self.site_of(path, &seen, event.scale)
        };
        if !self.wanted()[1] || !self.is_clear(site.material) {
            return (seen, site);
        }
        let surfaces = &self.plan.surfaces;
        for other in &event.hits {
            if *other == seen {
                continue;
            }
            let material = surfaces.material(&path.ray, other);
            if !self.is_clear(material) {
                let end = self.ends.len() as u32;
                self.ends.push((*other, event.scale));
                self.passed.push(Passed::Opaque { tag, end });
                break;
            }
            let object = surfaces.object(other);
            let unseen = self.hides(media, path, other);
            self.passed.push(Passed::Clear {
                tag,
                object,
                material,
                unseen,
            });
        }
        (seen, site)
    }

    /// The media behind hits of which none is there.
    fn passes_unseen(&mut self, path: &Path, hit: &Hit, event: &Option<Event>) -> Option<MediaId> {
        let hits = event
            .as_ref()
            .map_or(std::slice::from_ref(hit), |e| &e.hits);
        let media = self.media_across(path, hits);
        let unseen = hits.iter().all(|hit| self.hides(media, path, hit));
        unseen.then_some(media[1])
    }

    /// The media before hits at one place, and behind them.
    fn media_across(&mut self, path: &Path, hits: &[Hit]) -> [MediaId; 2] {
        if !self.plan.order.prioritized {
            return [path.media; 2];
        }
        let solids: Vec<Medium> = hits
            .iter()
            .filter_map(|hit| self.solid_of(path, hit))
            .collect();
        [path.media, self.media.pass(path.media, &solids).media]
    }

    fn hides(&self, media: [MediaId; 2], path: &Path, hit: &Hit) -> bool {
        self.plan.order.prioritized
            && self
                .solid_of(path, hit)
                .is_some_and(|solid| self.media.hides(media, &solid))
    }

    /// The solid whose surface a hit is on, if it is clear.
    fn solid_of(&self, path: &Path, hit: &Hit) -> Option<Medium> {
        let surfaces = &self.plan.surfaces;
        let material = surfaces.material(&path.ray, hit) as usize;
        let optics = &self.plan.scene.materials[material].optics;
        let solid = optics.is_transmissive() && !optics.thin;
        solid.then(|| self.plan.order.medium(surfaces.object(hit), optics.ior))
    }
}
