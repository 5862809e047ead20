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
use super::cost::Counts;
use super::draw::Ready;
use super::fit::Power;
use super::measure::{Judge, Measured};
use super::setting::{Setting, has_curves};
use super::truth::Truth;
use super::verify::elsewhere;
use crate::error::Error;
use crate::lanes::Isa;
use crate::render::{Precision, Renderer};
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
    /// The flags that ask for it.
    pub arguments: String,
    /// Expected rmse at the size that is asked for.
    pub error: f64,
    /// Expected seconds; only for a time.
    pub seconds: Option<f64>,
    /// Work expected, by the model of [`super::cost`].
    pub work: f64,
    /// Settings that were tried.
    pub tried: usize,
}

/// A setting that was tried on the small picture.
#[derive(Clone, Debug)]
struct Candidate {
    setting: Setting,
    /// Rmse, carried over to the size that is asked for.
    error: f64,
    /// Work that does not depend on the size, and work of the small picture that does.
    work: [f64; 2],
}

impl Candidate {
    /// Work of a picture with so many times as many pixels a side as the small one.
    fn work_at(&self, sides: f64) -> f64 {
        self.work[0] + self.work[1] * sides * sides
    }
}

/// An error of the small picture at so many times as many pixels a side: silhouettes are a line, so their share of the
/// pixels falls with the side.
fn carried(accuracy: &Accuracy, sides: f64) -> f64 {
    let (interior, silhouette) = (&accuracy.interior, &accuracy.silhouette);
    let pixels = (interior.pixels + silhouette.pixels).max(1) as f64;
    let share = silhouette.pixels as f64 / pixels / sides.max(1.0);
    let squares = |rmse: f64| rmse * rmse;
    ((1.0 - share) * squares(interior.rmse) + share * squares(silhouette.rmse)).sqrt()
}

/// The work of triangles, and all other, of a measurement.
fn work(measured: &Measured, precision: Precision) -> [f64; 2] {
    let triangles = Counts {
        triangles: measured.counts.triangles,
        ..Counts::default()
    };
    let fixed = triangles.work(precision);
    [fixed, measured.counts.work(precision) - fixed]
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

/// An error as it is typed: small ones with a power of ten.
fn typed(error: f64) -> String {
    if error == 1.0 / 255.0 {
        "1/255".to_owned()
    } else if error < 1e-3 {
        format!("{error:e}")
    } else {
        error.to_string()
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
        (self.progress)(&setting.name(self.full));
        self.tried += 1;
        let measured = self.judge.measure(setting, &[Truth::Own])?;
        let accuracy = measured.against(Truth::Own).copied().unwrap_or_default();
        Ok(Candidate {
            setting: *setting,
            error: carried(&accuracy, self.sides()),
            work: work(&measured, setting.precision),
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
        for setting in settings
            .iter()
            .filter(|s| !(exact(s) || hopeless && local(s)))
        {
            tried.push(self.try_out(setting)?);
        }
        self.refine(&mut tried, most)?;
        let sides = self.sides();
        tried.sort_by(|a, b| a.work_at(sides).total_cmp(&b.work_at(sides)));
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
        for coarse in tried
            .iter()
            .filter(|c| c.setting.renderer == Renderer::Raster && c.error > most)
        {
            let double = coarse
                .setting
                .shaded(coarse.setting.shading, 2 * coarse.setting.level);
            let Some(fine) = tried
                .iter()
                .find(|c| c.setting == double && c.error <= most)
            else {
                continue;
            };
            let [a, b] = [coarse, fine].map(|c| (f64::from(c.setting.level), c.error));
            let level = Power::through(&[a, b]).and_then(|fit| fit.solve(most));
            // Even, so that there are half as many stacks.
            let level = level.map(|l| 2 * (l / 2.0).ceil() as u32);
            if let Some(level) =
                level.filter(|l| *l > coarse.setting.level && *l < fine.setting.level)
            {
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
        (self.progress)("verifying the choice");
        let found = elsewhere(self.small, &candidate.setting, OTHER_SEED, self.isa)?;
        Ok(carried(&found, self.sides()))
    }

    fn out_of_reach(&self, most: f64, tried: &[Candidate]) -> Error {
        let best = tried.iter().min_by(|a, b| a.error.total_cmp(&b.error));
        let Some(best) = best else {
            return Error::parameter("--error", "no setting could be tried");
        };
        // Rounded up, so that asking for it works.
        let reachable = format!("{:.1e}", 1.1 * best.error);
        let message = format!(
            "{}: out of reach on this scene; the least error of {} settings is {:.2e}, with {}",
            typed(most),
            self.tried,
            best.error,
            best.setting.arguments(self.full)
        );
        Error::parameter("--error", message).with_help(format!("ask for {reachable} or more"))
    }

    /// The least error within a time.
    fn for_time(&mut self, most: f64) -> Result<Choice, Error> {
        let sides = self.sides();
        // Seconds at full size, from a picture with so many times the small one's pixels a side.
        let carried =
            |c: &Candidate, seconds: f64, from: f64| seconds * c.work_at(sides) / c.work_at(from);
        let mut tried = Vec::new();
        for setting in self.settings() {
            let candidate = self.try_out(&setting)?;
            let seconds = carried(&candidate, self.seconds(&candidate, self.small)?, 1.0);
            tried.push((candidate, seconds));
        }
        tried.sort_by(|(a, s), (b, t)| a.error.total_cmp(&b.error).then(s.total_cmp(t)));
        // Verified at four times the pixels: a small picture may flatter a setting.
        let larger = shrunk(self.full, 4.0 * SMALL);
        let from = f64::from(larger.image.width) / f64::from(self.small.image.width);
        for (candidate, seconds) in tried.iter().filter(|(_, s)| *s <= most) {
            (self.progress)("verifying the choice");
            let again = carried(candidate, self.seconds(candidate, &larger)?, from);
            let expected = again.max(*seconds);
            if expected <= most {
                return Ok(self.chosen(candidate, candidate.error, Some(expected)));
            }
        }
        let quickest = tried.iter().map(|(_, s)| *s).fold(f64::INFINITY, f64::min);
        let message = format!("{} ms: out of reach on this scene and machine", 1e3 * most);
        let help = format!(
            "the fastest setting is expected to take {:.2} ms; leave it some room",
            1e3 * quickest
        );
        Err(Error::parameter("--time", message).with_help(help))
    }

    /// The fastest of some runs of a setting.
    fn seconds(&self, candidate: &Candidate, scene: &Scene) -> Result<f64, Error> {
        let job = Ready::new(scene, &candidate.setting, self.isa);
        let mut fastest = f64::INFINITY;
        for _ in 0..RUNS {
            fastest = fastest.min(job.clock()?.0);
        }
        Ok(fastest)
    }

    fn chosen(&self, candidate: &Candidate, error: f64, seconds: Option<f64>) -> Choice {
        Choice {
            setting: candidate.setting,
            arguments: candidate.setting.arguments(self.full),
            error,
            seconds,
            work: candidate.work_at(self.sides()),
            tried: self.tried,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::{LoadOptions, load};
    use crate::trade::accuracy::Errors;

    fn scene(name: &str, width: u32, height: u32) -> Scene {
        let mut scene = load(name, &LoadOptions::default()).expect("shipped").scene;
        (scene.image.width, scene.image.height) = (width, height);
        scene
    }

    #[test]
    fn silhouettes_shrink_as_pictures_grow() {
        let errors = |rmse: f64, pixels: usize| Errors {
            rmse,
            pixels,
            ..Errors::default()
        };
        let accuracy = Accuracy {
            interior: errors(0.0, 900),
            silhouette: errors(0.2, 100),
            ..Accuracy::default()
        };
        assert!((carried(&accuracy, 1.0) - 0.2 * 0.1f64.sqrt()).abs() < 1e-12);
        assert!((carried(&accuracy, 10.0) - 0.2 * 0.01f64.sqrt()).abs() < 1e-12);
        assert_eq!(carried(&Accuracy::default(), 3.0), 0.0);
    }

    #[test]
    fn errors_are_echoed_as_typed() {
        let echoed = [1e-12, 0.05, 1.0 / 255.0].map(typed);
        assert_eq!(echoed, ["1e-12", "0.05", "1/255"]);
    }

    #[test]
    fn small_pictures_keep_their_shape() {
        let scene = scene("whitted", 1600, 900);
        let small = shrunk(&scene, SMALL);
        let (w, h) = (f64::from(small.image.width), f64::from(small.image.height));
        assert!(w * h < 1.02 * SMALL && (w / h - 16.0 / 9.0).abs() < 0.03);
        assert_eq!(shrunk(&small, 1e9), small);
    }

    /// The same choice every time, as accurate as it says, and none cheaper that is as accurate among its neighbours.
    #[test]
    fn an_accuracy_is_met_and_repeats() {
        let scene = scene("whitted", 64, 48);
        let choose = |e: f64| super::choose(&scene, Goal::Error(e), Isa::detect(), &|_| {});
        let choice = choose(1e-3).expect("in reach");
        assert_eq!(choose(1e-3).expect("in reach"), choice);
        assert!(choice.error <= 1e-3, "{choice:?}");
        let coarse = choose(0.05).expect("in reach");
        assert!(
            coarse.work < choice.work && coarse.error <= 0.05,
            "{coarse:?}"
        );
        // Two mirrors that face each other: some light is always left.
        let mirrors = self::scene("facing-mirrors", 40, 30);
        let beyond = super::choose(&mirrors, Goal::Error(1e-30), Isa::detect(), &|_| {});
        let error = beyond.expect_err("beyond rounding").to_string();
        assert!(
            error.contains("out of reach") && error.contains("least error"),
            "{error}"
        );
    }

    #[test]
    fn no_time_is_out_of_reach_and_an_hour_buys_the_best() {
        let scene = scene("two-sided", 40, 30);
        let choose = |s: f64| {
            let goal = Goal::Time(Duration::from_secs_f64(s));
            super::choose(&scene, goal, Isa::detect(), &|_| {})
        };
        assert!(
            choose(1e-9)
                .expect_err("no time")
                .to_string()
                .contains("out of reach")
        );
        let best = choose(3600.0).expect("an hour");
        assert!(best.error < 1e-6 && best.seconds.is_some(), "{best:?}");
    }
}
