//! What was measured, as one value: rows of a table, curves of the axes with their slopes, and answers.

use serde::Serialize;

use super::accuracy::{Accuracy, Errors};
use super::axis::{Axis, Law, Part, Series};
use super::cost::Counts;
use super::fit::{Power, falling, price_of_a_digit};
use super::journal::Journal;
use super::measure::{Measured, key};
use super::power::{PowerError, errors, exponents};
use super::run::{Outcome, on_front};
use super::setting::Setting;
use super::timing::Ratio;
use super::truth::{End, Truth};
use crate::lanes::Isa;
use crate::render::Renderer;
use crate::scene::Scene;

/// Errors that an answer is given for: half of what 8 bits can show is 1/510, so the first is two steps of display; the
/// last is the floor of f32.
pub const TARGETS: [f64; 3] = [1.0 / 255.0, 1e-3, 1e-6];

/// A whole trade.
#[derive(Clone, Debug, Serialize)]
pub struct Trade {
    /// The scene's name.
    pub scene: String,
    /// Width and height of the measured pictures.
    pub size: [u32; 2],
    /// Samples of the ideal picture.
    pub ideal_samples: u32,
    /// Where the full truth stopped following rays.
    pub truth: End,
    /// Instruction set.
    pub isa: &'static str,
    /// Settings there are, and those that are measured.
    pub settings: usize,
    /// See `settings`.
    pub measured: usize,
    /// Name of the setting that times are multiples of.
    pub base: String,
    /// One row a measured setting.
    pub rows: Vec<Row>,
    /// One an axis.
    pub axes: Vec<AxisFinding>,
    /// The cheapest setting for each of [`TARGETS`].
    pub answers: Vec<Answer>,
    /// Shininess exponents of the scene that need a power.
    pub exponents: Vec<f64>,
    /// Forms of the power at those exponents.
    pub power: Vec<PowerError>,
}

/// A measured setting.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// In a few words.
    pub setting: String,
    /// Flags of `rastray render`.
    pub arguments: String,
    /// Whether `rastray render` can draw it; else it is a study, and never an answer.
    pub offered: bool,
    /// Who draws.
    #[serde(skip)]
    pub renderer: Renderer,
    /// Error against Whitted's picture at pixel centres; none for several samples.
    pub full: Option<Accuracy>,
    /// Error against the local terms on the exact shapes.
    pub local: Option<Accuracy>,
    /// Error against the ideal picture.
    pub ideal: Option<Accuracy>,
    /// Exact counts.
    pub counts: Counts,
    /// Work a pixel by the model of [`super::cost`].
    pub work: f64,
    /// Nanoseconds a pixel as measured, on one thread.
    pub time: Option<Time>,
    /// On the front of work and error against the full truth.
    pub front: bool,
}

/// A measured time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Time {
    /// Nanoseconds a pixel, if they may be told.
    pub ns_per_pixel: Option<f64>,
    /// Their 95 % interval.
    pub interval: Option<[f64; 2]>,
    /// Why they may not.
    pub inconclusive: Option<String>,
    /// Rounds of A B B A.
    pub rounds: usize,
}

/// An axis measured.
#[derive(Clone, Debug, Serialize)]
pub struct AxisFinding {
    /// In a word or two.
    pub name: &'static str,
    /// What the knob counts; empty for choices.
    pub knob: &'static str,
    /// [`Truth::name`] of what judges it.
    pub truth: String,
    /// Which pixels count.
    pub part: Part,
    /// One a series.
    pub curves: Vec<Curve>,
}

/// A series measured.
#[derive(Clone, Debug, Serialize)]
pub struct Curve {
    /// Such as "gouraud".
    pub name: String,
    /// Its points, the knob rising.
    pub points: Vec<Point>,
    /// What theory says.
    pub law: Law,
    /// Slope of the falling error over the knob (as a positive number), or factor of a step; `None` where nothing falls.
    pub slope: Option<f64>,
    /// Whether the slope is what theory says.
    pub as_predicted: Option<bool>,
    /// What a tenth of the error costs, as a multiple of the work.
    pub price: Option<f64>,
}

/// A point of a curve.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// The knob's value.
    pub knob: f64,
    /// In a few words.
    pub setting: String,
    /// Error of the axis' pixels against its truth.
    pub error: Errors,
    /// Rmse of all pixels away from silhouettes.
    pub interior: f64,
    /// Work a pixel by the model.
    pub work: f64,
}

/// The cheapest setting for an error.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// The largest rmse.
    pub target: f64,
    /// Position in `rows`; `None` where no measured setting is good enough.
    pub row: Option<usize>,
    /// The least rmse of all.
    pub least: f64,
}

/// Everything that a run found.
pub fn find(
    scene: &Scene,
    ideal_samples: u32,
    truth: End,
    isa: Isa,
    outcome: &Outcome,
    journal: &Journal,
) -> Trade {
    let pixels = f64::from(scene.image.width) * f64::from(scene.image.height);
    let front = on_front(&outcome.tasks, journal);
    let mut rows = Vec::new();
    for (i, task) in outcome.tasks.iter().enumerate() {
        if let Some(measured) = journal.measurement(&key(&task.setting)) {
            let time = journal.time(&measured.setting).map(|r| time(r, pixels));
            let mut row = row(scene, &task.setting, measured, pixels, ideal_samples);
            (row.time, row.front) = (time, front.contains(&i));
            rows.push(row);
        }
    }
    rows.sort_by(|a, b| a.work.total_cmp(&b.work));
    let exponents = exponents(scene);
    Trade {
        scene: scene.name.clone(),
        size: [scene.image.width, scene.image.height],
        ideal_samples,
        truth,
        isa: isa.name(),
        settings: outcome.tasks.len(),
        measured: outcome.measured,
        base: Setting::of(scene).plain(scene).name(scene),
        answers: TARGETS.map(|target| answer(&rows, target)).into(),
        axes: outcome
            .axes
            .iter()
            .map(|axis| finding(scene, axis, journal, pixels))
            .collect(),
        rows,
        power: errors(&exponents, scene.light_model.specular_model, isa),
        exponents,
    }
}

fn row(scene: &Scene, setting: &Setting, measured: &Measured, pixels: f64, ideal: u32) -> Row {
    Row {
        setting: setting.name(scene),
        arguments: setting.arguments(scene),
        offered: setting.is_offered(),
        renderer: setting.renderer,
        full: measured.against(Truth::Full).copied(),
        local: measured.against(Truth::Local).copied(),
        ideal: measured.against(Truth::Ideal(ideal)).copied(),
        counts: measured.counts,
        work: measured.counts.work(setting.precision) / pixels,
        time: None,
        front: false,
    }
}

/// A time ratio as nanoseconds a pixel: the fastest run of the base, times the ratio.
fn time(ratio: &Ratio, pixels: f64) -> Time {
    let scale = 1e9 * ratio.base / pixels;
    let verdict = ratio.verdict();
    Time {
        ns_per_pixel: verdict.as_ref().ok().map(|r| r * scale),
        interval: ratio.interval.map(|i| i.map(|r| r * scale)),
        inconclusive: verdict.err(),
        rounds: ratio.rounds,
    }
}

/// The cheapest row whose rmse against the full truth is at most `target`. Rows are sorted by work.
pub fn answer(rows: &[Row], target: f64) -> Answer {
    let error = |row: &Row| {
        row.full
            .filter(|_| row.offered)
            .map_or(f64::INFINITY, |a| a.all.rmse)
    };
    Answer {
        target,
        row: rows.iter().position(|row| error(row) <= target),
        least: rows.iter().map(error).fold(f64::INFINITY, f64::min),
    }
}

/// What the journal knows of an axis; work is told a pixel, of which there are so many.
pub fn finding(scene: &Scene, axis: &Axis, journal: &Journal, pixels: f64) -> AxisFinding {
    let curves = axis.series.iter().map(|series| {
        let points = series.settings.iter().filter_map(|(knob, setting)| {
            let setting = setting.plain(scene);
            let measured = journal.measurement(&key(&setting))?;
            let accuracy = measured.against(axis.truth)?;
            Some(Point {
                knob: *knob,
                setting: setting.name(scene),
                error: part(accuracy, axis.part),
                interior: accuracy.interior.rmse,
                work: measured.counts.work(setting.precision) / pixels,
            })
        });
        curve(series, points.collect())
    });
    AxisFinding {
        name: axis.name,
        knob: axis.knob,
        truth: axis.truth.name(),
        part: axis.part,
        curves: curves.collect(),
    }
}

fn part(accuracy: &Accuracy, part: Part) -> Errors {
    match part {
        Part::All => accuracy.all,
        Part::Interior => accuracy.interior,
        Part::Silhouette => accuracy.silhouette,
        Part::Curved => accuracy.curved,
    }
}

/// Slope, verdict and price of a series.
pub fn curve(series: &Series, points: Vec<Point>) -> Curve {
    let errors: Vec<(f64, f64)> = points.iter().map(|p| (p.knob, p.error.rmse)).collect();
    // Orders are asymptotic: the three finest settings that still fall. Steps and samples have one law from the start.
    let most = match series.law {
        Law::Power { low, .. } if low > 0.8 => 3,
        _ => errors.len(),
    };
    let fall = falling(&errors, most);
    let slope = match series.law {
        Law::Power { .. } => Power::through(fall).map(|fit| -fit.slope),
        Law::Step { .. } => step(fall),
        Law::None => None,
    };
    let as_predicted = slope.and_then(|slope| match series.law {
        Law::Power { low, high } => Some((low..=high).contains(&slope)),
        // Rounding in f32 may add a little to a remainder that shrinks by exactly the factor.
        Law::Step { factor } if factor < 1.0 => Some(slope <= factor * 1.02),
        // Surfaces that pass on everything bound nothing.
        Law::Step { .. } => None,
        Law::None => None,
    });
    let costs: Vec<(f64, f64)> = points
        .iter()
        .filter(|p| fall.iter().any(|(knob, _)| *knob == p.knob))
        .map(|p| (p.work, p.error.rmse))
        .collect();
    Curve {
        name: series.name.clone(),
        law: series.law,
        slope,
        as_predicted,
        price: price_of_a_digit(&costs),
        points,
    }
}

/// The factor of one step: a straight line through the logarithms of the error over the knob itself.
fn step(points: &[(f64, f64)]) -> Option<f64> {
    let exponential: Vec<(f64, f64)> = points.iter().map(|(knob, e)| (knob.exp(), *e)).collect();
    Power::through(&exponential).map(|fit| fit.slope.exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(errors: &[(f64, f64)]) -> Vec<Point> {
        let point = |(knob, rmse): &(f64, f64)| Point {
            knob: *knob,
            setting: String::new(),
            error: Errors {
                rmse: *rmse,
                ..Errors::default()
            },
            interior: *rmse,
            work: knob * knob,
        };
        errors.iter().map(point).collect()
    }

    fn series(law: Law) -> Series {
        Series {
            name: String::new(),
            settings: Vec::new(),
            law,
        }
    }

    #[test]
    fn slopes_prices_and_verdicts() {
        let law = Law::Power {
            low: 1.85,
            high: 2.15,
        };
        let square: Vec<_> = [8.0, 16.0, 32.0, 64.0].map(|n: f64| (n, n.powi(-2))).into();
        let found = curve(&series(law), points(&square));
        assert!((found.slope.expect("falls") - 2.0).abs() < 1e-9);
        assert_eq!(found.as_predicted, Some(true));
        // Error and work are inverse: a tenth of one costs ten times the other.
        assert!((found.price.expect("falls") - 10.0).abs() < 1e-9);
        let linear: Vec<_> = square.iter().map(|(n, _)| (*n, 1.0 / n)).collect();
        assert_eq!(
            curve(&series(law), points(&linear)).as_predicted,
            Some(false)
        );
    }

    #[test]
    fn steps_have_a_factor() {
        let halves: Vec<_> = (0..9).map(|d| (f64::from(d), 0.5f64.powi(d + 1))).collect();
        let found = curve(&series(Law::Step { factor: 0.5 }), points(&halves));
        assert!(
            (found.slope.expect("falls") - 0.5).abs() < 1e-9,
            "{found:?}"
        );
        assert_eq!(found.as_predicted, Some(true));
        let slow = curve(&series(Law::Step { factor: 0.4 }), points(&halves));
        assert_eq!(slow.as_predicted, Some(false));
    }
}
