//! How far a pixel's centre lies from the outline of the triangle that it shows: which pixels the comparison sets apart.

use rayon::prelude::*;

use super::Plan;
use super::clip::clip_to_reach;
use crate::frame::{NONE, Plane};
use crate::lanes::Real;

impl<R: Real> Plan<'_, R> {
    /// For each pixel whose primitive is given: whether its centre lies within `distance_px` of the outline of that
    /// triangle as projected: not snapped, clipped at near and far. False where the primitive is [`NONE`].
    ///
    /// A primitive whose projection is empty (it lies outside near and far, or is not finite) is all outline. `primitives`
    /// has the size of the picture and holds primitive numbers of the assembly.
    pub fn near_edge(&self, primitives: &Plane<u32>, distance_px: f64) -> Plane<bool> {
        let width = primitives.width.max(1);
        let rows = primitives.data.par_chunks(width).enumerate();
        let data = rows
            .flat_map_iter(|(y, row)| {
                let mut outline = (NONE, Vec::new());
                row.iter().enumerate().map(move |(x, &primitive)| {
                    if primitive == NONE {
                        return false;
                    }
                    if outline.0 != primitive {
                        outline = (primitive, self.outline_px(primitive));
                    }
                    let center = [x as f64 + 0.5, y as f64 + 0.5];
                    distance_to_outline(&outline.1, center) <= distance_px
                })
            })
            .collect();
        Plane {
            width: primitives.width,
            height: primitives.height,
            data,
        }
    }

    /// The corners of a primitive's visible part in pixel coordinates.
    fn outline_px(&self, primitive: u32) -> Vec<[f64; 2]> {
        let polygon = clip_to_reach(&self.view, self.corners(primitive));
        let corners = polygon.vertices().iter().map(|v| self.view.pixel(v));
        corners.collect()
    }
}

/// Least distance to the sides of a closed polygon; 0 where it has none or they are not finite.
fn distance_to_outline(polygon: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let mut least = if polygon.is_empty() {
        0.0
    } else {
        f64::INFINITY
    };
    for (i, a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (ux, uy) = (b[0] - a[0], b[1] - a[1]);
        let (vx, vy) = (p[0] - a[0], p[1] - a[1]);
        let length2 = ux * ux + uy * uy;
        let t = if length2 > 0.0 {
            ((vx * ux + vy * uy) / length2).clamp(0.0, 1.0)
        } else {
            0.0
        };
        // Beside the side: the cross product is better than the difference of two far-away places.
        let distance = if t > 0.0 && t < 1.0 {
            (vx * uy - vy * ux).abs() / length2.sqrt()
        } else {
            let (dx, dy) = (vx - t * ux, vy - t * uy);
            (dx * dx + dy * dy).sqrt()
        };
        least = if distance.is_nan() {
            0.0
        } else {
            least.min(distance)
        };
    }
    least
}
