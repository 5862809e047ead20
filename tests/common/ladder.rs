//! Ladders of scenes.

use rastray::decompose::{Ladder, decompose};
use rastray::render::{Options, Precision};
use rastray::scene::Scene;

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
