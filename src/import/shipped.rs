//! The scenes inside the program: those of `scenes/`, and the meshes that they use.

/// A shipped scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shipped {
    /// Its name on the command line: the file's stem.
    pub name: &'static str,
    /// Its folder in `scenes/`; empty for the scenes at its top.
    pub folder: &'static str,
    /// What it asks or shows: the first comment line.
    pub title: &'static str,
    /// The whole file, comments included.
    pub text: &'static str,
}

macro_rules! scene {
    ($name:literal) => {{
        const TEXT: &str = include_str!(concat!("../../scenes/", $name, ".toml"));
        Shipped {
            name: split($name).1,
            folder: split($name).0,
            title: title(TEXT),
            text: TEXT,
        }
    }};
}

macro_rules! file {
    ($name:literal) => {
        ($name, include_str!(concat!("../../scenes/", $name)))
    };
}

/// In the order in which they are worth looking at.
const SCENES: &[Shipped] = &[
    scene!("whitted"),
    scene!("highlight"),
    scene!("lights"),
    scene!("two-sided"),
    scene!("vase"),
];

/// Files that the scenes refer to.
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

/// Folder and stem of a path without its extension.
const fn split(path: &'static str) -> (&'static str, &'static str) {
    let bytes = path.as_bytes();
    let mut slash = bytes.len();
    while slash > 0 {
        slash -= 1;
        if bytes[slash] == b'/' {
            let (folder, stem) = path.split_at(slash);
            return (folder, stem.split_at(1).1);
        }
    }
    ("", path)
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
    use super::split;

    #[test]
    fn names_are_stems_and_folders_are_kept() {
        assert_eq!(split("whitted"), ("", "whitted"));
        assert_eq!(split("lecture/01-point"), ("lecture", "01-point"));
        assert_eq!(split("a/b/c"), ("a/b", "c"));
    }
}
