//! `mesh`: the file that it names, by its extension. The command's material is used for all of it.

use std::sync::Arc;

use super::command::Command;
use super::{File, Reader, off, ray};
use crate::error::Error;
use crate::import::keys::MAX_MESH_TRIANGLES;
use crate::import::lexer::{Token, quote};
use crate::import::obj;
use crate::import::text::{self, MAX_MESH};
use crate::import::tiny;
use crate::scene::{Geometry, Mesh};

impl Reader<'_> {
    pub(super) fn mesh(&mut self, file: &File, command: &mut Command<'_, '_>) -> Result<(), Error> {
        let material = self.material(file, command)?;
        let token = command.name("the file")?;
        let path = self.found(file, command, &token);
        let mesh = match self.meshes.get(&path) {
            Some(mesh) => mesh.clone(),
            None => {
                let mesh = self.read_mesh(&path, command, &token)?;
                self.meshes.insert(path, mesh.clone());
                mesh
            }
        };
        self.mesh_triangles += mesh.triangles.len() as u64;
        if self.mesh_triangles > MAX_MESH_TRIANGLES {
            let message = format!("the meshes have more than {MAX_MESH_TRIANGLES} triangles");
            return Err(command.error(&token, message));
        }
        self.push(file, command, Geometry::Mesh(mesh), material)
    }

    fn read_mesh(
        &mut self,
        path: &str,
        command: &Command<'_, '_>,
        token: &Token<'_>,
    ) -> Result<Arc<Mesh>, Error> {
        let name = self.home.name(path);
        let extension = path.rfind('.').map_or("", |dot| &path[dot + 1..]);
        let extension = extension.to_lowercase();
        if !["off", "ray", "obj"].contains(&extension.as_str()) {
            let message = format!("{} is no mesh file that is imported", quote(token.text));
            return Err(Error::Unsupported {
                place: Some(Box::new(command.lexer.place(token))),
                message,
                help: Some("meshes are .off, .ray and .obj files".into()),
            });
        }
        if !self.home.exists(path) {
            let error = command.error(token, format!("there is no file {name}"));
            return Err(error.with_help("a mesh file is looked for beside the file that names it"));
        }
        if extension == "obj" {
            let model = obj::load(self.home, path, None, false)?;
            self.notes.extend(model.notes);
            let part = model.parts.into_iter().next();
            return part.map(|part| part.mesh).ok_or_else(|| {
                Error::input(crate::error::Place::file(&name), "the mesh has no face")
            });
        }
        let text = text::plain(&name, self.home.read(path, MAX_MESH)?)?;
        let mesh = match extension.as_str() {
            "off" => off::read(&name, &text, &mut self.notes)?,
            _ => ray::read(&name, &text, &mut self.notes)?,
        };
        self.notes.extend(tiny::note(&mesh, Some(token.text)));
        Ok(Arc::new(mesh))
    }
}

/// No normals where no vertex has one; area-weighted ones for the others where only some have.
pub(super) fn settle_normals(mesh: &mut Mesh) {
    let missing = |i: usize| !mesh.normals[i].length_squared().is_normal();
    let count = mesh.normals.len();
    let without: Vec<usize> = (0..count).filter(|i| missing(*i)).collect();
    if without.len() == count {
        mesh.normals.clear();
    } else if !without.is_empty() {
        let computed = mesh.area_weighted_normals();
        for i in without {
            mesh.normals[i] = computed[i];
        }
    }
}
