//! `rastray scenes --contact-sheet FILE`: every shipped scene, rasterized and traced, small on one picture.

use std::path::Path;

use rastray::error::Error;
use rastray::import::{LoadOptions, Shipped, load, shipped};
use rastray::render::Renderer;
use rastray::report::figures::{Panel, contact_sheet as sheet, pair};
use rastray::report::files::{self, Format, View};
use rastray::report::formats::png_small;
use rastray::report::picture::Picture;

use super::args::QualityArgs;
use super::options::{Verbosity, apply};
use super::progress::Progress;
use super::render::picture;

/// Width of one picture: four pairs to a row make a sheet of about 1600 pixels.
const WIDTH: u32 = 186;
/// Pairs to a row.
const COLUMNS: usize = 4;
/// Draws the sheet; small pictures need some samples for smooth edges.
pub(super) fn contact_sheet(path: &Path, samples: u32, verbosity: Verbosity) -> Result<(), Error> {
    if Format::of_path(path)? != Format::Png {
        let message = format!("{}: the sheet is an 8-bit picture", path.display());
        return Err(Error::parameter("--contact-sheet", message).with_help("write a .png"));
    }
    files::check_target(path, "--contact-sheet")?;
    let scenes = shipped();
    let progress = Progress::new(verbosity, scenes.len() as u64);
    let mut pairs = Vec::new();
    for (i, scene) in scenes.iter().enumerate() {
        progress.step(i as u64, scene.name);
        pairs.push((scene, drawn(scene.name, samples)?));
    }
    drop(progress);
    let group = |of: &[(&'static Shipped, Picture)]| of[0].0.folder;
    let chunks = pairs.chunk_by(|a, b| a.0.folder == b.0.folder);
    let groups: Vec<(&str, Vec<Panel>)> = chunks
        .map(|chunk| (group(chunk), chunk.iter().map(panel).collect()))
        .collect();
    let bytes = png_small(&sheet(&groups, COLUMNS)?)?;
    files::write_bytes_atomic(path, &bytes)?;
    verbosity.say(path.display());
    Ok(())
}

fn panel<'a>((scene, picture): &'a (&Shipped, Picture)) -> Panel<'a> {
    Panel {
        picture,
        title: scene.name,
        note: "",
    }
}

/// Both pictures of a scene, in its own shape.
fn drawn(name: &str, samples: u32) -> Result<Picture, Error> {
    let mut imported = load(name, &LoadOptions::default())?;
    let image = &imported.scene.image;
    let height = (WIDTH * image.height / image.width.max(1)).max(1);
    let args = QualityArgs {
        size: Some(format!("{WIDTH}x{height}")),
        samples: Some(samples),
        ..QualityArgs::default()
    };
    let options = apply(&args, &mut imported)?;
    let draw = |mode| -> Result<Picture, Error> {
        let plane = picture(&imported.scene, mode, &options)?;
        Picture::from_linear(&plane, View::Linear)
    };
    Ok(pair(&draw(Renderer::Raster)?, &draw(Renderer::Trace)?))
}
