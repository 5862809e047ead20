//! `probe lighting-bench ROW TIMES`: the lighting of 4096 points, over and over, for counting instructions.
//!
//! A row is a set of features of the numerics guide, section 7. What a renderer does for each point is done here, too: the
//! direction to the viewer, where the features ask for it, then the equation in a sum, at AVX2 (instruction counters know no
//! AVX-512). All points face the light and lie in its cone. Two runs of different length, subtracted, leave what a point
//! costs:
//!
//! ```text
//! valgrind --tool=cachegrind --cache-sim=no --cachegrind-out-file=/dev/null probe lighting-bench all 100
//! valgrind --tool=cachegrind --cache-sim=no --cachegrind-out-file=/dev/null probe lighting-bench all 300
//! ```
//!
//! (I refs of the second - of the first) / (200 * 4096) = instructions a point.

use rastray::gl;
use rastray::lanes::{Isa, Real};
use rastray::lighting::{Points, Rig, Sink, shade, to_viewer};
use rastray::math::DAffine3;
use rastray::scene::requirements::{Feature, Mode, Requirements};
use rastray::scene::{Geometry, Light, LightSpace, Material, Object, Optics, Scene, Shape};

use super::Failure;

/// Points of one call.
const POINTS: usize = 4096;

/// The rows of the table and what they change of the first one.
const ROWS: &[(&str, &[Change])] = &[
    ("all", &[]),
    ("no-spot", &[Change::NoSpot]),
    ("infinite-viewer", &[Change::InfiniteViewer]),
    ("directional", &[Change::Directional]),
    ("no-specular", &[Change::NoSpecular]),
    (
        "specular-directional-infinite",
        &[Change::Directional, Change::InfiniteViewer],
    ),
    (
        "diffuse-directional",
        &[
            Change::Directional,
            Change::InfiniteViewer,
            Change::NoSpecular,
            Change::DiffuseOnly,
        ],
    ),
    ("all-f64", &[]),
];

#[derive(Clone, Copy)]
enum Change {
    NoSpot,
    InfiniteViewer,
    Directional,
    NoSpecular,
    DiffuseOnly,
}

/// Runs a row; the sum of all colours, so that the work cannot be left out.
pub(super) fn run(row: &str, times: &str) -> Result<f64, Failure> {
    let times: u32 = times.parse()?;
    let names = || {
        ROWS.iter()
            .map(|(name, _)| *name)
            .collect::<Vec<_>>()
            .join(", ")
    };
    let found = ROWS.iter().find(|(name, _)| *name == row);
    let (_, changes) = found.ok_or_else(|| format!("no row {row:?}; there are {}", names()))?;
    let scene = scene(changes);
    Ok(if row.ends_with("f64") {
        repeat::<f64>(&scene, times)
    } else {
        repeat::<f32>(&scene, times)
    })
}

/// A white light before a shiny surface, with every feature of the equation but what the changes take away.
fn scene(changes: &[Change]) -> Scene {
    let mut scene = Scene::default();
    let mut front = gl::Material {
        emission: [0.1; 3],
        specular: [0.5; 3],
        shininess: 32.0,
        ..gl::Material::default()
    };
    let mut source = gl::LightSource {
        position: [1.0, 2.0, 3.0, 1.0],
        ambient: [0.1; 3],
        attenuation: [1.0, 0.1, 0.01],
        spot_direction: [-0.2, -0.4, -1.6],
        spot_cutoff_deg: 60.0,
        spot_exponent: 8.0,
        ..gl::LightSource::default()
    };
    for change in changes {
        match change {
            Change::NoSpot => source.spot_cutoff_deg = 180.0,
            Change::InfiniteViewer => scene.light_model.local_viewer = false,
            Change::Directional => {
                (source.position[3], source.spot_cutoff_deg) = (0.0, 180.0);
            }
            Change::NoSpecular => front.specular = [0.0; 3],
            Change::DiffuseOnly => {
                (front.emission, front.ambient) = ([0.0; 3], [0.0; 3]);
            }
        }
    }
    scene.materials.push(Material {
        name: "m".into(),
        front,
        back: None,
        optics: Optics::default(),
    });
    let (center, radius) = (Default::default(), 1.0);
    scene.objects.push(Object {
        name: "o".into(),
        geometry: Geometry::Shape(Shape::Sphere { center, radius }),
        materials: vec![0],
        world_from_object: DAffine3::IDENTITY,
        tessellation: None,
        priority: 0,
    });
    let (name, space, enabled) = ("l".into(), LightSpace::Eye, true);
    scene.lights.push(Light {
        name,
        source,
        space,
        enabled,
    });
    scene
}

fn repeat<R: Real>(scene: &Scene, times: u32) -> f64 {
    let needs = Requirements::of(scene, Mode::Raster);
    let rig = Rig::<R>::planned(&scene.lights_eye(), &scene.light_model, &needs);
    let viewers = needs.has(Feature::ViewVector);
    let real = |v: [f64; 3]| v.map(R::from_f64);
    let mut points = Points::default();
    for i in 0..POINTS {
        let (x, y) = ((i % 64) as f64 / 64.0, (i / 64) as f64 / 64.0);
        points.push(
            real([x, y, -4.0]),
            real([0.0, 0.6, 0.8]),
            real([0.0, 0.0, 1.0]),
        );
    }
    let mut sum = [Vec::new(), Vec::new(), Vec::new()];
    let mut total = 0.0;
    for _ in 0..times {
        if viewers {
            for i in 0..POINTS {
                let position = [0, 1, 2].map(|axis: usize| points.position[axis][i]);
                let viewer = to_viewer(position, true);
                for (list, v) in points.to_viewer.iter_mut().zip(viewer) {
                    list[i] = v;
                }
            }
        }
        let material = &scene.materials[0].front;
        let sink = Sink::Sum(&mut sum);
        shade(Isa::Avx2, &rig, material, &points, None, false, sink);
        total += sum[0][POINTS / 2].to_f64();
    }
    total
}
