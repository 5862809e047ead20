//! Importers: shipped scenes, error messages with their places, OBJ features, overrides.

mod broken;
mod doubts;
mod include;
mod lines;
mod mesh;
mod mutate;
mod names;
mod polygons;
mod schema;
mod scn;
mod strict;
mod values;

use std::path::Path;

use rastray::error::Error;
use rastray::import::{Imported, LoadOptions, load, shipped};
use rastray::scene::{Geometry, Mesh, Scene};

fn load_with(path: &Path, sets: &[&str]) -> Result<Imported, Box<Error>> {
    let sets = sets.iter().map(|s| s.to_string()).collect();
    Ok(load(
        path.to_str().unwrap(),
        &LoadOptions {
            sets,
            ..LoadOptions::default()
        },
    )?)
}

/// Loads a text as a file of this name, in a folder of its own.
fn load_text(file: &str, text: impl AsRef<[u8]>, sets: &[&str]) -> Result<Imported, Box<Error>> {
    load_files(&[(file, text.as_ref())], sets)
}

/// Writes the files to a folder of their own and loads the first.
fn load_files(files: &[(&str, &[u8])], sets: &[&str]) -> Result<Imported, Box<Error>> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    load_with(&folder.path().join(files[0].0), sets).map_err(|mut error| {
        // The folder's name is new each time.
        if let Error::Input { message, .. } = &mut *error {
            *message = message.replace(&format!("{}/", folder.path().display()), "");
        }
        error
    })
}

fn scene(text: &str) -> Scene {
    load_text("scene.toml", text, &[]).unwrap().scene
}

/// An error as "line:column message" (or "message" where it has no line), and its help.
fn failure(result: Result<Imported, Box<Error>>) -> (String, String) {
    let error = result.expect_err("an error");
    let help = error.help().unwrap_or_default().to_owned();
    let message = match &*error {
        Error::Input { message, .. }
        | Error::Unsupported { message, .. }
        | Error::Parameter { message, .. }
        | Error::Limit { message, .. } => message.clone(),
        Error::Io { .. } => error.to_string(),
    };
    let text = match error.place() {
        Some(place) if place.line > 0 => {
            // The caret stays inside the line that is shown.
            let columns = place.text.chars().count();
            assert!(place.column <= columns + 1, "{place:?}");
            assert!(place.column + place.length <= columns + 2, "{place:?}");
            format!("{}:{} {message}", place.line, place.column)
        }
        _ => message,
    };
    (text, help)
}

fn notes(imported: &Imported) -> String {
    let notes: Vec<String> = imported.notes.iter().map(|n| n.message.clone()).collect();
    notes.join("\n")
}

fn mesh_of(scene: &Scene, object: usize) -> &Mesh {
    match &scene.objects[object].geometry {
        Geometry::Mesh(mesh) => mesh,
        Geometry::Shape(shape) => panic!("{shape:?} is no mesh"),
    }
}

#[test]
fn shipped_scenes_load() {
    for scene in shipped() {
        let imported = load(scene.name, &LoadOptions::default()).unwrap();
        assert!(
            imported.notes.is_empty(),
            "{}: {:?}",
            scene.name,
            imported.notes
        );
        assert!(!imported.scene.objects.is_empty());
        assert!(scene.title.ends_with(['.', '?']), "{}", scene.title);
        assert_eq!(imported.scene.name, scene.name);
    }
}

#[test]
fn an_existing_file_wins_over_a_shipped_name() {
    let (message, help) = failure(load("whited", &LoadOptions::default()).map_err(Box::new));
    assert_eq!(
        message,
        "there is no file `whited`, and no shipped scene of that name"
    );
    assert_eq!(help, "did you mean `whitted`?");
    let (_, help) =
        failure(load("nothing/like/it.toml", &LoadOptions::default()).map_err(Box::new));
    assert_eq!(help, "`rastray scenes` lists the shipped ones");
    let (_, help) =
        failure(load("tests/data/shape.toml", &LoadOptions::default()).map_err(Box::new));
    assert_eq!(help, "did you mean `tests/data/shapes.toml`?");
}
