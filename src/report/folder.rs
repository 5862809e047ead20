//! The files that `compare` leaves in its folder, as bytes with their names.
//!
//! `raster.png trace.png difference.png side-by-side.png buildup.png terms/NN-NAME.png causes/NN-NAME.png summary.json
//! index.html`. `layers.exr` is not among them: see [`super::layered::exr`]. Numbers count from 01 in the order of the
//! sum (terms) and of the ladder (causes).
//!
//! Measured (2026-11, 640 x 480, 9 causes, 8 terms, one thread, optimised build with overflow checks): 0.95 s for all
//! files, which are encoded side by side, of which a PNG takes 0.04 s and 0.08 s with the sRGB transform. The page's own
//! sizes: [`super::page::live`].

use std::path::Path;

use rastray_compare::Map;
use rayon::prelude::*;

use crate::error::Error;

use super::causes::{explanation, figures};
use super::figures::{Panel, buildup, map, strip};
use super::files::{create_folder, write_bytes_atomic};
use super::formats::{png, png_of_picture};
use super::numbers::{count, percent, value};
use super::page::{Report, capital};
use super::picture::Picture;

/// What the rasterized picture is.
pub(super) const RASTER_NOTE: &str = "OpenGL's fixed-function lighting: every surface on its own";
/// What the traced picture is.
pub(super) const TRACE_NOTE: &str = "Whitted's ray tracing: shadows, mirrors and refraction";
/// What a signed map of the whole difference says below it.
pub(super) const DIFFERENCE_NOTE: &str = "trace − raster: orange where the traced picture is brighter, blue where it is darker; 1 = full intensity";

/// A file's name, and what makes its bytes.
type Job<'a> = (String, Encode<'a>);
/// Makes a file's bytes.
type Encode<'a> = Box<dyn FnOnce() -> Result<Vec<u8>, Error> + Send + 'a>;

fn job<'a>(
    name: impl Into<String>,
    encode: impl FnOnce() -> Result<Vec<u8>, Error> + Send + 'a,
) -> Job<'a> {
    (name.into(), Box::new(encode))
}

/// A file of the folder.
#[derive(Clone, Debug)]
pub struct File {
    /// Its name, with forward slashes.
    pub name: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

impl Report {
    /// All files of the comparison except `layers.exr`, encoded in parallel, in the order of the module's head.
    pub fn files(&self) -> Result<Vec<File>, Error> {
        let mut jobs: Vec<Job<'_>> = vec![
            job("raster.png", || png(&self.raster, self.view)),
            job("trace.png", || png(&self.trace, self.view)),
            job("difference.png", || {
                png_of_picture(&self.difference_figure()?)
            }),
            job("side-by-side.png", || png_of_picture(&self.side_by_side()?)),
            job("buildup.png", || png_of_picture(&self.buildup_figure()?)),
        ];
        for (i, term) in self.terms.iter().enumerate() {
            let name = format!("terms/{:02}-{}.png", i + 1, file_name(&term.name));
            jobs.push(job(name, || png(&term.plane, self.view)));
        }
        let causes = self.summary.causes.iter().zip(&self.cause_maps);
        for (i, (cause, _)) in causes.enumerate() {
            let name = format!("causes/{:02}-{}.png", i + 1, file_name(&cause.name));
            jobs.push(job(name, move || match self.cause_figure(i)? {
                Some(figure) => png_of_picture(&figure),
                None => Ok(Vec::new()),
            }));
        }
        jobs.push(job("summary.json", || {
            let json = self.summary.to_json().map(String::into_bytes);
            json.map_err(|e| Error::limit(format!("cannot write summary.json: {e}")))
        }));
        jobs.push(job("index.html", || self.to_html().map(String::into_bytes)));
        jobs.into_par_iter()
            .map(|(name, encode)| encode().map(|bytes| File { name, bytes }))
            .collect()
    }

    /// Writes all files into a folder, which is made where it is missing. Everything is encoded before the first write.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        Self::write_files(folder, &self.files()?)
    }

    /// Writes files that [`Report::files`] made into a folder, which is made where it is missing.
    pub fn write_files(folder: &Path, files: &[File]) -> Result<(), Error> {
        for part in ["terms", "causes"] {
            create_folder(&folder.join(part))?;
        }
        files
            .iter()
            .try_for_each(|f| write_bytes_atomic(&folder.join(&f.name), &f.bytes))
    }

    /// raster | trace | difference.
    pub fn side_by_side(&self) -> Result<Picture, Error> {
        let raster = Picture::from_linear(&self.raster, self.view)?;
        let trace = Picture::from_linear(&self.trace, self.view)?;
        let difference = Picture::from_map(&self.difference);
        strip(&[
            Panel {
                picture: &raster,
                title: "raster",
                note: RASTER_NOTE,
            },
            Panel {
                picture: &trace,
                title: "trace",
                note: TRACE_NOTE,
            },
            Panel {
                picture: &difference,
                title: "difference",
                note: DIFFERENCE_NOTE,
            },
        ])
    }

    /// The signed difference and its magnitude, with legends and numbers.
    pub fn difference_figure(&self) -> Result<Picture, Error> {
        let numbers = difference_numbers(&self.difference);
        let note = format!("{DIFFERENCE_NOTE}. {numbers}.");
        let signed = Picture::from_map(&self.difference);
        let magnitude = Picture::from_map(&self.error);
        strip(&[
            Panel {
                picture: &signed,
                title: "difference",
                note: &note,
            },
            Panel {
                picture: &magnitude,
                title: "error",
                note: "magnitude of the same in false colours: the lighter, the larger",
            },
        ])
    }

    /// The map of a cause with its legend and numbers; none where there is no such cause or map.
    pub fn cause_figure(&self, index: usize) -> Result<Option<Picture>, Error> {
        let found = self
            .summary
            .causes
            .get(index)
            .zip(self.cause_maps.get(index));
        let Some((cause, cause_map)) = found else {
            return Ok(None);
        };
        let numbers = capital(&figures(cause, self.pixels()));
        let note = match explanation(&cause.name) {
            Some(known) => format!("{}. {numbers}", capital(known.step)),
            None => numbers,
        };
        let picture = Picture::from_map(cause_map);
        map(Panel {
            picture: &picture,
            title: &cause.name,
            note: &note,
        })
        .map(Some)
    }

    /// The equation growing.
    pub fn buildup_figure(&self) -> Result<Picture, Error> {
        let mut pictures = Vec::new();
        for (term, plane) in &self.buildup {
            pictures.push((*term, Picture::from_linear(plane, self.view)?));
        }
        let steps: Vec<_> = pictures
            .iter()
            .map(|(term, picture)| (*term, picture))
            .collect();
        buildup(&steps, self.form)
    }
}

/// How much of a picture differs, and by how much; without a full stop.
pub(super) fn difference_numbers(difference: &Map) -> String {
    let summary = &difference.summary;
    match summary.pixels {
        0 => "The pictures are identical".to_owned(),
        n => format!(
            "{} pixels ({}) differ, at most by {}, rmse {}",
            count(n),
            percent(n, difference.pixels.len()),
            value(summary.max),
            value(summary.rmse)
        ),
    }
}

/// A name that is safe in every file system: letters, digits, `.`, `-`, `_`; others become `_`.
fn file_name(name: &str) -> String {
    let safe = |c: char| {
        if c.is_alphanumeric() || "-_.".contains(c) {
            c
        } else {
            '_'
        }
    };
    name.chars().take(100).map(safe).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::page::tests::example;

    #[test]
    fn the_folder_holds_what_it_promises() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("new/out");
        example().write(&target).unwrap();
        for name in [
            "raster.png",
            "trace.png",
            "difference.png",
            "side-by-side.png",
            "buildup.png",
            "terms/01-emission.png",
            "terms/02-diffuse.a_b.png",
            "causes/01-quantization.png",
            "causes/09-display.png",
            "summary.json",
            "index.html",
        ] {
            assert!(target.join(name).is_file(), "{name}");
        }
    }

    #[test]
    fn the_same_report_gives_the_same_bytes() {
        let bytes = |report: &Report| -> Vec<Vec<u8>> {
            report
                .files()
                .unwrap()
                .into_iter()
                .map(|f| f.bytes)
                .collect()
        };
        assert_eq!(bytes(&example()), bytes(&example()));
    }

    #[test]
    fn names_stay_inside_the_folder() {
        assert_eq!(
            file_name("diffuse.../../key light"),
            "diffuse..._.._key_light"
        );
    }
}
