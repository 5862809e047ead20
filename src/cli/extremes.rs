//! `rastray trade --extremes`: the atlas of shipped scenes at the ends of every input.

use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};

use rastray::error::Error;
use rastray::report::{atlas, files};
use rastray::trade::extremes::{self, Options};

use super::compare::command_line;
use super::options::Verbosity;
use super::progress::Progress;

/// Draws the atlas into a folder. Exit code 1 where a figure is the program's fault.
pub(super) fn extremes(
    output: Option<&Path>,
    size: Option<(u32, u32)>,
    verbosity: Verbosity,
) -> Result<ExitCode, Error> {
    let folder = output.unwrap_or(Path::new("extremes"));
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
    verbosity.say(folder.join("index.html").display());
    let fault = drawn
        .cells()
        .any(|(_, cell)| cell.figures().iter().any(|(_, f)| f.fault(cell.bar)));
    Ok(ExitCode::from(u8::from(fault)))
}
