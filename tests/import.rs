//! Importers: shipped scenes, error messages with their places, OBJ features, overrides.

use rastray::import::{LoadOptions, load, shipped};

#[test]
fn shipped_scenes_load() {
    for scene in shipped() {
        let imported = load(scene.name, &LoadOptions::default()).unwrap();
        assert!(
            imported.notes.is_empty(),
            "{}: {:?}",
            scene.name,
            imported.notes
        );
        assert!(!imported.scene.objects.is_empty());
        assert!(scene.title.ends_with(['.', '?']), "{}", scene.title);
    }
}
