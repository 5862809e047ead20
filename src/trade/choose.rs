//! The setting for an accuracy, or for a time: a quick trade of a small picture, carried over to the size that is asked for.
//!
//! Every setting of the grid is drawn at about [`SMALL`] pixels, at the samples that the scene asks for, and judged by the
//! truth there. Interior errors do not depend on the size; silhouettes are a line, so that their share of the pixels shrinks as
//! the size grows. Counts grow with the pixels, triangles do not. Where a tessellation is not fine enough and its double
//! is, the fitted slope says which level between them should be. The choice is then verified at other places of the small picture
//! (other jitter); one that fails makes way for the next.
//!
//! An accuracy is chosen by exact counts: the same setting on every machine. A time is measured here and now, on the threads that will
//! draw: the answer may differ from run to run.

use std::time::Duration;

use super::accuracy::Accuracy;
use super::axis::grid;
use super::cost::WEIGHTS;
use super::draw::Job;
use super::fit::Power;
use super::measure::{Judge, Measured};
use super::setting::{Precision, Renderer, Setting, has_curves, shading_name};
use super::truth::Truth;
use super::verify::elsewhere;
use crate::error::Error;
use crate::lanes::Isa;
use crate::scene::Scene;

/// Pixels of the picture that settings are tried on, at most.
pub const SMALL: f64 = 12_288.0;

/// Seed of the places that a choice is verified at.
const OTHER_SEED: u32 = 0x5eed;

/// Runs that a time is the fastest of.
const RUNS: usize = 3;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Largest rmse of linear values over all pixels.
    Error(f64),
    /// Longest time to draw.
    Time(Duration),
}

/// What was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The setting, with the scene's own samples.
    pub setting: Setting,
    /// Expected rmse at the size that is asked for.
    pub error: f64,
    /// Expected seconds; only for a time.
    pub seconds: Option<f64>,
    /// Nanoseconds of work expected, by the model of [`super::cost`].
    pub work: f64,
    /// Settings that were tried.
    pub tried: usize,
}

/// A setting that was tried, carried over to the size that is asked for.
#[derive(Clone, Debug)]
struct Candidate {
    setting: Setting,
    error: f64,
    /// Work at full size, and at the small one.
    work: [f64; 2],
}

/// Picks the setting for a goal. `progress` hears the name of each setting before it is tried.
///
/// # Errors
/// [`Error::Parameter`] where the goal is out of reach: it says what is reachable. What the renderers refuse.
pub fn choose(
    scene: &Scene,
    goal: Goal,
    isa: Isa,
    progress: &dyn Fn(&str),
) -> Result<Choice, Error> {
    let small = shrunk(scene, SMALL);
    let mut trial = Trial {
        full: scene,
        small: &small,
        isa,
        judge: Judge::new(&small, isa),
        tried: 0,
        progress,
    };
    match goal {
        Goal::Error(error) => trial.for_error(error),
        Goal::Time(time) => trial.for_time(time.as_secs_f64()),
    }
}

/// The scene with at most so many pixels, of the same shape.
pub fn shrunk(scene: &Scene, pixels: f64) -> Scene {
    let mut small = scene.clone();
    let (w, h) = (f64::from(scene.image.width), f64::from(scene.image.height));
    let scale = (pixels / (w * h)).sqrt().min(1.0);
    let side = |x: f64| ((x * scale).round() as u32).max(1);
    (small.image.width, small.image.height) = (side(w), side(h));
    small
}

/// Trials of settings on the small picture.
struct Trial<'a> {
    full: &'a Scene,
    small: &'a Scene,
    isa: Isa,
    judge: Judge<'a>,
    tried: usize,
    progress: &'a dyn Fn(&str),
}

impl Trial<'_> {
    /// How many times as many pixels a side the full picture has.
    fn sides(&self) -> f64 {
        f64::from(self.full.image.width) / f64::from(self.small.image.width)
    }

    fn try_out(&mut self, setting: &Setting) -> Result<Candidate, Error> {
        (self.progress)(&setting.name());
        self.tried += 1;
        let measured = self.judge.measure(setting, &[Truth::Own])?;
        let accuracy = measured.against(Truth::Own).copied().unwrap_or_default();
        Ok(Candidate {
            setting: *setting,
            error: carried(&accuracy, self.sides()),
            work: work(&measured, setting.precision, self.sides()),
        })
    }

    /// The grid at the scene's own samples.
    fn settings(&self) -> Vec<Setting> {
        let image = &self.full.image;
        let own = |setting: Setting| Setting {
            samples: image.samples,
            pattern: image.pattern,
            ..setting
        };
        grid(self.full).into_iter().map(own).collect()
    }

    /// Cheapest first, those that the goal may take.
    fn for_error(&mut self, most: f64) -> Result<Choice, Error> {
        let settings = self.settings();
        let local = |s: &Setting| s.renderer != Renderer::Trace;
        let exact = |s: &&Setting| s.renderer == Renderer::Cast && s.precision == Precision::F64;
        let mut tried = Vec::new();
        // What the rasterizer converges to: beyond the goal, and every raster setting is.
        let mut hopeless = false;
        if let Some(limit) = settings.iter().find(exact) {
            let limit = self.try_out(limit)?;
            hopeless = limit.error > most;
            tried.push(limit);
        }
        for setting in settings.iter().filter(|s| !exact(s) && !(hopeless && local(s))) {
            tried.push(self.try_out(setting)?);
        }
        self.refine(&mut tried, most)?;
        tried.sort_by(|a, b| a.work[0].total_cmp(&b.work[0]));
        for candidate in tried.iter().filter(|c| c.error <= most) {
            let error = self.verified(candidate)?;
            if error <= most {
                return Ok(self.chosen(candidate, error.max(candidate.error), None));
            }
        }
        Err(self.out_of_reach(most, &tried))
    }

    /// Adds the level between one that is not fine enough and its double that is, where a slope says which.
    fn refine(&mut self, tried: &mut Vec<Candidate>, most: f64) -> Result<(), Error> {
        if !has_curves(self.full) {
            return Ok(());
        }
        let mut finer = Vec::new();
        for coarse in tried.iter().filter(|c| c.setting.renderer == Renderer::Raster && c.error > most) {
            let double = coarse.setting.shaded(coarse.setting.shading, 2 * coarse.setting.level);
            let Some(fine) = tried.iter().find(|c| c.setting == double && c.error <= most) else {
                continue;
            };
            let [a, b] = [coarse, fine].map(|c| (f64::from(c.setting.level), c.error));
            let level = Power::through(&[a, b]).and_then(|fit| fit.solve(most));
            // Even, so that there are half as many stacks.
            let level = level.map(|l| 2 * (l / 2.0).ceil() as u32);
            if let Some(level) = level.filter(|l| *l > coarse.setting.level && *l < fine.setting.level) {
                finer.push(coarse.setting.shaded(coarse.setting.shading, level));
            }
        }
        for setting in finer {
            tried.push(self.try_out(&setting)?);
        }
        Ok(())
    }

    /// The error at other places of the small picture, carried over.
    fn verified(&mut self, candidate: &Candidate) -> Result<f64, Error> {
        if self.full.image.samples > 1 {
            return Ok(candidate.error);
        }
        (self.progress)("verifying the choice");
        let found = elsewhere(self.small, &candidate.setting, &[OTHER_SEED], self.isa)?;
        // The same share of interior and silhouette as at the centres.
        Ok(found.all.rmse.min(carried(&found, self.sides())))
    }

    fn out_of_reach(&self, most: f64, tried: &[Candidate]) -> Error {
        let best = tried.iter().min_by(|a, b| a.error.total_cmp(&b.error));
        let Some(best) = best else {
            return Error::parameter("--error", "no setting could be tried");
        };
        let reachable = format!("{:.1e}", round_up(best.error));
        let message = format!(
            "{most}: out of reach on this scene; the least error of {} settings is {:.2e}, with {}",
            self.tried,
            best.error,
            best.setting.arguments(self.full)
        );
        Error::parameter("--error", message).with_help(format!("ask for {reachable} or more"))
    }

    /// The least error within a time.
    fn for_time(&mut self, most: f64) -> Result<Choice, Error> {
        let mut tried = Vec::new();
        for setting in self.settings() {
            let candidate = self.try_out(&setting)?;
            let seconds = self.seconds(&candidate, self.small)? * candidate.work[0] / candidate.work[1];
            tried.push((candidate, seconds));
        }
        tried.sort_by(|(a, s), (b, t)| a.error.total_cmp(&b.error).then(s.total_cmp(t)));
        // Verified at four times the pixels: a small picture may flatter a setting.
        let larger = shrunk(self.full, 4.0 * SMALL);
        let share = f64::from(larger.image.width) / f64::from(self.small.image.width);
        let mut fastest = f64::INFINITY;
        for (candidate, seconds) in tried.iter().filter(|(_, s)| *s <= most) {
            let grown = 1.0 + (candidate.work[0] / candidate.work[1] - 1.0) * ((share * share - 1.0) / (self.sides().powi(2) - 1.0).max(1e-9)).min(1.0);
            let expected = self.seconds(candidate, &larger)? / grown * candidate.work[0] / candidate.work[1];
            let expected = expected.max(*seconds);
            fastest = fastest.min(expected);
            if expected <= most {
                return Ok(self.chosen(candidate, candidate.error, Some(expected)));
            }
        }
        let quickest = tried.iter().map(|(_, s)| *s).fold(fastest, f64::min);
        let message = format!("{} ms: out of reach on this scene and machine", 1e3 * most);
        let help = format!("the fastest setting is expected to take {:.2} ms", 1e3 * quickest);
        Err(Error::parameter("--time", message).with_help(help))
    }

    /// The fastest of some runs of a setting.
    fn seconds(&self, candidate: &Candidate, scene: &Scene) -> Result<f64, Error> {
        let job = Job::new(scene, &candidate.setting, self.isa);
        let mut fastest = f64::INFINITY;
        for _ in 0..RUNS {
            fastest = fastest.min(job.clock()?.0);
        }
        Ok(fastest)
    }

    fn chosen(&self, candidate: &Candidate, error: f64, seconds: Option<f64>) -> Choice {
        Choice {
            setting: candidate.setting,
            error,
            seconds,
            work: candidate.work[0],
            tried: self.tried,
        }
    }
}
