//! Clipping of one triangle in homogeneous space, before any division (GL 2.1 section 2.12): where its picture lies.
//!
//! Near always, far where the camera has one. The polygon bounds the triangle in the picture and in depth, and is its
//! outline; which samples it covers is decided without it (`sides`), and attributes, flat colours and facing come from the
//! whole triangle.

use super::view::{Vertex, View};

/// A triangle gains at most one vertex a plane.
const CAPACITY: usize = 9;

/// A convex polygon of at most nine vertices: a triangle cut by near, far and four sides.
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
    }
}

/// The part of a triangle between near and far; fewer than three vertices = nothing.
pub(super) fn clip(view: &View, corners: [Vertex; 3]) -> Polygon {
    let mut polygon = Polygon::triangle(corners);
    if corners.iter().any(|v| view.inside_near(v) < 0.0) {
        polygon = polygon.cut(|v| view.inside_near(v));
    }
    if corners.iter().any(|v| view.inside_far(v) < 0.0) {
        polygon = polygon.cut(|v| view.inside_far(v));
    }
    polygon
}

/// That part without what lies so far beside the picture that distances from its places would be all rounding: what is
/// kept reaches 2^36 px.
pub(super) fn clip_to_reach(view: &View, corners: [Vertex; 3]) -> Polygon {
    const REACH: f64 = (1u64 << 36) as f64;
    let polygon = clip(view, corners);
    let [sx, sy] = view.scale;
    let inside = |v: &Vertex| (sx * v.x).abs() <= REACH * v.w && (sy * v.y).abs() <= REACH * v.w;
    if polygon.vertices().iter().all(inside) {
        return polygon;
    }
    polygon
        .cut(|v| REACH * v.w - sx * v.x)
        .cut(|v| REACH * v.w + sx * v.x)
        .cut(|v| REACH * v.w - sy * v.y)
        .cut(|v| REACH * v.w + sy * v.y)
}
