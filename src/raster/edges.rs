//! Coverage of one triangle from snapped vertices: integer edge functions with the top-left rule.
//!
//! In: snapped vertices in units of 1/256 or 1/4096 px, y down. Out: for a sample, inside or not, exactly; a sample on an
//! edge belongs to the triangle for which it is a left edge or a horizontal top edge, so that triangles sharing an edge
//! own each sample once (GL 2.1 section 3.5.1 leaves the rule open; Direct3D 11.3 section 3.4 has this one).
//!
//! Samples lie on multiples of 1/256 px, so a function is divided by what the snap has more of, rounded down, and keeps
//! its sign at every sample. Vertices lie within +-2^29 units (2 million px at 8 bits), so that products fit 64 bits; what
//! reaches farther is the affair of `sides`.

use crate::sampling::SUBPIXEL;

/// Sub-pixel bits of sample places.
pub(super) const SAMPLE_BITS: u32 = SUBPIXEL.ilog2();

/// Largest absolute coordinate whose edge functions fit 64 bits.
const SMALL_UNITS: i64 = 1 << 29;

/// Snapped coordinates as small integers; `None` beyond [`SMALL_UNITS`].
pub(super) fn small(v: [i64; 2]) -> Option<[i32; 2]> {
    let fits = v[0].abs() <= SMALL_UNITS && v[1].abs() <= SMALL_UNITS;
    fits.then_some([v[0] as i32, v[1] as i32])
}

/// Twice the signed area of a snapped triangle in units^2: positive = clockwise on the screen (y down). Exact for any
/// snapped vertices.
pub(super) fn double_area(v: [[i64; 2]; 3]) -> i128 {
    let d = |i: usize, axis: usize| i128::from(v[i][axis] - v[0][axis]);
    d(1, 0) * d(2, 1) - d(1, 1) * d(2, 0)
}

/// Three edge functions e + a dx + b dy, dx and dy in 1/256 px from some place; inside = none negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Edges {
    /// Value at the place, the rule for samples on the edge folded in.
    pub(super) e: [i64; 3],
    /// Change for 1/256 px rightwards.
    pub(super) a: [i64; 3],
    /// Change for 1/256 px downwards.
    pub(super) b: [i64; 3],
}

impl Edges {
    /// The edge functions of a triangle of positive area and of vertices within [`SMALL_UNITS`], with this many sub-pixel
    /// bits, at a place in 1/256 px.
    pub(super) fn new(v: [[i64; 2]; 3], bits: u32, place: [i64; 2]) -> Self {
        let finer = bits - SAMPLE_BITS;
        let place = [place[0] << finer, place[1] << finer];
        let mut edges = Self {
            e: [0; 3],
            a: [0; 3],
            b: [0; 3],
        };
        for i in 0..3 {
            let (from, to) = (v[i], v[(i + 1) % 3]);
            let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
            let (px, py) = (place[0] - from[0], place[1] - from[1]);
            // Interior on the right hand of the edge (y down): a left edge runs upwards, a top edge rightwards.
            let top_left = dy < 0 || (dy == 0 && dx > 0);
            let bias = i64::from(top_left) - 1;
            edges.a[i] = -dy;
            edges.b[i] = dx;
            edges.e[i] = (dx * py - dy * px + bias) >> finer;
        }
        edges
    }

    /// No sample of the rectangle from the place to `extent` (1/256 px) right and down can be inside.
    pub(super) fn misses(&self, extent: [i64; 2]) -> bool {
        (0..3).any(|i| self.e[i] + self.a[i].max(0) * extent[0] + self.b[i].max(0) * extent[1] < 0)
    }

    /// Whether every sample of that rectangle is inside edge `i`.
    pub(super) fn contains(&self, i: usize, extent: [i64; 2]) -> bool {
        self.e[i] + self.a[i].min(0) * extent[0] + self.b[i].min(0) * extent[1] >= 0
    }
}
