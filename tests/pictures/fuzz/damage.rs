//! Scene files whose values are exchanged for others, legal and illegal: what the importer lets through, both renderers
//! must draw. (`tests/program/import/mutate.rs` damages bytes, and does not draw.)

use proptest::prelude::*;
use proptest::sample::select;
use rastray::gl::ShadeModel;
use rastray::import::shipped;
use rastray::lanes::Isa;
use rastray::scene::{Geometry, Scene, Shape};
use rastray::{raster, trace};

use crate::common::precise::{assembled, follow, rasterize, rasterizer, tracer};
use crate::common::text::import;

/// Where the numbers and strings of a text stand, comments left out.
fn values(text: &str) -> Vec<std::ops::Range<usize>> {
    let bytes = text.as_bytes();
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let rest = &text[at..];
        let length = match bytes[at] {
            b'#' => rest.find('\n').unwrap_or(rest.len()),
            b'"' => {
                let length = rest[1..].find('"').map_or(rest.len(), |end| end + 2);
                found.push(at..at + length);
                length
            }
            b'0'..=b'9' | b'-' | b'.' => {
                let is_part = |c: char| c.is_ascii_alphanumeric() || "+-._".contains(c);
                let length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
                found.push(at..at + length);
                length
            }
            _ => rest.chars().next().map_or(1, char::len_utf8),
        };
        at += length;
    }
    found
}

/// Numbers that have broken renderers, and things that are no numbers.
const VALUES: &[&str] = &[
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "0.5",
    "1e-320",
    "1e-30",
    "1e-9",
    "1e9",
    "1e30",
    "1e38",
    "1e39",
    "1e300",
    "-1e300",
    "nan",
    "inf",
    "-inf",
    "9223372036854775807",
    "180",
    "90",
    "128",
    "1000",
    "true",
    "\"K_S\"",
    "\"glass\"",
    "[0, 0, 0]",
    "[1, 2]",
    "[]",
    "{}",
    "\"\"",
];

#[derive(Clone, Debug)]
enum Edit {
    /// A value for another.
    Put(usize, &'static str),
    /// A value for one that stands elsewhere in the file.
    Swap(usize, usize),
    /// A line once more.
    Double(usize),
    /// A line less.
    Drop(usize),
}

fn edit() -> impl Strategy<Value = Edit> {
    let at = any::<usize>;
    prop_oneof![
        5 => (at(), select(VALUES)).prop_map(|(at, value)| Edit::Put(at, value)),
        2 => (at(), at()).prop_map(|(to, from)| Edit::Swap(to, from)),
        1 => at().prop_map(Edit::Double),
        1 => at().prop_map(Edit::Drop),
    ]
}

fn apply(text: &mut String, edit: &Edit) {
    let ranges = values(text);
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    if ranges.is_empty() || lines.is_empty() {
        return;
    }
    let range = |i: usize| ranges[i % ranges.len()].clone();
    let line = |i: usize| {
        let start = lines[..i % lines.len()].iter().map(|l| l.len()).sum();
        start..start + lines[i % lines.len()].len()
    };
    let (range, with) = match *edit {
        Edit::Put(at, value) => (range(at), value.to_owned()),
        Edit::Swap(to, from) => (range(to), text[range(from)].to_owned()),
        Edit::Double(at) => (line(at), text[line(at)].repeat(2)),
        Edit::Drop(at) => (line(at), String::new()),
    };
    text.replace_range(range, &with);
}

/// Small enough to draw many of: what costs much and is no question of values is cut.
fn small(mut scene: Scene) -> Scene {
    let image = &mut scene.image;
    (image.width, image.height) = (image.width.min(16), image.height.min(12));
    image.samples = image.samples.min(2);
    scene.trace.depth = scene.trace.depth.min(3);
    for object in &mut scene.objects {
        object.tessellation = Some(object.tessellation.unwrap_or(8).min(8));
        if let Geometry::Shape(Shape::Patch { tiles, .. }) = &mut object.geometry {
            *tiles = tiles.map(|n| n.min(8));
        }
    }
    scene
}

/// Draws it both ways; errors are fine, infinite colours are, NaN is not.
fn draws(scene: &Scene) -> Result<(), TestCaseError> {
    let Ok(assembly) = assembled::<f32>(scene, None) else {
        return Ok(());
    };
    let isa = Isa::detect();
    for shading in [ShadeModel::Gouraud, ShadeModel::Phong] {
        let options = raster::Options {
            shading,
            clamp: false,
            layers: true,
            isa,
        };
        let plan = rasterizer(scene, &assembly);
        if let Ok((frame, _)) = rasterize::<f32>(&plan, &options) {
            prop_assert!(!frame.has_nan(), "{:?}", shading);
        }
    }
    for geometry in [trace::Geometry::Exact, trace::Geometry::Mesh] {
        let plan = tracer(scene, &assembly, geometry);
        let options = trace::Options::of(scene, isa);
        if let Ok((frame, _)) = plan.and_then(|plan| follow::<f32>(&plan, &options)) {
            prop_assert!(!frame.has_nan(), "{:?}", geometry);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(super::config(150))]

    #[test]
    fn what_the_importer_lets_through_can_be_drawn(
        number in 0..shipped().len(),
        edits in proptest::collection::vec(edit(), 1..5),
    ) {
        let mut text = shipped()[number].text.to_owned();
        for edit in &edits {
            apply(&mut text, edit);
        }
        match import(&text) {
            Ok(imported) => draws(&small(imported.scene))?,
            Err(error) => {
                let place = error.place();
                prop_assert!(!error.to_string().is_empty());
                if let Some(place) = place.filter(|p| p.line > 0) {
                    // The caret stays inside the line that is shown.
                    let columns = place.text.chars().count();
                    prop_assert!(place.column <= columns + 1 && place.column + place.length <= columns + 2);
                }
            }
        }
    }
}
