//! Plans follow the list: `required` and `full` make the same bytes, and the counters show what is left out.

use std::path::{Path, PathBuf};

use rastray::gl::{self, ShadeModel};
use rastray::import::{LoadOptions, load, shipped};
use rastray::lanes::{Isa, Real};
use rastray::math::color::Rgb;
use rastray::render::{Rasterizer, Tracer};
use rastray::scene::requirements::{Feature, Mode, Model, Requirements};
use rastray::scene::{LightSpace, Scene};
use rastray::{raster, trace};

use crate::common::precise::{Precise, assembled, follow, rasterize, rasterizer, tracer};

fn shipped_scene(name: &str, width: u32, height: u32) -> Scene {
    let imported = load(name, &LoadOptions::default()).expect("a shipped scene loads");
    resized(imported.scene, width, height)
}

fn resized(mut scene: Scene, width: u32, height: u32) -> Scene {
    (scene.image.width, scene.image.height) = (width, height);
    scene.image.samples = 1;
    scene
}

/// Bits of a picture and of all its layers, and the work.
struct Drawn {
    bits: Vec<u64>,
    work: Work,
}

#[derive(Clone, Copy)]
enum Work {
    Raster(raster::Counters),
    Trace(trace::Counters),
}

fn bits<R: Real>(frame: &rastray::frame::Frame<R>) -> Vec<u64> {
    let layers = frame.layers.iter().flat_map(|l| &l.planes);
    let planes = layers
        .chain([&frame.color])
        .flat_map(|p| p.data.iter().flatten());
    let numbers = planes.chain(&frame.depth.data);
    numbers.map(|x| x.to_f64().to_bits()).collect()
}

fn rasterized<R: Precise>(scene: &Scene, model: Model, shading: ShadeModel, layers: bool) -> Drawn {
    let assembly = assembled::<R>(scene, Some(16)).expect("assembled");
    let plan = Rasterizer::new(scene, &assembly, model);
    let (clamp, isa) = (true, Isa::detect());
    let options = raster::Options {
        shading,
        clamp,
        layers,
        isa,
    };
    let (frame, counters) = rasterize::<R>(&plan, &options).expect("drawn");
    Drawn {
        bits: bits(&frame),
        work: Work::Raster(counters),
    }
}

fn traced<R: Precise>(scene: &Scene, model: Model, layers: bool) -> Drawn {
    let assembly = assembled::<R>(scene, Some(16)).expect("assembled");
    let plan = Tracer::new(scene, &assembly, trace::Geometry::Exact, model).expect("planned");
    let options = trace::Options {
        layers,
        ..trace::Options::of(scene, Isa::detect())
    };
    let (frame, counters) = follow::<R>(&plan, &options).expect("traced");
    Drawn {
        bits: bits(&frame),
        work: Work::Trace(counters),
    }
}

/// Every picture of a scene under both models.
fn identical<R: Precise>(scene: &Scene, layers: bool) {
    for shading in [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong] {
        let [a, b] =
            [Model::Required, Model::Full].map(|m| rasterized::<R>(scene, m, shading, layers));
        assert!(a.bits == b.bits, "{}: {shading:?}", scene.name);
        a.work.at_most(&b.work);
    }
    let [a, b] = [Model::Required, Model::Full].map(|m| traced::<R>(scene, m, layers));
    assert!(a.bits == b.bits, "{}: traced", scene.name);
    a.work.at_most(&b.work);
}

impl Work {
    fn lighting(&self) -> rastray::lighting::Counters {
        match self {
            Self::Raster(c) => c.lighting,
            Self::Trace(c) => c.lighting,
        }
    }

    fn normalizations(&self) -> u64 {
        match self {
            Self::Raster(c) => c.normalizations,
            Self::Trace(c) => c.normalizations,
        }
    }

    /// What is required is never more work than everything.
    fn at_most(&self, full: &Self) {
        let (a, b) = (self.lighting(), full.lighting());
        assert_eq!(a.points, b.points);
        let pairs = [
            (a.light_evaluations, b.light_evaluations),
            (a.light_vector_roots, b.light_vector_roots),
            (a.attenuations, b.attenuations),
            (a.spot_tests, b.spot_tests),
            (a.half_vectors, b.half_vectors),
            (a.pow_calls, b.pow_calls),
            (a.spot_pow_calls, b.spot_pow_calls),
            (self.normalizations(), full.normalizations()),
        ];
        for (less, more) in pairs {
            assert!(less <= more, "{a:?} {b:?}");
        }
    }
}

#[test]
fn required_and_full_are_the_same_bytes_on_every_shipped_scene() {
    for (i, shipped) in shipped().iter().enumerate() {
        let scene = shipped_scene(shipped.name, 40, 30);
        identical::<f32>(&scene, i % 4 == 0);
    }
    for name in ["whitted", "lights", "two-sided"] {
        identical::<f64>(&shipped_scene(name, 40, 30), true);
    }
}

/// Every file of a folder, sorted.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).expect("a readable folder");
    let mut paths: Vec<_> = entries.map(|e| e.expect("an entry").path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

#[test]
fn required_and_full_are_the_same_bytes_on_every_shared_scene() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    if !folder.is_dir() {
        println!("skipped: no {}", folder.display());
        return;
    }
    let mut paths = Vec::new();
    files(&folder, &mut paths);
    let (mut drawn, mut not_read) = (0, 0);
    for path in &paths {
        let Ok(imported) = load(&path.to_string_lossy(), &LoadOptions::default()) else {
            not_read += 1;
            continue;
        };
        let scene = resized(imported.scene, 32, 24);
        identical::<f32>(&scene, false);
        drawn += 1;
    }
    println!("{drawn} scenes, required = full; {not_read} files are no scenes that import");
    assert!(drawn > 0);
}

/// The same scene with other colours, everywhere.
fn recolored(mut scene: Scene, change: impl Fn(&mut gl::Material)) -> Scene {
    for material in &mut scene.materials {
        change(&mut material.front);
        material.back.iter_mut().for_each(&change);
    }
    scene
}

/// Work of per-fragment rasterizing and of tracing.
fn both(scene: &Scene) -> [Work; 2] {
    let raster = rasterized::<f32>(scene, Model::Required, ShadeModel::Phong, false);
    [
        raster.work,
        traced::<f32>(scene, Model::Required, false).work,
    ]
}

const BLACK: Rgb = [0.0; 3];

#[test]
fn a_scene_without_specular_makes_no_pow_calls() {
    let shiny = shipped_scene("highlight", 40, 30);
    assert!(
        both(&shiny)
            .iter()
            .all(|w| w.lighting().pow_calls > 0 && w.lighting().half_vectors > 0)
    );
    let matte = recolored(shiny, |m| m.specular = BLACK);
    for work in both(&matte) {
        let lighting = work.lighting();
        assert!(lighting.light_evaluations > 0);
        assert_eq!((lighting.pow_calls, lighting.half_vectors), (0, 0));
        // The falloff of the spot light is a power of its own, and a feature of its own.
        assert_eq!(lighting.spot_pow_calls, lighting.spot_tests);
    }
}

#[test]
fn an_opaque_scene_casts_no_refraction_rays() {
    let mut scene = shipped_scene("whitted", 40, 30);
    let rays = |scene: &Scene| match traced::<f32>(scene, Model::Full, false).work {
        Work::Trace(counters) => counters.rays,
        Work::Raster(_) => unreachable!("traced"),
    };
    assert!(rays(&scene).refraction > 0 && rays(&scene).reflection > 0);
    for material in &mut scene.materials {
        material.optics.transmission = BLACK;
    }
    assert_eq!(rays(&scene).refraction, 0);
    for material in &mut scene.materials {
        material.optics.reflection = BLACK;
    }
    let rays = rays(&scene);
    assert_eq!(
        (rays.reflection, rays.refraction, rays.primary),
        (0, 0, 1200)
    );
}

#[test]
fn directional_lights_take_no_square_roots() {
    let mut scene = shipped_scene("lights", 40, 30);
    let lit = both(&scene);
    assert!(
        lit.iter()
            .all(|w| w.lighting().light_vector_roots > 0 && w.lighting().attenuations > 0)
    );
    assert!(lit.iter().any(|w| w.lighting().spot_tests > 0));
    for light in &mut scene.lights {
        (light.source.position, light.space) = ([1.0, 2.0, 3.0, 0.0], LightSpace::World);
    }
    for work in both(&scene) {
        let lighting = work.lighting();
        assert!(lighting.light_evaluations > 0);
        let positional = [
            lighting.light_vector_roots,
            lighting.attenuations,
            lighting.spot_tests,
            lighting.spot_pow_calls,
        ];
        assert_eq!(positional, [0; 4]);
    }
}

/// Exact numbers: every fragment is lit once, by every light of the scene, each of one kind.
#[test]
fn counters_are_points_times_lights() {
    let scene = shipped_scene("two-sided", 40, 30);
    let Drawn { work, .. } = rasterized::<f32>(&scene, Model::Required, ShadeModel::Phong, false);
    let Work::Raster(counters) = work else {
        unreachable!("rasterized")
    };
    let (points, lighting) = (counters.points_shaded, counters.lighting);
    assert!(points > 300);
    assert_eq!(
        (lighting.points, lighting.light_evaluations),
        (points, 2 * points)
    );
    // One light has a position and no falloff; the other is far away.
    assert_eq!(
        (lighting.light_vector_roots, lighting.attenuations),
        (points, 0)
    );
    assert_eq!(lighting.visibility_queries, 0);
    // Only the sheet is shiny; a highlight is asked for where its light faces the point.
    assert!(lighting.pow_calls > 0 && lighting.pow_calls < points);
    assert_eq!(lighting.half_vectors, lighting.pow_calls);
    // A normal and a direction to the viewer each.
    assert_eq!(counters.normalizations, 2 * points);
}

#[test]
fn features_off_cost_nothing() {
    let scene = shipped_scene("two-sided", 40, 30);
    // An infinite viewer needs no direction.
    let mut infinite = scene.clone();
    infinite.light_model.local_viewer = false;
    // Without light, neither normals nor directions are asked for; the lights are dead.
    let dark = recolored(scene.clone(), |m| {
        (m.ambient, m.diffuse, m.specular) = (BLACK, BLACK, BLACK)
    });
    assert_eq!(
        Requirements::of(&dark, Mode::Trace).live_lights,
        [false, false]
    );
    let [before, per_normal, nothing] = [&scene, &infinite, &dark].map(both);
    for i in 0..2 {
        let points = before[i].lighting().points;
        assert_eq!(before[i].normalizations(), 2 * points);
        assert_eq!(per_normal[i].normalizations(), points);
        assert_eq!(
            (
                nothing[i].normalizations(),
                nothing[i].lighting().light_evaluations
            ),
            (0, 0)
        );
    }
}

/// The counters do not depend on vectors or threads.
#[test]
fn counters_do_not_depend_on_the_instruction_set() {
    let scene = shipped_scene("lights", 40, 30);
    let assembly = assembled::<f32>(&scene, Some(16)).expect("assembled");
    let raster = rasterizer(&scene, &assembly);
    let trace = tracer(&scene, &assembly, trace::Geometry::Exact).expect("planned");
    let count = |isa| {
        let (shading, clamp, layers) = (ShadeModel::Phong, false, false);
        let options = raster::Options {
            shading,
            clamp,
            layers,
            isa,
        };
        let drawn = rasterize::<f32>(&raster, &options).expect("drawn");
        let traced = follow::<f32>(&trace, &trace::Options::of(&scene, isa));
        (drawn.1, traced.expect("traced").1)
    };
    let expected = count(Isa::Scalar);
    assert!(Requirements::of(&scene, Mode::Trace).has(Feature::SpotPow));
    for isa in Isa::available() {
        assert_eq!(count(isa), expected, "{isa:?}");
    }
}
