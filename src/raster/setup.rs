//! Triangle setup: facing, culling, clipping, snapping, the depth plane; and binning to screen tiles in primitive order.
//!
//! Facing is decided on the numbers before snapping, exactly; coverage on the snapped vertices. A triangle whose exact or
//! snapped area is 0 draws nothing. Triangles are set up in parallel in chunks of consecutive primitives; each chunk lists,
//! for each tile, its records in order, so walking the chunks in order gives primitive order whatever the thread count.
//!
//! Depth is a key, larger = closer, that is affine in the picture: 1 / distance (perspective: reversed depth with an
//! infinite far plane) or -distance (orthographic), as k0 + kx X + ky Y in f64 at the sample's ray (X, Y), held within the
//! keys of the triangle's own vertices: a sample that only snapping gave to a steep triangle must not leap forward.

use super::Counters;
use super::clip::{Polygon, clip};
use super::edges::{Edges, SAMPLE_BITS, SMALL_UNITS, double_area};
use super::view::{Vertex, View, orientation};
use crate::scene::Cull;
use crate::scene::projection::Form;

/// Side of a screen tile in pixels.
pub(super) const TILE: usize = 64;

/// The picture cut into tiles.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileGrid {
    /// Picture width and height in pixels.
    pub(super) size: [usize; 2],
    /// First pixel of the picture in the pixel frame of the vertices.
    pub(super) origin: [i64; 2],
}

impl TileGrid {
    /// Columns of tiles.
    pub(super) fn columns(&self) -> usize {
        self.size[0].div_ceil(TILE)
    }

    /// Rows of tiles.
    pub(super) fn rows(&self) -> usize {
        self.size[1].div_ceil(TILE)
    }

    /// Number of tiles.
    pub(super) fn count(&self) -> usize {
        self.columns() * self.rows()
    }

    /// First pixel and size of a tile.
    pub(super) fn tile(&self, index: usize) -> TileArea {
        let corner = [index % self.columns() * TILE, index / self.columns() * TILE];
        let size = [0, 1].map(|axis| TILE.min(self.size[axis] - corner[axis]));
        TileArea {
            corner,
            place: [0, 1].map(|axis| self.origin[axis] + corner[axis] as i64),
            size,
        }
    }
}

/// One tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileArea {
    /// First pixel in the picture.
    pub(super) corner: [usize; 2],
    /// First pixel in the pixel frame of the vertices.
    pub(super) place: [i64; 2],
    /// Width and height in pixels, at most [`TILE`].
    pub(super) size: [usize; 2],
}

/// Where samples lie within any pixel, in 1/256 px: the box around them all.
#[derive(Clone, Copy, Debug)]
pub(super) struct SampleBox {
    /// Least offset in x and y.
    pub(super) min: [i64; 2],
    /// Greatest offset in x and y.
    pub(super) max: [i64; 2],
}

/// A triangle ready to be filled: 64 bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record {
    /// Snapped x, or `HUGE` in the first place.
    x: [i32; 3],
    /// Snapped y, or an index into `Chunk::huge` in the first place.
    y: [i32; 3],
    /// k0, kx, ky of the depth key.
    pub(super) key: [f64; 3],
    /// Least and greatest key.
    pub(super) range: [f32; 2],
    /// Primitive number.
    pub(super) primitive: u32,
}

const HUGE: i32 = i32::MIN;

/// Consecutive primitives, set up and binned.
#[derive(Clone, Debug, Default)]
pub(super) struct Chunk {
    records: Vec<Record>,
    huge: Vec<[[i64; 2]; 3]>,
    /// Per tile, where its part of `items` starts; one more at the end.
    offsets: Vec<u32>,
    /// Record numbers, tile by tile, each tile in primitive order.
    items: Vec<u32>,
    /// What happened to the primitives.
    pub(super) counters: Counters,
}

impl Chunk {
    /// Whether a tile has records.
    pub(super) fn meets_tile(&self, tile: usize) -> bool {
        self.offsets[tile] < self.offsets[tile + 1]
    }

    /// The records of a tile in primitive order, with their snapped vertices.
    pub(super) fn of_tile(&self, tile: usize) -> impl Iterator<Item = (&Record, [[i64; 2]; 3])> {
        let range = self.offsets[tile] as usize..self.offsets[tile + 1] as usize;
        self.items[range].iter().map(|&i| {
            let record = &self.records[i as usize];
            (record, self.vertices(record))
        })
    }

    #[inline]
    fn vertices(&self, record: &Record) -> [[i64; 2]; 3] {
        if record.x[0] == HUGE {
            self.huge[record.y[0] as usize]
        } else {
            // Written out: closures given to array::map are not inlined here.
            let ([x0, x1, x2], [y0, y1, y2]) = (record.x, record.y);
            [
                [i64::from(x0), i64::from(y0)],
                [i64::from(x1), i64::from(y1)],
                [i64::from(x2), i64::from(y2)],
            ]
        }
    }
}

/// Sets up triangles in primitive order.
pub(super) struct Builder<'a> {
    view: &'a View,
    grid: TileGrid,
    samples: SampleBox,
    cull: Cull,
    depth_test: bool,
    chunk: Chunk,
    /// Tile and record, in primitive order.
    entries: Vec<(u32, u32)>,
}

impl<'a> Builder<'a> {
    /// Nothing set up yet.
    pub(super) fn new(view: &'a View, grid: TileGrid, samples: SampleBox, cull: Cull) -> Self {
        Self {
            view,
            grid,
            samples,
            cull,
            depth_test: true,
            chunk: Chunk::default(),
            entries: Vec::new(),
        }
    }

    /// With or without the depth test.
    pub(super) fn depth_test(mut self, on: bool) -> Self {
        self.depth_test = on;
        self
    }

    /// Adds a triangle that needs no clipping: its vertices lie within near and far, and `snapped` within
    /// [`SMALL_UNITS`]. `corners` gives the vertices themselves and is asked only for what survives.
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
        self.push(primitive, v, area < 0, key, range, tiles);
        self.chunk.counters.triangles_drawn += 1;
    }

    /// Adds any triangle: clips it, and draws the polygon that is left as a fan.
    pub(super) fn clipped(&mut self, primitive: u32, corners: [Vertex; 3]) {
        self.chunk.counters.triangles_in += 1;
        let polygon = if corners.iter().all(Vertex::is_finite) {
            clip(self.view, corners)
        } else {
            Polygon::default()
        };
        let vertices = polygon.vertices();
        let snapped: Option<Vec<[i64; 2]>> = vertices.iter().map(|v| self.view.snap(v)).collect();
        let Some(snapped) = snapped.filter(|v| v.len() >= 3) else {
            self.chunk.counters.triangles_outside += 1;
            return;
        };
        let fans = || (1..snapped.len() - 1).map(|i| [snapped[0], snapped[i], snapped[i + 1]]);
        let area: i128 = fans().map(double_area).sum();
        let facing = orientation(corners.map(|v| v.homogeneous()));
        if !self.keeps(facing, area == 0) {
            return;
        }
        let (key, range) = self.depth(primitive, &corners, vertices);
        let mut drawn = false;
        for v in fans() {
            // Snapping may fold a sliver of the fan over; what it would take back is not drawn.
            if double_area(v).signum() != area.signum() {
                continue;
            }
            if let Some(tiles) = self.tiles(&v) {
                self.push(primitive, v, area < 0, key, range, tiles);
                drawn = true;
            }
        }
        let counters = &mut self.chunk.counters;
        if drawn {
            counters.triangles_drawn += 1;
            counters.triangles_clipped += 1;
        } else {
            counters.triangles_outside += 1;
        }
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
        for (tile, record) in &self.entries {
            let slot = &mut next[*tile as usize];
            items[*slot as usize] = *record;
            *slot += 1;
        }
        self.chunk.offsets = offsets;
        self.chunk.items = items;
        self.chunk.records.shrink_to_fit();
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

    /// The depth key of a triangle, and the least and greatest key of the part that is drawn. Without depth test the key is
    /// the primitive's number, so that later ones win.
    fn depth(
        &self,
        primitive: u32,
        corners: &[Vertex; 3],
        drawn: &[Vertex],
    ) -> ([f64; 3], [f32; 2]) {
        if !self.depth_test {
            let later = [f64::from(primitive), 0.0, 0.0];
            return (later, [f32::NEG_INFINITY, f32::INFINITY]);
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
        (key_plane(self.view.form, corners), range)
    }

    fn push(
        &mut self,
        primitive: u32,
        mut v: [[i64; 2]; 3],
        flip: bool,
        key: [f64; 3],
        range: [f32; 2],
        tiles: [[usize; 2]; 2],
    ) {
        if flip {
            v.swap(1, 2);
        }
        let small = v.iter().flatten().all(|c| c.abs() <= SMALL_UNITS);
        let mut record = Record {
            x: [HUGE; 3],
            y: [0; 3],
            key,
            range,
            primitive,
        };
        if small {
            record.x = [v[0][0] as i32, v[1][0] as i32, v[2][0] as i32];
            record.y = [v[0][1] as i32, v[1][1] as i32, v[2][1] as i32];
        } else {
            record.y[0] = self.chunk.huge.len() as i32;
            self.chunk.huge.push(v);
        }
        let number = self.chunk.records.len() as u32;
        self.chunk.records.push(record);
        let [[left, right], [top, bottom]] = tiles;
        let several = (right - left + 1) * (bottom - top + 1) > 2;
        for row in top..=bottom {
            for column in left..=right {
                let tile = row * self.grid.columns() + column;
                if !several || self.meets(v, tile) {
                    self.entries.push((tile as u32, number));
                }
            }
        }
    }

    /// Whether some sample of a tile may be inside all edges of a triangle.
    fn meets(&self, v: [[i64; 2]; 3], tile: usize) -> bool {
        let area = self.grid.tile(tile);
        let SampleBox { min, max } = self.samples;
        let place = [0, 1].map(|axis| (area.place[axis] << SAMPLE_BITS) + min[axis]);
        let extent = [0, 1]
            .map(|axis| ((area.size[axis] as i64 - 1) << SAMPLE_BITS) + max[axis] - min[axis]);
        !Edges::new(v, self.view.bits, place).misses(extent)
    }
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
fn key_plane(form: Form, corners: &[Vertex; 3]) -> [f64; 3] {
    if form == Form::General {
        return general_key_plane(corners);
    }
    let perspective = form == Form::Perspective;
    let point = |v: &Vertex| [v.x, v.y, if perspective { v.w } else { -v.distance }];
    let [p0, p1, p2] = [0, 1, 2].map(|i| point(&corners[i]));
    let (u, v) = (subtract(p1, p0), subtract(p2, p0));
    let n = [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ];
    if perspective {
        let d = n[0] * p0[0] + n[1] * p0[1] + n[2] * p0[2];
        [n[2] / d, n[0] / d, n[1] / d]
    } else {
        let (kx, ky) = (-n[0] / n[2], -n[1] / n[2]);
        [p0[2] - kx * p0[0] - ky * p0[1], kx, ky]
    }
}

/// The key is -reach / w: the plane over (x, y, w) with those values at the three corners, by Cramer's rule.
fn general_key_plane(corners: &[Vertex; 3]) -> [f64; 3] {
    let h = corners.map(|v| v.homogeneous());
    let mut key = [0.0; 3];
    let mut det = 0.0;
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let (p, q) = (h[j], h[k]);
        let side = [
            p[1] * q[2] - p[2] * q[1],
            p[2] * q[0] - p[0] * q[2],
            p[0] * q[1] - p[1] * q[0],
        ];
        if i == 0 {
            det = h[0][0] * side[0] + h[0][1] * side[1] + h[0][2] * side[2];
        }
        let value = -corners[i].reach;
        key[0] += value * side[2];
        key[1] += value * side[0];
        key[2] += value * side[1];
    }
    key.map(|k| k / det)
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
