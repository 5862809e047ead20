//! Wavefront OBJ and MTL.
//!
//! In: a mesh file and the libraries beside it. Out: meshes with materials, in object space; an OBJ alone becomes a
//! scene with a fitted camera and two invented lights. Read: v, vt, vn, f (any size, negative indices), o, g, s, usemtl,
//! mtllib, `\` continuation, CR LF. Dropped with a note: points, lines, free-form geometry, vertex colours and weights,
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
mod scan;
mod smooth;
mod words;

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::native::Contents;
use super::text::{Home, MAX_LIBRARY, MAX_MESH, check_text};
use crate::error::{Error, Note, Place};
use crate::gl;
use crate::scene::{Geometry, Material, Mesh, Object, Optics};
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
    let bytes = home.read(file, MAX_MESH)?;
    check_text(&name, &bytes)?;
    let mut scan = scan::scan(&name, &bytes)?;
    let mut notes = std::mem::take(&mut scan.notes);
    let libraries = libraries(home, file, &name, &bytes, &scan, &mut notes)?;
    drop(bytes);
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
            let index = *index_of.entry(number).or_insert_with(|| {
                let material = material(number, &used, &libraries, &name, &mut model.notes);
                model.materials.push(material);
                model.materials.len() - 1
            });
            materials.push(index);
        }
        model.parts.push(Part {
            name: part.name,
            mesh: part.mesh,
            materials,
        });
    }
    Ok(model)
}

/// The material of a `usemtl` number.
fn material(
    number: u32,
    used: &[String],
    libraries: &HashMap<String, Material>,
    file: &str,
    notes: &mut Vec<Note>,
) -> Material {
    let Some(name) = used.get(number as usize).filter(|_| number != NONE) else {
        return default_material();
    };
    match libraries.get(name) {
        Some(material) => material.clone(),
        None => {
            if notes.len() < MAX_NOTES {
                notes.push(Note {
                    place: Some(Place::file(file)),
                    message: format!("material {name} is in no library: OpenGL's default is used"),
                });
            }
            Material {
                name: name.clone(),
                ..default_material()
            }
        }
    }
}

/// The materials of all libraries that the file names; later ones win.
fn libraries(
    home: &Home,
    file: &str,
    name: &str,
    bytes: &[u8],
    scan: &Scan,
    notes: &mut Vec<Note>,
) -> Result<HashMap<String, Material>, Error> {
    let folder = file.rfind(['/', '\\']).map_or("", |i| &file[..=i]);
    let mut found = HashMap::new();
    let mut seen = HashSet::new();
    for (text, span) in &scan.libraries {
        // A name may hold blanks; only where no such file is, the line is a list of names.
        let whole = format!("{folder}{text}");
        let files = if home.has(&whole) {
            vec![whole]
        } else {
            let words = text.split_whitespace();
            words.map(|word| format!("{folder}{word}")).collect()
        };
        for file in files {
            if seen.len() >= MAX_LIBRARIES || !seen.insert(file.clone()) {
                continue;
            }
            if home.has(&file) {
                library(home, &file, &mut found, notes)?;
            } else {
                let library = home.name(&file);
                let message = format!(
                    "there is no material library {library}: OpenGL's default material is used"
                );
                let place = Some(place(name, bytes, span.clone()));
                notes.push(Note { place, message });
            }
        }
    }
    Ok(found)
}

/// Adds the materials of one library.
fn library(
    home: &Home,
    file: &str,
    found: &mut HashMap<String, Material>,
    notes: &mut Vec<Note>,
) -> Result<(), Error> {
    let bytes = home.read(file, MAX_LIBRARY)?;
    let library = home.name(file);
    for material in mtl::read(&library, &bytes, notes)? {
        let name = material.name.clone();
        if found.insert(name.clone(), material).is_some() {
            let message = format!("material {name} stands more than once; the last is used");
            notes.push(Note {
                place: Some(Place::file(&library)),
                message,
            });
        }
    }
    Ok(())
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
    });
    let contents = Contents {
        objects: objects.collect(),
        materials: model.materials,
        half_width: None,
    };
    Ok((contents, model.notes))
}
