//! Scenes as tests want them, and their ladders.

use rastray::decompose::{Ladder, decompose};
use rastray::import::{LoadOptions, load};
use rastray::render::{Options, Precision};
use rastray::scene::Scene;

/// A shipped scene, or one of a file, with overrides, at a size.
pub(crate) fn scene(name: &str, size: [u32; 2], sets: &[&str]) -> Scene {
    let options = LoadOptions {
        sets: sets.iter().map(|s| (*s).to_owned()).collect(),
        ..LoadOptions::default()
    };
    let mut imported = load(name, &options).expect("a shipped scene loads");
    imported.resize(size[0], size[1]);
    imported.scene
}

/// The default options in a precision.
pub(crate) fn options(precision: Precision) -> Options {
    Options {
        precision,
        ..Options::default()
    }
}

/// The ladder of a scene.
pub(crate) fn climb(scene: &Scene, options: &Options) -> Ladder {
    decompose(scene, options, &|_| {}).expect("a scene that renders")
}
