//! Scenes written in a test as the text of a scene file.

use rastray::error::Error;
use rastray::import::{Imported, LoadOptions, load};

/// Loads a text as a `.toml` file of its own.
pub(crate) fn import(text: &str) -> Result<Imported, Box<Error>> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).expect("written");
    let name = path.to_str().expect("a path in UTF-8");
    Ok(load(name, &LoadOptions::default())?)
}
