//! `[light.NAME]`.

use super::Reader;
use crate::error::Error;
use crate::gl::LightSource;
use crate::import::document::{Key, Node, Value};
use crate::import::keys;
use crate::import::reader::Section;
use crate::math::DVec3;
use crate::scene::{Light, LightSpace};

impl<'a> Reader<'a> {
    pub(super) fn light(&mut self, key: &Key, node: &'a Node) -> Result<(), Error> {
        let path = format!("light.{}", key.name);
        let section = Section::open(self.document, path, key.span.clone(), node, &[keys::LIGHT])?;
        let mut source = LightSource {
            position: position(&section)?,
            ..LightSource::default()
        };
        if let Some(ambient) = section.color("ambient")? {
            source.ambient = ambient;
        }
        if let Some(diffuse) = section.color("diffuse")? {
            source.diffuse = diffuse;
        }
        source.specular = section.color("specular")?.unwrap_or(source.diffuse);
        if let Some(attenuation) = section.vector("attenuation")? {
            source.attenuation = attenuation.to_array();
        }
        if let Some(direction) = section.direction("spot_direction")? {
            source.spot_direction = direction.to_array();
        }
        if let Some(exponent) = section.number("spot_exponent")? {
            source.spot_exponent = exponent;
        }
        if let Some(cutoff) = section.number("spot_cutoff")? {
            source.spot_cutoff_deg = cutoff;
        }
        let light = Light {
            name: key.name.clone(),
            source,
            space: section
                .choice("space", LightSpace::NAMES)?
                .unwrap_or_default(),
            enabled: section.bool("enabled")?.unwrap_or(true),
        };
        self.light_notes(&section, &light);
        self.scene.lights.push(light);
        Ok(())
    }

    fn light_notes(&mut self, section: &Section<'_>, light: &Light) {
        let source = &light.source;
        for violation in source.range_violations() {
            let span = section.get(violation.parameter).map(|node| &node.span);
            self.note(span, super::gl_would_refuse(&section.path, &violation));
        }
        let directional = source.position[3] == 0.0;
        if directional && source.position == [0.0; 4] {
            let message = format!(
                "{}: a direction of zero length lights nothing",
                section.path
            );
            self.note(Some(&section.span), message);
        }
        if directional && section.has("attenuation") {
            let span = section.get("attenuation").map(|node| &node.span);
            let path = &section.path;
            let message = format!("{path}: attenuation has no effect on a directional light");
            self.note(span, message);
        }
        if !directional && source.attenuation == [0.0; 3] {
            let span = section.get("attenuation").map(|node| &node.span);
            let path = &section.path;
            let message = format!(
                "{path}: attenuation [0, 0, 0] makes the light infinitely bright; [1, 0, 0] is none"
            );
            self.note(span, message);
        }
        let no_cone = source.spot_cutoff_deg == 180.0;
        for key in ["spot_direction", "spot_exponent"] {
            if no_cone && section.has(key) {
                let span = section.get(key).map(|node| &node.span);
                let message = format!("{}: {key} has no effect without spot_cutoff", section.path);
                self.note(span, message);
            }
        }
    }
}

/// `position`, or the opposite of the `direction` in which the light travels.
fn position(section: &Section<'_>) -> Result<[f64; 4], Error> {
    match (section.get("position"), section.direction("direction")?) {
        (Some(_), Some(_)) => Err(section
            .error_at("direction", "a light with a position has no direction")
            .with_help("remove one; the axis of a spot is spot_direction")),
        (None, None) => Err(section
            .error("expected a position, or a direction for a directional light")
            .with_help("add position = [x, y, z] or direction = [x, y, z]")),
        // 0 - x: a zero component stays +0.
        (None, Some(direction)) => {
            let back = DVec3::ZERO - direction;
            Ok([back.x, back.y, back.z, 0.0])
        }
        (Some(node), None) => {
            let expected = "three or four numbers, [x, y, z] or [x, y, z, w]";
            match &node.value {
                Value::List(items) if items.len() == 4 => section.array("position", node, expected),
                _ => {
                    let [x, y, z] = section.array("position", node, expected)?;
                    Ok([x, y, z, 1.0])
                }
            }
        }
    }
}
