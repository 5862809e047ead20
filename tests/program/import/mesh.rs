//! OBJ and MTL features, with the numbers that must come out.

use rastray::math::DVec3;
use rastray::scene::{Fresnel, Geometry, Material, Mesh, Scene};

use super::{load_files, load_text, load_with, mesh_of, notes};

fn obj(text: &str) -> Scene {
    load_text("a.obj", text, &[]).unwrap().scene
}

fn area(mesh: &Mesh) -> f64 {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).length() / 2.0
    };
    mesh.triangles.iter().map(area).sum()
}

/// Corner positions of each triangle: what a mesh is, however its vertices are numbered.
fn corners(mesh: &Mesh) -> Vec<[[f64; 3]; 3]> {
    let corner = |i: u32| mesh.positions[i as usize].to_array();
    mesh.triangles.iter().map(|t| t.map(corner)).collect()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn indices_count_from_one_or_back_from_the_last() {
    let ahead = obj(&format!("{SQUARE}f 1 2 3\nf 1 3 4\n"));
    let back = obj(&format!("{SQUARE}f -4 -3 -2\nf -4 -2 -1\n"));
    assert_eq!(corners(mesh_of(&ahead, 0)), corners(mesh_of(&back, 0)));
    // Relative to what was read so far, not to the end.
    let early = obj(&format!("{SQUARE}f -4 -3 -2\nv 9 9 9\nf -5 -3 -2\n"));
    assert_eq!(corners(mesh_of(&ahead, 0)), corners(mesh_of(&early, 0)));
    // Faces may stand before their vertices.
    let first = obj(&format!("f 1 2 3\nf 1 3 4\n{SQUARE}"));
    assert_eq!(corners(mesh_of(&ahead, 0)), corners(mesh_of(&first, 0)));
}

#[test]
fn lines_may_go_on_and_end_as_they_like() {
    let plain = obj(&format!("{SQUARE}f 1 2 3\nf 1 3 4\n"));
    let odd = "# \u{e9}t\u{e9}\r\nv 0 0 \\\r\n 0\r\nv\t1 0 0 # x\r\n  v 1 1 0 1.0\r\nv 0 1 0\r\nf 1\\\r\n 2 3\r\n\r\nf 1/ 3/ 4/\\";
    let odd = odd.chars().map(|c| c as u8).collect::<Vec<u8>>();
    let scene = load_text("a.obj", odd, &[]).unwrap().scene;
    assert_eq!(corners(mesh_of(&plain, 0)), corners(mesh_of(&scene, 0)));
}

#[test]
fn concave_faces_keep_their_area() {
    // An L of area 5, in one face; a fan from its first corner would cover 6.
    let scene = obj("v 3 0 1\nv 3 0 0\nv 0 0 0\nv 0 0 3\nv 1 0 3\nv 1 0 1\nf 1 2 3 4 5 6\n");
    let mesh = mesh_of(&scene, 0);
    assert_eq!(mesh.triangles.len(), 4);
    assert_eq!(area(mesh), 5.0);
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).y
    };
    assert!(mesh.triangles.iter().all(|t| normal(t) > 0.0));
}

#[test]
fn smoothing_groups_share_normals_within_themselves_only() {
    // Two squares that meet at right angles along the edge 1-2.
    let text = "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nv 0 1 1\nv 0 1 0\n";
    let (floor, wall) = ("f 1 2 3 4\n", "f 1 6 5 2\n");
    let half = 1.0 / 2f64.sqrt();
    let normals = |scene: &Scene| {
        let mesh = mesh_of(scene, 0);
        let at = |p: DVec3| {
            let mut found: Vec<[f64; 3]> = mesh
                .triangles
                .iter()
                .flatten()
                .filter(|i| mesh.positions[**i as usize] == p)
                .map(|i| mesh.normals[*i as usize].to_array())
                .collect();
            found.dedup();
            found
        };
        (
            at(DVec3::ZERO),
            at(DVec3::new(1.0, 0.0, 0.0)),
            at(DVec3::new(0.0, 1.0, 0.0)),
        )
    };
    let (up, right) = ([0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
    // One group: the shared corner has the mean, each counted with its area.
    let (edge, on_floor, on_wall) = normals(&obj(&format!("{text}s 7\n{floor}{wall}")));
    assert_eq!(edge, [[half, half, 0.0]]);
    assert_eq!((on_floor, on_wall), (vec![up], vec![right]));
    // Two groups: an edge between them.
    let (edge, ..) = normals(&obj(&format!("{text}s 1\n{floor}s 2\n{wall}")));
    assert_eq!(edge, [up, right]);
    // Off: flat, beside a group.
    let (edge, on_floor, on_wall) = normals(&obj(&format!("{text}s 1\n{floor}s off\n{wall}")));
    assert_eq!(edge, [up, right]);
    assert_eq!((on_floor, on_wall), (vec![up], vec![right]));
    // No groups: no normals at all, positions shared.
    let scene = obj(&format!("{text}{floor}{wall}"));
    assert!(mesh_of(&scene, 0).normals.is_empty());
    assert_eq!(mesh_of(&scene, 0).positions.len(), 6);
    // The file's normals win over its groups.
    let (edge, ..) = normals(&obj(&format!(
        "{text}vn 0 0 2\ns 1\nf 1//1 2//1 3//1 4//1\nf 1//1 6//1 5//1 2//1\n"
    )));
    assert_eq!(edge, [[0.0, 0.0, 2.0]]);
}

#[test]
fn smooth_overrides_the_file() {
    let mesh =
        "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 0 1 0\nvn 1 0 0\ns 1\nf 1//1 2//1 3//1\ns 2\nf 1 4 2\n";
    let load = |smooth: &str| {
        let text = format!("[object.a]\nmesh = \"a.obj\"\n{smooth}");
        let files: [(&str, &[u8]); 2] = [("a.toml", text.as_bytes()), ("a.obj", mesh.as_bytes())];
        load_files(&files, &[]).unwrap().scene
    };
    assert!(mesh_of(&load("smooth = false"), 0).normals.is_empty());
    let scene = load("smooth = true");
    let smooth = mesh_of(&scene, 0);
    assert_eq!(smooth.positions.len(), 4);
    assert_eq!(
        smooth.normals[0],
        DVec3::new(1.0 / 2f64.sqrt(), 1.0 / 2f64.sqrt(), 0.0)
    );
    let own = load("");
    assert_eq!(mesh_of(&own, 0).normals[0], DVec3::X);
    assert_eq!(mesh_of(&own, 0).positions.len(), 6);
}

#[test]
fn texture_coordinates_split_vertices() {
    let scene = obj(&format!(
        "{SQUARE}vt 0 0\nvt 1\nvt 1 1 0\nf 1/1 2/2 3/3\nf 1/2 3/3 4\n"
    ));
    let mesh = mesh_of(&scene, 0);
    assert_eq!(mesh.positions.len(), 5);
    assert_eq!(mesh.texcoords.len(), 5);
    let uv: Vec<[f64; 2]> = mesh.triangles[1]
        .iter()
        .map(|i| mesh.texcoords[*i as usize].to_array())
        .collect();
    assert_eq!(uv, [[1.0, 0.0], [1.0, 1.0], [0.0, 0.0]]);
}

#[test]
fn objects_become_objects_and_slots_follow_first_use() {
    let text = format!(
        "{SQUARE}o one\nusemtl b\nf 1 2 3\nusemtl a\nf 1 3 4\no two words\nusemtl b\nf 1 2 4\no one\nf 2 3 4\n"
    );
    let imported = load_text("a.obj", text, &[]).unwrap();
    let scene = &imported.scene;
    let names: Vec<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["one", "two words"]);
    let materials: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(materials, ["b", "a"]);
    assert_eq!(scene.objects[0].materials, [0, 1]);
    assert_eq!(mesh_of(scene, 0).slots, [0, 1, 0]);
    assert_eq!(scene.objects[1].materials, [0]);
    assert!(mesh_of(scene, 1).slots.is_empty());
    assert_eq!(mesh_of(scene, 1).positions.len(), 3);
    assert!(notes(&imported).contains("material b is in no library"));
}

#[test]
fn a_mesh_alone_is_a_scene() {
    let imported = load_text("cube.obj", format!("{SQUARE}f 1 2 3 4\n"), &[]).unwrap();
    assert!(imported.fitted.eye && imported.fitted.target && imported.fitted.near);
    let scene = &imported.scene;
    assert_eq!(
        (scene.name.as_str(), scene.objects[0].name.as_str()),
        ("cube", "cube")
    );
    assert_eq!(scene.light_names(), ["key", "fill"]);
    assert_eq!(scene.camera.target, DVec3::new(0.5, 0.5, 0.0));
    assert!(notes(&imported).contains("two were invented, light.key and light.fill"));
    assert!(notes(&imported).contains("camera: eye fitted"));
    // All corners are in the picture.
    let half = scene.camera.half_extent(640.0 / 480.0);
    for p in &mesh_of(scene, 0).positions {
        let p = scene.camera.eye_from_world(*p);
        assert!(p.x.abs() < -p.z * half.x && p.y.abs() < -p.z * half.y);
        assert!(-p.z > scene.camera.near);
    }
    let sets = [
        "camera.eye=[0.5, 0.5, 3]",
        "light.fill.enabled=false",
        "image.width=64",
    ];
    let scene = load_text("a.obj", format!("{SQUARE}f 1 2 3 4\n"), &sets)
        .unwrap()
        .scene;
    assert_eq!(scene.camera.eye, DVec3::new(0.5, 0.5, 3.0));
    assert_eq!(scene.light_names(), ["key"]);
    assert_eq!(scene.image.width, 64);
}

/// Materials of a library, each used by a face.
fn library(names: &[&str], mtl: &str) -> (Vec<Material>, String) {
    let mut text = format!("mtllib my file.mtl\n{SQUARE}");
    for name in names {
        text.push_str(&format!("usemtl {name}\nf 1 2 3\n"));
    }
    let files: [(&str, &[u8]); 2] = [("a.obj", text.as_bytes()), ("my file.mtl", mtl.as_bytes())];
    let imported = load_files(&files, &[]).unwrap();
    let read: Vec<_> = imported
        .files
        .iter()
        .filter_map(|f| f.file_name())
        .collect();
    assert_eq!(read, ["a.obj", "my file.mtl"]);
    (imported.scene.materials.clone(), notes(&imported))
}

#[test]
fn illum_says_which_terms_there_are() {
    let mut mtl = String::new();
    let names: Vec<String> = (0..=10).map(|i| format!("illum {i}")).collect();
    for (i, name) in names.iter().enumerate() {
        mtl.push_str(&format!(
            "newmtl {name}\nKa 0.1 0.1 0.1\nKd 0.5 0.25 0.125\nKs 0.25\nKe 0 0 1\nTf 0.5 1 1\nNs 20\nNi 1.5\nd 0.75\nillum {i}\n"
        ));
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let (materials, notes) = library(&names, &mtl);
    let (ks, none) = ([0.25; 3], [0.0; 3]);
    let through = [0.75 * 0.5, 0.75, 0.75];
    let reflection = [none, none, none, ks, ks, ks, ks, none, none, none, none];
    for (i, material) in materials.iter().enumerate() {
        let optics = &material.optics;
        assert_eq!(optics.reflection, reflection[i], "illum {i}");
        let transmission = match i {
            4 => [0.25 * 0.5, 0.25, 0.25],
            6 | 7 => through,
            _ => none,
        };
        assert_eq!(optics.transmission, transmission, "illum {i}");
        assert_eq!(optics.thin, i == 4);
        assert_eq!(optics.ior, if i == 6 || i == 7 { 1.5 } else { 1.0 });
        assert_eq!(optics.fresnel == Fresnel::Dielectric, i == 7);
        let front = &material.front;
        assert_eq!(front.shininess, 20.0);
        assert_eq!(front.specular, if i < 2 { none } else { ks });
        let lit = [0.5, 0.25, 0.125];
        assert_eq!(front.diffuse, if i == 0 { none } else { lit });
        assert_eq!(
            front.emission,
            if i == 0 {
                [0.5, 0.25, 1.125]
            } else {
                [0.0, 0.0, 1.0]
            }
        );
    }
    assert!(notes.contains("material illum 2: d = 0.75 has no effect under illum 2"));
    assert!(notes.contains("illum 8: the reflection map is dropped"));
    assert!(notes.contains("illum 10: shadow catchers are not supported"));
}

#[test]
fn libraries_are_forgiving_where_they_may_be() {
    let mtl = "Kd 1 1 1\nnewmtl a b\nmap_Kd -s 1 1 1 wood.png\nKs 1\nNs 1000\nTr 0.25\nd 0.5\nillum 4\nnewmtl c\nv 1 2 3\nKd 0.1 0.2 0.3\n";
    let (materials, notes) = library(&["a b", "c", "none"], mtl);
    assert_eq!(materials[0].optics.transmission, [0.5; 3]);
    assert_eq!(materials[0].front.shininess, 1000.0);
    assert_eq!(materials[1].front.diffuse, [0.1, 0.2, 0.3]); // f64, not rounded to f32
    assert_eq!(materials[1].front.ambient, [0.2; 3]);
    assert_eq!(materials[2].front.diffuse, [0.8; 3]);
    for expected in [
        "`Kd` before the first newmtl: dropped",
        "`map_Kd` is dropped",
        "material a b: d 0.5 and Tr 0.25 disagree: d is used",
        "material a b: GL would refuse shininess 1000 (0 to 128); evaluated all the same",
        "`v` is dropped",
        "material none is in no library: OpenGL's default is used",
    ] {
        assert!(notes.contains(expected), "{expected}: {notes}");
    }
    let text = format!("mtllib gone.mtl\n{SQUARE}usemtl a\nf 1 2 3\nl 1 2\nl 2 3\n");
    let imported = load_text("a.obj", text, &[]).unwrap();
    assert!(notes_of(&imported, "there is no material library"));
    assert!(notes_of(&imported, "`l` is not drawn: dropped 2 times"));
}

fn notes_of(imported: &rastray::import::Imported, part: &str) -> bool {
    notes(imported).contains(part)
}

#[test]
fn a_scene_shares_a_mesh_file_and_may_repaint_it() {
    let toml = "[material.red]\ncolor = [1, 0, 0]\n[object.a]\nmesh = \"m.obj\"\n[object.b]\nmesh = \"m.obj\"\nmaterial = \"red\"\n";
    let obj = format!("{SQUARE}o x\nusemtl one\nf 1 2 3\no y\nusemtl red\nf 1 3 4\n");
    let files: [(&str, &[u8]); 2] = [("a.toml", toml.as_bytes()), ("m.obj", obj.as_bytes())];
    let scene = load_files(&files, &[]).unwrap().scene;
    let (Geometry::Mesh(a), Geometry::Mesh(b)) =
        (&scene.objects[0].geometry, &scene.objects[1].geometry)
    else {
        panic!("meshes expected");
    };
    assert!(std::sync::Arc::ptr_eq(a, b));
    assert_eq!(a.slots, [0, 1]);
    let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["red", "one", "m.obj:red"]);
    assert_eq!(scene.objects[0].materials, [1, 2]);
    assert_eq!(scene.objects[1].materials, [0]);
}

#[test]
fn files_of_others_load() {
    let shared = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let mut found = 0;
    for folder in ["scenes/obj", "models"] {
        let Ok(entries) = std::fs::read_dir(shared.join(folder)) else {
            continue;
        };
        for path in entries.map(|e| e.unwrap().path()) {
            if path.extension().is_some_and(|e| e == "obj") {
                let imported = load_with(&path, &[]).unwrap();
                assert!(!imported.scene.objects.is_empty());
                found += 1;
            }
        }
    }
    if found == 0 {
        println!("skipped: there is no ../shared with OBJ files");
        return;
    }
    // 871,414 triangles, as the folder's list says; flat, since the file has neither normals nor groups.
    let dragon = load_with(&shared.join("models/dragon.obj"), &[])
        .unwrap()
        .scene;
    let mesh = mesh_of(&dragon, 0);
    assert_eq!(
        (mesh.triangles.len(), mesh.positions.len()),
        (871_414, 437_645)
    );
    assert!(mesh.normals.is_empty());
}
