//! A check as people and programs read it: pictures here, `text` for a terminal, `json` for programs.
//!
//! Pictures are the given one, the one with the mistake that explains it, the right one, and their differences.
//! Values are shown as the files store them. The difference maps share one scale, so that what the mistake explains is seen
//! to go.

mod json;
mod text;

use std::path::Path;

use rastray_compare::{Reduction, Scale, ScaleKind};

use super::figures::{Panel, contact_sheet, strip};
use super::files::View;
use super::folder::File;
use super::formats::{png, png_of_picture};
use super::numbers::value;
use super::origin::{quoted, sets};
use super::picture::Picture;
use crate::check::{Given, Report, Telling};
use crate::error::Error;
use crate::frame::Plane;

/// Small pictures are enlarged to about this width in figures.
const WIDTH: usize = 320;

/// A check with its pictures.
#[derive(Clone, Copy, Debug)]
pub struct Checked<'a> {
    /// The answer.
    pub report: &'a Report,
    /// The picture that was checked.
    pub given: &'a Given,
    /// As what.
    pub asked: Asked<'a>,
}

/// What a check was asked, in the words of its command line.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// The file that was checked.
    pub image: &'a Path,
    /// The scene: a file, or a shipped one's name.
    pub scene: &'a str,
    /// Overrides of its keys.
    pub sets: &'a [String],
    /// `--mode` was given.
    pub mode: bool,
    /// `--shading` was given.
    pub shading: bool,
}

impl Asked<'_> {
    /// The line that explains a pixel.
    fn explain(&self, [width, height]: [usize; 2], told: &Telling) -> String {
        format!(
            "rastray explain {} {} {} --size {width}x{height}{}",
            quoted(self.scene),
            told.x,
            told.y,
            sets(self.sets)
        )
    }
}

impl Checked<'_> {
    /// given | with the mistake | right, and below given - mistaken, given - right; without a mistake, given | right |
    /// given - right.
    ///
    /// # Errors
    /// Pictures that are too large for a figure.
    pub fn strip(&self) -> Result<Picture, Error> {
        let given = shown(&self.given.color)?;
        let right = shown(&self.report.right)?;
        let off = self.difference(&self.report.right);
        let off_note = format!("rmse {}", value(self.report.error));
        let right_note = format!("what the scene gives: {}", self.report.mode.describe());
        let given = panel(&given, "given", "the picture that is checked");
        let right = panel(&right, "right", &right_note);
        let off = panel(&off, "given − right", &off_note);
        let found = self
            .report
            .mistaken
            .as_ref()
            .zip(self.report.findings.first());
        let Some((mistaken, finding)) = found else {
            return strip(&[given, right, off]);
        };
        let picture = shown(mistaken)?;
        let left = self.difference(mistaken);
        let note = format!("rmse {}: what the mistake leaves", value(finding.error));
        let mistaken = panel(&picture, "with the mistake", finding.mistake.title);
        let left = panel(&left, "given − with the mistake", &note);
        contact_sheet(
            &[("", vec![given, mistaken, right]), ("", vec![off, left])],
            3,
        )
    }

    /// The files of a folder: the strip, its pictures one by one, pixel for pixel, and `check.json`.
    ///
    /// # Errors
    /// As [`Self::strip`].
    pub fn files(&self) -> Result<Vec<File>, Error> {
        let file = |name: &str, bytes| File {
            name: name.to_owned(),
            bytes,
        };
        let mut files = vec![
            file("strip.png", png_of_picture(&self.strip()?)?),
            file("right.png", png(&self.report.right, View::Linear)?),
        ];
        if let Some(mistaken) = &self.report.mistaken {
            files.push(file("mistaken.png", png(mistaken, View::Linear)?));
        }
        let report = format!("{:#}\n", self.to_json());
        files.push(file("check.json", report.into_bytes()));
        Ok(files)
    }

    /// given - another picture, signed, on the scale of given - right.
    fn difference(&self, other: &Plane<[f32; 3]>) -> Picture {
        let given = &self.given.color;
        let limited = |x: f32| f64::from(x).clamp(-1e6, 1e6);
        let pixel = |a: &[f32; 3], b: &[f32; 3]| {
            Reduction::Largest.apply([0, 1, 2].map(|c| limited(a[c]) - limited(b[c])))
        };
        let values = |b: &Plane<[f32; 3]>| -> Vec<f64> {
            given
                .data
                .iter()
                .zip(&b.data)
                .map(|(a, b)| pixel(a, b))
                .collect()
        };
        let largest = values(&self.report.right)
            .into_iter()
            .fold(0.0, |m: f64, x| m.max(x.abs()));
        let scale = Scale::fitting(ScaleKind::Signed, largest);
        let picture = Picture {
            width: given.width,
            height: given.height,
            pixels: values(other).into_iter().map(|x| scale.color(x)).collect(),
            scale: Some(scale),
        };
        enlarged(picture)
    }
}

fn shown(values: &Plane<[f32; 3]>) -> Result<Picture, Error> {
    Picture::from_linear(values, View::Linear).map(enlarged)
}

fn enlarged(picture: Picture) -> Picture {
    let factor = WIDTH.div_ceil(picture.width.max(1)).max(1);
    picture.enlarged(factor)
}

fn panel<'a>(picture: &'a Picture, title: &'a str, note: &'a str) -> Panel<'a> {
    Panel {
        picture,
        title,
        note,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_that_explains_a_pixel_can_be_typed() {
        let sets = ["light.key.position=[1,2,3]".to_owned()];
        let asked = Asked {
            image: Path::new("mine.png"),
            scene: "it's mine.toml",
            sets: &sets,
            mode: false,
            shading: false,
        };
        let told = Telling {
            x: 3,
            y: 4,
            given: [0.0; 3],
            mistaken: [0.0; 3],
            right: [1.0; 3],
        };
        assert_eq!(
            asked.explain([64, 48], &told),
            r"rastray explain 'it'\''s mine.toml' 3 4 --size 64x48 --set 'light.key.position=[1,2,3]'"
        );
    }
}
