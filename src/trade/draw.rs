//! A setting drawn: the picture in f64, which object each pixel shows, and what it took.
//!
//! Colours are linear and before any clamp. What is drawn, and therefore timed, is everything after the scene is read and
//! before the picture is written: triangles, plan (lights, binning, hierarchy), pixels.

use std::time::Instant;

use super::cost::Counts;
use super::setting::Setting;
use crate::error::Error;
use crate::frame::Plane;
use crate::lanes::Isa;
use crate::render::{self, Counters, Job};
use crate::scene::Scene;

/// What a render leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot {
    /// Linear colours before any clamp.
    pub color: Plane<[f64; 3]>,
    /// The object seen at each pixel's first sample; `frame::NONE` where there is none.
    pub object: Plane<u32>,
    /// The work.
    pub counts: Counts,
}

/// A scene ready to be drawn by a setting, again and again.
#[derive(Clone, Debug)]
pub struct Ready {
    scene: Scene,
    setting: Setting,
    isa: Isa,
}

impl Ready {
    /// The scene as the setting has it.
    pub fn new(scene: &Scene, setting: &Setting, isa: Isa) -> Self {
        Self {
            scene: setting.apply(scene),
            setting: *setting,
            isa,
        }
    }

    /// Draws.
    ///
    /// # Errors
    /// What the renderers refuse: too many triangles, too many rays a pixel.
    pub fn draw(&self) -> Result<Shot, Error> {
        let drawn = self.job().draw()?;
        Ok(Shot {
            color: drawn.picture.color_f64(),
            object: drawn.picture.object().clone(),
            counts: match &drawn.counters {
                Counters::Raster(counters) => Counts::of_raster(counters),
                Counters::Trace(counters) => Counts::of_trace(counters, drawn.triangles),
            },
        })
    }

    /// Draws, and gives the seconds that took and a checksum of the colours.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn clock(&self) -> Result<(f64, u64), Error> {
        let start = Instant::now();
        let drawn = self.job().draw()?;
        let seconds = start.elapsed().as_secs_f64();
        let color = drawn.picture.color_f64();
        let bits = color.data.iter().flatten().map(|x| x.to_bits());
        // FNV-1a by words.
        let fnv = |sum: u64, word: u64| (sum ^ word).wrapping_mul(0x0100_0000_01b3);
        Ok((seconds, bits.fold(0xcbf2_9ce4_8422_2325, fnv)))
    }

    fn job(&self) -> Job<'_> {
        let (scene, setting) = (&self.scene, &self.setting);
        let options = render::Options {
            precision: setting.precision,
            level: Some(setting.level),
            geometry: setting.geometry,
            isa: self.isa,
            ..render::Options::default()
        };
        let mut job = Job::with(scene, setting.renderer, &options).shading(setting.shading);
        job.study.trace.offset = setting.offset;
        job
    }
}
