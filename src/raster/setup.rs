//! Triangle setup: facing, culling, clipping, snapping, the depth plane; and binning to screen tiles in primitive order.
//!
//! Facing is decided on the numbers before snapping, exactly; coverage on the snapped vertices where a triangle has them
//! (`edges`), else on its sides (`sides`). A triangle whose exact or snapped area is 0 draws nothing. Triangles are set up
//! in parallel in chunks of consecutive primitives; each chunk lists, for each tile, its triangles in order, so walking the
//! chunks in order gives primitive order whatever the thread count.
//!
//! Depth is a key, larger = closer, that is affine in the picture: 1 / distance (perspective: reversed depth with an
//! infinite far plane) or -distance (orthographic), as k0 + kx X + ky Y in f64 at the sample's ray (X, Y), held within the
//! keys of the triangle's own vertices: a sample that only snapping gave to a steep triangle must not leap forward. The depth
//! test and the depth range decide what the key is made of ([`DepthOrder`]): the kernels only ask for the larger one.

use super::bin::{BY_SIDES, Binned, Chunk, SampleBox, TILE, TileArea, TileGrid};
use super::clip::{Polygon, clip};
use super::edges::{Edges, SAMPLE_BITS};
use super::sides::Sides;
use super::view::{Vertex, View, orientation};
use crate::math::Each;
use crate::math::color::clamp01;
use crate::math::float::dot;
use crate::scene::{Cull, RasterSettings};

/// Which of the surfaces that cover a sample shows: GL_LESS on window depth (GL 2.1 sections 2.11.1 and 4.1.6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DepthOrder {
    /// The nearest; the first one drawn at equal depths.
    Nearest,
    /// The farthest: the depth range is turned round.
    Farthest,
    /// The first one drawn: the depth range is a single depth.
    First,
    /// The last one drawn: there is no depth test.
    Last,
    /// None: every depth is 1, which is not less than what the buffer is cleared to.
    Never,
}

impl DepthOrder {
    /// What a scene's settings ask for.
    pub(super) fn of(raster: &RasterSettings) -> Self {
        // glDepthRange clamps.
        let [near, far] = raster.depth_range.map(clamp01);
        match raster.depth_test {
            false => Self::Last,
            true if near < far => Self::Nearest,
            true if near > far => Self::Farthest,
            true if near == 1.0 => Self::Never,
            true => Self::First,
        }
    }
}

/// Sets up triangles in primitive order.
pub(super) struct Builder<'a> {
    view: &'a View,
    grid: TileGrid,
    samples: SampleBox,
    cull: Cull,
    order: DepthOrder,
    chunk: Chunk,
    /// Tile and triangle, in primitive order.
    entries: Vec<(u32, u32)>,
}

impl<'a> Builder<'a> {
    /// Nothing set up yet.
    pub(super) fn new(
        view: &'a View,
        grid: TileGrid,
        samples: SampleBox,
        (cull, order): (Cull, DepthOrder),
    ) -> Self {
        Self {
            view,
            grid,
            samples,
            cull,
            order,
            chunk: Chunk::default(),
            entries: Vec::new(),
        }
    }

    /// Adds a triangle that needs no clipping: its vertices lie within near and far, and `snapped` within
    /// 2^29 units. `corners` gives the vertices themselves and is asked only for what survives.
    pub(super) fn inside(
        &mut self,
        primitive: u32,
        snapped: [[i32; 2]; 3],
        corners: impl Fn() -> [Vertex; 3],
    ) {
        self.chunk.counters.triangles_in += 1;
        let wide = |p: [i32; 2]| [i64::from(p[0]), i64::from(p[1])];
        let v = [wide(snapped[0]), wide(snapped[1]), wide(snapped[2])];
        let Some(tiles) = self.tiles(&v) else {
            self.chunk.counters.triangles_outside += 1;
            return;
        };
        let (d1, d2) = (
            [v[1][0] - v[0][0], v[1][1] - v[0][1]],
            [v[2][0] - v[0][0], v[2][1] - v[0][1]],
        );
        let area = d1[0] * d2[1] - d1[1] * d2[0];
        // Snapping moves each difference by less than 2 units, so this area has the sign of the exact one.
        let doubt = 2 * (d1[0].abs() + d1[1].abs() + d2[0].abs() + d2[1].abs()) + 8;
        let certain = area.abs() > doubt;
        let facing = if certain {
            -area.signum() as i32
        } else {
            orientation(corners().map(|v| v.homogeneous()))
        };
        if !self.keeps(facing, area == 0) {
            return;
        }
        let corners = corners();
        let (key, range) = self.depth(primitive, &corners, &corners);
        let (snapped, v) = if area < 0 {
            ([snapped[0], snapped[2], snapped[1]], [v[0], v[2], v[1]])
        } else {
            (snapped, v)
        };
        let triangle = Binned {
            x: [snapped[0][0], snapped[1][0], snapped[2][0]],
            y: [snapped[0][1], snapped[1][1], snapped[2][1]],
            key,
            range,
            primitive,
        };
        let (grid, bits, samples) = (self.grid, self.view.bits, self.samples);
        self.push(triangle, tiles, |tile| {
            meets(v, bits, &grid.tile(tile), samples)
        });
        self.chunk.counters.triangles_drawn += 1;
    }

    /// Adds any triangle: its sides decide its coverage.
    pub(super) fn general(&mut self, primitive: u32, corners: [Vertex; 3]) {
        self.chunk.counters.triangles_in += 1;
        let polygon = if corners.iter().all(Vertex::is_finite) {
            clip(self.view, corners)
        } else {
            Polygon::default()
        };
        let vertices = polygon.vertices();
        let Some([first, last]) = self.pixel_box(&corners, vertices) else {
            self.chunk.counters.triangles_outside += 1;
            return;
        };
        let facing = orientation(corners.each(|v| v.homogeneous()));
        let sides = Sides::new(self.view, &corners, facing);
        if !self.keeps(facing, sides.is_none()) {
            return;
        }
        let Some(sides) = sides else { return };
        let (key, range) = self.depth(primitive, &corners, vertices);
        let triangle = Binned {
            x: [BY_SIDES, first[0] as i32, last[0] as i32],
            y: [
                self.chunk.sides.len() as i32,
                first[1] as i32,
                last[1] as i32,
            ],
            key,
            range,
            primitive,
        };
        self.chunk.sides.push(sides);
        let tiles = [0, 1].each(|axis| [first[axis] / TILE, last[axis] / TILE]);
        self.push(triangle, tiles, |_| true);
        let counters = &mut self.chunk.counters;
        counters.triangles_drawn += 1;
        let outside = |v: &Vertex| self.view.inside_near(v) < 0.0 || self.view.inside_far(v) < 0.0;
        counters.triangles_clipped += u64::from(corners.iter().any(outside));
    }

    /// First and last column and row of the picture's pixels that a polygon may meet; `None` = none. `corners` are those
    /// of the triangle that it was cut from.
    fn pixel_box(&self, corners: &[Vertex; 3], polygon: &[Vertex]) -> Option<[[usize; 2]; 2]> {
        if polygon.len() < 3 {
            return None;
        }
        let least_w = polygon
            .iter()
            .fold(f64::INFINITY, |least, v| least.min(v.w));
        let (mut first, mut last) = ([0; 2], [0; 2]);
        for axis in 0..2 {
            let at = |v: &Vertex| self.view.pixel(v)[axis];
            // A cut vertex carries the rounding of the corners that it lies between; snapping moves by less than a pixel.
            let largest = corners
                .iter()
                .fold(0.0f64, |most, v| most.max(v.homogeneous()[axis].abs()));
            let rounding = largest * self.view.scale[axis].abs() / least_w * (16.0 * f64::EPSILON);
            let places = polygon.iter().map(at);
            let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                // What has no place may be anywhere.
                let (l, h) = if x.is_nan() {
                    (f64::NEG_INFINITY, f64::INFINITY)
                } else {
                    (x, x)
                };
                (low.min(l), high.max(h))
            });
            let margin = if rounding.is_nan() {
                f64::INFINITY
            } else {
                1.0 + rounding
            };
            // In the picture's own pixels; conversion to integers saturates, NaN (infinity less infinity) is 0.
            let origin = self.grid.origin[axis] as f64;
            let size = self.grid.size[axis] as f64;
            let low = (low - margin - origin).max(0.0);
            let high = (high + margin - origin).min(size - 1.0);
            if low > high {
                return None;
            }
            (first[axis], last[axis]) = (low as usize, high as usize);
        }
        Some([first, last])
    }

    /// Sorts the entries by tile, keeping primitive order within a tile.
    pub(super) fn finish(mut self) -> Chunk {
        let mut offsets = vec![0u32; self.grid.count() + 1];
        for (tile, _) in &self.entries {
            offsets[*tile as usize + 1] += 1;
        }
        for i in 1..offsets.len() {
            offsets[i] += offsets[i - 1];
        }
        let mut next = offsets.clone();
        let mut items = vec![0u32; self.entries.len()];
        for (tile, triangle) in &self.entries {
            let slot = &mut next[*tile as usize];
            items[*slot as usize] = *triangle;
            *slot += 1;
        }
        self.chunk.offsets = offsets;
        self.chunk.items = items;
        self.chunk.triangles.shrink_to_fit();
        self.chunk
    }

    /// Whether a triangle of this facing (+1 counter-clockwise, y up) is drawn; counts it where not.
    fn keeps(&mut self, facing: i32, no_area: bool) -> bool {
        let counters = &mut self.chunk.counters;
        let front = facing * self.view.front_sign > 0;
        let culled = match self.cull {
            Cull::None => false,
            Cull::Back => !front,
            Cull::Front => front,
        };
        if facing == 0 || (no_area && !culled) {
            counters.triangles_degenerate += 1;
        } else if culled {
            counters.triangles_culled += 1;
        } else {
            return true;
        }
        false
    }

    /// First and last tile column and row whose samples may lie in the box around a triangle; `None` = no sample does.
    fn tiles(&self, v: &[[i64; 2]; 3]) -> Option<[[usize; 2]; 2]> {
        let mut range = [[0; 2]; 2];
        for axis in 0..2 {
            let places = [v[0][axis], v[1][axis], v[2][axis]];
            let [least, most] = pixels(
                places,
                [self.samples.min[axis], self.samples.max[axis]],
                self.view.bits,
            );
            let least = (least - self.grid.origin[axis]).max(0);
            let most = (most - self.grid.origin[axis]).min(self.grid.size[axis] as i64 - 1);
            if least > most {
                return None;
            }
            range[axis] = [least as usize / TILE, most as usize / TILE];
        }
        Some(range)
    }

    /// The depth key of a triangle, and the least and greatest key of the part that is drawn: the largest key shows, the
    /// first one drawn of equals.
    fn depth(
        &self,
        primitive: u32,
        corners: &[Vertex; 3],
        drawn: &[Vertex],
    ) -> ([f64; 3], [f32; 2]) {
        let everywhere = |key: f64| ([key, 0.0, 0.0], [f32::NEG_INFINITY, f32::INFINITY]);
        match self.order {
            DepthOrder::Last => return everywhere(f64::from(primitive)),
            DepthOrder::First => return everywhere(0.0),
            DepthOrder::Never => return everywhere(f64::NEG_INFINITY),
            DepthOrder::Nearest | DepthOrder::Farthest => {}
        }
        let keys = drawn.iter().map(|v| self.view.depth_key(v));
        let (least, most) = keys.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), k| {
            (l.min(k), m.max(k))
        });
        let mut range = [least as f32, most as f32];
        if f64::from(range[0]) > least {
            range[0] = range[0].next_down();
        }
        if f64::from(range[1]) < most {
            range[1] = range[1].next_up();
        }
        let plane = key_plane(self.view, corners);
        if self.order == DepthOrder::Farthest {
            return (plane.map(|k| -k), [-range[1], -range[0]]);
        }
        (plane, range)
    }

    fn push(
        &mut self,
        triangle: Binned,
        [[left, right], [top, bottom]]: [[usize; 2]; 2],
        meets: impl Fn(usize) -> bool,
    ) {
        let number = self.chunk.triangles.len() as u32;
        self.chunk.triangles.push(triangle);
        let several = (right - left + 1) * (bottom - top + 1) > 2;
        for row in top..=bottom {
            for column in left..=right {
                let tile = row * self.grid.columns() + column;
                if !several || meets(tile) {
                    self.entries.push((tile as u32, number));
                }
            }
        }
    }
}

/// Whether some sample of a tile may be inside all edges of a triangle of snapped vertices.
fn meets(v: [[i64; 2]; 3], bits: u32, area: &TileArea, samples: SampleBox) -> bool {
    let SampleBox { min, max } = samples;
    let place = [0, 1].each(|axis| (area.place[axis] << SAMPLE_BITS) + min[axis]);
    let extent =
        [0, 1].each(|axis| ((area.size[axis] as i64 - 1) << SAMPLE_BITS) + max[axis] - min[axis]);
    !Edges::new(v, bits, place).misses(extent)
}

/// First and last pixel of one axis that have a sample between the least and the greatest of three places in units, for
/// samples that lie between `offsets` (1/256 px) in their pixel.
pub(super) fn pixels(places: [i64; 3], offsets: [i64; 2], bits: u32) -> [i64; 2] {
    let least = places[0].min(places[1]).min(places[2]);
    let most = places[0].max(places[1]).max(places[2]);
    let finer = bits - SAMPLE_BITS;
    let (low, high) = (offsets[0] << finer, offsets[1] << finer);
    [-((high - least) >> bits), (most - low) >> bits]
}

/// k0, kx, ky with key = k0 + kx X + ky Y on the triangle's plane. May be infinite or NaN for planes that are all but
/// edge-on; the range bounds what is used.
fn key_plane(view: &View, corners: &[Vertex; 3]) -> [f64; 3] {
    let [h0, h1, h2] = corners.each(|v| v.homogeneous());
    let [q0, q1, q2] = corners.each(|v| view.depth_numerator(&v));
    let (u, v) = (subtract(h1, h0), subtract(h2, h0));
    // k . h_i = q_i at each corner: k det = q0 (u x v) + (q1 - q0) (v x h0) + (q2 - q0) (h0 x u), det = (u x v) . h0.
    // Where all q are equal (perspective) it is a multiple of the plane's normal.
    let (n, first, second) = (cross(u, v), cross(v, h0), cross(h0, u));
    let det = dot(n, h0);
    let k = |axis: usize| (q0 * n[axis] + (q1 - q0) * first[axis] + (q2 - q0) * second[axis]) / det;
    if view.is_parallel() {
        // From corner 0 on: far from the picture's centre the constant part would cancel.
        let (kx, ky) = (k(0), k(1));
        [q0 - kx * h0[0] - ky * h0[1], kx, ky]
    } else {
        [k(2), k(0), k(1)]
    }
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
