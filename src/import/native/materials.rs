//! `[material.NAME]`.

use super::Reader;
use super::colors::color_material;
use crate::error::Error;
use crate::gl;
use crate::import::document::{Key, Node, Value};
use crate::import::keys;
use crate::import::reader::Section;
use crate::math::color::Rgb;
use crate::scene::{Fresnel, Material, Optics};

impl<'a> Reader<'a> {
    pub(super) fn material(&mut self, key: &Key, node: &'a Node) -> Result<(), Error> {
        let path = format!("material.{}", key.name);
        let rows = [keys::SURFACE, keys::MATERIAL];
        let section = Section::open(self.document, path, key.span.clone(), node, &rows)?;
        let front = self.surface(&section)?;
        let back = self.back(&section)?;
        if back.is_some() {
            self.back_without_two_sides.push(key.name.clone());
        }
        if let Some(own) = color_material(&section)? {
            let index = self.scene.materials.len();
            self.own_color_material.insert(index, own);
        }
        let reflection = match weight(&section, front.specular)? {
            Some(stated) => stated,
            None if self.lecture => front.specular,
            None => [0.0; 3],
        };
        let optics = Optics {
            reflection,
            transmission: section.color("transmission")?.unwrap_or_default(),
            ior: section.number("ior")?.unwrap_or(1.0),
            thin: section.bool("thin")?.unwrap_or(false),
            fresnel: section
                .choice("fresnel", Fresnel::NAMES)?
                .unwrap_or_default(),
        };
        self.push_material(Material {
            name: key.name.clone(),
            front,
            back,
            optics,
        });
        Ok(())
    }

    fn back(&mut self, section: &Section<'a>) -> Result<Option<gl::Material>, Error> {
        let Some(node) = section.get("back") else {
            return Ok(None);
        };
        let path = format!("{}.back", section.path);
        let span = node.span.clone();
        let back = Section::open(self.document, path, span, node, &[keys::SURFACE])?;
        self.surface(&back).map(Some)
    }

    fn surface(&mut self, section: &Section<'_>) -> Result<gl::Material, Error> {
        let mut material = gl::Material::default();
        if let Some(color) = section.color("color")? {
            for key in ["ambient", "diffuse"] {
                if section.has(key) {
                    let message = "`color` sets ambient and diffuse together";
                    let help = format!("remove `color` or `{key}`");
                    return Err(section.error_at(key, message).with_help(help));
                }
            }
            material.ambient = color;
            material.diffuse = color;
        }
        if let Some(emission) = section.color("emission")? {
            material.emission = emission;
        }
        if let Some(ambient) = section.color("ambient")? {
            material.ambient = ambient;
        }
        if let Some(diffuse) = section.color("diffuse")? {
            material.diffuse = diffuse;
        }
        if let Some(specular) = section.color("specular")? {
            material.specular = specular;
        }
        if let Some(shininess) = section.number("shininess")? {
            material.shininess = shininess;
        }
        for violation in material.range_violations() {
            let span = section.get(violation.parameter).map(|node| &node.span);
            self.note(span, super::gl_would_refuse(&section.path, &violation));
        }
        Ok(material)
    }
}

/// `reflection`: a colour, or "K_S".
fn weight(section: &Section<'_>, specular: Rgb) -> Result<Option<Rgb>, Error> {
    match section.get("reflection") {
        Some(node) => match &node.value {
            Value::Text(text) if text == "K_S" => Ok(Some(specular)),
            Value::Text(_) => {
                let expected = "a number, [red, green, blue] or \"K_S\"";
                Err(section.mismatch("reflection", node, expected))
            }
            _ => section.color("reflection"),
        },
        None => Ok(None),
    }
}
