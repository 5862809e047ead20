//! Line ends of every kind, `\` at them, free-format OFF, items that cannot be read and are not needed.

use rastray::import::Imported;
use rastray::math::DVec3;

use super::{failure, load_files, load_text, mesh_of, notes};

const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";

fn corners(imported: &Imported) -> Vec<[f64; 3]> {
    let mesh = mesh_of(&imported.scene, 0);
    let corner = |i: &u32| mesh.positions[*i as usize].to_array();
    mesh.triangles.iter().flatten().map(corner).collect()
}

fn colors(imported: &Imported) -> Vec<[f64; 3]> {
    let materials = imported.scene.materials.iter();
    materials.map(|m| m.front.diffuse).collect()
}

#[test]
fn comments_never_go_on() {
    let plain = load_text("a.obj", format!("{SQUARE}f 1 2 3 4\n"), &[]).unwrap();
    for text in [
        // A folder of Windows, a comment behind numbers, one of Shift-JIS (its second byte is a backslash), CR LF.
        format!("# from C:\\models\\\n{SQUARE}f 1 2 3 4\n"),
        format!("{SQUARE}f 1 2 3 4 # all \\\nv 9 9 9\n"),
        format!("{SQUARE}#\\\r\nf 1 2 3 4\r\n"),
    ] {
        let found = load_text("a.obj", &text, &[]).unwrap();
        assert_eq!(corners(&found), corners(&plain), "{text}");
        assert!(!notes(&found).contains('\\'), "{}", notes(&found));
    }
    let mut bytes = b"# \x83\x5c\n".to_vec();
    bytes.extend(format!("{SQUARE}f 1 2 3 4\n").bytes());
    assert_eq!(
        corners(&load_text("a.obj", bytes, &[]).unwrap()),
        corners(&plain)
    );
}

#[test]
fn a_name_does_not_swallow_the_next_statement() {
    for (name, second) in [
        ("g dir\\", "f 1 3 4"),
        ("usemtl \\", "f 1 3 4"),
        ("o C:\\", "f 1 3 4 # x"),
    ] {
        let text = format!("{SQUARE}f 1 2 3\n{name}\n{second}\n");
        let found = load_text("a.obj", text, &[]).unwrap();
        let triangles: usize = (0..found.scene.objects.len())
            .map(|i| mesh_of(&found.scene, i).triangles.len())
            .sum();
        assert_eq!(triangles, 2, "{name}");
        assert!(
            notes(&found).contains("does not join the next one to it"),
            "{}",
            notes(&found)
        );
    }
    // What is no keyword goes on, as it must.
    let found = load_text("a.obj", format!("{SQUARE}f 1 2 \\\n3 4\ng a \\\nb\n"), &[]).unwrap();
    assert_eq!(mesh_of(&found.scene, 0).triangles.len(), 2);
    // In a library: a name of Shift-JIS, on both sides.
    let obj = [
        SQUARE.as_bytes(),
        b"mtllib m.mtl\nusemtl \x95\x5c\nf 1 2 3 4\n",
    ]
    .concat();
    let files: [(&str, &[u8]); 2] = [
        ("a.obj", &obj[..]),
        ("m.mtl", b"newmtl \x95\x5c\nKd 0 1 0\n"),
    ];
    let found = load_files(&files, &[]).unwrap();
    assert_eq!(colors(&found), [[0.0, 1.0, 0.0]]);
    assert!(notes(&found).contains("does not join"), "{}", notes(&found));
}

#[test]
fn every_line_end_is_one() {
    let text = format!("# by x\nmtllib m.mtl\n{SQUARE}usemtl a\nf 1 2 \\\n3 4\n");
    let library = "newmtl b\nKd 0 1 0\nnewmtl a\nKd 1 0 0\n";
    let mixed = |text: &str| {
        let ends = ["\r", "\n", "\r\n", "\r"];
        let lines = text.lines().zip(ends.iter().cycle());
        lines
            .map(|(line, end)| format!("{line}{end}"))
            .collect::<String>()
    };
    let ways: [&dyn Fn(&str) -> String; 4] = [
        &|t| t.to_owned(),
        &|t| t.replace('\n', "\r"),
        &|t| t.replace('\n', "\r\n"),
        &mixed,
    ];
    let mut first = None;
    for way in ways {
        let (obj, mtl) = (way(&text), way(library));
        let files: [(&str, &[u8]); 2] = [("a.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes())];
        let found = load_files(&files, &[]).unwrap();
        assert_eq!(colors(&found), [[1.0, 0.0, 0.0]], "{obj:?}");
        let expected = first.get_or_insert_with(|| corners(&found));
        assert_eq!(&corners(&found), expected, "{obj:?}");
    }
    // Places count these lines, too.
    let (message, _) = failure(load_text("a.obj", "v 0 0 0\rv 0 0 x\rf 1 2 1\r", &[]));
    assert_eq!(message, "2:7 expected a number, found `x`");
    let scn = "# made\rbackground 0 0 1\rmesh -1 m.off\r";
    let off = "OFF\r# x\r3 1 0\r0 0 0\r1 0 0 # y\r0 1 0\r3 0 1 2\r";
    let files: [(&str, &[u8]); 2] = [("a.scn", scn.as_bytes()), ("m.off", off.as_bytes())];
    let found = load_files(&files, &[]).unwrap();
    assert_eq!(found.scene.image.background, [0.0, 0.0, 1.0]);
    assert_eq!(mesh_of(&found.scene, 0).triangles, [[0, 1, 2]]);
}

#[test]
fn off_is_free_of_lines() {
    let same = [
        "OFF\n4 1 0\n-1 -1 0 1 -1 0 1 1 0 -1 1 0\n4 0 1 2 3\n",
        "OFF4 1 0 -1 -1 0 1 -1 0 1 1 0 -1 1 0 4 0 1 2 3",
        "OFF\n4 1 0\n-1 -1 0 1 -1 0\n1 1 0 -1\n1 0\n4 0 1\n2 3\n",
        "OFF 4 2 0\n-1 -1 0 1 -1 0\n1 1 0 -1 1 0\n3 0 1 2 3 0 2 3\n",
        "OFF\n4 1 0\n-1 -1 0 1 -1 0 1 1 0 -1 1 0\n4 0 1 2 3 255 0 0\n",
        "OFF\n4 1 0\n-1 -1 0 255 0 0\n1 -1 0 0 255 0\n1 1 0 0 0 255\n-1 1 0 9 9 9\n4 0 1 2 3\n",
        "COFF\n4 1 0\n-1 -1 0 1 0 0 1 1 -1 0 0 1 0 1\n1 1 0 0 0 1 1 -1 1 0 1 1 1 1\n4 0 1 2 3\n",
        "CNOFF\n4 1 0\n-1 -1 0 0 0 1 1 0 0 1\n1 -1 0 0 0 1 1 0 0 1\n1 1 0 0 0 1 1 0 0 1\n-1 1 0 0 0 1 1 0 0 1\n4 0 1 2 3\n",
        "NCOFF4 1 4\n-1 -1 0 0 0 1 1 0 0 1 1 -1 0 0 0 1 1 0 0 1\n1 1 0 0 0 1 1 0 0 1 -1 1 0 0 0 1 1 0 0 1\n4 0 1 2 3\n",
    ];
    for text in same {
        let files = [
            ("a.scn", &b"mesh -1 m.off\n"[..]),
            ("m.off", text.as_bytes()),
        ];
        let found = load_files(&files, &[]).unwrap_or_else(|e| panic!("{text}: {e}"));
        let mesh = mesh_of(&found.scene, 0);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]], "{text}");
        assert_eq!(mesh.positions[3], DVec3::new(-1.0, 1.0, 0.0), "{text}");
        let with_normals = text.contains("N");
        assert_eq!(
            mesh.normals.len(),
            if with_normals { 4 } else { 0 },
            "{text}"
        );
        let colored = text.contains("255") || text.contains("COFF") || text.contains("CNOFF");
        assert_eq!(
            notes(&found).contains("colours of the mesh"),
            colored,
            "{text}"
        );
    }
}

#[test]
fn what_nothing_needs_may_be_unusable() {
    for (before, after, note) in [
        (
            "vn nan 0 0\n",
            "",
            "`vn` cannot be used: expected a finite number, found `nan`",
        ),
        (
            "vn 1 0\nvn 0 x 0\n",
            "",
            "`vn` needs 3 numbers, found 2 (the first of 2)",
        ),
        ("vt inf 0\n", "", "`vt` cannot be used"),
        (
            "",
            "v 1 two 3\n",
            "`v` cannot be used: expected a number, found `two`",
        ),
        (
            "f 1 2\n",
            "f 3\n",
            "a face needs 3 corners or more, found 2: not drawn, as are 1 more",
        ),
    ] {
        let text = format!("{before}{SQUARE}f 1 2 3 4\n{after}");
        let text = if before.starts_with('f') {
            format!("{SQUARE}{before}f 1 2 3 4\n{after}")
        } else {
            text
        };
        let found = load_text("a.obj", &text, &[]).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(mesh_of(&found.scene, 0).triangles.len(), 2, "{text}");
        assert!(notes(&found).contains(note), "{text}: {}", notes(&found));
    }
    // A normal that is not one is computed where a face has it; a vertex that is not one is an error there.
    let found = load_text(
        "a.obj",
        format!("{SQUARE}vn nan nan nan\nf 1//1 2//1 3//1 4//1\n"),
        &[],
    )
    .unwrap();
    assert!(mesh_of(&found.scene, 0).normals.is_empty());
    let (message, _) = failure(load_text(
        "a.obj",
        format!("{SQUARE}v 0 nan 0\nf 1 2 5\n"),
        &[],
    ));
    assert_eq!(message, "5:5 expected a finite number, found `nan`");
    let (message, _) = failure(load_text(
        "a.obj",
        format!("{SQUARE}vn 1 0\nf 1//1 2 3\n"),
        &[],
    ));
    assert_eq!(message, "5:1 `vn` needs 3 numbers, found 2");
}

#[test]
fn materials_that_nothing_uses_may_be_unusable() {
    let obj = format!("mtllib m.mtl\n{SQUARE}usemtl a\nf 1 2 3 4\n");
    for wrong in [
        "Kd spectral x.rfl",
        "Ka xyz 1 1 1",
        "Ks 1 0",
        "Ns high",
        "Ni",
        "illum",
    ] {
        let mtl = format!("newmtl b\n{wrong}\nnewmtl a\nKd 1 0 0\n");
        let files: [(&str, &[u8]); 2] = [("a.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes())];
        let found = load_files(&files, &[]).unwrap_or_else(|e| panic!("{wrong}: {e}"));
        assert_eq!(colors(&found), [[1.0, 0.0, 0.0]]);
        assert!(
            notes(&found).contains("material b, which nothing uses, is dropped: "),
            "{}",
            notes(&found)
        );
    }
}

#[test]
fn opacity_and_transparency_may_say_the_same() {
    let obj = format!("mtllib m.mtl\n{SQUARE}usemtl a\nf 1 2 3 4\n");
    for (d, tr, same) in [
        ("0.8", "0.2", true),
        ("0.9", "0.1", true),
        ("0.333333", "0.666667", true),
        ("0.7", "0.300000012", true),
        ("0.8", "0.8", false),
        ("0.5", "0.25", false),
    ] {
        let mtl = format!("newmtl a\nillum 4\nd {d}\nTr {tr}\n");
        let files: [(&str, &[u8]); 2] = [("a.obj", obj.as_bytes()), ("m.mtl", mtl.as_bytes())];
        let found = load_files(&files, &[]).unwrap();
        assert_eq!(!notes(&found).contains("disagree"), same, "{d} {tr}");
        let d: f64 = d.parse().unwrap();
        assert_eq!(found.scene.materials[0].optics.transmission, [1.0 - d; 3]);
    }
}

#[test]
fn what_will_not_show_is_said() {
    for (text, note) in [
        ("v 1 2 3\nf 1 1 1\n".to_owned(), "no face has an area"),
        (
            "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n".to_owned(),
            "no face has an area",
        ),
        (
            SQUARE.replace('1', "1e-40") + "f 1 2 3 4\n",
            "less than single precision holds",
        ),
        (
            SQUARE.replace('1', "4e-310") + "f 1 2 3 4\n",
            "less than single precision holds",
        ),
    ] {
        match load_text(
            "a.obj",
            &text,
            &[
                "camera.eye=[0,0,9]",
                "camera.target=[0,0,0]",
                "camera.near=1",
            ],
        ) {
            Ok(found) => assert!(notes(&found).contains(note), "{text}: {}", notes(&found)),
            Err(error) => panic!("{text}: {error}"),
        }
    }
    // A library in UTF-16, with its mark and without, from either end.
    let obj = format!("mtllib m.mtl\n{SQUARE}usemtl \u{e9}\nf 1 2 3 4\n");
    let text = "newmtl \u{e9}\r\nKd 0 0 1\r\n";
    for (mark, little) in [(true, true), (true, false), (false, true), (false, false)] {
        let units = mark
            .then_some(0xfeff)
            .into_iter()
            .chain(text.encode_utf16());
        let bytes = |u: u16| {
            if little {
                u.to_le_bytes()
            } else {
                u.to_be_bytes()
            }
        };
        let mtl: Vec<u8> = units.flat_map(bytes).collect();
        let files: [(&str, &[u8]); 2] = [("a.obj", obj.as_bytes()), ("m.mtl", &mtl[..])];
        let found = load_files(&files, &[]).unwrap();
        assert_eq!(colors(&found), [[0.0, 0.0, 1.0]], "{mark} {little}");
        assert!(notes(&found).contains("UTF-16"), "{}", notes(&found));
    }
}
