//! `[object.NAME]`: shapes, meshes and what they are made of.

use std::sync::Arc;

use super::Reader;
use crate::error::{Error, Place};
use crate::import::document::{Key, Node, Value};
use crate::import::keys::{self, KeyInfo, MAX_MESH_TRIANGLES, SHAPES};
use crate::import::reader::{Section, mismatch, table};
use crate::import::{names, obj};
use crate::math::DAffine3;
use crate::scene::{Geometry, Material, Object};

/// Forms that an object can have, for the message where it has none.
const FORMS: &str =
    "a `shape`, a `mesh` file, inline `positions`, or an `instance` of another object";

/// What makes an object: the key that it has one of.
enum Form<'a> {
    Shape(&'a Node),
    Mesh,
    Inline,
    Instance(&'a Node),
}

impl<'a> Reader<'a> {
    pub(super) fn object(&mut self, key: &Key, node: &'a Node) -> Result<(), Error> {
        let path = format!("object.{}", key.name);
        let form = self.form(&path, key, node)?;
        let own: &'static [KeyInfo] = match form {
            Form::Shape(name) => self.shape_keys(name)?,
            Form::Mesh => keys::MESH,
            Form::Inline => keys::INLINE,
            Form::Instance(_) => &[],
        };
        let rows = [keys::OBJECT, own];
        let section = Section::open(self.document, path, key.span.clone(), node, &rows)?;
        let mut materials = self.stated_materials(&section)?;
        let mut world_from_object = self.transform(&section)?;
        let mut tessellation = None;
        let mut priority = section.signed("priority")?;
        let geometry = match form {
            Form::Shape(_) => {
                tessellation = section.integer("tessellation")?;
                self.shape(&section, tessellation)?
            }
            Form::Mesh => {
                let shared = self.mesh_file(&section)?;
                materials = materials.or(Some(shared.materials));
                Geometry::Mesh(shared.mesh)
            }
            Form::Inline => Geometry::Mesh(Arc::new(self.inline(&section)?)),
            Form::Instance(node) => {
                let original = self.scene.objects[self.original(&key.name, node)?].clone();
                world_from_object = placed(&section, &world_from_object, &original)?;
                tessellation = original.tessellation;
                priority = priority.or(Some(original.priority));
                materials = materials.or(Some(original.materials));
                if let Geometry::Shape(shape) = &original.geometry {
                    self.count_triangles(&section, shape, tessellation)?;
                }
                original.geometry
            }
        };
        self.count_mesh(&section, &geometry)?;
        let materials = match materials {
            Some(materials) => materials,
            None => vec![self.gl_default_material()],
        };
        let index = self.scene.objects.len();
        self.object_index.insert(key.name.clone(), index);
        self.scene.objects.push(Object {
            name: key.name.clone(),
            geometry,
            materials,
            world_from_object,
            tessellation,
            priority: priority.unwrap_or(0),
        });
        Ok(())
    }

    fn form(&self, path: &str, key: &Key, node: &'a Node) -> Result<Form<'a>, Error> {
        let entries = table(self.document, node, path)?;
        let mut found = Vec::new();
        for (k, value) in entries {
            match k.name.as_str() {
                "shape" => found.push(("shape", Form::Shape(value))),
                "mesh" => found.push(("mesh", Form::Mesh)),
                "positions" => found.push(("positions", Form::Inline)),
                "instance" => found.push(("instance", Form::Instance(value))),
                _ => {}
            }
        }
        let names: Vec<&str> = found.iter().map(|(name, _)| *name).collect();
        let message = match names.len() {
            0 => format!("{path}: expected {FORMS}"),
            _ => {
                let list = names::list(&names, "and");
                format!("{path}: expected one of {FORMS}, found {list}")
            }
        };
        match (found.pop(), found.len()) {
            (Some((_, form)), 0) => Ok(form),
            _ => Err(self.document.error(&key.span, message)),
        }
    }

    /// The object that an instance repeats: one that stands further up.
    fn original(&self, own: &str, node: &Node) -> Result<usize, Error> {
        let Value::Text(name) = &node.value else {
            return Err(mismatch(
                self.document,
                "instance",
                node,
                "the name of an object",
            ));
        };
        if let Some(index) = self.object_index.get(name) {
            return Ok(*index);
        }
        let known: Vec<&str> = self.scene.objects.iter().map(|o| o.name.as_str()).collect();
        let all = self.top()?.named("object")?;
        let later = all.iter().any(|(key, _)| key.name == *name);
        let (message, help) = match later {
            true if own == name => (
                format!("instance: `{name}` cannot repeat itself"),
                format!("say what it is: {FORMS}"),
            ),
            true => (
                format!("instance: `{name}` stands further down"),
                format!("move [object.{name}] up, before its instances"),
            ),
            false => {
                let message = format!("instance: there is no object called `{name}`");
                let error = self.document.error(&node.span, message);
                return Err(names::with_advice(error, name, &known));
            }
        };
        Err(self.document.error(&node.span, message).with_help(help))
    }

    /// The keys of the shape that is named, or an error that lists the shapes there are.
    fn shape_keys(&self, node: &Node) -> Result<&'static [KeyInfo], Error> {
        let known: Vec<&str> = SHAPES.iter().map(|s| s.0).collect();
        let list = names::list(&known, "and");
        let Value::Text(name) = &node.value else {
            let expected = format!("one of {list}");
            return Err(mismatch(self.document, "shape", node, &expected));
        };
        if let Some((_, own)) = SHAPES.iter().find(|s| s.0 == name) {
            return Ok(own);
        }
        let message = format!("shape: expected one of {list}, found {name:?}");
        let error = self.document.error(&node.span, message);
        Err(names::with_closest(error, name, &known))
    }

    /// `material` or `materials`, as indices.
    fn stated_materials(&self, section: &Section<'a>) -> Result<Option<Vec<usize>>, Error> {
        let expected = "a list of material names";
        match (
            section.get("material"),
            section.list("materials", expected)?,
        ) {
            (Some(_), Some(_)) => Err(section.error_at(
                "materials",
                "an object has `material` or `materials`, not both",
            )),
            (Some(node), None) => {
                let name = section.text("material")?.unwrap_or_default();
                Ok(Some(vec![self.material_index(node, name)?]))
            }
            (None, Some([])) => Err(section.error_at("materials", "expected at least one name")),
            (None, Some(items)) => {
                let index = |node: &Node| match &node.value {
                    Value::Text(name) => self.material_index(node, name),
                    _ => Err(section.mismatch("materials", node, "a material name")),
                };
                items.iter().map(index).collect::<Result<_, _>>().map(Some)
            }
            (None, None) => Ok(None),
        }
    }

    fn material_index(&self, node: &Node, name: &str) -> Result<usize, Error> {
        if let Some(index) = self.material_index.get(name) {
            return Ok(*index);
        }
        let known: Vec<&str> = self
            .scene
            .materials
            .iter()
            .map(|m| m.name.as_str())
            .collect();
        let message = format!("there is no material called `{name}`");
        let error = self.document.error(&node.span, message);
        Err(match names::advice(name, &known) {
            Some(advice) => error.with_help(advice),
            None => error.with_help(format!("add [material.{name}]")),
        })
    }

    /// Adds a material under its name.
    pub(super) fn push_material(&mut self, material: Material) -> usize {
        let index = self.scene.materials.len();
        self.material_index.insert(material.name.clone(), index);
        self.scene.materials.push(material);
        index
    }

    fn gl_default_material(&mut self) -> usize {
        match self.default_material {
            Some(index) => index,
            None => {
                let index = self.push_material(obj::default_material());
                *self.default_material.insert(index)
            }
        }
    }

    fn mesh_file(&mut self, section: &Section<'a>) -> Result<obj::Shared, Error> {
        let file = section.text("mesh")?.unwrap_or_default();
        let smooth = section.bool("smooth")?;
        if !file.to_lowercase().ends_with(".obj") {
            let message = format!("expected an OBJ file, found {file:?}");
            return Err(section.error_at("mesh", message));
        }
        let key = (file.to_owned(), smooth);
        if let Some(shared) = self.models.get(&key) {
            return Ok(shared.clone());
        }
        if !self.home.exists(file) {
            let message = format!("there is no file {}", self.home.name(file));
            return Err(section
                .error_at("mesh", message)
                .with_help("a mesh file is looked for beside the scene file"));
        }
        let model = obj::load(self.home, file, smooth, false)?;
        self.notes.extend(model.notes);
        let mut indices = Vec::with_capacity(model.materials.len());
        for material in model.materials {
            indices.push(self.add_material(file, material));
        }
        let part = model.parts.into_iter().next().ok_or_else(|| {
            Error::input(Place::file(self.home.name(file)), "the mesh has no face")
        })?;
        let shared = obj::Shared {
            materials: part.materials.iter().map(|m| indices[*m]).collect(),
            mesh: part.mesh,
        };
        self.models.insert(key, shared.clone());
        Ok(shared)
    }

    /// Adds a mesh file's material; a name that is taken gets the file's in front.
    fn add_material(&mut self, file: &str, mut material: Material) -> usize {
        if let Some(index) = self.material_index.get(&material.name) {
            if self.scene.materials[*index] == material {
                return *index;
            }
            material.name = format!("{file}:{}", material.name);
        }
        self.push_material(material)
    }

    /// Refuses scenes that show meshes so often that they have too many triangles.
    fn count_mesh(&mut self, section: &Section<'_>, geometry: &Geometry) -> Result<(), Error> {
        let Geometry::Mesh(mesh) = geometry else {
            return Ok(());
        };
        self.mesh_triangles += mesh.triangles.len() as u64;
        if self.mesh_triangles <= MAX_MESH_TRIANGLES {
            return Ok(());
        }
        let count = self.mesh_triangles;
        let message =
            format!("the scene's meshes have {count} triangles, more than {MAX_MESH_TRIANGLES}");
        Err(section.error(message))
    }
}

/// World from object of an instance: first the original's transform, then its own.
fn placed(section: &Section<'_>, own: &DAffine3, original: &Object) -> Result<DAffine3, Error> {
    let place = *own * original.world_from_object;
    let det = place.matrix3.determinant();
    if place.is_finite() && det.is_finite() && det != 0.0 {
        return Ok(place);
    }
    let message = format!(
        "its transform and that of {} together leave the number range",
        original.name
    );
    Err(section.error_at("instance", message))
}
