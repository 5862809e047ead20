//! The program, run as a user runs it.

use std::path::Path;
use std::process::{Command, Output};

/// Runs it in a folder.
pub(crate) fn rastray(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rastray"))
        .current_dir(folder)
        .args(args)
        .env("NO_COLOR", "1")
        .output()
        .expect("the program starts")
}

/// What it said.
pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
