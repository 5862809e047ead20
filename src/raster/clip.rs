//! Clipping of one triangle in homogeneous space, before any division (GL 2.1 section 2.12).
//!
//! Near always, far where the camera has one, x and y only at the guard band. Only places are clipped: attributes,
//! flat colours and facing come from the whole triangle (so a vertex made here never becomes a provoking vertex). A cut
//! is computed from the inside end to the outside end, so that two triangles sharing an edge get the same new vertex.

use super::view::{GUARD_UNITS, Vertex, View};

/// A triangle gains at most one vertex a plane: 3 + 6.
const CAPACITY: usize = 9;

/// A convex polygon of at most nine vertices.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Polygon {
    vertices: [Vertex; CAPACITY],
    len: usize,
}

impl Polygon {
    /// The triangle itself.
    pub(super) fn triangle(corners: [Vertex; 3]) -> Self {
        let mut polygon = Self::default();
        corners.into_iter().for_each(|v| polygon.push(v));
        polygon
    }

    /// The vertices in the order of the triangle's winding.
    pub(super) fn vertices(&self) -> &[Vertex] {
        &self.vertices[..self.len]
    }

    fn push(&mut self, v: Vertex) {
        // A plane adds one vertex at most, save through rounding in a polygon that is all but degenerate: its
        // surplus corner is dropped rather than the program.
        if self.len < CAPACITY {
            self.vertices[self.len] = v;
            self.len += 1;
        }
    }

    /// What lies where `inside` is not negative (Sutherland and Hodgman 1974).
    fn cut(&self, inside: impl Fn(&Vertex) -> f64) -> Self {
        let mut kept = Self::default();
        let vertices = self.vertices();
        for (i, v) in vertices.iter().enumerate() {
            let next = &vertices[(i + 1) % vertices.len()];
            let (d, d_next) = (inside(v), inside(next));
            if d >= 0.0 {
                kept.push(*v);
            }
            if d >= 0.0 && d_next < 0.0 {
                kept.push(between(v, next, d, d_next));
            } else if d < 0.0 && d_next >= 0.0 {
                kept.push(between(next, v, d_next, d));
            }
        }
        kept
    }
}

/// The vertex where the plane's distance is 0 on the way from `a` (inside, d_a >= 0) to `b` (outside, d_b < 0).
fn between(a: &Vertex, b: &Vertex, d_a: f64, d_b: f64) -> Vertex {
    let t = d_a / (d_a - d_b);
    let mix = |p: f64, q: f64| p + t * (q - p);
    Vertex {
        x: mix(a.x, b.x),
        y: mix(a.y, b.y),
        w: mix(a.w, b.w),
        distance: mix(a.distance, b.distance),
        reach: mix(a.reach, b.reach),
    }
}

/// The part of a triangle that may be divided and snapped; fewer than three vertices = nothing.
pub(super) fn clip(view: &View, corners: [Vertex; 3]) -> Polygon {
    let mut polygon = Polygon::triangle(corners).cut(|v| v.distance - view.near);
    if view.far < f64::INFINITY {
        polygon = polygon.cut(|v| view.far - v.reach);
    }
    if polygon.vertices().iter().any(|v| view.snap(v).is_none()) {
        // Half the guard, so that the picture's own offset and rounding stay inside the whole.
        let limit = GUARD_UNITS / 2.0 / view.unit() as f64;
        let [sx, sy] = view.scale;
        polygon = polygon
            .cut(|v| limit * v.w - sx * v.x)
            .cut(|v| limit * v.w + sx * v.x)
            .cut(|v| limit * v.w - sy * v.y)
            .cut(|v| limit * v.w + sy * v.y);
    }
    polygon
}
