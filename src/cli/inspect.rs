//! `rastray inspect`: what a scene contains, which features of the model it requires and why, and what it is spared.

use rastray::error::{Error, Note};
use rastray::import::Imported;
use rastray::render::{Assembled, Precision};
use rastray::scene::requirements::{Mode, Requirements};
use serde_json::{Map, Value, json};

use super::args::InspectArgs;
use super::commands::{load, print, print_json};
use super::options::Verbosity;

pub(crate) fn inspect(args: &InspectArgs) -> Result<(), Error> {
    let imported = load(&args.scene, &[], Verbosity::Quiet)?;
    let triangles = Assembled::unchecked(&imported.scene, None, Precision::F32)?;
    let triangles = triangles.triangles().len();
    let needs = Requirements::of(&imported.scene, Mode::Trace);
    if args.json {
        print_json(&value(&imported, triangles, &needs))
    } else {
        print(&text(&imported, triangles, &needs))
    }
}

fn value(imported: &Imported, triangles: usize, needs: &Requirements) -> Value {
    let scene = &imported.scene;
    let why = needs
        .iter()
        .map(|(f, why)| (f.name().to_owned(), json!(why)));
    let saves = needs
        .absent()
        .map(|(f, saves)| (f.name().to_owned(), json!(saves)));
    json!({
        "triangles": triangles,
        "objects": scene.objects.len(),
        "lights": scene.lights.len(),
        "materials": scene.materials.len(),
        "features": needs.iter().map(|(f, _)| f.name()).collect::<Vec<_>>(),
        "why": why.collect::<Map<_, _>>(),
        "saves": saves.collect::<Map<_, _>>(),
        "notes": imported.notes.iter().map(Note::to_string).collect::<Vec<_>>(),
    })
}

fn text(imported: &Imported, triangles: usize, needs: &Requirements) -> String {
    let scene = &imported.scene;
    let plural = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
    let mut text = format!(
        "{}\n\n  {}, {}, {}, {} at the default tessellation\n",
        imported.source,
        plural(scene.objects.len(), "object"),
        plural(scene.lights.len(), "light"),
        plural(scene.materials.len(), "material"),
        plural(triangles, "triangle"),
    );
    let needed: Vec<_> = needs.iter().map(|(f, why)| (f.name(), why)).collect();
    let absent: Vec<_> = needs.absent().map(|(f, saves)| (f.name(), saves)).collect();
    text += "\nRequires, because of\n";
    text += &table(&needed);
    text += "\nDoes without, and so is spared\n";
    text += &table(&absent);
    let dead = scene.enabled_lights().zip(&needs.live_lights);
    let dead: Vec<_> = dead
        .filter(|(_, live)| !**live)
        .map(|(l, _)| l.name.as_str())
        .collect();
    if !dead.is_empty() {
        text += &format!(
            "\nPasses over lights that no material shows\n  {}\n",
            dead.join(", ")
        );
    }
    if !imported.notes.is_empty() {
        text += "\nNotes\n";
        for note in &imported.notes {
            text += &format!("  {note}\n");
        }
    }
    text
}

fn table(rows: &[(&str, &str)]) -> String {
    let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    if rows.is_empty() {
        return "  nothing\n".into();
    }
    rows.iter()
        .map(|(name, why)| format!("  {name:width$}  {why}\n"))
        .collect()
}
