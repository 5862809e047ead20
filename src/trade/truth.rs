//! What settings are measured against: the exact shapes, in f64, lit per pixel, followed until nothing is left to see.
//!
//! | truth | light | places | judges |
//! | - | - | - | - |
//! | [`Truth::Full`] | Whitted's | pixel centres | every setting: what is wrong with its pixels |
//! | [`Truth::Local`] | the rasterizer's terms | pixel centres | shading and tessellation, which missing shadows would drown |
//! | [`Truth::Mesh`] | the same, on the triangles of a level | pixel centres | the sub-pixel grid, which the chords would drown |
//! | [`Truth::Ideal`] | Whitted's | many jittered samples | samples: what is wrong with its edges |
//! | [`Truth::Own`] | Whitted's | the scene's own samples | the setting that `render --error` picks |
//!
//! Secondary rays go on until their weight is below [`LEAST_WEIGHT`] in every channel, for at most [`MOST_DEPTH`] generations:
//! enough for mirrors of weight 0.88; with brighter ones [`Truth::end`] tells what weight may be left there.

use serde::Serialize;

use super::axis::bounce_weight;
use super::draw::{Ready, Shot};
use super::setting::{Setting, is_curved};
use crate::error::Error;
use crate::frame::Plane;
use crate::lanes::Isa;
use crate::render::{Precision, Renderer};
use crate::sampling::Pattern;
use crate::scene::{Scene, Snap};
use crate::trace;

/// Branches of less weight are not followed.
pub const LEAST_WEIGHT: f64 = 1e-7;

/// Generations that are followed at most: a mirror of weight 0.88 is below [`LEAST_WEIGHT`] by then.
pub const MOST_DEPTH: u32 = 128;

/// What the seed of the scene's jitter is changed by for the ideal picture.
const IDEAL_SEED: u32 = 0x1dea_1000;

/// Samples of the ideal picture where nobody says.
pub const IDEAL_SAMPLES: u32 = 256;

/// Which truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// Whitted's picture at pixel centres.
    Full,
    /// The rasterizer's terms on the exact shapes, at pixel centres.
    Local,
    /// The rasterizer's terms on the triangles of a level, at pixel centres.
    Mesh(u32),
    /// Whitted's picture as the mean of this many jittered samples.
    Ideal(u32),
    /// Whitted's picture at the samples that the scene asks for.
    Own,
}

/// A truth that was drawn.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Linear colours before any clamp.
    pub color: Plane<[f64; 3]>,
    /// The object seen at each pixel's first sample.
    pub object: Plane<u32>,
    /// Whether that is a curved shape.
    pub curved: Plane<bool>,
    /// Generations of secondary rays that were followed.
    pub depth: u32,
    /// Rays of all kinds.
    pub rays: u64,
}

/// Where a truth stopped following rays.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct End {
    /// Generations of secondary rays that were allowed.
    pub depth: u32,
    /// Where rays were left that weigh [`LEAST_WEIGHT`] or more: the most that the next generation of a pixel can weigh (1
    /// where surfaces pass on all light). `None` where every ray was followed to its end.
    pub weight_left: Option<f64>,
}

impl Truth {
    /// What reports call it.
    pub fn name(self) -> String {
        match self {
            Self::Full => "full".to_owned(),
            Self::Local => "local".to_owned(),
            Self::Mesh(level) => format!("mesh {level}"),
            Self::Ideal(samples) => format!("ideal {samples}"),
            Self::Own => "own".to_owned(),
        }
    }

    /// Draws it.
    ///
    /// # Errors
    /// What the renderers refuse.
    pub fn draw(self, scene: &Scene, isa: Isa) -> Result<Reference, Error> {
        let (scene, setting) = self.posed(scene);
        deepest(&scene, setting, isa)
    }

    /// Where a truth that was drawn stopped: whether one more generation would have had rays.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn end(self, scene: &Scene, drawn: &Reference, isa: Isa) -> Result<End, Error> {
        let depth = drawn.depth;
        let left = bounce_weight(scene).map_or(0.0, |k| k.powf(f64::from(depth) + 1.0).min(1.0));
        if left < LEAST_WEIGHT {
            let weight_left = None;
            return Ok(End { depth, weight_left });
        }
        let (scene, setting) = self.posed(scene);
        let deeper = Setting {
            depth: depth + 1,
            ..setting
        };
        let more = match Ready::new(&scene, &deeper, isa).draw() {
            Ok(further) => further.counts.rays() > drawn.rays,
            Err(Error::Limit { .. }) => true,
            Err(error) => return Err(error),
        };
        let weight_left = more.then_some(left);
        Ok(End { depth, weight_left })
    }

    /// The scene, and the setting that draws the truth of it.
    fn posed(self, scene: &Scene) -> (Scene, Setting) {
        let mut scene = scene.clone();
        scene.trace.weight_cutoff = LEAST_WEIGHT;
        let renderer = match self {
            Self::Full | Self::Ideal(_) | Self::Own => Renderer::Trace,
            Self::Local | Self::Mesh(_) => Renderer::Cast,
        };
        let mut setting = Setting {
            precision: Precision::F64,
            depth: MOST_DEPTH,
            snap: Snap::Exact,
            ..Setting::by(renderer, &scene)
        };
        if let Self::Mesh(level) = self {
            (setting.geometry, setting.level) = (trace::Geometry::Mesh, level);
        }
        if let Self::Ideal(samples) = self {
            (setting.samples, setting.pattern) = (samples, Pattern::Jitter);
            // Other places than those of any setting, as many samples as it may have.
            scene.image.seed ^= IDEAL_SEED;
        }
        if self == Self::Own {
            (setting.samples, setting.pattern) = (scene.image.samples, scene.image.pattern);
        }
        (scene, setting)
    }
}

/// Draws with as many generations as the cap on rays lets through, halving from [`MOST_DEPTH`].
fn deepest(scene: &Scene, mut setting: Setting, isa: Isa) -> Result<Reference, Error> {
    loop {
        match Ready::new(scene, &setting, isa).draw() {
            Ok(Shot {
                color,
                object,
                counts,
            }) => {
                let curved = |o: &u32| scene.objects.get(*o as usize).is_some_and(is_curved);
                return Ok(Reference {
                    color,
                    curved: object.map(curved),
                    object,
                    depth: setting.depth,
                    rays: counts.rays(),
                });
            }
            Err(Error::Limit { .. }) if setting.depth > 8 => setting.depth /= 2,
            Err(error) => return Err(error),
        }
    }
}
