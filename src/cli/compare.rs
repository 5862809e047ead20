//! `rastray compare`: both pictures and every difference, into a folder.

use std::cell::Cell;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rastray::decompose::{self, Ladder, Views, decompose};
use rastray::error::Error;
use rastray::explain::Precision;
use rastray::lanes::Real;
use rastray::report::comparison::Comparison;
use rastray::report::files;
use rastray::report::{Report, causes, layered, layers};
use rastray::scene::Scene;

use super::args::{AgainstArg, CompareArgs, PrecisionArg};
use super::explain_line::explain_line;
use super::options::{Quality, Verbosity, apply, settings, view};
use super::progress::Progress;
use super::watch::{Made, follow};
use super::{commands, opengl};

/// Steps that progress hears of: those of the ladder, and the report.
const STEPS: u64 = 12;

/// Exit code 1 where a threshold was asked for and is exceeded.
pub(super) fn compare(args: &CompareArgs, verbosity: Verbosity) -> Result<ExitCode, Error> {
    let peer = args.against == AgainstArg::Opengl;
    if peer {
        opengl::check("--against opengl")?;
    }
    let lonely = [
        ("--driver-info", args.driver_info),
        ("--max-error", args.max_error.is_some()),
    ];
    if let Some((flag, _)) = lonely.into_iter().find(|(_, given)| *given && !peer) {
        let message = "compares with a driver, and there is none";
        return Err(Error::parameter(flag, message).with_help("add --against opengl"));
    }
    let over = Cell::new(false);
    follow(args.follow, &args.scene.scene, verbosity, || {
        if !peer {
            return once(args, verbosity);
        }
        let (made, exceeded) = opengl::compare(args, verbosity)?;
        over.set(exceeded);
        Ok(made)
    })?;
    Ok(ExitCode::from(u8::from(over.get())))
}

fn once(args: &CompareArgs, verbosity: Verbosity) -> Result<Made, Error> {
    let start = Instant::now();
    let mut imported = commands::load(&args.scene, &[], verbosity)?;
    let quality = apply(&args.quality, &mut imported)?;
    let path = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}-compare", imported.scene.name)));
    files::check_folder(&path, "--output")?;
    let options = ladder_options(args, &quality);
    let (progress, done) = (Progress::new(verbosity, STEPS), AtomicU64::new(0));
    let step = |name: &str| progress.step(done.fetch_add(1, Ordering::Relaxed), name);
    let (ladder, views) = match args.quality.precision {
        PrecisionArg::F32 => climb::<f32>(&imported.scene, &options, &step)?,
        PrecisionArg::F64 => climb::<f64>(&imported.scene, &options, &step)?,
    };
    let render_seconds = start.elapsed().as_secs_f64();
    step("figures and page");
    let comparison = Comparison {
        imported: &imported,
        ladder: &ladder,
        views: &views,
        options: &options,
        precision: match args.quality.precision {
            PrecisionArg::F32 => Precision::F32,
            PrecisionArg::F64 => Precision::F64,
        },
        view: view(&args.quality),
        command: commands::command_line(),
        explain: explain_line(args),
        settings: settings(&args.quality, &imported.scene, &quality),
        start,
        render_seconds,
    };
    let report = comparison.report()?;
    let exr = || layers::of(&ladder, &views, &imported.scene);
    let exr = || layered::exr(Some(&ladder.trace_color), report.view, &exr());
    let (layers, files) = rayon::join(exr, || report.files());
    let (layers, files) = (layers?, files?);
    files::create_folder(&path)?;
    files::write_bytes_atomic(&path.join("layers.exr"), &layers)?;
    Report::write_files(&path, &files)?;
    drop(progress);
    let page = path.join("index.html");
    let summary = &report.summary;
    let pixels = summary.size[0] * summary.size[1];
    let digest = causes::digest(summary.metrics.rmse, &summary.causes, pixels);
    verbosity.say(digest);
    verbosity.say(summary.as_seen());
    verbosity.say(page.display());
    if args.json {
        let text = report.summary.to_json();
        commands::print(&text.map_err(|e| Error::limit(format!("summary.json: {e}")))?)?;
    }
    Ok(Made {
        inputs: imported.files,
        result: page,
    })
}

fn ladder_options(args: &CompareArgs, quality: &Quality) -> decompose::Options {
    decompose::Options {
        level: quality.level,
        isa: quality.isa,
        model: quality.model,
        shadows: !args.quality.no_shadows,
        reflection: !args.quality.no_reflection,
        refraction: !args.quality.no_refraction,
    }
}

/// The ladder, and the views beside it.
fn climb<R: Real>(
    scene: &Scene,
    options: &decompose::Options,
    step: &(dyn Fn(&str) + Sync),
) -> Result<(Ladder, Views), Error> {
    let ladder = decompose::<R>(scene, options, step)?;
    let views = decompose::views::<R>(scene, options, &ladder, step)?;
    Ok((ladder, views))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rastray::import;

    #[test]
    fn the_number_of_steps_is_known() {
        let mut scene = import::load("two-sided", &import::LoadOptions::default())
            .expect("a shipped scene")
            .scene;
        (scene.image.width, scene.image.height) = (8, 6);
        let options = decompose::Options {
            level: Some(4),
            isa: rastray::lanes::Isa::detect(),
            model: rastray::scene::requirements::Model::Required,
            shadows: true,
            reflection: true,
            refraction: true,
        };
        let heard = AtomicU64::new(0);
        let step = |_: &str| {
            heard.fetch_add(1, Ordering::Relaxed);
        };
        decompose::<f32>(&scene, &options, &step).expect("climbs");
        // The views beside the ladder, and the report, are the steps after the ladder's.
        assert_eq!(heard.into_inner() + 2, STEPS);
    }
}
