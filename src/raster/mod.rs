//! The rasterizer: triangles to a picture, as OpenGL's fixed function draws them.
//!
//! In: a [`Scene`] and its [`Assembly`] (eye-space vertices). Out: a [`Frame`] of unclamped or GL-clamped linear colours,
//! depth, primitive and object numbers, layers if asked for; and [`Counters`]. Pixel frame: y down, (0, 0) top-left.
//!
//! Stages: project and snap vertices (`view`); set up, clip, cull and bin triangles (`setup`, `clip`); then tile by tile, in
//! parallel, for each sample: visibility from integer edge functions (`edges`, `tile`), weights at the unsnapped place
//! (`attribute`), lighting of what is seen (`shade`). [`Plan::new`] does the first two, which no option changes;
//! [`Plan::draw`] the rest. GL 2.1 sections 2.11, 2.12, 2.14, 3.5, 3.9, 4.1.6.
//!
//! Every sample is resolved visibility-first and shaded once: all surfaces are opaque. Depth ties go to the lowest
//! primitive number. Bytes do not depend on the number of threads: tiles do not meet, and sums over samples are in order.
//!
//! Left out: points, lines, user clip planes, polygon offset, fog, blending, textures.

mod attribute;
mod clip;
mod coverage;
mod edges;
mod outline;
mod setup;
mod shade;
mod slots;
mod tile;
mod view;

pub use coverage::{Run, coverage, coverage_clip_space, depth_key, perspective_weights};

use rayon::prelude::*;
use serde::Serialize;

use crate::error::Error;
use crate::frame::{Frame, LayerIndex, Layers, NONE, remainder, sum_in_order};
use crate::gl;
use crate::lanes::{Isa, Real};
use crate::lighting::Rig;
use crate::math::DVec2;
use crate::math::float::normalize;
use crate::sampling::{self, Pattern};
use crate::scene::assembly::Assembly;
use crate::scene::{Projection, Scene};
use setup::{Builder, Chunk, SampleBox, TILE, TileGrid};
use shade::{Mode, Pass, Sums, Workspace};
use tile::Samples;
use view::{Vertex, View};

/// The most pixels a picture may have.
pub const MAX_PIXELS: u64 = 1 << 28;

/// How one picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Flat, Gouraud or per-fragment; instead of the scene's own.
    pub shading: gl::ShadeModel,
    /// GL's clamps to [0, 1]: per vertex (flat, Gouraud) or per fragment (Phong), then the fragment's colour sum.
    pub clamp: bool,
    /// Also the terms of the equation. They describe the unclamped picture.
    pub layers: bool,
    /// Instruction set of the lighting.
    pub isa: Isa,
}

/// What a draw did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counters {
    /// Evaluations of the equation at vertices: once a tile that sees the vertex, and surface.
    pub vertices_shaded: u64,
    /// Triangles of the assembly = outside + culled + degenerate + drawn.
    pub triangles_in: u64,
    /// Beyond the picture, near or far, not finite, or between samples.
    pub triangles_outside: u64,
    /// Dropped by facing.
    pub triangles_culled: u64,
    /// Edge-on, or without area once snapped.
    pub triangles_degenerate: u64,
    /// Drawn, and cut by near, far or the guard band.
    pub triangles_clipped: u64,
    /// Handed to at least one tile.
    pub triangles_drawn: u64,
    /// Samples in the boxes around triangles.
    pub fragments_tested: u64,
    /// Samples inside triangles.
    pub fragments_covered: u64,
    /// Samples that were nearest so far.
    pub fragments_passed: u64,
    /// Evaluations of the equation, vertices included.
    pub points_shaded: u64,
}

impl Counters {
    /// Both together.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            vertices_shaded: self.vertices_shaded + other.vertices_shaded,
            triangles_in: self.triangles_in + other.triangles_in,
            triangles_outside: self.triangles_outside + other.triangles_outside,
            triangles_culled: self.triangles_culled + other.triangles_culled,
            triangles_degenerate: self.triangles_degenerate + other.triangles_degenerate,
            triangles_clipped: self.triangles_clipped + other.triangles_clipped,
            triangles_drawn: self.triangles_drawn + other.triangles_drawn,
            fragments_tested: self.fragments_tested + other.fragments_tested,
            fragments_covered: self.fragments_covered + other.fragments_covered,
            fragments_passed: self.fragments_passed + other.fragments_passed,
            points_shaded: self.points_shaded + other.points_shaded,
        }
    }
}

/// A scene ready to be drawn: everything that the options do not change.
pub struct Plan<'a, R> {
    scene: &'a Scene,
    assembly: &'a Assembly<R>,
    rig: Rig<R>,
    view: View,
    grid: TileGrid,
    chunks: Vec<Chunk>,
}

impl<'a, R: Real> Plan<'a, R> {
    /// Projects, clips, culls and bins the triangles of an assembly of this scene.
    pub fn new(scene: &'a Scene, assembly: &'a Assembly<R>) -> Self {
        let size = [scene.image.width, scene.image.height];
        let (camera, raster) = (&scene.camera, &scene.raster);
        let view = View::new(camera, size, raster.snap, raster.front_face);
        let drawable = check_image(scene).is_ok();
        let grid = TileGrid {
            size: if drawable {
                size.map(|n| n as usize)
            } else {
                [0; 2]
            },
            origin: [0; 2],
        };
        let mut plan = Self {
            scene,
            assembly,
            rig: Rig::new(&scene.lights_eye(), &scene.light_model),
            view,
            grid,
            chunks: Vec::new(),
        };
        if drawable {
            plan.chunks = plan.set_up();
        }
        plan
    }

    /// Draws the picture.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a picture without pixels or samples, [`Error::Limit`] for one that is too large.
    pub fn draw(&self, options: &Options) -> Result<(Frame<R>, Counters), Error> {
        check_image(self.scene)?;
        let [width, height] = self.grid.size;
        let mode = Mode::new(self, options);
        let mut frame = Frame::empty(width, height);
        if options.layers {
            let names = self.scene.light_names();
            frame.layers = Some(Layers::zero(&names, width, height, mode.signed()));
        }
        let rays = RayTables::new(self);
        let drawer = Drawer {
            plan: self,
            mode,
            options,
            rays,
        };
        let drawn = drawer.bands(&mut frame);
        let counters = self.chunks.iter().map(|chunk| &chunk.counters);
        let counters = counters.fold(drawn, |sum, c| sum.plus(c));
        Ok((frame, counters))
    }

    /// The corners of a primitive.
    fn corners(&self, primitive: u32) -> [Vertex; 3] {
        let corners = self.assembly.triangles[primitive as usize];
        corners.map(|v| {
            self.view
                .vertex(self.assembly.vertex_eye(v).map(Real::to_f64))
        })
    }

    /// Unit vector to the viewer: towards the eye, or (0, 0, 1) for an infinite viewer (GL 2.1 section 2.14.1).
    fn to_viewer(&self, position_eye: [R; 3]) -> [R; 3] {
        if self.scene.light_model.local_viewer {
            normalize(position_eye.map(|x| -x)).0
        } else {
            [R::ZERO, R::ZERO, R::ONE]
        }
    }

    /// The material of a surface number.
    fn material(&self, surface: usize) -> &gl::Material {
        let material = &self.scene.materials[surface / 2];
        match &material.back {
            Some(back) if surface % 2 == 1 => back,
            _ => &material.front,
        }
    }

    /// Vertex stage and triangle setup, in chunks of consecutive primitives.
    fn set_up(&self) -> Vec<Chunk> {
        let snapped = self.snap_vertices();
        let triangles = &self.assembly.triangles;
        let samples = self.sample_box();
        // Enough chunks to share out, few enough that their tile tables stay small.
        let length = triangles.len().div_ceil(256).max(4096);
        let chunks = triangles.par_chunks(length).enumerate();
        chunks
            .map(|(index, part)| {
                let cull = self.scene.raster.cull;
                let mut builder = Builder::new(&self.view, self.grid, samples, cull);
                for (i, corners) in part.iter().enumerate() {
                    let primitive = (index * length + i) as u32;
                    let places = corners.map(|v| snapped[v as usize]);
                    if places.contains(&NEEDS_CLIPPING) {
                        builder.clipped(primitive, self.corners(primitive));
                    } else {
                        builder.inside(primitive, places, || self.corners(primitive));
                    }
                }
                builder.finish()
            })
            .collect()
    }

    /// Snapped pixel coordinates of the vertices, or [`NEEDS_CLIPPING`].
    fn snap_vertices(&self) -> Vec<[i32; 2]> {
        let [x, y, z] = &self.assembly.position_eye;
        (x, y, z)
            .into_par_iter()
            .map(|(x, y, z)| {
                let v = self.view.vertex([x, y, z].map(|x| x.to_f64()));
                let inside = v.distance >= self.view.near && v.distance <= self.view.far;
                let small = |p: &[i64; 2]| p.iter().all(|c| c.abs() <= edges::SMALL_UNITS);
                match self.view.snap(&v).filter(small) {
                    Some(place) if inside => place.map(|c| c as i32),
                    _ => NEEDS_CLIPPING,
                }
            })
            .collect()
    }

    /// The place of a sample in its pixel, in 1/256 px.
    fn sample_offset(&self, x: u32, y: u32, sample: u32) -> [i64; 2] {
        let image = &self.scene.image;
        let (sx, sy) = sampling::position(image.pattern, image.samples, x, y, sample);
        [i64::from(sx), i64::from(sy)]
    }

    fn sample_box(&self) -> SampleBox {
        match self.scene.image.pattern {
            Pattern::Jitter => SampleBox {
                min: [0; 2],
                max: [i64::from(sampling::SUBPIXEL) - 1; 2],
            },
            Pattern::Grid => {
                let first = self.sample_offset(0, 0, 0);
                let last = self.sample_offset(0, 0, self.scene.image.samples - 1);
                SampleBox {
                    min: first,
                    max: last,
                }
            }
        }
    }

    /// X and Y of the ray through a place of the pixel frame: what weights and depth keys are evaluated at.
    fn ray(&self, x: f64, y: f64) -> [f64; 2] {
        let [width, height] = self.grid.size.map(|n| n as u32);
        let camera = &self.scene.camera;
        let (origin, direction) = camera.primary_ray(DVec2::new(x, y), width, height);
        match camera.projection {
            Projection::Perspective { .. } => [direction.x, direction.y],
            Projection::Orthographic { .. } => [origin.x, origin.y],
        }
    }
}

/// A vertex beyond near, far or 2^29 units: its triangles take the long way.
const NEEDS_CLIPPING: [i32; 2] = [i32::MIN; 2];

fn check_image(scene: &Scene) -> Result<(), Error> {
    let image = &scene.image;
    let pixels = u64::from(image.width) * u64::from(image.height);
    if pixels == 0 {
        let size = format!("{}x{}", image.width, image.height);
        return Err(Error::parameter(
            "size",
            format!("a picture of {size} pixels shows nothing"),
        ));
    }
    if pixels > MAX_PIXELS || image.width.max(image.height) > 1 << 17 {
        return Err(Error::limit(format!(
            "a picture of {}x{} pixels exceeds {MAX_PIXELS} pixels, or {} in one direction",
            image.width,
            image.height,
            1 << 17
        ))
        .with_help("draw it smaller"));
    }
    if !(1..=sampling::MAX_SAMPLES).contains(&image.samples) {
        return Err(Error::parameter(
            "samples",
            format!(
                "expected 1 to {}, found {}",
                sampling::MAX_SAMPLES,
                image.samples
            ),
        ));
    }
    Ok(())
}

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
struct Drawer<'a, 's, R> {
    plan: &'a Plan<'s, R>,
    mode: Mode,
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

impl<R: Real> Drawer<'_, '_, R> {
    /// Draws all tiles into the frame.
    fn bands(&self, frame: &mut Frame<R>) -> Counters {
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
        let mut sums = Sums::new(&self.mode);
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
                mode: &self.mode,
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
    fn samples<'b>(
        &'b self,
        places: &'b mut Places,
        area: &setup::TileArea,
        sample: u32,
    ) -> Samples<'b> {
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
                band.layers[index.remainder()][to] = close(plain, values, self.mode.signed());
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
