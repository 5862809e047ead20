//! Tiles to a frame: where samples lie, tile by tile in parallel, means over samples, and the layer that closes the sum.

use rayon::prelude::*;

use super::lit::Mode;
use super::setup::{TILE, TileArea};
use super::shade::{Pass, Sums, Workspace};
use super::tile::Samples;
use super::{Counters, Options, Plan};
use crate::frame::{Frame, LayerIndex, NONE, remainder, sum_in_order};
use crate::lanes::Real;
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

/// The rows of a frame that one row of tiles fills.
struct Band<'f, R> {
    color: &'f mut [[R; 3]],
    depth: &'f mut [R],
    primitive: &'f mut [u32],
    object: &'f mut [u32],
    layers: Vec<&'f mut [[R; 3]]>,
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
        let rows = TILE * self.plan.grid.size[0];
        let mut bands: Vec<Band<'_, R>> = frame
            .color
            .data
            .chunks_mut(rows)
            .zip(frame.depth.data.chunks_mut(rows))
            .zip(frame.primitive.data.chunks_mut(rows))
            .zip(frame.object.data.chunks_mut(rows))
            .map(|(((color, depth), primitive), object)| Band {
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
        let columns = self.plan.grid.columns();
        let materials = self.plan.scene.materials.len();
        let counters = bands.into_par_iter().enumerate().map(|(row, mut band)| {
            let tiles: Vec<(Sums<R>, Counters)> = (0..columns)
                .into_par_iter()
                .map_init(
                    || Workspace::new(materials),
                    |workspace, column| self.tile(workspace, row * columns + column),
                )
                .collect();
            let mut counters = Counters::default();
            for (column, (sums, part)) in tiles.iter().enumerate() {
                self.resolve(&mut band, row * columns + column, sums);
                counters = counters.plus(part);
            }
            counters
        });
        // Integers: their sum does not depend on the order.
        counters.reduce(Counters::default, |a, b| a.plus(&b))
    }

    /// Draws the samples of one tile.
    fn tile(&self, workspace: &mut Workspace<R>, index: usize) -> (Sums<R>, Counters) {
        let plan = self.plan;
        let area = plan.grid.tile(index);
        let mut sums = Sums::new(self.mode);
        let mut counters = Counters::default();
        let mut places = Places::default();
        workspace.start_tile();
        for sample in 0..plan.scene.image.samples {
            let samples = self.samples(&mut places, &area, sample);
            workspace.visibility.clear();
            for chunk in &plan.chunks {
                for (record, v) in chunk.of_tile(index) {
                    let (bits, counters) = (plan.view.bits, &mut counters);
                    workspace
                        .visibility
                        .draw(&area, &samples, bits, record, v, counters);
                }
            }
            let pass = Pass {
                plan,
                mode: self.mode,
                options: self.options,
                area: &area,
                samples: &samples,
                first: sample == 0,
            };
            workspace.sample(&pass, &mut sums, &mut counters);
        }
        (sums, counters)
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

    /// Writes the means over a tile's samples into the frame.
    fn resolve(&self, band: &mut Band<'_, R>, index: usize, sums: &Sums<R>) {
        let plan = self.plan;
        let area = plan.grid.tile(index);
        let samples = plan.scene.image.samples;
        let index = LayerIndex {
            lights: plan.rig.light_count(),
        };
        for y in 0..area.size[1] {
            for x in 0..area.size[0] {
                let from = y * TILE + x;
                let to = y * plan.grid.size[0] + area.corner[0] + x;
                let color: [R; 3] = sampling::resolve(sums.color[from], samples);
                band.color[to] = color;
                band.depth[to] = sums.depth[from];
                let primitive = sums.primitive[from];
                band.primitive[to] = primitive;
                if primitive != NONE {
                    band.object[to] = plan.assembly.object[primitive as usize];
                }
                if sums.layers.is_empty() {
                    continue;
                }
                for (layer, sum) in band.layers.iter_mut().zip(&sums.layers) {
                    layer[to] = sampling::resolve(sum[from], samples);
                }
                let plain = match sums.plain.get(from) {
                    Some(sum) => sampling::resolve(*sum, samples),
                    None => color,
                };
                let values = band.layers[..index.remainder()].iter().map(|l| l[to]);
                band.layers[index.remainder()][to] = close(plain, values, self.mode.signed);
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

/// The layer that makes the sum of all layers the picture, bit for bit.
fn close<R: Real>(picture: [R; 3], layers: impl Iterator<Item = [R; 3]>, signed: bool) -> [R; 3] {
    if !signed {
        let sum = sum_in_order(layers, false);
        return [0, 1, 2].map(|k| remainder(picture[k], sum[k]));
    }
    let sum = sum_in_order(layers.map(|l| l.map(Real::to_f64)), false);
    [0, 1, 2].map(|k| {
        if R::from_f64(sum[k]) == picture[k] {
            R::ZERO
        } else {
            R::from_f64(remainder(picture[k].to_f64(), sum[k]))
        }
    })
}
