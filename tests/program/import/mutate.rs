//! Damaged files: any answer will do, but no panic, and every caret inside its line.

use proptest::prelude::*;
use rastray::import::shipped;
use rastray::scene::Shape;

use super::{failure, load_files};

/// Changes some bytes: replaces, doubles or removes short ranges.
fn damage(bytes: &[u8], edits: &[(usize, u8, u8)]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for (at, kind, byte) in edits {
        let at = at % bytes.len().max(1);
        let end = (at + usize::from(*byte) % 9 + 1).min(bytes.len());
        match kind % 4 {
            0 if at < bytes.len() => bytes[at] = *byte,
            1 => bytes.insert(at, *byte),
            2 => {
                let copy = bytes[at..end].to_vec();
                bytes.splice(at..at, copy);
            }
            _ => {
                bytes.drain(at..end);
            }
        }
    }
    bytes
}

/// Mostly characters that mean something in these files.
fn edits() -> impl Strategy<Value = Vec<(usize, u8, u8)>> {
    let byte = prop_oneof![
        3 => proptest::sample::select(b"0123456789.-+e[]{}=\"'#\n\r\\ ,/fvsnt".to_vec()),
        1 => any::<u8>(),
    ];
    proptest::collection::vec((any::<usize>(), any::<u8>(), byte), 1..6)
}

const OBJ: &str = include_str!("damaged.obj");
const MTL: &str = "newmtl a\nKa 0.1 0.2 0.3\nKd 1 # grey\nKs .5 .5 .5\nNs 10\nNi 1.5\nd 0.5\nTf 1 1 1\nillum 7\nnewmtl b\nmap_Kd -s 1 1 x.png\nTr 0.1\nillum 4\n";

const SCN: &str = "# all commands\ncamera 0 2 9  0 0 -1  0 1 0  .25 .01 100\nbackground 0 0 0 ambient .1 .1 .1\n\
    material 0 0 0  1 1 1  0 0 0  0 0 0  0 0 0  10 1 0\ndir_light 1 1 1  0 -1 0\npoint_light 1 1 1  2 2 2  0 0 1\n\
    spot_light 1 1 1  0 5 0  0 -1 0  1 0 0  .5 8\narea_light 1 1 1  0 3 0  0 -1 0  .5  1 0 0\n\
    rect_light 1 1 1  0 3 0  1 0 0  0 0 1  2 3  1 0 0\nbegin -1  1 0 0 1  0 2 0 0  0 0 -1 0  0 0 0 1\n\
    tri 0  0 0 0  1 0 0  0 1 0\nbox -1  0 0 0  1 1 0\ngroup g 0  1 0 0 1  0 1 0 0  0 0 1 0  0 0 0 1\n\
    sphere 0  0 0 0  1\nmesh 0 m.off\nend end\nmesh -1 m.ray\nline 0  0 0 0  1 1 1\ninclude b.scn\n";
const OFF: &str = "STCNOFF\n# five\n5 3 0\n0 0 0 0 0 1 1 1 1 0 0\n1 0 0 0 0 1 1 1 1 0 0\n1 1 0 0 0 1 1 1 1 0 0\n\
    0 1 0 0 0 1 1 1 1 0 0\n0 0 1 0 0 0 1 1 1 0 0\n4 0 1 2 3  1 0 0\n3 0 1 4\n5 0 1 2 3 4\n";
const RAY: &str = "#vertex 0 0 0  0 0 1  0 0\n#vertex 1 0 0  0 0 0  1 0\n#vertex 0 1 0  0 0 1  0 1\n#material 1\n\
    #shape_triangle 5  0 1 2\n#shape_triangle 0 2 1\n";

const BPT: [&str; 2] = [
    "1\n3 3\n0.0 0 0\n1 0 0\n2 0 0\n3 0 0\n0 1 0\n1 1 1\n2 1 0\n3 1 0\n0 2 0\n1 2 0\n2 2 1\n3 2 0\n0 3 0\n1 3 0\n2 3 0\n3 3 0\n",
    "1\n1,2,3,4,1,2,3,4,4,3,2,1,1,1,1,1\n4\n0,0,0\n1,0,0\n2,1,0\n3,0,1\n",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_scenes_never_panic(scene in 0..shipped().len(), edits in edits()) {
        let bytes = damage(shipped()[scene].text.as_bytes(), &edits);
        let result = load_files(&[("a.toml", &bytes), ("vase.obj", OBJ.as_bytes())], &[]);
        if result.is_err() {
            failure(result);
        }
    }

    #[test]
    fn damaged_meshes_never_panic(mesh in edits(), library in edits()) {
        let (obj, mtl) = (damage(OBJ.as_bytes(), &mesh), damage(MTL.as_bytes(), &library));
        let result = load_files(&[("a.obj", &obj), ("x.mtl", &mtl)], &[]);
        match result {
            Err(_) => {
                failure(result);
            }
            Ok(imported) => {
                for object in &imported.scene.objects {
                    prop_assert!(object.materials.iter().all(|m| *m < imported.scene.materials.len()));
                    let rastray::scene::Geometry::Mesh(mesh) = &object.geometry else { continue };
                    let count = mesh.positions.len() as u32;
                    prop_assert!(mesh.triangles.iter().flatten().all(|v| *v < count));
                    prop_assert!(mesh.normals.is_empty() || mesh.normals.len() == mesh.positions.len());
                    prop_assert!(mesh.texcoords.is_empty() || mesh.texcoords.len() == mesh.positions.len());
                    prop_assert!(mesh.normals.iter().all(|n| n.is_finite()));
                }
                let camera = &imported.scene.camera;
                prop_assert!(camera.eye.is_finite() && camera.near > 0.0 && camera.near.is_finite());
                prop_assert!(camera.eye_from_world_rotation().is_finite());
            }
        }
    }

    #[test]
    fn damaged_scn_scenes_never_panic(scene in edits(), off in edits(), ray in edits()) {
        let files = [
            ("a.scn", damage(SCN.as_bytes(), &scene)),
            ("m.off", damage(OFF.as_bytes(), &off)),
            ("m.ray", damage(RAY.as_bytes(), &ray)),
            ("b.scn", b"material 0 0 0 1 1 1 0 0 0 0 0 0 0 0 0 1 1 0 tri 0 0 0 0 1 0 0 0 1 0".to_vec()),
        ];
        let files: Vec<(&str, &[u8])> = files.iter().map(|(n, b)| (*n, &b[..])).collect();
        match load_files(&files, &[]) {
            Ok(imported) => {
                let scene = &imported.scene;
                for object in &scene.objects {
                    prop_assert!(object.materials.iter().all(|m| *m < scene.materials.len()));
                    prop_assert!(object.world_from_object.is_finite());
                    let rastray::scene::Geometry::Mesh(mesh) = &object.geometry else { continue };
                    let count = mesh.positions.len() as u32;
                    prop_assert!(mesh.triangles.iter().flatten().all(|v| *v < count));
                    prop_assert!(mesh.normals.is_empty() || mesh.normals.len() == mesh.positions.len());
                    prop_assert!(mesh.texcoords.is_empty() || mesh.texcoords.len() == mesh.positions.len());
                }
                let camera = &scene.camera;
                prop_assert!(camera.eye.is_finite() && camera.near > 0.0 && camera.near.is_finite());
                prop_assert!(camera.eye_from_world_rotation().is_finite());
            }
            result => {
                failure(result);
            }
        }
    }

    #[test]
    fn damaged_patches_never_panic(main in edits(), patches in edits(), form in 0..2usize) {
        let text = b"[object.a]\nshape = \"bezier\"\npatches = \"a.bpt\"\n[object.b]\nshape = \"bezier\"\n\
            points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\npatches = [[0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0]]\n";
        let (main, patches) = (damage(text, &main), damage(BPT[form].as_bytes(), &patches));
        match load_files(&[("a.toml", &main), ("a.bpt", &patches)], &[]) {
            Ok(imported) => {
                for object in &imported.scene.objects {
                    if let rastray::scene::Geometry::Shape(Shape::Bezier { points, patches }) = &object.geometry {
                        prop_assert!(points.iter().all(|p| p.is_finite()));
                        prop_assert!(patches.iter().flatten().all(|i| (*i as usize) < points.len()));
                    }
                }
            }
            result => {
                failure(result);
            }
        }
    }

    #[test]
    fn damaged_includes_never_panic(main in edits(), library in edits()) {
        let text = b"include = [\"m.toml\"]\n[object.a]\nshape = \"sphere\"\nmaterial = \"red\"\n";
        let materials = b"[material.red]\ncolor = [1, 0, 0]\n[material.blue]\nback = { color = 1 }\n";
        let (main, library) = (damage(text, &main), damage(materials, &library));
        let result = load_files(&[("a.toml", &main), ("m.toml", &library)], &[]);
        if result.is_err() {
            failure(result);
        }
    }

    #[test]
    fn overrides_never_panic(set in "[a-z.=\\[\\]\"{} 0-9]{0,40}") {
        let result = load_files(&[("a.toml", shipped()[0].text.as_bytes())], &[&set]);
        if result.is_err() {
            failure(result);
        }
    }
}
