//! The TOML scene file (DESIGN, section 2): document in, [`Scene`] and notes out.
//!
//! Sections are read in the order image, light model, raster, trace, lights, materials, objects, camera, since the
//! camera may be fitted to the objects; lights, materials and objects keep the file's order. What the file leaves out
//! has OpenGL's default but for the exceptions of DESIGN, section 1. Not read in this version, each an error with a
//! reason: textures.

mod bezier;
mod colors;
mod doubts;
mod lights;
mod materials;
mod mesh;
mod objects;
mod settings;
mod shapes;
mod transform;

use std::collections::{HashMap, HashSet};

use super::document::{Document, Key, Node, Value};
use super::keys::{self, CONVENTION, CONVENTIONS, TOP};
use super::reader::{Section, table};
use super::text::Home;
use super::{Fitted, names, obj};
use crate::error::{Error, Note};
use crate::gl::ColorMaterial;
use crate::scene::{ImageSettings, Material, Object, Scene};

/// What an importer of another format found: the rest of the scene comes from overrides and defaults.
#[derive(Debug, Default)]
pub(crate) struct Contents {
    pub(crate) materials: Vec<Material>,
    pub(crate) objects: Vec<Object>,
    /// Half of the picture's width at distance 1, where the camera states no angle of its own.
    pub(crate) half_width: Option<f64>,
}

/// What a document and its contents make.
#[derive(Debug)]
pub(crate) struct Read {
    pub(crate) scene: Scene,
    pub(crate) notes: Vec<Note>,
    pub(crate) fitted: Fitted,
    /// As in [`Contents`], where it was used.
    pub(crate) half_width: Option<f64>,
}

/// The full vertical angle in degrees of a picture whose half width at distance 1 is given: tan scales with the sides.
pub(crate) fn vertical_angle(half_width: f64, image: &ImageSettings) -> f64 {
    let (width, height) = (f64::from(image.width), f64::from(image.height));
    2.0 * libm::atan(half_width * height / width).to_degrees()
}

/// Reads a document. `contents` come before what the document itself holds.
pub(crate) fn read(document: &Document, home: &Home, contents: Contents) -> Result<Read, Error> {
    let mut reader = Reader::new(document, home, contents);
    let top = reader.top()?;
    reader.convention(&top)?;
    reader.image(top.get("image"))?;
    reader.light_model(top.get("light_model"))?;
    reader.raster(top.get("raster"))?;
    reader.trace(top.get("trace"))?;
    for (key, node) in top.named("light")? {
        reader.light(key, node)?;
    }
    for (key, node) in top.named("material")? {
        if document.is_included(&key.span) {
            reader.shared_materials.insert(reader.scene.materials.len());
        }
        reader.material(key, node)?;
    }
    for (key, node) in top.named("object")? {
        reader.object(key, node)?;
    }
    if reader.scene.objects.is_empty() {
        let error = Error::input(document.whole(), "the scene has no object");
        return Err(error.with_help("add one, for example [object.ball] with shape = \"sphere\""));
    }
    reader.track_colors();
    let fitted = reader.camera(top.get("camera"))?;
    reader.closing_notes();
    reader.doubts();
    Ok(Read {
        scene: reader.scene,
        notes: reader.notes,
        fitted,
        half_width: reader.half_width,
    })
}

/// A reading under way.
struct Reader<'a> {
    document: &'a Document,
    home: &'a Home,
    scene: Scene,
    notes: Vec<Note>,
    /// `convention = "lecture"`.
    lecture: bool,
    /// `light_model.color_material`.
    color_material: Option<ColorMaterial>,
    /// `color_material` of the materials that state it.
    own_color_material: HashMap<usize, Option<ColorMaterial>>,
    /// Materials whose back nobody will see.
    back_without_two_sides: Vec<String>,
    /// Index of OpenGL's default material, once an object needed it.
    default_material: Option<usize>,
    /// OBJ files read so far, by name and `smooth`.
    models: HashMap<(String, Option<bool>), obj::Shared>,
    /// Half of the picture's width at distance 1, if that is the angle to use.
    half_width: Option<f64>,
    /// Materials of included files, which need not be used.
    shared_materials: HashSet<usize>,
    /// Materials by name.
    material_index: HashMap<String, usize>,
    /// Objects by name.
    object_index: HashMap<String, usize>,
    /// Triangles that stated levels and tiles ask for.
    tessellated: u64,
    /// Triangles of the objects' meshes.
    mesh_triangles: u64,
}

/// The top level of the document.
struct Top<'a> {
    document: &'a Document,
    entries: &'a [(Key, Node)],
}

impl<'a> Top<'a> {
    fn get(&self, name: &str) -> Option<&'a (Key, Node)> {
        self.entries.iter().find(|(key, _)| key.name == name)
    }

    /// The tables of `[section.NAME]` in file order.
    fn named(&self, section: &str) -> Result<&'a [(Key, Node)], Error> {
        match self.get(section) {
            Some((_, node)) => {
                let help = format!("write [{section}.NAME], with a name of your own");
                let entries = table(self.document, node, section)
                    .map_err(|error| error.with_help(help.clone()))?;
                for (key, node) in entries {
                    if !matches!(node.value, Value::Table(_)) {
                        let message = format!(
                            "{section}.{0}: expected a table, found {1}",
                            key.name,
                            node.value.describe()
                        );
                        return Err(self.document.error(&key.span, message).with_help(help));
                    }
                }
                Ok(entries)
            }
            None => Ok(&[]),
        }
    }
}

impl<'a> Reader<'a> {
    fn new(document: &'a Document, home: &'a Home, contents: Contents) -> Self {
        let mut reader = Self {
            document,
            home,
            scene: Scene::default(),
            notes: Vec::new(),
            lecture: false,
            color_material: None,
            own_color_material: HashMap::new(),
            back_without_two_sides: Vec::new(),
            default_material: None,
            models: HashMap::new(),
            half_width: contents.half_width,
            shared_materials: HashSet::new(),
            material_index: HashMap::new(),
            object_index: HashMap::new(),
            tessellated: 0,
            mesh_triangles: 0,
        };
        for material in contents.materials {
            reader.push_material(material);
        }
        reader.scene.objects = contents.objects;
        reader
    }

    fn top(&self) -> Result<Top<'a>, Error> {
        let entries = table(self.document, &self.document.root, "the file")?;
        for (key, node) in entries {
            if key.name == "include" {
                // Those of the file are resolved by now: this one is an override's.
                let message = "include: files are included by the scene file only";
                return Err(self.document.error(&key.span, message));
            }
            if !TOP.contains(&key.name.as_str()) {
                return Err(unknown_section(self.document, key, node));
            }
        }
        Ok(Top {
            document: self.document,
            entries,
        })
    }

    fn convention(&mut self, top: &Top<'a>) -> Result<(), Error> {
        const KEYS: &[keys::KeyInfo] = &[CONVENTION];
        let Some((key, node)) = top.get("convention") else {
            return Ok(());
        };
        let root = Node {
            span: key.span.clone(),
            value: Value::Table(vec![(key.clone(), node.clone())]),
        };
        let section = Section::open(self.document, "", key.span.clone(), &root, &[KEYS])?;
        self.lecture = section.choice("convention", CONVENTIONS)?.unwrap_or(false);
        Ok(())
    }

    fn note(&mut self, place: Option<&std::ops::Range<usize>>, message: impl Into<String>) {
        self.notes.push(Note {
            place: place.map(|span| self.document.place(span)),
            message: message.into(),
        });
    }

    /// Notes that only the whole scene can tell.
    fn closing_notes(&mut self) {
        let lights = self.scene.lights.len();
        if self.scene.enabled_lights().next().is_none() {
            let message = match lights {
                0 => "no light: only emission and scene ambient show",
                _ => "no light is enabled: only emission and scene ambient show",
            };
            self.note(None, message);
        }
        if !self.scene.light_model.two_sided {
            for name in std::mem::take(&mut self.back_without_two_sides) {
                let message = format!(
                    "material {name}: `back` is not used, since light_model.two_sided is false"
                );
                self.note(None, message);
            }
        }
        let mut used = vec![false; self.scene.materials.len()];
        for object in &self.scene.objects {
            for index in &object.materials {
                if let Some(flag) = used.get_mut(*index) {
                    *flag = true;
                }
            }
        }
        let unused: Vec<&str> = self
            .scene
            .materials
            .iter()
            .enumerate()
            .filter(|(i, _)| !used[*i] && !self.shared_materials.contains(i))
            .map(|(_, m)| m.name.as_str())
            .collect();
        let message = match unused.len() {
            0 => return,
            1..=8 => format!("no object uses material {}", names::list(&unused, "or")),
            more => format!("no object uses {more} of the materials"),
        };
        self.note(None, message);
    }
}

/// The error for a name that the top level does not have.
fn unknown_section(document: &Document, key: &Key, node: &Node) -> Error {
    let name = key.name.as_str();
    if matches!(node.value, Value::Table(_)) {
        let error = document.error(&key.span, format!("there is no section `{name}`"));
        return names::with_advice(error, name, TOP);
    }
    let error = document.error(&key.span, format!("`{name}` stands outside of any section"));
    let home = keys::SECTIONS
        .iter()
        .find(|(_, rows)| rows.iter().any(|row| row.name == name));
    match home {
        Some((section, _)) => error.with_help(format!("it belongs into {section}")),
        None => names::with_closest(error, name, TOP),
    }
}

/// The note about a value that real OpenGL refuses.
pub(crate) fn gl_would_refuse(path: &str, violation: &crate::gl::RangeViolation) -> String {
    format!("{path}: {}", super::strict::refusal(violation))
}
