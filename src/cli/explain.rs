//! `rastray explain SCENE X Y`: why one pixel has its colour, in both renderers.

use std::path::{Path, PathBuf};

use clap::Args;
use rastray::error::{Error, Note};
use rastray::explain::{Explanation, Setting};
use rastray::render::Options;
use rastray::report::files;
use rastray::report::pixel::{Layout, figure, paths, text};
use rastray::scene::Scene;
use rastray::trace::Geometry;

use super::args::{FollowArgs, QualityArgs, SceneArgs, geometry};
use super::options::{Verbosity, apply};
use super::watch::{Made, follow};
use super::{commands, diagnostic};

pub(super) const EXAMPLES: &str = "Examples:
  rastray explain whitted 230 280             the equation with its numbers, and the ray tree
  rastray explain whitted 230 280 -o tree.svg     the rays in a side view, and the tree beside it
  rastray explain whitted 230 280 -o rays.obj     the ray paths, for a modelling program
  rastray explain lights 320 300 --shading phong --json
  rastray explain 18-total-reflection 60 70 --size 320x240 --set trace.tir=\"reflect\"

X and Y count from the top left. The text on a terminal has colours; -v gives every ray of a large tree a line.
The equation itself, thirty lines to read beside the specification: src/lighting/plain.rs.";

#[derive(Debug, Args)]
pub(super) struct ExplainArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Column of the pixel, from 0 at the left
    #[arg(value_name = "X")]
    x: u32,
    /// Row of the pixel, from 0 at the top
    #[arg(value_name = "Y")]
    y: u32,
    /// Draw the rays instead: .svg (side view and ray tree) or .obj (ray paths)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    quality: QualityArgs,
    /// What the tracer traces: exact shapes, or the rasterizer's triangles
    #[arg(
        long,
        value_parser = geometry(),
        default_value = "exact",
        value_name = "GEOMETRY",
        hide_short_help = true,
        help_heading = "Expert"
    )]
    geometry: Geometry,
    #[command(flatten)]
    follow: FollowArgs,
    /// Print the explanation as JSON, with exact numbers
    #[arg(long)]
    json: bool,
}

/// What `-o` asks for.
#[derive(Clone, Copy)]
enum Kind {
    Figure,
    Paths,
}

pub(super) fn explain(args: &ExplainArgs, verbosity: Verbosity) -> Result<(), Error> {
    // A wrong output name is said before the work, not after it.
    let kind = args.output.as_deref().map(kind).transpose()?;
    if let Some(path) = &args.output {
        files::check_target(path, "--output")?;
    } else if args.follow.open {
        let message = "there is no file to show";
        return Err(Error::parameter("--open", message).with_help("add -o tree.svg"));
    }
    if args.quality.srgb && verbosity != Verbosity::Quiet {
        let message = "--srgb encodes pictures; the numbers here are linear".to_owned();
        diagnostic::note(&Note {
            place: None,
            message,
        });
    }
    follow(args.follow, &args.scene.scene, verbosity, || {
        once(args, kind, verbosity)
    })
}

/// The kind of file that a name asks for.
fn kind(path: &Path) -> Result<Kind, Error> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("svg") => Ok(Kind::Figure),
        Some("obj") => Ok(Kind::Paths),
        _ => {
            let message = format!(
                "{}: expected a name that ends in .svg or .obj",
                path.display()
            );
            Err(Error::parameter("--output", message).with_help("for text, give no -o"))
        }
    }
}

fn once(args: &ExplainArgs, kind: Option<Kind>, verbosity: Verbosity) -> Result<Made, Error> {
    let mut imported = commands::load(&args.scene, &[], verbosity)?;
    let options = apply(&args.quality, &mut imported)?;
    let scene = &imported.scene;
    // A pixel outside is said before the work.
    let [x, y] = scene.image.check_pixel([args.x, args.y])?;
    let options = Options {
        geometry: args.geometry,
        ..options
    };
    let setting = Setting::new(scene, options)?;
    let explanation = setting.explainer()?.at(x, y)?;
    if let (Some(path), Some(kind)) = (&args.output, kind) {
        draw(path, kind, scene, &explanation)?;
        verbosity.say(path.display());
    }
    if args.json {
        let value = serde_json::to_value(&explanation);
        commands::print_json(&value.map_err(|e| Error::limit(format!("--json: {e}")))?)?;
    } else if kind.is_none() {
        let layout = Layout {
            width: diagnostic::width(std::io::stdout()),
            all_rays: verbosity == Verbosity::Verbose,
        };
        commands::print(&text(scene, &explanation, layout))?;
    }
    Ok(Made {
        inputs: imported.files,
        result: args.output.clone().unwrap_or_default(),
    })
}

fn draw(path: &Path, kind: Kind, scene: &Scene, explanation: &Explanation) -> Result<(), Error> {
    let text = match kind {
        Kind::Figure => figure(scene, explanation),
        Kind::Paths => paths(explanation),
    };
    files::write_bytes_atomic(path, text.as_bytes())
}
