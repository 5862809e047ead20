//! "Did you mean": the nearest of the known names.

use crate::error::Error;

/// The known name that a misspelt one most likely means.
pub(crate) fn closest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let wanted = name.to_lowercase();
    known
        .iter()
        .map(|k| (strsim::jaro_winkler(&wanted, &k.to_lowercase()), *k))
        .filter(|(score, k)| {
            let edits = strsim::osa_distance(&wanted, &k.to_lowercase());
            *score > 0.8 || edits <= 1 || edits == 2 && k.len() > 4
        })
        .reduce(|best, x| if x.0 > best.0 { x } else { best })
        .map(|(_, k)| k)
}

/// A line of advice about a name that is not among the known ones; `None` where none is known.
pub(crate) fn advice(name: &str, known: &[&str]) -> Option<String> {
    match closest(name, known) {
        Some(near) => Some(format!("did you mean `{near}`?")),
        None if known.is_empty() => None,
        None if known.len() == 1 => Some(format!("there is {}", list(known, "and"))),
        None if known.len() <= 24 => Some(format!("there are {}", list(known, "and"))),
        None => Some(format!("there are {} names", known.len())),
    }
}

/// The error with [`advice`] where there is some.
pub(crate) fn with_advice(error: Error, name: &str, known: &[&str]) -> Error {
    match advice(name, known) {
        Some(advice) => error.with_help(advice),
        None => error,
    }
}

/// The error with the nearest known name, for messages that list the names already.
pub(crate) fn with_closest(error: Error, name: &str, known: &[&str]) -> Error {
    match closest(name, known) {
        Some(near) => error.with_help(format!("did you mean `{near}`?")),
        None => error,
    }
}

/// "`a`, `b` and `c`".
pub(crate) fn list(names: &[&str], join: &str) -> String {
    match names {
        [] => String::new(),
        [one] => format!("`{one}`"),
        [rest @ .., last] => {
            let rest: Vec<String> = rest.iter().map(|n| format!("`{n}`")).collect();
            format!("{} {join} `{last}`", rest.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspelt_names_find_their_neighbour() {
        let known = ["shininess", "specular", "diffuse"];
        assert_eq!(closest("shinyness", &known), Some("shininess"));
        assert_eq!(closest("Specular", &known), Some("specular"));
        assert_eq!(closest("zebra", &known), None);
        assert_eq!(closest("rde", &["red", "blue"]), Some("red"));
        assert_eq!(list(&known, "or"), "`shininess`, `specular` or `diffuse`");
    }
}
