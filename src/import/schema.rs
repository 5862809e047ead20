//! The JSON Schema (draft 2020-12) of the scene file, made from the same tables as the reader.
//!
//! It is for editors: it knows keys, types, ranges, names and defaults, not what keys mean together.

use serde_json::{Map, Value, json};

use super::keys::{self, KeyInfo, Kind, Range, SHAPES};
use crate::scene::profile::MAX_POINTS;

/// The JSON Schema of the scene file, as text.
pub fn schema() -> String {
    let mut text = serde_json::to_string_pretty(&document()).unwrap_or_default();
    text.push('\n');
    text
}

fn document() -> Value {
    let named = |items: Value, doc: &str| {
        json!({
            "type": "object",
            "description": doc,
            "additionalProperties": items,
        })
    };
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "rastray scene",
        "type": "object",
        "properties": {
            "convention": property(&keys::CONVENTION),
            "include": property(&keys::INCLUDE),
            "image": section(&[keys::IMAGE], "Size, background and samples"),
            "camera": section(&[keys::CAMERA], "The view; fitted to the scene where omitted"),
            "light_model": section(&[keys::LIGHT_MODEL], "OpenGL's light model"),
            "raster": section(&[keys::RASTER], "How the rasterizer draws"),
            "trace": section(&[keys::TRACE], "How the tracer recurses"),
            "light": named(light(), "Light sources by name"),
            "material": named(
                section(&[keys::SURFACE, keys::MATERIAL], "A material"),
                "Materials by name",
            ),
            "object": named(object(), "Objects by name"),
        },
        "required": ["object"],
        "additionalProperties": false,
    })
}

fn section(rows: &[&[KeyInfo]], doc: &str) -> Value {
    let mut properties = Map::new();
    for row in rows.iter().flat_map(|rows| rows.iter()) {
        if !matches!(row.kind, Kind::Unsupported(_)) {
            properties.insert(row.name.into(), property(row));
        }
    }
    json!({
        "type": "object",
        "description": doc,
        "properties": properties,
        "additionalProperties": false,
    })
}

fn light() -> Value {
    let mut light = section(&[keys::LIGHT], "A light source");
    light["oneOf"] = json!([{ "required": ["position"] }, { "required": ["direction"] }]);
    light
}

/// An object has one of several forms, each with its own keys.
fn object() -> Value {
    let mut forms: Vec<Value> = SHAPES
        .iter()
        .map(|(name, own)| {
            let mut form = section(&[keys::OBJECT, own], &format!("A {name}"));
            form["properties"]["shape"] = json!({ "const": name });
            require(&mut form, "shape", &["mesh", "instance"])
        })
        .collect();
    let mut mesh = section(&[keys::OBJECT, keys::MESH], "A mesh from a file");
    forms.push(require(&mut mesh, "mesh", &["shape", "instance"]));
    let mut inline = section(&[keys::OBJECT, keys::INLINE], "A mesh written here");
    forms.push(require(
        &mut inline,
        "positions",
        &["shape", "mesh", "instance"],
    ));
    let mut instance = section(&[keys::OBJECT], "Another object once more");
    forms.push(require(&mut instance, "instance", &["shape", "mesh"]));
    json!({ "oneOf": forms })
}

fn require(form: &mut Value, key: &str, without: &[&str]) -> Value {
    if let Some(properties) = form["properties"].as_object_mut() {
        for name in without {
            properties.shift_remove(*name);
        }
    }
    form["required"] = json!([key]);
    form.take()
}

fn property(row: &KeyInfo) -> Value {
    let mut value = kind(row.kind);
    value["description"] = json!(row.doc);
    if !row.default.is_empty()
        && let Ok(default) = serde_json::from_str::<Value>(row.default)
    {
        value["default"] = default;
    }
    value
}

fn number(range: Range) -> Value {
    match range {
        Range::Any => json!({ "type": "number" }),
        Range::AtLeast(low) => json!({ "type": "number", "minimum": low }),
        Range::Above(low) => json!({ "type": "number", "exclusiveMinimum": low }),
        Range::Within(low, high) => json!({ "type": "number", "minimum": low, "maximum": high }),
        Range::Between(low, high) => {
            json!({ "type": "number", "exclusiveMinimum": low, "exclusiveMaximum": high })
        }
    }
}

/// A list of exactly so many of something.
fn list(items: &Value, low: usize, high: usize) -> Value {
    json!({ "type": "array", "items": items, "minItems": low, "maxItems": high })
}

fn numbers(low: usize, high: usize) -> Value {
    list(&number(Range::Any), low, high)
}

fn any_of(forms: &[Value]) -> Value {
    json!({ "anyOf": forms })
}

fn kind(kind: Kind) -> Value {
    let any = number(Range::Any);
    let above = number(Range::Above(0.0));
    let color = || any_of(&[number(Range::Any), numbers(3, 3)]);
    let whole = |low: u32, high: u32| json!({ "type": "integer", "minimum": low, "maximum": high });
    match kind {
        Kind::Number(range) => number(range),
        Kind::Integer(low, high) => whole(low, high),
        Kind::Signed(low, high) => {
            json!({ "type": "integer", "minimum": low, "maximum": high })
        }
        Kind::Bool => json!({ "type": "boolean" }),
        Kind::Text => json!({ "type": "string" }),
        Kind::Choice(names) => json!({ "enum": names() }),
        Kind::Snap => json!({ "enum": [8, 12, "exact"] }),
        Kind::Color => color(),
        Kind::Weight => any_of(&[color(), json!({ "const": "K_S" })]),
        Kind::Vector => numbers(3, 3),
        Kind::Position => numbers(3, 4),
        Kind::DepthRange => list(&number(Range::Within(0.0, 1.0)), 2, 2),
        Kind::Size => any_of(&[above.clone(), list(&above, 2, 2)]),
        Kind::BoxSize => any_of(&[above.clone(), list(&above, 3, 3)]),
        Kind::Scale => any_of(&[any, numbers(3, 3)]),
        Kind::Tiles => {
            let tiles = whole(1, keys::MAX_TILES);
            any_of(&[tiles.clone(), list(&tiles, 2, 2)])
        }
        Kind::Unsupported(_) => json!(false),
        _ => structure(kind),
    }
}

/// The kinds that are lists of lists, or tables.
fn structure(kind: Kind) -> Value {
    let any = number(Range::Any);
    match kind {
        Kind::Numbers => {
            let nested = json!({ "type": "array", "items": numbers(2, 4) });
            any_of(&[json!({ "type": "array", "items": any }), nested])
        }
        Kind::Profile => list(&numbers(2, 2), 2, MAX_POINTS),
        Kind::Matrix => any_of(&[numbers(16, 16), list(&numbers(4, 4), 4, 4)]),
        Kind::Corners => any_of(&[numbers(12, 12), list(&numbers(3, 3), 4, 4)]),
        Kind::Indices => {
            let index = json!({ "type": "integer", "minimum": 0 });
            let face = json!({ "type": "array", "items": index, "minItems": 3 });
            any_of(&[
                json!({ "type": "array", "items": index }),
                json!({ "type": "array", "items": face }),
            ])
        }
        Kind::Patches => {
            let index = json!({ "type": "integer", "minimum": 0 });
            let patches = json!({ "type": "array", "items": list(&index, 16, 16), "minItems": 1 });
            any_of(&[patches, json!({ "type": "string" })])
        }
        Kind::Names => json!({ "type": "array", "items": { "type": "string" }, "minItems": 1 }),
        Kind::Transform => {
            let mut step = section(&[keys::STEPS], "One step");
            step["minProperties"] = json!(1);
            step["maxProperties"] = json!(1);
            json!({ "type": "array", "items": step })
        }
        Kind::Rotation => {
            let mut rotation = section(&[keys::ROTATE], "A rotation");
            rotation["required"] = json!(["axis", "degrees"]);
            rotation
        }
        Kind::ColorMaterial => any_of(&[
            json!({ "type": "boolean" }),
            section(&[keys::COLOR_MATERIAL], "As glColorMaterial takes it"),
        ]),
        Kind::Back => section(&[keys::SURFACE], "The material of back faces"),
        _ => json!({}),
    }
}
