//! The tracer: Whitted's light transport over the one lighting equation.
//!
//! In: a scene, its assembly (the rasterizer's triangles), options. Out: a [`Frame`] of unclamped linear colours, with
//! layers if asked for, and [`Counters`]. Rays and hierarchy live in world space and f64; hits come out in eye space, where
//! `lighting` works. Sheet: `whitted.md`; decisions: DESIGN section 1, "Tracing".
//!
//! | module | does |
//! | - | - |
//! | `exact` | products and sums with known error |
//! | `ray` | rays, hits, the spawn offset |
//! | `planar` `sphere` `cuboid` | what a ray meets: triangle, parallelogram, sphere, box |
//! | `disk` `cylinder` `cone` `torus` | round shapes, `span` where convex; `body` one interface to them |
//! | `revolution` `hyperbola` `isolate` | surfaces of revolution, a piece of profile at a time; rays about an axis; roots |
//! | `bezier` | bicubic patches |
//! | `solid` `surface` | shapes in the world; everything that rays meet, under one hierarchy |
//! | `build` `split` `bvh` `instance` | the hierarchy, and meshes that several objects share |
//! | `optics` `media` `inside` `branch` | directions, media, those that the camera is in, secondary rays |
//! | `shadow` `tile` `sums` | S_L; a tile in waves; its sums |
//! | `record` | what happened on the way to one pixel, for whoever explains it |
//! | `faults` | mistakes that people make, for `check` |
//! | `touch` | surfaces that touch are one event |
//!
//! Facing of an exact shape: outward = front, under any transform; a triangle's front is the side whose corners run the
//! front winding in the window. `front_face = "cw"` turns both round. Secondary rays look back along themselves: an infinite
//! viewer is the picture's alone.
//!
//! Measured (2026-11, one x86-64 thread, CPU time, dev profile at opt-level 2, where the box test is not yet vectors; at 3 it
//! is): 1024 x 1024 primary rays on the 69,451-triangle bunny 0.49 s, 4.0 nodes and 1.3 triangles a ray, 41.6 % hit; on the
//! 871,414-triangle dragon with a floor 0.66 s, 4.6 nodes and 1.8 primitives a ray, 80.0 % hit, built in 1.1 s (139,318
//! nodes); peak memory with scene and assembly 0.4 GB. Three spheres on a floor at depth 6 (glass, mirror, red): 2,470,927
//! secondary and 3,909,559 shadow rays, where an independent tracer with fixed offsets counts 2,470,927 and 3,909,533.
//!
//! Vertex colours are interpolated as normals are, and light a hit in place of the terms that its material tracks; exact
//! shapes are white, GL's current colour by default.
//!
//! Left out: textures, packets.

mod bezier;
mod body;
mod branch;
pub mod build;
pub mod bvh;
pub mod cone;
pub mod cuboid;
pub mod cylinder;
pub mod disk;
pub mod exact;
mod faults;
mod hyperbola;
mod inside;
mod instance;
mod isolate;
mod media;
pub mod optics;
pub mod planar;
pub mod ray;
pub mod record;
pub mod revolution;
mod shadow;
mod solid;
pub mod span;
pub mod sphere;
mod split;
mod sums;
pub mod surface;
mod tile;
pub mod torus;
mod touch;

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

pub use faults::{Faults, Normals};
pub use shadow::Lamp;
pub use surface::Surfaces;

use crate::error::Error;
use crate::frame::{Frame, LayerIndex, Layers, Plane};
use crate::gl;
use crate::lanes::{Isa, Real};
use crate::lighting::{self, Rig, Rounded};
use crate::scene::Scene;
use crate::scene::assembly::Assembly;
use crate::scene::requirements::{Mode, Model, Requirements};
use bvh::Work;
use inside::Inside;
use media::Order;
use ray::Ray;
use record::Record;
use shadow::lamps;
use tile::{Area, TileFrame};

/// The most secondary rays that one sample of a pixel may cast.
pub const MAX_RAYS: u32 = 1 << 18;

/// Pixels a side of a tile.
const TILE: u32 = 16;

/// What rays meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Geometry {
    /// The true shapes; meshes keep their triangles (the default).
    #[default]
    Exact,
    /// The rasterizer's own triangles.
    Mesh,
}

impl Geometry {
    /// The one table of names: command line, scene file and reports.
    pub const NAMES: &[(&'static str, Self)] = &[("exact", Self::Exact), ("mesh", Self::Mesh)];
}

/// What is traced beyond the primary rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Generations of secondary rays.
    pub depth: u32,
    /// Shadow rays are cast; else every light counts as lit.
    pub shadows: bool,
    /// Mirror rays are cast.
    pub reflection: bool,
    /// Transmitted rays are cast, and primary rays start in the media around the camera.
    pub refraction: bool,
    /// The frame carries its layers.
    pub layers: bool,
    /// Instruction set of the lighting equation. Changes no byte.
    pub isa: Isa,
}

impl Options {
    /// Primary rays only, S_L left out: the picture that equals the rasterizer's.
    pub fn cast(isa: Isa) -> Self {
        Self {
            depth: 0,
            shadows: false,
            reflection: false,
            refraction: false,
            layers: false,
            isa,
        }
    }

    /// What the scene asks for.
    pub fn of(scene: &Scene, isa: Isa) -> Self {
        Self {
            depth: scene.trace.depth,
            shadows: true,
            reflection: true,
            refraction: true,
            layers: false,
            isa,
        }
    }
}

/// Rays by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Rays {
    /// From the eye.
    pub primary: u64,
    /// Towards lights.
    pub shadow: u64,
    /// Mirrored.
    pub reflection: u64,
    /// Transmitted.
    pub refraction: u64,
}

/// The work of a render. Equal for every thread count and tile order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Counters {
    /// Rays by kind.
    pub rays: Rays,
    /// Inner nodes entered.
    pub node_visits: u64,
    /// Child boxes tested.
    pub box_tests: u64,
    /// Primitives tested.
    pub primitive_tests: u64,
    /// Points that the lighting equation was asked for.
    pub shaded_points: u64,
    /// Unit vectors made for them: shading normals, and directions to the viewer.
    pub normalizations: u64,
    /// What the equation did.
    pub lighting: lighting::Counters,
    /// Inner nodes of the hierarchy.
    pub bvh_nodes: u64,
    /// Leaves of the hierarchy.
    pub bvh_leaves: u64,
}

impl Counters {
    fn add(&mut self, other: &Self) {
        self.rays.primary += other.rays.primary;
        self.rays.shadow += other.rays.shadow;
        self.rays.reflection += other.rays.reflection;
        self.rays.refraction += other.rays.refraction;
        self.node_visits += other.node_visits;
        self.box_tests += other.box_tests;
        self.primitive_tests += other.primitive_tests;
        self.shaded_points += other.shaded_points;
        self.normalizations += other.normalizations;
        self.lighting += other.lighting;
    }

    fn add_work(&mut self, work: &Work) {
        self.node_visits += work.node_visits;
        self.box_tests += work.box_tests;
        self.primitive_tests += work.primitive_tests;
    }
}

/// Everything about a scene that does not depend on options: made once, drawn with several.
#[derive(Clone, Debug)]
pub struct Plan<'a, R> {
    scene: &'a Scene,
    surfaces: Arc<Surfaces<'a, R>>,
    inside: Inside,
    rig: Rig<R>,
    rounded: Rounded,
    /// The enabled lights: places in the world, and GL parameters in eye space.
    lamps: Vec<Lamp>,
    sources: Vec<gl::LightSource>,
    needs: Requirements,
    /// Of each lamp, the faces whose planes it lies in.
    lamp_planes: Vec<Vec<(u32, u32)>>,
    /// What orders the solids.
    order: Order,
    /// Some colour is negative: sums run in f64.
    signed: bool,
    build_seconds: f64,
    faults: Faults,
}

impl<'a, R: Real> Plan<'a, R> {
    /// Prepares a scene: resolves its lights and builds the hierarchy.
    ///
    /// # Errors
    /// [`Error::Parameter`] where the picture has no pixels.
    pub fn new(
        scene: &'a Scene,
        assembly: &'a Assembly<R>,
        geometry: Geometry,
        model: Model,
    ) -> Result<Self, Error> {
        let needs = Requirements::plan(scene, Mode::Trace, model);
        Self::with_requirements(scene, assembly, geometry, needs)
    }

    /// [`Plan::new`] with requirements of the caller's: what they lack is not evaluated, and rays that they lack not cast.
    ///
    /// # Errors
    /// As [`Plan::new`].
    pub fn with_requirements(
        scene: &'a Scene,
        assembly: &'a Assembly<R>,
        geometry: Geometry,
        needs: Requirements,
    ) -> Result<Self, Error> {
        let image = &scene.image;
        if image.width == 0 || image.height == 0 {
            let size = format!("{}x{} has no pixels", image.width, image.height);
            return Err(Error::parameter("image", size));
        }
        let start = Instant::now();
        let surfaces = Surfaces::new(scene, assembly, geometry == Geometry::Exact);
        let build_seconds = start.elapsed().as_secs_f64();
        Ok(Self::over(scene, Arc::new(surfaces), needs, build_seconds))
    }

    /// A plan over surfaces that are there.
    fn over(
        scene: &'a Scene,
        surfaces: Arc<Surfaces<'a, R>>,
        needs: Requirements,
        build_seconds: f64,
    ) -> Self {
        let sources = scene.lights_eye();
        let lamps = lamps(scene);
        let planes = |lamp: &Lamp| match lamp {
            Lamp::Point(place) => surfaces.planes_through(*place),
            Lamp::Direction(_) => Vec::new(),
        };
        Self {
            lamp_planes: lamps.iter().map(planes).collect(),
            order: Order::of(scene),
            scene,
            surfaces,
            inside: Inside::new(scene),
            rig: Rig::planned(&sources, &scene.light_model, &needs),
            rounded: Rounded::default(),
            lamps,
            sources,
            needs,
            signed: scene.has_negative_colors(),
            build_seconds,
            faults: Faults::default(),
        }
    }

    /// The same surfaces and their hierarchy under a scene that differs in lights, materials, light model, settings of the
    /// tracer, size or projection alone: objects, the camera's place, `normalize` and front faces are those of the first.
    pub fn relit<'b>(&self, scene: &'b Scene) -> Plan<'b, R>
    where
        'a: 'b,
    {
        let surfaces: Arc<Surfaces<'b, R>> = self.surfaces.clone();
        let needs = Requirements::plan(scene, Mode::Trace, self.needs.model());
        Plan::over(scene, surfaces, needs, self.build_seconds)
    }

    /// The same plan with mistakes in it.
    #[must_use]
    pub fn with_faults(self, faults: Faults) -> Self {
        Self {
            rig: self.rig.with_faults(faults.lighting),
            faults,
            ..self
        }
    }

    /// The same plan, with inputs of the equation rounded to f32: to measure what that does to a picture in f64. The
    /// assembly's own numbers stay the caller's affair.
    #[must_use]
    pub fn rounding(mut self, rounded: Rounded) -> Self {
        self.rig = self.rig.rounding(rounded);
        self.rounded = rounded;
        self
    }

    /// How long the hierarchy took to build, in seconds. Kept apart from [`Counters`], which repeat.
    pub fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    /// How many triangles the scene has.
    pub fn triangles(&self) -> usize {
        self.surfaces.triangles()
    }

    /// What rays meet.
    pub fn surfaces(&self) -> &Surfaces<'a, R> {
        &self.surfaces
    }

    /// Traces the picture.
    ///
    /// # Errors
    /// [`Error::Limit`] where a pixel would cast more than [`MAX_RAYS`] secondary rays, or layers would fill the memory.
    pub fn draw(&self, options: &Options) -> Result<(Frame<R>, Counters), Error> {
        self.draw_tiles(options, TILE)
    }

    /// [`Self::draw`], where the layers asked for also hold reflection and refraction split by light.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn draw_split(&self, options: &Options) -> Result<(Frame<R>, Counters), Error> {
        self.draw_parts(options, TILE, true)
    }

    /// [`Self::draw`] with another tile size; the bytes are the same.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn draw_tiles(&self, options: &Options, side: u32) -> Result<(Frame<R>, Counters), Error> {
        self.draw_parts(options, side, false)
    }

    fn draw_parts(
        &self,
        options: &Options,
        side: u32,
        split: bool,
    ) -> Result<(Frame<R>, Counters), Error> {
        let image = &self.scene.image;
        if options.layers {
            let lights = self.lamps.len();
            LayerIndex { lights }.check_size(image.width, image.height)?;
        }
        let areas = areas(image.width, image.height, side.max(1));
        let tiles: Vec<_> = areas
            .into_par_iter()
            .map(|area| tile::draw(self, options, area, split))
            .collect();
        let (width, height) = (
            self.scene.image.width as usize,
            self.scene.image.height as usize,
        );
        let mut frame = Frame::empty(width, height);
        if options.layers {
            let names = self.scene.light_names();
            let mut layers = Layers::zero(&names, width, height, self.signed);
            if split {
                let lights = self.lamps.len();
                let black = Plane::filled(width, height, [R::ZERO; 3]);
                layers.splits = vec![black; LayerIndex { lights }.splits()];
            }
            frame.layers = Some(layers);
        }
        let (nodes, leaves) = self.surfaces.hierarchy_size();
        let mut counters = Counters {
            bvh_nodes: nodes as u64,
            bvh_leaves: leaves as u64,
            ..Counters::default()
        };
        for tile in tiles {
            let tile = tile?;
            counters.add(&tile.counters);
            place(&mut frame, &tile);
        }
        debug_assert!(!frame.has_nan(), "no NaN leaves the tracer");
        Ok((frame, counters))
    }

    /// One pixel of [`Self::draw`]: a picture of that pixel alone, the same bytes.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a pixel outside the picture, and as [`Self::draw`].
    pub fn draw_pixel(&self, options: &Options, pixel: [u32; 2]) -> Result<Frame<R>, Error> {
        let [x, y] = self.scene.image.check_pixel(pixel)?;
        let area = Area {
            x,
            y,
            width: 1,
            height: 1,
        };
        let mut tile = tile::draw(self, options, area, false)?;
        let mut frame = Frame::empty(1, 1);
        if options.layers {
            frame.layers = Some(Layers::zero(&self.scene.light_names(), 1, 1, self.signed));
        }
        (tile.area.x, tile.area.y) = (0, 0);
        place(&mut frame, &tile);
        Ok(frame)
    }

    /// What happens on the way to a pixel of [`Self::draw`]: the colours of its samples, and the rays of sample `keep`.
    ///
    /// # Errors
    /// As [`Self::draw_pixel`].
    pub fn record_pixel(
        &self,
        options: &Options,
        pixel: [u32; 2],
        keep: u32,
    ) -> Result<Record<R>, Error> {
        let pixel = self.scene.image.check_pixel(pixel)?;
        let (tile, mut record) = tile::record(self, options, pixel, None, Record::new(keep))?;
        record.color = tile.color[0];
        Ok(record)
    }

    /// What happens to a ray in world space: seen along itself, one sample, near and far left out.
    ///
    /// # Errors
    /// [`Error::Limit`] where it casts too many secondary rays.
    pub fn record_ray(&self, options: &Options, ray: &Ray) -> Result<Record<R>, Error> {
        let (tile, mut record) = tile::record(self, options, [0; 2], Some(*ray), Record::new(0))?;
        record.color = tile.color[0];
        Ok(record)
    }

    /// Where the enabled lights are.
    pub fn lamps(&self) -> &[Lamp] {
        &self.lamps
    }

    /// The lights of the equation, resolved.
    pub fn rig(&self) -> &Rig<R> {
        &self.rig
    }

    /// GL material of a surface number (`lighting::surface`).
    pub fn material(&self, surface: usize) -> &gl::Material {
        let material = &self.scene.materials[surface / 2];
        match &material.back {
            Some(back) if surface % 2 == 1 => back,
            _ => &material.front,
        }
    }
}

fn areas(width: u32, height: u32, side: u32) -> Vec<Area> {
    let starts = |length: u32| (0..length).step_by(side as usize);
    starts(height)
        .flat_map(|y| {
            starts(width).map(move |x| Area {
                x,
                y,
                width: side.min(width - x),
                height: side.min(height - y),
            })
        })
        .collect()
}

/// Copies a tile into the picture.
fn place<R: Real>(frame: &mut Frame<R>, tile: &TileFrame<R>) {
    let area = tile.area;
    let (tile_width, width) = (area.width as usize, frame.color.width);
    for row in 0..area.height as usize {
        let from = row * tile_width..(row + 1) * tile_width;
        let start = (area.y as usize + row) * width + area.x as usize;
        let to = start..start + tile_width;
        frame.color.data[to.clone()].copy_from_slice(&tile.color[from.clone()]);
        frame.depth.data[to.clone()].copy_from_slice(&tile.depth[from.clone()]);
        frame.primitive.data[to.clone()].copy_from_slice(&tile.primitive[from.clone()]);
        frame.object.data[to.clone()].copy_from_slice(&tile.object[from.clone()]);
        if let Some(layers) = &mut frame.layers {
            let planes = layers.planes.iter_mut().zip(&tile.layers);
            let splits = layers.splits.iter_mut().zip(&tile.splits);
            for (plane, layer) in planes.chain(splits) {
                plane.data[to.clone()].copy_from_slice(&layer[from.clone()]);
            }
        }
    }
}
