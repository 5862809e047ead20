//! Files to scenes: the TOML scene file and OBJ meshes, and the scenes that are shipped inside the program.
//!
//! In: a path or the name of a shipped scene, and `KEY=VALUE` overrides. Out: a [`Scene`] and notes about what was
//! dropped, invented or doubted. Every importer ends in the same [`Scene`], so the renderers know no file format.
//! Every error has its place; nothing a file says can panic, or allocate beyond the limits of [`keys`] and [`text`].
//!
//! ```
//! let scene = rastray::import::load("whitted", &Default::default())?.scene;
//! assert_eq!((scene.image.width, scene.image.height), (640, 480));
//! # Ok::<(), rastray::error::Error>(())
//! ```

mod document;
pub mod keys;
mod names;
mod native;
mod obj;
mod polygon;
mod reader;
mod schema;
mod shipped;
pub mod text;

use std::path::{Path, PathBuf};

pub use keys::{MAX_PIXELS, MAX_SIDE};
pub use schema::schema;
pub use shipped::{Shipped, shipped};

use crate::error::{Error, Note, Place};
use crate::scene::Scene;
use document::Document;
use native::Contents;
use text::{Home, MAX_TEXT};

/// How to load.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Overrides `KEY=VALUE`, such as `material.red.shininess=64`, applied in turn before the file is interpreted.
    pub sets: Vec<String>,
}

/// What of the camera was fitted to the scene, since the file is silent about it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fitted {
    /// The eye point.
    pub eye: bool,
    /// The point looked at.
    pub target: bool,
    /// The near distance.
    pub near: bool,
}

/// A loaded scene.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The scene.
    pub scene: Scene,
    /// What was dropped, invented or doubted.
    pub notes: Vec<Note>,
    /// What was loaded: the path, or "shipped scene NAME".
    pub source: String,
    /// The files that were read, the scene file first; none for a shipped scene.
    pub files: Vec<PathBuf>,
    /// What of the camera was fitted.
    pub fitted: Fitted,
}

/// Loads a file, or a shipped scene by its name. A path that exists wins.
///
/// # Errors
/// Whatever is wrong with the file or the overrides, with its place; names of shipped scenes that are close to an
/// unknown `name`.
pub fn load(name: &str, options: &LoadOptions) -> Result<Imported, Error> {
    let path = Path::new(name);
    // A folder is no scene: `rastray compare whitted -o whitted` must work twice.
    let folder_of_that_name = path.is_dir() && shipped().iter().any(|scene| scene.name == name);
    if path.exists() && !folder_of_that_name {
        return load_path(path, name, options);
    }
    let text = shipped_text(name)?.to_owned();
    let file = format!("{name}.toml");
    let imported = load_toml(&file, text, Home::Embedded, name, options)?;
    let source = format!("shipped scene {name}");
    Ok(Imported { source, ..imported })
}

/// The text of a shipped scene.
///
/// # Errors
/// An unknown name; names that are close to it are told.
pub fn shipped_text(name: &str) -> Result<&'static str, Error> {
    let found = shipped().iter().find(|scene| scene.name == name);
    found.map(|scene| scene.text).ok_or_else(|| unknown(name))
}

fn load_path(path: &Path, name: &str, options: &LoadOptions) -> Result<Imported, Error> {
    let part = |part: Option<&std::ffi::OsStr>| {
        part.map_or(String::new(), |s| s.to_string_lossy().into_owned())
    };
    let file = part(path.file_name());
    let stem = part(path.file_stem());
    let home = Home::folder(path.parent().map_or(PathBuf::new(), Path::to_path_buf));
    match part(path.extension()).to_lowercase().as_str() {
        _ if path.is_dir() => Err(text::folder(name)),
        "toml" => {
            let text = text::utf8(name, home.read(&file, MAX_TEXT)?)?;
            load_toml(name, text, home, &stem, options)
        }
        "obj" => load_obj(name, &file, home, &stem, options),
        other => Err(Error::Unsupported {
            place: Some(Box::new(Place::file(name))),
            message: match other {
                "" => "a scene file needs an extension".into(),
                other => format!("files of type .{other} are not imported"),
            },
            help: Some("rastray reads .toml scenes and .obj meshes".into()),
        }),
    }
}

fn load_toml(
    file: &str,
    text: String,
    home: Home,
    stem: &str,
    options: &LoadOptions,
) -> Result<Imported, Error> {
    let document = Document::parse(file, text, &options.sets)?;
    let (mut scene, notes, fitted) = native::read(&document, &home, Contents::default())?;
    scene.name = stem.to_owned();
    Ok(Imported {
        scene,
        notes,
        source: file.to_owned(),
        files: home.files(),
        fitted,
    })
}

fn load_obj(
    name: &str,
    file: &str,
    home: Home,
    stem: &str,
    options: &LoadOptions,
) -> Result<Imported, Error> {
    // Overrides are parsed before the mesh is read, which may take a while.
    let document = Document::parse(name, obj::INVENTED_LIGHTS.to_owned(), &options.sets)?;
    let (contents, mut notes) = obj::contents(&home, file, stem)?;
    let (mut scene, more, fitted) = native::read(&document, &home, contents)?;
    notes.push(Note {
        place: None,
        message: "the file has no lights: two were invented, light.key and light.fill".into(),
    });
    notes.extend(more);
    scene.name = stem.to_owned();
    Ok(Imported {
        scene,
        notes,
        source: name.to_owned(),
        files: home.files(),
        fitted,
    })
}

/// The error for a name that is neither a file nor a shipped scene.
fn unknown(name: &str) -> Error {
    let known: Vec<&str> = shipped().iter().map(|scene| scene.name).collect();
    let message = format!("there is no file `{name}`, and no shipped scene of that name");
    let stem = Path::new(name)
        .file_stem()
        .map_or(name.into(), |s| s.to_string_lossy());
    let help = match names::closest(&stem, &known) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("shipped scenes: {}", names::list(&known, "and")),
    };
    Error::parameter("SCENE", message).with_help(help)
}
