//! What happened on the way to one pixel: its rays in the order in which the tracer follows them, their hits, what the
//! lighting equation was asked and answered there, shadow rays with what blocks them, and what became of K_T.
//!
//! Out: a [`Record`], for whoever explains a pixel. The tracer's own waves write it down while they run, so it holds the
//! numbers that made the picture. Points and directions in world space unless the name ends in `_eye`; f64, and `R` for what
//! the equation took and gave. A pixel's waves are never cut, so a wave's rays follow each other here.

use serde::Serialize;

use super::branch::{Forked, Path};
use super::media::{AIR, Media};
use super::ray::{Foot, Ray};
use super::surface::Site;
use crate::lanes::Real;
use crate::lighting::{Batch, Points};
use crate::math::DVec3;
use crate::math::color::Rgb;

/// How a ray came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// From the eye.
    Primary,
    /// Mirrored.
    Reflection,
    /// Transmitted.
    Refraction,
}

/// A pixel's rays.
#[derive(Clone, Debug, Default)]
pub struct Record<R> {
    /// Colour of the pixel.
    pub color: [R; 3],
    /// Colour of each sample, and what reflection and refraction add to it.
    pub samples: Vec<([R; 3], [[R; 3]; 2])>,
    /// The rays of the kept sample, generation by generation, parents in order, reflection before refraction.
    pub rays: Vec<Traced<R>>,
    keep: usize,
    /// Where the wave at hand begins in `rays`.
    base: usize,
    /// Parent, kind and own weight of each ray of the next wave.
    next: Vec<(usize, Kind, Rgb)>,
}

/// One ray.
#[derive(Clone, Debug)]
pub struct Traced<R> {
    /// How it came about.
    pub kind: Kind,
    /// Number of the ray whose hit it leaves.
    pub parent: Option<usize>,
    /// As it was traced.
    pub ray: Ray,
    /// Weight at that hit alone.
    pub share: Rgb,
    /// Product of the weights from the eye on.
    pub weight: Rgb,
    /// It runs inside a medium.
    pub inside: bool,
    /// Index of refraction of what it runs through.
    pub ior: f64,
    /// What it meets.
    pub meeting: Option<Meeting<R>>,
}

/// A hit and its shading.
#[derive(Clone, Debug)]
pub struct Meeting<R> {
    /// Parameter of the ray.
    pub t: f64,
    /// The point and its geometric normal.
    pub foot: Foot,
    /// Unit shading normal of the front side, eye space; zero where there is none.
    pub normal_eye: DVec3,
    /// Index into the scene's objects.
    pub object: u32,
    /// Index into the scene's materials.
    pub material: u32,
    /// Seen from the back.
    pub back: bool,
    /// Number of the surface that was shaded (`lighting::surface`).
    pub surface: usize,
    /// The point as the equation took it, eye space: the only one of the list.
    pub point: Points<R>,
    /// The terms: emission, scene ambient, then for each light ambient, diffuse, specular.
    pub terms: Vec<[R; 3]>,
    /// Shadow rays with the number of their light.
    pub shadows: Vec<(usize, ShadowRecord)>,
    /// Secondary rays were considered here; else the depth was reached, or nothing asks for any.
    pub fork: Option<ForkRecord>,
}

/// A shadow ray's answer.
#[derive(Clone, Debug)]
pub struct ShadowRecord {
    /// From the hit to the light: to t = 1, or without end for a directional light.
    pub ray: Ray,
    /// S_L.
    pub lit: [f64; 3],
    /// Objects that take light from it and their t, nearest first; none where nothing is in the way.
    pub crossed: Vec<(u32, f64)>,
}

/// What a hit makes of the light that arrives by other surfaces.
#[derive(Clone, Debug)]
pub struct ForkRecord {
    /// Weight of the mirror ray; 0 where nothing mirrors.
    pub mirror: Rgb,
    /// The mirror ray.
    pub reflection: Option<usize>,
    /// What became of K_T; `None` where nothing transmits.
    pub passage: Option<PassageRecord>,
}

/// What becomes of K_T at a surface.
#[derive(Clone, Debug)]
pub struct PassageRecord {
    /// Weight of the transmitted ray, K_T less what Fresnel's share takes.
    pub weight: Rgb,
    /// Index of refraction before and behind the surface.
    pub eta: [f64; 2],
    /// The part of K_T that the mirror ray takes.
    pub reflected: f64,
    /// Where the transmitted ray goes, unit; `None` at total internal reflection.
    pub direction: Option<DVec3>,
    /// The transmitted ray, where one was cast.
    pub refraction: Option<usize>,
}

impl<R: Real> Record<R> {
    /// Listens to every sample, and keeps the rays of one.
    pub(super) fn new(keep: u32) -> Self {
        Self {
            keep: keep as usize,
            ..Self::default()
        }
    }

    /// The same record in f64, exact.
    pub fn to_f64(&self) -> Record<f64> {
        let wide = |c: &[R; 3]| c.map(Real::to_f64);
        let samples = self.samples.iter();
        let samples = samples
            .map(|(color, [mirrored, passed])| (wide(color), [wide(mirrored), wide(passed)]));
        Record {
            color: wide(&self.color),
            samples: samples.collect(),
            rays: self.rays.iter().map(Traced::to_f64).collect(),
            keep: self.keep,
            base: self.base,
            next: self.next.clone(),
        }
    }

    /// The kept sample.
    pub fn kept(&self) -> Option<&([R; 3], [[R; 3]; 2])> {
        self.samples.get(self.keep)
    }

    fn keeps(&self) -> bool {
        self.samples.len() == self.keep
    }

    /// A generation of rays and where they hit.
    pub(super) fn wave(&mut self, paths: &[Path], sites: &[Option<Site<R>>], media: &Media) {
        if !self.keeps() {
            return;
        }
        self.base = self.rays.len();
        let mut origins = std::mem::take(&mut self.next).into_iter();
        for (path, site) in paths.iter().zip(sites) {
            let (parent, kind, share) = origins
                .next()
                .map_or((None, Kind::Primary, [1.0; 3]), |(p, k, s)| (Some(p), k, s));
            self.rays.push(Traced {
                kind,
                parent,
                ray: path.ray,
                share,
                weight: path.weight,
                inside: path.media != AIR,
                ior: media.ior(path.media),
                meeting: site.as_ref().map(Meeting::at),
            });
        }
    }

    /// The hit of a ray of the wave.
    fn meeting(&mut self, tag: u32) -> Option<&mut Meeting<R>> {
        let ray = self.rays.get_mut(self.base + tag as usize)?;
        ray.meeting.as_mut()
    }

    /// A light's shadow ray.
    pub(super) fn shadow(&mut self, tag: u32, light: usize, shadow: ShadowRecord) {
        if self.keeps()
            && let Some(meeting) = self.meeting(tag)
        {
            meeting.shadows.push((light, shadow));
        }
    }

    /// What the equation was asked, and answered.
    pub(super) fn shaded(&mut self, batch: &Batch<R>, terms: &[[Vec<R>; 3]]) {
        if !self.keeps() {
            return;
        }
        for (slot, &tag) in batch.tags.iter().enumerate() {
            if let Some(meeting) = self.meeting(tag) {
                meeting.surface = batch.surface;
                meeting.point = batch.points.one(slot);
                meeting.terms = terms
                    .iter()
                    .map(|t| [0, 1, 2].map(|c| t[c][slot]))
                    .collect();
            }
        }
    }

    /// The secondary rays of a hit.
    pub(super) fn fork(&mut self, tag: u32, forked: &Forked) {
        if !self.keeps() {
            return;
        }
        let parent = self.base + tag as usize;
        let first = self.rays.len();
        let next = &mut self.next;
        let mut child = |exists: bool, kind, share| {
            exists.then(|| {
                next.push((parent, kind, share));
                first + next.len() - 1
            })
        };
        let exists = forked.reflection.is_some();
        let reflection = child(exists, Kind::Reflection, forked.mirror);
        let passage = forked.passage.as_ref().map(|passage| {
            let part = passage.beyond.as_ref().map(|(_, part, _)| *part);
            let weight = forked
                .transmission
                .map(|k| k * part.unwrap_or(1.0 - passage.reflected));
            let exists = forked.refraction.is_some();
            PassageRecord {
                weight,
                eta: passage.eta,
                reflected: passage.reflected,
                direction: passage.beyond.as_ref().map(|(direction, ..)| *direction),
                refraction: child(exists, Kind::Refraction, weight),
            }
        });
        let mirror = forked.mirror;
        if let Some(meeting) = self.meeting(tag) {
            meeting.fork = Some(ForkRecord {
                mirror,
                reflection,
                passage,
            });
        }
    }

    /// What a sample came to.
    pub(super) fn end_sample(&mut self, sample: ([R; 3], [[R; 3]; 2])) {
        self.samples.push(sample);
    }
}

impl<R: Real> Traced<R> {
    fn to_f64(&self) -> Traced<f64> {
        Traced {
            kind: self.kind,
            parent: self.parent,
            ray: self.ray,
            share: self.share,
            weight: self.weight,
            inside: self.inside,
            ior: self.ior,
            meeting: self.meeting.as_ref().map(Meeting::to_f64),
        }
    }
}

impl<R: Real> Meeting<R> {
    fn to_f64(&self) -> Meeting<f64> {
        let terms = self.terms.iter().map(|c| c.map(Real::to_f64));
        Meeting {
            t: self.t,
            foot: self.foot,
            normal_eye: self.normal_eye,
            object: self.object,
            material: self.material,
            back: self.back,
            surface: self.surface,
            point: self.point.convert(),
            terms: terms.collect(),
            shadows: self.shadows.clone(),
            fork: self.fork.clone(),
        }
    }

    /// A hit that is not shaded yet.
    fn at(site: &Site<R>) -> Self {
        Self {
            t: site.t,
            foot: site.foot,
            normal_eye: DVec3::from_array(site.normal_eye),
            object: site.object,
            material: site.material,
            back: site.back,
            surface: 0,
            point: Points::default(),
            terms: Vec::new(),
            shadows: Vec::new(),
            fork: None,
        }
    }
}
