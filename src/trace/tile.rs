//! One tile of the picture, traced in waves: all rays of a generation, then their shading, then the next generation.
//!
//! A wave's hits are gathered by surface and shaded side by side; shadow rays are asked for one light over many points.
//! Waves hold pixels one after the other and the rays of a pixel in the order in which they were made (parents in order,
//! reflection before refraction), so a pixel's sums run breadth first whatever the size of tile or wave. There is no
//! recursion; a wave that grows too long is cut between pixels and the pieces are finished one by one.

mod meet;
mod primary;
mod secondary;
mod shading;

use super::branch::{Branch, Path};
use super::bvh::Walker;
use super::exact::unit;
use super::faults::Normals;
use super::inside::Inside;
use super::media::{AIR, Media};
use super::ray::{Hit, Ray};
use super::record::Record;
use super::sums::{Keep, Mean, Sums};
use super::surface::Site;
use super::{Counters, Options, Plan};
use crate::error::Error;
use crate::frame::{LayerIndex, NONE};
use crate::lanes::Real;
use crate::lighting::{Batches, surface};
use crate::math::Each;
use crate::math::{DMat3, DVec3};
use crate::scene::requirements::Feature;

/// A wave longer than this is cut between pixels.
const WAVE: usize = 1 << 14;

/// A rectangle of the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Area {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) width: u32,
    pub(super) height: u32,
}

/// What a tile shows: one value a pixel, row by row.
#[derive(Debug)]
pub(super) struct TileFrame<R> {
    pub(super) area: Area,
    pub(super) color: Vec<[R; 3]>,
    pub(super) depth: Vec<R>,
    pub(super) primitive: Vec<u32>,
    pub(super) object: Vec<u32>,
    /// One list a layer, if they were asked for.
    pub(super) layers: Vec<Vec<[R; 3]>>,
    /// Reflection and refraction by light, if they were asked for.
    pub(super) splits: Vec<Vec<[R; 3]>>,
    pub(super) counters: Counters,
}

/// A terms list of one batch: [`Sink::Record`]'s, or one sum.
type Terms<R> = Vec<[Vec<R>; 3]>;

/// The tracer at work on one tile.
pub(super) struct Tile<'p, 'a, R> {
    plan: &'p Plan<'a, R>,
    options: &'p Options,
    area: Area,
    rotation: DMat3,
    signed: bool,
    walker: Walker,
    media: Media,
    batches: Batches<R>,
    counters: Counters,
    sums: Sums<R>,
    /// Of the wave at hand: what rays pass with what they met, in order.
    passed: Vec<Passed>,
    /// Of the sample at hand: opaque hits that end rays behind what touches them, and how much their error bounds grow.
    ends: Vec<(Hit, f64)>,
    /// Primary rays of the sample at hand, eye space.
    eye_rays: Vec<(DVec3, DVec3)>,
    /// A ray of the caller's in place of the primary rays, and the solids that it may start in.
    start: Option<(Ray, Inside)>,
    /// Who listens, if anybody does: then the tile is one pixel.
    record: Option<Box<Record<R>>>,
    out: TileFrame<R>,
}

/// What a ray passes at the place of the hit that is seen.
#[derive(Clone, Copy, Debug)]
enum Passed {
    /// A clear surface; one inside a solid of a higher priority takes no light.
    Clear {
        tag: u32,
        object: u32,
        material: u32,
        unseen: bool,
    },
    /// An opaque one, by its number in `ends`: the ray ends there.
    Opaque { tag: u32, end: u32 },
}

impl Passed {
    fn tag(&self) -> u32 {
        match self {
            Self::Clear { tag, .. } | Self::Opaque { tag, .. } => *tag,
        }
    }
}

/// Traces one tile.
pub(super) fn draw<R: Real>(
    plan: &Plan<'_, R>,
    options: &Options,
    area: Area,
    split: bool,
) -> Result<TileFrame<R>, Error> {
    let keep = match (options.layers, split) {
        (false, _) => Keep::Color,
        (true, false) => Keep::Layers,
        (true, true) => Keep::Split,
    };
    let mut tile = Tile::new(plan, options, area, keep);
    tile.draw()?;
    Ok(tile.out)
}

/// Traces one pixel, or the one sample of a ray of the caller's, and writes down what happens.
pub(super) fn record<R: Real>(
    plan: &Plan<'_, R>,
    options: &Options,
    [x, y]: [u32; 2],
    start: Option<Ray>,
    record: Record<R>,
) -> Result<(TileFrame<R>, Record<R>), Error> {
    // Single terms are kept only for layers.
    let options = Options {
        layers: true,
        ..*options
    };
    let area = Area {
        x,
        y,
        width: 1,
        height: 1,
    };
    let mut tile = Tile::new(plan, &options, area, Keep::Layers);
    tile.start = start.map(|ray| (ray, Inside::around(plan.scene, &ray)));
    tile.record = Some(Box::new(record));
    tile.draw()?;
    let record = tile.record.map(|record| *record).unwrap_or_default();
    Ok((tile.out, record))
}

impl<'p, 'a, R: Real> Tile<'p, 'a, R> {
    fn new(plan: &'p Plan<'a, R>, options: &'p Options, area: Area, keep: Keep) -> Self {
        let pixels = (area.width * area.height) as usize;
        let index = LayerIndex {
            lights: plan.lamps.len(),
        };
        let signed = plan.signed;
        let layers = if keep == Keep::Color {
            0
        } else {
            index.count()
        };
        let splits = if keep == Keep::Split {
            index.splits()
        } else {
            0
        };
        let black = || vec![[R::ZERO; 3]; pixels];
        Self {
            plan,
            options,
            area,
            rotation: plan.scene.camera.eye_from_world_rotation(),
            signed,
            walker: Walker::default(),
            media: Media::new(),
            batches: Batches::new(plan.scene.materials.len()).rounding(plan.rounded),
            counters: Counters::default(),
            sums: Sums::new(pixels, index, keep, signed),
            passed: Vec::new(),
            ends: Vec::new(),
            eye_rays: Vec::new(),
            start: None,
            record: None,
            out: TileFrame {
                area,
                color: black(),
                depth: vec![R::INFINITY; pixels],
                primitive: vec![NONE; pixels],
                object: vec![NONE; pixels],
                layers: (0..layers).map(|_| black()).collect(),
                splits: (0..splits).map(|_| black()).collect(),
                counters: Counters::default(),
            },
        }
    }

    /// Traces every sample of every pixel into `out`.
    fn draw(&mut self) -> Result<(), Error> {
        let samples = match &self.start {
            Some(_) => 1,
            None => self.plan.scene.image.samples.max(1),
        };
        let mut mean = Mean::new(&self.out, samples);
        for index in 0..samples {
            self.sample(index)?;
            mean.add(&self.sums, &mut self.out);
            if let Some(record) = &mut self.record {
                record.end_sample(self.sums.color(0));
            }
        }
        mean.finish(&mut self.out, self.signed);
        self.counters.add_work(&self.walker.work);
        self.out.counters = self.counters;
        Ok(())
    }

    /// Traces one sample of every pixel into `sums`.
    fn sample(&mut self, index: u32) -> Result<(), Error> {
        self.sums.clear();
        self.ends.clear();
        let paths = self.primary_paths(index);
        self.counters.rays.primary += paths.len() as u64;
        let mut waves = vec![(0, paths)];
        while let Some((generation, paths)) = waves.pop() {
            let next = self.wave(generation, index, paths)?;
            for piece in cut_between_pixels(next).into_iter().rev() {
                waves.push((generation + 1, piece));
            }
        }
        Ok(())
    }

    /// One generation: hits, shading, sums; returns the rays of the next one.
    fn wave(
        &mut self,
        generation: u32,
        index: u32,
        mut paths: Vec<Path>,
    ) -> Result<Vec<Path>, Error> {
        self.batches.clear();
        self.passed.clear();
        let mut sites = Vec::with_capacity(paths.len());
        for (i, path) in paths.iter_mut().enumerate() {
            let site = self.meet(i as u32, path, index);
            sites.push(site);
        }
        let paths = &paths[..];
        if let Some(record) = &mut self.record {
            record.wave(paths, &sites, &self.media);
        }
        if generation == 0 {
            self.add_local(paths, &sites);
        } else {
            self.add_bounced(paths, &sites);
        }
        let secondary = self.wanted().contains(&true);
        if generation >= self.options.depth || !secondary {
            return Ok(Vec::new());
        }
        let mut next = Vec::new();
        for (i, (path, site)) in paths.iter().zip(&sites).enumerate() {
            if let Some(site) = site {
                self.fork(i as u32, path, site, &mut next)?;
            }
        }
        Ok(next)
    }

    /// Follows one ray to its hit and enters that for shading. On the way the ray may enter solids whose surfaces are not there.
    fn meet(&mut self, tag: u32, path: &mut Path, index: u32) -> Option<Site<R>> {
        let (hit, mut site) = self.find(tag, path)?;
        self.counters.normalizations += u64::from(self.wants_normals());
        let surfaces = &self.plan.surfaces;
        let faults = &self.plan.faults;
        let primary = path.branch == Branch::Primary;
        let bent = (faults.normals != Normals::Right)
            .then(|| faults.bend_normal(surfaces, &hit, &mut site, &self.rotation));
        if primary && index == 0 {
            let pixel = path.pixel as usize;
            self.out.depth[pixel] = -site.position_eye[2];
            self.out.primitive[pixel] = hit.primitive;
            self.out.object[pixel] = site.object;
        }
        let surface = self.enter(tag, path, &site);
        if let Some(length) = bent {
            let points = &mut self.batches.batch(surface).points;
            points.normal_length.push(R::from_f64(length));
        }
        Some(site)
    }

    /// Enters a hit for shading: which side faces the ray, and where the viewer is. Returns the number of the surface.
    fn enter(&mut self, tag: u32, path: &Path, site: &Site<R>) -> usize {
        let (model, needs) = (&self.plan.scene.light_model, &self.plan.needs);
        let arriving = self.rotation * path.ray.direction;
        // Facing: the rule of the light model in air, towards the ray inside a medium.
        let front = DVec3::from_array(site.normal_eye);
        let back = model.two_sided && needs.has(Feature::TwoSide) && site.back;
        let flip = if path.media == AIR {
            back
        } else {
            arriving.dot(front) > 0.0 && !self.plan.faults.normal_kept_inside
        };
        let normal = match (needs.has(Feature::Normal), flip) {
            (false, _) => DVec3::ZERO,
            (true, true) => -front,
            (true, false) => front,
        };
        // A viewer at infinity is GL's for the picture; a secondary ray is looked back along, where a highlight asks.
        // A ray of one's own (`start`) has no picture: it is looked back along as well.
        let primary = path.branch == Branch::Primary && self.start.is_none();
        let looks_back = if primary {
            model.local_viewer && needs.has(Feature::ViewVector)
        } else {
            needs.has(Feature::HalfVector)
        };
        let viewer = match (looks_back, primary) {
            (false, _) => DVec3::Z,
            (true, true) => unit(-DVec3::from_array(site.position_eye.each(Real::to_f64))),
            (true, false) => unit(-arriving),
        };
        self.counters.normalizations += u64::from(looks_back);
        let real = |v: DVec3| v.to_array().each(R::from_f64);
        let surface = surface(site.material as usize, back);
        let (normal, viewer) = (real(normal), real(viewer));
        self.batches
            .push(surface, tag, site.position_eye, normal, viewer);
        if let Some(color) = site.color
            && self.plan.material(surface).tracked.any()
        {
            self.batches.batch(surface).points.push_color(color);
        }
        self.counters.shaded_points += 1;
        surface
    }
}

/// Cuts a wave into pieces of at most about [`WAVE`] rays, never inside a pixel.
fn cut_between_pixels(mut paths: Vec<Path>) -> Vec<Vec<Path>> {
    let mut pieces = Vec::new();
    while paths.len() > WAVE {
        let pixel = paths[WAVE].pixel;
        let start = paths.partition_point(|p| p.pixel < pixel);
        let end = paths.partition_point(|p| p.pixel <= pixel);
        let cut = if start > 0 { start } else { end };
        let rest = paths.split_off(cut);
        pieces.push(std::mem::replace(&mut paths, rest));
    }
    if !paths.is_empty() {
        pieces.push(paths);
    }
    pieces
}
