//! The rasterizer: triangles to a picture, as OpenGL's fixed function draws them.
//!
//! In: a [`Scene`] and its [`Assembly`] (eye-space vertices). Out: a [`Frame`] of unclamped or GL-clamped linear colours,
//! depth, primitive and object numbers, layers if asked for; and [`Counters`]. Pixel frame: y down, (0, 0) top-left.
//!
//! Stages: project and snap vertices (`view`); set up, clip, cull and bin triangles (`setup`, `clip`); then tile by tile,
//! in parallel, for each sample: visibility from integer edge functions or exact sides (`edges`, `sides`, `tile`), weights
//! at the unsnapped place (`attribute`), lighting of what is seen (`shade`). [`Plan::new`] does the first two, which no
//! option changes; [`Plan::draw`] the rest. GL 2.1 sections 2.11, 2.12, 2.14, 3.5, 3.9, 4.1.6.
//!
//! Every sample is resolved visibility-first and shaded once: all surfaces are opaque, unless the scene asks for GL's
//! blending of transmissive ones (`blend`), which are then shaded and blended over the opaque picture; depth, primitive and
//! object numbers stay those of the opaque surfaces. Depth ties go to the lowest primitive number. Bytes do not depend on
//! the number of threads: tiles do not meet, and sums over samples are in order.
//!
//! Measured (2026-11): all coverage, near-plane and depth cases of the numerics guide at 8 bits, 12 bits and without a snap
//! grid with 0 wrong pixels; interpolation within 4.3e-16 of the largest attribute, 1.8e-15 of w. 22 pictures of Mesa's
//! llvmpipe: every pixel shows the same triangle and the same number of covering ones; softpipe: at most 1 pixel differs in
//! coverage away from slivers and ties; colours within 1.1e-5 (slivers 2.9e-4), depth within 2.3e-6. 871,414 flat triangles at
//! 1920x1080 in f32: at most 0.41 GB in the whole process, scene and assembly included.
//!
//! Vertex colours (GL 2.1 section 2.14.3): flat takes the provoking vertex's, Gouraud lights each vertex with its own; per
//! fragment the colour is interpolated perspective-correctly like the normal, and stands in for the tracked terms there, which
//! GL has no mode for.
//!
//! Left out: points, lines, user clip planes, polygon offset, fog, textures; blending but for transmissive surfaces.

mod attribute;
mod bin;
mod blend;
mod clip;
mod coverage;
mod draw;
mod edges;
mod faults;
mod jumps;
mod lit;
mod outline;
pub mod record;
mod setup;
mod shade;
mod sides;
mod slots;
mod tile;
mod view;
mod window;

pub use coverage::{Run, coverage, coverage_clip_space, depth_key, perspective_weights};
pub use faults::Faults;

use std::sync::Arc;

use rayon::prelude::*;
use serde::Serialize;

use crate::error::Error;
use crate::frame::{Frame, LayerIndex, Layers, NONE};
use crate::gl;
use crate::lanes::{Isa, Real};
use crate::lighting::{self, Rig, Rounded};
use crate::sampling::{self, Pattern};
use crate::scene::Scene;
use crate::scene::assembly::Assembly;
use crate::scene::requirements::{self, Feature, Model, Requirements};
use bin::{Chunk, SampleBox, TileGrid};
use draw::Drawer;
use lit::Mode;
use record::Record;
use setup::{Builder, DepthOrder};
use tile::Planes;
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
    /// Drawn, and cut by near or far.
    pub triangles_clipped: u64,
    /// Handed to at least one tile.
    pub triangles_drawn: u64,
    /// Samples in the boxes around triangles.
    pub fragments_tested: u64,
    /// Samples inside triangles.
    pub fragments_covered: u64,
    /// Samples that were nearest so far, or blended.
    pub fragments_passed: u64,
    /// Evaluations of the equation, vertices included.
    pub points_shaded: u64,
    /// Unit vectors made for them: interpolated normals, and directions to a local viewer.
    pub normalizations: u64,
    /// What the equation did.
    pub lighting: lighting::Counters,
}

impl Counters {
    /// Both together.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut lighting = self.lighting;
        lighting += other.lighting;
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
            normalizations: self.normalizations + other.normalizations,
            lighting,
        }
    }
}

/// A scene ready to be drawn: everything that the options do not change.
pub struct Plan<'a, R> {
    scene: &'a Scene,
    assembly: &'a Assembly<R>,
    rig: Rig<R>,
    rounded: Rounded,
    /// Back faces are lit apart: asked for by the light model, and seen in some product.
    two_sided: bool,
    /// Some term looks at normals.
    normals: bool,
    /// Some highlight looks at the direction to a local viewer.
    viewers: bool,
    view: View,
    grid: TileGrid,
    chunks: Arc<Vec<Chunk>>,
    /// Which triangles lie in one plane.
    planes: Planes,
    /// For each material the alpha that it is blended with, `None` where it is opaque; empty where nothing is blended.
    alphas: Vec<Option<f64>>,
    model: Model,
    faults: Faults,
}

impl<'a, R: Real> Plan<'a, R> {
    /// Projects, clips, culls and bins the triangles of an assembly of this scene.
    pub fn new(scene: &'a Scene, assembly: &'a Assembly<R>, model: Model) -> Self {
        let needs = Requirements::plan(scene, requirements::Mode::Raster, model);
        Self::with_requirements(scene, assembly, &needs)
    }

    /// [`Plan::new`] with requirements of the caller's: what they lack is not evaluated.
    pub fn with_requirements(
        scene: &'a Scene,
        assembly: &'a Assembly<R>,
        needs: &Requirements,
    ) -> Self {
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
        let mut plan = Self::over(scene, assembly, view, grid, Arc::default(), needs);
        if drawable {
            plan.chunks = Arc::new(plan.set_up());
        }
        plan
    }

    /// A plan over triangles that are set up.
    fn over(
        scene: &'a Scene,
        assembly: &'a Assembly<R>,
        view: View,
        grid: TileGrid,
        chunks: Arc<Vec<Chunk>>,
        needs: &Requirements,
    ) -> Self {
        let light_model = &scene.light_model;
        Self {
            scene,
            assembly,
            rig: Rig::planned(&scene.lights_eye(), light_model, needs),
            rounded: Rounded::default(),
            two_sided: light_model.two_sided && needs.has(Feature::TwoSide),
            normals: needs.has(Feature::Normal),
            viewers: light_model.local_viewer && needs.has(Feature::ViewVector),
            view,
            grid,
            chunks,
            planes: planes(scene, assembly),
            alphas: blend::alphas(scene),
            model: needs.model(),
            faults: Faults::default(),
        }
    }

    /// The same triangles, set up as they are, under a scene that differs in lights, materials or light model alone, and an
    /// assembly that differs in normals or the order of corners alone.
    pub fn relit<'b>(&self, scene: &'b Scene, assembly: &'b Assembly<R>) -> Plan<'b, R> {
        let (view, chunks) = (self.view.clone(), Arc::clone(&self.chunks));
        let needs = Requirements::plan(scene, requirements::Mode::Raster, self.model);
        Plan::over(scene, assembly, view, self.grid, chunks, &needs)
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

    /// Draws the picture.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a picture without pixels or samples, [`Error::Limit`] for one that is too large.
    pub fn draw(&self, options: &Options) -> Result<(Frame<R>, Counters), Error> {
        check_image(self.scene)?;
        let mut frame = Frame::empty(self.grid.size[0], self.grid.size[1]);
        let counters = self.draw_into(options, &mut frame)?;
        Ok((frame, counters))
    }

    /// Draws the picture into a frame of an earlier draw, whose memory it reuses; a frame of another size is replaced.
    ///
    /// # Errors
    /// As [`Plan::draw`].
    pub fn draw_into(&self, options: &Options, frame: &mut Frame<R>) -> Result<Counters, Error> {
        check_image(self.scene)?;
        if options.layers {
            let lights = self.rig.light_count();
            let image = &self.scene.image;
            LayerIndex { lights }.check_size(image.width, image.height)?;
        }
        let [width, height] = self.grid.size;
        let mode = Mode::new(self, options);
        if (frame.color.width, frame.color.height) != (width, height) {
            *frame = Frame::empty(width, height);
        }
        frame.layers = self.layers(options, &mode, [width, height]);
        let drawn = Drawer::new(self, &mode, options).bands(frame);
        debug_assert!(!frame.has_nan(), "no NaN leaves the rasterizer");
        let counters = self.chunks.iter().map(|chunk| &chunk.counters);
        Ok(counters.fold(drawn, |sum, c| sum.plus(c)))
    }

    /// One pixel of [`Plan::draw`]: a picture of that pixel alone, the same bytes.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a pixel outside the picture, and as [`Plan::draw`].
    pub fn draw_pixel(&self, options: &Options, pixel: [u32; 2]) -> Result<Frame<R>, Error> {
        Ok(self.pixel(options, pixel, None)?.0)
    }

    /// What happens on the way to a pixel of [`Plan::draw`]: the colours of its samples, and what sample `keep` shows.
    ///
    /// # Errors
    /// As [`Plan::draw_pixel`].
    pub fn record_pixel(
        &self,
        options: &Options,
        pixel: [u32; 2],
        keep: u32,
    ) -> Result<Record<R>, Error> {
        // Single terms are kept only for layers.
        let options = Options {
            layers: true,
            ..*options
        };
        let record = Some(Box::new(Record::new(keep)));
        let (frame, record) = self.pixel(&options, pixel, record)?;
        let mut record = record.map(|record| *record).unwrap_or_default();
        record.color = frame.color.data[0];
        Ok(record)
    }

    fn pixel(
        &self,
        options: &Options,
        pixel: [u32; 2],
        record: Option<Box<Record<R>>>,
    ) -> Result<Pixel<R>, Error> {
        check_image(self.scene)?;
        let pixel = self.scene.image.check_pixel(pixel)?;
        let mode = Mode::new(self, options);
        let mut frame = Frame::empty(1, 1);
        frame.layers = self.layers(options, &mode, [1, 1]);
        let record = Drawer::new(self, &mode, options).pixel(pixel, &mut frame, record);
        Ok((frame, record))
    }

    /// Layers of +0, where they are asked for.
    fn layers(
        &self,
        options: &Options,
        mode: &Mode,
        [width, height]: [usize; 2],
    ) -> Option<Layers<R>> {
        options.layers.then(|| {
            let names = self.scene.light_names();
            Layers::zero(&names, width, height, mode.signed)
        })
    }

    /// How many triangles the scene has.
    pub fn triangles(&self) -> usize {
        self.assembly.triangles.len()
    }

    /// The lights of the equation, resolved.
    pub fn rig(&self) -> &Rig<R> {
        &self.rig
    }

    /// The corners of a primitive.
    fn corners(&self, primitive: u32) -> [Vertex; 3] {
        // Written out: closures given to array::map are not inlined here.
        let corner = |v: u32| {
            let [x, y, z] = self.assembly.vertex_eye(v);
            self.view.vertex([x.to_f64(), y.to_f64(), z.to_f64()])
        };
        let [a, b, c] = self.assembly.triangles[primitive as usize];
        [corner(a), corner(b), corner(c)]
    }

    /// The material of a surface number.
    pub fn material(&self, surface: usize) -> &gl::Material {
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
                let raster = &self.scene.raster;
                let state = (raster.cull, DepthOrder::of(raster));
                let mut builder = Builder::new(&self.view, self.grid, samples, state);
                for (i, corners) in part.iter().enumerate() {
                    let primitive = (index * length + i) as u32;
                    let places = corners.map(|v| snapped[v as usize]);
                    if places.contains(&BY_SIDES) {
                        builder.general(primitive, self.corners(primitive));
                    } else {
                        builder.inside(primitive, places, || self.corners(primitive));
                    }
                }
                builder.finish()
            })
            .collect()
    }

    /// Snapped pixel coordinates of the vertices, or [`BY_SIDES`].
    fn snap_vertices(&self) -> Vec<[i32; 2]> {
        let [x, y, z] = &self.assembly.position_eye;
        (x, y, z)
            .into_par_iter()
            .map(|(x, y, z)| {
                let v = self.view.vertex([x, y, z].map(|x| x.to_f64()));
                match self.view.snap(&v).and_then(edges::small) {
                    Some(place) if self.view.holds(&v) => place,
                    _ => BY_SIDES,
                }
            })
            .collect()
    }

    /// The place of a sample in its pixel, in 1/256 px.
    fn sample_offset(&self, x: u32, y: u32, sample: u32) -> [i64; 2] {
        let image = &self.scene.image;
        let (sx, sy) =
            sampling::seeded_position(image.pattern, image.samples, [x, y], sample, image.seed);
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

    /// X and Y of the ray through a place of the pixel frame.
    fn ray(&self, x: f64, y: f64) -> [f64; 2] {
        self.view.ray([x, y])
    }
}

/// A picture of one pixel, and what was written down about it.
type Pixel<R> = (Frame<R>, Option<Box<Record<R>>>);

/// A vertex beyond near, far or 2^29 units, or without a snap grid: its triangles take the long way.
const BY_SIDES: [i32; 2] = [i32::MIN; 2];

/// Which triangles lie in one plane: only where depth decides what is seen.
fn planes<R>(scene: &Scene, assembly: &Assembly<R>) -> Planes {
    let order = DepthOrder::of(&scene.raster);
    if !matches!(order, DepthOrder::Nearest | DepthOrder::Farthest) {
        return Planes::default();
    }
    let mut planes = Vec::new();
    for (key, set) in &assembly.contacts.faces {
        let Some(range) = assembly.triangle_range.get(key.object as usize) else {
            continue;
        };
        let primitive = (range.start + key.part) as usize;
        if planes.len() <= primitive {
            planes.resize(primitive + 1, NONE);
        }
        planes[primitive] = *set;
    }
    planes.into()
}

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
