//! `probe requirements`: a file of abstract scenes on standard input, the features that each one needs as one JSON list.

#[path = "../common/descriptor.rs"]
mod descriptor;

use serde_json::Value;

use super::Failure;

/// One list of sorted names a scene.
pub(super) fn answer(text: &str) -> Result<Value, Failure> {
    let scenes: Vec<Value> = serde_json::from_str(text)?;
    let lists = scenes.iter().enumerate().map(|(i, v)| {
        let names = descriptor::required(v);
        names.map_err(|e| Failure::from(format!("scene {i}, {}: {e}", v["name"])))
    });
    Ok(Value::from(
        lists
            .map(|l| Ok(Value::from(l?)))
            .collect::<Result<Vec<_>, Failure>>()?,
    ))
}
