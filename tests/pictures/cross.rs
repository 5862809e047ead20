//! The rasterizer against the tracer, and both against themselves: the most valuable tests of the project.
//!
//! On every shipped scene: the causes sum to the total difference with residual 0; rungs 3 and 4 agree as the ladder
//! promises; layers add up to the pictures bit for bit; thread count and instruction set change no byte.

use rastray::decompose::{CAUSES, Ladder, agreement};
use std::sync::OnceLock;

use rastray::frame::{Frame, Layers, Plane};
use rastray::gl::ShadeModel;
use rastray::import::{Shipped, shipped};
use rastray::lanes::{Isa, Real};
use rastray::render::{Options, Precision};
use rastray::scene::Scene;
use rastray::{raster, trace};

use crate::common::ladder::{climb, options};
use crate::common::precise::{Precise, assembled, follow, rasterize, rasterizer, tracer};
use crate::common::scenes::scene;

fn in_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a pool")
        .install(work)
}

/// Size of the shared ladders: several tiles in every renderer.
const SIZE: [u32; 2] = [96, 72];

/// The ladders of all shipped scenes in f32, climbed once for all tests.
fn ladders() -> &'static [(&'static str, Ladder)] {
    static LADDERS: OnceLock<Vec<(&str, Ladder)>> = OnceLock::new();
    LADDERS.get_or_init(|| {
        let ladder = |s: &Shipped| {
            (
                s.name,
                climb(&scene(s.name, SIZE, &[]), &Options::default()),
            )
        };
        shipped().iter().map(ladder).collect()
    })
}

#[test]
fn causes_sum_to_the_total_on_every_shipped_scene() {
    for (name, ladder) in ladders() {
        assert_eq!(ladder.residual_max, 0.0, "{name}");
        assert_eq!(ladder.limited_pixels, 0, "{name}");
        assert_eq!(ladder.rungs.len(), CAUSES.len() + 1);
        let total: f64 = ladder.total().data.iter().flatten().map(|x| x.abs()).sum();
        assert!(total > 0.0, "{name}: the two pictures are the same");
    }
}

/// The agreement that is drawn alone is the ladder's, also where samples or blending make both draw anew.
#[test]
fn the_agreement_alone_is_that_of_the_ladder() {
    for sets in [
        &[][..],
        &["image.samples=4"],
        &["raster.transparency=\"blend\""],
    ] {
        for precision in Precision::ALL {
            let (scene, options) = (scene("16-transparency", [48, 36], sets), options(precision));
            let alone = agreement(&scene, &options).expect("drawn");
            assert_eq!(climb(&scene, &options).agreement, alone, "{sets:?}");
            assert!(alone.coverage.both > 100, "{alone:?}");
        }
    }
}

#[test]
fn raster_and_cast_agree_on_every_shipped_scene() {
    for shipped in shipped() {
        let scene = scene(shipped.name, [320, 240], &[]);
        for precision in Precision::ALL {
            let agreement = agreement(&scene, &options(precision)).expect("drawn");
            println!("{}: {agreement:?}", shipped.name);
            assert!(
                agreement.interior_max <= 1e-5,
                "{}: {agreement:?}",
                shipped.name
            );
            assert_eq!(agreement.coverage.raster_only, 0, "{}", shipped.name);
            assert_eq!(agreement.coverage.trace_only, 0, "{}", shipped.name);
            let both = agreement.coverage.both;
            assert!(
                both > 20 * agreement.edge_pixels,
                "{}: {agreement:?}",
                shipped.name
            );
        }
    }
}

/// Bit for bit, -0 and +0 apart.
fn assert_layers_sum<R: Real>(layers: &Layers<R>, color: &Plane<[R; 3]>, what: &str) {
    for (pixel, color) in color.data.iter().enumerate() {
        let sum = layers.sum(pixel);
        for c in 0..3 {
            let (sum, color) = (sum[c].to_f64().to_bits(), color[c].to_f64().to_bits());
            assert_eq!(sum, color, "{what}: pixel {pixel}, channel {c}");
        }
    }
}

/// Every picture of a scene, with layers, and whether the picture without them is the same: three shadings, and traced.
fn with_layers<R: Precise>(scene: &Scene) -> Vec<(String, Frame<R>, bool)> {
    let (assembly, isa) = (assembled::<R>(scene, None), Isa::detect());
    let assembly = assembly.expect("an assembly");
    let plan = rasterizer(scene, &assembly);
    let mut pictures = Vec::new();
    for shading in [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong] {
        let [frame, without] = [true, false].map(|layers| {
            let options = raster::Options {
                shading,
                clamp: false,
                layers,
                isa,
            };
            rasterize::<R>(&plan, &options).expect("a picture").0
        });
        let same = frame.color == without.color;
        pictures.push((format!("{shading:?}"), frame, same));
    }
    let plan = tracer(scene, &assembly, trace::Geometry::Exact).expect("a plan");
    let [frame, without] = [true, false].map(|layers| {
        let options = trace::Options {
            layers,
            ..trace::Options::of(scene, isa)
        };
        follow::<R>(&plan, &options).expect("a picture").0
    });
    let same = frame.color == without.color;
    pictures.push(("traced".to_owned(), frame, same));
    pictures
}

#[test]
fn layers_add_up_bit_for_bit() {
    for shipped in shipped() {
        for samples in [1, 4] {
            let mut scene = scene(shipped.name, [72, 54], &[]);
            scene.image.samples = samples;
            layers_of::<f32>(&scene, shipped.name);
            layers_of::<f64>(&scene, shipped.name);
        }
    }
}

fn layers_of<R: Precise>(scene: &Scene, name: &str) {
    for (what, frame, same) in with_layers::<R>(scene) {
        assert!(same, "{name}: Sum and Record differ, {what}");
        let layers = frame.layers.as_ref().expect("layers were asked for");
        assert_layers_sum(layers, &frame.color, &format!("{name}, {what}"));
        let remainder = layers.planes.last().expect("a remainder layer");
        if what == "Phong" && scene.image.samples == 1 {
            let mut rest = remainder.data.iter().flatten();
            assert!(rest.all(|x| *x == R::ZERO), "{name}");
        }
    }
}

/// A light that takes light away: sums of both signs, in every shading and with several samples.
#[test]
fn layers_add_up_where_colours_are_negative() {
    for samples in [1, 4] {
        let mut scene = scene("lights", [96, 72], &[]);
        scene.image.samples = samples;
        scene.lights[1].source.diffuse = [-0.7, -0.3, -1.1];
        signed_layers_of::<f32>(&scene);
        signed_layers_of::<f64>(&scene);
    }
}

fn signed_layers_of<R: Precise>(scene: &Scene) {
    for (_, frame, _) in with_layers::<R>(scene) {
        assert_signed_sum(&frame);
    }
}

/// Bit for bit wherever the picture is larger than its remainder; else within the remainder's own rounding.
fn assert_signed_sum<R: Real>(frame: &Frame<R>) {
    let layers = frame.layers.as_ref().expect("layers were asked for");
    assert!(layers.signed);
    let rest = &layers.planes.last().expect("a remainder layer").data;
    let mut negative = 0;
    for (pixel, color) in frame.color.data.iter().enumerate() {
        let sum = layers.sum(pixel);
        for c in 0..3 {
            let (sum, color) = (sum[c].to_f64(), color[c].to_f64());
            let rest = rest[pixel][c].to_f64().abs();
            negative += u32::from(color < 0.0);
            let allowed = if rest < color.abs() {
                0.0
            } else {
                2.0 * R::ROUNDOFF.to_f64() * rest
            };
            assert!(
                (sum - color).abs() <= allowed,
                "pixel {pixel}, {c}: {sum} {color} {rest}"
            );
        }
    }
    assert!(negative > 100, "only {negative} values are negative");
}

/// Two modules that may not name each other list the causes; a reader must find the same ones in both.
#[test]
fn causes_are_explained_in_ladder_order() {
    assert_eq!(CAUSES, rastray::report::causes::CAUSES.map(|c| c.name));
}

#[test]
fn threads_and_instruction_sets_change_no_byte() {
    let sets = Isa::available().into_iter().map(|isa| (2, isa));
    let ways: Vec<(usize, Isa)> = sets.chain([(1, Isa::Scalar), (8, Isa::Scalar)]).collect();
    for (name, reference) in ladders() {
        let scene = scene(name, SIZE, &[]);
        for &(threads, isa) in &ways {
            let options = Options {
                isa,
                ..Options::default()
            };
            let ladder = in_threads(threads, || climb(&scene, &options));
            for (rung, (a, b)) in reference.rungs.iter().zip(&ladder.rungs).enumerate() {
                let set = isa.name();
                assert!(a == b, "{name}: rung {rung}, {threads} threads, {set}");
            }
        }
    }
}
