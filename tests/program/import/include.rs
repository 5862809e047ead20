//! `include`: materials of other files.

use super::{failure, load_files, notes};

const LIBRARY: &[u8] = b"[material.red]\ncolor = [1, 0, 0]\n[material.blue]\ncolor = [0, 0, 1]\n";
const BALL: &str = "[object.ball]\nshape = \"sphere\"\nmaterial = \"red\"\n";

fn scene(head: &str) -> Vec<u8> {
    format!("{head}\n{BALL}").into_bytes()
}

#[test]
fn included_materials_come_first_and_can_be_overridden() {
    let own = scene("include = [\"m.toml\"]\n[material.own]\nshininess = 3");
    let files: [(&str, &[u8]); 2] = [("a.toml", &own), ("m.toml", LIBRARY)];
    let imported = load_files(&files, &["material.red.shininess=9"]).unwrap();
    let scene = &imported.scene;
    let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["red", "blue", "own"]);
    assert_eq!(scene.materials[0].front.diffuse, [1.0, 0.0, 0.0]);
    assert_eq!(scene.materials[0].front.shininess, 9.0);
    assert_eq!(scene.objects[0].materials, [0]);
    assert_eq!(imported.files.len(), 2);
    // A library need not be used up; the scene's own materials are there to be used.
    let notes = notes(&imported);
    assert!(notes.ends_with("no object uses material `own`"), "{notes}");
}

#[test]
fn includes_nest_and_are_read_once() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    let main = scene("include = [\"sub/b.toml\", \"sub/c.toml\"]");
    let inner: &[u8] = b"include = [\"c.toml\"]\n[material.green]\ncolor = 1\n";
    for (name, text) in [
        ("a.toml", &main[..]),
        ("sub/b.toml", inner),
        ("sub/c.toml", LIBRARY),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let imported = super::load_with(&folder.path().join("a.toml"), &[]).unwrap();
    let names: Vec<&str> = imported
        .scene
        .materials
        .iter()
        .map(|m| m.name.as_str())
        .collect();
    assert_eq!(names, ["red", "blue", "green"]);
    assert_eq!(imported.files.len(), 3);
}

#[test]
fn the_scene_files_convention_holds() {
    let own = scene("convention = \"lecture\"\ninclude = [\"m.toml\"]");
    let library = b"[material.red]\nspecular = 0.5\n";
    let imported = load_files(&[("a.toml", &own), ("m.toml", library)], &[]).unwrap();
    assert_eq!(imported.scene.materials[0].optics.reflection, [0.5; 3]);
}

/// What the main file starts with, the library, and what is said: of the library where it starts with its name.
#[rustfmt::skip] // a table
const BROKEN: &[(&str, &str, &str)] = &[
    ("include = [3]", "", "a.toml:1:12: include: expected a file name, found 3"),
    ("include = [\"none.toml\"]", "", "a.toml:1:12: include: there is no file none.toml"),
    ("include = [\"a.toml\"]", "", "a.toml:1:12: include: a.toml includes itself"),
    ("include = [\"m.toml\"]", "include = [\"a.toml\"]", "m.toml:1:12: include: a.toml includes itself"),
    ("include = [\"m.toml\"]", "[material.red]\nshinyness = 3", "m.toml:2:1: material.red has no key `shinyness`"),
    ("include = [\"m.toml\"]", "[material.red]\nshininess = -3", "m.toml:2:13: shininess: expected a number, 0 or more, found -3"),
    ("include = [\"m.toml\"]", "[material.red\n", "m.toml:1:14: unclosed table, expected `]`"),
    ("include = [\"m.toml\"]", "[object.x]\nshape = \"box\"", "m.toml:1:2: an included file holds materials only, found `object`"),
    ("include = [\"m.toml\"]", "material = 3", "m.toml:1:12: material: expected a table, found 3"),
    ("include = [\"m.toml\"]\n[material.red]\ncolor = 1", "[material.red]\ncolor = 1", "a.toml:2:11: there is a material `red` in m.toml already"),
    ("include = [\"m.toml\"]\nmaterial = 3", "[material.red]\ncolor = 1", "a.toml:2:12: material: expected a table, found 3"),
];

#[test]
fn broken_includes_say_where() {
    for (head, library, expected) in BROKEN {
        let own = scene(head);
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.toml"), own).unwrap();
        std::fs::write(folder.path().join("m.toml"), format!("{library}\n")).unwrap();
        let error = super::load_with(&folder.path().join("a.toml"), &[]).unwrap_err();
        let found = error
            .to_string()
            .replace(&format!("{}/", folder.path().display()), "");
        assert_eq!(&found, expected, "{head} / {library}");
    }
    let own = scene("");
    let files: [(&str, &[u8]); 2] = [("a.toml", &own), ("m.toml", LIBRARY)];
    let (message, _) = failure(load_files(&files, &["include=[\"m.toml\"]"]));
    assert_eq!(
        message,
        "include: files are included by the scene file only"
    );
}
