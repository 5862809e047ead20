//! Tiles to a frame: where samples lie, tile by tile in parallel, means over samples, and the layer that closes the sum.

use rayon::prelude::*;

use super::bin::{TILE, TileArea};
use super::lit::Mode;
use super::record::Record;
use super::shade::{Pass, Shown, Workspace};
use super::tile::Samples;
use super::{Counters, Options, Plan};
use crate::frame::{Frame, LayerIndex, NONE, remainder};
use crate::lanes::Real;
use crate::math::Each;
use crate::sampling::{self, Pattern};

/// Ray coordinates of grid samples: one list of columns a sample column, one of rows a sample row.
struct RayTables {
    columns: Vec<Vec<f64>>,
    rows: Vec<Vec<f64>>,
}

impl RayTables {
    fn new<R: Real>(plan: &Plan<'_, R>) -> Self {
        let image = &plan.scene.image;
        if image.pattern == Pattern::Jitter {
            return Self {
                columns: Vec::new(),
                rows: Vec::new(),
            };
        }
        let (columns, rows) = sampling::grid_shape(image.samples);
        let unit = f64::from(sampling::SUBPIXEL);
        let place = |sample: u32| plan.sample_offset(0, 0, sample).map(|o| o as f64 / unit);
        Self {
            columns: (0..columns)
                .map(|sample| {
                    let offset = place(sample)[0];
                    let x = |x: u32| plan.ray(f64::from(x) + offset, 0.0)[0];
                    (0..image.width).map(x).collect()
                })
                .collect(),
            rows: (0..rows)
                .map(|sample| {
                    let offset = place(sample * columns)[1];
                    let y = |y: u32| plan.ray(0.0, f64::from(y) + offset)[1];
                    (0..image.height).map(y).collect()
                })
                .collect(),
        }
    }
}

/// One draw: the plan, the options, and the rays of the samples.
pub(super) struct Drawer<'a, 's, R> {
    plan: &'a Plan<'s, R>,
    mode: &'a Mode,
    options: &'a Options,
    rays: RayTables,
}

/// A part of a frame: the rows that one row of tiles fills, or the rows of one tile.
struct Part<P, D, N> {
    color: P,
    depth: D,
    primitive: N,
    object: N,
    layers: Vec<P>,
}

/// The rows of a row of tiles, whole.
type Band<'f, R> = Part<&'f mut [[R; 3]], &'f mut [R], &'f mut [u32]>;

/// The rows of a tile, one slice each.
type Rows<'f, R> = Part<Vec<&'f mut [[R; 3]]>, Vec<&'f mut [R]>, Vec<&'f mut [u32]>>;

/// A frame cut into rows of tiles.
fn bands<R: Real>(frame: &mut Frame<R>) -> Vec<Band<'_, R>> {
    let rows = TILE * frame.color.width;
    let mut bands: Vec<Band<'_, R>> = frame
        .color
        .data
        .chunks_mut(rows)
        .zip(frame.depth.data.chunks_mut(rows))
        .zip(frame.primitive.data.chunks_mut(rows))
        .zip(frame.object.data.chunks_mut(rows))
        .map(|(((color, depth), primitive), object)| Part {
            color,
            depth,
            primitive,
            object,
            layers: Vec::new(),
        })
        .collect();
    for plane in frame.layers.iter_mut().flat_map(|l| &mut l.planes) {
        for (band, part) in bands.iter_mut().zip(plane.data.chunks_mut(rows)) {
            band.layers.push(part);
        }
    }
    bands
}

/// The rows of a band cut into the rows of its tiles.
fn cut<'f, R>(band: Band<'f, R>, width: usize) -> Vec<Rows<'f, R>> {
    let mut color = columns(band.color, width).into_iter();
    let mut depth = columns(band.depth, width).into_iter();
    let mut primitive = columns(band.primitive, width).into_iter();
    let mut object = columns(band.object, width).into_iter();
    let layers = band
        .layers
        .into_iter()
        .map(|l| columns(l, width).into_iter());
    let mut layers: Vec<_> = layers.collect();
    let mut tiles = Vec::with_capacity(width.div_ceil(TILE));
    while let (Some(color), Some(depth), Some(primitive), Some(object)) =
        (color.next(), depth.next(), primitive.next(), object.next())
    {
        tiles.push(Part {
            color,
            depth,
            primitive,
            object,
            layers: layers.iter_mut().filter_map(Iterator::next).collect(),
        });
    }
    tiles
}

/// The rows of each tile of a band of rows.
fn columns<T>(band: &mut [T], width: usize) -> Vec<Vec<&mut [T]>> {
    let rows = band.len() / width;
    let mut tiles: Vec<Vec<&mut [T]>> = (0..width.div_ceil(TILE))
        .map(|_| Vec::with_capacity(rows))
        .collect();
    for row in band.chunks_mut(width) {
        for (tile, part) in tiles.iter_mut().zip(row.chunks_mut(TILE)) {
            tile.push(part);
        }
    }
    tiles
}

/// Sums in f64 over the samples of a tile, row-major with stride [`TILE`].
#[derive(Default)]
struct Sums {
    color: Vec<[f64; 3]>,
    plain: Vec<[f64; 3]>,
    layers: Vec<Vec<[f64; 3]>>,
}

impl Sums {
    /// Adds a sample, or starts with it.
    fn add<R: Real>(&mut self, shown: &Shown<R>, first: bool) {
        add(&mut self.color, &shown.color, first);
        add(&mut self.plain, &shown.plain, first);
        self.layers.resize_with(shown.layers.len(), Vec::new);
        for (sum, layer) in self.layers.iter_mut().zip(&shown.layers) {
            add(sum, layer, first);
        }
    }

    /// The means, in the place of the last sample.
    fn resolve<R: Real>(&self, shown: &mut Shown<R>, samples: u32) {
        resolve(&self.color, &mut shown.color, samples);
        resolve(&self.plain, &mut shown.plain, samples);
        for (sum, layer) in self.layers.iter().zip(&mut shown.layers) {
            resolve(sum, layer, samples);
        }
    }
}

fn add<R: Real>(sums: &mut Vec<[f64; 3]>, values: &[[R; 3]], first: bool) {
    if first {
        sums.clear();
        sums.resize(values.len(), [0.0; 3]);
    }
    for (sum, value) in sums.iter_mut().zip(values) {
        for (s, x) in sum.iter_mut().zip(value) {
            *s += x.to_f64();
        }
    }
}

fn resolve<R: Real>(sums: &[[f64; 3]], values: &mut [[R; 3]], samples: u32) {
    for (sum, value) in sums.iter().zip(values) {
        *value = sampling::resolve(*sum, samples);
    }
}

/// Memory of one worker, reused from tile to tile.
struct Worker<R> {
    workspace: Workspace<R>,
    sums: Sums,
    places: Places,
}

impl<'a, 's, R: Real> Drawer<'a, 's, R> {
    /// Prepares a draw.
    pub(super) fn new(plan: &'a Plan<'s, R>, mode: &'a Mode, options: &'a Options) -> Self {
        Self {
            plan,
            mode,
            options,
            rays: RayTables::new(plan),
        }
    }

    /// Draws all tiles into the frame.
    pub(super) fn bands(&self, frame: &mut Frame<R>) -> Counters {
        let (columns, width) = (self.plan.grid.columns(), self.plan.grid.size[0]);
        let tiles = bands(frame).into_par_iter().enumerate();
        let tiles = tiles.flat_map(|(row, band)| {
            let tiles = cut(band, width).into_par_iter().enumerate();
            tiles.map(move |(column, rows)| (row * columns + column, rows))
        });
        let counters = tiles.map_init(
            || self.worker(),
            |worker, (index, rows)| {
                let area = self.plan.grid.tile(index);
                self.tile(worker, index, &area, rows)
            },
        );
        // Integers: their sum does not depend on the order.
        counters.reduce(Counters::default, |a, b| a.plus(&b))
    }

    /// Draws one pixel of the picture into a frame of that size; `record` listens.
    pub(super) fn pixel(
        &self,
        [x, y]: [u32; 2],
        frame: &mut Frame<R>,
        record: Option<Box<Record<R>>>,
    ) -> Option<Box<Record<R>>> {
        let grid = &self.plan.grid;
        let corner = [x as usize, y as usize];
        let index = corner[1] / TILE * grid.columns() + corner[0] / TILE;
        let area = TileArea {
            corner,
            place: [0, 1].each(|axis| grid.origin[axis] + corner[axis] as i64),
            size: [1, 1],
        };
        let mut worker = self.worker();
        worker.workspace.record = record;
        for rows in bands(frame).into_iter().flat_map(|band| cut(band, 1)) {
            self.tile(&mut worker, index, &area, rows);
        }
        worker.workspace.record
    }

    fn worker(&self) -> Worker<R> {
        Worker {
            workspace: Workspace::new(self.mode, self.plan),
            sums: Sums::default(),
            places: Places::default(),
        }
    }

    /// Draws the samples of an area of one tile.
    fn tile(
        &self,
        worker: &mut Worker<R>,
        index: usize,
        area: &TileArea,
        rows: Rows<'_, R>,
    ) -> Counters {
        let plan = self.plan;
        let mut counters = Counters::default();
        let Worker {
            workspace,
            sums,
            places,
        } = worker;
        let count = plan.scene.image.samples;
        let blends = plan.blends();
        workspace.start_tile();
        for sample in 0..count {
            let samples = self.samples(places, area, sample);
            workspace.visibility.clear();
            for chunk in plan.chunks.iter().filter(|c| c.meets_tile(index)) {
                for triangle in chunk.of_tile(index) {
                    if blends && plan.blend_alpha(triangle.0.primitive).is_some() {
                        continue;
                    }
                    let (bits, counters) = (plan.view.bits, &mut counters);
                    let visibility = &mut workspace.visibility;
                    visibility.draw(area, &samples, bits, triangle, counters);
                }
            }
            let pass = Pass {
                plan,
                mode: self.mode,
                options: self.options,
                area,
                samples: &samples,
                first: sample == 0,
            };
            workspace.sample(&pass, &mut counters);
            if blends {
                workspace.blend(&pass, index, &mut counters);
            }
            if let Some(record) = &mut workspace.record {
                record.end_sample(workspace.shown.color[0]);
            }
            if count > 1 {
                sums.add(&workspace.shown, sample == 0);
            }
        }
        if count > 1 {
            sums.resolve(&mut workspace.shown, count);
        }
        self.write(rows, &workspace.shown);
        counters
    }

    /// Where one sample of each pixel of a tile lies.
    fn samples<'b>(&'b self, places: &'b mut Places, area: &TileArea, sample: u32) -> Samples<'b> {
        let plan = self.plan;
        let [left, top] = area.corner;
        let [width, height] = area.size;
        if plan.scene.image.pattern == Pattern::Grid {
            let (columns, _) = sampling::grid_shape(plan.scene.image.samples);
            let x = &self.rays.columns[(sample % columns) as usize];
            let y = &self.rays.rows[(sample / columns) as usize];
            return Samples::Shared {
                offset: plan.sample_offset(0, 0, sample),
                x: &x[left..left + width],
                y: &y[top..top + height],
            };
        }
        let unit = f64::from(sampling::SUBPIXEL);
        places.offset.resize(TILE * TILE, [0; 2]);
        places.ray.resize(TILE * TILE, [0.0; 2]);
        for row in 0..height {
            for column in 0..width {
                let (x, y) = ((left + column) as u32, (top + row) as u32);
                let offset = plan.sample_offset(x, y, sample);
                let [dx, dy] = offset.map(|o| o as f64 / unit);
                places.offset[row * TILE + column] = offset;
                places.ray[row * TILE + column] = plan.ray(f64::from(x) + dx, f64::from(y) + dy);
            }
        }
        Samples::Each {
            offset: &places.offset,
            ray: &places.ray,
        }
    }

    /// Writes a tile into its rows of the frame.
    fn write(&self, mut rows: Rows<'_, R>, shown: &Shown<R>) {
        let object = &self.plan.assembly.object;
        let height = rows.color.len();
        for y in 0..height {
            let from = y * TILE..y * TILE + rows.color[y].len();
            rows.color[y].copy_from_slice(&shown.color[from.clone()]);
            rows.depth[y].copy_from_slice(&shown.depth[from.clone()]);
            rows.primitive[y].copy_from_slice(&shown.primitive[from.clone()]);
            for (to, primitive) in rows.object[y].iter_mut().zip(&shown.primitive[from]) {
                *to = match *primitive {
                    NONE => NONE,
                    primitive => object[primitive as usize],
                };
            }
        }
        if !shown.layers.is_empty() {
            self.write_layers(&mut rows.layers, shown);
        }
    }

    fn write_layers(&self, planes: &mut [Vec<&mut [[R; 3]]>], shown: &Shown<R>) {
        let lights = self.plan.rig.light_count();
        let last = LayerIndex { lights }.remainder();
        let picture = if self.mode.keeps_plain() {
            &shown.plain
        } else {
            &shown.color
        };
        for y in 0..planes[last].len() {
            for x in 0..planes[last][y].len() {
                let from = y * TILE + x;
                for (plane, layer) in planes.iter_mut().zip(&shown.layers) {
                    plane[y][x] = layer[from];
                }
                // Reflection and refraction are +0.
                for plane in &mut planes[shown.layers.len()..last] {
                    plane[y][x] = [R::ZERO; 3];
                }
                let values = planes[..last].iter().map(|plane| plane[y][x]);
                planes[last][y][x] = remainder(picture[from], values, self.mode.signed);
            }
        }
    }
}

/// Places of jittered samples of a tile.
#[derive(Default)]
struct Places {
    offset: Vec<[i64; 2]>,
    ray: Vec<[f64; 2]>,
}
