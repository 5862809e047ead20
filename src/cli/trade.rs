//! `rastray trade`: speed against accuracy, measured, into a folder.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;
use rastray::error::Error;
use rastray::frame::Plane;
use rastray::import::Imported;
use rastray::lanes::Isa;
use rastray::report::files::{self, View};
use rastray::report::origin::{quoted, sets};
use rastray::report::trade::TradeReport;
use rastray::report::trade::notes::{found_note, left_note, settings};
use rastray::sampling::MAX_SAMPLES;
use rastray::scene::Scene;
use rastray::trade::choose::shrunk;
use rastray::trade::draw::Ready;
use rastray::trade::finding::{Trade, find};
use rastray::trade::journal::Journal;
use rastray::trade::run::{Options, Outcome, run};
use rastray::trade::truth::{IDEAL_SAMPLES, Truth};

use super::args::SceneArgs;
use super::options::{Verbosity, parse_size};
use super::progress::Progress;
use super::{commands, diagnostic, show, verify};

/// Pixels of the measured pictures where nobody says: 160 x 120 for most scenes.
const PIXELS: f64 = 19_200.0;
/// The longest budget: a week.
const LONGEST: f64 = 604_800.0;

/// Examples of the long help.
pub(super) const EXAMPLES: &str = "Examples:
  rastray trade whitted --open                whitted-trade/index.html after a minute
  rastray trade highlight --set raster.snap=12 -o fine
  rastray trade 15-mirror --budget 2 --json
  rastray trade --extremes                    what holds at the ends of the numbers, as a page

A run that is interrupted loses only the setting at hand: what is measured is kept in the folder's journal.jsonl, and the \
same command goes on from there. A changed scene, size or version starts again.

Exit codes: 0 done, 1 --extremes found a figure at fault, 2 error.";

#[derive(Debug, Args)]
pub(super) struct TradeArgs {
    // Optional, so that a mode that brings its own scenes can do without.
    /// A scene file (.toml, .scn, .obj), or the name of a shipped scene (see `rastray scenes`)
    #[arg(value_name = "SCENE")]
    pub(super) scene: Option<String>,
    /// Override a key of the scene file, such as material.red.shininess=64
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) sets: Vec<String>,
    /// Output folder (default: SCENE-trade)
    #[arg(short, long, value_name = "FOLDER")]
    pub(super) output: Option<PathBuf>,
    /// Size of the measured pictures in pixels (default: the scene's shape, about 160x120)
    #[arg(long, value_name = "WxH")]
    pub(super) size: Option<String>,
    /// Seconds to spend; another run with the same scene goes on where this one ends
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 60.0,
        allow_negative_numbers = true
    )]
    pub(super) budget: f64,
    /// Instead of a scene: shipped scenes with every input at its extremes, f32 against f64, into extremes/
    #[arg(long, conflicts_with_all = ["sets", "budget", "no_times", "verify", "ideal_samples"])]
    pub(super) extremes: bool,
    /// Samples of the ideal picture that samples are judged by
    #[arg(long, value_name = "N", default_value_t = IDEAL_SAMPLES, hide_short_help = true, help_heading = "Expert")]
    pub(super) ideal_samples: u32,
    /// Take no times: errors and exact counts only
    #[arg(long, hide_short_help = true, help_heading = "Expert")]
    pub(super) no_times: bool,
    /// Check each answer against the truth at other places: other seeds, twice the samples
    #[arg(long, hide_short_help = true, help_heading = "Expert")]
    pub(super) verify: bool,
    /// Show the page with the system's viewer
    #[arg(long)]
    pub(super) open: bool,
    /// Print trade.json, or extremes.json
    #[arg(long)]
    pub(super) json: bool,
}

impl TradeArgs {
    /// The scene as other commands take it.
    fn scene(&self) -> Result<SceneArgs, Error> {
        let scene = self.scene.clone().ok_or_else(|| {
            let error = Error::parameter("SCENE", "trade measures a scene, and none is named");
            error.with_help("rastray trade whitted")
        })?;
        Ok(SceneArgs {
            scene,
            sets: self.sets.clone(),
            strict_gl: false,
        })
    }

    fn options(&self) -> Result<Options, Error> {
        if !(self.budget > 0.0 && self.budget <= LONGEST) {
            let message = format!(
                "{}: expected seconds, more than 0, at most {LONGEST}",
                self.budget
            );
            return Err(Error::parameter("--budget", message));
        }
        if !(2..=MAX_SAMPLES).contains(&self.ideal_samples) {
            let message = format!("{}: expected 2 to {MAX_SAMPLES}", self.ideal_samples);
            return Err(Error::parameter("--ideal-samples", message));
        }
        Ok(Options {
            isa: Isa::detect(),
            budget: Duration::from_secs_f64(self.budget),
            ideal_samples: self.ideal_samples,
            times: !self.no_times,
        })
    }
}

/// Runs the command.
pub(super) fn trade(args: &TradeArgs, verbosity: Verbosity) -> Result<ExitCode, Error> {
    let scene_args = args.scene()?;
    let options = args.options()?;
    let mut imported = commands::load(&scene_args, &[], verbosity)?;
    match &args.size {
        Some(size) => {
            let (width, height) = parse_size(size)?;
            imported.resize(width, height);
        }
        None => {
            let image = shrunk(&imported.scene, PIXELS).image;
            imported.resize(image.width, image.height);
        }
    }
    let folder = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}-trade", imported.scene.name)));
    files::check_folder(&folder, "--output")?;
    files::create_folder(&folder)?;
    let (report, outcome) = measured(&scene_args, &imported, &options, &folder, verbosity)?;
    report.write(&folder)?;
    if args.verify {
        verify::print(&imported.scene, &report.trade, &outcome, &options)?;
    }
    finish(args, &report, &folder, verbosity)?;
    Ok(ExitCode::SUCCESS)
}

/// Measures what the folder's journal does not know, and gathers the report.
fn measured(
    scene_args: &SceneArgs,
    imported: &Imported,
    options: &Options,
    folder: &Path,
    verbosity: Verbosity,
) -> Result<(TradeReport, Outcome), Error> {
    let scene = &imported.scene;
    let mut journal = Journal::open(&folder.join("journal.jsonl"), scene, options.isa)?;
    let found = found_note(journal.found, folder);
    if let Some(note) = found.as_ref()
        && verbosity != Verbosity::Quiet
    {
        diagnostic::note(note);
    }
    // The number of steps is known once the first is heard of.
    let progress = std::cell::OnceCell::new();
    let step = |done: usize, all: usize, name: &str| {
        let bar = progress.get_or_init(|| Progress::new(verbosity, all as u64));
        bar.step(done as u64, name);
    };
    let outcome = run(scene, options, &mut journal, &step)?;
    let truth = Truth::Full.draw(scene, options.isa)?;
    let end = Truth::Full.end(scene, &truth, options.isa)?;
    let trade = find(
        scene,
        options.ideal_samples,
        end,
        options.isa,
        &outcome,
        &journal,
    );
    let answers = pictures(scene, &trade, &outcome, options.isa)?;
    drop(progress);
    let report = TradeReport {
        scene_arguments: quoted(&scene_args.scene) + &sets(&scene_args.sets),
        command: commands::command_line(),
        view: View::Linear,
        truth: to_f32(&truth.color),
        answers,
        notes: imported
            .notes
            .iter()
            .cloned()
            .chain(found)
            .chain(left_note(&trade.truth))
            .collect(),
        settings: settings(scene, options, &outcome, truth.depth),
        trade,
    };
    Ok((report, outcome))
}

/// The picture of each answer.
fn pictures(
    scene: &Scene,
    trade: &Trade,
    outcome: &Outcome,
    isa: Isa,
) -> Result<Vec<Option<Plane<[f32; 3]>>>, Error> {
    let draw = |row: Option<usize>| {
        let name = &trade.rows[row?].setting;
        let task = outcome
            .tasks
            .iter()
            .find(|t| t.setting.name(scene) == *name)?;
        Some(
            Ready::new(scene, &task.setting, isa)
                .draw()
                .map(|d| to_f32(&d.color)),
        )
    };
    trade
        .answers
        .iter()
        .map(|a| draw(a.row).transpose())
        .collect()
}

fn to_f32(plane: &Plane<[f64; 3]>) -> Plane<[f32; 3]> {
    plane.map(|c| c.map(|x| x as f32))
}

/// Tells the result.
fn finish(
    args: &TradeArgs,
    report: &TradeReport,
    folder: &Path,
    verbosity: Verbosity,
) -> Result<(), Error> {
    let page = folder.join("index.html");
    if args.json {
        commands::print(&report.to_json()?)?;
    } else if verbosity != Verbosity::Quiet {
        commands::print(&report.to_text())?;
    }
    verbosity.say(page.display());
    if args.open {
        show::open(&page);
    }
    Ok(())
}
