//! Princeton's .scn: a scene number by number, the meshes beside it, damaged files, and the course's own scenes.

use rastray::decompose::Ladder;
use rastray::gl::SpecularModel;
use rastray::math::{DVec2, DVec3};
use rastray::render::Options;
use rastray::scene::{Geometry, Projection, Scene, Shape};

use crate::common::ladder;

use super::{failure, load_files, load_text, load_with, mesh_of, notes};

/// Half of a right angle in radians, to the last digit: tan is 1.
const EIGHTH: &str = "0.7853981633974483";

fn whole_scene() -> String {
    format!(
        "# every command that makes something\r\n\
         camera 1 2 10  0 0 -2  0 3 0  {EIGHTH}  0.5 50\n\
         background .1 .2 .3 ambient .4 .5 .6\n\
         material .1 .2 .3  .4 .5 .6  .7 .8 .9  0 0 0  .01 .02 .03  12 0 0\n\
         material 0 0 0  0 0 0  .5 .5 .5  .25 .5 .75  0 0 0  0 1.5 0 # glass\n\
         dir_light 1 .5 .25  1 -2 3\n\
         point_light 2 2 2  1 2 3  .1 .2 .3\n\
         spot_light 1 0 0  4 5 6  0 -2 0  1 0 0  {EIGHTH} 8\n\
         sphere -1  1 2 3  4\n\
         begin 1  0 -2 0 5  2 0 0 6  0 0 2 7  0 0 0 1\n\
           box -1  1 1 1  -1 -2 -3\n\
           group lid 0  1 0 0 1  0 1 0 0  0 0 1 0  0 0 0 1\n\
             tri -1  0 0 0  1 0 0  0 1 0\n\
             tri  0  0 0 0  0 1 0  0 0 1\n\
             tri  1  0 0 0  1 0 0  0 0 1\n\
           end\n\
         end\n\
         sphere 1  0 0 0  .5\n"
    )
}

#[test]
fn every_number_arrives() {
    let imported = load_text(
        "a.scn",
        whole_scene(),
        &["image.width=200", "image.height=100"],
    );
    let imported = imported.unwrap();
    let scene = &imported.scene;
    let camera = &scene.camera;
    assert_eq!(camera.eye, DVec3::new(1.0, 2.0, 10.0));
    assert_eq!(camera.target, DVec3::new(1.0, 2.0, 8.0));
    assert_eq!(camera.up, DVec3::new(0.0, 3.0, 0.0));
    assert_eq!((camera.near, camera.far), (0.5, Some(50.0)));
    // tan(xfov) = 1, half as high as wide: the half vertical angle is atan(1/2).
    let Projection::Perspective { fovy_deg } = camera.projection else {
        panic!("{:?}", camera.projection)
    };
    assert!(
        (fovy_deg - 2.0 * 26.56505117707799).abs() < 1e-12,
        "{fovy_deg}"
    );
    assert_eq!(scene.image.background, [0.1, 0.2, 0.3]);
    assert_eq!(scene.light_model.ambient, [0.4, 0.5, 0.6]);
    assert_eq!(scene.light_model.specular_model, SpecularModel::Reflection);
    assert_eq!(scene.name, "a");
}

#[test]
fn lights_and_materials_arrive() {
    let imported = load_text("a.scn", whole_scene(), &[]).unwrap();
    let scene = &imported.scene;
    assert_eq!(scene.light_names(), ["dir1", "point1", "spot1"]);
    let [dir, point, spot] = [0, 1, 2].map(|i| &scene.lights[i].source);
    assert_eq!(dir.position, [-1.0, 2.0, -3.0, 0.0]);
    assert_eq!(
        (dir.diffuse, dir.specular),
        ([1.0, 0.5, 0.25], [1.0, 0.5, 0.25])
    );
    assert_eq!((dir.ambient, dir.attenuation), ([0.0; 3], [1.0, 0.0, 0.0]));
    assert_eq!(point.position, [1.0, 2.0, 3.0, 1.0]);
    assert_eq!(
        (point.attenuation, point.spot_cutoff_deg),
        ([0.1, 0.2, 0.3], 180.0)
    );
    assert_eq!(spot.spot_direction, [0.0, -2.0, 0.0]);
    assert!((spot.spot_cutoff_deg - 45.0).abs() < 1e-13);
    assert_eq!(spot.spot_exponent, 8.0);

    let [a, glass, default] = [0, 1, 2].map(|i| &scene.materials[i]);
    assert_eq!(
        [&a.name, &glass.name, &default.name],
        ["m0", "m1", "(default)"]
    );
    assert_eq!(
        (a.front.ambient, a.front.diffuse),
        ([0.1, 0.2, 0.3], [0.4, 0.5, 0.6])
    );
    assert_eq!(
        (a.front.specular, a.front.emission),
        ([0.7, 0.8, 0.9], [0.01, 0.02, 0.03])
    );
    assert_eq!(
        (a.front.shininess, a.optics.reflection),
        (12.0, [0.7, 0.8, 0.9])
    );
    // ir = 0 means nothing where nothing is transmitted.
    assert_eq!((a.optics.transmission, a.optics.ior), ([0.0; 3], 1.0));
    assert_eq!(
        (glass.optics.transmission, glass.optics.ior),
        ([0.25, 0.5, 0.75], 1.5)
    );
    assert_eq!(
        (default.front.ambient, default.front.diffuse),
        ([0.2; 3], [0.5; 3])
    );
    assert_eq!(
        (default.front.specular, default.front.shininess),
        ([0.5; 3], 10.0)
    );
    assert_eq!(default.optics.reflection, [0.5; 3]);
}

#[test]
fn groups_are_flattened() {
    let imported = load_text("a.scn", whole_scene(), &[]).unwrap();
    let scene = &imported.scene;
    let found: Vec<(&str, usize)> = scene
        .objects
        .iter()
        .map(|o| (o.name.as_str(), o.materials[0]))
        .collect();
    let expected = [
        ("sphere1", 2),
        ("box1", 1),
        ("lid.tri1", 0),
        ("lid.tri2", 1),
        ("sphere2", 1),
    ];
    assert_eq!(found, expected);
    let [min, max] = [DVec3::new(-1.0, -2.0, -3.0), DVec3::ONE];
    assert_eq!(
        scene.objects[1].geometry,
        Geometry::Shape(Shape::Box { min, max })
    );
    // Row by row: x' = -2 y + 5, y' = 2 x + 6, z' = 2 z + 7.
    let world = |object: usize, x: f64, y: f64, z: f64| {
        let m = &scene.objects[object].world_from_object;
        m.transform_point3(DVec3::new(x, y, z)).to_array()
    };
    assert_eq!(world(1, 1.0, 10.0, 100.0), [-15.0, 8.0, 207.0]);
    // The inner group moves by +1 in x first.
    assert_eq!(world(2, 0.0, 10.0, 100.0), [-15.0, 8.0, 207.0]);
    assert_eq!(world(4, 1.0, 2.0, 3.0), [1.0, 2.0, 3.0]);
    // Two triangles of one material are one mesh, the third is one of its own.
    let corners = |o: usize| mesh_of(scene, o).positions.len();
    assert_eq!((corners(2), corners(3)), (6, 3));
    assert_eq!(mesh_of(scene, 2).triangles, [[0, 1, 2], [3, 4, 5]]);
}

#[test]
fn the_picture_keeps_the_horizontal_angle() {
    let mut imported = load_text("a.scn", whole_scene(), &[]).unwrap();
    let half = |i: &rastray::import::Imported, aspect| i.scene.camera.half_extent(aspect);
    assert!((half(&imported, 640.0 / 480.0) - DVec2::new(1.0, 0.75)).length() < 1e-14);
    imported.resize(100, 300);
    assert!((half(&imported, 1.0 / 3.0) - DVec2::new(1.0, 3.0)).length() < 1e-14);
    // Whoever states the vertical angle has it.
    let mut stated = load_text("a.scn", whole_scene(), &["camera.fovy=60"]).unwrap();
    stated.resize(100, 300);
    let projection = stated.scene.camera.projection;
    assert_eq!(projection, Projection::Perspective { fovy_deg: 60.0 });
}

#[test]
fn distant_eyes_keep_their_direction() {
    let text = "camera 1e30 0 0  -3 -4 0  0 0 1  .3  1 1e31\nsphere -1  0 0 0  1\n";
    let camera = load_text("a.scn", text, &[]).unwrap().scene.camera;
    let forward = (camera.target - camera.eye).normalize();
    assert!(
        (forward - DVec3::new(-0.6, -0.8, 0.0)).length() < 1e-15,
        "{forward}"
    );
}

#[test]
fn round_shapes_arrive() {
    let text = "cylinder -1  1 2 3  4 5\ncone -1  1 2 3  4 6\ncircle -1  1 2 3  0 0 2  4\n";
    let scene = load_text("a.scn", text, &[]).unwrap().scene;
    let (low, high) = (DVec3::new(1.0, -0.5, 3.0), DVec3::new(1.0, 4.5, 3.0));
    let (foot, tip) = (DVec3::new(1.0, -1.0, 3.0), DVec3::new(1.0, 5.0, 3.0));
    let expected = [
        Shape::Cylinder {
            base: low,
            top: high,
            radius: 4.0,
            caps: true,
        },
        Shape::Cone {
            base: foot,
            apex: tip,
            radius: 4.0,
            cap: true,
        },
        Shape::Disk {
            center: DVec3::new(1.0, 2.0, 3.0),
            normal: DVec3::Z * 2.0,
            radius: 4.0,
        },
    ];
    for (object, shape) in scene.objects.iter().zip(expected) {
        assert_eq!(object.geometry, Geometry::Shape(shape));
    }
    assert_eq!(scene.objects.len(), 3);
}

#[test]
fn what_is_missing_is_the_formats_default() {
    let imported = load_text("a.scn", "sphere -1  1 2 3  2\n", &[]).unwrap();
    let scene = &imported.scene;
    // The bounds' half diagonal is 2 sqrt 3.
    let radius = 2.0 * 3f64.sqrt();
    let camera = &scene.camera;
    let eye = DVec3::new(1.0, 2.0, 3.0 + 3.0 * radius);
    assert!((camera.eye - eye).length() < 1e-14);
    assert!((camera.eye - camera.target).normalize() == DVec3::Z && camera.up == DVec3::Y);
    assert!((camera.near / (0.01 * radius) - 1.0).abs() < 1e-14);
    assert!((camera.far.unwrap() / (100.0 * radius) - 1.0).abs() < 1e-14);
    let half = camera.half_extent(640.0 / 480.0).x;
    assert!((half - libm::tan(0.25)).abs() < 1e-14);
    let [a, b] = [0, 1].map(|i| &scene.lights[i].source);
    assert_eq!((a.position, a.diffuse), ([3.0, 4.0, 5.0, 0.0], [1.0; 3]));
    assert_eq!((b.position, b.diffuse), ([-3.0, -2.0, -3.0, 0.0], [0.5; 3]));
    assert_eq!(
        (b.specular, scene.light_model.ambient),
        ([0.5; 3], [0.0; 3])
    );
    let notes = notes(&imported);
    assert!(notes.contains("the file has no camera"), "{notes}");
    assert!(notes.contains("the file has no lights"), "{notes}");
    assert!(notes.contains("(V.R)^n"), "{notes}");
}

#[test]
fn notes_say_what_the_renderers_do_not_do() {
    let text = "material 0 0 0  1 1 1  1 1 1  0 0 0  0 0 0  1000 1 checker.bmp\n\
        area_light 1 1 1  0 3 0  0 -1 0  .5  1 0 0\n\
        rect_light 1 1 1  4 5 6  1 0 0  0 1 0  2 3  1 0 0\n\
        point_light 1 1 1  9 9 9  0 0 0\n\
        line 0  0 0 0  1 1 1\n\
        begin -1  1 0 0 5  0 1 0 0  0 0 1 0  0 0 0 1\n\
        dir_light 1 1 1  0 -1 0\n\
        end\n\
        camera 0 0 5  0 0 -1  0 1 0  .3  0 -1\n\
        sphere 0  0 0 0  1\n";
    let imported = load_text("a.scn", text, &[]).unwrap();
    let scene = &imported.scene;
    assert_eq!(scene.light_names(), ["area1", "rect1", "point1", "dir1"]);
    assert_eq!(scene.lights[0].source.position, [0.0, 3.0, 0.0, 1.0]);
    assert_eq!(scene.lights[1].source.position, [4.0, 5.0, 6.0, 1.0]);
    assert_eq!(scene.lights[3].source.position, [0.0, 1.0, 0.0, 0.0]);
    assert_eq!(scene.camera.far, None);
    assert!(scene.camera.near > 0.0);
    let notes = notes(&imported);
    for expected in [
        "the texture `checker.bmp` is not read",
        "material m0: GL would refuse shininess 1000 (0 to 128)",
        "light area1: a light with an area becomes a point light at its centre",
        "light rect1: a light with an area becomes",
        "light point1: with attenuation 0 0 0",
        "a line is not drawn",
        "light dir1: lights are not moved by the group",
        "near 0 cannot be used",
        "far -1 cannot be used",
    ] {
        assert!(notes.contains(expected), "{expected}: {notes}");
    }
}

#[test]
fn a_box_without_thickness_faces_the_eye() {
    for (z, towards) in [(5, -1.0), (-5, 1.0)] {
        let text =
            format!("camera 0 0 {z}  0 0 {towards}  0 1 0  .3  .1 100\nbox -1  -1 -2 0  1 2 0\n");
        let imported = load_text("a.scn", text, &[]).unwrap();
        let Geometry::Shape(Shape::Patch { edge_u, edge_v, .. }) =
            imported.scene.objects[0].geometry
        else {
            panic!("{:?}", imported.scene.objects[0])
        };
        assert_eq!(edge_u.cross(edge_v), DVec3::Z * (-8.0 * towards));
    }
}

#[test]
fn overrides_reach_what_the_importer_made() {
    let sets = [
        "light_model.specular_model=half-vector",
        "light.point1.diffuse=[1,2,3]",
        "camera.eye=[0,0,30]",
        "trace.depth=2",
        "raster.shading=flat",
    ];
    let imported = load_text("a.scn", whole_scene(), &sets).unwrap();
    let scene = &imported.scene;
    assert_eq!(scene.light_model.specular_model, SpecularModel::HalfVector);
    assert_eq!(scene.lights[1].source.diffuse, [1.0, 2.0, 3.0]);
    assert_eq!((scene.camera.eye.z, scene.trace.depth), (30.0, 2));
    let (message, _) = failure(load_text(
        "a.scn",
        whole_scene(),
        &["light.point2.diffuse=1"],
    ));
    assert_eq!(message, "there is no light called `point2`");
    // An override that fits only its own value badly has no line of the file to show.
    let (message, _) = failure(load_text("a.scn", whole_scene(), &["camera.up=[0,0,1]"]));
    assert_eq!(
        message,
        "up: [0, 0, 1] is parallel to the view from eye to target"
    );
}

#[test]
fn includes_number_their_own_materials() {
    let outer = "material 1 1 1  1 0 0  0 0 0  0 0 0  0 0 0  1 1 0\n\
        begin 0  1 0 0 7  0 1 0 0  0 0 1 0  0 0 0 1\n\
        include sub/inner.scn\n\
        include sub/inner.scn\n\
        end\n\
        sphere 0  0 0 0  1\n";
    let inner = "material 1 1 1  0 1 0  0 0 0  0 0 0  0 0 0  1 1 0\n\
        sphere 0  1 0 0  1\nsphere -1  2 0 0  1\nmesh 0 one.off\n";
    let one = "OFF\n3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    for (name, text) in [
        ("a.scn", outer),
        ("sub/inner.scn", inner),
        ("sub/one.off", one),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let imported = load_with(&folder.path().join("a.scn"), &[]).unwrap();
    let scene = &imported.scene;
    let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["m0", "sub/inner.scn:m0", "(default)"]);
    let materials: Vec<usize> = scene.objects.iter().map(|o| o.materials[0]).collect();
    assert_eq!(materials, [1, 2, 1, 1, 2, 1, 0]);
    assert_eq!(scene.objects[1].world_from_object.translation.x, 7.0);
    assert_eq!(imported.files.len(), 4);
    assert!(std::ptr::eq(mesh_of(scene, 2), mesh_of(scene, 5)));
}

/// OFF texts that all hold the same square pyramid's base and one side: text, what a note says.
const OFFS: &[(&str, &str)] = &[
    (
        "OFF\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3\n3 0 1 4\n",
        "",
    ),
    (
        "OFF 5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3\n3 0 1 4",
        "",
    ),
    (
        "5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3\n3 0 1 4\n",
        "",
    ),
    (
        "OFF\r\n# made by hand\r\n5 2\r\n\r\n0 0 0\r\n1 0 0\r\n# half\r\n1 1 0\r\n0 1 0\r\n0 0 1\r\n4 0 1 2 3\r\n3 0 1 4\r\n",
        "",
    ),
    (
        "OFF\n5\n2\n0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3\n3 0 1 4\n",
        "",
    ),
    (
        "OFF\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3  255 0 0\n3 0 1 4  0.5 0.5 0.5 1\n",
        "dropped on 2 lines",
    ),
    (
        "COFF\n5 2 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n1 1 0 1 1 1 1\n0 1 0 1 1 1 1\n0 0 1 1 1 1 1\n4 0 1 2 3\n3 0 1 4\n",
        "dropped on 5 lines",
    ),
    (
        "OFF\n5 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n4 0 1 2 3\n2 0 1\n3 0 1 4\n",
        "fewer than three corners",
    ),
];

const MESH_SCENE: &str = "mesh -1 m.off\n";

#[test]
fn off_meshes_of_every_kind() {
    for (off, note) in OFFS {
        let files = [("a.scn", MESH_SCENE.as_bytes()), ("m.off", off.as_bytes())];
        let imported = load_files(&files, &[]).unwrap_or_else(|e| panic!("{off}: {e}"));
        let mesh = mesh_of(&imported.scene, 0);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 4]], "{off}");
        assert_eq!(mesh.positions[2], DVec3::new(1.0, 1.0, 0.0));
        assert!(mesh.normals.is_empty());
        assert!(
            notes(&imported).contains(note),
            "{off}: {}",
            notes(&imported)
        );
    }
    let full = "STCNOFF\n3 1 0\n0 0 0 0 0 2 1 0 0 1 .25 .5\n1 0 0 0 0 2 1 0 0 1 1 0\n0 1 0 0 0 2 1 0 0 1 0 1\n3 0 1 2\n";
    let files = [("a.scn", MESH_SCENE.as_bytes()), ("m.off", full.as_bytes())];
    let imported = load_files(&files, &[]).unwrap();
    let mesh = mesh_of(&imported.scene, 0);
    assert_eq!(mesh.normals, [DVec3::Z * 2.0; 3]);
    assert_eq!(mesh.texcoords[0], DVec2::new(0.25, 0.5));
}

#[test]
fn ray_and_obj_meshes() {
    let ray = "#vertex 0 0 0  0 0 1  0 0\n#vertex 1 0 0  0 0 0  1 0\n#vertex 0 1 0  0 0 1  0 1\n\
        #material 1 1 1 x\n#shape_triangle 5  0 1 2\n#shape_triangle 0 2 1\n";
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\n";
    let scn = "mesh -1 m.ray\nmesh -1 m.OBJ\n";
    let files = [
        ("a.scn", scn.as_bytes()),
        ("m.ray", ray.as_bytes()),
        ("m.OBJ", obj.as_bytes()),
    ];
    let imported = load_files(&files, &[]).unwrap();
    let mesh = mesh_of(&imported.scene, 0);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 1]]);
    // The second vertex states none; its two triangles cancel out.
    assert_eq!(mesh.normals[0], DVec3::Z);
    assert_eq!(mesh.texcoords[2], DVec2::new(0.0, 1.0));
    assert!(notes(&imported).contains("`#material` is no part of a mesh: dropped"));
    assert_eq!(mesh_of(&imported.scene, 1).triangles.len(), 2);
    assert_eq!(imported.scene.objects[1].materials, [0]);
}

/// Broken scenes: text, "line:column message", help.
#[rustfmt::skip] // a table
const BROKEN: &[(&str, &str, &str)] = &[
    ("sphere -1 0 0 0\n", "1:16 expected a number for the radius of `sphere`, found the end of the file", "it is written `sphere m  cx cy cz  r`"),
    ("sphere -1 0 0 zero 1\n", "1:15 expected a number for the centre of `sphere`, found `zero`", "it is written `sphere m  cx cy cz  r`"),
    ("sphere -1 0 0 nan 1\n", "1:15 expected a number for the centre of `sphere`, which must be finite, found `nan`", "it is written `sphere m  cx cy cz  r`"),
    ("sphere -1 0 0 1e99 1\n", "1:15 expected a number for the centre of `sphere` of magnitude 3.4e38 or less (single precision), found `1e99`", "it is written `sphere m  cx cy cz  r`"),
    ("sphere -1 0 0 # middle\n0 1\n", "1:15 expected a number for the centre of `sphere`, found `#`", "a comment may stand between commands, not inside one"),
    ("sphere -1 0,0 0 1\n", "1:11 expected a number for the centre of `sphere`, found `0,0`", "numbers are separated by blanks, and have a decimal point"),
    ("sphere 0.5 0 0 0 1\n", "1:8 expected a whole number for the material of `sphere`, found `0.5`", "it is written `sphere m  cx cy cz  r`"),
    ("sphere 0 0 0 0 1\n", "1:8 sphere: material 0: the file has none so far", "materials count from 0 in each file, in the order in which they stand; -1 is the group's"),
    ("sphere -1 0 0 0 0\n", "1:17 sphere: expected the radius to be above 0, found 0", "it is written `sphere m  cx cy cz  r`"),
    ("sphere -1 0 0 0 1 2\n", "1:19 expected a command, found `2`", "the command before it has fewer arguments, or this one lost its word"),
    ("shpere -1 0 0 0 1\n", "1:1 expected a command, found `shpere`", "did you mean `sphere`?"),
    ("particle_source 1 0\n", "1:1 `particle_source`: particle scenes are not imported", "remove the particle commands; the rest of the scene can be drawn"),
    ("obb 0\n", "1:1 `obb`: oriented boxes are not imported", "write a box inside a group: begin -1, a rotation matrix, box, end"),
    ("box -1 0 0 0  0 0 1\n", "1:8 box: the corners span neither a box nor a rectangle", "it is written `box m  x1 y1 z1  x2 y2 z2`"),
    ("end\n", "1:1 end: there is no open group to end", "it is written `end`"),
    ("begin -1 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\nsphere -1 0 0 0 1\n", "1:1 expected `end` for this group, found none", ""),
    ("begin -1 1 0 0 0  0 1 0 0  0 0 1 0\n  5 0 0 1\n", "2:3 begin: expected 0 0 0 1 as the last row of the matrix (no projection)", "numbers stand row by row; the translation is the last of each row"),
    ("begin -1 1 0 0 0  0 0 0 0  0 0 1 0  0 0 0 1\n", "1:10 begin: the matrix flattens what is in the group", "it is written `begin m  a00 a01 a02 a03  a10 a11 a12 a13  a20 a21 a22 a23  a30 a31 a32 a33`"),
    ("camera 0 0 0  0 0 0  0 1 0  .3 1 2\n", "1:15 camera: expected a direction for the viewing direction, found [0.0, 0.0, 0.0]", "it is written `camera ex ey ez  tx ty tz  ux uy uz  xfov near far`"),
    ("camera 0 0 0  0 0 1  0 0 2  .3 1 2\n", "1:22 camera: up is parallel to the viewing direction", "it is written `camera ex ey ez  tx ty tz  ux uy uz  xfov near far`"),
    ("camera 0 0 0  0 0 1  0 1 0  45 1 2\n", "1:29 camera: expected xfov between 0 and pi/2, found 45", "xfov is half of the horizontal angle of view, in radians"),
    ("material 0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  -1 1 0\n", "1:45 material: expected n, the shininess, to be 0 or more, found -1", "it is written `material ka.rgb kd.rgb ks.rgb kt.rgb e.rgb n ir texture, 17 numbers and a file name or 0`"),
    ("material 0 0 0  0 0 0  0 0 0  1 0 0  0 0 0  1 0 0\n", "1:47 material: expected ir, the index of refraction, above 0, found 0", "1 lets rays go straight on; glass has 1.5"),
    ("spot_light 1 1 1  0 0 0  0 1 0  1 0 0  -1 0\n", "1:40 spot_light: expected the cutoff sc to be 0 or more, found -1", "it is written `spot_light r g b  px py pz  dx dy dz  ca la qa  sc sd`"),
    ("cone -1  0 1e20 0  1 2\n", "1:1 cone: the height vanishes beside the coordinates of the centre", "it is written `cone m  cx cy cz  r h`"),
    ("dir_light 1 1 1  0 0 0\n", "1:18 dir_light: expected a direction for the direction, found [0.0, 0.0, 0.0]", "it is written `dir_light r g b  dx dy dz`"),
    ("mesh -1 a.ply\n", "1:9 `a.ply` is no mesh file that is imported", "meshes are .off, .ray and .obj files"),
    ("line -1  0 0 0  1 1 1\n# two\nline -1  0 0 0  1 1 1\n", "1:1 the scene holds only lines, which are not drawn", "add a tri, box, sphere, cylinder, cone or mesh"),
    ("# nothing\n", "the scene has no surface to draw", "add a tri, box, sphere, cylinder, cone or mesh"),
    (" \n", "is empty", ""),
];

#[test]
fn broken_scenes_say_where() {
    for (text, expected, help) in BROKEN {
        let found = failure(load_text("a.scn", text, &[]));
        assert_eq!(
            found,
            ((*expected).to_owned(), (*help).to_owned()),
            "{text}"
        );
    }
}

#[test]
fn files_that_are_not_there_are_named() {
    let (message, help) = failure(load_text("a.scn", "mesh -1 b.off\n", &[]));
    assert_eq!(message, "1:9 mesh: there is no file b.off");
    assert!(
        help.starts_with("a mesh file is looked for beside"),
        "{help}"
    );
    let (message, _) = failure(load_text("a.scn", "\ninclude b.scn\n", &[]));
    assert_eq!(message, "2:9 include: there is no file b.scn");
    let (message, _) = failure(load_text("a.scn", "include a.scn\n", &[]));
    assert_eq!(message, "1:9 include: a.scn includes itself");
    // Through another name the depth ends it.
    let (message, _) = failure(load_text("a.scn", "include ./a.scn include ./a.scn\n", &[]));
    assert_eq!(
        message,
        "1:9 include: files include each other more than 16 deep"
    );
}

#[test]
fn errors_in_other_files_name_them() {
    let files: [(&str, &[u8]); 2] = [("a.scn", b"include b.scn\n"), ("b.scn", b"\n cube 3\n")];
    let error = load_files(&files, &[]).unwrap_err();
    let place = error.place().unwrap();
    assert!(place.file.ends_with("b.scn"), "{place:?}");
    assert_eq!((place.line, place.column), (2, 2));
}

/// Broken OFF meshes: text, "line:column message".
#[rustfmt::skip] // a table
const BROKEN_OFF: &[(&str, &str)] = &[
    ("solid x\n", "1:1 expected OFF, found `solid`"),
    ("OFF BINARY\n3 1 0\n", "1:1 binary OFF meshes are not imported"),
    ("4OFF\n3 1 0\n", "1:1 OFF meshes of other than three dimensions are not imported"),
    ("OFF\n-3 1 0\n", "2:1 expected the number of vertices, found `-3`"),
    ("OFF\n3 1 0\n0 0 0\n1 0 0\n", "4:6 expected a coordinate of a vertex, found the end of the file"),
    ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 x 0\n3 0 1 2\n", "5:3 expected a coordinate of a vertex, found `x`"),
    ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "6:7 vertex 3: there are 3, counted from 0"),
    ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "6:7 vertex -1: there are 3, counted from 0"),
    ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n99999 0 1 2\n", "6:1 expected the number of corners of a face, 1 to 16384, found `99999`"),
    ("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "5:6 the mesh has no face"),
    ("OFF\n999999999999 9 0\n0 0 0\n", "3:6 expected a coordinate of a vertex, found the end of the file"),
];

#[test]
fn broken_meshes_say_where() {
    for (off, expected) in BROKEN_OFF {
        let files = [("a.scn", MESH_SCENE.as_bytes()), ("m.off", off.as_bytes())];
        let (message, _) = failure(load_files(&files, &[]));
        assert_eq!(message, *expected, "{off}");
    }
    for (ray, expected) in [
        (
            "v 1 2 3\n",
            "1:1 expected #vertex or #shape_triangle, found `v`",
        ),
        (
            "#vertex 0 0 0 0 0 1 0\n",
            "1:22 expected one of eight numbers: position, normal, texture coordinates, found the end of the file",
        ),
        (
            "#vertex 0 0 0 0 0 1 0 0\n#shape_triangle 0 0 0 1\n",
            "2:23 vertex 1: there are 1 so far, from 0",
        ),
        ("#camera 1 2 3\n", "1:14 the mesh has no face"),
    ] {
        let files = [
            ("a.scn", "mesh -1 m.ray".as_bytes()),
            ("m.ray", ray.as_bytes()),
        ];
        let (message, _) = failure(load_files(&files, &[]));
        assert_eq!(message, expected, "{ray}");
    }
}

/// The course's scenes: each is read and drawn small by both renderers.
#[test]
fn the_courses_scenes_are_drawn() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/scenes/scn");
    let Ok(entries) = std::fs::read_dir(folder) else {
        println!("skipped: {folder} is not there");
        return;
    };
    let mut paths: Vec<_> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "scn"))
        .collect();
    paths.sort();
    assert!(paths.len() >= 20, "{}", paths.len());
    for path in paths {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let result = load_with(&path, &["image.width=48", "image.height=32"]);
        if name == "lines" {
            let (message, _) = failure(result);
            assert_eq!(
                message,
                "1:1 the scene holds only lines, which are not drawn"
            );
            continue;
        }
        let imported = result.unwrap_or_else(|e| panic!("{name}: {e}"));
        let ladder = climb(&imported.scene);
        assert_eq!(ladder.residual_max, 0.0, "{name}");
        let both = ladder.agreement.coverage;
        assert_eq!((both.raster_only, both.trace_only), (0, 0), "{name}");
        assert!(
            ladder.agreement.interior_max <= 1e-5,
            "{name}: {:?}",
            ladder.agreement
        );
        // The one spot of this scene falls between the corners of its box: Gouraud shading shows nothing of it.
        let least = if name == "spotlight1" {
            [0, 30]
        } else {
            [150, 150]
        };
        let ends = [ladder.rungs.first(), ladder.rungs.last()];
        for (rung, least) in ends.into_iter().zip(least) {
            let colors = &rung.unwrap().data;
            let shown = |c: &&[f64; 3]| c.iter().any(|x| *x > 0.02);
            let lit = colors.iter().filter(shown).count();
            assert!(lit >= least, "{name}: something shows in {lit} pixels only");
        }
    }
}

fn climb(scene: &Scene) -> Ladder {
    ladder::climb(scene, &Options::default())
}
