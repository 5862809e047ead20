//! A progress bar on standard error: only on a terminal, only after half a second, never with `-q` or `-v`.

use std::io::{IsTerminal, stderr};
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::options::Verbosity;

/// Work that is shorter shows nothing.
const DELAY: Duration = Duration::from_millis(500);

/// What is being done, and how far it is.
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    verbosity: Verbosity,
}

impl Progress {
    /// Progress over a number of steps; over one, a spinner.
    pub(super) fn new(verbosity: Verbosity, steps: u64) -> Self {
        let shown = verbosity == Verbosity::Normal && stderr().is_terminal();
        let bar = shown.then(|| bar(steps));
        Self { bar, verbosity }
    }

    /// Says that step number `done` (from 0) begins; with `-v` as a line.
    pub(super) fn step(&self, done: u64, name: &str) {
        self.verbosity.step(name);
        if let Some(bar) = &self.bar {
            bar.set_position(done);
            bar.set_message(name.to_owned());
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A bar that appears after the delay.
fn bar(steps: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::hidden());
    let template = if steps > 1 {
        "{spinner} {bar:24} {pos}/{len}  {msg}  {elapsed}"
    } else {
        "{spinner} {msg}  {elapsed}"
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    let late = bar.clone();
    thread::spawn(move || {
        thread::sleep(DELAY);
        if !late.is_finished() {
            late.set_draw_target(ProgressDrawTarget::stderr());
            late.enable_steady_tick(Duration::from_millis(100));
        }
    });
    bar
}
