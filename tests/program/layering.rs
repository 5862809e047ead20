//! Layers point one way: the `use crate::` lines of `src/` against the table of layers.
//!
//! A module may use modules on lines above its own, modules inside itself, and nothing else. The table is the house's
//! plan; a new module needs a line here before it compiles into the tree.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Layer of each top-level module: an arrow may only go to a smaller number (or stay inside the module).
const LAYERS: &[(&str, u32)] = &[
    ("math", 0),
    ("lanes", 0),
    ("error", 0),
    ("gl", 1),
    ("frame", 2),
    ("sampling", 2),
    ("scene", 3),
    ("import", 4),
    ("lighting", 4),
    ("raster", 5),
    ("trace", 5),
    ("render", 6),
    ("decompose", 7),
    ("context", 7),
    ("peers", 7),
    ("explain", 8),
    ("trade", 8),
    ("check", 9),
    ("report", 10),
    ("cli", 11),
];

/// Modules of one layer that may use each other (the foundation knows one another; siblings above do not).
const FOUNDATION: u32 = 0;

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = std::fs::read_dir(folder)
        .expect("src is readable")
        .map(|entry| entry.expect("a readable entry").path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The module that a file belongs to: `src/scene/camera.rs` -> `scene`.
fn module_of(src: &Path, file: &Path) -> String {
    let relative = file.strip_prefix(src).expect("inside src");
    let first = relative.components().next().expect("not empty");
    let name = first.as_os_str().to_string_lossy();
    name.trim_end_matches(".rs").to_owned()
}

/// The text without its line comments.
fn without_comments(text: &str) -> String {
    let lines = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or(""));
    lines.collect::<Vec<_>>().join("\n")
}

/// Every module named after `crate::` and, in the binary, `rastray::`, with its line; groups in braces included.
fn arrows(text: &str) -> Vec<(usize, String)> {
    let code = without_comments(text);
    let mut found = Vec::new();
    for root in ["crate::", "rastray::"] {
        for (at, _) in code.match_indices(root) {
            let line = code[..at].matches('\n').count() + 1;
            let rest = &code[at + root.len()..];
            found.extend(first_names(rest).into_iter().map(|name| (line, name)));
        }
    }
    found
}

/// `scene::Scene` -> scene; `{gl, scene::{A, B}}` -> gl, scene.
fn first_names(rest: &str) -> Vec<String> {
    let word = |s: &str| {
        let letters = s.trim_start().chars();
        letters
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect::<String>()
    };
    let Some(group) = rest.strip_prefix('{') else {
        return vec![word(rest)];
    };
    let mut names = vec![word(group)];
    let mut depth = 0;
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => names.push(word(&group[at + 1..])),
            _ => {}
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

fn allowed(from: &str, to: &str, layers: &BTreeMap<&str, u32>) -> bool {
    match (layers.get(from), layers.get(to)) {
        (Some(a), Some(b)) => from == to || b < a || (*a == FOUNDATION && *b == FOUNDATION),
        _ => false,
    }
}

#[test]
fn arrows_go_up_only() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let layers: BTreeMap<&str, u32> = LAYERS.iter().copied().collect();
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let mut wrong = Vec::new();
    let mut seen = 0;
    for file in &files {
        let from = module_of(&src, file);
        if from == "lib" || from == "main" {
            continue; // lib declares the modules; main is the binary's first line, above everything
        }
        assert!(
            layers.contains_key(from.as_str()),
            "src/{from} is not in the table of layers"
        );
        let text = std::fs::read_to_string(file).expect("a readable source");
        for (line, to) in arrows(&text) {
            seen += 1;
            if !allowed(&from, &to, &layers) {
                wrong.push(format!("{}:{line}: {from} -> {to}", file.display()));
            }
        }
    }
    assert!(seen > 30, "only {seen} arrows found: the scan is broken");
    assert!(
        wrong.is_empty(),
        "arrows against the table of layers:\n{}",
        wrong.join("\n")
    );
}

/// Above `render` everything is plain: no module there is generic over the precision, so that renderers compile once.
#[test]
fn precision_ends_at_render() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let layers: BTreeMap<&str, u32> = LAYERS.iter().copied().collect();
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let above =
        |file: &&PathBuf| layers.get(module_of(&src, file).as_str()) > Some(&layers["render"]);
    let mut wrong = Vec::new();
    let mut seen = 0;
    for file in files.iter().filter(above) {
        let text = std::fs::read_to_string(file).expect("a readable source");
        seen += 1;
        let code = without_comments(&text);
        if [
            "R: Real",
            "lanes::Real",
            "raster::Plan",
            "trace::Plan",
            "Assembly<",
        ]
        .iter()
        .any(|name| code.contains(name))
        {
            wrong.push(file.display().to_string());
        }
    }
    assert!(
        seen > 100,
        "only {seen} files above render: the scan is broken"
    );
    assert!(
        wrong.is_empty(),
        "generic above render:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn the_scan_sees_what_it_should() {
    let names = |text| {
        arrows(text)
            .into_iter()
            .map(|(_, name)| name)
            .collect::<Vec<_>>()
    };
    assert_eq!(names("use crate::scene::Scene;"), ["scene"]);
    assert_eq!(
        names("use crate::{gl::{A, B},\n trace::Plan,\n};"),
        ["gl", "trace"]
    );
    assert_eq!(names("let x = rastray::cli::run();"), ["cli"]);
    assert_eq!(
        arrows("\n// crate::cli\nuse crate::gl;"),
        [(3, "gl".to_owned())]
    );
    let layers: BTreeMap<&str, u32> = LAYERS.iter().copied().collect();
    assert!(!allowed("raster", "trace", &layers));
    assert!(!allowed("lighting", "import", &layers));
    assert!(!allowed("scene", "raster", &layers));
    assert!(allowed("trace", "lighting", &layers));
    assert!(!allowed("trace", "nowhere", &layers));
}
