//! `rastray trade`: speed against accuracy, measured.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use rastray::error::Error;
use rastray::lanes::Isa;
use rastray::trade::accuracy::Accuracy;
use rastray::trade::draw::Job;
use rastray::trade::setting::{Renderer, Setting};
use rastray::trade::truth::{Truth, silhouette};

use super::args::SceneArgs;
use super::commands;
use super::extremes::extremes;
use super::options::Verbosity;

/// Examples of the long help.
pub(super) const EXAMPLES: &str = "Examples:
  rastray trade whitted --size 48x36 --budget 1
  rastray trade --extremes                    what holds at the ends of the numbers, as a page";

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
    /// Size of the pictures in pixels
    #[arg(long, value_name = "WxH")]
    pub(super) size: Option<String>,
    /// Seconds to spend; a run with the same scene goes on where the last one ended
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    pub(super) budget: f64,
    /// Instead of a scene: shipped scenes with every input at its extremes, f32 against f64, into extremes/
    #[arg(long, conflicts_with_all = ["scene", "sets", "budget"])]
    pub(super) extremes: bool,
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
}

/// Runs the command.
pub(super) fn trade(args: &TradeArgs, verbosity: Verbosity) -> Result<ExitCode, Error> {
    if args.extremes {
        let size = args.size.as_deref().map(super::options::parse_size);
        return extremes(args.output.as_deref(), size.transpose()?, verbosity);
    }
    let mut imported = commands::load(&args.scene()?, &[], verbosity)?;
    if let Some(size) = &args.size {
        let (width, height) = super::options::parse_size(size)?;
        imported.resize(width, height);
    }
    let scene = &imported.scene;
    let isa = Isa::detect();
    let truth = Truth::Full.draw(scene, isa)?;
    let mut text = String::new();
    for (_, renderer) in Renderer::NAMES {
        let setting = Setting::by(*renderer, scene);
        let drawn = Job::new(scene, &setting, isa).draw()?;
        let mask = silhouette(&drawn.object, &truth.object);
        let accuracy = Accuracy::of(&drawn.color, &truth.color, &mask, 0.0);
        text += &format!("{:30} rmse {:.3e}\n", setting.name(), accuracy.all.rmse);
    }
    commands::print(&text)?;
    Ok(ExitCode::SUCCESS)
}
