//! The small commands: inspect, scenes, schema.

use std::io::Write;

use rastray::error::{Error, Note};
use rastray::import;
use rastray::scene::assembly::Assembly;
use rastray::scene::requirements::{Feature, Mode, Requirements};
use serde_json::json;

use super::options::Verbosity;
use super::{InspectArgs, SceneArgs, ScenesArgs, diagnostic};

/// Imports the scene and says its notes.
pub(crate) fn load(args: &SceneArgs, verbosity: Verbosity) -> Result<import::Imported, Error> {
    let options = import::LoadOptions {
        sets: args.sets.clone(),
    };
    let imported = import::load(&args.scene, &options)?;
    if verbosity != Verbosity::Quiet {
        imported.notes.iter().for_each(diagnostic::note);
    }
    Ok(imported)
}

/// Writes text to standard output; a closed pipe is not an error.
pub(crate) fn print(text: &str) -> Result<(), Error> {
    let mut out = anstream::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    match written {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Error::io("standard output", "write", e))
        }
        _ => Ok(()),
    }
}

/// Prints a JSON value, indented.
pub(crate) fn print_json(value: &serde_json::Value) -> Result<(), Error> {
    print(&format!("{value:#}\n"))
}

pub(crate) fn scenes(args: &ScenesArgs) -> Result<(), Error> {
    let shipped = import::shipped();
    if let Some(name) = &args.name {
        return print(import::shipped_text(name)?);
    }
    if args.json {
        let list = shipped
            .iter()
            .map(|s| json!({"name": s.name, "title": s.title}));
        return print_json(&serde_json::Value::Array(list.collect()));
    }
    let width = shipped.iter().map(|s| s.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for scene in shipped {
        text += &format!("{:width$}  {}\n", scene.name, scene.title);
    }
    text += "\nrastray compare NAME   both pictures and every difference\n";
    text += "rastray scenes NAME    print the scene, to start one's own from\n";
    print(&text)
}

pub(crate) fn schema() -> Result<(), Error> {
    print(&import::schema())
}

pub(crate) fn inspect(args: &InspectArgs) -> Result<(), Error> {
    let imported = load(&args.scene, Verbosity::Quiet)?;
    let scene = &imported.scene;
    let triangles = Assembly::<f32>::new(scene, None)?.triangles.len();
    let needs = Requirements::of(scene, Mode::Trace);
    let features: Vec<(&str, &str)> = needs.iter().map(|(f, why)| (f.name(), why)).collect();
    if args.json {
        let why: serde_json::Map<String, serde_json::Value> = features
            .iter()
            .map(|(name, why)| ((*name).to_owned(), json!(why)))
            .collect();
        return print_json(&json!({
            "triangles": triangles,
            "objects": scene.objects.len(),
            "lights": scene.lights.len(),
            "materials": scene.materials.len(),
            "features": features.iter().map(|(name, _)| *name).collect::<Vec<_>>(),
            "why": why,
            "notes": imported.notes.iter().map(Note::to_string).collect::<Vec<_>>(),
        }));
    }
    let mut text = format!("{}\n\n", imported.source);
    let plural = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
    text += &format!(
        "  {}, {}, {}, {} at the default tessellation\n",
        plural(scene.objects.len(), "object"),
        plural(scene.lights.len(), "light"),
        plural(scene.materials.len(), "material"),
        plural(triangles, "triangle"),
    );
    text += "\nRequires\n";
    text += &table(&features);
    let absent: Vec<&str> = Feature::NAMES
        .iter()
        .filter(|(_, f)| !needs.has(*f))
        .map(|(name, _)| *name)
        .collect();
    text += &format!(
        "\nDoes without\n  {}\n",
        if absent.is_empty() {
            "nothing".into()
        } else {
            absent.join(", ")
        }
    );
    if !imported.notes.is_empty() {
        text += "\nNotes\n";
        for note in &imported.notes {
            text += &format!("  {note}\n");
        }
    }
    print(&text)
}

fn table(rows: &[(&str, &str)]) -> String {
    let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    rows.iter()
        .map(|(name, why)| format!("  {name:width$}  {why}\n"))
        .collect()
}
