//! The deck of a lecture: what `rastray lecture` leaves in its folder.
//!
//! In: one [`Slide`] a scene, with its pictures and what the comment at its head says. Out: files. A slide gives four PNG
//! of one size, which lie over each other pixel by pixel where they are pictures (`NAME-raster.png`, `-trace.png`,
//! `-difference.png`), and `NAME-equation.png`, where the scene's terms are lit; what the deck keeps of it is an
//! [`Entry`], small enough to hold many. The entries together give `figures.md`, `figures.tex` and `index.html`, a deck
//! that needs no other file. Measured (2026-11, twenty scenes at 1920 x 1080, 4 samples): 80 pictures of 11 MB together,
//! a page of 6 MB, 180 s of processor time, nearly all of it for rendering.

mod latex;
mod markdown;
mod page;
mod slide;

use rastray_compare::{Map, Scale};

use crate::error::Error;
use crate::frame::Plane;
use crate::import::Head;

use super::equation::Form;
use super::files::View;
use super::folder::{File, difference_numbers};
use super::formats::{png, png_small};
use super::picture::Picture;
use super::topic::Topics;

/// Width that the pictures inside the page come near to: a third of a slide shows them pixel for pixel and more.
const EMBEDDED_WIDTH: usize = 960;

/// The pictures of a slide, in the order in which they are shown.
const KINDS: [&str; 3] = ["raster", "trace", "difference"];

/// A scene of the deck with its pictures, all of one size.
#[derive(Clone, Debug)]
pub struct Slide {
    /// What its files are called, without extension; the same name twice in one deck is told apart by [`stems`].
    pub stem: String,
    /// What its comment says; an empty question is replaced by the name.
    pub head: Head,
    /// What it is about.
    pub topics: Topics,
    /// How it writes the equation.
    pub form: Form,
    /// How linear values are shown.
    pub view: View,
    /// The rasterized picture.
    pub raster: Plane<[f32; 3]>,
    /// The traced picture.
    pub trace: Plane<[f32; 3]>,
    /// Trace minus raster, of the values that the files store.
    pub difference: Map,
}

/// What the deck's own files need of a slide: its texts and small pictures.
#[derive(Clone, Debug)]
pub struct Entry {
    stem: String,
    head: Head,
    topics: Topics,
    form: Form,
    /// Raster, trace and difference, as in [`KINDS`]: PNG, with its width and height.
    pictures: Vec<(Vec<u8>, usize, usize)>,
    scale: Scale,
    /// How much differs, in a sentence without its full stop.
    numbers: String,
}

impl Entry {
    /// What stands above the pictures.
    fn title(&self) -> &str {
        match self.head.question.as_str() {
            "" => &self.stem,
            question => question,
        }
    }

    /// The name of a picture's file.
    fn file(&self, kind: &str) -> String {
        format!("{}-{kind}.png", self.stem)
    }

    /// What stands below the pictures, as sentences.
    fn caption(&self) -> String {
        let answer = &self.head.answer;
        format!(
            "{}{}{answer}",
            self.title(),
            if answer.is_empty() { "" } else { " " }
        )
    }
}

impl Slide {
    /// The four pictures as files, encoded in parallel, and what the deck keeps.
    ///
    /// # Errors
    /// Pictures of different or empty sizes, and sizes beyond memory.
    pub fn finish(self) -> Result<(Vec<File>, Entry), Error> {
        let (width, height) = (self.raster.width, self.raster.height);
        let name = |kind: &str| format!("{}-{kind}.png", self.stem);
        let signed = Picture::from_map(&self.difference);
        let shown = [
            Picture::from_linear(&self.raster, self.view)?,
            Picture::from_linear(&self.trace, self.view)?,
            signed.clone(),
        ];
        let (pictures, files) = rayon::join(
            || shown.iter().map(embedded).collect::<Result<Vec<_>, _>>(),
            || {
                let ((raster, trace), (difference, equation)) = rayon::join(
                    || {
                        rayon::join(
                            || png(&self.raster, self.view),
                            || png(&self.trace, self.view),
                        )
                    },
                    || {
                        rayon::join(
                            || png_small(&slide::with_legend(&signed)?),
                            || png_small(&slide::equation(&self, width, height)?),
                        )
                    },
                );
                let bytes = [raster?, trace?, difference?, equation?];
                let names = [KINDS[0], KINDS[1], KINDS[2], "equation"].map(name);
                let files = names.into_iter().zip(bytes);
                Ok::<_, Error>(files.map(|(name, bytes)| File { name, bytes }).collect())
            },
        );
        let (pictures, files) = (pictures?, files?);
        let entry = Entry {
            pictures,
            scale: self.difference.scale,
            numbers: difference_numbers(&self.difference),
            stem: self.stem,
            head: self.head,
            topics: self.topics,
            form: self.form,
        };
        Ok((files, entry))
    }
}

/// A small PNG of a picture, with its size.
fn embedded(picture: &Picture) -> Result<(Vec<u8>, usize, usize), Error> {
    let factor = (picture.width + EMBEDDED_WIDTH / 2) / EMBEDDED_WIDTH;
    let small = picture.reduced(factor.max(1));
    Ok((png_small(&small)?, small.width, small.height))
}

/// A deck: its entries in the order of the lecture.
#[derive(Clone, Debug)]
pub struct Deck {
    /// The command line that made it.
    pub command: String,
    /// The slides.
    pub entries: Vec<Entry>,
}

impl Deck {
    /// `figures.md`, `figures.tex` and `index.html`.
    pub fn files(&self) -> Vec<File> {
        let file = |name: &str, text: String| File {
            name: name.to_owned(),
            bytes: text.into_bytes(),
        };
        vec![
            file("figures.md", self.to_markdown()),
            file("figures.tex", self.to_latex()),
            file("index.html", self.to_html()),
        ]
    }
}

/// Names of files for scenes: letters, digits, `-` and `_` of ASCII, so that every program that includes pictures takes
/// them; a name that was there before has a number behind it.
///
/// ```
/// use rastray::report::deck::stems;
/// assert_eq!(stems(&["a b", "ball", "ball", "ball-2"]), ["a_b", "ball", "ball-2", "ball-2-2"]);
/// ```
pub fn stems(names: &[&str]) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for name in names {
        let safe = |c: char| {
            if c.is_ascii_alphanumeric() || c == '-' {
                c
            } else {
                '_'
            }
        };
        let stem: String = name.chars().take(100).map(safe).collect();
        let mut unused = stem.clone();
        let mut number = 2;
        while unused.is_empty() || found.contains(&unused) {
            unused = format!("{stem}-{number}");
            number += 1;
        }
        found.push(unused);
    }
    found
}

#[cfg(test)]
mod tests;
