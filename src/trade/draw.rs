//! A setting drawn: the picture in f64, which object each pixel shows, and what it took.
//!
//! Colours are linear and before any clamp. What is drawn, and therefore timed, is everything after the scene is read and
//! before the picture is written: triangles, plan (lights, binning, hierarchy), pixels.

use std::time::Instant;

use super::cost::Counts;
use super::setting::{Precision, Renderer, Setting};
use crate::error::Error;
use crate::frame::{Frame, Plane};
use crate::lanes::{Isa, Real};
use crate::scene::Scene;
use crate::scene::assembly::Assembly;
use crate::scene::requirements::Model;
use crate::{raster, trace};

/// What a render leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// Linear colours before any clamp.
    pub color: Plane<[f64; 3]>,
    /// The object seen at each pixel's first sample; `frame::NONE` where there is none.
    pub object: Plane<u32>,
    /// The work.
    pub counts: Counts,
}

/// A scene ready to be drawn by a setting, again and again.
#[derive(Clone, Debug)]
pub struct Job {
    scene: Scene,
    setting: Setting,
    isa: Isa,
}

impl Job {
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
    pub fn draw(&self) -> Result<Drawn, Error> {
        match self.setting.precision {
            Precision::F32 => self.frame::<f32>().map(drawn),
            Precision::F64 => self.frame::<f64>().map(drawn),
        }
    }

    /// Draws, and gives the seconds that took and a checksum of the colours.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn clock(&self) -> Result<(f64, u64), Error> {
        match self.setting.precision {
            Precision::F32 => self.clock_in::<f32>(),
            Precision::F64 => self.clock_in::<f64>(),
        }
    }

    fn clock_in<R: Real>(&self) -> Result<(f64, u64), Error> {
        let start = Instant::now();
        let (frame, _) = self.frame::<R>()?;
        let seconds = start.elapsed().as_secs_f64();
        let bits = frame
            .color
            .data
            .iter()
            .flatten()
            .map(|x| x.to_f64().to_bits());
        // FNV-1a by words.
        let fnv = |sum: u64, word: u64| (sum ^ word).wrapping_mul(0x0100_0000_01b3);
        Ok((seconds, bits.fold(0xcbf2_9ce4_8422_2325, fnv)))
    }

    fn frame<R: Real>(&self) -> Result<(Frame<R>, Counts), Error> {
        let (scene, setting) = (&self.scene, &self.setting);
        let assembly = Assembly::<R>::new(scene, Some(setting.level))?;
        assembly.check_range(scene)?;
        if setting.renderer == Renderer::Raster {
            let options = raster::Options {
                shading: setting.shading,
                clamp: false,
                layers: false,
                isa: self.isa,
            };
            let plan = raster::Plan::new(scene, &assembly, Model::Required);
            let (frame, counters) = plan.draw(&options)?;
            return Ok((frame, Counts::of_raster(&counters)));
        }
        let faults = trace::Faults {
            offset: setting.offset,
            ..trace::Faults::default()
        };
        let plan = trace::Plan::new(scene, &assembly, setting.geometry, Model::Required)?;
        let plan = plan.with_faults(faults);
        let options = match setting.renderer {
            Renderer::Trace => trace::Options::of(scene, self.isa),
            _ => trace::Options::cast(self.isa),
        };
        let (frame, counters) = plan.draw(&options)?;
        Ok((frame, Counts::of_trace(&counters, assembly.triangles.len())))
    }
}

fn drawn<R: Real>((frame, counts): (Frame<R>, Counts)) -> Drawn {
    Drawn {
        color: frame.color.map(|c| c.map(Real::to_f64)),
        object: frame.object,
        counts,
    }
}
