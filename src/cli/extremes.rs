//! `rastray trade --extremes`: the atlas of shipped scenes at the ends of every input.

use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};

use rastray::error::Error;
use rastray::report::{atlas, files};
use rastray::trade::extremes::{self, Options};

use super::commands::command_line;
use super::options::{Verbosity, parse_size};
use super::progress::Progress;
use super::trade::TradeArgs;
use super::{commands, show};

/// Draws the atlas into a folder. Exit code 1 where a figure is the program's fault.
pub(super) fn extremes(args: &TradeArgs, verbosity: Verbosity) -> Result<ExitCode, Error> {
    if let Some(scene) = &args.scene {
        let message = format!("brings its own scenes: leave out {scene}");
        return Err(Error::parameter("--extremes", message));
    }
    let size = args.size.as_deref().map(parse_size).transpose()?;
    let folder = args.output.as_deref().unwrap_or(Path::new("extremes"));
    files::check_folder(folder, "--output")?;
    let mut options = Options::default();
    if let Some((width, height)) = size {
        (options.width, options.height) = (width, height);
    }
    let progress = Progress::new(verbosity, extremes::cell_count(&options) as u64);
    let done = AtomicU64::new(0);
    let step = |name: &str| progress.step(done.fetch_add(1, Ordering::Relaxed), name);
    let drawn = extremes::atlas(&options, &step)?;
    drop(progress);
    let written = atlas::files(&drawn, &command_line())?;
    files::create_folder(folder)?;
    for file in &written {
        files::write_bytes_atomic(&folder.join(&file.name), &file.bytes)?;
    }
    if args.json {
        commands::print(&atlas::json(&drawn)?)?;
    } else if verbosity != Verbosity::Quiet {
        commands::print(&(atlas::summary(&drawn) + "\n"))?;
    }
    let page = folder.join("index.html");
    verbosity.say(page.display());
    if args.open {
        show::open(&page);
    }
    let fault = drawn
        .cells()
        .any(|(_, cell)| cell.figures().iter().any(|(_, f)| f.fault(cell.bar)));
    Ok(ExitCode::from(u8::from(fault)))
}
