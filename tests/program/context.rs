//! Fixed-function GL against its specification: projection matrices, vertex colours, and the program-facing context.

use std::sync::Arc;

use rastray::context::{
    Array, Buffers, Capability, Context, Format, GlError, LightModelParameter, LightParameter,
    MAX_LIGHTS, MAX_MODELVIEW_STACK_DEPTH, MaterialParameter, MatrixMode, PrimitiveMode,
};
use rastray::frame::{Frame, NONE};
use rastray::gl::{self, ColorMaterialMode, Face, LightSource, ShadeModel};
use rastray::math::{DAffine3, DMat4, DVec3};
use rastray::render::{Options, Precision, Renderer};
use rastray::scene::{
    Camera, Cull, FrontFace, Geometry, Light, LightSpace, Material, Mesh, Object, Optics,
    Projection, Scene, Shape,
};
use rastray::trace;

use crate::common::exact;
use crate::common::ladder::{climb, options};

// ---- scenes with a projection matrix --------------------------------------------------------------------------------

/// A camera at the origin that looks down -z.
fn eye_camera(projection: Projection) -> Camera {
    Camera {
        eye: DVec3::ZERO,
        target: DVec3::NEG_Z,
        up: DVec3::Y,
        projection,
        near: 1.0,
        far: Some(20.0),
    }
}

/// Two coloured triangles that cross the near plane and each other, and a ball.
fn sample_scene(projection: Projection) -> Scene {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (96, 64);
    scene.camera = eye_camera(projection);
    scene.lights.push(Light {
        name: "key".into(),
        source: LightSource {
            position: [1.0, 2.0, 3.0, 0.0],
            ..LightSource::default()
        },
        space: LightSpace::Eye,
        enabled: true,
    });
    scene.light_model.two_sided = true;
    let tracked = gl::ColorMaterial::default().tracked(false);
    scene.materials.push(Material {
        name: "tracks".into(),
        front: gl::Material {
            tracked,
            specular: [0.5; 3],
            shininess: 8.0,
            ..gl::Material::default()
        },
        back: Some(gl::Material {
            diffuse: [0.1, 0.2, 0.9],
            ..gl::Material::default()
        }),
        optics: Optics::default(),
    });
    let mesh = Mesh {
        positions: [
            [-3.0, -1.0, 0.5],
            [3.0, -1.0, -2.0],
            [0.0, 2.0, -9.0],
            [-2.0, 0.0, -9.0],
            [2.0, -1.5, -3.0],
            [2.0, 2.0, -6.0],
        ]
        .map(DVec3::from_array)
        .to_vec(),
        colors: vec![
            [1.0, 0.0, 0.0, 1.0],
            [0.0, 1.0, 0.0, 1.0],
            [0.0, 0.0, 1.0, 1.0],
            [1.0, 1.0, 0.0, 1.0],
            [0.0, 1.0, 1.0, 1.0],
            [1.0, 0.0, 1.0, 1.0],
        ],
        triangles: vec![[0, 1, 2], [5, 4, 3]],
        ..Mesh::default()
    };
    let ball = Shape::Sphere {
        center: DVec3::new(-1.0, 0.5, -4.0),
        radius: 0.8,
    };
    for geometry in [Geometry::Mesh(Arc::new(mesh)), Geometry::Shape(ball)] {
        scene.objects.push(Object {
            name: format!("object {}", scene.objects.len()),
            geometry,
            materials: vec![0],
            world_from_object: DAffine3::IDENTITY,
            tessellation: Some(12),
            priority: 0,
        });
    }
    scene
}

fn rasterized(scene: &Scene) -> Frame<f64> {
    exact::rasterized(scene, &options(Precision::F64), ShadeModel::Phong)
}

fn cast(scene: &Scene) -> Frame<f64> {
    let options = Options {
        geometry: trace::Geometry::Mesh,
        ..options(Precision::F64)
    };
    exact::traced(scene, &options, Renderer::Cast)
}

/// Projection matrices of every form, all of which see the sample scene.
fn matrices() -> Vec<(&'static str, DMat4)> {
    let aspect = 1.5;
    let view = |p: Projection| eye_camera(p).clip_from_eye(aspect);
    let perspective = view(Projection::Perspective { fovy_deg: 60.0 });
    let ortho = view(Projection::Orthographic { height: 5.0 });
    let shift = DMat4::from_translation(DVec3::new(0.25, -0.125, 0.0));
    vec![
        ("perspective", perspective),
        ("scaled", perspective * 7.0),
        ("off centre", shift * perspective),
        ("orthographic", ortho),
        (
            "behind the eye",
            ortho * DMat4::from_translation(DVec3::NEG_Z * 3.0),
        ),
        (
            "turned",
            perspective * DMat4::from_rotation_y(0.2) * DMat4::from_rotation_x(0.1),
        ),
        (
            "mirrored",
            DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)) * perspective,
        ),
        (
            "farthest first",
            DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0)) * perspective,
        ),
    ]
}

#[test]
fn both_renderers_see_the_same_through_any_matrix() {
    for (name, matrix) in matrices() {
        let scene = sample_scene(Projection::Matrix {
            clip_from_eye: matrix,
        });
        let ladder = climb(&scene, &options(Precision::F64));
        let agreement = ladder.agreement;
        assert_eq!(ladder.residual_max, 0.0, "{name}");
        assert!(agreement.interior_max <= 1e-9, "{name}: {agreement:?}");
        assert_eq!(agreement.coverage.raster_only, 0, "{name}: {agreement:?}");
        assert_eq!(agreement.coverage.trace_only, 0, "{name}: {agreement:?}");
        assert!(agreement.coverage.both > 1000, "{name}: {agreement:?}");
    }
}

#[test]
fn a_matrix_draws_what_the_camera_in_words_draws() {
    for projection in [
        Projection::Perspective { fovy_deg: 60.0 },
        Projection::Orthographic { height: 5.0 },
    ] {
        let words = sample_scene(projection);
        let matrix = eye_camera(projection).clip_from_eye(1.5);
        let numbers = sample_scene(Projection::Matrix {
            clip_from_eye: matrix,
        });
        for (a, b) in [
            (rasterized(&words), rasterized(&numbers)),
            (cast(&words), cast(&numbers)),
        ] {
            // Vertices may round to the other side of a tie; only pixels of the same triangle have the same colour.
            let seen = a.primitive.data.iter().zip(&b.primitive.data);
            let same: Vec<bool> = seen.map(|(a, b)| a == b).collect();
            let differing = same.iter().filter(|same| !**same).count();
            assert!(differing <= 3, "{projection:?}: {differing} pixels");
            let colors = a.color.data.iter().zip(&b.color.data).zip(&same);
            let pairs = colors
                .filter(|(_, same)| **same)
                .flat_map(|((a, b), _)| a.iter().zip(b));
            let largest = pairs.fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(largest < 1e-9, "{projection:?}: {largest:e}");
        }
    }
}

#[test]
fn a_matrix_without_inverse_shows_nothing() {
    let flat = DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let scene = sample_scene(Projection::Matrix {
        clip_from_eye: flat,
    });
    for frame in [rasterized(&scene), cast(&scene)] {
        assert!(frame.primitive.data.iter().all(|p| *p == NONE));
    }
}

#[test]
fn depth_reversed_shows_the_farthest_and_mirroring_turns_facing() {
    let perspective = matrices()[0].1;
    let [near, far] = [perspective, matrices()[7].1]
        .map(|m| rasterized(&sample_scene(Projection::Matrix { clip_from_eye: m })));
    let deeper = near.depth.data.iter().zip(&far.depth.data);
    assert!(deeper.clone().all(|(n, f)| n <= f) && deeper.clone().any(|(n, f)| n < f));
    // Culling back faces of the mirror image leaves what culling front faces leaves of the picture, column for column.
    let culled = |matrix, cull| {
        let mut scene = sample_scene(Projection::Matrix {
            clip_from_eye: matrix,
        });
        scene.objects.truncate(1);
        scene.raster.cull = cull;
        rasterized(&scene).primitive
    };
    let picture = culled(perspective, Cull::Front);
    let mirror = culled(matrices()[6].1, Cull::Back);
    let row =
        |plane: &rastray::frame::Plane<u32>, y: usize| plane.data[y * 96..(y + 1) * 96].to_vec();
    let mut different = 0;
    for y in 0..64 {
        let mut turned = row(&mirror, y);
        turned.reverse();
        different += turned
            .iter()
            .zip(row(&picture, y))
            .filter(|(a, b)| **a != *b)
            .count();
    }
    assert!(different == 0 && picture.data.contains(&1), "{different}");
}

// ---- the context ----------------------------------------------------------------------------------------------------

/// A window in which one unit is one pixel, (0, 0) its lower left.
fn pixel_window(width: u32, height: u32) -> Context {
    let mut gl = Context::new(width, height);
    gl.matrix_mode(MatrixMode::Projection);
    gl.ortho(0.0, f64::from(width), 0.0, f64::from(height), -1.0, 1.0);
    gl.matrix_mode(MatrixMode::ModelView);
    gl
}

/// Which vertex's colour each pixel has, top row first; '.' where nothing is.
fn provoking(mode: PrimitiveMode, vertices: &[[f64; 2]], width: u32, height: u32) -> Vec<String> {
    let mut gl = pixel_window(width, height);
    gl.shade_model(ShadeModel::Flat);
    gl.clear_color(1.0, 1.0, 1.0, 1.0);
    gl.clear(Buffers::COLOR);
    gl.begin(mode);
    for (i, [x, y]) in vertices.iter().enumerate() {
        gl.color3(i as f64 / 16.0, 0.0, 0.0);
        gl.vertex2(*x, *y);
    }
    gl.end();
    let pixels: Vec<f32> = gl.read_pixels(0, 0, width, height, Format::Rgb).unwrap();
    assert_eq!(gl.get_error(), None);
    let row = |row: &[f32]| -> String {
        let digit = |p: &[f32]| match (p[0] * 16.0) as u32 {
            16 => '.',
            i => char::from_digit(i, 16).unwrap(),
        };
        row.chunks(3).map(digit).collect()
    };
    pixels.chunks(3 * width as usize).rev().map(row).collect()
}

#[test]
fn provoking_vertices_of_all_modes() {
    use PrimitiveMode as M;
    // Centres never lie on a diagonal: the squares are 5 wide and 4 high.
    let zigzag = [
        [0.0, 0.0],
        [0.0, 4.0],
        [5.0, 0.0],
        [5.0, 4.0],
        [10.0, 0.0],
        [10.0, 4.0],
    ];
    let around = [[0.0, 0.0], [5.0, 0.0], [5.0, 4.0], [0.0, 4.0]];
    let two = [
        [0.0, 0.0],
        [5.0, 0.0],
        [0.0, 4.0],
        [5.0, 4.0],
        [0.0, 4.0],
        [5.0, 0.0],
    ];
    let next = around.map(|[x, y]| [x + 5.0, y]);
    let quads = [around, next].concat();
    assert_eq!(
        provoking(M::Triangles, &two, 5, 4),
        ["25555", "22555", "22255", "22225"]
    );
    assert_eq!(
        provoking(M::TriangleStrip, &zigzag, 10, 4),
        ["2333345555", "2233344555", "2223344455", "2222344445"]
    );
    assert_eq!(
        provoking(M::TriangleFan, &around, 5, 4),
        ["33332", "33322", "33222", "32222"]
    );
    assert_eq!(provoking(M::Quads, &quads, 10, 4), ["3333377777"; 4]);
    assert_eq!(provoking(M::QuadStrip, &zigzag, 10, 4), ["3333355555"; 4]);
    assert_eq!(provoking(M::Polygon, &around, 5, 4), ["00000"; 4]);
    // What is left over is ignored.
    assert_eq!(
        provoking(M::Triangles, &two[..5], 5, 4),
        ["2....", "22...", "222..", "2222."]
    );
    assert_eq!(provoking(M::Quads, &quads[..7], 10, 4), ["33333....."; 4]);
    assert_eq!(
        provoking(M::QuadStrip, &zigzag[..5], 10, 4),
        ["33333....."; 4]
    );
    assert_eq!(provoking(M::Polygon, &around[..2], 5, 4), ["....."; 4]);
}

#[test]
fn all_triangles_of_a_strip_face_the_same_way() {
    let zigzag = [
        [0.0, 0.0],
        [0.0, 4.0],
        [5.0, 0.0],
        [5.0, 4.0],
        [10.0, 0.0],
        [10.0, 4.0],
    ];
    for mode in [PrimitiveMode::TriangleStrip, PrimitiveMode::QuadStrip] {
        for (winding, seen) in [(FrontFace::Cw, 40), (FrontFace::Ccw, 0)] {
            let mut gl = pixel_window(10, 4);
            gl.enable(Capability::CullFace);
            gl.front_face(winding);
            gl.begin(mode);
            zigzag.iter().for_each(|[x, y]| gl.vertex2(*x, *y));
            gl.end();
            let frame = gl.draw().unwrap();
            let count = frame.primitive.data.iter().filter(|p| **p != NONE).count();
            assert_eq!(count, seen, "{mode:?} {winding:?}");
        }
    }
    let mut gl = pixel_window(10, 4);
    gl.enable(Capability::CullFace);
    gl.cull_face(Face::FrontAndBack);
    gl.begin(PrimitiveMode::QuadStrip);
    zigzag.iter().for_each(|[x, y]| gl.vertex2(*x, *y));
    gl.end();
    assert!(gl.scene().unwrap().objects.is_empty());
}

#[test]
fn stacks_and_the_error_flag() {
    let mut gl = Context::new(2, 2);
    gl.pop_matrix();
    gl.viewport(0, 0, -1, 4);
    // The first error stays; reading it clears it.
    assert_eq!(gl.get_error(), Some(GlError::StackUnderflow));
    assert_eq!(gl.get_error(), None);
    for _ in 1..32 {
        gl.push_matrix();
    }
    assert_eq!(
        gl.get_error(),
        None,
        "modelview stacks are 32 deep at least"
    );
    for _ in 32..=MAX_MODELVIEW_STACK_DEPTH {
        gl.push_matrix();
    }
    assert_eq!(gl.get_error(), Some(GlError::StackOverflow));
    gl.matrix_mode(MatrixMode::Projection);
    gl.push_matrix();
    gl.translate(1.0, 2.0, 3.0);
    assert_eq!(
        gl.matrix(MatrixMode::Projection)[12..],
        [1.0, 2.0, 3.0, 1.0]
    );
    gl.pop_matrix();
    assert_eq!(
        gl.matrix(MatrixMode::Projection)[12..],
        [0.0, 0.0, 0.0, 1.0]
    );
    // Between begin and end.
    gl.begin(PrimitiveMode::Triangles);
    gl.load_identity();
    assert_eq!(gl.get_error(), Some(GlError::InvalidOperation));
    gl.begin(PrimitiveMode::Quads);
    assert_eq!(gl.get_error(), Some(GlError::InvalidOperation));
    assert!(gl.read_pixels::<u8>(0, 0, 1, 1, Format::Rgb).is_err());
    assert_eq!(gl.get_error(), Some(GlError::InvalidOperation));
    gl.color3(1.0, 0.0, 0.0);
    gl.normal3(0.0, 1.0, 0.0);
    gl.material(Face::Front, MaterialParameter::Shininess(3.0));
    gl.end();
    assert_eq!(gl.get_error(), None);
    gl.end();
    assert_eq!(gl.get_error(), Some(GlError::InvalidOperation));
    assert_eq!(gl.current_normal(), [0.0, 1.0, 0.0]);
}

#[test]
fn matrices_are_gls() {
    let near = |a: [f64; 16], b: [f64; 16]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15);
    let mut gl = Context::new(2, 2);
    // The transform stated last comes first: a vertex at the origin ends at (1, 2, 3).
    gl.translate(1.0, 2.0, 3.0);
    gl.rotate(90.0, 0.0, 0.0, 5.0);
    gl.scale(2.0, 3.0, 4.0);
    let expected = [
        0.0, 2.0, 0.0, 0.0, -3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 1.0, 2.0, 3.0, 1.0,
    ];
    assert!(near(gl.matrix(MatrixMode::ModelView), expected));
    gl.load_identity();
    gl.frustum(-1.0, 3.0, -1.0, 1.0, 2.0, 6.0);
    let expected = [
        1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.5, 0.0, -2.0, -1.0, 0.0, 0.0, -6.0, 0.0,
    ];
    assert!(near(gl.matrix(MatrixMode::ModelView), expected));
    gl.load_matrix(&[3.0; 16]);
    gl.frustum(-1.0, 1.0, -1.0, 1.0, -2.0, 6.0);
    assert_eq!(gl.get_error(), Some(GlError::InvalidValue));
    gl.ortho(1.0, 1.0, 0.0, 1.0, 0.0, 1.0);
    assert_eq!(gl.get_error(), Some(GlError::InvalidValue));
    assert_eq!(gl.matrix(MatrixMode::ModelView), [3.0; 16]);
    gl.load_identity();
    gl.look_at([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    assert_eq!(
        gl.matrix(MatrixMode::ModelView)[12..],
        [0.0, 0.0, -5.0, 1.0]
    );
    gl.look_at([0.0; 3], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0]);
    assert_eq!(gl.get_error(), Some(GlError::InvalidValue));
}

#[test]
fn positions_are_transformed_when_set_and_errors_keep_the_old_value() {
    use LightParameter as L;
    let mut gl = Context::new(2, 2);
    gl.translate(1.0, 0.0, 0.0);
    gl.scale(1.0, 2.0, 1.0);
    gl.light(1, L::Position([1.0, 1.0, 1.0, 1.0]));
    gl.light(1, L::SpotDirection([0.0, 1.0, 0.0]));
    gl.load_identity();
    let light = gl.get_light(1).unwrap();
    assert_eq!(light.position, [2.0, 2.0, 1.0, 1.0]);
    assert_eq!(light.spot_direction, [0.0, 2.0, 0.0]);
    assert_eq!(
        (light.diffuse, gl.get_light(0).unwrap().diffuse),
        ([0.0; 3], [1.0; 3])
    );
    for wrong in [
        L::SpotExponent(128.5),
        L::SpotExponent(-1.0),
        L::SpotCutoff(100.0),
        L::SpotCutoff(f64::NAN),
        L::ConstantAttenuation(-1.0),
        L::LinearAttenuation(-1.0),
        L::QuadraticAttenuation(f64::NAN),
    ] {
        let before = gl.get_light(1).cloned();
        gl.light(1, wrong);
        assert_eq!(gl.get_error(), Some(GlError::InvalidValue), "{wrong:?}");
        assert_eq!(gl.get_light(1).cloned(), before, "{wrong:?}");
    }
    for right in [
        L::SpotExponent(128.0),
        L::SpotCutoff(90.0),
        L::SpotCutoff(180.0),
    ] {
        gl.light(1, right);
        assert_eq!(gl.get_error(), None, "{right:?}");
    }
    gl.light(MAX_LIGHTS, L::SpotExponent(1.0));
    assert_eq!(gl.get_error(), Some(GlError::InvalidValue));
    gl.material(Face::Back, MaterialParameter::Shininess(7.0));
    gl.material(Face::FrontAndBack, MaterialParameter::Shininess(129.0));
    assert_eq!(gl.get_error(), Some(GlError::InvalidValue));
    assert_eq!(
        (
            gl.get_material(false).shininess,
            gl.get_material(true).shininess
        ),
        (0.0, 7.0)
    );
}

/// A quad over the whole of clip space at z, facing the viewer.
fn full_quad(gl: &mut Context, z: f64) {
    gl.begin(PrimitiveMode::Quads);
    for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
        gl.vertex3(x, y, z);
    }
    gl.end();
}

fn one_pixel(gl: &mut Context) -> [f32; 4] {
    let pixel = gl.read_pixels(0, 0, 1, 1, Format::Rgba).unwrap();
    [pixel[0], pixel[1], pixel[2], pixel[3]]
}

#[test]
fn lighting_by_hand() {
    let mut gl = Context::new(1, 1);
    gl.enable(Capability::Lighting);
    full_quad(&mut gl, 0.0);
    // No light: scene ambient 0.2 times material ambient 0.2.
    assert_eq!(one_pixel(&mut gl), [0.04, 0.04, 0.04, 1.0]);
    gl.clear(Buffers::COLOR);
    // Light 0 from (0, 0, 1) on the normal (0, 0, 1): + 1 * 0.8.
    gl.enable(Capability::Light(0));
    full_quad(&mut gl, 0.0);
    assert_eq!(one_pixel(&mut gl)[0], 0.04f32 + 0.8);
    gl.clear(Buffers::COLOR);
    // Normals are taken as they come: a scale by 2 halves them (inverse transpose), and so the diffuse term.
    gl.push_matrix();
    gl.scale(2.0, 2.0, 2.0);
    full_quad(&mut gl, 0.0);
    assert!((one_pixel(&mut gl)[0] - 0.44).abs() < 1e-6);
    for on in [Capability::Normalize, Capability::RescaleNormal] {
        gl.clear(Buffers::COLOR);
        gl.enable(on);
        full_quad(&mut gl, 0.0);
        assert!((one_pixel(&mut gl)[0] - 0.84).abs() < 1e-6, "{on:?}");
        gl.disable(on);
    }
    gl.pop_matrix();
    // Alpha is the diffuse one; emission joins; everything is clamped.
    gl.clear(Buffers::COLOR);
    gl.material(
        Face::Front,
        MaterialParameter::Diffuse([0.5, 0.0, 0.25, 0.5]),
    );
    gl.material(
        Face::Front,
        MaterialParameter::Emission([0.25, -1.0, 9.0, 0.1]),
    );
    full_quad(&mut gl, 0.0);
    assert_eq!(one_pixel(&mut gl), [0.79, 0.0, 1.0, 0.5]);
    // Two-sided: the back has its own material and the turned normal.
    gl.clear(Buffers::COLOR);
    gl.light_model(LightModelParameter::TwoSide(true));
    gl.light_model(LightModelParameter::Ambient([0.0; 4]));
    gl.material(
        Face::Back,
        MaterialParameter::Diffuse([0.0, 1.0, 0.0, 0.25]),
    );
    gl.front_face(FrontFace::Cw);
    gl.normal3(0.0, 0.0, -1.0);
    full_quad(&mut gl, 0.0);
    assert_eq!(one_pixel(&mut gl), [0.0, 1.0, 0.0, 0.25]);
}

#[test]
fn without_lighting_the_colour_is_the_colour() {
    let mut gl = Context::new(1, 1);
    gl.enable(Capability::Light(0));
    gl.color4(0.1, 0.7, 2.0, 0.3);
    full_quad(&mut gl, 0.0);
    assert_eq!(one_pixel(&mut gl), [0.1, 0.7, 1.0, 0.3]);
    // Beside lit polygons, too.
    gl.enable(Capability::Lighting);
    full_quad(&mut gl, 0.0);
    assert_eq!(one_pixel(&mut gl)[3], 1.0);
    assert_eq!(one_pixel(&mut gl)[0], 0.04f32 + 0.8);
}

#[test]
fn color_material_changes_between_vertices() {
    // Gouraud over one row: red follows the colour from 0 to 1; the unlit terms stay.
    let mut gl = pixel_window(4, 1);
    gl.enable(Capability::Lighting);
    gl.light_model(LightModelParameter::Ambient([0.0; 4]));
    gl.enable(Capability::Light(0));
    gl.color_material(Face::Front, ColorMaterialMode::Diffuse);
    gl.enable(Capability::ColorMaterial);
    gl.begin(PrimitiveMode::Quads);
    for (x, y, red) in [
        (0.0, 0.0, 0.0),
        (4.0, 0.0, 1.0),
        (4.0, 1.0, 1.0),
        (0.0, 1.0, 0.0),
    ] {
        gl.color4(red, 0.5, 0.0, red);
        gl.vertex2(x, y);
    }
    gl.end();
    let row: Vec<f32> = gl.read_pixels(0, 0, 4, 1, Format::Rgba).unwrap();
    for (x, pixel) in row.chunks(4).enumerate() {
        let expected = (x as f32 + 0.5) / 4.0;
        assert!(
            (pixel[0] - expected).abs() < 1e-6 && pixel[1] == 0.5,
            "{pixel:?}"
        );
        assert!((pixel[3] - expected).abs() < 1e-6, "{pixel:?}");
    }
    let scene = gl.scene().unwrap();
    assert_eq!(scene.materials.len(), 1);
    assert!(scene.materials[0].front.tracked.diffuse);
    // The last colour stays in the material when it no longer follows (section 2.14.3); the other face never did.
    gl.disable(Capability::ColorMaterial);
    gl.color3(1.0, 1.0, 1.0);
    assert_eq!(gl.get_material(false).diffuse, [0.0, 0.5, 0.0]);
    assert_eq!(gl.get_material(true).diffuse, [0.8; 3]);
    // While it follows, material leaves it alone.
    gl.enable(Capability::ColorMaterial);
    gl.material(Face::Front, MaterialParameter::AmbientAndDiffuse([0.25; 4]));
    assert_eq!(gl.get_material(false).diffuse, [1.0; 3]);
    assert_eq!(gl.get_material(false).ambient, [0.25; 3]);
}

#[test]
fn materials_between_vertices_become_slots_or_are_refused() {
    let emit = |gl: &mut Context, red: f64, shininess: f64| {
        let face = Face::FrontAndBack;
        gl.material(face, MaterialParameter::Emission([red, 0.0, 0.0, 1.0]));
        gl.material(face, MaterialParameter::Shininess(shininess));
    };
    let draw = |mixed: bool, flat: bool| {
        let mut gl = pixel_window(2, 1);
        gl.enable(Capability::Lighting);
        gl.shade_model(if flat {
            ShadeModel::Flat
        } else {
            ShadeModel::Gouraud
        });
        gl.begin(PrimitiveMode::Quads);
        for left in [0.0, 1.0] {
            emit(&mut gl, 0.25 + left / 2.0, 1.0 + left);
            gl.vertex2(left, 0.0);
            if mixed {
                emit(&mut gl, 0.5, 9.0);
            }
            gl.vertex2(left + 1.0, 0.0);
            gl.vertex2(left + 1.0, 1.0);
            emit(&mut gl, 0.25 + left / 2.0, 1.0 + left);
            gl.vertex2(left, 1.0);
        }
        gl.end();
        gl
    };
    for (mixed, flat) in [(false, false), (false, true), (true, true)] {
        let mut gl = draw(mixed, flat);
        let row: Vec<f32> = gl.read_pixels(0, 0, 2, 1, Format::Rgb).unwrap();
        assert_eq!([row[0], row[3]], [0.25f32 + 0.04, 0.75f32 + 0.04]);
    }
    let error = draw(true, false).scene().unwrap_err().to_string();
    assert!(error.contains("more than one colour"), "{error}");
}

/// Points of a bumpy grid with normals, for arrays.
fn grid(side: u32) -> (Vec<f32>, Vec<f64>, Vec<f32>, Vec<u32>) {
    let (mut positions, mut normals, mut colors) = (Vec::new(), Vec::new(), Vec::new());
    for y in 0..=side {
        for x in 0..=side {
            let [u, v] = [x, y].map(|t| t as f32 / side as f32 * 1.8 - 0.9);
            positions.extend([u, v, 0.2 * (u * v)]);
            normals.extend([f64::from(-0.2 * v), f64::from(-0.2 * u), 1.0]);
            colors.extend([0.5 + u / 2.0, 0.5 + v / 2.0, 0.5]);
        }
    }
    let corner = |x: u32, y: u32| y * (side + 1) + x;
    let mut indices = Vec::new();
    for y in 0..side {
        for x in 0..side {
            let (a, b) = (corner(x, y), corner(x + 1, y));
            let (c, d) = (corner(x, y + 1), corner(x + 1, y + 1));
            indices.extend([a, b, c, c, b, d]);
        }
    }
    (positions, normals, colors, indices)
}

/// A lit window with colour material.
fn lit_window(size: u32, shading: ShadeModel) -> Context {
    let mut gl = Context::new(size, size);
    gl.shade_model(shading);
    for on in [
        Capability::Lighting,
        Capability::Light(0),
        Capability::DepthTest,
        Capability::Normalize,
        Capability::ColorMaterial,
    ] {
        gl.enable(on);
    }
    gl.material(Face::FrontAndBack, MaterialParameter::Specular([0.5; 4]));
    gl.material(Face::FrontAndBack, MaterialParameter::Shininess(20.0));
    gl.light(0, LightParameter::Position([1.0, 1.0, 2.0, 1.0]));
    gl
}

#[test]
fn arrays_elements_strips_and_vertices_draw_the_same_bytes() {
    let side = 6;
    let (positions, normals, colors, indices) = grid(side);
    for shading in [ShadeModel::Flat, ShadeModel::Gouraud] {
        let emit = |gl: &mut Context, i: u32| {
            let at = |list: &[f32]| [0, 1, 2].map(|k| f64::from(list[3 * i as usize + k]));
            let ([r, g, b], [x, y, z]) = (at(&colors), at(&positions));
            let n = &normals[3 * i as usize..];
            gl.color3(r, g, b);
            gl.normal3(n[0], n[1], n[2]);
            gl.vertex3(x, y, z);
        };
        let read = |mut gl: Context| {
            assert_eq!(gl.get_error(), None);
            gl.read_pixels::<f32>(0, 0, 40, 40, Format::Rgba).unwrap()
        };
        let mut by_vertices = lit_window(40, shading);
        by_vertices.begin(PrimitiveMode::Triangles);
        indices.iter().for_each(|i| emit(&mut by_vertices, *i));
        by_vertices.end();
        let mut by_elements = lit_window(40, shading);
        by_elements.vertex_pointer(3, &positions);
        by_elements.normal_pointer(&normals);
        by_elements.color_pointer(3, &colors);
        for array in [Array::Vertex, Array::Normal, Array::Color] {
            by_elements.enable_client_state(array);
        }
        let mut by_arrays = by_elements.clone();
        by_elements.draw_elements(PrimitiveMode::Triangles, &indices);
        let expand = |list: &[f32]| -> Vec<f32> {
            let of = |i: &u32| list[3 * *i as usize..][..3].to_vec();
            indices.iter().flat_map(of).collect()
        };
        let long: Vec<f64> = indices
            .iter()
            .flat_map(|i| normals[3 * *i as usize..][..3].to_vec())
            .collect();
        by_arrays.vertex_pointer(3, &expand(&positions));
        by_arrays.normal_pointer(&long);
        by_arrays.color_pointer(3, &expand(&colors));
        by_arrays.draw_arrays(PrimitiveMode::Triangles, 0, indices.len() as u32);
        let mut by_strips = lit_window(40, shading);
        for y in 0..side {
            by_strips.begin(PrimitiveMode::TriangleStrip);
            for x in 0..=side {
                for row in [0, 1] {
                    emit(&mut by_strips, (y + row) * (side + 1) + x);
                }
            }
            by_strips.end();
        }
        let reference = read(by_vertices);
        assert!(reference.iter().any(|x| *x > 0.5));
        assert_eq!(read(by_elements), reference);
        assert_eq!(read(by_arrays), reference);
        if shading == ShadeModel::Gouraud {
            // The same diagonals, other corners first: the same picture within rounding.
            let strips = read(by_strips);
            let differing = strips
                .iter()
                .zip(&reference)
                .filter(|(a, b)| (*a - *b).abs() > 1e-6);
            assert_eq!(differing.count(), 0);
        }
    }
    let mut gl = lit_window(4, ShadeModel::Flat);
    gl.vertex_pointer(3, &[0.0f32; 9]);
    gl.draw_elements(PrimitiveMode::Triangles, &[0, 1, 2]);
    assert!(
        gl.scene().unwrap().objects.is_empty(),
        "the array is not enabled"
    );
    gl.enable_client_state(Array::Vertex);
    gl.draw_elements(PrimitiveMode::Triangles, &[0, 1, 3]);
    assert_eq!(gl.get_error(), Some(GlError::InvalidValue));
    gl.draw_arrays(PrimitiveMode::Triangles, 1, u32::MAX);
    assert_eq!(gl.get_error(), Some(GlError::InvalidValue));
    gl.vertex_pointer(5, &[0.0f32; 9]);
    assert_eq!(gl.get_error(), Some(GlError::InvalidValue));
}

#[test]
fn pixels_come_bottom_row_first_and_depth_is_the_windows() {
    let mut gl = Context::new(2, 3);
    gl.enable(Capability::DepthTest);
    gl.clear_color(0.0, 0.0, 1.0, 0.5);
    gl.clear(Buffers::COLOR | Buffers::DEPTH);
    gl.depth_range(0.25, 0.75);
    gl.color3(1.0, 0.0, 0.0);
    gl.begin(PrimitiveMode::Polygon);
    for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, -0.3], [-1.0, -0.3]] {
        gl.vertex3(x, y, 0.5); // the bottom row; identity projection: ndc z = 0.5
    }
    gl.end();
    let rgb: Vec<u8> = gl.read_pixels(0, 0, 1, 3, Format::Rgb).unwrap();
    assert_eq!(rgb, [255, 0, 0, 0, 0, 255, 0, 0, 255]);
    let rgba: Vec<u8> = gl.read_pixels(1, 0, 1, 2, Format::Rgba).unwrap();
    assert_eq!(rgba, [255, 0, 0, 255, 0, 0, 255, 128]);
    assert_eq!(gl.read_depth(0, 0, 1, 2).unwrap(), [0.625, 1.0]);
    // Nearer wins, whatever the order; without the test, later.
    for (test, red) in [(true, 1.0), (false, 0.0)] {
        gl.clear(Buffers::COLOR | Buffers::DEPTH);
        if !test {
            gl.disable(Capability::DepthTest);
        }
        gl.color3(1.0, 0.0, 0.0);
        full_quad(&mut gl, -0.5);
        gl.color3(0.0, 1.0, 0.0);
        full_quad(&mut gl, 0.5);
        assert_eq!(one_pixel(&mut gl)[0], red);
        let depth = gl.read_depth(0, 0, 1, 1).unwrap()[0];
        assert_eq!(depth, if test { 0.375 } else { 1.0 });
    }
    // Window depth of a perspective view: z = f/(f-n) (1 - n/d).
    let mut gl = Context::new(1, 1);
    gl.enable(Capability::DepthTest);
    gl.matrix_mode(MatrixMode::Projection);
    gl.perspective(90.0, 1.0, 1.0, 9.0);
    for turn in [0.0, 30.0] {
        gl.matrix_mode(MatrixMode::ModelView);
        gl.clear(Buffers::COLOR | Buffers::DEPTH);
        gl.matrix_mode(MatrixMode::Projection);
        gl.push_matrix();
        gl.rotate(turn, 0.0, 1.0, 0.0);
        gl.matrix_mode(MatrixMode::ModelView);
        gl.push_matrix();
        gl.rotate(-turn, 0.0, 1.0, 0.0);
        gl.scale(9.0, 9.0, 1.0);
        full_quad(&mut gl, -3.0);
        gl.pop_matrix();
        let depth = gl.read_depth(0, 0, 1, 1).unwrap()[0];
        assert!((depth - 0.75).abs() < 1e-6, "{depth}");
        gl.matrix_mode(MatrixMode::Projection);
        gl.pop_matrix();
    }
}

#[test]
fn viewports_place_the_picture_in_the_window() {
    let mut gl = Context::new(4, 4);
    gl.clear_color(0.25, 0.25, 0.25, 1.0);
    gl.clear(Buffers::COLOR);
    gl.viewport(1, 2, 2, 1);
    full_quad(&mut gl, 0.0);
    let red: Vec<u8> = gl.read_pixels(0, 0, 4, 4, Format::Rgb).unwrap();
    let red: Vec<u8> = red.chunks(3).map(|p| p[0]).collect();
    assert_eq!(
        red,
        [
            64, 64, 64, 64, 64, 64, 64, 64, 64, 255, 255, 64, 64, 64, 64, 64
        ]
    );
    assert_eq!(
        gl.read_pixels::<u8>(-1, 2, 3, 1, Format::Rgb).unwrap()[..7],
        [64, 64, 64, 64, 64, 64, 255]
    );
    assert!(
        gl.read_pixels::<u8>(0, 0, u32::MAX, u32::MAX, Format::Rgb)
            .is_err()
    );
    gl.viewport(0, 0, 0, 0);
    gl.clear(Buffers::COLOR);
    assert_eq!(
        gl.read_pixels::<u8>(0, 0, 1, 1, Format::Rgba).unwrap(),
        [64, 64, 64, 255]
    );
}

#[test]
fn what_a_scene_cannot_hold_is_refused_by_name() {
    type Change = fn(&mut Context);
    let changes: &[(&str, Change)] = &[
        ("a light", |gl| {
            gl.light(0, LightParameter::Ambient([1.0; 4]))
        }),
        ("a light", |gl| gl.enable(Capability::Light(3))),
        ("the light model", |gl| {
            gl.light_model(LightModelParameter::TwoSide(true))
        }),
        ("handling of normals", |gl| {
            gl.enable(Capability::RescaleNormal)
        }),
        ("projection", |gl| {
            gl.matrix_mode(MatrixMode::Projection);
            gl.scale(2.0, 1.0, 1.0);
        }),
        ("viewport", |gl| gl.viewport(0, 0, 1, 1)),
        ("shade model", |gl| gl.shade_model(ShadeModel::Flat)),
        ("culling", |gl| gl.enable(Capability::CullFace)),
        ("front face", |gl| gl.front_face(FrontFace::Cw)),
        ("depth range", |gl| gl.depth_range(0.5, 1.0)),
        ("depth test", |gl| gl.disable(Capability::DepthTest)),
        ("clear of one buffer", |gl| gl.clear(Buffers::DEPTH)),
    ];
    for (what, change) in changes {
        let mut gl = lit_window(2, ShadeModel::Gouraud);
        full_quad(&mut gl, 0.0);
        change(&mut gl);
        full_quad(&mut gl, 0.0);
        let error = gl.scene().unwrap_err();
        assert!(error.to_string().contains(what), "{what}: {error}");
        assert!(error.help().is_some() && gl.draw().is_err() && gl.trace().is_err());
        // A new picture starts afresh, and what is set but not used does not matter.
        gl.clear(Buffers::COLOR | Buffers::DEPTH);
        full_quad(&mut gl, 0.0);
        assert!(gl.scene().is_ok(), "{what}");
    }
    let mut gl = Context::new(2, 2);
    gl.begin(PrimitiveMode::Triangles);
    gl.vertex4(0.0, 0.0, 0.0, 0.0);
    gl.end();
    assert!(gl.scene().unwrap_err().to_string().contains("w = 0"));
}

#[test]
fn sheared_and_mirrored_modelviews_light_as_gl_says() {
    // x' = x + y: the inverse transpose takes (1, 0, 0) to (1, -1, 0); unnormalised, its diffuse term with a light from
    // +x is 1, with Normalize 1/sqrt 2.
    for (normalize, expected) in [(false, 1.0), (true, 0.5f32.sqrt())] {
        let mut gl = Context::new(1, 1);
        gl.enable(Capability::Lighting);
        gl.enable(Capability::Light(0));
        gl.light_model(LightModelParameter::Ambient([0.0; 4]));
        gl.light(0, LightParameter::Position([1.0, 0.0, 0.0, 0.0]));
        gl.material(Face::Front, MaterialParameter::Diffuse([1.0; 4]));
        if normalize {
            gl.enable(Capability::Normalize);
        }
        gl.mult_matrix(&[
            1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
        ]);
        gl.normal3(1.0, 0.0, 0.0);
        full_quad(&mut gl, 0.0);
        assert!((one_pixel(&mut gl)[0] - expected).abs() < 1e-6);
        // The same modelview times 2 as a whole is the same place, and half the normal.
        gl.clear(Buffers::COLOR);
        gl.load_matrix(&[
            2.0, 0.0, 0.0, 0.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 2.0,
        ]);
        full_quad(&mut gl, 0.0);
        let scale = if normalize { 1.0 } else { 0.5 };
        assert!((one_pixel(&mut gl)[0] - expected * scale).abs() < 1e-6);
        // A mirror turns the winding: the quad now shows its back, and is culled.
        gl.clear(Buffers::COLOR);
        gl.load_identity();
        gl.scale(-1.0, 1.0, 1.0);
        gl.enable(Capability::CullFace);
        full_quad(&mut gl, 0.0);
        assert_eq!(one_pixel(&mut gl)[0], 0.0);
    }
}

#[test]
fn the_same_scene_is_traced() {
    // A small quad before a large one: the light behind the viewer throws its shadow.
    let mut gl = lit_window(32, ShadeModel::Gouraud);
    gl.matrix_mode(MatrixMode::Projection);
    gl.ortho(-1.0, 1.0, -1.0, 1.0, 0.0, 4.0);
    gl.matrix_mode(MatrixMode::ModelView);
    gl.load_identity();
    gl.light(0, LightParameter::Position([1.0, 0.0, 1.0, 0.0]));
    full_quad(&mut gl, -2.0);
    gl.color3(1.0, 0.0, 0.0);
    gl.scale(0.25, 0.25, 1.0);
    full_quad(&mut gl, -1.5);
    let traced = gl.trace().unwrap();
    let drawn = gl.draw().unwrap();
    assert_eq!(traced.primitive, drawn.primitive);
    // The shadow lies 0.5 to the left: at x = -0.5 the tracer is darker, elsewhere not.
    let dark = |x: usize| traced.color.at(x, 16)[1] < drawn.color.at(x, 16)[1] - 0.3;
    assert!(dark(8) && !dark(3) && !dark(16) && !dark(28));
}
