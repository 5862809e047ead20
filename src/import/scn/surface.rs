//! `material`, the default material, and the material numbers of everything else.

use super::command::Command;
use super::{File, Reader};
use crate::error::Error;
use crate::gl;
use crate::import::lexer::quote;
use crate::import::native::gl_would_refuse;
use crate::math::color::Rgb;
use crate::scene::{Material, Optics};

/// The material of what has none, as the format has it.
fn default_material() -> Material {
    Material {
        name: "(default)".into(),
        front: gl::Material {
            ambient: [0.2; 3],
            diffuse: [0.5; 3],
            specular: [0.5; 3],
            shininess: 10.0,
            ..gl::Material::default()
        },
        back: None,
        optics: Optics {
            reflection: [0.5; 3],
            ..Optics::default()
        },
    }
}

impl Reader<'_> {
    /// The next argument, a material number, as an index into the scene's materials.
    pub(super) fn material(
        &mut self,
        file: &File,
        command: &mut Command<'_, '_>,
    ) -> Result<usize, Error> {
        let stated = self.stated_material(file, command)?;
        Ok(stated.unwrap_or_else(|| self.default_material()))
    }

    /// The same; `None` is the default material, which is made where an object needs it.
    pub(super) fn stated_material(
        &self,
        file: &File,
        command: &mut Command<'_, '_>,
    ) -> Result<Option<usize>, Error> {
        let (number, token) = command.integer("the material")?;
        if number < 0 {
            return Ok(file.group().and_then(|group| group.material));
        }
        let known = usize::try_from(number).ok();
        if let Some(index) = known.and_then(|i| file.materials.get(i)) {
            return Ok(Some(*index));
        }
        let message = match file.materials.len() {
            0 => format!("material {number}: the file has none so far"),
            1 => format!("material {number}: the file has only number 0 so far"),
            n => format!("material {number}: the file has only 0 to {} so far", n - 1),
        };
        let help = "materials count from 0 in each file, in the order in which they stand; -1 is the group's";
        Err(command.error(&token, message).with_help(help))
    }

    fn default_material(&mut self) -> usize {
        match self.default_material {
            Some(index) => index,
            None => {
                let index = self.contents.materials.len();
                self.contents.materials.push(default_material());
                *self.default_material.insert(index)
            }
        }
    }

    /// `material ka kd ks kt e n ir texture`.
    pub(super) fn read_material(
        &mut self,
        file: &mut File,
        command: &mut Command<'_, '_>,
    ) -> Result<(), Error> {
        let [ambient, diffuse, specular, transmission, emission] = [
            command.color("ka")?,
            command.color("kd")?,
            command.color("ks")?,
            command.color("kt")?,
            command.color("e")?,
        ];
        let (shininess, token) = command.number("n")?;
        if shininess < 0.0 {
            let message = format!("expected n, the shininess, to be 0 or more, found {shininess}");
            return Err(command.error(&token, message));
        }
        let ior = index_of_refraction(command, &transmission)?;
        let texture = command.name("the texture")?;
        if texture.text != "0" {
            let message = format!(
                "the texture {} is not read: textures are not in this version",
                quote(texture.text)
            );
            self.note_at(command, "(texture)", message);
        }
        let front = gl::Material {
            emission,
            ambient,
            diffuse,
            specular,
            shininess,
            ..gl::Material::default()
        };
        let own = format!("m{}", file.materials.len());
        // The scene file's own materials have plain names.
        let name = match self.open_files.len() {
            0 | 1 => own,
            _ => format!("{}:{own}", file.path),
        };
        for violation in front.range_violations() {
            let message = gl_would_refuse(&format!("material {name}"), &violation);
            self.note_at(command, "(range)", message);
        }
        let material = Material {
            name,
            front,
            back: None,
            optics: Optics {
                reflection: specular,
                transmission,
                ior,
                ..Optics::default()
            },
        };
        file.materials.push(self.scene_material(material));
        Ok(())
    }

    /// The index of a material; a file that is included twice has its materials once.
    fn scene_material(&mut self, material: Material) -> usize {
        let materials = &mut self.contents.materials;
        if let Some(index) = self.material_of_name.get(&material.name)
            && materials[*index] == material
        {
            return *index;
        }
        self.material_of_name
            .insert(material.name.clone(), materials.len());
        materials.push(material);
        materials.len() - 1
    }
}

/// `ir`; 0 and the like occur in files that transmit nothing, where it means nothing.
fn index_of_refraction(command: &mut Command<'_, '_>, transmission: &Rgb) -> Result<f64, Error> {
    let (ior, token) = command.number("ir")?;
    if ior > 0.0 {
        return Ok(ior);
    }
    if transmission.iter().all(|kt| *kt == 0.0) {
        return Ok(1.0);
    }
    let message = format!("expected ir, the index of refraction, above 0, found {ior}");
    Err(command
        .error(&token, message)
        .with_help("1 lets rays go straight on; glass has 1.5"))
}
