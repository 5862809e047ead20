//! Random scenes, and random damage to scene files, through both renderers: what must hold whatever the scene.
//!
//! Shapes of all kinds, turned, stretched, mirrored, nearly flat or nearly nothing, sharing planes, nested and touching glass,
//! instances; lights, materials and cameras of all kinds; up to eight generations of rays. Whatever comes:
//! no panic; nothing infinite or not a number in any layer; layers add up to the picture; the causes of the ladder add up to
//! the total; no byte depends on threads, instruction set or the features left out, nor, in f64, on the scene's scale; both
//! renderers agree where they must; an error is a proper one.
//!
//! The default run is short and repeats. A long one, about a quarter of an hour of CPU time, with scenes of its own:
//! `PROPTEST_CASES=4000 PROPTEST_RNG_SEED=1 cargo test --test pictures fuzz::`. A failing scene is printed as it is after shrinking.

mod damage;
mod found;
mod laws;
mod scenes;

use proptest::prelude::ProptestConfig;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{RngSeed, TestRunner};
use rastray::lanes::Isa;
use rastray::trace::{Geometry, Options};

use crate::common::precise::{assembled, follow, tracer};

/// Few cases and a fixed seed, unless the environment asks for others.
fn config(cases: u32) -> ProptestConfig {
    let mut config = ProptestConfig {
        failure_persistence: None,
        max_shrink_iters: 400,
        ..ProptestConfig::default()
    };
    let is_asked = |name: &str| std::env::var_os(name).is_some();
    if !is_asked("PROPTEST_CASES") {
        config.cases = cases;
    }
    if !is_asked("PROPTEST_RNG_SEED") {
        config.rng_seed = RngSeed::Fixed(1980);
    }
    config
}

proptest::proptest! {
    #![proptest_config(config(150))]

    #[test]
    fn random_scenes_obey_the_laws(scene in scenes::scene()) {
        laws::hold(&scene)?;
    }
}

/// The laws are tried on something: most scenes are seen, and rays of every kind are cast in many.
#[test]
fn random_scenes_are_worth_looking_at() {
    let mut runner = TestRunner::deterministic();
    let mut counts = [0; 5];
    for _ in 0..200 {
        let scene = scenes::scene()
            .new_tree(&mut runner)
            .expect("a scene")
            .current();
        let assembly = assembled::<f64>(&scene, Some(8)).expect("small");
        let plan = tracer(&scene, &assembly, Geometry::Exact).expect("a plan");
        let Ok((frame, counters)) = follow::<f64>(&plan, &Options::of(&scene, Isa::Scalar)) else {
            continue;
        };
        let rays = counters.rays;
        let seen = frame
            .object
            .data
            .iter()
            .filter(|o| **o != rastray::frame::NONE);
        let found = [
            seen.count() > 10,
            rays.shadow > 10,
            rays.reflection > 10,
            rays.refraction > 10,
            rays.refraction > 300,
        ];
        for (count, found) in counts.iter_mut().zip(found) {
            *count += u32::from(found);
        }
    }
    println!("of 200 scenes: seen, shadow, reflection, refraction, many refractions: {counts:?}");
    assert!(counts[0] > 120 && counts[1] > 80, "{counts:?}");
    assert!(
        counts[2] > 60 && counts[3] > 60 && counts[4] > 10,
        "{counts:?}"
    );
}
