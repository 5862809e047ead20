//! `rastray check`: somebody's own picture of a scene, right or explained by a mistake.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use rastray::check::{self, Given, Mode, Options, Report, Verdict};
use rastray::error::Error;
use rastray::import::{self, Imported, picture};
use rastray::render::{self, Renderer};
use rastray::report::checked::{Asked, Checked};
use rastray::report::files;
use rastray::report::formats::png_of_picture;
use rastray::report::origin::quoted;

use super::args::{QualityArgs, SceneArgs, ShadingArg, renderer};
use super::options::{Verbosity, apply};
use super::progress::Progress;
use super::{commands, diagnostic};

pub(super) const EXAMPLES: &str = "Examples:
  rastray render whitted -o mine.png --mode trace --size 160x120
  rastray check whitted mine.png              right or not, and why
  rastray check whitted mine.png --mode trace -o strip.png
  rastray check whitted mine.png --json

Exit codes: 0 the picture is right, 1 it is not, 2 error.";

#[derive(Debug, Args)]
// Parsed only to be refused with a reason.
#[command(mut_arg("size", |size| size.hide(true)))]
pub(super) struct CheckArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// The picture: PNG, JPEG, BMP, PPM, PGM, PFM, HDR or OpenEXR; the scene is drawn at its size
    #[arg(value_name = "IMAGE")]
    pub(super) image: PathBuf,
    /// What the picture is meant to be: raster, cast, trace (default: found by looking)
    #[arg(long, value_parser = renderer(), value_name = "MODE", hide_possible_values = true)]
    pub(super) mode: Option<Renderer>,
    /// Given, with the mistake, right, and their differences: one .png, or a folder
    #[arg(short, long, value_name = "PATH")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    pub(super) quality: QualityArgs,
    /// Print the report as JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Exit code 0 where the picture is right, else 1.
pub(super) fn check(args: &CheckArgs, verbosity: Verbosity) -> Result<ExitCode, Error> {
    refuse(args)?;
    check_output(args.output.as_deref())?;
    let file = picture::read(&args.image, None)?;
    for note in file.notes.iter().filter(|_| verbosity != Verbosity::Quiet) {
        diagnostic::note(note);
    }
    let given = Given::from(file);
    let mut imported = commands::load(&args.scene, &[], verbosity)?;
    imported.resize(given.color.width as u32, given.color.height as u32);
    let render = apply(&args.quality, &mut imported)?;
    let options = options(args, render);
    let report = checked(&imported, &given, &options, verbosity)?;
    let both = Checked {
        report: &report,
        given: &given,
        asked: Asked {
            image: &args.image,
            scene: &args.scene.scene,
            sets: &args.scene.sets,
            mode: args.mode.is_some(),
            shading: args.quality.shading.is_some(),
        },
    };
    if let Some(path) = &args.output {
        write(path, &both)?;
    }
    if args.json {
        commands::print_json(&both.to_json())?;
    } else {
        let columns = diagnostic::width(std::io::stdout())
            .unwrap_or(100)
            .clamp(60, 100);
        commands::print(&both.to_text(columns))?;
    }
    if let Some(path) = &args.output {
        verbosity.say(path.display());
    }
    Ok(ExitCode::from(u8::from(report.verdict != Verdict::Right)))
}

/// What is asked for in vain, and a picture and a scene that have changed places.
fn refuse(args: &CheckArgs) -> Result<(), Error> {
    if args.quality.size.is_some() {
        let message = "the scene is drawn at the size of the picture";
        return Err(Error::parameter("--size", message).with_help("leave it out"));
    }
    let rays = match args.mode {
        Some(by @ (Renderer::Cast | Renderer::Trace)) => Some(by.name()),
        Some(Renderer::Raster) | None => None,
    };
    if let (Some(rays), Some(_)) = (rays, args.quality.shading) {
        let message = format!("a shading is the rasterizer's, and --mode {rays} asks for rays");
        let help = "leave out one of the two, or say --mode raster";
        return Err(Error::parameter("--shading", message).with_help(help));
    }
    let image = args.image.to_string_lossy();
    let is_scene = import::shipped().iter().any(|s| s.name == image);
    if is_scene && !args.image.is_file() {
        let message = format!("{image}: there is no such file, but a scene of that name");
        let scene = quoted(&args.scene.scene);
        let help = format!("the scene comes first: rastray check {image} {scene}");
        return Err(Error::parameter("IMAGE", message).with_help(help));
    }
    Ok(())
}

fn is_png(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("png"))
}

/// Endings of pictures and pages: a folder that is to be made is hardly meant to have one.
const OTHER_ENDINGS: [&str; 17] = [
    "jpg", "jpeg", "bmp", "ppm", "pgm", "pnm", "pfm", "hdr", "exr", "gif", "tif", "tiff", "webp",
    "svg", "html", "htm", "pdf",
];

/// `-`, or what is named like a file that `check` does not write.
fn is_other_file(path: &Path) -> bool {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    path.as_os_str() == "-" || ending.is_some_and(|e| OTHER_ENDINGS.contains(&e.as_str()))
}

fn check_output(output: Option<&Path>) -> Result<(), Error> {
    match output {
        None => Ok(()),
        Some(path) if is_png(path) => files::check_target(path, "--output"),
        Some(path) if is_other_file(path) && !path.is_dir() => {
            let expected = "expected a .png file or the name of a folder";
            let message = format!("{}: {expected}", path.display());
            Err(Error::parameter("--output", message).with_help("for example -o check.png"))
        }
        Some(path) => files::check_folder(path, "--output"),
    }
}

fn options(args: &CheckArgs, render: render::Options) -> Options {
    let shaded = |mode: &Mode| match args.quality.shading {
        None => true,
        Some(shading) => {
            *mode
                == match shading {
                    ShadingArg::Flat => Mode::Flat,
                    ShadingArg::Gouraud => Mode::Gouraud,
                    ShadingArg::Phong => Mode::Phong,
                }
        }
    };
    let meant = |mode: &Mode| match args.mode {
        // A shading is the rasterizer's.
        None => args.quality.shading.is_none() || mode.shading().is_some(),
        Some(by) => mode.renderer() == by,
    };
    let wanted = |mode: &Mode| meant(mode) && (mode.shading().is_none() || shaded(mode));
    Options {
        modes: Mode::ALL.into_iter().filter(wanted).collect(),
        render,
        srgb: args.quality.srgb,
    }
}

fn checked(
    imported: &Imported,
    given: &Given,
    options: &Options,
    verbosity: Verbosity,
) -> Result<Report, Error> {
    // The bar learns its length from the first step.
    let bar = std::sync::OnceLock::new();
    let progress = |done: u64, steps: u64, name: &str| {
        bar.get_or_init(|| Progress::new(verbosity, steps))
            .step(done, name);
    };
    check::check(&imported.scene, given, options, &progress)
}

fn write(path: &Path, both: &Checked<'_>) -> Result<(), Error> {
    if is_png(path) {
        return files::write_bytes_atomic(path, &png_of_picture(&both.strip()?)?);
    }
    let made = both.files()?;
    files::create_folder(path)?;
    made.iter()
        .try_for_each(|file| files::write_bytes_atomic(&path.join(&file.name), &file.bytes))
}
