//! `[object.NAME]`: shapes, meshes and what they are made of.

use super::Reader;
use crate::error::{Error, Place};
use crate::import::document::{Key, Node, Value};
use crate::import::keys::{self, FUTURE_SHAPES, MAX_TESSELLATED, MAX_TILES, Range, SHAPES};
use crate::import::reader::{Section, table};
use crate::import::{names, obj};
use crate::math::DVec3;
use crate::scene::{Geometry, Material, Object, Shape};

/// Forms that an object can have, for the message where it has none.
const FORMS: &str = "a `shape`, a `mesh` file, or inline `positions`";

impl<'a> Reader<'a> {
    pub(super) fn object(&mut self, key: &Key, node: &'a Node) -> Result<(), Error> {
        let path = format!("object.{}", key.name);
        let entries = table(self.document, node, &path)?;
        let value = |name: &str| entries.iter().find(|(k, _)| k.name == name).map(|(_, v)| v);
        let forms: Vec<&str> = ["shape", "mesh", "positions"]
            .into_iter()
            .filter(|name| value(name).is_some())
            .collect();
        let own: &'static [keys::KeyInfo] = match forms.as_slice() {
            [] => {
                let message = format!("{path}: expected {FORMS}");
                return Err(self.document.error(&key.span, message));
            }
            ["shape"] => self.shape_keys(value("shape"))?,
            ["mesh"] => keys::MESH,
            ["positions"] => keys::INLINE,
            several => {
                let found = names::list(several, "and");
                let message = format!("{path}: expected one of {FORMS}, found {found}");
                return Err(self.document.error(&key.span, message));
            }
        };
        let rows = [keys::OBJECT, own];
        let section = Section::open(self.document, path, key.span.clone(), node, &rows)?;
        let stated = self.stated_materials(&section)?;
        let world_from_object = self.transform(&section)?;
        let tessellation = match forms.as_slice() {
            ["shape"] => section.integer("tessellation")?,
            _ => None,
        };
        let (geometry, own_materials) = match forms.as_slice() {
            ["shape"] => (self.shape(&section, tessellation)?, None),
            ["mesh"] => {
                let (mesh, materials) = self.mesh_file(&section)?;
                (Geometry::Mesh(mesh), Some(materials))
            }
            _ => (
                Geometry::Mesh(std::sync::Arc::new(self.inline(&section)?)),
                None,
            ),
        };
        let materials = match stated.or(own_materials) {
            Some(materials) => materials,
            None => vec![self.gl_default_material()],
        };
        self.scene.objects.push(Object {
            name: key.name.clone(),
            geometry,
            materials,
            world_from_object,
            tessellation,
        });
        Ok(())
    }

    /// The keys of the shape that is named, or an error that lists the shapes there are.
    fn shape_keys(&self, node: Option<&Node>) -> Result<&'static [keys::KeyInfo], Error> {
        let known: Vec<&str> = SHAPES.iter().map(|s| s.0).collect();
        let Some(Node {
            value: Value::Text(name),
            span,
        }) = node
        else {
            let node = node.unwrap_or(&self.document.root);
            let expected = format!("one of {}", names::list(&known, "and"));
            return Err(super::super::reader::mismatch(
                self.document,
                "shape",
                node,
                &expected,
            ));
        };
        if let Some((_, own)) = SHAPES.iter().find(|s| s.0 == name) {
            return Ok(own);
        }
        let list = names::list(&known, "and");
        if FUTURE_SHAPES.contains(&name.as_str()) {
            return Err(Error::Unsupported {
                place: Some(self.document.place(span)),
                message: format!("shape = \"{name}\" is not supported: this version has {list}"),
                help: None,
            });
        }
        let message = format!("shape: expected one of {list}, found {name:?}");
        let error = self.document.error(span, message);
        Err(match names::closest(name, &known) {
            Some(near) => error.with_help(format!("did you mean `{near}`?")),
            None => error,
        })
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
        let materials = &self.scene.materials;
        if let Some(index) = materials.iter().position(|m| m.name == name) {
            return Ok(index);
        }
        let known: Vec<&str> = materials.iter().map(|m| m.name.as_str()).collect();
        let message = format!("there is no material called `{name}`");
        let error = self.document.error(&node.span, message);
        Err(match names::advice(name, &known) {
            Some(advice) => error.with_help(advice),
            None => error.with_help(format!("add [material.{name}]")),
        })
    }

    fn gl_default_material(&mut self) -> usize {
        let materials = &mut self.scene.materials;
        *self.default_material.get_or_insert_with(|| {
            materials.push(obj::default_material());
            materials.len() - 1
        })
    }

    fn mesh_file(
        &mut self,
        section: &Section<'a>,
    ) -> Result<(std::sync::Arc<crate::scene::Mesh>, Vec<usize>), Error> {
        let file = section.text("mesh")?.unwrap_or_default();
        let smooth = section.bool("smooth")?;
        let lower = file.to_lowercase();
        if !lower.ends_with(".obj") {
            let message = format!("expected an OBJ file, found {file:?}");
            return Err(section.error_at("mesh", message));
        }
        if !self.home.has(file) && !std::path::Path::new(&self.home.name(file)).exists() {
            let message = format!("there is no file {}", self.home.name(file));
            return Err(section
                .error_at("mesh", message)
                .with_help("a mesh file is looked for beside the scene file"));
        }
        let key = (file.to_owned(), smooth);
        if !self.models.contains_key(&key) {
            let model = obj::load(self.home, file, smooth, false)?;
            self.notes.extend(model.notes);
            let mut indices = Vec::new();
            for material in model.materials {
                indices.push(self.add_material(file, material));
            }
            let part = model.parts.into_iter().next();
            let part = part.ok_or_else(|| {
                Error::input(Place::file(self.home.name(file)), "the mesh has no face")
            })?;
            let shared = obj::Shared {
                materials: part.materials.iter().map(|m| indices[*m]).collect(),
                mesh: part.mesh,
            };
            self.models.insert(key.clone(), shared);
        }
        let shared = &self.models[&key];
        Ok((shared.mesh.clone(), shared.materials.clone()))
    }

    /// Adds a mesh file's material; a name that is taken gets the file's in front.
    fn add_material(&mut self, file: &str, mut material: Material) -> usize {
        let materials = &mut self.scene.materials;
        let same = |m: &Material| m.name == material.name;
        if let Some(index) = materials.iter().position(|m| *m == material) {
            return index;
        }
        if materials.iter().any(same) {
            material.name = format!("{file}:{}", material.name);
        }
        materials.push(material);
        materials.len() - 1
    }

    fn shape(
        &mut self,
        section: &Section<'a>,
        tessellation: Option<u32>,
    ) -> Result<Geometry, Error> {
        let name = section.text("shape")?.unwrap_or_default();
        if let (Some(level), "sphere") = (tessellation, name)
            && level < 3
        {
            let message = format!("expected a whole number from 3 to 4096, found {level}");
            return Err(section.error_at("tessellation", message));
        }
        let shape = match name {
            "sphere" => Shape::Sphere {
                center: section.vector("center")?.unwrap_or_default(),
                radius: section.number("radius")?.unwrap_or(1.0),
            },
            "plane" => plane(section)?,
            "quad" if section.has("points") => {
                for key in ["corner", "edge_u", "edge_v", "tessellation"] {
                    if section.has(key) {
                        let message = "does not go with `points`";
                        return Err(section.error_at(key, message));
                    }
                }
                return Ok(Geometry::Mesh(std::sync::Arc::new(super::mesh::quad(
                    section,
                )?)));
            }
            "quad" => quad(section)?,
            "box" => cuboid(section)?,
            _ => floor(section)?,
        };
        self.count_triangles(section, &shape, tessellation)?;
        Ok(Geometry::Shape(shape))
    }

    /// Refuses levels and tiles that together ask for more triangles than a file may.
    fn count_triangles(
        &mut self,
        section: &Section<'_>,
        shape: &Shape,
        tessellation: Option<u32>,
    ) -> Result<(), Error> {
        let cells = u64::from(tessellation.unwrap_or(1));
        let triangles = match shape {
            Shape::Sphere { .. } => {
                let slices = u64::from(tessellation.unwrap_or(64));
                2 * slices * (slices / 2).saturating_sub(1)
            }
            Shape::Patch { tiles: [a, b], .. } => 2 * u64::from(*a) * u64::from(*b) * cells * cells,
            Shape::Box { .. } => 12 * cells * cells,
        };
        self.tessellated += triangles;
        if self.tessellated > MAX_TESSELLATED {
            let message = format!(
                "the scene's shapes ask for {} triangles, more than {MAX_TESSELLATED}",
                self.tessellated
            );
            return Err(section
                .error(message)
                .with_help("lower tessellation or tiles"));
        }
        Ok(())
    }
}

/// A patch through `center`, u to the right as seen from the front with y up.
fn plane(section: &Section<'_>) -> Result<Shape, Error> {
    let center = section.vector("center")?.unwrap_or_default();
    let normal = section.direction("normal")?.unwrap_or(DVec3::Y);
    let [width, depth] = size(section)?;
    let n = DVec3::from_array(crate::math::float::normalize(normal.to_array()).0);
    let sideways = n.x == 0.0 && n.z == 0.0;
    let u = if sideways {
        DVec3::X
    } else {
        DVec3::Y.cross(n).normalize()
    };
    let v = n.cross(u);
    let (edge_u, edge_v) = (u * width, v * depth);
    let corner = center - edge_u / 2.0 - edge_v / 2.0;
    // Adding 0 turns the -0 of a cross product into +0.
    let [corner, edge_u, edge_v] = [corner, edge_u, edge_v].map(|x| x + DVec3::ZERO);
    checked_patch(section, corner, edge_u, edge_v, [1, 1])
}

fn quad(section: &Section<'_>) -> Result<Shape, Error> {
    let part = |key: &str| {
        let found = section.vector(key)?;
        found.ok_or_else(|| {
            section.error(format!(
                "expected `points`, or `corner`, `edge_u` and `edge_v`; `{key}` is missing"
            ))
        })
    };
    let (corner, edge_u, edge_v) = (part("corner")?, part("edge_u")?, part("edge_v")?);
    checked_patch(section, corner, edge_u, edge_v, [1, 1])
}

fn checked_patch(
    section: &Section<'_>,
    corner: DVec3,
    edge_u: DVec3,
    edge_v: DVec3,
    tiles: [u32; 2],
) -> Result<Shape, Error> {
    let normal = edge_u.cross(edge_v);
    if !(normal.length_squared().is_normal() && (corner + edge_u + edge_v).is_finite()) {
        return Err(section.error("its sides span no area that can be computed with"));
    }
    Ok(Shape::Patch {
        corner,
        edge_u,
        edge_v,
        tiles,
    })
}

fn cuboid(section: &Section<'_>) -> Result<Shape, Error> {
    let (min, max) = match (section.vector("min")?, section.vector("max")?) {
        (Some(min), Some(max)) => {
            for key in ["center", "size"] {
                if section.has(key) {
                    return Err(section.error_at(key, "does not go with `min` and `max`"));
                }
            }
            (min, max)
        }
        (None, None) => {
            let center = section.vector("center")?.unwrap_or_default();
            let half = box_size(section)? / 2.0;
            (center - half, center + half)
        }
        _ => return Err(section.error("`min` and `max` go together")),
    };
    if !(min.cmplt(max).all() && (max - min).is_finite()) {
        let message = "expected each coordinate of `min` below that of `max`";
        return Err(section.error_at("max", message));
    }
    Ok(Shape::Box { min, max })
}

fn box_size(section: &Section<'_>) -> Result<DVec3, Error> {
    let above = Range::Above(0.0);
    match section.get("size") {
        None => Ok(DVec3::ONE),
        Some(node) => match &node.value {
            Value::List(items) if items.len() == 3 => {
                let mut size = [0.0; 3];
                for (x, item) in size.iter_mut().zip(items) {
                    *x = section.number_of("size", item, above)?;
                }
                Ok(DVec3::from_array(size))
            }
            Value::List(_) => Err(section.mismatch("size", node, "a number or [x, y, z]")),
            _ => section.number_of("size", node, above).map(DVec3::splat),
        },
    }
}

/// A floor that faces +y: u runs along +x, v along -z (so that u x v = +y).
fn floor(section: &Section<'_>) -> Result<Shape, Error> {
    let center = section.vector("center")?.unwrap_or_default();
    let [width, depth] = size(section)?;
    let corner = center + DVec3::new(-width / 2.0, 0.0, depth / 2.0);
    let (edge_u, edge_v) = (DVec3::X * width, DVec3::new(0.0, 0.0, -depth));
    checked_patch(section, corner, edge_u, edge_v, tiles(section)?)
}

fn size(section: &Section<'_>) -> Result<[f64; 2], Error> {
    let above = Range::Above(0.0);
    match section.get("size") {
        None => Ok([10.0; 2]),
        Some(node) => match &node.value {
            Value::List(items) if items.len() == 2 => Ok([
                section.number_of("size", &items[0], above)?,
                section.number_of("size", &items[1], above)?,
            ]),
            Value::List(_) => Err(section.mismatch("size", node, "a number or [width, depth]")),
            _ => section.number_of("size", node, above).map(|x| [x; 2]),
        },
    }
}

fn tiles(section: &Section<'_>) -> Result<[u32; 2], Error> {
    let one = |node: &Node| section.integer_of("tiles", node, 1, MAX_TILES);
    match section.get("tiles") {
        None => Ok([10; 2]),
        Some(node) => match &node.value {
            Value::List(items) if items.len() == 2 => Ok([one(&items[0])?, one(&items[1])?]),
            Value::List(_) => Err(section.mismatch("tiles", node, "a whole number or two")),
            _ => one(node).map(|x| [x; 2]),
        },
    }
}
