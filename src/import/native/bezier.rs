//! `shape = "bezier"` and `shape = "teapot"`: patches written in the scene file, in a file of their own, or known to the program.

use super::Reader;
use super::mesh::tuples;
use crate::error::Error;
use crate::import::bpt;
use crate::import::document::{Node, Value};
use crate::import::keys::{MAX_PATCH_POINTS, MAX_PATCHES};
use crate::import::reader::Section;
use crate::import::text::{self, MAX_TEXT};
use crate::math::DVec3;
use crate::scene::{Shape, teapot};

/// What `patches` holds.
const EXPECTED: &str = "a list of patches of 16 point numbers each, or the name of a file";

impl<'a> Reader<'a> {
    /// Patches by number of point, or from a file.
    pub(super) fn bezier(&mut self, section: &Section<'a>) -> Result<Shape, Error> {
        let (points, patches) = match section.get("patches") {
            None => {
                let message = "expected `patches`, with `points` or as the name of a file";
                return Err(section.error(message));
            }
            Some(Node {
                value: Value::Text(file),
                ..
            }) => self.patch_file(section, file)?,
            Some(_) => written(section)?,
        };
        Ok(Shape::Bezier {
            points: points.into(),
            patches: patches.into(),
        })
    }

    fn patch_file(&self, section: &Section<'a>, file: &str) -> Result<bpt::Patches, Error> {
        if section.has("points") {
            let message = "does not go with a file of patches, which has its own";
            return Err(section.error_at("points", message));
        }
        let name = self.home.name(file);
        if !self.home.exists(file) {
            let message = format!("there is no file {name}");
            return Err(section
                .error_at("patches", message)
                .with_help("a file of patches is looked for beside the scene file"));
        }
        let text = text::utf8(&name, self.home.read(file, MAX_TEXT)?)?;
        bpt::read(&name, &text)
    }
}

/// `points` and `patches`.
fn written(section: &Section<'_>) -> Result<bpt::Patches, Error> {
    let items = section.list("patches", EXPECTED)?.unwrap_or_default();
    let Some(points) = tuples::<3>(section, "points")? else {
        return Err(section.error_at("patches", "expected `points` for its numbers"));
    };
    let points: Vec<DVec3> = points.into_iter().map(DVec3::from_array).collect();
    if points.is_empty() || points.len() > MAX_PATCH_POINTS as usize {
        let found = points.len();
        let message = format!("expected from 1 to {MAX_PATCH_POINTS} points, found {found}");
        return Err(section.error_at("points", message));
    }
    if items.is_empty() || items.len() > MAX_PATCHES as usize {
        let message = format!(
            "expected from 1 to {MAX_PATCHES} patches, found {}",
            items.len()
        );
        return Err(section.error_at("patches", message));
    }
    let last = points.len() as u32 - 1;
    let patch = |node: &Node| {
        let Value::List(numbers) = &node.value else {
            return Err(section.mismatch("patches", node, EXPECTED));
        };
        let mut patch = [0; 16];
        if numbers.len() != patch.len() {
            let found = numbers.len();
            let message = format!("patches: expected 16 point numbers, found {found}");
            return Err(section.document.error(&node.span, message));
        }
        for (index, number) in patch.iter_mut().zip(numbers) {
            *index = section.integer_of("patches", number, 0, last)?;
        }
        Ok(patch)
    };
    let patches = items.iter().map(patch).collect::<Result<_, _>>()?;
    Ok((points, patches))
}

/// The Utah teapot, as wide or as high as asked for.
pub(super) fn teapot(section: &Section<'_>) -> Result<Shape, Error> {
    let base = section.vector("base")?.unwrap_or_default();
    let scale = match (section.number("radius")?, section.number("height")?) {
        (Some(_), Some(_)) => {
            let message = "a teapot has `radius` or `height`, not both";
            return Err(section.error_at("height", message));
        }
        (radius, None) => radius.unwrap_or(1.0) / teapot::RADIUS,
        (None, Some(height)) => height / teapot::HEIGHT,
    };
    Ok(teapot::teapot(base, scale))
}
