//! Files to scenes: the TOML scene file, OBJ meshes and Princeton's .scn, and the scenes that are shipped inside the
//! program. Picture files to planes: [`picture`].
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

mod bpt;
mod document;
mod head;
mod include;
pub mod keys;
mod lexer;
mod names;
mod native;
mod obj;
pub mod picture;
mod polygon;
mod reader;
mod schema;
mod scn;
mod shipped;
mod strict;
mod syntax;
pub mod text;
mod tiny;

use std::path::{Path, PathBuf};

pub use head::{Head, Word};
pub use keys::{MAX_PIXELS, MAX_SIDE};
pub use schema::schema;
pub use shipped::{Shipped, shipped};

use crate::error::{Error, Note, Place};
use crate::scene::{Projection, Scene};
use document::Document;
use native::Contents;
use text::{Home, MAX_TEXT};

/// How to load.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Overrides `KEY=VALUE`, such as `material.red.shininess=64`, applied in turn before the file is interpreted.
    pub sets: Vec<String>,
    /// Values that real OpenGL refuses are errors instead of notes.
    pub strict_gl: bool,
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
    /// What the comment at the head of a `.toml` scene says; empty for other formats.
    pub head: Head,
    /// Half of the picture's width at distance 1, where the file states the horizontal angle instead of the vertical
    /// one (.scn).
    pub half_width: Option<f64>,
}

impl Imported {
    /// Gives the picture another size. Where the file states the horizontal angle, that angle stays and the vertical
    /// one follows; else it is the other way round.
    pub fn resize(&mut self, width: u32, height: u32) {
        (self.scene.image.width, self.scene.image.height) = (width, height);
        if let Some(half_width) = self.half_width {
            let fovy_deg = native::vertical_angle(half_width, &self.scene.image);
            self.scene.camera.projection = Projection::Perspective { fovy_deg };
        }
    }
}

/// Loads a file, or a shipped scene by its name. A path that exists wins.
///
/// # Errors
/// Whatever is wrong with the file or the overrides, with its place; names of shipped scenes that are close to an
/// unknown `name`.
pub fn load(name: &str, options: &LoadOptions) -> Result<Imported, Error> {
    let imported = load_any(name, options)?;
    if options.strict_gl {
        strict::check(&imported)?;
    }
    Ok(imported)
}

fn load_any(name: &str, options: &LoadOptions) -> Result<Imported, Error> {
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
        "scn" => load_scn(name, &file, home, &stem, options),
        other => Err(Error::Unsupported {
            place: Some(Box::new(Place::file(name))),
            message: match other {
                "" => "a scene file needs an extension".into(),
                other => format!("files of type .{other} are not imported"),
            },
            help: Some("rastray reads .toml and .scn scenes and .obj meshes".into()),
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
    let head = Head::of(file, &text);
    let document = Document::parse(file, text, &home, &options.sets)?;
    let read = native::read(&document, &home, Contents::default())?;
    let imported = imported(read, Vec::new(), file, home, stem);
    Ok(Imported { head, ..imported })
}

fn load_obj(
    name: &str,
    file: &str,
    home: Home,
    stem: &str,
    options: &LoadOptions,
) -> Result<Imported, Error> {
    // Overrides are parsed before the mesh is read, which may take a while.
    let document = Document::made(name, obj::INVENTED_LIGHTS.to_owned(), &options.sets)?;
    let (contents, mut notes) = obj::contents(&home, file, stem)?;
    let read = native::read(&document, &home, contents)?;
    notes.push(Note {
        place: None,
        message: "the file has no lights: two were invented, light.key and light.fill".into(),
    });
    Ok(imported(read, notes, name, home, stem))
}

fn load_scn(
    name: &str,
    file: &str,
    home: Home,
    stem: &str,
    options: &LoadOptions,
) -> Result<Imported, Error> {
    let scn::Loaded {
        contents,
        document,
        notes,
    } = scn::load(&home, file)?;
    let document = Document::made(name, document, &options.sets)?;
    let read = native::read(&document, &home, contents)?;
    Ok(imported(read, notes, name, home, stem))
}

/// What was read of a file and its document; `notes` come before those of the document.
fn imported(
    read: native::Read,
    mut notes: Vec<Note>,
    source: &str,
    home: Home,
    stem: &str,
) -> Imported {
    notes.extend(read.notes);
    let mut scene = read.scene;
    scene.name = stem.to_owned();
    Imported {
        scene,
        notes,
        source: source.to_owned(),
        files: home.files(),
        fitted: read.fitted,
        head: Head::default(),
        half_width: read.half_width,
    }
}

/// The error for a name that is neither a file nor a shipped scene: the nearest shipped name, or file beside it.
fn unknown(name: &str) -> Error {
    let path = Path::new(name);
    let known: Vec<&str> = shipped().iter().map(|scene| scene.name).collect();
    let message = format!("there is no file `{name}`, and no shipped scene of that name");
    let part = |part: Option<&std::ffi::OsStr>| {
        part.map_or(String::new(), |s| s.to_string_lossy().into_owned())
    };
    let beside = scenes_beside(path);
    let files: Vec<&str> = beside.iter().map(String::as_str).collect();
    let near_file = names::closest(&part(path.file_name()), &files)
        .map(|file| path.with_file_name(file).display().to_string());
    let near = names::closest(&part(path.file_stem()), &known).map(str::to_owned);
    let help = match near_file.or(near) {
        Some(near) => format!("did you mean `{near}`?"),
        None => "`rastray scenes` lists the shipped ones".to_owned(),
    };
    Error::parameter("SCENE", message).with_help(help)
}

/// Names of the scene files in the folder that a path points into, at most 1000, sorted.
fn scenes_beside(path: &Path) -> Vec<String> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let names = entries.take(1000).filter_map(|entry| {
        let name = entry.ok()?.file_name().into_string().ok()?;
        let extension = Path::new(&name).extension()?.to_str()?.to_lowercase();
        ["toml", "scn", "obj"]
            .contains(&extension.as_str())
            .then_some(name)
    });
    let mut names: Vec<_> = names.collect();
    names.sort();
    names
}
