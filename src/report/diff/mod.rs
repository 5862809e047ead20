//! Two picture files held against each other: what `rastray diff A B` says and writes.
//!
//! In: two [`PictureFile`]s of one size. Out: [`Diff`]: numbers, maps, text, JSON, and the files of a folder:
//! `side-by-side.png difference.png error.png flip.png summary.json index.html`. A is the reference, which is trusted, B the
//! test, which is judged: difference = B - A.
//!
//! Values are compared as stored. Whether another reading of one file would bring them nearer (its values decoded from
//! sRGB) is measured beside it and said, never applied unasked. LDR-FLIP looks at the 8-bit pictures; where both files
//! hold light as floats, HDR-FLIP looks at the light.

mod page;

use rastray_compare::{
    CompareError, Comparison, DynamicRange, Encoding, Exposures, ImageView, Map, Metrics,
    Reduction, Viewing, flip_map, magnitude_map, pixels_differing, signed_map,
};
use rayon::prelude::*;
use serde::Serialize;

use super::figures::{Panel, map, strip};
use super::files::View;
use super::folder::File;
use super::formats::png_of_picture;
use super::numbers::{count, percent, value};
use super::picture::Picture;
use crate::error::{Error, Place};
use crate::frame::Plane;
use crate::import::picture::PictureFile;
use crate::math::color::{linear_from_srgb, srgb_from_linear};

/// One of the two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Which {
    /// The first, the reference.
    A,
    /// The second, the test.
    B,
}

impl Which {
    /// `A` or `B`.
    pub fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }
}

/// How to compare.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Pixels per degree of visual angle, for FLIP.
    pub ppd: f64,
    /// The picture whose values are decoded from sRGB first.
    pub decode: Option<Which>,
}

/// Values that are infinite or not a number: what `--nan` counts. The metrics leave them out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct NonFinite {
    /// Pixels of A that hold one.
    pub a: usize,
    /// Pixels of B that hold one.
    pub b: usize,
    /// Pixels where one picture holds one and the other does not, or one of another kind. NaN equals NaN, and an infinity
    /// the same infinity.
    pub differing: usize,
    /// Those of them that differ in another channel, too, by finite values.
    #[serde(skip)]
    also: usize,
}

/// Every number of the comparison: `summary.json`, and what `--json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DiffSummary {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The reference.
    pub a: Side,
    /// The test.
    pub b: Side,
    /// B against A; see `rastray_compare` for what each number means and when it misleads.
    pub metrics: Metrics,
    /// Pixels that differ in at least one channel.
    pub pixels_differing: usize,
    /// Values that have no distance to others; null where all are finite.
    pub non_finite: Option<NonFinite>,
    /// Which form of FLIP, from how far.
    pub flip: FlipKind,
    /// How far apart the pictures are under each reading of their values.
    pub readings: Readings,
    /// What was left out of a file or taken in some way.
    pub notes: Vec<String>,
}

/// What is known of one file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Side {
    /// The file as it was named.
    pub file: String,
    /// Such as PNG.
    pub format: &'static str,
    /// Bits of a stored value; null for floats.
    pub bits: Option<u8>,
    /// `linear` or `sRGB`.
    pub encoding: &'static str,
    /// Why that was assumed.
    pub because: String,
    /// Its values were decoded from sRGB, as asked.
    pub decoded: bool,
}

/// How FLIP was computed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FlipKind {
    /// `LDR` or `HDR`.
    pub form: &'static str,
    /// Pixels per degree of visual angle.
    pub ppd: f64,
    /// First and last exposure, as powers of two, and how many; null for LDR.
    pub exposures: Option<(f64, f64, usize)>,
}

/// Root mean squared error under the readings of the stored values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Readings {
    /// Both as they are stored.
    pub as_stored: f64,
    /// A decoded from sRGB, B as stored.
    pub a_decoded: f64,
    /// B decoded from sRGB, A as stored.
    pub b_decoded: f64,
    /// Whose decoding brings them clearly nearer than any other reading; null where none does.
    pub better: Option<Which>,
}

/// The comparison with everything that its folder shows.
#[derive(Clone, Debug)]
pub struct Diff {
    /// Every number.
    pub summary: DiffSummary,
    /// The command line that made it.
    pub command: String,
    a: Plane<[f32; 3]>,
    b: Plane<[f32; 3]>,
    /// B - A, signed.
    difference: Map,
    /// Its magnitude.
    error: Map,
    flip: Map,
}

const DIFFERENCE_NOTE: &str =
    "B − A: orange where B is brighter, blue where it is darker; 1 = full intensity";
const ERROR_NOTE: &str = "magnitude of the same: the lighter, the larger";
const FLIP_NOTE: &str = "what a viewer sees who flips between A and B: black = nothing, 1 = as much as green against blue";

/// Errors that no reading can halve are no matter of encoding; neither are those of 8-bit rounding.
const CLEARLY: f64 = 0.5;
const ROUNDING: f64 = 0.5 / 255.0;

impl Diff {
    /// Compares B, the test, with A, the reference. `command` is shown on the page.
    ///
    /// # Errors
    /// Pictures of different sizes, and a number of pixels per degree outside 1 to 1000.
    pub fn new(
        a: PictureFile,
        b: PictureFile,
        options: Options,
        command: String,
    ) -> Result<Self, Error> {
        check_sizes(&a, &b)?;
        let (mut a, mut b) = (a, b);
        let non_finite = leave_out_non_finite(&mut a.pixels, &mut b.pixels);
        let readings = readings(&a.pixels, &b.pixels);
        let sides = [(&a, Which::A), (&b, Which::B)].map(|(file, which)| Side {
            file: file.name.clone(),
            format: file.format.name(),
            bits: file.bits,
            encoding: file.assumed.encoding.name(),
            because: file.assumed.why.clone(),
            decoded: options.decode == Some(which),
        });
        let light = |file: &PictureFile, side: &Side| {
            let float = file.bits.is_none() && file.assumed.encoding == Encoding::Linear;
            float || side.decoded
        };
        let floats = a.bits.is_none() || b.bits.is_none();
        let range = match floats && light(&a, &sides[0]) && light(&b, &sides[1]) {
            true => DynamicRange::High,
            false => DynamicRange::Low,
        };
        let notes = a.notes.iter().chain(&b.notes).map(|note| note.to_string());
        let notes = notes.collect();
        let [a, b] = [(a, &sides[0]), (b, &sides[1])].map(|(file, side)| match side.decoded {
            true => decoded(&file.pixels),
            false => file.pixels,
        });
        let viewing = Viewing {
            ppd: options.ppd,
            range,
        };
        let any_decoded = sides.iter().any(|side| side.decoded);
        let measured = Measured::new(&a, &b, viewing, any_decoded)?;
        let [side_a, side_b] = sides;
        let exposures = |e: Exposures| (e.start, e.stop, e.count);
        let summary = DiffSummary {
            size: [a.width, a.height],
            a: side_a,
            b: side_b,
            metrics: measured.metrics,
            pixels_differing: measured.pixels_differing
                + non_finite.map_or(0, |n| n.differing - n.also),
            non_finite,
            flip: FlipKind {
                form: if range == DynamicRange::High {
                    "HDR"
                } else {
                    "LDR"
                },
                ppd: options.ppd,
                exposures: measured.exposures.map(exposures),
            },
            readings,
            notes,
        };
        Ok(Self {
            summary,
            command,
            difference: measured.difference,
            error: measured.error,
            flip: measured.flip,
            a,
            b,
        })
    }

    /// All files of the folder, encoded in parallel.
    ///
    /// # Errors
    /// Pictures that are too large to encode.
    pub fn files(&self) -> Result<Vec<File>, Error> {
        type Encode = fn(&Diff) -> Result<Vec<u8>, Error>;
        let jobs: [(&str, Encode); 6] = [
            ("side-by-side.png", |d| png_of_picture(&d.side_by_side()?)),
            ("difference.png", |d| {
                figure(&d.difference, "difference", DIFFERENCE_NOTE)
            }),
            ("error.png", |d| figure(&d.error, "error", ERROR_NOTE)),
            ("flip.png", |d| figure(&d.flip, "FLIP", FLIP_NOTE)),
            ("summary.json", |d| {
                d.summary.to_json().map(String::into_bytes)
            }),
            ("index.html", |d| d.to_html().map(String::into_bytes)),
        ];
        let encoded = jobs.into_par_iter().map(|(name, encode)| {
            let bytes = encode(self)?;
            let name = name.to_owned();
            Ok(File { name, bytes })
        });
        encoded.collect()
    }

    /// A | difference | B.
    fn side_by_side(&self) -> Result<Picture, Error> {
        let shown = |plane| Picture::from_linear(plane, View::Linear);
        let (a, b) = (shown(&self.a)?, shown(&self.b)?);
        let difference = Picture::from_map(&self.difference);
        let panel = |picture, title, note| Panel {
            picture,
            title,
            note,
        };
        let summary = &self.summary;
        strip(&[
            panel(&a, "A", &summary.a.file),
            panel(&difference, "difference", DIFFERENCE_NOTE),
            panel(&b, "B", &summary.b.file),
        ])
    }
}

/// A map with its legend, as PNG.
fn figure(of: &Map, title: &str, note: &str) -> Result<Vec<u8>, Error> {
    let picture = &Picture::from_map(of);
    png_of_picture(&map(Panel {
        picture,
        title,
        note,
    })?)
}

fn check_sizes(a: &PictureFile, b: &PictureFile) -> Result<(), Error> {
    let size = |file: &PictureFile| (file.pixels.width, file.pixels.height);
    let ((w, h), (v, g)) = (size(a), size(b));
    if (w, h) == (v, g) {
        return Ok(());
    }
    let message = format!(
        "{} is {v} x {g} pixels, but {} is {w} x {h}",
        b.name, a.name
    );
    Err(Error::input(Place::file(&b.name), message)
        .with_help("nothing is resized here: render or crop one of them to the size of the other"))
}

/// What comes of the planes.
struct Measured {
    metrics: Metrics,
    pixels_differing: usize,
    exposures: Option<Exposures>,
    difference: Map,
    error: Map,
    flip: Map,
}

impl Measured {
    /// `decoded`: the planes hold light, which a screen shows encoded.
    fn new(
        a: &Plane<[f32; 3]>,
        b: &Plane<[f32; 3]>,
        viewing: Viewing,
        decoded: bool,
    ) -> Result<Self, Error> {
        let refused = |e: CompareError| match e {
            e @ CompareError::PixelsPerDegree { .. } => Error::parameter("--ppd", e.to_string()),
            e => Error::limit(format!("cannot compare the pictures: {e}")),
        };
        let measure = || {
            let (reference, test) = (stored(a)?, stored(b)?);
            let both = Comparison::new(&test, &reference, viewing)?;
            let mut metrics = both.metrics();
            let mut flip = both.flip().clone();
            if decoded && viewing.range == DynamicRange::Low {
                let (a, b) = (encoded(a), encoded(b));
                flip = rastray_compare::flip(&stored(&b)?, &stored(&a)?, viewing)?;
                metrics.flip = flip.summary();
            }
            let differences = rastray_compare::differences(&test, &reference)?;
            let (w, h, largest) = (a.width, a.height, Reduction::Largest);
            Ok(Self {
                metrics,
                pixels_differing: pixels_differing(&test, &reference)?,
                exposures: flip.exposures,
                difference: signed_map(w, h, &differences, largest)?,
                error: magnitude_map(w, h, &differences, largest)?,
                flip: flip_map(&flip)?,
            })
        };
        measure().map_err(refused)
    }
}

/// Stored values, to be compared with stored values: see the head of the module.
fn stored(plane: &Plane<[f32; 3]>) -> Result<ImageView<'_>, CompareError> {
    ImageView::new(plane.width, plane.height, &plane.data, Encoding::Linear)
}

/// The values decoded from sRGB; beyond [0, 1] the curve goes on, and negative values mirror it.
fn decoded(plane: &Plane<[f32; 3]>) -> Plane<[f32; 3]> {
    plane.map(|p| p.map(|x| (linear_from_srgb(f64::from(x.abs())) as f32).copysign(x)))
}

/// Light as the values that a screen is given.
fn encoded(plane: &Plane<[f32; 3]>) -> Plane<[f32; 3]> {
    plane.map(|p| p.map(|x| srgb_from_linear(f64::from(x.clamp(0.0, 1.0))) as f32))
}

/// Counts values that are not finite, and sets them to 0 in both pictures, so that the rest can be measured; none where
/// there are none.
fn leave_out_non_finite(a: &mut Plane<[f32; 3]>, b: &mut Plane<[f32; 3]>) -> Option<NonFinite> {
    let mut found = NonFinite::default();
    for (a, b) in a.data.iter_mut().zip(&mut b.data) {
        let bad = |p: &[f32; 3]| p.iter().any(|v| !v.is_finite());
        found.a += usize::from(bad(a));
        found.b += usize::from(bad(b));
        let (mut differs, mut finite_differs) = (false, false);
        for (a, b) in a.iter_mut().zip(b.iter_mut()) {
            if a.is_finite() && b.is_finite() {
                finite_differs |= a != b;
                continue;
            }
            differs |= !(a.is_nan() && b.is_nan() || *a == *b);
            (*a, *b) = (0.0, 0.0);
        }
        // A pixel that differs elsewhere, too, is counted there.
        found.differing += usize::from(differs);
        found.also += usize::from(differs && finite_differs);
    }
    (found != NonFinite::default()).then_some(found)
}

/// The distances under each reading.
fn readings(a: &Plane<[f32; 3]>, b: &Plane<[f32; 3]>) -> Readings {
    let as_stored = rmse(a, b);
    let (a_decoded, b_decoded) = (rmse(&decoded(a), b), rmse(a, &decoded(b)));
    let (nearest, which) = match a_decoded < b_decoded {
        true => (a_decoded, Which::A),
        false => (b_decoded, Which::B),
    };
    let clear = as_stored > ROUNDING && nearest < CLEARLY * as_stored;
    Readings {
        as_stored,
        a_decoded,
        b_decoded,
        better: clear.then_some(which),
    }
}

/// Root mean squared error of stored values.
fn rmse(a: &Plane<[f32; 3]>, b: &Plane<[f32; 3]>) -> f64 {
    let rows = a.data.chunks(a.width).zip(b.data.chunks(b.width));
    rastray_compare::rmse(rows.map(|(a, b)| {
        let pairs = a.as_flattened().iter().zip(b.as_flattened());
        pairs.map(|(a, b)| f64::from(*a) - f64::from(*b))
    }))
}

impl DiffSummary {
    /// The file's text: indented, a newline at the end.
    ///
    /// # Errors
    /// [`Error::Limit`] where a number is not one that JSON can hold.
    pub fn to_json(&self) -> Result<String, Error> {
        serde_json::to_string_pretty(self)
            .map(|text| text + "\n")
            .map_err(|e| Error::limit(format!("cannot write the numbers as JSON: {e}")))
    }

    /// The report for a terminal.
    pub fn to_text(&self) -> String {
        let mut text = format!(
            "A  {}\nB  {}\n\n{}\n",
            self.a.describe(),
            self.b.describe(),
            self.verdict()
        );
        if self.pixels_differing > 0 {
            text.push('\n');
            for [name, number, meaning] in self.rows() {
                // Widths count characters; numbers hold none that are wider or narrower than one.
                text += &format!("  {name:<12} {number:>10}   {meaning}\n");
            }
        }
        if let Some(advice) = self.advice() {
            text += &format!("\n{advice}\n");
        }
        text
    }

    /// How much differs, in a sentence.
    pub fn verdict(&self) -> String {
        let [w, h] = self.size;
        let verdict = match self.pixels_differing {
            0 => format!("The pictures are the same: all values of {w} x {h} pixels are equal."),
            n => format!(
                "{} of {} pixels ({}) differ; B - A is at most {}, rmse {}.",
                count(n),
                count(w * h),
                percent(n, w * h),
                value(self.metrics.max),
                value(self.metrics.rmse)
            ),
        };
        match self.non_finite {
            None => verdict,
            Some(found) => format!(
                "{verdict} {} pixels of A and {} of B hold NaN or infinity, which the numbers leave out; at {} of them the \
                 other picture holds something else.",
                count(found.a),
                count(found.b),
                count(found.differing)
            ),
        }
    }

    /// Each number with what it means, once.
    pub(super) fn rows(&self) -> Vec<[String; 3]> {
        let m = &self.metrics;
        let decibel = |x: f64| format!("{x:.2} dB");
        let flip = match self.flip.exposures {
            None => format!("FLIP at {} pixels per degree", self.flip.ppd),
            Some((_, _, n)) => format!(
                "HDR-FLIP at {} pixels per degree, the worst of {n} exposures",
                self.flip.ppd
            ),
        };
        let rows = [
            (
                "rmse",
                value(m.rmse),
                "root of the mean squared error of all values; 1 = full intensity".to_owned(),
            ),
            ("mse", value(m.mse), "its square".to_owned()),
            (
                "mae",
                value(m.mae),
                "mean of the absolute errors".to_owned(),
            ),
            (
                "max",
                value(m.max),
                "largest absolute error of a value".to_owned(),
            ),
            (
                "p50",
                value(m.p50),
                "half of the values are off by no more than this".to_owned(),
            ),
            ("p95", value(m.p95), "95 % of the values are".to_owned()),
            ("p99", value(m.p99), "99 % of the values are".to_owned()),
            (
                "psnr",
                m.psnr.map_or("none".into(), decibel),
                "10 log10(1 / mse): 20 dB is rmse 0.1, 40 dB is rmse 0.01".to_owned(),
            ),
            (
                "ssim",
                m.ssim.map_or("none".into(), value),
                "structure: 1 = the same, 0 = nothing in common; none below 11 x 11 pixels"
                    .to_owned(),
            ),
            (
                "flip mean",
                value(m.flip.mean),
                format!("what a viewer sees who flips between them, 0 to 1: {flip}"),
            ),
            (
                "flip median",
                value(m.flip.median),
                "half of the pixels show no more than this".to_owned(),
            ),
            (
                "flip max",
                value(m.flip.max),
                "the pixel that shows most".to_owned(),
            ),
        ];
        rows.map(|(name, number, meaning)| [name.to_owned(), number, meaning])
            .into()
    }

    /// What another reading of the values would change, where that is clear.
    pub fn advice(&self) -> Option<String> {
        let r = &self.readings;
        let (which, other, nearer) = match r.better? {
            Which::A => (Which::A, Which::B, r.a_decoded),
            Which::B => (Which::B, Which::A, r.b_decoded),
        };
        let (which, other) = (which.name(), other.name());
        let done = self.a.decoded || self.b.decoded;
        let next = match done {
            true => String::new(),
            false => format!(" Compare again with --decode {}.", which.to_lowercase()),
        };
        Some(format!(
            "Encoding: with the values of {which} decoded from sRGB, rmse is {} instead of {} as stored: {which} seems to hold \
             sRGB values, and {other} linear ones.{next}",
            value(nearer),
            value(r.as_stored)
        ))
    }
}

impl Side {
    /// "ball.png: PNG, 8 bits; values taken for sRGB (the file does not say)".
    pub fn describe(&self) -> String {
        let bits = match self.bits {
            Some(bits) => format!("{bits} bits a value"),
            None => "floats".to_owned(),
        };
        let decoded = if self.decoded {
            ", decoded here as asked"
        } else {
            ""
        };
        format!(
            "{}: {}, {bits}; assumed {} ({}){decoded}",
            self.file, self.format, self.encoding, self.because
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::picture;

    fn pgm(name: &str, f: impl Fn(usize) -> u8) -> PictureFile {
        let mut bytes = b"P5 16 12 255\n".to_vec();
        bytes.extend((0..16 * 12).map(f));
        picture::decode(name, &bytes, None).unwrap()
    }

    fn diff(a: PictureFile, b: PictureFile, decode: Option<Which>) -> Diff {
        let options = Options { ppd: 67.02, decode };
        Diff::new(a, b, options, "rastray diff a b".to_owned()).unwrap()
    }

    #[test]
    fn another_encoding_is_noticed_and_others_are_not() {
        let encode = |i: usize| {
            let linear = i as f64 / 191.0;
            (crate::math::color::srgb_from_linear(linear) * 255.0).round() as u8
        };
        let linear = |i: usize| (i as f64 / 191.0 * 255.0).round() as u8;
        let found = diff(pgm("a", linear), pgm("b", encode), None).summary;
        assert_eq!(found.readings.better, Some(Which::B));
        assert!(found.advice().unwrap().contains("--decode b"));
        let found = diff(pgm("a", encode), pgm("b", linear), None).summary;
        assert_eq!(found.readings.better, Some(Which::A));
        // Decoded as asked, they are the same within rounding, and nothing more is advised.
        let found = diff(pgm("a", encode), pgm("b", linear), Some(Which::A)).summary;
        assert!(found.metrics.max < 1.5 / 255.0, "{}", found.metrics.max);
        assert!(!found.advice().unwrap().contains("--decode"));
        // A picture that is only darker, and one that is the same.
        for b in [pgm("b", |i| linear(i) / 2), pgm("b", linear)] {
            assert_eq!(diff(pgm("a", linear), b, None).summary.advice(), None);
        }
    }

    #[test]
    fn the_difference_is_b_minus_a() {
        let found = diff(pgm("a", |_| 100), pgm("b", |_| 151), None);
        assert!((found.difference.summary.sum[0] - 192.0 * 0.2).abs() < 1e-12);
        assert_eq!(found.summary.pixels_differing, 192);
        let json: serde_json::Value =
            serde_json::from_str(&found.summary.to_json().unwrap()).unwrap();
        assert!((json["metrics"]["rmse"].as_f64().unwrap() - 0.2).abs() < 1e-12);
        assert_eq!(json["pixels_differing"], 192);
    }

    #[test]
    fn sizes_must_match() {
        let small = picture::decode("small.ppm", b"P3 2 1 255 1 2 3 4 5 6", None).unwrap();
        let options = Options {
            ppd: 67.02,
            decode: None,
        };
        let error = Diff::new(pgm("a.pgm", |_| 0), small, options, String::new()).unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("small.ppm is 2 x 1 pixels, but a.pgm is 16 x 12"),
            "{text}"
        );
    }
}
