//! Files of bicubic patches: the two plain text forms that such models, the teapot first, are passed on in.
//!
//! | form | words |
//! | - | - |
//! | points in place (`.bpt`) | the number of patches; for each `3 3` (its degrees) and 16 points |
//! | numbered points (Newell's list) | the number of patches; for each 16 numbers from 1; the number of points; the points |
//!
//! Commas count as spaces, and messages show them as such; line ends mean nothing. Degrees other than 3 are refused, and so are
//! comments.

use super::keys::{MAX_PATCH_POINTS, MAX_PATCHES};
use super::lexer::{Lexer, Token};
use crate::error::Error;
use crate::math::DVec3;

/// Control points, and patches by number from 0.
pub(crate) type Patches = (Vec<DVec3>, Vec<[u32; 16]>);

/// Reads the text of a file.
pub(crate) fn read(file: &str, text: &str) -> Result<Patches, Error> {
    let text = text.replace(',', " ");
    let mut lexer = Lexer::new(file, &text);
    let patches = count(&mut lexer, "the number of patches", MAX_PATCHES)?;
    let found = if has_points_in_place(&lexer, patches) {
        in_place(&mut lexer, patches)?
    } else {
        numbered(&mut lexer, patches)?
    };
    match lexer.next() {
        None => Ok(found),
        more => Err(lexer.expected("the end of the file", more.as_ref())),
    }
}

/// Whether the words after the count are points in place: two degrees and a word with a decimal point, which is no point number; or 50
/// words a patch, each time `3 3` first.
fn has_points_in_place(lexer: &Lexer<'_>, patches: u32) -> bool {
    let mut ahead = lexer.clone();
    let mut words = 0u64;
    let mut degrees = true;
    while let Some(token) = ahead.next() {
        degrees &= words % 50 >= 2 || token.text == "3";
        words += 1;
    }
    let mut ahead = lexer.clone();
    let begins = (0..2).all(|_| ahead.next().is_some_and(|t| t.text.len() == 1))
        && ahead.next().is_some_and(|t| t.text.contains('.'));
    begins || degrees && words == 50 * u64::from(patches)
}

fn count(lexer: &mut Lexer<'_>, what: &str, most: u32) -> Result<u32, Error> {
    let (count, token) = lexer.integer(what)?;
    match u32::try_from(count) {
        Ok(count) if (1..=most).contains(&count) => Ok(count),
        _ => Err(lexer.expected(&format!("{what}, from 1 to {most}"), Some(&token))),
    }
}

fn point(lexer: &mut Lexer<'_>) -> Result<DVec3, Error> {
    let mut number = || Ok(lexer.number("a coordinate")?.0);
    Ok(DVec3::new(number()?, number()?, number()?))
}

fn in_place(lexer: &mut Lexer<'_>, patches: u32) -> Result<Patches, Error> {
    let mut found = Patches::default();
    for k in 0..patches {
        for _ in 0..2 {
            let (degree, token) = lexer.integer("the degrees of a patch, 3 3")?;
            if degree != 3 {
                return Err(lexer.expected("the degrees of a patch, 3 3", Some(&token)));
            }
        }
        for _ in 0..16 {
            found.0.push(point(lexer)?);
        }
        found.1.push(std::array::from_fn(|i| 16 * k + i as u32));
    }
    Ok(found)
}

fn numbered(lexer: &mut Lexer<'_>, patches: u32) -> Result<Patches, Error> {
    let mut found = Patches::default();
    let mut largest: Option<(i64, Token<'_>)> = None;
    for _ in 0..patches {
        let mut patch = [0; 16];
        for index in &mut patch {
            let what = "the number of a control point, from 1";
            let (number, token) = lexer.integer(what)?;
            if !(1..=i64::from(MAX_PATCH_POINTS)).contains(&number) {
                return Err(lexer.expected(what, Some(&token)));
            }
            if largest.as_ref().is_none_or(|l| l.0 < number) {
                largest = Some((number, token));
            }
            *index = number as u32 - 1;
        }
        found.1.push(patch);
    }
    let points = count(lexer, "the number of control points", MAX_PATCH_POINTS)?;
    if let Some((number, token)) = largest
        && number > i64::from(points)
    {
        let what = format!("a point number from 1 to {points}");
        return Err(lexer.expected(&what, Some(&token)));
    }
    for _ in 0..points {
        found.0.push(point(lexer)?);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sheet z = 0 over a 4 x 4 grid of points.
    fn point_words(i: u32) -> String {
        format!("{}.0 {}.0 0\n", i % 4, i / 4)
    }

    #[test]
    fn both_forms_say_the_same() {
        let points: String = (0..16).map(point_words).collect();
        let in_place = read("a.bpt", &format!("1\n3 3\n{points}")).unwrap();
        let numbers: Vec<String> = (1..=16).map(|i| i.to_string()).collect();
        let text = format!("1\n{}\n16\n{}", numbers.join(","), points.replace(' ', ","));
        assert_eq!(read("a", &text).unwrap(), in_place);
        assert_eq!(in_place.0[5], DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(in_place.1[0][15], 15);
    }

    #[test]
    fn errors_have_a_place() {
        let points: String = (0..16).map(point_words).collect();
        let numbers: Vec<String> = (1..=16).map(|i| i.to_string()).collect();
        let numbers = numbers.join(" ");
        for (text, place, message) in [
            (
                "x".into(),
                "1:1",
                "expected the number of patches, found `x`",
            ),
            (
                "0".into(),
                "1:1",
                "expected the number of patches, from 1 to 65536, found `0`",
            ),
            (
                "99999999".into(),
                "1:1",
                "expected the number of patches, from 1 to 65536, found `99999999`",
            ),
            (
                format!("1 3 3 {}", points.replacen("1.0", "nan", 1)),
                "2:1",
                "expected a coordinate, which must be finite, found `nan`",
            ),
            (
                "1 3 3 0.0 0 0 1".into(),
                "1:16",
                "expected a coordinate, found the end of the file",
            ),
            (
                format!("1 3 3 {points} 7"),
                "17:2",
                "expected the end of the file, found `7`",
            ),
            (
                format!("1 3 2 {points}"),
                "1:5",
                "expected the degrees of a patch, 3 3, found `2`",
            ),
            (
                format!("1 {numbers} 15 {points}"),
                "1:39",
                "expected a point number from 1 to 15, found `16`",
            ),
            (
                format!("1 {} 16 {points}", numbers.replacen('1', "0", 1)),
                "1:3",
                "expected the number of a control point, from 1, found `0`",
            ),
            (
                format!("1 {numbers} 17 {points}"),
                "16:10",
                "expected a coordinate, found the end of the file",
            ),
        ] {
            let error = read("a.bpt", &text).unwrap_err();
            let found = error.place().unwrap();
            let found = format!("{}:{} {error}", found.line, found.column);
            assert!(
                found.starts_with(place) && found.contains(message),
                "{text:?}: {found}"
            );
        }
    }
}
