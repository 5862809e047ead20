//! `probe trace`: rays given in world space, answered with the `trace` object of `explain --json`.
//!
//! In: a line each, {scene: path or name of a shipped scene, origin, direction, depth (the scene's where it is left out)}.
//! Out: a line each, in order; {"error": ...} where a line, its scene or its ray is wrong. Neighbouring lines of one scene and
//! depth share their preparation.

use std::io::{BufRead, Write};

use rastray::explain::Setting;
use rastray::import::{LoadOptions, load};
use rastray::render::{Options, Precision};
use serde::Deserialize;
use serde_json::{Value, json};

use super::Failure;

/// One line.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    scene: String,
    origin: [f64; 3],
    direction: [f64; 3],
    depth: Option<u32>,
}

/// A line of the input: its number, and what it says.
type Line = (usize, Result<Case, String>);

/// Answers every line; says whether all went well.
pub(crate) fn answer(
    input: impl BufRead,
    precision: Precision,
    out: &mut impl Write,
) -> Result<bool, Failure> {
    let mut lines: Vec<Line> = Vec::new();
    for (i, line) in input.lines().enumerate() {
        let line = line?;
        if !line.trim().is_empty() {
            let case = serde_json::from_str(&line).map_err(|e| e.to_string());
            lines.push((i + 1, case));
        }
    }
    let key = |line: &Line| {
        let case = line.1.as_ref().ok()?;
        Some((case.scene.clone(), case.depth))
    };
    let mut good = true;
    for part in lines.chunk_by(|a, b| key(a).is_some() && key(a) == key(b)) {
        for (answer, (number, _)) in answers(part, precision).into_iter().zip(part) {
            let value = answer.unwrap_or_else(|message| {
                good = false;
                json!({ "error": format!("line {number}: {message}") })
            });
            writeln!(out, "{value}")?;
        }
    }
    Ok(good)
}

/// The answers to lines of one scene and depth.
fn answers(part: &[Line], precision: Precision) -> Vec<Result<Value, String>> {
    let every = |message: String| part.iter().map(|_| Err(message.clone())).collect();
    let case = match &part[0].1 {
        Ok(case) => case,
        Err(message) => return every(message.clone()),
    };
    let mut scene = match load(&case.scene, &LoadOptions::default()) {
        Ok(imported) => imported.scene,
        Err(e) => return every(e.to_string()),
    };
    scene.trace.depth = case.depth.unwrap_or(scene.trace.depth);
    let options = Options {
        precision,
        ..Options::default()
    };
    let setting = match Setting::new(&scene, options) {
        Ok(setting) => setting,
        Err(e) => return every(e.to_string()),
    };
    let explainer = match setting.explainer() {
        Ok(explainer) => explainer,
        Err(e) => return every(e.to_string()),
    };
    let one = |case: &Case| {
        let trace = explainer.along(case.origin, case.direction);
        let trace = trace.map_err(|e| e.to_string())?;
        serde_json::to_value(&trace).map_err(|e| e.to_string())
    };
    part.iter()
        .map(|(_, case)| one(case.as_ref().map_err(Clone::clone)?))
        .collect()
}
