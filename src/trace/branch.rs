//! Secondary rays of a hit: which ones, where to, with which weight (whitted.md 2 and 4; DESIGN 1 "Tracing").
//!
//! Reflection comes before refraction. Mirror weight is the material's; `fresnel` moves K_T F to it, and total internal
//! reflection all of K_T with `tir = "reflect"` or a Fresnel model (where F = 1), else nothing (I_T = 0). `thin` surfaces
//! pass straight on, enter no medium and have no index, hence no Fresnel share. Weights multiply once per interface. A branch
//! of weight 0, or below `weight_cutoff` in every channel, is dropped.
//!
//! Directions follow the shading normal. Where it would send a mirrored ray into the surface, or a transmitted one back
//! out of it (smooth meshes seen at grazing angles), the geometric normal takes its place.

use super::exact::unit;
use super::faults::Faults;
use super::media::{Media, MediaId, Order};
use super::optics::{Transmission, fresnel, reflect, refract};
use super::ray::{Foot, Ray};
use super::touch::Touching;
use crate::math::DVec3;
use crate::math::Each;
use crate::math::color::Rgb;
use crate::scene::{Fresnel, Optics, Tir, TraceSettings};

/// How a path left the eye: local light, or the layer of its first bounce.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Branch {
    /// A primary ray.
    Primary,
    /// First bounce was a mirror.
    Reflection,
    /// First bounce was a transmission.
    Refraction,
}

/// A ray on its way, with everything that its hit will need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    pub(super) ray: Ray,
    /// Product of the weights so far.
    pub(super) weight: Rgb,
    /// Pixel of the tile.
    pub(super) pixel: u32,
    /// Layer that it adds to.
    pub(super) branch: Branch,
    /// What it is inside of.
    pub(super) media: MediaId,
    /// Number of the hit that ends it, where it passed surfaces that touch an opaque one; [`NO_END`] = what it meets.
    pub(super) end: u32,
}

/// No hit is set.
pub(super) const NO_END: u32 = u32::MAX;

/// A hit that secondary rays start from.
pub(super) struct Fork<'s> {
    /// The ray that arrived.
    pub(super) path: &'s Path,
    /// Transmissive surfaces that touch the one hit, and that the ray passes with it.
    pub(super) touching: &'s [Touching<'s>],
    /// Number of the opaque hit that ends the ray behind them; [`NO_END`] = none.
    pub(super) end: u32,
    /// What orders solids that touch.
    pub(super) order: &'s Order,
    /// Where.
    pub(super) foot: &'s Foot,
    /// Items that rays leaving outwards, and inwards, cannot meet.
    pub(super) skip: [u32; 2],
    /// Sets of faces that such rays cannot meet.
    pub(super) set: [u32; 2],
    /// Shading normal, world space, on either side; zero = use the geometric one.
    pub(super) normal_world: DVec3,
    /// The object hit: a medium of its own.
    pub(super) object: u32,
    pub(super) optics: &'s Optics,
    pub(super) settings: &'s TraceSettings,
    /// Whether reflected, and refracted rays are asked for.
    pub(super) wanted: [bool; 2],
    /// Whether any surface of the scene bends what it transmits.
    pub(super) bends: bool,
    /// Mistakes asked for.
    pub(super) faults: &'s Faults,
}

/// What becomes of K_T at a surface.
pub(super) struct Passage {
    /// Index of refraction before and behind the surface.
    pub(super) eta: [f64; 2],
    /// The part of K_T that the mirror ray takes.
    pub(super) reflected: f64,
    /// Where the rest goes, its part of K_T, and the media behind; `None` at total internal reflection.
    pub(super) beyond: Option<(DVec3, f64, MediaId)>,
}

/// The secondary rays of a hit, and how they came about.
pub(super) struct Forked {
    /// The reflected ray, where it exists and weighs something.
    pub(super) reflection: Option<Path>,
    /// The refracted ray, where it exists and weighs something.
    pub(super) refraction: Option<Path>,
    /// What the mirror ray is weighted with here.
    pub(super) mirror: Rgb,
    /// K_T here; 0 where nothing transmits.
    pub(super) transmission: Rgb,
    /// What became of it; `None` where nothing transmits.
    pub(super) passage: Option<Passage>,
}

impl Fork<'_> {
    /// The reflected and the refracted ray, where they exist and weigh something.
    pub(super) fn branches(&self, media: &mut Media) -> Forked {
        let mut mirror = self.optics.reflection;
        let mut refraction = None;
        let (mut passed, mut transmission) = (None, [0.0; 3]);
        if self.optics.is_transmissive() {
            let passage = self.transmit(media);
            let k_t = self.transmission();
            for (m, k) in mirror.iter_mut().zip(self.optics.transmission) {
                *m += k * passage.reflected;
            }
            let beyond = passage.beyond.filter(|_| self.wanted[1]);
            refraction = beyond.and_then(|(direction, part, media)| {
                self.child(direction, k_t.each(|k| k * part), Branch::Refraction, media)
            });
            (passed, transmission) = (Some(passage), k_t);
        }
        let reflection = (self.wanted[0] && mirror != [0.0; 3])
            .then(|| self.mirror_direction())
            .and_then(|d| self.child(d, mirror, Branch::Reflection, self.path.media));
        Forked {
            reflection,
            refraction,
            mirror,
            transmission,
            passage: passed,
        }
    }

    fn child(&self, direction: DVec3, k: Rgb, branch: Branch, media: MediaId) -> Option<Path> {
        // Weights above 1 saturate, so that a later factor of 0 still makes 0; those that lose their digits are 0, for the
        // smallest number times 0.9 rounds to itself and would never end.
        let product = |c: usize| (self.path.weight[c] * k[c]).clamp(f64::MIN, f64::MAX);
        let weight = [0, 1, 2].each(product);
        let weight = weight.each(|w| if w.is_subnormal() { 0.0 } else { w });
        let cutoff = self.settings.weight_cutoff;
        if weight.iter().all(|w| *w == 0.0 || w.abs() < cutoff) {
            return None;
        }
        let end = match branch {
            Branch::Refraction => self.end,
            Branch::Primary | Branch::Reflection => NO_END,
        };
        let ray = if end == NO_END {
            let inwards = usize::from(self.foot.normal.dot(direction) < 0.0);
            Ray {
                skip: self.skip[inwards],
                set: self.set[inwards],
                ..Ray::new(self.faults.spawn(self.foot, direction), direction)
            }
        } else {
            // The hit that ends it is one of the ray that arrived.
            self.path.ray
        };
        let first = self.path.branch == Branch::Primary;
        Some(Path {
            ray,
            weight,
            pixel: self.path.pixel,
            branch: if first { branch } else { self.path.branch },
            media,
            end,
        })
    }

    /// The shading normal, or the geometric one where there is none.
    fn normal(&self) -> DVec3 {
        if self.normal_world == DVec3::ZERO {
            self.foot.normal
        } else {
            self.normal_world
        }
    }

    /// Whether `direction` leaves to the side that the arriving ray came from.
    fn returns(&self, direction: DVec3) -> bool {
        let arriving = self.path.ray.direction.dot(self.foot.normal);
        direction.dot(self.foot.normal) * arriving < 0.0
    }

    fn mirror_direction(&self) -> DVec3 {
        let d = self.path.ray.direction;
        let mirrored = reflect(d, self.normal());
        if self.returns(mirrored) {
            mirrored
        } else {
            reflect(d, self.foot.normal)
        }
    }

    fn transmit(&self, media: &mut Media) -> Passage {
        let d = self.path.ray.direction;
        let straight = |media, ior| Passage {
            eta: [ior; 2],
            reflected: 0.0,
            beyond: Some((unit(d), 1.0, media)),
        };
        let nothing_between = self.end != NO_END;
        if nothing_between || (self.optics.thin && self.touching.is_empty()) {
            return straight(self.path.media, media.ior(self.path.media));
        }
        let crossing = self.cross(media);
        let eta = [crossing.eta_i, crossing.eta_t];
        let [eta_i, eta_t] = self.faults.indices(d, self.foot.normal, eta);
        if eta_i == eta_t || !self.bends {
            return straight(crossing.media, eta_t);
        }
        // Thin sheets bend nothing and have no Fresnel share: that of the first solid passed counts.
        let mut passed = std::iter::once(self.optics).chain(self.touching.iter().map(|t| t.optics));
        let model = passed.find(|o| !o.thin).unwrap_or(self.optics).fresnel;
        let mut normal = self.normal();
        let mut passed = refract(d, normal, eta_i, eta_t);
        if let Transmission::Through { direction, .. } = passed
            && self.returns(direction)
        {
            normal = self.foot.normal;
            passed = refract(d, normal, eta_i, eta_t);
        }
        match passed {
            Transmission::Through { direction, cosine } => {
                let cos_i = unit(d).dot(normal).abs().min(1.0);
                let f = fresnel(model, cos_i, cosine, eta_i, eta_t);
                let direction = self.faults.transmitted(direction, d, self.foot.normal);
                Passage {
                    eta: [eta_i, eta_t],
                    reflected: f,
                    beyond: Some((direction, 1.0 - f, crossing.media)),
                }
            }
            Transmission::Total => {
                let all = self.settings.tir == Tir::Reflect || model != Fresnel::Off;
                Passage {
                    eta: [eta_i, eta_t],
                    reflected: if all { 1.0 } else { 0.0 },
                    beyond: None,
                }
            }
        }
    }
}
