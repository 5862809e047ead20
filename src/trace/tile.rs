//! One tile of the picture, traced in waves: all rays of a generation, then their shading, then the next generation.
//!
//! A wave's hits are gathered by surface and shaded side by side; shadow rays are asked for one light over many points.
//! Waves hold pixels one after the other and the rays of a pixel in the order in which they were made (parents in order,
//! reflection before refraction), so a pixel's sums run breadth first whatever the size of tile or wave. There is no
//! recursion; a wave that grows too long is cut between pixels and the pieces are finished one by one.

use super::branch::{Branch, Fork, Path};
use super::bvh::Walker;
use super::exact::unit;
use super::faults::Normals;
use super::inside::Inside;
use super::media::{AIR, Media, MediaId};
use super::ray::{NO_ITEM, Ray};
use super::record::Record;
use super::shadow::Shadows;
use super::sums::{Keep, Mean, Sums};
use super::surface::Site;
use super::{Counters, MAX_RAYS, Options, Plan};
use crate::error::Error;
use crate::frame::{LayerIndex, NONE};
use crate::gl;
use crate::lanes::Real;
use crate::lighting::{Batch, Batches, Sink, Visibility, shade, surface};
use crate::math::{DMat3, DVec2, DVec3};
use crate::sampling;
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
    /// Of the wave at hand: a ray's number, and a surface that touches the one it met, in order.
    touching: Vec<(u32, Site<R>)>,
    /// Primary rays of the sample at hand, eye space.
    eye_rays: Vec<(DVec3, DVec3)>,
    /// A ray of the caller's in place of the primary rays, and the solids that it may start in.
    start: Option<(Ray, Inside)>,
    /// Who listens, if anybody does: then the tile is one pixel.
    record: Option<Box<Record<R>>>,
    out: TileFrame<R>,
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
            touching: Vec::new(),
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
        let paths = self.primary_paths(index);
        self.counters.rays.primary += paths.len() as u64;
        let mut waves = vec![(0, paths)];
        while let Some((generation, paths)) = waves.pop() {
            let next = self.wave(generation, index, &paths)?;
            for piece in cut_between_pixels(next).into_iter().rev() {
                waves.push((generation + 1, piece));
            }
        }
        Ok(())
    }

    fn primary_paths(&mut self, index: u32) -> Vec<Path> {
        self.eye_rays.clear();
        if let Some(ray) = self.start.as_ref().map(|(ray, _)| *ray) {
            return vec![Path {
                media: self.first_media(&ray),
                ray,
                weight: [1.0; 3],
                pixel: 0,
                branch: Branch::Primary,
            }];
        }
        let image = &self.plan.scene.image;
        let camera = &self.plan.scene.camera;
        let world_from_eye = self.rotation.transpose();
        let mut paths = Vec::new();
        for pixel in 0..self.area.width * self.area.height {
            let place = self.sample_place(pixel, index);
            let (origin, direction) = camera.primary_ray(place, image.width, image.height);
            let [t_min, t_max] = camera.ray_range(place, image.width, image.height);
            self.eye_rays.push((origin, direction));
            let ray = Ray {
                origin: camera.eye + world_from_eye * origin,
                direction: world_from_eye * direction,
                t_min,
                t_max,
                skip: NO_ITEM,
            };
            paths.push(Path {
                media: self.first_media(&ray),
                ray,
                weight: [1.0; 3],
                pixel,
                branch: Branch::Primary,
            });
        }
        paths
    }

    /// The media that a primary ray starts in: air where nothing is transmitted, so that `cast` lights as the rasterizer does.
    fn first_media(&mut self, ray: &Ray) -> MediaId {
        if !self.options.refraction {
            return AIR;
        }
        let plan = self.plan;
        let (walker, media) = (&mut self.walker, &mut self.media);
        let inside = self
            .start
            .as_ref()
            .map_or(&plan.inside, |(_, inside)| inside);
        inside.media(ray, &plan.surfaces, walker, media)
    }

    /// Where a sample of a pixel of the tile lies in the pixel frame.
    fn sample_place(&self, pixel: u32, index: u32) -> DVec2 {
        let image = &self.plan.scene.image;
        let (x, y) = self.pixel_place(pixel);
        let (sx, sy) =
            sampling::seeded_position(image.pattern, image.samples, [x, y], index, image.seed);
        let step = f64::from(sampling::SUBPIXEL);
        DVec2::new(
            f64::from(x) + f64::from(sx) / step,
            f64::from(y) + f64::from(sy) / step,
        )
    }

    fn pixel_place(&self, pixel: u32) -> (u32, u32) {
        let (column, row) = (pixel % self.area.width, pixel / self.area.width);
        (self.area.x + column, self.area.y + row)
    }

    /// One generation: hits, shading, sums; returns the rays of the next one.
    fn wave(&mut self, generation: u32, index: u32, paths: &[Path]) -> Result<Vec<Path>, Error> {
        self.batches.clear();
        self.touching.clear();
        let mut sites = Vec::with_capacity(paths.len());
        for (i, path) in paths.iter().enumerate() {
            let site = self.meet(i as u32, path, index);
            sites.push(site);
        }
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

    /// Follows one ray to its hit and enters that for shading.
    fn meet(&mut self, tag: u32, path: &Path, index: u32) -> Option<Site<R>> {
        let surfaces = &self.plan.surfaces;
        let faults = &self.plan.faults;
        let hit = faults.closest_hit(surfaces, &path.ray, &mut self.walker)?;
        let primary = path.branch == Branch::Primary;
        let eye_ray = self.eye_rays.get(path.pixel as usize).copied();
        let eye_ray = eye_ray.filter(|_| primary);
        // Without shading and without secondary rays nothing asks for the shading normal.
        let normal = self.plan.needs.has(Feature::Normal) || self.wanted().contains(&true);
        let mut site = surfaces.site_with(&path.ray, &hit, eye_ray, normal);
        self.counters.normalizations += u64::from(normal);
        let bent = (faults.normals != Normals::Right)
            .then(|| faults.bend_normal(surfaces, &hit, &mut site, &self.rotation));
        if primary && index == 0 {
            let pixel = path.pixel as usize;
            self.out.depth[pixel] = -site.position_eye[2];
            self.out.primitive[pixel] = hit.primitive;
            self.out.object[pixel] = site.object;
        }
        let site = self.settle(tag, path, &hit, site);
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
            (true, true) => unit(-DVec3::from_array(site.position_eye.map(Real::to_f64))),
            (true, false) => unit(-arriving),
        };
        self.counters.normalizations += u64::from(looks_back);
        let real = |v: DVec3| v.to_array().map(R::from_f64);
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

    /// Primary hits: their terms are the picture's own; misses show the background.
    fn add_local(&mut self, paths: &[Path], sites: &[Option<Site<R>>]) {
        let background = self
            .plan
            .scene
            .background()
            .map(|x| R::ZERO + R::from_f64(x));
        for (path, _) in paths.iter().zip(sites).filter(|(_, site)| site.is_none()) {
            let pixel = path.pixel as usize;
            self.sums.local[pixel] = background;
            if let Some(emission) = self.sums.terms.get_mut(LayerIndex::EMISSION) {
                emission[pixel] = background;
            }
        }
        let batches = std::mem::take(&mut self.batches);
        for batch in batches.iter() {
            let terms = self.shade(batch, sites, self.sums.recording());
            for (slot, &tag) in batch.tags.iter().enumerate() {
                let pixel = paths[tag as usize].pixel as usize;
                for (k, term) in terms.iter().enumerate() {
                    let value = [term[0][slot], term[1][slot], term[2][slot]];
                    if self.sums.recording() {
                        self.sums.terms[k][pixel] = value;
                    } else {
                        self.sums.local[pixel] = value;
                    }
                }
            }
        }
        self.batches = batches;
    }

    /// Secondary hits and misses: weight x term, in the order of the wave.
    fn add_bounced(&mut self, paths: &[Path], sites: &[Option<Site<R>>]) {
        let batches = std::mem::take(&mut self.batches);
        let mut shaded: Vec<Terms<R>> = Vec::new();
        let mut places = vec![(0u32, 0u32); paths.len()];
        for (number, batch) in batches.iter().enumerate() {
            shaded.push(self.shade(batch, sites, true));
            for (slot, &tag) in batch.tags.iter().enumerate() {
                places[tag as usize] = (number as u32, slot as u32);
            }
        }
        self.batches = batches;
        let background = self.plan.scene.background().map(R::from_f64);
        let index = LayerIndex {
            lights: self.plan.lamps.len(),
        };
        for (i, path) in paths.iter().enumerate() {
            let layer = usize::from(path.branch == Branch::Refraction);
            let pixel = path.pixel as usize;
            if sites[i].is_none() {
                let part = index.split(layer, index.lights);
                self.sums.add(layer, pixel, path.weight, background);
                self.sums.add_split(part, pixel, path.weight, background);
                continue;
            }
            let (number, slot) = (places[i].0 as usize, places[i].1 as usize);
            for (k, term) in shaded[number].iter().enumerate() {
                let value = [term[0][slot], term[1][slot], term[2][slot]];
                let part = index.split(layer, index.light_of(k));
                self.sums.add(layer, pixel, path.weight, value);
                self.sums.add_split(part, pixel, path.weight, value);
            }
        }
    }

    /// Asks the equation for a batch: every term where `record`, else one sum.
    fn shade(&mut self, batch: &Batch<R>, sites: &[Option<Site<R>>], record: bool) -> Terms<R> {
        let plan = self.plan;
        let material = plan.material(batch.surface);
        // Where terms follow the vertex colour, any light that it reflects may be shadowed.
        let white = material
            .tracked
            .any()
            .then(|| material.with_color(gl::CURRENT_COLOR));
        let mut shadows = Shadows {
            surfaces: &plan.surfaces,
            scene: plan.scene,
            lamps: &plan.lamps,
            sources: &plan.sources,
            material: white.as_ref().unwrap_or(material),
            faults: &plan.faults,
            ask_all: plan.needs.is_full(),
            sites,
            tags: &batch.tags,
            walker: &mut self.walker,
            counters: &mut self.counters,
            record: self.record.as_deref_mut(),
        };
        let wanted = self.options.shadows && plan.needs.has(Feature::ShadowRays);
        let visibility = wanted.then_some(&mut shadows as &mut dyn Visibility<R>);
        let (isa, rig) = (self.options.isa, &plan.rig);
        let mut terms = Vec::new();
        let mut sum = [Vec::new(), Vec::new(), Vec::new()];
        let sink = if record {
            Sink::Record(&mut terms)
        } else {
            Sink::Sum(&mut sum)
        };
        let counted = shade(
            isa,
            rig,
            material,
            &batch.points,
            visibility,
            self.signed,
            sink,
        );
        self.counters.lighting += counted;
        if let Some(listener) = &mut self.record {
            listener.shaded(batch, &terms);
        }
        if record { terms } else { vec![sum] }
    }

    /// Which secondary rays are cast: those asked for that the scene has a use for.
    fn wanted(&self) -> [bool; 2] {
        let needs = &self.plan.needs;
        [
            self.options.reflection && needs.has(Feature::ReflectionRays),
            self.options.refraction && needs.has(Feature::RefractionRays),
        ]
    }

    /// Adds the secondary rays of a hit to the next wave.
    fn fork(
        &mut self,
        tag: u32,
        path: &Path,
        site: &Site<R>,
        next: &mut Vec<Path>,
    ) -> Result<(), Error> {
        let optics = &self.plan.scene.materials[site.material as usize].optics;
        if !optics.is_mirror() && !optics.is_transmissive() {
            return Ok(());
        }
        let touching = self.touching_of(tag);
        let fork = Fork {
            path,
            touching: &touching,
            foot: &site.foot,
            skip: site.skip,
            normal_world: self.rotation.transpose() * DVec3::from_array(site.normal_eye),
            object: site.object,
            optics,
            settings: &self.plan.scene.trace,
            wanted: self.wanted(),
            bends: self.plan.needs.has(Feature::Tir),
            faults: &self.plan.faults,
        };
        let forked = fork.branches(&mut self.media);
        if let Some(record) = &mut self.record {
            record.fork(tag, &forked);
        }
        let (reflection, refraction) = (forked.reflection, forked.refraction);
        self.counters.rays.reflection += u64::from(reflection.is_some());
        self.counters.rays.refraction += u64::from(refraction.is_some());
        let before = next.len();
        next.extend([reflection, refraction].into_iter().flatten());
        let rays = &mut self.sums.rays[path.pixel as usize];
        *rays += (next.len() - before) as u32;
        if *rays > MAX_RAYS {
            let (x, y) = self.pixel_place(path.pixel);
            return Err(Error::limit(format!(
                "pixel {x} {y}: more than {MAX_RAYS} secondary rays for one sample"
            ))
            .with_help("lower the depth, or raise trace.weight_cutoff"));
        }
        Ok(())
    }

    /// What a ray meets where surfaces touch (`touch`): the opaque one that the solid it is in stands on, else the one it met;
    /// then those that it passes with it are kept for [`Self::fork`].
    fn settle(&mut self, tag: u32, path: &Path, hit: &super::ray::Hit, site: Site<R>) -> Site<R> {
        let materials = &self.plan.scene.materials;
        let clear = |site: &Site<R>| materials[site.material as usize].optics.is_transmissive();
        if self.options.depth == 0 || !self.wanted()[1] || !clear(&site) {
            return site;
        }
        let surfaces = &self.plan.surfaces;
        let others = surfaces.touching(&path.ray, hit, &site.foot, &mut self.walker);
        let passed = others.iter().take_while(|other| clear(other)).count();
        if passed < others.len() && self.media.hold(path.media, site.object) {
            return others[passed];
        }
        let kept = others[..passed].iter().map(|other| (tag, *other));
        self.touching.extend(kept);
        site
    }

    /// What a ray passes with the surface that it met.
    fn touching_of(&self, tag: u32) -> Vec<super::touch::Touching<'p>> {
        let first = self.touching.partition_point(|(t, _)| *t < tag);
        let of_tag = self.touching[first..].iter().take_while(|(t, _)| *t == tag);
        let plan = self.plan;
        of_tag
            .map(|(_, site)| super::touch::Touching {
                object: site.object,
                optics: &plan.scene.materials[site.material as usize].optics,
                foot: site.foot,
                skip: site.skip,
            })
            .collect()
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
