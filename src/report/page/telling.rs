//! Pixels that `compare` explains beforehand, for its page: those that tell most, then a grid.

use super::live::Explained;
use crate::decompose::{CAUSES, Ladder};
use crate::error::Error;
use crate::explain::Setting;
use crate::frame::{LayerIndex, Plane};
use crate::render::Options;
use crate::scene::Scene;
use rayon::prelude::*;
use serde_json::{Number, Value};

/// Columns and rows of the grid.
const GRID: [usize; 2] = [16, 12];
/// Explanations beyond this many bytes of JSON are left out: about a tenth of it once packed.
const MOST: usize = 5_000_000;
/// How many pixels of a cause are shown, far from each other.
const PER_CAUSE: usize = 2;

/// Explains pixels of a scene.
pub(in crate::report) fn explained(
    scene: &Scene,
    ladder: &Ladder,
    options: &Options,
) -> Result<Vec<Explained>, Error> {
    let pixels = pixels(scene, ladder);
    let setting = Setting::new(scene, options.clone())?;
    let explainer = setting.explainer()?;
    let explain = |(at, why): &([usize; 2], String)| {
        let found = explainer.at(at[0] as u32, at[1] as u32)?;
        let mut explanation = serde_json::to_value(&found)
            .map_err(|e| Error::limit(format!("cannot write an explanation: {e}")))?;
        shorten(&mut explanation);
        Ok(Explained {
            pixel: *at,
            why: why.clone(),
            explanation,
        })
    };
    let all = pixels
        .par_iter()
        .map(explain)
        .collect::<Result<Vec<_>, Error>>()?;
    let mut bytes = 0;
    let fits = |e: &Explained| {
        bytes += e.explanation.to_string().len();
        bytes <= MOST
    };
    Ok(all.into_iter().filter(fits).collect())
}

/// Numbers to six significant digits: what a page shows of them.
fn shorten(value: &mut Value) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(shorten),
        Value::Object(map) => map.values_mut().for_each(shorten),
        Value::Number(number) if number.is_f64() => {
            let short = number.as_f64().map(|x| format!("{x:.5e}"));
            let short = short.and_then(|text| text.parse().ok());
            if let Some(short) = short.and_then(Number::from_f64) {
                *number = short;
            }
        }
        _ => {}
    }
}

/// Telling pixels with their reasons, then the grid; each pixel once.
fn pixels(scene: &Scene, ladder: &Ladder) -> Vec<([usize; 2], String)> {
    let (width, height) = (ladder.rungs[0].width, ladder.rungs[0].height);
    let mut found: Vec<([usize; 2], String)> = Vec::new();
    let mut add = |at: [usize; 2], why: String| {
        if !found.iter().any(|(other, _)| *other == at) {
            found.push((at, why));
        }
    };
    for (i, cause) in CAUSES.iter().enumerate() {
        let size = ladder
            .cause(i)
            .map(|c| c.iter().fold(0.0f64, |m, x| m.max(x.abs())));
        for (rank, at) in peaks(&size, PER_CAUSE).into_iter().enumerate() {
            let far = if rank == 0 { "" } else { ", elsewhere" };
            add(at, format!("largest {cause}{far}"));
        }
    }
    let at = LayerIndex {
        lights: scene.enabled_lights().count(),
    };
    for (light, name) in scene.light_names().iter().enumerate() {
        let specular = &ladder.trace_layers.planes[at.light(light) + 2];
        let size = specular.map(|c| f64::from(c.iter().fold(0.0f32, |m, x| m.max(*x))));
        for at in peaks(&size, 1) {
            add(at, format!("brightest highlight of {name}"));
        }
    }
    for y in 0..GRID[1] {
        for x in 0..GRID[0] {
            let at = |k: usize, of: usize, size: usize| (2 * k + 1) * size / (2 * of);
            add(
                [at(x, GRID[0], width), at(y, GRID[1], height)],
                String::new(),
            );
        }
    }
    found
}

/// The places of the largest values above 0, each at least an eighth of the width from the ones before.
fn peaks(size: &Plane<f64>, most: usize) -> Vec<[usize; 2]> {
    let mut found: Vec<[usize; 2]> = Vec::new();
    let far = (size.width / 8) as f64;
    for _ in 0..most {
        let free = |i: &usize| {
            let at = [i % size.width, i / size.width];
            let away = |p: &[usize; 2]| {
                let d = [0, 1].map(|k| at[k] as f64 - p[k] as f64);
                d[0].hypot(d[1]) >= far
            };
            found.iter().all(away)
        };
        let places = (0..size.data.len()).filter(|i| size.data[*i] > 0.0);
        // The first of equal ones.
        let best = places
            .filter(free)
            .reduce(|a, b| if size.data[b] > size.data[a] { b } else { a });
        found.extend(best.map(|i| [i % size.width, i / size.width]));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_are_large_and_apart() {
        let mut size = Plane::filled(80, 10, 0.0);
        for (x, value) in [(10, 3.0), (12, 2.9), (40, 1.0)] {
            size.data[80 + x] = value;
        }
        assert_eq!(peaks(&size, 3), [[10, 1], [40, 1]]);
        assert!(peaks(&Plane::filled(4, 4, 0.0), 2).is_empty());
    }

    #[test]
    fn numbers_are_shortened_and_whole_ones_kept() {
        let mut value = serde_json::json!({"a": [0.123456789, 3, null], "b": 1e-30});
        shorten(&mut value);
        assert_eq!(value.to_string(), r#"{"a":[0.123457,3,null],"b":1e-30}"#);
    }
}
