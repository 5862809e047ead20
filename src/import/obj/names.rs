//! Names of materials, objects and groups as the bytes they are, and when two of them mean the same.
//!
//! A name runs to the end of its line, so a comment behind it is part of it as far as the format goes; some programs
//! write names with `#` in them (`Material #25`), others comments behind names. So a name is tried whole first, then
//! without what may be a comment. Quotes around a name, `.\\` or `./` before it and the direction of its slashes say
//! nothing.

use std::collections::HashMap;

use super::words::comment;
use crate::import::text::{decode, unquoted};

/// What a name is called: without quotes, and without a comment, whose `#` is a word of its own.
pub(super) fn label(name: &[u8]) -> &[u8] {
    let is_comment = |at: &usize| name.get(at + 1).is_none_or(u8::is_ascii_whitespace);
    let end = comment(name).filter(|at| *at > 0).filter(is_comment);
    unquoted(&name[..end.unwrap_or(name.len())])
}

/// [`label`] as text.
pub(super) fn shown(name: &[u8]) -> String {
    decode(label(name)).into_owned()
}

/// The name without a comment.
pub(super) fn without_comment(name: &[u8]) -> &[u8] {
    &name[..comment(name).filter(|at| *at > 0).unwrap_or(name.len())]
}

/// What names that mean the same share.
fn key(name: &[u8]) -> Vec<u8> {
    let name = unquoted(name);
    let slashes = name.iter().map(|b| if *b == b'\\' { b'/' } else { *b });
    let slashes: Vec<u8> = slashes.collect();
    let mut key = &slashes[..];
    while let Some(rest) = key.strip_prefix(b"./") {
        key = rest;
    }
    key.strip_suffix(b"/").unwrap_or(key).to_vec()
}

/// Names with what they stand for.
#[derive(Debug, Default)]
pub(super) struct Names {
    whole: HashMap<Vec<u8>, usize>,
    /// Without comments; none where two names differ in theirs only.
    bare: HashMap<Vec<u8>, Option<usize>>,
}

impl Names {
    /// Gives a name another meaning; says what it meant before.
    pub(super) fn insert(&mut self, name: &[u8], value: usize) -> Option<usize> {
        let before = self.whole.insert(key(name), value);
        let bare = self.bare.entry(key(without_comment(name)));
        let same = |old: &Option<usize>| before.is_some() && *old == before;
        bare.and_modify(|old| *old = Some(value).filter(|_| same(old)))
            .or_insert(Some(value));
        before
    }

    /// What exactly this name means.
    pub(super) fn get(&self, name: &[u8]) -> Option<usize> {
        self.whole.get(&key(name)).copied()
    }

    /// What a name means, or another that is the same without comments.
    pub(super) fn find(&self, name: &[u8]) -> Option<usize> {
        let (whole, bare) = (key(name), key(without_comment(name)));
        let exact = self.whole.get(&whole).or_else(|| self.whole.get(&bare));
        // `#25` may be part of a name; only what is surely a comment may differ on both sides.
        let commented = key(label(name));
        let loose = || self.bare.get(&whole).or_else(|| self.bare.get(&commented));
        exact.copied().or_else(|| *loose()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_mean_the_same_are_found() {
        let mut names = Names::default();
        for (i, name) in [
            "red # warm",
            "Material #25",
            "Material #26",
            "dir\\a",
            "\"b c\"",
        ]
        .iter()
        .enumerate()
        {
            assert_eq!(names.insert(name.as_bytes(), i), None);
        }
        let find = |name: &str| names.find(name.as_bytes());
        assert_eq!(find("red"), Some(0));
        assert_eq!(find("red # cold"), Some(0));
        assert_eq!(find("Material #26"), Some(2));
        assert_eq!(find("Material"), None);
        assert_eq!(find("Material #27"), None);
        let mut one = Names::default();
        one.insert(b"Material #25", 0);
        assert_eq!(one.find(b"Material #26"), None);
        assert_eq!(one.find(b"Material"), Some(0));
        assert_eq!(
            [find("dir/a"), find(".\\dir/a"), find("'dir\\a'")],
            [Some(3); 3]
        );
        assert_eq!([find("b c"), find("b c # x")], [Some(4); 2]);
        assert_eq!(names.find(b"r\xe9d"), None);
        assert_eq!(shown(b"\"r\xe9d\" # x"), "r\u{e9}d");
        assert_eq!(shown(b"Material #25"), "Material #25");
        // Another meaning for the same name: the comment stays what it was.
        assert_eq!(names.insert(b"red # warm", 9), Some(0));
        assert_eq!(names.find(b"red"), Some(9));
    }
}
