//! `rastray lecture`: the deck, into a folder.
//!
//! Every scene is read before the first is drawn, and every file is written whole, the page last: an error or an
//! interruption leaves pictures of the scenes so far, and the page of an earlier run as it was.

use std::path::Path;

use rastray::error::{Error, Note};
use rastray::import::{Imported, LoadOptions, load, shipped};
use rastray::render::{Options, Renderer};
use rastray::report::deck::{Deck, Entry, Slide, stems};
use rastray::report::difference::{signed, stored_difference};
use rastray::report::equation::Form;
use rastray::report::files;
use rastray::report::folder::File;
use rastray::report::topic::Topics;

use super::args::LectureArgs;
use super::commands::command_line;
use super::options::{Verbosity, apply, view};
use super::progress::Progress;
use super::render::picture;
use super::{diagnostic, show};

/// Size of pictures where none is asked for: a slide of full HD.
const SIZE: (u32, u32) = (1920, 1080);
/// Samples a pixel where none are asked for: smooth edges on a projector.
const SAMPLES: u32 = 4;

/// A scene that is ready to be drawn.
struct Ready {
    imported: Imported,
    options: Options,
    topics: Topics,
}

pub(super) fn lecture(args: &LectureArgs, verbosity: Verbosity) -> Result<(), Error> {
    let folder = Path::new(&args.output);
    files::check_folder(folder, "--output")?;
    let names = match args.scenes.is_empty() {
        true => own_scenes(),
        false => args.scenes.clone(),
    };
    let scenes = names
        .iter()
        .map(|name| ready(name, args, verbosity))
        .collect::<Result<Vec<_>, _>>()?;
    let stems = stems(
        &scenes
            .iter()
            .map(|s| s.imported.scene.name.as_str())
            .collect::<Vec<_>>(),
    );
    files::create_folder(folder)?;
    let progress = Progress::new(verbosity, scenes.len() as u64);
    let mut entries = Vec::new();
    for (i, (scene, stem)) in scenes.into_iter().zip(stems).enumerate() {
        progress.step(i as u64, &stem);
        entries.push(drawn(&scene, stem, args, folder)?);
    }
    drop(progress);
    let deck = Deck {
        command: command_line(),
        entries,
    };
    write(folder, &deck.files())?;
    let page = folder.join("index.html");
    verbosity.say(page.display());
    if args.open {
        show::open(&page);
    }
    Ok(())
}

/// The names of the lecture's scenes, in its order.
fn own_scenes() -> Vec<String> {
    let lecture = shipped().iter().filter(|s| s.folder == "lecture");
    lecture.map(|s| s.name.to_owned()).collect()
}

/// Loads a scene and what its head says.
fn ready(name: &str, args: &LectureArgs, verbosity: Verbosity) -> Result<Ready, Error> {
    let mut imported = load(name, &LoadOptions::default())?;
    if verbosity != Verbosity::Quiet {
        imported.notes.iter().for_each(diagnostic::note);
        if imported.head.question.is_empty() {
            diagnostic::note(&Note {
                place: None,
                message: format!(
                    "{name} asks no question; a comment at the head of a .toml scene is shown: `# Why? Because.`"
                ),
            });
        }
    }
    let topics = Topics::of(&imported.head.terms)?;
    imported.resize(SIZE.0, SIZE.1);
    let image = &mut imported.scene.image;
    image.samples = image.samples.max(SAMPLES);
    let options = apply(&args.quality, &mut imported)?;
    Ok(Ready {
        imported,
        options,
        topics,
    })
}

/// Draws a scene both ways and writes its pictures.
fn drawn(ready: &Ready, stem: String, args: &LectureArgs, folder: &Path) -> Result<Entry, Error> {
    let scene = &ready.imported.scene;
    let raster = picture(scene, Renderer::Raster, &ready.options)?;
    let trace = picture(scene, Renderer::Trace, &ready.options)?;
    let slide = Slide {
        stem,
        head: ready.imported.head.clone(),
        topics: ready.topics.clone(),
        form: Form::of(scene),
        view: view(&args.quality),
        difference: signed(&stored_difference(&trace, &raster))?,
        raster,
        trace,
    };
    let (files, entry) = slide.finish()?;
    write(folder, &files)?;
    Ok(entry)
}

fn write(folder: &Path, files: &[File]) -> Result<(), Error> {
    files
        .iter()
        .try_for_each(|file| files::write_bytes_atomic(&folder.join(&file.name), &file.bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lecture_is_all_of_its_folder_in_order() {
        let names = own_scenes();
        assert!(names.len() >= 20 && names[0] == "01-point-light");
        assert!(names.is_sorted());
    }
}
