//! Points sorted by surface, so that each batch has one material: how both renderers hand fragments to the equation.

use super::Points;
use super::rounded::{Rounded, round_if};
use crate::lanes::Real;

/// Number of a surface: a material and the side it is seen from (the back side has its own number under two-sided
/// lighting, where normal and material change).
pub fn surface(material: usize, back: bool) -> usize {
    2 * material + usize::from(back)
}

/// Points of one surface, each with a tag of the caller's (a pixel, a hit).
#[derive(Clone, Debug, Default)]
pub struct Batch<R> {
    /// See [`surface`].
    pub surface: usize,
    /// The points.
    pub points: Points<R>,
    /// The caller's number of each point.
    pub tags: Vec<u32>,
}

/// Batches in the order in which their surfaces were first met.
#[derive(Clone, Debug, Default)]
pub struct Batches<R> {
    list: Vec<Batch<R>>,
    used: usize,
    slot_of_surface: Vec<u32>,
    /// What is rounded to f32 on the way in: nothing, but to measure what that does.
    pub(super) rounded: Rounded,
}

const UNUSED: u32 = u32::MAX;

impl<R: Real> Batches<R> {
    /// No points yet, for a scene with this many materials.
    pub fn new(materials: usize) -> Self {
        Self {
            list: Vec::new(),
            used: 0,
            slot_of_surface: vec![UNUSED; 2 * materials],
            rounded: Rounded::default(),
        }
    }

    /// Adds a point of a surface.
    pub fn push(
        &mut self,
        surface: usize,
        tag: u32,
        position: [R; 3],
        normal: [R; 3],
        viewer: [R; 3],
    ) {
        let rounded = self.rounded;
        let batch = self.batch(surface);
        batch.points.push(
            round_if(rounded.positions, position),
            round_if(rounded.normals, normal),
            round_if(rounded.viewers, viewer),
        );
        batch.tags.push(tag);
    }

    /// The batch of a surface, for callers that fill it themselves.
    pub fn batch(&mut self, surface: usize) -> &mut Batch<R> {
        if self.slot_of_surface[surface] == UNUSED {
            self.slot_of_surface[surface] = self.used as u32;
            if self.used == self.list.len() {
                self.list.push(Batch::default());
            }
            self.list[self.used].surface = surface;
            self.used += 1;
        }
        &mut self.list[self.slot_of_surface[surface] as usize]
    }

    /// The batches in use.
    pub fn iter(&self) -> impl Iterator<Item = &Batch<R>> {
        self.list[..self.used].iter()
    }

    /// Forgets the points, keeps the memory.
    pub fn clear(&mut self) {
        for batch in &mut self.list[..self.used] {
            self.slot_of_surface[batch.surface] = UNUSED;
            batch.points.clear();
            batch.tags.clear();
        }
        self.used = 0;
    }
}
