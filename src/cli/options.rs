//! Raw flags to validated library options.

use rastray::error::Error;
use rastray::gl::ShadeModel;
use rastray::import::{Imported, MAX_PIXELS, MAX_SIDE};
use rastray::lanes::Isa;
use rastray::report::files::View;
use rastray::report::origin;
use rastray::sampling::MAX_SAMPLES;
use rastray::scene::requirements::Model;
use rastray::scene::tessellate::LEVELS;
use rastray::scene::{Scene, Snap};

use super::args::{ModelArg, PrecisionArg, QualityArgs, ShadingArg};

/// How much to say on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verbosity {
    /// Errors only.
    Quiet,
    /// Notes and results.
    Normal,
    /// Each step.
    Verbose,
}

impl Verbosity {
    pub(crate) fn new(quiet: bool, verbose: bool) -> Self {
        match (quiet, verbose) {
            (true, _) => Self::Quiet,
            (_, true) => Self::Verbose,
            _ => Self::Normal,
        }
    }

    /// Says a line unless quiet.
    pub(crate) fn say(self, line: impl std::fmt::Display) {
        if self != Self::Quiet {
            anstream::eprintln!("{line}");
        }
    }

    /// Says a line if verbose.
    pub(crate) fn step(self, line: &str) {
        if self == Self::Verbose {
            anstream::eprintln!("{line}");
        }
    }
}

/// Runs the work on a pool of `threads` workers (one a core where `None`).
pub(crate) fn in_pool<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> Result<T, Error> + Send,
) -> Result<T, Error> {
    const MOST: usize = 1024;
    if let Some(n) = threads.filter(|n| !(1..=MOST).contains(n)) {
        let error = Error::parameter("--threads", format!("{n}: expected 1 to {MOST}"));
        return Err(error.with_help("leave it out for one worker a core"));
    }
    // 0 lets the pool choose.
    let threads = threads.unwrap_or(0);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| Error::limit(format!("cannot start the worker threads: {e}")))?;
    pool.install(work)
}

/// What the quality flags say beyond the scene itself.
#[derive(Clone, Debug)]
pub(crate) struct Quality {
    pub(crate) level: Option<u32>,
    pub(crate) isa: Isa,
    pub(crate) model: Model,
}

/// Writes the flags into the scene and returns the rest.
pub(crate) fn apply(args: &QualityArgs, imported: &mut Imported) -> Result<Quality, Error> {
    if let Some(size) = &args.size {
        let (width, height) = parse_size(size)?;
        imported.resize(width, height);
    }
    let scene = &mut imported.scene;
    if let Some(samples) = args.samples {
        if !(1..=MAX_SAMPLES).contains(&samples) {
            let message = format!("{samples}: expected 1 to {MAX_SAMPLES}");
            return Err(Error::parameter("--samples", message));
        }
        scene.image.samples = samples;
    }
    if let Some(shading) = args.shading {
        scene.raster.shading = match shading {
            ShadingArg::Flat => ShadeModel::Flat,
            ShadingArg::Gouraud => ShadeModel::Gouraud,
            ShadingArg::Phong => ShadeModel::Phong,
        };
    }
    if let Some(depth) = args.depth {
        scene.trace.depth = depth;
    }
    if let Some(snap) = &args.snap {
        let found = Snap::NAMES.iter().find(|(name, _)| name == snap);
        scene.raster.snap = match found {
            Some((_, value)) => *value,
            None => {
                let message = format!("{snap}: expected 8, 12 or exact");
                return Err(Error::parameter("--snap", message));
            }
        };
    }
    if let Some(level) = args.tessellation.filter(|level| !LEVELS.contains(level)) {
        let message = format!("{level}: expected {} to {}", LEVELS.start(), LEVELS.end());
        return Err(Error::parameter("--tessellation", message));
    }
    let isa = match &args.isa {
        Some(name) => parse_isa(name)?,
        None => Isa::detect(),
    };
    let model = match args.model {
        ModelArg::Required => Model::Required,
        ModelArg::Full => Model::Full,
    };
    Ok(Quality {
        level: args.tessellation,
        isa,
        model,
    })
}

/// What was rendered how, for pages.
pub(super) fn settings(
    args: &QualityArgs,
    scene: &Scene,
    quality: &Quality,
) -> Vec<(String, String)> {
    let precision = match args.precision {
        PrecisionArg::F32 => "f32",
        PrecisionArg::F64 => "f64",
    };
    origin::settings(scene, quality.level, precision, quality.isa)
}

/// How linear values are stored in viewable files.
pub(super) fn view(args: &QualityArgs) -> View {
    if args.srgb { View::Srgb } else { View::Linear }
}

/// The width and height that `--size` asks for.
pub(super) fn parse_size(text: &str) -> Result<(u32, u32), Error> {
    let wrong = || {
        let message = format!("{text}: expected WIDTHxHEIGHT, each 1 to {MAX_SIDE}");
        Error::parameter("--size", message).with_help("for example --size 640x480")
    };
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let side = |s: &str| s.parse::<u32>().ok().filter(|n| (1..=MAX_SIDE).contains(n));
    let (width, height) = side(width).zip(side(height)).ok_or_else(wrong)?;
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(Error::parameter(
            "--size",
            format!("{text}: more than {MAX_PIXELS} pixels"),
        ));
    }
    Ok((width, height))
}

fn parse_isa(name: &str) -> Result<Isa, Error> {
    let available = Isa::available();
    let names: Vec<&str> = available.iter().map(|isa| isa.name()).collect();
    Isa::from_name(name)
        .filter(|isa| available.contains(isa))
        .ok_or_else(|| {
            let message = format!("{name}: not available here");
            Error::parameter("--isa", message)
                .with_help(format!("this machine has {}", names.join(", ")))
        })
}
