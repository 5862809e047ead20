//! A trade: truths, settings, times, within a budget, going on where the last run ended.
//!
//! The order of the work: axes one by one (each draws its truth when its first setting is due), then the grid, then times, those on the
//! front first. A render that has begun is finished, and so are the settings of the ideal truth once that is
//! drawn; otherwise nothing begins after the budget is spent. Everything that was measured is in the journal by then.
//!
//! Times are taken on one thread, warm, and every run must leave the same bytes as the first.

use std::time::{Duration, Instant};

use super::axis::{Axis, axes, grid};
use super::draw::Ready;
use super::front::front;
use super::journal::{Journal, Timed};
use super::measure::{Judge, Measured, key};
use super::setting::Setting;
use super::timing::{FEWEST, ROUNDS, Ratio, rounds};
use super::truth::Truth;
use crate::error::Error;
use crate::lanes::Isa;
use crate::scene::Scene;

/// How to run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Instruction set.
    pub isa: Isa,
    /// Time to spend.
    pub budget: Duration,
    /// Samples of the ideal picture.
    pub ideal_samples: u32,
    /// Whether times are taken at all; counts and errors always are.
    pub times: bool,
}

/// Share of the budget that errors and counts may take while times are wanted.
const FOR_ERRORS: f64 = 0.7;

/// A setting to measure, and by which truths.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// The setting.
    pub setting: Setting,
    /// The truths.
    pub truths: Vec<Truth>,
}

/// Every setting of a scene once, in the order of the work.
pub fn tasks(scene: &Scene, axes: &[Axis]) -> Vec<Task> {
    let mut all: Vec<Task> = Vec::new();
    let mut add = |setting: Setting, truth: Truth| match all
        .iter_mut()
        .find(|task| task.setting == setting)
    {
        Some(task) if task.truths.contains(&truth) => {}
        Some(task) => task.truths.push(truth),
        None => all.push(Task {
            setting,
            truths: vec![truth],
        }),
    };
    for axis in axes {
        for (_, setting) in axis.series.iter().flat_map(|s| &s.settings) {
            let setting = setting.plain(scene);
            add(setting, axis.truth);
            // What lies at pixel centres can be on the front, too.
            if !matches!(axis.truth, Truth::Ideal(_)) {
                add(setting, Truth::Full);
            }
        }
    }
    for setting in grid(scene) {
        add(setting, Truth::Full);
    }
    // The ideal truth costs hundreds of pictures: what needs it comes last.
    all.sort_by_key(Task::is_ideal);
    all
}

impl Task {
    fn is_ideal(&self) -> bool {
        self.truths.iter().any(|t| matches!(t, Truth::Ideal(_)))
    }

    /// Whether a measurement has an error for every truth.
    fn done(&self, measured: Option<&Measured>) -> bool {
        measured.is_some_and(|m| self.truths.iter().all(|t| m.against(*t).is_some()))
    }
}

/// What a run leaves beside the journal.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The axes of the scene.
    pub axes: Vec<Axis>,
    /// Every setting, measured or not.
    pub tasks: Vec<Task>,
    /// How many are measured.
    pub measured: usize,
    /// Settings whose time was asked, and those that have one from 31 rounds.
    pub timed: [usize; 2],
}

/// Measures what the journal does not know yet. `progress` hears how many steps are done, of how many, and what comes next.
///
/// # Errors
/// What the renderers refuse; [`Error::Io`] where the journal cannot be written.
pub fn run(
    scene: &Scene,
    options: &Options,
    journal: &mut Journal,
    progress: &dyn Fn(usize, usize, &str),
) -> Result<Outcome, Error> {
    let start = Instant::now();
    let axes = axes(scene, options.ideal_samples);
    let tasks = tasks(scene, &axes);
    let share = if options.times { FOR_ERRORS } else { 1.0 };
    let spent = |share: f64| start.elapsed().as_secs_f64() >= share * options.budget.as_secs_f64();
    let mut judge = Judge::new(scene, options.isa);
    let steps = tasks.len() * if options.times { 2 } else { 1 };
    let (mut measured, mut fresh) = (0, 0);
    for (i, task) in tasks.iter().enumerate() {
        if task.done(journal.measurement(&key(&task.setting))) {
            measured += 1;
            continue;
        }
        let begun = task.truths.iter().all(|t| judge.has(*t)) && task.is_ideal();
        // However small the budget, a run gets one setting further.
        if fresh > 0 && spent(share) && !begun {
            continue;
        }
        progress(i, steps, &task.setting.name(scene));
        journal.keep(judge.measure(&task.setting, &task.truths)?)?;
        (measured, fresh) = (measured + 1, fresh + 1);
    }
    let mut timed = [0; 2];
    if options.times {
        let chosen = to_time(&tasks, journal);
        timed = time(scene, options, &chosen, journal, &|i, name| {
            progress(tasks.len() + i, steps, name);
            start.elapsed().as_secs_f64() / options.budget.as_secs_f64()
        })?;
    }
    Ok(Outcome {
        axes,
        tasks,
        measured,
        timed,
    })
}

/// Error and cost of what can be rendered and was measured against the full truth: (position in `tasks`, work, rmse).
pub fn points(tasks: &[Task], journal: &Journal) -> Vec<(usize, f64, f64)> {
    let point = |(i, task): (usize, &Task)| {
        let measured = journal.measurement(&key(&task.setting))?;
        if !task.setting.is_offered() {
            return None;
        }
        let accuracy = measured.against(Truth::Full)?;
        let work = measured.counts.work(task.setting.precision);
        Some((i, work, accuracy.all.rmse))
    };
    tasks.iter().enumerate().filter_map(point).collect()
}

/// Positions in `tasks` of the settings on the front, by work and rmse against the full truth.
pub fn on_front(tasks: &[Task], journal: &Journal) -> Vec<usize> {
    let points = points(tasks, journal);
    let plain: Vec<(f64, f64)> = points
        .iter()
        .map(|(_, work, error)| (*work, *error))
        .collect();
    let on = front(&plain);
    points
        .iter()
        .zip(on)
        .filter(|(_, on)| *on)
        .map(|((i, ..), _)| *i)
        .collect()
}

/// Measured settings whose time is not known from enough rounds: those on the front, then the others.
fn to_time(tasks: &[Task], journal: &Journal) -> Vec<Setting> {
    let front = on_front(tasks, journal);
    let others = (0..tasks.len()).filter(|i| !front.contains(i));
    let order = front.iter().copied().chain(others);
    let wanted = |i: &usize| {
        let key = key(&tasks[*i].setting);
        let known = journal.time(&key).map_or(0, |ratio| ratio.rounds);
        journal.measurement(&key).is_some() && known < ROUNDS
    };
    order.filter(wanted).map(|i| tasks[i].setting).collect()
}

/// Takes times against the base setting, each with an equal share of what is left of the budget. `spent` hears how many are
/// done and what comes next, and answers how much of the budget is gone. Returns how many were asked and how many have
/// all rounds.
fn time(
    scene: &Scene,
    options: &Options,
    settings: &[Setting],
    journal: &mut Journal,
    spent: &dyn Fn(usize, &str) -> f64,
) -> Result<[usize; 2], Error> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .map_err(|e| Error::limit(format!("cannot start a worker thread: {e}")))?;
    let base = Ready::new(scene, &Setting::of(scene).plain(scene), options.isa);
    let mut complete = 0;
    for (i, setting) in settings.iter().enumerate() {
        let name = format!("time of {}", setting.name(scene));
        let gone = spent(i, &name);
        if gone >= 1.0 {
            break;
        }
        let share = (1.0 - gone) / (settings.len() - i) as f64 * options.budget.as_secs_f64();
        let job = Ready::new(scene, setting, options.isa);
        let begun = Instant::now();
        let done = pool.install(|| {
            let (mut a, mut b) = (Clocked::new(&base), Clocked::new(&job));
            // Warm, and the bytes that every run must leave; a setting that takes its whole share for this has no time.
            a.run()?;
            b.run()?;
            let once = begun.elapsed().as_secs_f64();
            let fits = share > 2.0 * once * (FEWEST + 1) as f64;
            let most = if fits { ROUNDS } else { 0 };
            rounds(
                most,
                || a.run(),
                || b.run(),
                |done| done < FEWEST || begun.elapsed().as_secs_f64() < share,
            )
        })?;
        if let Some(ratio) = Ratio::of(&done) {
            complete += usize::from(ratio.rounds >= ROUNDS);
            let setting = key(setting);
            journal.keep_time(Timed { setting, ratio })?;
        }
    }
    Ok([settings.len(), complete])
}

/// A job with the checksum of its first run.
struct Clocked<'a> {
    job: &'a Ready,
    checksum: Option<u64>,
}

impl<'a> Clocked<'a> {
    fn new(job: &'a Ready) -> Self {
        Self {
            job,
            checksum: None,
        }
    }

    /// Runs once; the seconds.
    fn run(&mut self) -> Result<f64, Error> {
        let (seconds, checksum) = self.job.clock()?;
        let first = *self.checksum.get_or_insert(checksum);
        if first == checksum {
            return Ok(seconds);
        }
        Err(
            Error::limit("two runs of one setting left different bytes, so no time is told")
                .with_help("this is a fault of rastray: please report it with the scene"),
        )
    }
}
