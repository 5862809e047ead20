//! `--strict-gl`: values that real OpenGL would answer with INVALID_VALUE are errors instead of notes.
//!
//! The ranges are those of GL 2.1 tables 2.10 and 2.11, kept with the parameters in [`crate::gl`]; the scene decides, whatever
//! file it came from. The notes of the importer say where a value stands.

use super::Imported;
use crate::error::{Error, Place};
use crate::gl::RangeViolation;

/// The words of a note about a value that real OpenGL refuses.
pub(super) fn refusal(violation: &RangeViolation) -> String {
    format!("{}; evaluated all the same", refused(violation))
}

fn refused(violation: &RangeViolation) -> String {
    let RangeViolation {
        parameter,
        value,
        legal,
    } = violation;
    format!("GL would refuse {parameter} {value} ({legal})")
}

/// Refuses a scene that holds a value outside of GL's range.
///
/// # Errors
/// [`Error::Unsupported`] at the first such value.
pub(super) fn check(imported: &Imported) -> Result<(), Error> {
    let scene = &imported.scene;
    let lights = scene.lights.iter().map(|light| {
        let path = format!("light.{}", light.name);
        (path, &light.name, light.source.range_violations())
    });
    let materials = scene.materials.iter().map(|material| {
        let back = material.back.iter().flat_map(|m| m.range_violations());
        let all = material.front.range_violations().into_iter().chain(back);
        let path = format!("material.{}", material.name);
        (path, &material.name, all.collect())
    });
    let found: Vec<_> = lights
        .chain(materials)
        .flat_map(|(path, name, all)| all.into_iter().map(move |v| (path.clone(), name, v)))
        .collect();
    let Some((path, name, violation)) = found.first() else {
        return Ok(());
    };
    let more = match found.len() {
        1 => String::new(),
        n => format!(" (and {} more)", n - 1),
    };
    Err(Error::Unsupported {
        place: place(imported, name, violation).map(Box::new),
        message: format!("{path}: {}{more}", refused(violation)),
        help: Some("bring it into that range, or leave out --strict-gl".into()),
    })
}

/// Where the importer's note says that the value stands.
fn place(imported: &Imported, name: &str, violation: &RangeViolation) -> Option<Place> {
    let words = refusal(violation);
    let about =
        |note: &&crate::error::Note| note.message.ends_with(&words) && note.message.contains(name);
    imported.notes.iter().find(about)?.place.clone()
}
