//! Where a report comes from: command lines that can be typed again, and what was rendered how.

use crate::render::Options;
use crate::scene::Scene;
use crate::scene::tessellate::DEFAULT_LEVEL;

/// A word of a command line, in quotes where a shell would see more in it than a word.
///
/// Single quotes keep everything in POSIX shells but a single quote itself, which leaves them for a moment.
///
/// ```
/// use rastray::report::origin::quoted;
/// assert_eq!(quoted("light.key.diffuse=0.5"), "light.key.diffuse=0.5");
/// assert_eq!(quoted("my scene.toml"), "'my scene.toml'");
/// assert_eq!(quoted("it's.toml"), r"'it'\''s.toml'");
/// ```
pub fn quoted(word: &str) -> String {
    // Brackets as in KEY=[1,2,3] are patterns of files; zsh refuses those that match none.
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// The words behind the program's name as they could be typed again.
///
/// ```
/// use rastray::report::origin::command;
/// assert_eq!(command(["compare", "my scene.toml"]), "rastray compare 'my scene.toml'");
/// ```
pub fn command(words: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    let words = words.into_iter().map(|word| quoted(word.as_ref()));
    let all: Vec<String> = std::iter::once("rastray".to_owned()).chain(words).collect();
    all.join(" ")
}

/// Overrides of a scene's keys, each behind a space.
///
/// ```
/// use rastray::report::origin::sets;
/// assert_eq!(sets(&["trace.depth=1".to_owned()]), " --set trace.depth=1");
/// ```
pub fn sets(sets: &[String]) -> String {
    let all = sets.iter().map(|set| format!(" --set {}", quoted(set)));
    all.collect()
}

/// What was rendered how: names and values.
pub fn settings(scene: &Scene, options: &Options) -> Vec<(String, String)> {
    let image = &scene.image;
    let pairs = [
        ("size", format!("{}x{}", image.width, image.height)),
        ("samples", image.samples.to_string()),
        (
            "shading",
            format!("{:?}", scene.raster.shading).to_lowercase(),
        ),
        (
            "tessellation",
            options.level.unwrap_or(DEFAULT_LEVEL).to_string(),
        ),
        ("depth", scene.trace.depth.to_string()),
        ("precision", options.precision.name().to_owned()),
        ("snap", scene.raster.snap.name().to_owned()),
        ("isa", options.isa.name().to_owned()),
        ("threads", rayon::current_num_threads().to_string()),
    ];
    pairs.map(|(name, value)| (name.to_owned(), value)).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Words with everything that a shell could see in them.
    #[cfg(unix)]
    const WORDS: [&str; 10] = [
        "whitted",
        "",
        "it's.toml",
        "''",
        "a b\tc",
        "$HOME `id` \\ \"",
        "light.key.position=[-1,2,1]",
        "*?{a,b}~!#&;|<>()",
        "größe.toml",
        "-o=x\ny",
    ];

    #[test]
    fn quotes_of_a_shell_are_its_own() {
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted("'"), r"''\'''");
        assert_eq!(quoted(""), "''");
        assert_eq!(quoted("größe.toml"), "größe.toml");
    }

    #[cfg(unix)]
    #[test]
    fn a_shell_reads_every_word_back() {
        for word in WORDS {
            let script = format!("printf %s {}", quoted(word));
            let out = std::process::Command::new("sh")
                .args(["-c", &script])
                .output();
            assert_eq!(
                out.expect("a POSIX shell").stdout,
                word.as_bytes(),
                "{word}"
            );
        }
    }
}
