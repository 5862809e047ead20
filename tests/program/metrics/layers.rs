//! `layers.exr` as other programs read it: names that they group into layers, and layers that add up to the picture.
//!
//! The same is asked of the reference implementation of OpenEXR by `tests/reference/layers.py`, which says how to run it.

use std::collections::BTreeMap;
use std::path::Path;

use exr::prelude::*;

use crate::common::program::rastray;

type Values = Vec<f32>;

/// All channels by name, and the comment.
fn channels(path: &Path) -> (BTreeMap<String, Values>, String) {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_file(path)
        .expect("an EXR file");
    assert_eq!(image.layer_data.len(), 1, "one part");
    let layer = &image.layer_data[0];
    let channel =
        |c: &AnyChannel<FlatSamples>| (c.name.to_string(), c.sample_data.values_as_f32().collect());
    let comments = layer
        .attributes
        .comments
        .as_ref()
        .expect("a comment")
        .to_string();
    (
        layer.channel_data.list.iter().map(channel).collect(),
        comments,
    )
}

#[test]
fn layers_are_named_as_other_programs_group_them_and_add_up() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let args = "compare whitted -q --size 48x36 --shading phong -o out";
    let args: Vec<&str> = args.split(' ').collect();
    assert!(rastray(folder.path(), &args).status.success());
    let (channels, comments) = channels(&out.join("layers.exr"));
    let own = order(&comments);
    let lights = ["ambient", "diffuse", "specular"];
    let expected = ["emission".to_owned(), "ambient".to_owned()]
        .into_iter()
        .chain(
            ["sun", "lamp"]
                .iter()
                .flat_map(|l| lights.map(|t| format!("{t}.{l}"))),
        )
        .chain(["reflection", "refraction", "remainder"].map(String::from));
    assert_eq!(own, expected.collect::<Vec<_>>());
    // NAME.R, NAME.G, NAME.B of each layer, of the rasterizer's too, and the picture's own.
    let mut names: Vec<String> = ["R", "G", "B"].map(String::from).to_vec();
    for name in &own {
        for prefix in ["", "raster."] {
            names.extend(["R", "G", "B"].map(|c| format!("{prefix}{name}.{c}")));
        }
    }
    names.sort();
    // What stands beside the sums is named so: light without shadows, and parts by light.
    let (beside, summed): (Vec<&String>, Vec<&String>) = channels
        .keys()
        .partition(|name| name.starts_with("unshadowed.") || name.starts_with("split."));
    assert_eq!(summed, names.iter().collect::<Vec<_>>());
    assert!(
        beside
            .iter()
            .any(|name| name.starts_with("split.reflection."))
    );
    assert!(
        beside
            .iter()
            .any(|name| name.starts_with("unshadowed.diffuse."))
    );
    // Plain f32 additions in the order that the file states: the picture, bit for bit.
    for c in ["R", "G", "B"] {
        let mut sum = vec![0.0f32; 48 * 36];
        for name in &own {
            for (s, v) in sum.iter_mut().zip(&channels[&format!("{name}.{c}")]) {
                *s += v;
            }
        }
        let bits = |values: &Values| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&sum), bits(&channels[c]), "{c}");
    }
    assert!(channels["reflection.R"].iter().any(|v| *v > 0.1));
}

/// The names of the layers in the order of their sum, from the comment.
fn order(comments: &str) -> Vec<String> {
    let (values, list) = comments.split_once("in this order:\n").expect("an order");
    for group in ["raster.*", "unshadowed.*", "split.*"] {
        assert!(values.contains(group), "{values}");
    }
    list.lines().map(str::to_owned).collect()
}
