//! The vertices between begin and end, and what their materials come to (GL 2.1 sections 2.14.3 and 2.14.7).
//!
//! Each vertex brings the material that it is lit with, current colour included. Where the materials of a batch differ by one
//! colour, the mesh has vertex colours and its material follows them; where they differ otherwise, each triangle has a
//! material of its own, the provoking vertex's in flat shading; what is left cannot be recorded.

use crate::gl::{self, Tracked};
use crate::math::DVec3;
use crate::scene::Optics;

/// A vertex, object coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
}

/// Front and back material, and what the tracer adds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Surface {
    pub(super) sides: [gl::Material; 2],
    pub(super) optics: Optics,
}

impl Surface {
    /// Lighting off: both sides show a colour as it is.
    pub(super) fn unlit([r, g, b, alpha]: [f64; 4], optics: Optics) -> Self {
        let side = gl::Material {
            emission: [r, g, b],
            ambient: [0.0; 3],
            diffuse: [0.0; 3],
            alpha,
            ..gl::Material::default()
        };
        Self {
            sides: [side.clone(), side],
            optics,
        }
    }
}

/// The vertices between begin and end.
#[derive(Clone, Debug, Default)]
pub(super) struct Batch {
    /// Their places and normals.
    pub(super) vertices: Vec<Vertex>,
    /// Materials, each different from the one before.
    pub(super) surfaces: Vec<Surface>,
    /// Index into `surfaces` of each vertex.
    surface_of: Vec<u32>,
}

impl Batch {
    /// Forgets the vertices.
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
        self.surfaces.clear();
        self.surface_of.clear();
    }

    /// Adds a vertex, lit with a material.
    pub(super) fn push(&mut self, vertex: Vertex, surface: Surface) {
        if self.surfaces.last() != Some(&surface) {
            self.surfaces.push(surface);
        }
        self.vertices.push(vertex);
        self.surface_of.push(self.surfaces.len() as u32 - 1);
    }

    /// The material of the batch and its vertex colours, where the materials differ by one colour at most.
    pub(super) fn following(&self) -> Option<(Surface, Vec<[f64; 4]>)> {
        let first = self.surfaces.first()?;
        let mut base = first.clone();
        let fixed = |s: &Surface| {
            let shininess = s.sides.iter().zip(&first.sides);
            s.optics == first.optics
                && shininess
                    .into_iter()
                    .all(|(a, b)| a.shininess == b.shininess)
        };
        if !self.surfaces.iter().all(fixed) {
            return None;
        }
        for (side, material) in base.sides.iter_mut().enumerate() {
            let of = |s: &Surface| s.sides[side].clone();
            material.tracked = differing(first.sides[side].clone(), self.surfaces.iter().map(of));
        }
        let colors: Option<Vec<[f64; 4]>> = self
            .surfaces
            .iter()
            .map(|surface| one_color(&base, surface))
            .collect();
        let colors = colors?;
        let of_vertices = self.surface_of.iter().map(|s| colors[*s as usize]);
        Some((base, of_vertices.collect()))
    }

    /// The material slot of each triangle; `None` where a smooth triangle has several.
    pub(super) fn slots(&self, triangles: &[[u32; 3]], flat: bool) -> Option<Vec<u32>> {
        let of = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| self.surface_of[v as usize]);
            let same = |i: u32| i == c || self.surfaces[i as usize] == self.surfaces[c as usize];
            (flat || (same(a) && same(b))).then_some(c)
        };
        triangles.iter().map(of).collect()
    }
}

/// The terms of one side in which some material differs from the first.
fn differing(first: gl::Material, all: impl Iterator<Item = gl::Material>) -> Tracked {
    let mut tracked = Tracked::default();
    let mut alpha = false;
    for material in all {
        tracked.emission |= material.emission != first.emission;
        tracked.ambient |= material.ambient != first.ambient;
        tracked.diffuse |= material.diffuse != first.diffuse;
        tracked.specular |= material.specular != first.specular;
        alpha |= material.alpha != first.alpha;
    }
    tracked.diffuse |= alpha && !tracked.any();
    tracked
}

/// The one colour that all tracked terms of `base` have in a material; `None` where they differ. White where none is.
fn one_color(base: &Surface, surface: &Surface) -> Option<[f64; 4]> {
    let mut found: Option<[f64; 4]> = None;
    for (base, side) in base.sides.iter().zip(&surface.sides) {
        let tracked = base.tracked;
        let terms = [
            (tracked.emission, side.emission),
            (tracked.ambient, side.ambient),
            (tracked.diffuse, side.diffuse),
            (tracked.specular, side.specular),
        ];
        for (_, [r, g, b]) in terms.into_iter().filter(|(follows, _)| *follows) {
            let color = [r, g, b, side.alpha];
            if *found.get_or_insert(color) != color {
                return None;
            }
        }
    }
    Some(found.unwrap_or(gl::CURRENT_COLOR))
}
