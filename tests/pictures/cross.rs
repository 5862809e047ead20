//! The rasterizer against the tracer, and both against themselves: the most valuable tests of the project.
//!
//! On every shipped scene: the causes sum to the total difference with residual 0; rungs 3 and 4 agree as the ladder
//! promises; layers add up to the pictures bit for bit; thread count and instruction set change no byte.

use rastray::decompose::CAUSES;
use rastray::frame::{Frame, Layers, Plane};
use rastray::gl::ShadeModel;
use rastray::import::shipped;
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

#[test]
fn causes_sum_to_the_total_on_every_shipped_scene() {
    for shipped in shipped() {
        let ladder = climb(&scene(shipped.name, [200, 150], &[]), &Options::default());
        assert_eq!(ladder.residual_max, 0.0, "{}", shipped.name);
        assert_eq!(ladder.limited_pixels, 0, "{}", shipped.name);
        assert_eq!(ladder.rungs.len(), CAUSES.len() + 1);
        let total: f64 = ladder.total().data.iter().flatten().map(|x| x.abs()).sum();
        assert!(
            total > 0.0,
            "{}: the two pictures are the same",
            shipped.name
        );
    }
}

#[test]
fn raster_and_cast_agree_on_every_shipped_scene() {
    for shipped in shipped() {
        let scene = scene(shipped.name, [320, 240], &[]);
        for precision in Precision::ALL {
            let agreement = climb(&scene, &options(precision)).agreement;
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

fn draw_raster<R: Precise>(scene: &Scene, options: &raster::Options) -> Frame<R> {
    let assembly = assembled::<R>(scene, None).expect("an assembly");
    let plan = rasterizer(scene, &assembly);
    rasterize(&plan, options).expect("a picture").0
}

fn draw_trace<R: Precise>(scene: &Scene, options: &trace::Options) -> Frame<R> {
    let assembly = assembled::<R>(scene, None).expect("an assembly");
    let plan = tracer(scene, &assembly, trace::Geometry::Exact).expect("a plan");
    follow(&plan, options).expect("a picture").0
}

#[test]
fn layers_add_up_bit_for_bit() {
    for shipped in shipped() {
        for samples in [1, 4] {
            let mut scene = scene(shipped.name, [96, 72], &[]);
            scene.image.samples = samples;
            layers_of::<f32>(&scene, shipped.name);
            layers_of::<f64>(&scene, shipped.name);
        }
    }
}

fn layers_of<R: Precise>(scene: &Scene, name: &str) {
    let isa = Isa::detect();
    for shading in [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong] {
        let options = raster::Options {
            shading,
            clamp: false,
            layers: true,
            isa,
        };
        let frame = draw_raster::<R>(scene, &options);
        let layers = frame.layers.as_ref().expect("layers were asked for");
        assert_layers_sum(layers, &frame.color, &format!("{name}, {shading:?}"));
        let without = draw_raster::<R>(
            scene,
            &raster::Options {
                layers: false,
                ..options
            },
        );
        assert_eq!(
            without.color, frame.color,
            "{name}: Sum and Record differ, {shading:?}"
        );
        let remainder = layers.planes.last().expect("a remainder layer");
        if shading == ShadeModel::Phong && scene.image.samples == 1 {
            assert!(
                remainder.data.iter().flatten().all(|x| *x == R::ZERO),
                "{name}"
            );
        }
    }
    let options = trace::Options {
        layers: true,
        ..trace::Options::of(scene, isa)
    };
    let frame = draw_trace::<R>(scene, &options);
    let layers = frame.layers.as_ref().expect("layers were asked for");
    assert_layers_sum(layers, &frame.color, &format!("{name}, traced"));
    let without = draw_trace::<R>(
        scene,
        &trace::Options {
            layers: false,
            ..options
        },
    );
    assert_eq!(
        without.color, frame.color,
        "{name}: Sum and Record differ, traced"
    );
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
    let isa = Isa::detect();
    for shading in [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong] {
        let options = raster::Options {
            shading,
            clamp: false,
            layers: true,
            isa,
        };
        assert_signed_sum(&draw_raster::<R>(scene, &options));
    }
    let options = trace::Options {
        layers: true,
        ..trace::Options::of(scene, isa)
    };
    assert_signed_sum(&draw_trace::<R>(scene, &options));
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
    for shipped in shipped() {
        let scene = scene(shipped.name, [128, 96], &[]);
        let on = |isa| Options {
            isa,
            ..Options::default()
        };
        let reference = in_threads(1, || climb(&scene, &on(Isa::Scalar))).rungs;
        for (threads, isa) in [(2, Isa::Scalar), (8, Isa::Scalar)]
            .into_iter()
            .chain(Isa::available().into_iter().map(|isa| (2, isa)))
        {
            let rungs = in_threads(threads, || climb(&scene, &on(isa))).rungs;
            for (rung, (a, b)) in reference.iter().zip(&rungs).enumerate() {
                let name = isa.name();
                assert!(
                    a == b,
                    "{}: rung {rung}, {threads} threads, {name}",
                    shipped.name
                );
            }
        }
    }
}
