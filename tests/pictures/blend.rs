//! `raster.transparency = "blend"` against answers derived by hand: C = alpha C_s + (1 - alpha) C_d with
//! alpha = 1 - luminance(K_T), opaque surfaces first, then transmissive ones in their order (GL 2.1 section 4.1.8).

use std::sync::Arc;

use rastray::frame::{Frame, LayerIndex, NONE};
use rastray::gl::{self, ColorControl, ShadeModel};
use rastray::import::{LoadOptions, load};
use rastray::lanes::Isa;
use rastray::math::color::luma;
use rastray::math::{DAffine3, DVec3};
use rastray::raster::{Counters, Options};
use rastray::render::Precision;
use rastray::sampling::Pattern;
use rastray::scene::{
    Camera, Geometry, Material, Mesh, Object, Optics, Projection, Scene, Snap, Transparency,
};

use crate::common::ladder;
use crate::common::precise::{Precise, assembled, rasterize, rasterizer};

const SHADINGS: [ShadeModel; 3] = [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong];
const SIZE: u32 = 8;

/// An empty picture of SIZE x SIZE pixels, one unit a pixel, that blends.
fn empty() -> Scene {
    let mut scene = Scene::default();
    (scene.image.width, scene.image.height) = (SIZE, SIZE);
    scene.camera = Camera {
        projection: Projection::Orthographic {
            height: f64::from(SIZE),
        },
        near: 1.0,
        ..Camera::default()
    };
    scene.light_model.ambient = [0.0; 3];
    scene.raster.transparency = Transparency::Blend;
    scene
}

/// Adds two triangles that shine by themselves over the columns of a range, all rows, at a depth of world space.
fn pane(scene: &mut Scene, columns: [f64; 2], z: f64, emission: [f64; 3], transmission: [f64; 3]) {
    let half = f64::from(SIZE) / 2.0;
    let [l, r] = columns.map(|x| x - half);
    let corners = [[l, -half], [r, -half], [r, half], [l, half]];
    let mesh = Mesh {
        positions: corners.map(|[x, y]| DVec3::new(x, y, z)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    scene.materials.push(Material {
        name: String::new(),
        front: gl::Material {
            emission,
            ambient: [0.0; 3],
            diffuse: [0.0; 3],
            ..gl::Material::default()
        },
        back: None,
        optics: Optics {
            transmission,
            ..Optics::default()
        },
    });
    scene.objects.push(Object {
        name: format!("pane {}", scene.objects.len()),
        geometry: Geometry::Mesh(Arc::new(mesh)),
        materials: vec![scene.materials.len() - 1],
        world_from_object: DAffine3::IDENTITY,
        tessellation: None,
        priority: 0,
    });
}

const WHOLE: [f64; 2] = [0.0, SIZE as f64];

fn options(shading: ShadeModel) -> Options {
    Options {
        shading,
        clamp: false,
        layers: false,
        isa: Isa::detect(),
    }
}

fn draw<R: Precise>(scene: &Scene, options: &Options) -> (Frame<R>, Counters) {
    let assembly = assembled::<R>(scene, None).expect("a small scene");
    let plan = rasterizer(scene, &assembly);
    rasterize(&plan, options).expect("a legal picture")
}

/// The one colour of a picture in every shading, and its one primitive's number halved: the object.
fn one_color(scene: &Scene) -> ([f64; 3], u32) {
    let frames = SHADINGS.map(|shading| draw::<f64>(scene, &options(shading)).0);
    let first = (frames[0].color.data[0], frames[0].object.data[0]);
    for frame in &frames {
        assert!(frame.color.data.iter().all(|c| *c == first.0));
        assert!(frame.object.data.iter().all(|o| *o == first.1));
    }
    first
}

/// The equation as GL has it.
fn over(transmission: [f64; 3], source: [f64; 3], destination: [f64; 3]) -> [f64; 3] {
    let alpha = 1.0 - luma(transmission);
    [0, 1, 2].map(|c| alpha * source[c] + (1.0 - alpha) * destination[c])
}

#[test]
fn half_of_the_pane_and_half_of_the_wall() {
    let (wall, own) = ([0.5, 0.25, 1.0], [0.125, 0.75, 0.0]);
    let mut scene = empty();
    pane(&mut scene, WHOLE, -5.0, wall, [0.0; 3]);
    pane(&mut scene, WHOLE, -3.0, own, [0.5; 3]);
    // Dyadic numbers: the arithmetic is exact.
    assert_eq!(luma([0.5; 3]), 0.5);
    let mean = [0, 1, 2].map(|c| 0.5 * own[c] + 0.5 * wall[c]);
    // Depth writes are off: the planes are those of the wall.
    assert_eq!(one_color(&scene), (mean, 0));
    let frame = draw::<f32>(&scene, &options(ShadeModel::Flat)).0;
    let depth = (scene.camera.eye.z + 5.0) as f32;
    assert!(frame.depth.data.iter().all(|d| *d == depth));
    // The order of the file does not matter between opaque and transmissive.
    scene.objects.reverse();
    assert_eq!(one_color(&scene), (mean, 1));
    // Opaque: the pane alone.
    scene.raster.transparency = Transparency::Opaque;
    assert_eq!(one_color(&scene), (own, 0));
}

#[test]
fn colored_transmission_counts_by_its_luminance() {
    let (wall, own) = ([0.9, 0.3, 0.1], [0.2, 0.4, 0.6]);
    for transmission in [[0.9, 0.0, 0.0], [0.0, 0.0, 0.7], [0.1, 0.8, 0.3], [1.0; 3]] {
        let mut scene = empty();
        pane(&mut scene, WHOLE, -5.0, wall, [0.0; 3]);
        pane(&mut scene, WHOLE, -3.0, own, transmission);
        assert_eq!(one_color(&scene).0, over(transmission, own, wall));
    }
    // Beyond 1 alpha is 0, not negative.
    let mut scene = empty();
    pane(&mut scene, WHOLE, -5.0, wall, [0.0; 3]);
    pane(&mut scene, WHOLE, -3.0, own, [3.0; 3]);
    assert_eq!(one_color(&scene).0, wall);
}

#[test]
fn panes_are_blended_in_the_order_of_the_file() {
    let (wall, a, b) = ([1.0, 0.5, 0.25], [0.5, 0.0, 0.0], [0.0, 0.0, 0.75]);
    let (clear, dim) = ([0.75; 3], [0.25; 3]);
    // GL does not sort: the order of the file decides, whichever pane is nearer.
    for [near, far] in [[-2.0, -3.0], [-3.0, -2.0]] {
        let mut scene = empty();
        pane(&mut scene, WHOLE, near, a, clear);
        pane(&mut scene, WHOLE, -5.0, wall, [0.0; 3]);
        pane(&mut scene, WHOLE, far, b, dim);
        let first_a = over(dim, b, over(clear, a, wall));
        assert_eq!(one_color(&scene), (first_a, 1));
        scene.objects.reverse();
        let first_b = over(clear, a, over(dim, b, wall));
        assert_eq!(one_color(&scene), (first_b, 1));
        assert_ne!(first_a, first_b);
    }
}

#[test]
fn the_depth_of_opaque_surfaces_hides() {
    let (wall, own, background) = ([0.5; 3], [1.0; 3], [0.25, 0.5, 0.75]);
    let mut scene = empty();
    scene.image.background = background;
    pane(&mut scene, [0.0, 4.0], -3.0, wall, [0.0; 3]);
    // Behind the wall, at its very depth (GL_LESS), and beside it over the background.
    pane(&mut scene, WHOLE, -4.0, own, [0.5; 3]);
    pane(&mut scene, [0.0, 4.0], -3.0, own, [0.5; 3]);
    for shading in SHADINGS {
        let frame = draw::<f64>(&scene, &options(shading)).0;
        for (pixel, color) in frame.color.data.iter().enumerate() {
            let left = pixel % SIZE as usize >= 4;
            let expected = if left {
                over([0.5; 3], own, background)
            } else {
                wall
            };
            assert_eq!(*color, expected);
            assert_eq!(frame.object.data[pixel], if left { NONE } else { 0 });
            assert_eq!(frame.depth.data[pixel].is_finite(), !left);
        }
    }
}

#[test]
fn without_a_depth_test_the_order_is_the_files() {
    let (wall, a, b) = ([1.0, 0.5, 0.25], [0.5, 0.0, 0.0], [0.0, 0.0, 0.75]);
    let mut scene = empty();
    scene.raster.depth_test = false;
    pane(&mut scene, WHOLE, -2.0, a, [0.5; 3]);
    pane(&mut scene, WHOLE, -5.0, wall, [0.0; 3]);
    // Behind, and blended all the same.
    pane(&mut scene, WHOLE, -6.0, b, [0.5; 3]);
    assert_eq!(one_color(&scene), (over([0.5; 3], b, wall), 1));
}

#[test]
fn the_source_is_clamped_before_it_is_blended() {
    let (wall, own) = ([0.5, -1.0, 3.0], [2.0, 0.5, -4.0]);
    let mut scene = empty();
    pane(&mut scene, WHOLE, -5.0, wall, [0.0; 3]);
    pane(&mut scene, WHOLE, -3.0, own, [0.75; 3]);
    for control in [ColorControl::Single, ColorControl::SeparateSpecular] {
        scene.light_model.color_control = control;
        for shading in SHADINGS {
            let clamped = Options {
                clamp: true,
                layers: true,
                ..options(shading)
            };
            let frame = draw::<f64>(&scene, &clamped).0;
            let expected = over([0.75; 3], [1.0, 0.5, 0.0], [0.5, 0.0, 1.0]);
            assert!(frame.color.data.iter().all(|c| *c == expected));
            // The layers are those of the unclamped picture.
            let plain = over([0.75; 3], own, wall);
            let layers = frame.layers.as_ref().expect("layers");
            assert!((0..64).all(|pixel| layers.sum(pixel) == plain));
        }
    }
}

/// A shipped scene, small, that blends.
fn shipped(name: &str) -> Scene {
    let sets = vec!["raster.transparency=blend".to_owned()];
    let options = LoadOptions {
        sets,
        ..LoadOptions::default()
    };
    let mut scene = load(name, &options).expect("a shipped scene").scene;
    (scene.image.width, scene.image.height) = (150, 110);
    scene
}

/// Every bit of a frame.
fn bits(frame: &Frame<f32>) -> Vec<u32> {
    let layers = frame.layers.iter().flat_map(|l| &l.planes);
    let colors = std::iter::once(&frame.color).chain(layers);
    let colors = colors.flat_map(|p| p.data.iter().flatten().map(|x| x.to_bits()));
    let depth = frame.depth.data.iter().map(|x| x.to_bits());
    let ids = frame.primitive.data.iter().chain(&frame.object.data);
    colors.chain(depth).chain(ids.copied()).collect()
}

#[test]
fn same_bytes_for_threads_and_instruction_sets_and_layers_add_up() {
    let mut scene = shipped("whitted");
    let grid = (1, Pattern::Grid, Snap::Bits8);
    for (samples, pattern, snap) in [grid, (3, Pattern::Jitter, Snap::Exact)] {
        (scene.image.samples, scene.image.pattern) = (samples, pattern);
        scene.raster.snap = snap;
        for shading in SHADINGS {
            let plain = draw::<f32>(&scene, &options(shading)).0;
            let on = |threads: usize, isa: Isa| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                let layers = Options {
                    layers: true,
                    isa,
                    ..options(shading)
                };
                pool.expect("threads")
                    .install(|| draw::<f32>(&scene, &layers))
            };
            let (frame, counters) = on(1, Isa::detect());
            assert_eq!(frame.color, plain.color);
            for isa in Isa::available() {
                let (other, counted) = on(3, isa);
                assert_eq!((bits(&other), counted), (bits(&frame), counters));
            }
            let layers = frame.layers.as_ref().expect("layers");
            let sums = (0..plain.color.data.len()).map(|pixel| layers.sum(pixel));
            assert!(sums.eq(plain.color.data.iter().copied()));
            // What closes the sum is rounding.
            let lights = scene.enabled_lights().count();
            let rest = &layers.planes[LayerIndex { lights }.remainder()];
            assert!(rest.data.iter().flatten().all(|x| x.abs() < 1e-5));
        }
    }
}

#[test]
fn only_transmissive_surfaces_pay() {
    // Nothing to blend: same bytes, same counters.
    let mut scene = shipped("07-diffuse");
    assert!(!scene.blends());
    let blended = draw::<f32>(&scene, &options(ShadeModel::Gouraud));
    scene.raster.transparency = Transparency::Opaque;
    let opaque = draw::<f32>(&scene, &options(ShadeModel::Gouraud));
    assert_eq!(bits(&blended.0), bits(&opaque.0));
    assert_eq!(blended.1, opaque.1);
    // Something to blend: the planes beside the colours are those of the scene without it.
    let mut scene = shipped("16-transparency");
    let blended = draw::<f32>(&scene, &options(ShadeModel::Gouraud)).0;
    let clear: Vec<bool> = scene
        .materials
        .iter()
        .map(|m| m.optics.blend_alpha().is_some())
        .collect();
    scene
        .objects
        .retain(|o| !o.materials.iter().any(|m| clear[*m]));
    let without = draw::<f32>(&scene, &options(ShadeModel::Gouraud)).0;
    assert_eq!(blended.depth, without.depth);
    assert_ne!(blended.color, without.color);
}

#[test]
fn many_overlapping_panes_pass_through_several_batches() {
    // 40 panes of 64 x 64 pixels are more samples than one batch holds; each leaves half of what was there.
    let mut scene = empty();
    scene.camera.projection = Projection::Orthographic { height: 8.0 };
    (scene.image.width, scene.image.height) = (64, 64);
    scene.image.background = [1.0; 3];
    for i in 0..40 {
        pane(
            &mut scene,
            WHOLE,
            -2.0 - f64::from(i),
            [f64::from(i % 2), 0.0, 0.0],
            [0.5; 3],
        );
    }
    let expected = (0..40).fold([1.0; 3], |c, i| {
        over([0.5; 3], [f64::from(i % 2), 0.0, 0.0], c)
    });
    assert_eq!(one_color(&scene), (expected, NONE));
}

#[test]
fn the_ladder_says_which_step_ends_the_blending() {
    let climb = |scene: &Scene| ladder::climb(scene, &ladder::options(Precision::F32));
    let mut scene = shipped("16-transparency");
    let blended = climb(&scene);
    scene.raster.transparency = Transparency::Opaque;
    let opaque = climb(&scene);
    assert_eq!(blended.residual_max, 0.0);
    assert_eq!(blended.agreement, opaque.agreement);
    assert!(blended.agreement.interior_max <= 1e-5);
    let [note] = &blended.notes[..] else {
        panic!("one note, not {:?}", blended.notes);
    };
    assert!(note.message.contains("`coverage`"), "{note}");
    assert!(opaque.notes.is_empty());
    // From rung 4 on the ladders are the same, and coverage alone takes the blending away.
    assert_eq!(blended.rungs[4..], opaque.rungs[4..]);
    assert_ne!(blended.rungs[3], opaque.rungs[3]);
}
