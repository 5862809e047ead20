//! Contacts: surfaces that a ray meets at one place are one event (DESIGN section 1, "Contact").
//!
//! *What touches.* Faces on one carrier are found from the shapes when a plan is made ([`crate::scene::contact`]) and numbered
//! in *sets*; a ray that meets one of a set meets the others there, whatever its rounded distances say. A flat set is met
//! once by any ray, so rays that leave it are not tested against it at all ([`Ray::set`]). What no set knows - a ball on a
//! floor, an edge on a wall, curved patches - touches a clear surface where the ray cannot tell the two apart: both points
//! within the sum of their error bounds along the normal.
//!
//! *What happens.* The lowest primitive number is seen. If it is clear, the ray passes the others in the order of their
//! numbers: K_T of each, and whatever is opaque ends it, so that the transmitted ray meets that face and nothing else
//! ([`Path::end`](super::branch::Path::end)). It is not bent on the way there, nor lost to total internal reflection: nothing
//! lies between. Where all are clear, direction and Fresnel's share are those at the one that is seen, between the media before
//! and behind all of them: solids are left, the smallest first, then entered, the largest first ([`super::media`]).
//!
//! *Cost.* Without sets a hit pays one comparison. With them, hits on a face of a set look for the others only in the box around
//! the overlaps.

use std::cmp::Ordering;

use super::branch::Fork;
use super::media::{Crossing, Media, Medium};
use super::ray::{Hit, NO_SET, Ray};
use super::surface::{Site, Surfaces, along_the_ray, in_range};
use crate::lanes::Real;
use crate::math::DVec3;
use crate::math::Each;
use crate::math::color::Rgb;
use crate::scene::Optics;
use crate::scene::contact::{Contacts, Key, Set};

/// Faces a solid can have of its own.
pub(super) const PARTS: usize = 6;

/// The sets of a scene, found by item.
#[derive(Clone, Debug, Default)]
pub(super) struct Touch {
    sets: Vec<Set>,
    /// Set of each triangle; empty where none is in one.
    of_triangle: Vec<u32>,
    /// Sets of the faces of each solid.
    of_solid: Vec<[u32; PARTS]>,
    /// The largest error of a set.
    error: f64,
}

/// Where a face of the shapes is among the items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FaceItem {
    /// A face of a solid, by its number.
    Solid { solid: u32, part: u32 },
    /// A triangle.
    Triangle(u32),
}

/// Everything that a ray meets at one place.
pub(super) struct Event {
    /// In the order of their numbers.
    pub(super) hits: Vec<Hit>,
    /// What its points' [`Foot::scale`](super::ray::Foot::scale) has to grow by to get past all of them.
    pub(super) scale: f64,
}

/// A transmissive surface that touches the one that a ray met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching<'s> {
    /// Its object.
    pub(super) object: u32,
    pub(super) optics: &'s Optics,
    /// It lies inside a solid of a higher priority: it is crossed, but not there.
    pub(super) unseen: bool,
}

impl Touch {
    /// `place` says which face of which item a face is; `stored` is the error that storing a triangle adds.
    pub(super) fn new(
        contacts: &Contacts,
        place: impl Fn(Key) -> Option<FaceItem>,
        stored: impl Fn(u32) -> f64,
    ) -> Self {
        let mut touch = Self {
            sets: contacts.sets.clone(),
            ..Self::default()
        };
        for (key, set) in &contacts.faces {
            match place(*key) {
                Some(FaceItem::Solid { solid, part }) => {
                    let solid = solid as usize;
                    if touch.of_solid.len() <= solid {
                        touch.of_solid.resize(solid + 1, [NO_SET; PARTS]);
                    }
                    touch.of_solid[solid][part as usize % PARTS] = *set;
                }
                Some(FaceItem::Triangle(triangle)) => {
                    let place = triangle as usize;
                    if touch.of_triangle.len() <= place {
                        touch.of_triangle.resize(place + 1, NO_SET);
                    }
                    touch.of_triangle[place] = *set;
                    let shapes = contacts.sets[*set as usize].error;
                    let error = &mut touch.sets[*set as usize].error;
                    *error = error.max(shapes + stored(triangle));
                }
                None => {}
            }
        }
        touch.error = touch.sets.iter().map(|set| set.error).fold(0.0, f64::max);
        touch
    }

    /// There is none.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.sets.is_empty()
    }

    pub(super) fn of_triangle(&self, triangle: u32) -> u32 {
        let found = self.of_triangle.get(triangle as usize);
        found.copied().unwrap_or(NO_SET)
    }

    pub(super) fn of_solid(&self, solid: u32, part: usize) -> u32 {
        let found = self.of_solid.get(solid as usize);
        found.map_or(NO_SET, |parts| parts[part % PARTS])
    }

    /// The set, if its overlaps may be at a point that lies within `bound` of where it seems.
    fn near(&self, set: u32, point: DVec3, bound: f64) -> Option<&Set> {
        let set = self.sets.get(set as usize)?;
        let slack = bound + set.error;
        let within = point.cmpge(set.bounds.min - slack) & point.cmple(set.bounds.max + slack);
        within.all().then_some(set)
    }

    /// How far the faces of a curved set may be apart; 0 for others.
    fn gap(&self, set: u32) -> f64 {
        let set = self.sets.get(set as usize).filter(|set| !set.flat);
        set.map_or(0.0, |set| set.error)
    }

    fn is_flat(&self, set: u32) -> bool {
        self.sets.get(set as usize).is_some_and(|set| set.flat)
    }
}

impl<R: Real> Surfaces<'_, R> {
    /// What a ray meets where it meets `hit`; `None` where that is `hit` alone. `doubtful` = what the ray cannot tell apart
    /// from it counts, too.
    pub(super) fn event(
        &self,
        ray: &Ray,
        (hit, site): (&Hit, &Site<R>),
        doubtful: bool,
        walker: &mut super::bvh::Walker,
    ) -> Option<Event> {
        let foot = &site.foot;
        let touch = self.touch();
        let own = match touch.is_empty() {
            true => None,
            false => touch.near(self.set_of(hit), foot.point, foot.bound()),
        };
        if own.is_none() && !doubtful {
            return None;
        }
        let per_t = foot.normal.dot(ray.direction).abs();
        let reach = 4.0 * (foot.bound() + touch.error) / per_t;
        let near = Ray {
            t_min: hit.t,
            t_max: (hit.t + reach).min(ray.t_max),
            ..*ray
        };
        // Almost always there is nothing but the hit itself, and nothing is allocated.
        let mut found: Vec<Hit> = Vec::new();
        self.walk(&near, walker, |other, _| {
            if in_range(&near, &other) && (other.item, other.feature) != (hit.item, hit.feature) {
                found.push(other);
            }
            false
        });
        if found.is_empty() {
            return None;
        }
        found.sort_by(along_the_ray);
        self.joined(ray, (hit, site), doubtful, found)
    }

    /// The hits of `found` that are one event with `hit`.
    fn joined(
        &self,
        ray: &Ray,
        (hit, site): (&Hit, &Site<R>),
        doubtful: bool,
        mut found: Vec<Hit>,
    ) -> Option<Event> {
        let touch = self.touch();
        let mut scale = 0.0;
        let mut hits = vec![*hit];
        // Each one that joins may bring those of its own set.
        while let Some(at) = found.iter().position(|other| {
            let mate = hits.iter().any(|h| self.same_place(ray, h, other));
            mate || (doubtful && self.touches(ray, other, site))
        }) {
            let other = found.remove(at);
            // Rays that leave a flat set never meet it again; of others they have to get clear.
            let set = self.set_of(&other);
            if set != self.set_of(hit) || !touch.is_flat(set) {
                scale += self.site_with(ray, &other, None, false).foot.scale;
                scale += touch.gap(set) / (4.0 * f64::EPSILON);
            }
            hits.push(other);
        }
        if hits.len() == 1 {
            return None;
        }
        hits.sort_by(by_number);
        Some(Event { hits, scale })
    }

    /// Whether the ray cannot tell a hit from a site: along a flat ray much is near; only what passes through the point
    /// itself touches.
    fn touches(&self, ray: &Ray, other: &Hit, site: &Site<R>) -> bool {
        let foot = self.site_with(ray, other, None, false).foot;
        let gap = (foot.point - site.foot.point).dot(foot.normal);
        gap.abs() <= site.foot.bound() + foot.bound()
    }

    /// Whether two hits of one ray are on one carrier, and there at one place.
    pub(super) fn same_place(&self, ray: &Ray, a: &Hit, b: &Hit) -> bool {
        let set = self.set_of(a);
        if set == NO_SET || set != self.set_of(b) {
            return false;
        }
        let touch = self.touch();
        if touch.is_flat(set) {
            return true;
        }
        let foot = self.site_with(ray, a, None, false).foot;
        let per_t = foot.normal.dot(ray.direction).abs();
        (a.t - b.t).abs() * per_t <= 4.0 * (foot.bound() + touch.gap(set))
    }

    /// The sets that rays which leave a hit, outwards and inwards, cannot meet again: a plane; what lies within a convex face.
    pub(super) fn sets_left(&self, hit: &Hit, convex: bool) -> [u32; 2] {
        if self.touch().is_empty() {
            return [NO_SET; 2];
        }
        let set = self.set_of(hit);
        match (self.touch().is_flat(set), convex) {
            (true, _) => [set; 2],
            (false, true) => [set, NO_SET],
            (false, false) => [NO_SET; 2],
        }
    }
}

fn by_number(a: &Hit, b: &Hit) -> Ordering {
    (a.primitive, a.feature).cmp(&(b.primitive, b.feature))
}

impl Fork<'_> {
    /// K_T of every surface passed, multiplied.
    pub(super) fn transmission(&self) -> Rgb {
        let own = self.optics.transmission;
        let there = self.touching.iter().filter(|next| !next.unseen);
        there.fold(own, |k, next| {
            [0, 1, 2].each(|c| k[c] * next.optics.transmission[c])
        })
    }

    /// Crosses every solid passed: the index before the first, and what is behind the last.
    pub(super) fn cross(&self, media: &mut Media) -> Crossing {
        let others = self.touching.iter().map(|t| (t.object, t.optics));
        let solids: Vec<Medium> = std::iter::once((self.object, self.optics))
            .chain(others)
            .filter(|(_, optics)| !optics.thin)
            .map(|(object, optics)| self.order.medium(object, optics.ior))
            .collect();
        media.pass(self.path.media, &solids)
    }
}
