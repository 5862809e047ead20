//! The system's OpenGL in a program that was built without it: its options are known, and say how to get it.

use rastray::error::Error;
use rastray::frame::Plane;
use rastray::render::Assembled;
use rastray::scene::Scene;
use serde_json::Value;

use super::args::CompareArgs;
use super::options::Verbosity;
use super::watch::Made;

/// A picture by the driver: no program without the feature has one.
pub(super) struct Drawn {
    pub(super) color: Plane<[f32; 3]>,
    pub(super) remark: String,
    pub(super) driver: Value,
}

fn absent(flag: &str) -> Error {
    Error::parameter(flag, "this rastray was built without OpenGL")
        .with_help("build it with: cargo build --release --features opengl")
}

pub(super) fn check(flag: &str) -> Result<(), Error> {
    Err(absent(flag))
}

pub(super) fn draw(_: &Scene, _: &Assembled, _: bool) -> Result<Drawn, Error> {
    Err(absent("--mode opengl"))
}

pub(super) fn compare(_: &CompareArgs, _: Verbosity) -> Result<(Made, bool), Error> {
    Err(absent("--against opengl"))
}
