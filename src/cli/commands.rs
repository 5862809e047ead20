//! The small commands: scenes, schema, completions; and what all commands print and load with.

use std::io::Write;

use rastray::error::Error;
use rastray::import::{self, Shipped};
use rastray::report::lines::wrap;
use rastray::report::origin;
use serde_json::json;

use super::args::{CompletionsArgs, SceneArgs, ScenesArgs};
use super::diagnostic;
use super::options::Verbosity;

/// Imports the scene with further overrides, and says its notes.
pub(super) fn load(
    args: &SceneArgs,
    more: &[String],
    verbosity: Verbosity,
) -> Result<import::Imported, Error> {
    let options = import::LoadOptions {
        sets: [&args.sets[..], more].concat(),
        strict_gl: args.strict_gl,
    };
    let imported = import::load(&args.scene, &options)?;
    if verbosity != Verbosity::Quiet {
        imported.notes.iter().for_each(diagnostic::note);
    }
    Ok(imported)
}

/// The words behind the program's name; what is no Unicode in them has marks in its place.
pub(super) fn words() -> Vec<String> {
    let words = std::env::args_os().skip(1);
    words
        .map(|word| word.to_string_lossy().into_owned())
        .collect()
}

/// The command line as it could be typed again.
pub(super) fn command_line() -> String {
    origin::command(words())
}

/// Writes text to standard output; a closed pipe is not an error.
pub(crate) fn print(text: &str) -> Result<(), Error> {
    let mut out = anstream::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    match written {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Error::io("standard output", "write", e))
        }
        _ => Ok(()),
    }
}

/// Prints a JSON value, indented.
pub(crate) fn print_json(value: &serde_json::Value) -> Result<(), Error> {
    print(&format!("{value:#}\n"))
}

pub(crate) fn scenes(args: &ScenesArgs) -> Result<(), Error> {
    let shipped = import::shipped();
    if let Some(name) = &args.name {
        return print(import::shipped_text(name)?);
    }
    if args.json {
        let list = shipped
            .iter()
            .map(|s| json!({"name": s.name, "folder": s.folder, "title": s.title}));
        return print_json(&serde_json::Value::Array(list.collect()));
    }
    let mut text = scene_list(shipped, diagnostic::width(std::io::stdout()));
    text += "\nrastray compare NAME   both pictures and every difference\n";
    text += "rastray scenes NAME    print the scene, to start one's own from\n";
    print(&text)
}

/// Names and titles in columns of a terminal's `columns`, a heading above the scenes of each folder.
fn scene_list(shipped: &[Shipped], columns: Option<usize>) -> String {
    let width = shipped.iter().map(|s| s.name.len()).max().unwrap_or(0);
    let mut folders: Vec<&str> = Vec::new();
    for scene in shipped {
        if !folders.contains(&scene.folder) {
            folders.push(scene.folder);
        }
    }
    let mut text = String::new();
    for folder in folders {
        let indent = if folder.is_empty() { "" } else { "  " };
        if !folder.is_empty() {
            text += &format!("{}{folder}\n", if text.is_empty() { "" } else { "\n" });
        }
        for scene in shipped.iter().filter(|s| s.folder == folder) {
            let column = indent.len() + width + 2;
            let title = wrap(scene.title, columns, column);
            let title = title.replace('\n', &format!("\n{:column$}", ""));
            text += &format!("{indent}{:width$}  {title}\n", scene.name);
        }
    }
    text
}

pub(super) fn completions(args: &CompletionsArgs, mut command: clap::Command) -> Result<(), Error> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "rastray", &mut script);
    print(&String::from_utf8_lossy(&script))
}

pub(crate) fn schema() -> Result<(), Error> {
    print(&import::schema())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_has_columns_and_folders() {
        let scene = |folder, name, title| Shipped {
            name,
            folder,
            title,
            text: "",
        };
        let scenes = [
            scene("", "vase", "A vase."),
            scene("lecture", "01-point", "A light."),
            scene("", "a", "An a."),
        ];
        assert_eq!(
            scene_list(&scenes, None),
            "vase      A vase.\na         An a.\n\nlecture\n  01-point  A light.\n"
        );
        assert_eq!(
            scene_list(&scenes[1..2], Some(18)),
            "lecture\n  01-point  A\n            light.\n"
        );
    }
}
