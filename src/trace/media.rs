//! The media that a ray is in: the list rule of whitted.md section 2.
//!
//! Crossing the surface of object A removes A from the list if it is there, else appends it. The index before is that of the
//! last entry before, the index after that of the last entry after; an empty list is air (1). So a hollow ball is one
//! ball inside another, and touching or overlapping solids need no care. Lists are kept once and named by number, so that
//! rays stay small. Where primary rays start: [`super::inside`].

use std::collections::HashMap;

/// One object that the ray is inside of.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Medium {
    object: u32,
    ior: f64,
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

    /// Crosses the surface of an object whose inside has the index `ior`.
    pub(super) fn cross(&mut self, from: MediaId, object: u32, ior: f64) -> Crossing {
        let before = &self.lists[from as usize];
        let eta_i = index(before);
        let mut after = before.clone();
        match after.iter().rposition(|m| m.object == object) {
            Some(at) => {
                after.remove(at);
            }
            None => after.push(Medium { object, ior }),
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

    /// Whether a list holds an object.
    pub(super) fn hold(&self, media: MediaId, object: u32) -> bool {
        let list = &self.lists[media as usize];
        list.iter().any(|m| m.object == object)
    }
}

fn index(list: &[Medium]) -> f64 {
    list.last().map_or(1.0, |m| m.ior)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hollow_ball_is_air_in_its_middle() {
        // Glass ball 0 holds an air bubble, object 1 with index 1.
        let mut media = Media::new();
        let a = media.cross(AIR, 0, 1.5);
        assert_eq!((a.eta_i, a.eta_t), (1.0, 1.5));
        let b = media.cross(a.media, 1, 1.0);
        assert_eq!((b.eta_i, b.eta_t), (1.5, 1.0));
        let c = media.cross(b.media, 1, 1.0);
        assert_eq!((c.eta_i, c.eta_t), (1.0, 1.5));
        let d = media.cross(c.media, 0, 1.5);
        assert_eq!((d.eta_i, d.eta_t, d.media), (1.5, 1.0, AIR));
    }

    #[test]
    fn leaving_the_outer_of_two_overlapping_objects_first() {
        let mut media = Media::new();
        let a = media.cross(AIR, 7, 1.5);
        let b = media.cross(a.media, 8, 1.3);
        let c = media.cross(b.media, 7, 1.5);
        assert_eq!((c.eta_i, c.eta_t), (1.3, 1.3));
        let d = media.cross(c.media, 8, 1.3);
        assert_eq!((d.eta_i, d.eta_t, d.media), (1.3, 1.0, AIR));
    }
}
