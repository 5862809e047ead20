//! `--open`: a result in the system's viewer.
//!
//! The viewer is started by the system's own command (`xdg-open`, `open`, `start`), detached, and never waited for longer
//! than it takes to fail. The files are written by then, so nothing here fails a run: a viewer that does not start is a
//! note with the path.

use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use rastray::error::Note;

use super::diagnostic;

/// How long a viewer has to say that it cannot start.
const PATIENCE: Duration = Duration::from_millis(400);

/// The command that shows a file as a double click would.
fn viewer(path: &Path) -> Command {
    let mut command = if cfg!(target_os = "macos") {
        Command::new("open")
    } else if cfg!(windows) {
        let mut command = Command::new("cmd");
        // The empty string is the window's title.
        command.args(["/c", "start", ""]);
        command
    } else {
        Command::new("xdg-open")
    };
    command
        .arg(path)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    #[cfg(unix)]
    {
        // A group of its own: Ctrl-C ends a watch, not the viewer.
        use std::os::unix::process::CommandExt;
        command.process_group(0);
    }
    command
}

/// Shows a file; says so if that is not possible.
pub(super) fn open(path: &Path) {
    // An absolute path cannot be taken for a flag.
    let full = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let mut command = viewer(&full);
    let name = command.get_program().to_string_lossy().into_owned();
    let trouble = match command.spawn() {
        Ok(mut child) => match ended(&mut child) {
            Some(status) if !status.success() => format!("{name} found no viewer ({status})"),
            _ => return,
        },
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => format!("{name} is not installed"),
        Err(e) => format!("{name}: {e}"),
    };
    diagnostic::note(&Note {
        place: None,
        message: format!("--open: {trouble}; the result is {}", path.display()),
    });
}

/// How the command ended, if it did soon.
fn ended(child: &mut Child) -> Option<ExitStatus> {
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        if let Ok(Some(status)) = child.try_wait() {
            return Some(status);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    None
}
