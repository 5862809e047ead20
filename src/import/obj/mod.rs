//! Wavefront OBJ and MTL.
//!
//! In: a mesh file and the libraries beside it. Out: meshes with materials, in object space; an OBJ alone becomes a
//! scene with a fitted camera and two invented lights. Read: v, vt, vn, f (any size, negative indices), o, g, s, usemtl,
//! mtllib, `\` continuation, all line ends. Dropped with a note: points, lines, free-form geometry, vertex colours and weights,
//! textures.
//!
//! `tobj` reads the libraries (see `mtl`), but the geometry is scanned here: tobj ignores smoothing groups, cuts every
//! face into a fan (wrong where it is concave), turns faces of one or two corners into points and lines, gives errors
//! without a place, and splits a file at every `usemtl`.
//!
//! Measured (release build, one core of a busy two-core server, 2026-11): 871,414 triangles in 30 MB of text take 0.3 to
//! 0.5 s and 77 MB at the peak, the text included; 303,876 triangles (12 MB) 0.13 s. One vertex table with chains a
//! position instead of a hash map of corners: nothing is hashed for a vertex.

mod build;
mod check;
mod mtl;
mod names;
mod scan;
mod smooth;
mod words;

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;

use super::native::Contents;
use super::text::{Home, MAX_LIBRARY, MAX_MESH, check_text, end_lines, from_utf16};
use crate::error::{Error, Note, Place};
use crate::gl;
use crate::scene::{Geometry, Material, Mesh, Object, Optics};
use mtl::Entry;
use names::{Names, shown, without_comment};
use scan::{NONE, Scan};
use words::place;

/// The most libraries of one mesh that are looked for.
const MAX_LIBRARIES: usize = 256;
/// Notes about missing materials stop at so many.
const MAX_NOTES: usize = 1024;

/// A mesh file as objects share it: materials are indices into the scene's.
#[derive(Clone, Debug)]
pub(crate) struct Shared {
    pub(crate) mesh: Arc<Mesh>,
    pub(crate) materials: Vec<usize>,
}

/// One mesh of a file.
#[derive(Debug)]
pub(crate) struct Part {
    /// Its `o` or `g` name; `None` for the file as a whole.
    pub(crate) name: Option<String>,
    pub(crate) mesh: Arc<Mesh>,
    /// Material of each slot, as an index into [`Model::materials`].
    pub(crate) materials: Vec<usize>,
}

/// What a file holds.
#[derive(Debug)]
pub(crate) struct Model {
    pub(crate) parts: Vec<Part>,
    /// The materials that faces use, in order of first use.
    pub(crate) materials: Vec<Material>,
    pub(crate) notes: Vec<Note>,
}

/// OpenGL's default material, for what has none.
pub(crate) fn default_material() -> Material {
    Material {
        name: "(default)".into(),
        front: gl::Material::default(),
        back: None,
        optics: Optics::default(),
    }
}

/// Loads a mesh file. `smooth` as in the scene file; `split` makes a part of each object (or group).
pub(crate) fn load(
    home: &Home,
    file: &str,
    smooth: Option<bool>,
    split: bool,
) -> Result<Model, Error> {
    let name = home.name(file);
    let mut bytes = home.read(file, MAX_MESH)?;
    check_text(&name, &bytes)?;
    end_lines(&mut bytes);
    let mut scan = scan::scan(&name, &bytes)?;
    let mut notes = std::mem::take(&mut scan.notes);
    let mut libraries = Libraries {
        home,
        folder: file.rfind(['/', '\\']).map_or("", |i| &file[..=i]),
        names: Names::default(),
        entries: Vec::new(),
        notes: &mut notes,
    };
    libraries.read_all(&name, &bytes, &scan)?;
    drop(bytes);
    let (names, mut entries) = (libraries.names, libraries.entries);
    let used = std::mem::take(&mut scan.materials.list);
    let built = build::build(scan, smooth, split, &mut notes)?;
    let mut model = Model {
        parts: Vec::with_capacity(built.len()),
        materials: Vec::new(),
        notes,
    };
    let mut index_of = HashMap::new();
    for part in built {
        let mut materials = Vec::with_capacity(part.materials.len());
        for number in part.materials {
            let known = index_of.get(&number).copied();
            let index = known.unwrap_or(model.materials.len());
            if known.is_none() {
                let wanted = used.get(number as usize).filter(|_| number != NONE);
                let material = match wanted {
                    None => default_material(),
                    Some(wanted) => {
                        material(wanted, &names, &mut entries, &name, &mut model.notes)?
                    }
                };
                model.materials.push(material);
                index_of.insert(number, index);
            }
            materials.push(index);
        }
        model.parts.push(Part {
            name: part.name,
            mesh: part.mesh,
            materials,
        });
    }
    note_unused(entries, &mut model.notes);
    Ok(model)
}

/// The material of a `usemtl` name.
fn material(
    wanted: &[u8],
    names: &Names,
    entries: &mut [Entry],
    file: &str,
    notes: &mut Vec<Note>,
) -> Result<Material, Error> {
    if let Some(index) = names.find(wanted) {
        let entry = &mut entries[index].material;
        return match entry {
            Ok(material) => Ok(material.clone()),
            Err(_) => std::mem::replace(entry, Ok(default_material())),
        };
    }
    let name = shown(wanted);
    if notes.len() < MAX_NOTES {
        let known: Vec<String> = entries.iter().map(|e| shown(&e.name)).collect();
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        let near = super::names::closest(&name, &known);
        let near = near.map_or(String::new(), |near| format!("; there is `{near}`"));
        notes.push(Note {
            place: Some(Place::file(file)),
            message: format!("material {name} is in no library: OpenGL's default is used{near}"),
        });
    }
    Ok(Material {
        name,
        ..default_material()
    })
}

/// Notes about materials that cannot be read and that nothing needs.
fn note_unused(entries: Vec<Entry>, notes: &mut Vec<Note>) {
    for entry in entries {
        if let Err(error) = entry.material
            && notes.len() < MAX_NOTES
        {
            let name = shown(&entry.name);
            let place = error.place().cloned();
            let what = match error {
                Error::Input { message, .. } | Error::Unsupported { message, .. } => message,
                error => error.to_string(),
            };
            let message = format!("material {name}, which nothing uses, is dropped: {what}");
            notes.push(Note { place, message });
        }
    }
}

/// The material libraries of a mesh file.
struct Libraries<'a> {
    home: &'a Home,
    /// That of the mesh file.
    folder: &'a str,
    /// Into `entries`.
    names: Names,
    entries: Vec<Entry>,
    notes: &'a mut Vec<Note>,
}

impl Libraries<'_> {
    /// Reads all libraries that the file names; of several materials of a name, the first library's is used.
    fn read_all(&mut self, name: &str, bytes: &[u8], scan: &Scan) -> Result<(), Error> {
        let mut seen = HashSet::new();
        for (text, span) in &scan.libraries {
            for (wanted, found) in self.files(text) {
                let at = || Some(place(name, bytes, span.clone()));
                let Some((file, respelt)) = found else {
                    let library = self.home.name(format!("{}{wanted}", self.folder));
                    let message = format!(
                        "there is no material library {library}: OpenGL's default material is used"
                    );
                    let place = at();
                    if seen.insert(library.into()) && seen.len() < MAX_LIBRARIES {
                        self.notes.push(Note { place, message });
                    }
                    continue;
                };
                if seen.len() >= MAX_LIBRARIES || !seen.insert(file.clone()) {
                    continue;
                }
                if respelt {
                    let found = self.home.name(&file);
                    let message = format!("material library {wanted}: {found} is read");
                    let place = at();
                    self.notes.push(Note { place, message });
                }
                self.read(&file)?;
            }
        }
        Ok(())
    }

    /// The files that a `mtllib` line names, and where they are. A name may hold blanks and `#`; only where no such file
    /// is, the line is a list of names.
    fn files(&self, text: &[u8]) -> Vec<(String, Option<(PathBuf, bool)>)> {
        let bare = without_comment(text);
        let whole = [text, bare].map(|name| (shown(name), self.home.find(self.folder, name)));
        let exact = |(_, found): &&(_, Option<(_, bool)>)| matches!(found, Some((_, false)));
        if let Some(found) = whole.iter().find(exact) {
            return vec![found.clone()];
        }
        let find = |word: &[u8]| (shown(word), self.home.find(self.folder, word));
        let words: Vec<_> = quoted_words(bare).into_iter().map(find).collect();
        let any = words.iter().any(|(_, found)| found.is_some());
        let respelt = whole.into_iter().find(|(_, found)| found.is_some());
        match respelt {
            Some(found) if !any || words.len() < 2 => vec![found],
            _ => words,
        }
    }

    /// Adds the materials of one library.
    fn read(&mut self, file: &std::path::Path) -> Result<(), Error> {
        let mut bytes = self.home.read(file, MAX_LIBRARY)?;
        let library = self.home.name(file);
        let mut note = |message: &str| {
            let place = Some(Place::file(&library));
            let message = message.to_owned();
            self.notes.push(Note { place, message });
        };
        if let Some(text) = from_utf16(&bytes) {
            note("the library is UTF-16 text; it is read, but other programs may want UTF-8");
            bytes = text.trim_start_matches('\u{feff}').as_bytes().to_vec();
        }
        if bytes.contains(&0) {
            note("the library is no text: it is not read");
            return Ok(());
        }
        end_lines(&mut bytes);
        let before = self.entries.len();
        for entry in mtl::read(&library, &bytes, self.notes)? {
            let name = shown(&entry.name);
            let index = self.entries.len();
            let message = match self.names.get(&entry.name) {
                Some(old) if old < before => {
                    format!(
                        "material {name} is in a library before this one, too; that one is used"
                    )
                }
                old => {
                    self.names.insert(&entry.name, index);
                    self.entries.push(entry);
                    if old.is_none() {
                        continue;
                    }
                    format!("material {name} stands more than once; the last is used")
                }
            };
            let place = Some(Place::file(&library));
            self.notes.push(Note { place, message });
        }
        Ok(())
    }
}

/// Words between blanks, or between quotes.
fn quoted_words(text: &[u8]) -> Vec<&[u8]> {
    let mut words = Vec::new();
    let mut rest = text.trim_ascii();
    while let Some(first) = rest.first() {
        let quoted = *first == b'"' && rest[1..].contains(first);
        let ends = |b: &u8| {
            if quoted {
                b == first
            } else {
                b.is_ascii_whitespace()
            }
        };
        let start = usize::from(quoted);
        let length = rest[start..].iter().position(ends);
        let end = length.map_or(rest.len(), |length| start + length);
        words.push(&rest[start..end]);
        rest = rest[(end + start).min(rest.len())..].trim_ascii_start();
    }
    words
}

/// Lights for a file that has none, in eye space: a key light from the upper left behind the camera, a weak fill light
/// from the right.
pub(crate) const INVENTED_LIGHTS: &str = r#"
[light.key]
position = [-0.6, 0.8, 1, 0]
space = "eye"
diffuse = 0.8
[light.fill]
position = [1, 0.1, 0.5, 0]
space = "eye"
diffuse = 0.25
specular = 0
"#;

/// A mesh file as the contents of a scene: one object for each `o` (or `g`).
pub(crate) fn contents(
    home: &Home,
    file: &str,
    stem: &str,
) -> Result<(Contents, Vec<Note>), Error> {
    let model = load(home, file, None, true)?;
    let objects = model.parts.into_iter().map(|part| Object {
        name: part.name.unwrap_or_else(|| stem.to_owned()),
        geometry: Geometry::Mesh(part.mesh),
        materials: part.materials,
        world_from_object: crate::math::DAffine3::IDENTITY,
        tessellation: None,
        priority: 0,
    });
    let contents = Contents {
        objects: objects.collect(),
        materials: model.materials,
        half_width: None,
    };
    Ok((contents, model.notes))
}
