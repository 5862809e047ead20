//! Legal scene files: the values that must come out, overrides, notes.

use std::sync::Arc;

use rastray::gl;
use rastray::import::{LoadOptions, load};
use rastray::math::{DAffine3, DVec3};
use rastray::sampling::Pattern;
use rastray::scene::{
    Cull, Curve, Fresnel, FrontFace, Geometry, LightSpace, Profile, Projection, Shadow, Shape,
    Snap, Tir, Transparency, teapot,
};

use super::{failure, load_text, mesh_of, notes, scene};

const BALL: &str = "[object.ball]\nshape = \"sphere\"\n";

#[test]
fn what_is_left_out_has_opengls_defaults() {
    let scene = scene(&format!(
        "[light.a]\nposition = [1, 2, 3]\n[material.m]\n{BALL}"
    ));
    assert_eq!(
        (scene.image.width, scene.image.height, scene.image.samples),
        (640, 480, 1)
    );
    assert_eq!(scene.image.background, [0.0; 3]);
    assert_eq!(scene.light_model, gl::LightModel::default());
    assert_eq!(scene.raster.shading, gl::ShadeModel::Gouraud);
    assert_eq!((scene.trace.depth, scene.trace.weight_cutoff), (6, 0.0));
    let light = &scene.lights[0];
    assert_eq!((light.name.as_str(), light.enabled), ("a", true));
    assert_eq!(light.space, LightSpace::World);
    let expected = gl::LightSource {
        position: [1.0, 2.0, 3.0, 1.0],
        ..Default::default()
    };
    assert_eq!(light.source, expected);
    assert_eq!(scene.materials[0].front, gl::Material::default());
    assert_eq!(scene.materials[0].back, None);
    assert_eq!(scene.materials[1].name, "(default)");
    assert_eq!(scene.materials[1].front, gl::Material::default());
    assert_eq!(scene.objects[0].materials, [1]);
    let unit = Shape::Sphere {
        center: DVec3::ZERO,
        radius: 1.0,
    };
    assert_eq!(scene.objects[0].geometry, Geometry::Shape(unit));
    assert_eq!(scene.objects[0].world_from_object, DAffine3::IDENTITY);
}

#[test]
fn every_key_arrives() {
    let text = r#"
[image]
width = 320
height = 0xf0
background = [0.1, 0.2, 0.3]
samples = 16
pattern = "jitter"
[camera]
eye = [1, 2, 3]
target = [0.5, 0, 0]
up = [0, 0, 2]
fovy = 60
near = 0.25
far = 1e3
[light_model]
ambient = 0.05
local_viewer = false
two_sided = true
color_control = "separate"
specular_model = "phong"
normalize = false
rescale_normal = true
[raster]
shading = "per-pixel"
cull = "back"
front_face = "cw"
depth_range = [1, 0]
snap = 12
transparency = "blend"
depth_test = false
[trace]
depth = 3
shadow = "filtered"
tir = "reflect"
weight_cutoff = 0.01
[light.z]
direction = [0, -1, 2]
space = "eye"
enabled = false
ambient = 0.1
diffuse = [0.2, 0.3, 0.4]
[light.a]
position = [1, 2, 3, 2]
diffuse = 0.5
specular = 0.25
attenuation = [1, 0.1, 0.01]
spot_direction = [1, 0, 0]
spot_exponent = 5
spot_cutoff = 30
[material.glass]
color = 0.05
specular = [0.7, 0.8, 0.9]
emission = 0.01
shininess = 40
reflection = "K_S"
transmission = 0.9
ior = 1.5
thin = true
fresnel = "schlick"
back = { ambient = 0.3, diffuse = [0.4, 0.5, 0.6], specular = 1, shininess = 2 }
[object.b]
shape = "box"
size = [2, 4, 6]
center = [1, 1, 1]
material = "glass"
tessellation = 3
"#;
    let imported = load_text("a.toml", text, &[]).unwrap();
    let scene = imported.scene;
    assert_eq!(
        (scene.image.width, scene.image.height, scene.image.samples),
        (320, 240, 16)
    );
    assert_eq!(scene.image.background, [0.1, 0.2, 0.3]);
    assert_eq!(scene.image.pattern, Pattern::Jitter);
    let camera = &scene.camera;
    assert_eq!(
        (camera.eye, camera.target),
        (DVec3::new(1.0, 2.0, 3.0), DVec3::X * 0.5)
    );
    assert_eq!(
        (camera.up, camera.near, camera.far),
        (DVec3::Z * 2.0, 0.25, Some(1e3))
    );
    assert_eq!(
        camera.projection,
        Projection::Perspective { fovy_deg: 60.0 }
    );
    let model = gl::LightModel {
        ambient: [0.05; 3],
        local_viewer: false,
        two_sided: true,
        color_control: gl::ColorControl::SeparateSpecular,
        specular_model: gl::SpecularModel::Reflection,
        normalize: false,
        rescale_normal: true,
    };
    assert_eq!(scene.light_model, model);
    let raster = &scene.raster;
    assert_eq!(
        (raster.shading, raster.cull),
        (gl::ShadeModel::Phong, Cull::Back)
    );
    assert_eq!(
        (raster.front_face, raster.snap),
        (FrontFace::Cw, Snap::Bits12)
    );
    assert_eq!(raster.depth_range, [1.0, 0.0]);
    assert!(!raster.depth_test);
    assert_eq!(raster.transparency, Transparency::Blend);
    let trace = &scene.trace;
    assert_eq!(
        (trace.depth, trace.shadow, trace.tir),
        (3, Shadow::Filtered, Tir::Reflect)
    );
    assert_eq!(trace.weight_cutoff, 0.01);
    // File order, not the alphabet's.
    let [z, a] = &scene.lights[..] else {
        panic!("two lights expected")
    };
    assert_eq!(
        (z.name.as_str(), z.enabled, z.space),
        ("z", false, LightSpace::Eye)
    );
    assert_eq!(z.source.position, [0.0, 1.0, -2.0, 0.0]);
    assert_eq!(z.source.specular, [0.2, 0.3, 0.4]); // as diffuse
    assert_eq!(a.source.position, [1.0, 2.0, 3.0, 2.0]);
    assert_eq!((a.source.diffuse, a.source.specular), ([0.5; 3], [0.25; 3]));
    assert_eq!(a.source.attenuation, [1.0, 0.1, 0.01]);
    assert_eq!(
        (a.source.spot_exponent, a.source.spot_cutoff_deg),
        (5.0, 30.0)
    );
    assert_eq!(a.source.spot_direction, [1.0, 0.0, 0.0]);
    let glass = &scene.materials[0];
    assert_eq!(
        (glass.front.ambient, glass.front.diffuse),
        ([0.05; 3], [0.05; 3])
    );
    assert_eq!(
        (glass.front.emission, glass.front.shininess),
        ([0.01; 3], 40.0)
    );
    assert_eq!(glass.optics.reflection, [0.7, 0.8, 0.9]);
    assert_eq!(
        (glass.optics.transmission, glass.optics.ior),
        ([0.9; 3], 1.5)
    );
    assert!(glass.optics.thin);
    assert_eq!(glass.optics.fresnel, Fresnel::Schlick);
    let back = gl::Material {
        ambient: [0.3; 3],
        diffuse: [0.4, 0.5, 0.6],
        specular: [1.0; 3],
        shininess: 2.0,
        ..Default::default()
    };
    assert_eq!(glass.back, Some(back));
    let block = Shape::Box {
        min: DVec3::new(0.0, -1.0, -2.0),
        max: DVec3::new(2.0, 3.0, 4.0),
    };
    assert_eq!(scene.objects[0].geometry, Geometry::Shape(block));
    assert_eq!(scene.objects[0].tessellation, Some(3));
    assert!(!imported.fitted.eye && !imported.fitted.target && !imported.fitted.near);
}

#[test]
fn the_lecture_sets_two_defaults_and_nothing_else() {
    let text = format!(
        "[material.a]\nspecular = 0.5\n[material.b]\nspecular = 0.5\nreflection = 0.1\n{BALL}material = \"a\"\n"
    );
    let plain = scene(&text);
    let lecture = scene(&format!("convention = \"lecture\"\n{text}"));
    assert_eq!(
        plain.light_model.specular_model,
        gl::SpecularModel::HalfVector
    );
    assert_eq!(
        lecture.light_model.specular_model,
        gl::SpecularModel::Reflection
    );
    assert_eq!(lecture.materials[0].optics.reflection, [0.5; 3]);
    assert_eq!(lecture.materials[1].optics.reflection, [0.1; 3]);
    let mut same = lecture;
    same.light_model.specular_model = gl::SpecularModel::HalfVector;
    same.materials[0].optics.reflection = [0.0; 3];
    assert_eq!(same, plain);
    let stated =
        format!("convention = \"lecture\"\n[light_model]\nspecular_model = \"blinn\"\n{BALL}");
    assert_eq!(
        scene(&stated).light_model.specular_model,
        gl::SpecularModel::HalfVector
    );
}

fn shape(text: &str) -> Shape {
    match &scene(&format!("[object.a]\n{text}")).objects[0].geometry {
        Geometry::Shape(shape) => shape.clone(),
        Geometry::Mesh(_) => panic!("a shape expected"),
    }
}

#[test]
fn round_shapes_have_their_defaults_and_their_keys() {
    let (o, y) = (DVec3::ZERO, DVec3::Y);
    let disk = |center, normal, radius| Shape::Disk {
        center,
        normal,
        radius,
    };
    let point = DVec3::new(1.0, -2.0, 3.0);
    assert_eq!(shape("shape = \"disk\"\n"), disk(o, y, 1.0));
    let text = "shape = \"disk\"\ncenter = [1, -2, 3]\nnormal = [0, 0, 5]\nradius = 2\n";
    assert_eq!(shape(text), disk(point, DVec3::Z * 5.0, 2.0));
    let tube = |base, top, radius, caps| Shape::Cylinder {
        base,
        top,
        radius,
        caps,
    };
    assert_eq!(shape("shape = \"cylinder\"\n"), tube(o, y, 1.0, true));
    let text =
        "shape = \"cylinder\"\nbase = [1, -2, 3]\ntop = [0, 0, 0]\nradius = 2\ncaps = false\n";
    assert_eq!(shape(text), tube(point, o, 2.0, false));
    let cone = |base, apex, radius, cap| Shape::Cone {
        base,
        apex,
        radius,
        cap,
    };
    assert_eq!(shape("shape = \"cone\"\n"), cone(o, y, 1.0, true));
    let text = "shape = \"cone\"\nbase = [1, -2, 3]\napex = [0, 0, 0]\nradius = 2\ncap = false\n";
    assert_eq!(shape(text), cone(point, o, 2.0, false));
    let ring = |center, axis, major, minor| Shape::Torus {
        center,
        axis,
        major,
        minor,
    };
    assert_eq!(shape("shape = \"torus\"\n"), ring(o, y, 1.0, 0.25));
    let text = "shape = \"torus\"\ncenter = [1, -2, 3]\naxis = [0, 2, 0]\nmajor_radius = 3\nminor_radius = 1\n";
    assert_eq!(shape(text), ring(point, DVec3::Y * 2.0, 3.0, 1.0));
    let turned = |base, axis, curve, points: &[[f64; 2]]| Shape::Revolution {
        base,
        axis,
        profile: Arc::new(Profile::new(curve, points).unwrap()),
    };
    let points = [[0.0, -1.0], [2.0, 0.0], [1.0, 0.5], [0.5, 1.0]];
    let text = "shape = \"revolution\"\nprofile = [[0, -1], [2, 0], [1, 0.5], [0.5, 1]]\n";
    assert_eq!(shape(text), turned(o, y, Curve::Polyline, &points));
    let text = format!("{text}base = [1, -2, 3]\naxis = [0, 2, 0]\n");
    for (name, curve) in Curve::NAMES {
        let text = format!("{text}curve = \"{name}\"\n");
        assert_eq!(shape(&text), turned(point, y * 2.0, *curve, &points));
    }
}

#[test]
fn patches_come_from_the_scene_a_file_or_newell() {
    let pot = shape("shape = \"teapot\"\n");
    assert_eq!(pot, teapot::teapot(DVec3::ZERO, 0.5));
    let text = "shape = \"teapot\"\nbase = [1, -2, 3]\nheight = 6.3\n";
    assert_eq!(
        shape(text),
        teapot::teapot(DVec3::new(1.0, -2.0, 3.0), 6.3 / 3.15)
    );
    // One patch from the scene, from points in place, and from numbered points.
    let point = |i: u32| [i % 4, i / 4, i % 3].map(f64::from);
    let points: Vec<[f64; 3]> = (0..16).map(point).collect();
    let numbers: Vec<u32> = (0..16).rev().collect();
    let text = format!("shape = \"bezier\"\npoints = {points:?}\npatches = [{numbers:?}]\n");
    let Shape::Bezier {
        points: found,
        patches,
    } = shape(&text)
    else {
        panic!("no patches")
    };
    assert_eq!(found[5].to_array(), points[5]);
    assert_eq!(patches[0].to_vec(), numbers);
    let words = |p: &[f64; 3]| format!("{} {} {}\n", p[0], p[1], p[2]);
    let in_place: String = numbers
        .iter()
        .map(|i| words(&points[*i as usize]))
        .collect();
    let listed: String = points.iter().map(words).collect();
    let from_one: Vec<String> = numbers.iter().map(|i| (i + 1).to_string()).collect();
    let files = [
        format!("1\n3 3\n{in_place}"),
        format!("1\n{}\n16\n{listed}", from_one.join(",")),
    ];
    let main = b"[object.a]\nshape = \"bezier\"\npatches = \"a.bpt\"\n";
    for file in files {
        let files: [(&str, &[u8]); 2] = [("a.toml", main), ("a.bpt", file.as_bytes())];
        let scene = super::load_files(&files, &[]).unwrap().scene;
        let Geometry::Shape(Shape::Bezier {
            points: p,
            patches: q,
        }) = &scene.objects[0].geometry
        else {
            panic!("no patches")
        };
        for (i, number) in numbers.iter().enumerate() {
            assert_eq!(p[q[0][i] as usize].to_array(), points[*number as usize]);
        }
    }
    let bad: [(&str, &[u8]); 2] = [("a.toml", main), ("a.bpt", b"1\n3 3\n0.5 0 x")];
    let error = failure(super::load_files(&bad, &[]));
    assert_eq!(error.0, "3:7 expected a coordinate, found `x`");
}

#[test]
fn flat_shapes_face_where_they_say() {
    let patch = |corner: [f64; 3], u: [f64; 3], v: [f64; 3], tiles| Shape::Patch {
        corner: corner.into(),
        edge_u: u.into(),
        edge_v: v.into(),
        tiles,
    };
    let floor =
        shape("shape = \"checkered floor\"\ncenter = [1, 2, 3]\nsize = [4, 6]\ntiles = [2, 3]\n");
    assert_eq!(
        floor,
        patch([-1.0, 2.0, 6.0], [4.0, 0.0, 0.0], [0.0, 0.0, -6.0], [2, 3])
    );
    let plane = shape("shape = \"plane\"\nsize = [4, 6]\n");
    assert_eq!(
        plane,
        patch([-2.0, 0.0, 3.0], [4.0, 0.0, 0.0], [0.0, 0.0, -6.0], [1, 1])
    );
    let wall = shape("shape = \"plane\"\nnormal = [0, 0, 5]\nsize = 2\n");
    assert_eq!(
        wall,
        patch([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1, 1])
    );
    for normal in [DVec3::NEG_Y, DVec3::new(1.0, 2.0, -3.0), DVec3::NEG_X] {
        let [x, y, z] = normal.to_array();
        let text = format!(
            "shape = \"plane\"\nnormal = [{x}, {y}, {z}]\ncenter = [1, 1, 1]\nsize = [2, 3]\n"
        );
        let Shape::Patch {
            corner,
            edge_u,
            edge_v,
            ..
        } = shape(&text)
        else {
            panic!("a patch expected");
        };
        let front = edge_u.cross(edge_v);
        assert!((front.normalize() - normal.normalize()).length() < 1e-15);
        assert!((front.length() - 6.0).abs() < 1e-14);
        assert!((corner + edge_u / 2.0 + edge_v / 2.0 - DVec3::ONE).length() < 1e-15);
        assert!(edge_v.y.abs() >= edge_u.y.abs()); // v goes up
    }
    let quad =
        shape("shape = \"quad\"\ncorner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 2, 0]\n");
    assert_eq!(
        quad,
        patch([0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1, 1])
    );
    // A dart: its cut must run through the corner that points inward.
    let dart = scene("[object.a]\nshape = \"quad\"\npoints = [0,0,0, 4,0,0, 1,1,0, 0,4,0]\n");
    let cuts: Vec<bool> = mesh_of(&dart, 0)
        .triangles
        .iter()
        .map(|t| t.contains(&2))
        .collect();
    assert_eq!(cuts, [true, true]);
    assert!(mesh_of(&dart, 0).triangles.iter().all(|t| t.contains(&0)));
}

#[test]
fn inline_meshes_take_flat_and_nested_lists() {
    let flat =
        scene("[object.a]\npositions = [0,0,0, 1,0,0, 1,1,0, 0,1,0]\nindices = [0,1,2, 0,2,3]\n");
    let nested = scene(
        "[object.a]\npositions = [[0,0,0], [1,0,0], [1,1,0], [0,1,0]]\nindices = [[0,1,2,3]]\ntexcoords = [[0,0], [1,0], [1,1], [0,1]]\n",
    );
    assert_eq!(mesh_of(&flat, 0).triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh_of(&nested, 0).triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh_of(&nested, 0).texcoords.len(), 4);
    assert!(mesh_of(&flat, 0).normals.is_empty());
    let smooth = scene("[object.a]\nsmooth = true\npositions = [0,0,0, 1,0,0, 0,1,0]\n");
    assert_eq!(mesh_of(&smooth, 0).normals, [DVec3::Z; 3]);
}

const TRIANGLE: &str = "[object.t]\nmaterial = \"m\"\npositions = [0, 0, 0, 1, 0, 0, 0, 1, 0]\n";

#[test]
fn vertex_colours_arrive_with_and_without_alpha() {
    let colors = |list: &str| {
        let scene = scene(&format!("[material.m]\n{TRIANGLE}colors = {list}\n"));
        mesh_of(&scene, 0).colors.clone()
    };
    let opaque = [
        [1.0, 0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0, 1.0],
        [0.0, 0.0, 1.0, 1.0],
    ];
    assert_eq!(colors("[1, 0, 0, 0, 1, 0, 0, 0, 1]"), opaque);
    assert_eq!(colors("[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"), opaque);
    let clear = opaque.map(|[r, g, b, _]| [r, g, b, 0.25]);
    assert_eq!(
        colors("[[1, 0, 0, 0.25], [0, 1, 0, 0.25], [0, 0, 1, 0.25]]"),
        clear
    );
    assert_eq!(
        colors("[1, 0, 0, 0.25, 0, 1, 0, 0.25, 0, 0, 1, 0.25]"),
        clear
    );
}

#[test]
fn color_material_is_the_scenes_or_the_materials_own() {
    let tracked = |model: &str, own: &str| {
        let text = format!(
            "[light_model]\n{model}\n[material.m]\n{own}\n{TRIANGLE}colors = [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
        );
        let material = scene(&text).materials.remove(0);
        (material.front.tracked, material.back.map(|b| b.tracked))
    };
    let none = gl::Tracked::default();
    let both = gl::Tracked {
        ambient: true,
        diffuse: true,
        ..none
    };
    let emission = gl::Tracked {
        emission: true,
        ..none
    };
    let on = "color_material = true";
    assert_eq!(tracked("", ""), (none, None));
    assert_eq!(tracked(on, ""), (both, None));
    assert_eq!(tracked(on, "color_material = false"), (none, None));
    assert_eq!(tracked("", on), (both, None));
    assert_eq!(
        tracked("color_material = { enabled = false }", ""),
        (none, None)
    );
    let mode = "color_material = { mode = \"emission\" }";
    assert_eq!(tracked(on, mode), (emission, None));
    // One face only: the other gets a material of its own that does not follow.
    let front = "color_material = { face = \"front\", mode = \"emission\" }";
    assert_eq!(tracked(front, ""), (emission, Some(none)));
    let back = "color_material = { face = \"back\" }";
    assert_eq!(tracked(back, ""), (none, Some(both)));
    let idle = format!("[material.m]\n{TRIANGLE}colors = [1, 0, 0, 0, 1, 0, 0, 0, 1]\n");
    let said = notes(&load_text("a.toml", &idle, &[]).unwrap());
    assert!(said.contains("object t: `colors` are not used"), "{said}");
}

#[test]
fn transforms_apply_in_the_order_written() {
    let m = |steps: &str| {
        let text = format!("{BALL}transform = [{steps}]\n");
        scene(&text).objects[0].world_from_object
    };
    let p = DVec3::new(1.0, 2.0, 3.0);
    let first = m("{ translate = [1, 0, 0] }, { scale = 2 }");
    assert_eq!(first.transform_point3(p), DVec3::new(4.0, 4.0, 6.0));
    let second = m("{ scale = [2, 1, -1] }, { translate = [1, 0, 0] }");
    assert_eq!(second.transform_point3(p), DVec3::new(3.0, 2.0, -3.0));
    // Quarter turns are exact; counter-clockwise about +y takes z to x.
    let turn = m("{ rotate = { axis = [0, 3, 0], degrees = 450 } }");
    assert_eq!(turn.transform_point3(p), DVec3::new(3.0, 2.0, -1.0));
    let third = m("{ rotate = { axis = [1, 1, 1], degrees = 120 } }");
    assert!((third.transform_point3(p) - DVec3::new(3.0, 1.0, 2.0)).length() < 1e-15);
    let rows = m("{ matrix = [1, 2, 0, 5,  0, 1, 0, 6,  0, 0, 1, 7,  0, 0, 0, 1] }");
    assert_eq!(rows.transform_point3(p), DVec3::new(10.0, 8.0, 10.0));
    let tables = scene(&format!(
        "{BALL}[[object.ball.transform]]\ntranslate = [1, 0, 0]\n[[object.ball.transform]]\nscale = 2\n"
    ));
    assert_eq!(tables.objects[0].world_from_object, first);
}

#[test]
fn overrides_replace_and_add() {
    let text = "[camera]\neye = [0, 0, 9]\n[material.red]\nshininess = 3\nspecular = 0.5\n[object.ball]\nshape = \"sphere\"\nmaterial = \"red\"\n";
    let sets = [
        "material.red.shininess=64",
        "camera.eye=[0,2,7]",
        "trace.depth = 2",
        "image.width=320",
        "raster.shading=phong",
        "material.red.reflection=K_S",
        "material.red.back.diffuse=0.25",
        "object.ball.transform=[{ translate = [1, 0, 0] }]",
        "material.'red'.ior=1.5",
        "material.red.shininess=65",
        "convention=lecture",
    ];
    let scene = load_text("a.toml", text, &sets).unwrap().scene;
    let red = &scene.materials[0];
    assert_eq!((red.front.shininess, red.optics.ior), (65.0, 1.5));
    assert_eq!(red.optics.reflection, [0.5; 3]);
    assert_eq!(red.back.as_ref().unwrap().diffuse, [0.25; 3]);
    assert_eq!(scene.camera.eye, DVec3::new(0.0, 2.0, 7.0));
    assert_eq!((scene.trace.depth, scene.image.width), (2, 320));
    assert_eq!(scene.raster.shading, gl::ShadeModel::Phong);
    assert_eq!(
        scene.light_model.specular_model,
        gl::SpecularModel::Reflection
    );
    assert_eq!(scene.objects[0].world_from_object.translation, DVec3::X);
}

#[test]
fn overrides_fail_as_the_file_does() {
    let text = format!("[material.red]\nshininess = 3\n{BALL}");
    let cases = [
        (
            "material.red.shinyness=6",
            "material.red has no key `shinyness`",
            "did you mean `shininess`?",
        ),
        (
            "material.rde.shininess=6",
            "there is no material called `rde`",
            "did you mean `red`?",
        ),
        (
            "material.red.shininess=-6",
            "shininess: expected a number, 0 or more, found -6",
            "",
        ),
        (
            "image.width=wide",
            "width: expected a whole number from 1 to 16384, found the string \"wide\"",
            "",
        ),
        (
            "imgae.width=3",
            "there is no section `imgae`",
            "did you mean `image`?",
        ),
        ("camera.eye.x=3", "", ""),
        (
            "material.red.shininess.a=3",
            "`material.red.shininess` is not a table, so it has no `a`",
            "",
        ),
        (
            "camera.eye=[1,",
            "unclosed array, expected `]`",
            "write KEY=VALUE, for example material.red.shininess=64 or camera.eye=[0,2,7]",
        ),
        (
            "camera.eye",
            "there is no `=`",
            "write KEY=VALUE, for example material.red.shininess=64 or camera.eye=[0,2,7]",
        ),
    ];
    for (set, expected, expected_help) in cases {
        let result = load_text("a.toml", &text, &[set]);
        let error = result.err().unwrap();
        assert_eq!(error.place().unwrap().to_string(), format!("--set {set}"));
        if !expected.is_empty() {
            let found = failure(Err(error));
            assert_eq!(
                found,
                (expected.to_owned(), expected_help.to_owned()),
                "{set}"
            );
        }
    }
    // The file's own errors keep their places.
    let (message, _) = failure(load_text(
        "a.toml",
        "[image]\nwidth = 0\n",
        &["image.height=3"],
    ));
    assert!(message.starts_with("2:9 width"), "{message}");
    let whitted = load(
        "whitted",
        &LoadOptions {
            sets: vec!["trace.depth=2".into()],
            ..LoadOptions::default()
        },
    );
    assert_eq!(whitted.unwrap().scene.trace.depth, 2);
}

#[test]
fn notes_say_what_is_doubtful() {
    let text = "[light.a]\nposition = [0, 0, 1, 0]\nattenuation = [1, -1, 0]\nspot_exponent = 200\nspot_direction = [0, 0, 1]\n[light.b]\nposition = [0, 0, 1]\nspot_cutoff = 100\n[material.m]\nshininess = 200\nback = { shininess = 300 }\n[object.ball]\nshape = \"sphere\"\n";
    let notes_found = notes(&load_text("a.toml", text, &[]).unwrap());
    for expected in [
        "light.a: GL would refuse attenuation -1 (0 or more); evaluated all the same",
        "light.a: GL would refuse spot_exponent 200 (0 to 128); evaluated all the same",
        "light.a: attenuation has no effect on a directional light",
        "light.a: spot_exponent has no effect without spot_cutoff",
        "light.b: GL would refuse spot_cutoff 100 (0 to 90, or 180); evaluated all the same",
        "material.m: GL would refuse shininess 200 (0 to 128); evaluated all the same",
        "material.m.back: GL would refuse shininess 300 (0 to 128); evaluated all the same",
        "material m: `back` is not used, since light_model.two_sided is false",
        "no object uses material `m`",
        "camera: eye fitted",
    ] {
        assert!(notes_found.contains(expected), "{expected}\n{notes_found}");
    }
    let dark = notes(&load_text("a.toml", BALL, &[]).unwrap());
    assert!(
        dark.contains("no light: only emission and scene ambient show"),
        "{dark}"
    );
}

#[test]
fn cameras_are_fitted_where_the_file_is_silent() {
    let ball = "[object.ball]\nshape = \"sphere\"\ncenter = [3, 0, 0]\n";
    let fitted = load_text("a.toml", format!("[camera]\nfovy = 20\n{ball}"), &[]).unwrap();
    assert!(fitted.fitted.eye && fitted.fitted.target && fitted.fitted.near);
    let camera = fitted.scene.camera;
    assert_eq!(camera.target, DVec3::new(3.0, 0.0, 0.0));
    assert_eq!(
        camera.projection,
        Projection::Perspective { fovy_deg: 20.0 }
    );
    let placed = load_text(
        "a.toml",
        format!("[camera]\neye = [3, 0, 5]\ntarget = [3, 0, 0]\n{ball}"),
        &[],
    );
    let camera = placed.unwrap().scene.camera;
    assert_eq!(camera.near, 2.0); // half of the least depth
    let parallel = load_text("a.toml", format!("[camera]\northographic = 4\n{ball}"), &[]);
    let camera = parallel.unwrap().scene.camera;
    assert_eq!(camera.projection, Projection::Orthographic { height: 4.0 });
    assert!(camera.eye_from_world(DVec3::new(3.0, 0.0, 0.0)).z < -1.0);
}
