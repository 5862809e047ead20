//! Names of materials and paths of files: bytes, quotes, comments, backslashes, capitals.

use super::{load_files, load_with, mesh_of, notes};

const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";
const RED: [f64; 3] = [1.0, 0.0, 0.0];

/// The colour of a face whose material is named so, of a library where it is named so.
fn color(used: &[u8], named: &[u8]) -> Option<[f64; 3]> {
    let obj = [
        &b"mtllib m.mtl\n"[..],
        SQUARE.as_bytes(),
        b"usemtl ",
        used,
        b"\nf 1 2 3 4\n",
    ]
    .concat();
    let mtl = [
        &b"newmtl "[..],
        named,
        b"\nKd 1 0 0 # r\nillum 1\nnewmtl other\nKd 0 1 0\n",
    ]
    .concat();
    let found = load_files(&[("a.obj", &obj[..]), ("m.mtl", &mtl[..])], &[]).unwrap();
    let missing = notes(&found).matches("is in no library").count();
    assert!(missing <= 1);
    (missing == 0).then(|| found.scene.materials[0].front.diffuse)
}

#[test]
fn names_that_mean_the_same_match() {
    for (used, named) in [
        (&b"red"[..], &b"red"[..]),
        (b"red", b"red # the red one"),
        (b"red # here", b"red"),
        (b"red", b"red\t#warm"),
        (b"\"red\"", b"red"),
        (b"red", b"\"red\""),
        (b"'two words'", b"two words"),
        (b"dir\\red", b"dir\\red"),
        (b"dir/red", b"dir\\red"),
        (b".\\red", b"red"),
        (b"red", b"./red"),
        (b"a\\b\\red", b".\\a/b/red"),
        (b"r\xe9d", b"r\xe9d"),
        (b"Material #25", b"Material #25"),
    ] {
        assert_eq!(color(used, named), Some(RED), "{used:?} {named:?}");
    }
    for (used, named) in [
        (&b"red"[..], &b"Red"[..]),
        (b"r\xe9d", b"r\xe8d"),
        (b"M #25", b"M #26"),
    ] {
        assert_eq!(color(used, named), None, "{used:?} {named:?}");
    }
}

#[test]
fn bytes_that_differ_are_names_that_differ() {
    let pairs: [[&[u8]; 2]; 4] = [
        [b"\xe9", b"\xe8"],
        [b"caf\xe9", b"caf\xea"],
        [b"\x95\x5c1", b"\x94\x5c1"],
        [b"\x81", b"\x82"],
    ];
    for [a, b] in pairs {
        let obj = [
            &b"mtllib m.mtl\n"[..],
            SQUARE.as_bytes(),
            b"usemtl ",
            a,
            b"\nf 1 2 3\nusemtl ",
            b,
            b"\nf 1 3 4\n",
        ]
        .concat();
        let mtl = [
            &b"newmtl "[..],
            a,
            b"\nKd 1 0 0\nnewmtl ",
            b,
            b"\nKd 0 1 0\n",
        ]
        .concat();
        let found = load_files(&[("a.obj", &obj[..]), ("m.mtl", &mtl[..])], &[]).unwrap();
        let colors: Vec<_> = found
            .scene
            .materials
            .iter()
            .map(|m| m.front.diffuse)
            .collect();
        assert_eq!(colors, [RED, [0.0, 1.0, 0.0]], "{a:?} {b:?}");
        assert_ne!(found.scene.materials[0].name, found.scene.materials[1].name);
        assert_eq!(mesh_of(&found.scene, 0).slots, [0, 1]);
    }
}

#[test]
fn libraries_are_found_however_they_are_spelt() {
    for (line, said) in [
        ("m.mtl", false),
        ("\"m.mtl\"", false),
        ("m.mtl # materials", false),
        (".\\m.mtl", true),
        ("C:\\models\\m.mtl", true),
        ("..\\tex\\m.mtl", true),
        ("M.MTL", true),
    ] {
        let obj = format!("mtllib {line}\n{SQUARE}usemtl a\nf 1 2 3 4\n");
        let files: [(&str, &[u8]); 2] = [
            ("a.obj", obj.as_bytes()),
            ("m.mtl", b"newmtl a\nKd 1 0 0\n"),
        ];
        let found = load_files(&files, &[]).unwrap();
        assert_eq!(found.scene.materials[0].front.diffuse, RED, "{line}");
        assert_eq!(
            notes(&found).contains("is read"),
            said,
            "{line}: {}",
            notes(&found)
        );
    }
    // Folders with backslashes, for libraries and for the meshes of .scn files.
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    let obj = format!("mtllib sub\\m.mtl\n{SQUARE}usemtl a\nf 1 2 3 4\n");
    for (name, text) in [
        ("a.obj", &obj[..]),
        ("sub/m.mtl", "newmtl a\nKd 1 0 0\n"),
        (
            "a.scn",
            "mesh -1 sub\\b.off\nmesh -1 \"sub/b.off\"\nmesh -1 D:\\x\\a.obj\n",
        ),
        ("sub/b.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let found = load_with(&folder.path().join("a.obj"), &[]).unwrap();
    assert_eq!(found.scene.materials[0].front.diffuse, RED);
    let found = load_with(&folder.path().join("a.scn"), &[]).unwrap();
    assert_eq!(found.scene.objects.len(), 3);
    assert!(notes(&found).contains("sub\\b.off: "), "{}", notes(&found));
}

#[test]
fn the_first_of_two_libraries_wins() {
    let (one, two) = (
        "newmtl a\nKd 1 0 0\n",
        "newmtl a\nKd 0 1 0\nnewmtl b\nKd 0 0 1\n",
    );
    for lines in [
        "mtllib one.mtl two.mtl\n",
        "mtllib one.mtl\nmtllib two.mtl\n",
        "mtllib \"one.mtl\" \"two.mtl\"\n",
    ] {
        let obj = format!("{lines}{SQUARE}usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n");
        let files: [(&str, &[u8]); 3] = [
            ("a.obj", obj.as_bytes()),
            ("one.mtl", one.as_bytes()),
            ("two.mtl", two.as_bytes()),
        ];
        let found = load_files(&files, &[]).unwrap();
        let colors: Vec<_> = found
            .scene
            .materials
            .iter()
            .map(|m| m.front.diffuse)
            .collect();
        assert_eq!(colors, [RED, [0.0, 0.0, 1.0]], "{lines}");
        assert!(
            notes(&found).contains("material a is in a library before this one"),
            "{}",
            notes(&found)
        );
    }
}
