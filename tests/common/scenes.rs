//! Scenes as most tests want them; `text` has those that a test writes itself.

use rastray::import::{LoadOptions, load};
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
