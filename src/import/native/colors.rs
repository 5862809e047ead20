//! `color_material`: which materials follow the vertex colours (GL 2.1 section 2.14.3).
//!
//! `light_model.color_material` holds for every material that does not state its own. As in GL, a vertex without a colour
//! has the current colour, white.

use super::Reader;
use crate::error::Error;
use crate::gl::{ColorMaterial, ColorMaterialMode, Face};
use crate::import::document::Value;
use crate::import::keys;
use crate::import::reader::Section;
use crate::scene::Geometry;

/// `color_material` of a section: `None` where it is not stated, `Some(None)` where it is off.
pub(super) fn color_material(
    section: &Section<'_>,
) -> Result<Option<Option<ColorMaterial>>, Error> {
    let Some(node) = section.get("color_material") else {
        return Ok(None);
    };
    match &node.value {
        Value::Bool(on) => Ok(Some(on.then(ColorMaterial::default))),
        Value::Table(_) => {
            let path = format!("{}.color_material", section.path);
            let span = node.span.clone();
            let rows = [keys::COLOR_MATERIAL];
            let table = Section::open(section.document, path, span, node, &rows)?;
            let on = table.bool("enabled")?.unwrap_or(true);
            let setting = ColorMaterial {
                face: table.choice("face", Face::NAMES)?.unwrap_or_default(),
                mode: table
                    .choice("mode", ColorMaterialMode::NAMES)?
                    .unwrap_or_default(),
            };
            Ok(Some(on.then_some(setting)))
        }
        _ => {
            let expected = "true, false or a table { face, mode }";
            Err(section.mismatch("color_material", node, expected))
        }
    }
}

impl Reader<'_> {
    /// Gives the materials their tracked terms; notes colours that nothing follows.
    pub(super) fn track_colors(&mut self) {
        for (index, material) in self.scene.materials.iter_mut().enumerate() {
            let own = self.own_color_material.get(&index);
            let Some(setting) = own.copied().unwrap_or(self.color_material) else {
                continue;
            };
            let (front, back) = (setting.tracked(false), setting.tracked(true));
            if front != back && material.back.is_none() {
                material.back = Some(material.front.clone());
            }
            material.front.tracked = front;
            if let Some(side) = &mut material.back {
                side.tracked = back;
            }
        }
        let tracked = |index: &usize| {
            let material = &self.scene.materials[*index];
            let back = material.back.as_ref().is_some_and(|b| b.tracked.any());
            material.front.tracked.any() || back
        };
        let idle = self.scene.objects.iter().filter(|o| match &o.geometry {
            Geometry::Mesh(mesh) => !mesh.colors.is_empty() && !o.materials.iter().any(tracked),
            Geometry::Shape(_) => false,
        });
        let messages: Vec<String> = idle
            .map(|o| {
                format!(
                    "object {}: `colors` are not used, since color_material is off",
                    o.name
                )
            })
            .collect();
        for message in messages {
            self.note(None, message);
        }
    }
}
