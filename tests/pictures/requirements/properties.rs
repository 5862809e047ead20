//! What a list of requirements may depend on, over random scenes: more lights and materials never need less, order does
//! not matter, and what cannot be seen asks for nothing.

use std::collections::BTreeSet;

use proptest::prelude::*;
use rastray::scene::Scene;
use rastray::scene::requirements::{Feature, Mode, Requirements};
use serde_json::{Value, json};

use crate::common::descriptor;

/// A colour with a good chance of zeros.
fn color() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![
        Just([0.0; 3]),
        Just([0.5, 0.0, 0.25]),
        Just([0.0, 1.0, 0.0])
    ]
}

fn light() -> impl Strategy<Value = Value> {
    let place = prop_oneof![Just([1.0, 2.0, 3.0, 1.0]), Just([1.0, 2.0, 3.0, 0.0])];
    let falloff = prop_oneof![
        Just([1.0, 0.0, 0.0]),
        Just([1.0, 0.1, 0.0]),
        Just([0.5, 0.0, 0.0])
    ];
    let cone = prop_oneof![Just((180.0, 0.0)), Just((30.0, 0.0)), Just((30.0, 4.0))];
    let colors = (color(), color(), color());
    (any::<bool>(), place, colors, falloff, cone).prop_map(
        |(on, pos, (ambient, diffuse, specular), [kc, kl, kq], (cutoff, exponent))| {
            json!({"on": on, "pos": pos, "ambient": ambient, "diffuse": diffuse, "specular": specular,
                "kc": kc, "kl": kl, "kq": kq, "spot_cutoff": cutoff, "spot_exp": exponent})
        },
    )
}

fn material() -> impl Strategy<Value = Value> {
    let shininess = prop_oneof![Just(0.0), Just(1.0), Just(8.0)];
    let optics = prop_oneof![
        Just((0.0, 0.0, 1.0)),
        Just((0.4, 0.0, 1.0)),
        Just((0.0, 0.7, 1.0)),
        Just((0.0, 0.7, 1.5))
    ];
    (any::<bool>(), (color(), color(), color(), color()), shininess, optics).prop_map(
        |(used, (emission, ambient, diffuse, specular), shininess, (mirror, transmit, ior))| {
            json!({"used": used, "emission": emission, "ambient": ambient, "diffuse": diffuse,
                "specular": specular, "shininess": shininess, "mirror": mirror, "transmit": transmit,
                "ior": ior, "texture": false})
        },
    )
}

fn descriptor() -> impl Strategy<Value = Value> {
    let flags = any::<[bool; 6]>();
    let lists = (
        prop::collection::vec(light(), 0..4),
        prop::collection::vec(material(), 0..4),
    );
    (flags, lists, color(), 0u32..3).prop_map(
        |([trace, local, two, cull, back, normalize], (lights, materials), ambient, depth)| {
            json!({"mode": if trace { "trace" } else { "raster" }, "lighting": true, "local_viewer": local,
                "two_side": two, "cull_back": cull, "back_material": back, "normalize": normalize,
                "normals_unit": false, "shadows": true, "max_depth": depth, "scene_ambient": ambient,
                "lights": lights, "materials": materials})
        },
    )
}

fn mode(v: &Value) -> Mode {
    if v["mode"] == "trace" {
        Mode::Trace
    } else {
        Mode::Raster
    }
}

fn scene(v: &Value) -> Scene {
    descriptor::scene(v, mode(v)).expect("a descriptor")
}

fn features(scene: &Scene, mode: Mode) -> BTreeSet<Feature> {
    Requirements::of(scene, mode)
        .iter()
        .map(|(f, _)| f)
        .collect()
}

proptest! {
    #[test]
    fn more_never_needs_less(v in descriptor(), more in (light(), material())) {
        let before = features(&scene(&v), mode(&v));
        for (key, one) in [("lights", more.0), ("materials", more.1)] {
            let mut larger = v.clone();
            larger[key].as_array_mut().expect("a list").push(one);
            let after = features(&scene(&larger), mode(&v));
            prop_assert!(before.is_subset(&after), "{key}: {before:?} {after:?}");
        }
    }

    #[test]
    fn order_does_not_matter(v in descriptor()) {
        let mut turned = v.clone();
        for key in ["lights", "materials"] {
            turned[key].as_array_mut().expect("a list").reverse();
        }
        prop_assert_eq!(features(&scene(&v), mode(&v)), features(&scene(&turned), mode(&v)));
    }

    #[test]
    fn what_cannot_be_seen_asks_for_nothing(v in descriptor()) {
        let mut scene = scene(&v);
        let needs = Requirements::of(&scene, mode(&v));
        let before = features(&scene, mode(&v));
        // Dead lights go, in the order of the enabled ones; lights that are off go, too.
        let mut live = needs.live_lights.iter();
        scene.lights.retain(|light| light.enabled && *live.next().expect("one each"));
        prop_assert_eq!(&before, &features(&scene, mode(&v)));
        // A material that no object shows is as good as gone.
        for (index, material) in scene.materials.iter_mut().enumerate() {
            if !scene.objects.iter().any(|o| o.materials.contains(&index)) {
                (material.front, material.back) = (Default::default(), None);
                material.optics = Default::default();
            }
        }
        prop_assert_eq!(before, features(&scene, mode(&v)));
    }
}
