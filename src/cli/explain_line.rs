//! The line that explains a pixel, made of the command line of `compare`.

use rastray::report::origin::quoted;

use super::args::CompareArgs;
use super::commands;

/// `rastray explain SCENE`, and the options behind X Y: those of this command that change a pixel.
pub(super) fn explain_line(args: &CompareArgs) -> [String; 2] {
    let scene = &args.scene.scene;
    let before = format!("rastray explain {} ", quoted(scene));
    let options = options(&commands::words(), scene);
    [before, options.iter().map(|o| format!(" {o}")).collect()]
}

/// The words of a command line that change a pixel, without the scene.
fn options(words: &[String], scene: &str) -> Vec<String> {
    let mut options = Vec::new();
    let (mut skip, mut named) = (false, false);
    for word in words {
        if skip {
            skip = false;
        } else if OWN_VALUE.contains(&word.as_str()) {
            skip = true;
        } else if !named && word == scene {
            named = true;
        } else if !is_own(word) {
            options.push(quoted(word));
        }
    }
    options
}

/// Options of `compare` that take a value and do not concern a pixel.
const OWN_VALUE: [&str; 6] = ["-o", "--output", "-j", "--threads", "--color", "--against"];

/// Whether a word concerns files and messages, not the picture.
fn is_own(word: &str) -> bool {
    let flag = matches!(
        word,
        "compare" | "-q" | "--quiet" | "-v" | "--verbose" | "--json" | "--open" | "--watch"
    );
    let joined = OWN_VALUE.iter().any(|own| {
        let rest = word.strip_prefix(own);
        rest.is_some_and(|rest| rest.starts_with('=') || own.len() == 2 && !word.starts_with("--"))
    });
    flag || joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_options_of_the_picture_reach_the_line() {
        for own in [
            "-o",
            "-j4",
            "--output=x",
            "--threads=2",
            "--json",
            "--watch",
            "compare",
        ] {
            assert!(is_own(own) || OWN_VALUE.contains(&own), "{own}");
        }
        for word in [
            "--set",
            "--samples",
            "16",
            "--no-shadows",
            "light.key.diffuse=0.5",
        ] {
            assert!(!is_own(word) && !OWN_VALUE.contains(&word), "{word}");
        }
    }

    #[test]
    fn a_folder_may_have_the_name_of_the_scene() {
        let line = |text: &str| -> Vec<String> {
            let words: Vec<String> = text.split(' ').map(str::to_owned).collect();
            options(&words, "whitted")
        };
        for text in [
            "compare whitted --samples 4 -o whitted",
            "compare -o whitted whitted --samples 4",
            "-q compare --output whitted --samples 4 whitted --json",
            "--color never compare --samples 4 whitted -j 2",
        ] {
            assert_eq!(line(text), ["--samples", "4"], "{text}");
        }
        assert_eq!(
            line("compare whitted --set a.b=[1,2]"),
            ["--set", "'a.b=[1,2]'"]
        );
    }
}
