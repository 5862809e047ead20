//! `rastray compare`: both pictures and every difference, into a folder.

use std::cell::Cell;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rastray::decompose::{self, decompose};
use rastray::error::Error;
use rastray::report::comparison::Comparison;
use rastray::report::files;
use rastray::report::{Report, causes, layered, layers, origin};

use super::args::{AgainstArg, CompareArgs};
use super::explain_line::explain_line;
use super::options::{Verbosity, apply, view};
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
    let options = apply(&args.quality, &mut imported)?;
    let path = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}-compare", imported.scene.name)));
    files::check_folder(&path, "--output")?;
    let (progress, done) = (Progress::new(verbosity, STEPS), AtomicU64::new(0));
    let step = |name: &str| progress.step(done.fetch_add(1, Ordering::Relaxed), name);
    let ladder = decompose(&imported.scene, &options, &step)?;
    let views = decompose::views(&imported.scene, &options, &ladder, &step)?;
    let render_seconds = start.elapsed().as_secs_f64();
    step("figures and page");
    let comparison = Comparison {
        imported: &imported,
        ladder: &ladder,
        views: &views,
        options: &options,
        view: view(&args.quality),
        command: commands::command_line(),
        explain: explain_line(args),
        settings: origin::settings(&imported.scene, &options),
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

#[cfg(test)]
mod tests {
    use super::*;
    use rastray::import;
    use rastray::render::Options;

    #[test]
    fn the_number_of_steps_is_known() {
        let mut scene = import::load("two-sided", &import::LoadOptions::default())
            .expect("a shipped scene")
            .scene;
        (scene.image.width, scene.image.height) = (8, 6);
        let options = Options {
            level: Some(4),
            ..Options::default()
        };
        let heard = AtomicU64::new(0);
        let step = |_: &str| {
            heard.fetch_add(1, Ordering::Relaxed);
        };
        decompose(&scene, &options, &step).expect("climbs");
        // The views beside the ladder, and the report, are the steps after the ladder's.
        assert_eq!(heard.into_inner() + 2, STEPS);
    }
}
