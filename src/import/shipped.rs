//! The scenes inside the program: those of `scenes/` and its folders, and the meshes that they use.
//!
//! The list is written out, so that the order is one worth browsing; a test holds it against the folders.

/// A shipped scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shipped {
    /// Its name on the command line: the file's stem.
    pub name: &'static str,
    /// The folder of `scenes/` that it lies in, which is its topic; empty for those at the top.
    pub folder: &'static str,
    /// What it asks or shows: the first comment line.
    pub title: &'static str,
    /// The whole file, comments included.
    pub text: &'static str,
}

/// Folder by folder, the names of its scenes. The folder is what stands before the name in a path: "" or "lecture/".
macro_rules! scenes {
    ($($folder:literal: [$($name:literal),* $(,)?]),* $(,)?) => {
        &[$($({
            const TEXT: &str = include_str!(concat!("../../scenes/", $folder, $name, ".toml"));
            Shipped {
                name: $name,
                folder: without_slash($folder),
                title: title(TEXT),
                text: TEXT,
            }
        }),*),*]
    };
}

macro_rules! file {
    ($name:literal) => {
        ($name, include_str!(concat!("../../scenes/", $name)))
    };
}

/// In the order in which they are worth looking at: one of each kind, the lecture from its beginning, single questions.
const SCENES: &[Shipped] = scenes! {
    "": ["whitted", "highlight", "lights", "two-sided", "vase"],
    "lecture/": [
        "01-point-light",
        "02-falloff",
        "03-directional-light",
        "04-spot-cutoff",
        "05-spot-exponent",
        "06-peakiness",
        "07-diffuse",
        "08-specular",
        "09-emission",
        "10-ambient",
        "11-sum",
        "12-eight-lights",
        "13-ray-casting",
        "14-shadow",
        "15-mirror",
        "16-transparency",
        "17-refraction",
        "18-total-reflection",
        "19-ray-tree",
        "20-whitted-picture",
    ],
    "study/": [
        "gl-materials",
        "gouraud-phong",
        "teapot",
        "highlight-half-vector",
        "highlight-reflection",
        "box-room",
        "facing-mirrors",
        "glass-slab",
        "instances",
        "revolution",
        "vertex-colours",
    ],
};

/// Files that the scenes refer to, relative to them.
const FILES: &[(&str, &str)] = &[file!("vase.obj"), file!("vase.mtl")];

/// The shipped scenes.
pub fn shipped() -> &'static [Shipped] {
    SCENES
}

/// The text of a file that a shipped scene refers to.
pub(crate) fn file(name: &str) -> Option<&'static str> {
    let found = FILES.iter().find(|(n, _)| *n == name);
    found.map(|(_, text)| *text)
}

/// A folder's name without the slash behind it.
const fn without_slash(folder: &'static str) -> &'static str {
    match folder.len() {
        0 => folder,
        n => folder.split_at(n - 1).0,
    }
}

/// The first line, without its `#`.
const fn title(text: &'static str) -> &'static str {
    let bytes = text.as_bytes();
    let mut start = 0;
    while start < bytes.len() && (bytes[start] == b'#' || bytes[start] == b' ') {
        start += 1;
    }
    let mut end = start;
    while end < bytes.len() && bytes[end] != b'\n' && bytes[end] != b'\r' {
        end += 1;
    }
    let (line, _) = text.split_at(end);
    let (_, line) = line.split_at(start);
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::{Path, PathBuf};

    /// The folder of the scenes.
    fn root() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
    }

    /// Every file under a folder, as a path relative to it, with slashes.
    fn files_under(folder: &Path, before: &str, found: &mut BTreeSet<String>) {
        for entry in std::fs::read_dir(folder).expect("a folder of scenes") {
            let path = entry.expect("an entry").path();
            let name = path
                .file_name()
                .and_then(|n| n.to_str())
                .expect("a name in UTF-8");
            if path.is_dir() {
                files_under(&path, &format!("{before}{name}/"), found);
            } else {
                found.insert(format!("{before}{name}"));
            }
        }
    }

    #[test]
    fn every_file_of_the_folder_is_embedded_as_it_is() {
        let mut there = BTreeSet::new();
        files_under(&root(), "", &mut there);
        let mut embedded = BTreeSet::new();
        for scene in SCENES {
            let Shipped { name, folder, .. } = scene;
            let slash = if folder.is_empty() { "" } else { "/" };
            let path = format!("{folder}{slash}{name}.toml");
            let text = std::fs::read_to_string(root().join(&path)).expect("the scene's file");
            assert_eq!(text, scene.text, "{path}");
            embedded.insert(path);
        }
        embedded.extend(FILES.iter().map(|(name, _)| (*name).to_owned()));
        assert_eq!(
            there, embedded,
            "files of scenes/, and those in the table above"
        );
    }

    #[test]
    fn names_are_unique_and_easily_typed() {
        let names: BTreeSet<_> = SCENES.iter().map(|scene| scene.name).collect();
        assert_eq!(names.len(), SCENES.len());
        for scene in SCENES {
            let typed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            assert!(scene.name.chars().all(typed), "{}", scene.name);
        }
    }

    #[test]
    fn the_lecture_is_in_its_order_and_each_scene_asks_one_question() {
        let lecture: Vec<_> = SCENES.iter().filter(|s| s.folder == "lecture").collect();
        assert!(!lecture.is_empty());
        for (index, scene) in lecture.iter().enumerate() {
            let number = format!("{:02}-", index + 1);
            assert!(
                scene.name.starts_with(&number),
                "{} is not {number}",
                scene.name
            );
        }
        for scene in SCENES {
            assert_eq!(
                scene.title.matches('?').count(),
                1,
                "{}: {}",
                scene.name,
                scene.title
            );
            let lines: Vec<_> = scene
                .text
                .lines()
                .take_while(|l| l.starts_with('#'))
                .collect();
            assert!(
                lines.len() >= 3 && lines[1] == "#",
                "{} says what to look for",
                scene.name
            );
        }
    }
}
