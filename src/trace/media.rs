//! The media that a ray is in: the list rule of whitted.md section 2.
//!
//! Crossing the surface of object A removes A from the list if it is there, else appends it. The index before is that of the
//! last entry before, the index after that of the last entry after; an empty list is air (1). So a hollow ball is one
//! ball inside another, and overlapping solids need no care. Lists are kept once and named by number, so that
//! rays stay small. Where primary rays start: [`super::inside`].
//!
//! *Contacts.* Solids that a ray crosses at one place are left first, the smallest first, then entered, the largest first, so
//! that what lies in a cavity is inside it (equal volumes: object number), whatever the order of the file.
//!
//! *Priority* (Schmidt and Budge 2002, "Simple nested dielectrics in ray traced images"): of the list the highest priority
//! counts, of equal ones the last. A surface of a solid inside one of a higher priority is not there ([`Media::hides`]).

use std::collections::HashMap;

use crate::scene::{Scene, volume};

/// One object that the ray is inside of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Medium {
    pub(super) object: u32,
    pub(super) ior: f64,
    pub(super) priority: i32,
    /// Its place in the order of volumes.
    pub(super) rank: u32,
}

/// What orders the solids of a scene.
#[derive(Clone, Debug)]
pub(super) struct Order {
    /// Priority and rank by volume of each object.
    objects: Vec<(i32, u32)>,
    /// Some priority is not 0.
    pub(super) prioritized: bool,
}

impl Order {
    pub(super) fn of(scene: &Scene) -> Self {
        let priorities = scene.objects.iter().map(|object| object.priority);
        let prioritized = priorities.clone().any(|priority| priority != 0);
        let objects = priorities.zip(volume::ranks(scene)).collect();
        Self {
            objects,
            prioritized,
        }
    }

    /// An object as a medium of an index.
    pub(super) fn medium(&self, object: u32, ior: f64) -> Medium {
        let (priority, rank) = self.objects[object as usize];
        Medium {
            object,
            ior,
            priority,
            rank,
        }
    }
}

/// Number of a list of media.
pub(super) type MediaId = u32;

/// The empty list: air.
pub(super) const AIR: MediaId = 0;

/// The lists in use, each kept once.
#[derive(Debug)]
pub(super) struct Media {
    lists: Vec<Vec<Medium>>,
    /// Number of a list, found by its objects and the bits of their indices.
    known: HashMap<Vec<(u32, u64)>, MediaId>,
}

/// What crossing a surface means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    /// The list behind the surface.
    pub(super) media: MediaId,
    /// Index of refraction before.
    pub(super) eta_i: f64,
    /// Index of refraction after.
    pub(super) eta_t: f64,
}

impl Media {
    pub(super) fn new() -> Self {
        Self {
            lists: vec![Vec::new()],
            known: HashMap::from([(Vec::new(), AIR)]),
        }
    }

    /// Index of refraction in a list of media.
    pub(super) fn ior(&self, media: MediaId) -> f64 {
        index(&self.lists[media as usize])
    }

    /// Crosses the surface of one solid.
    #[cfg(test)]
    fn cross(&mut self, from: MediaId, solid: Medium) -> Crossing {
        self.pass(from, &[solid])
    }

    /// Crosses the surfaces of solids that touch at one place, in whatever order they come.
    pub(super) fn pass(&mut self, from: MediaId, solids: &[Medium]) -> Crossing {
        let before = &self.lists[from as usize];
        let eta_i = index(before);
        let mut after = before.clone();
        // Leaving changes no order, so that which one is left first does not matter to the list behind.
        let mut entered = Vec::new();
        for solid in solids {
            match after.iter().rposition(|m| m.object == solid.object) {
                Some(at) => {
                    after.remove(at);
                }
                None => entered.push(*solid),
            }
        }
        entered.sort_by_key(|m| (std::cmp::Reverse(m.rank), m.object));
        for solid in entered {
            match after.iter().rposition(|m| m.object == solid.object) {
                Some(at) => {
                    after.remove(at);
                }
                None => after.push(solid),
            }
        }
        let eta_t = index(&after);
        let key = after.iter().map(|m| (m.object, m.ior.to_bits())).collect();
        let lists = &mut self.lists;
        let media = *self.known.entry(key).or_insert_with(|| {
            lists.push(after);
            lists.len() as MediaId - 1
        });
        Crossing {
            media,
            eta_i,
            eta_t,
        }
    }

    /// Whether the surface of a solid is not there, since it lies inside one of a higher priority: one that is in the list
    /// before the place, and behind it.
    pub(super) fn hides(&self, [before, behind]: [MediaId; 2], solid: &Medium) -> bool {
        let behind = &self.lists[behind as usize];
        let stays = |m: &Medium| behind.iter().any(|b| b.object == m.object);
        let before = &self.lists[before as usize];
        before
            .iter()
            .any(|m| m.object != solid.object && m.priority > solid.priority && stays(m))
    }
}

/// The index of the highest priority, of equal ones the last.
fn index(list: &[Medium]) -> f64 {
    list.iter()
        .max_by_key(|m| m.priority)
        .map_or(1.0, |m| m.ior)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solid(object: u32, ior: f64) -> Medium {
        Medium {
            object,
            ior,
            priority: 0,
            rank: 0,
        }
    }

    #[test]
    fn a_hollow_ball_is_air_in_its_middle() {
        // Glass ball 0 holds an air bubble, object 1 with index 1.
        let mut media = Media::new();
        let a = media.cross(AIR, solid(0, 1.5));
        assert_eq!((a.eta_i, a.eta_t), (1.0, 1.5));
        let b = media.cross(a.media, solid(1, 1.0));
        assert_eq!((b.eta_i, b.eta_t), (1.5, 1.0));
        let c = media.cross(b.media, solid(1, 1.0));
        assert_eq!((c.eta_i, c.eta_t), (1.0, 1.5));
        let d = media.cross(c.media, solid(0, 1.5));
        assert_eq!((d.eta_i, d.eta_t, d.media), (1.5, 1.0, AIR));
    }

    #[test]
    fn leaving_the_outer_of_two_overlapping_objects_first() {
        let mut media = Media::new();
        let a = media.cross(AIR, solid(7, 1.5));
        let b = media.cross(a.media, solid(8, 1.3));
        let c = media.cross(b.media, solid(7, 1.5));
        assert_eq!((c.eta_i, c.eta_t), (1.3, 1.3));
        let d = media.cross(c.media, solid(8, 1.3));
        assert_eq!((d.eta_i, d.eta_t, d.media), (1.3, 1.0, AIR));
    }

    #[test]
    fn solids_that_touch_are_entered_largest_first_whatever_the_order() {
        let (mut cavity, mut water) = (solid(1, 1.0), solid(2, 1.33));
        (cavity.rank, water.rank) = (2, 1);
        for order in [[cavity, water], [water, cavity]] {
            let mut media = Media::new();
            let glass = media.cross(AIR, solid(0, 1.5)).media;
            let inside = media.pass(glass, &order);
            assert_eq!((inside.eta_i, inside.eta_t), (1.5, 1.33));
            let out = media.pass(inside.media, &order);
            assert_eq!((out.eta_i, out.eta_t, out.media), (1.33, 1.5, glass));
        }
        // Equal volumes: the object number.
        let mut media = Media::new();
        let both = [solid(4, 1.4), solid(3, 1.3)];
        assert_eq!(media.pass(AIR, &both).eta_t, 1.4);
    }

    #[test]
    fn the_higher_priority_is_there() {
        let mut media = Media::new();
        let (mut water, glass) = (solid(0, 1.33), solid(1, 1.5));
        water.priority = 1;
        let a = media.cross(AIR, water);
        let b = media.cross(a.media, glass);
        assert_eq!((b.eta_i, b.eta_t), (1.33, 1.33));
        assert!(media.hides([a.media, b.media], &glass));
        assert!(!media.hides([AIR, a.media], &water));
        let c = media.cross(b.media, water);
        assert_eq!((c.eta_i, c.eta_t), (1.33, 1.5));
        assert!(!media.hides([b.media, c.media], &water));
    }
}
