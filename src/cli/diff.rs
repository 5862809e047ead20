//! `rastray diff A B`: two picture files, whoever made them.

use std::cell::Cell;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use rastray::error::Error;
use rastray::import::picture::{self, ReadOptions};
use rastray::report::diff::{Diff, DiffSummary, Options, Which};
use rastray::report::files;
use rastray_compare::DEFAULT_PPD;

use super::args::FollowArgs;
use super::commands::command_line;
use super::options::Verbosity;
use super::watch::{Made, follow};
use super::{commands, diagnostic};

/// What `--help` ends with.
pub(super) const EXAMPLES: &str = "Examples:
  rastray diff expected.png mine.png
  rastray diff expected.png mine.png -o differs     strip, maps and a page, into differs/
  rastray diff expected.png mine.png --max-error 0.02 --min-psnr 30 --max-flip 0.05
  rastray diff expected.exr mine.exr --layer diffuse.lamp --json
  rastray diff expected.png mine.png --decode b     where mine.png holds sRGB values and expected.png linear ones

A is the reference, B the test: difference = B - A. The files' first bytes say what they
are: PNG, JPEG, BMP, PPM, PGM, PFM, HDR, EXR. Values are compared as stored: integers as
fractions of the largest one, floats as they are. FLIP looks at the 8-bit pictures as a
screen shows them, decoded values encoded again; where both files hold floats, HDR-FLIP
looks at the light.

Exit codes: 0 done, 1 over --max-error, --min-psnr or --max-flip, 2 error.
--max-error 0 asks for the same values.";

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum WhichArg {
    A,
    B,
}

#[derive(Debug, Args)]
pub(super) struct DiffArgs {
    /// The picture that is trusted
    #[arg(value_name = "A")]
    a: PathBuf,
    /// The picture that is judged
    #[arg(value_name = "B")]
    b: PathBuf,
    /// Write strip, maps, summary.json and a page into this folder
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Exit 1 where a value differs by more than this (1 = full intensity)
    #[arg(long, value_name = "ERROR", allow_negative_numbers = true)]
    max_error: Option<f64>,
    /// Exit 1 where PSNR is below this, in dB
    #[arg(long, value_name = "DB", allow_negative_numbers = true)]
    min_psnr: Option<f64>,
    /// Exit 1 where the mean FLIP error is above this (0 to 1)
    #[arg(long, value_name = "ERROR", allow_negative_numbers = true)]
    max_flip: Option<f64>,
    /// Pixels per degree of visual angle, for FLIP: 67.02 is 0.7 m from a 4K screen 0.7 m wide
    #[arg(long, value_name = "N", default_value_t = DEFAULT_PPD)]
    ppd: f64,
    /// Decode the values of A or B from sRGB before they are compared
    #[arg(long, value_enum, value_name = "WHICH")]
    decode: Option<WhichArg>,
    /// Count values that are NaN or infinite instead of refusing them: same place and kind = equal
    #[arg(long)]
    nan: bool,
    /// Turn pictures as their EXIF orientation says
    #[arg(long)]
    orient: bool,
    /// Compare this layer, part or view of .exr files, such as diffuse.key
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,
    #[command(flatten)]
    follow: FollowArgs,
    /// Print the numbers as JSON
    #[arg(long)]
    json: bool,
}

/// Exit code 1 where a threshold was asked for and is exceeded.
pub(super) fn diff(args: &DiffArgs, verbosity: Verbosity) -> Result<ExitCode, Error> {
    check(args)?;
    let over = Cell::new(false);
    let first = args.a.display().to_string();
    follow(args.follow, &first, verbosity, || {
        let (made, exceeded) = once(args, verbosity)?;
        over.set(exceeded);
        Ok(made)
    })?;
    Ok(ExitCode::from(u8::from(over.get())))
}

/// Refuses flags that make no sense, before any file is read.
fn check(args: &DiffArgs) -> Result<(), Error> {
    let thresholds = [
        ("--max-error", args.max_error),
        ("--min-psnr", args.min_psnr),
        ("--max-flip", args.max_flip),
    ];
    for (flag, asked) in thresholds {
        if let Some(value) = asked.filter(|v| v.is_nan() || *v < 0.0) {
            return Err(Error::parameter(
                flag,
                format!("{value}: expected 0 or more"),
            ));
        }
    }
    if let Some(value) = args.max_flip.filter(|v| *v > 1.0) {
        let message = format!("{value}: expected 0 to 1; FLIP is never above 1");
        return Err(Error::parameter("--max-flip", message));
    }
    match &args.output {
        Some(folder) => files::check_folder(folder, "--output"),
        None if args.follow.open => {
            let error = Error::parameter("--open", "there is nothing to show without a folder");
            Err(error.with_help("add -o FOLDER"))
        }
        None => Ok(()),
    }
}

fn once(args: &DiffArgs, verbosity: Verbosity) -> Result<(Made, bool), Error> {
    let options = ReadOptions {
        layer: args.layer.as_deref(),
        orient: args.orient,
        non_finite: args.nan,
    };
    let read = |path: &PathBuf| picture::read_with(path, options);
    let (a, b) = (read(&args.a)?, read(&args.b)?);
    if verbosity != Verbosity::Quiet {
        a.notes.iter().chain(&b.notes).for_each(diagnostic::note);
    }
    let options = Options {
        ppd: args.ppd,
        decode: args.decode.map(|which| match which {
            WhichArg::A => Which::A,
            WhichArg::B => Which::B,
        }),
    };
    let diff = Diff::new(a, b, options, command_line())?;
    let mut result = args.a.clone();
    if let Some(folder) = &args.output {
        let all = diff.files()?;
        files::create_folder(folder)?;
        for file in &all {
            files::write_bytes_atomic(&folder.join(&file.name), &file.bytes)?;
        }
        result = folder.join("index.html");
    }
    if args.json {
        commands::print(&diff.summary.to_json()?)?;
    } else {
        commands::print(&diff.summary.to_text())?;
    }
    let exceeded = exceeded(args, &diff.summary);
    for line in &exceeded {
        verbosity.say(line);
    }
    if args.output.is_some() {
        verbosity.say(result.display());
    }
    let made = Made {
        inputs: vec![args.a.clone(), args.b.clone()],
        result,
    };
    Ok((made, !exceeded.is_empty()))
}

/// The thresholds that were asked for and are exceeded, in words.
fn exceeded(args: &DiffArgs, summary: &DiffSummary) -> Vec<String> {
    let m = &summary.metrics;
    let mut lines = Vec::new();
    let mut above = |flag: &str, what: &str, found: f64, asked: Option<f64>| {
        if let Some(asked) = asked.filter(|asked| found > *asked) {
            // All digits, for thresholds that are nearly met.
            lines.push(format!("over {flag} {asked}: {what} is {found}"));
        }
    };
    let elsewhere = summary.non_finite.is_some_and(|n| n.differing > 0);
    let largest = if elsewhere { f64::INFINITY } else { m.max };
    above("--max-error", "the largest error", largest, args.max_error);
    above(
        "--max-flip",
        "the mean FLIP error",
        m.flip.mean,
        args.max_flip,
    );
    if let (Some(asked), Some(found)) = (args.min_psnr.or(args.max_flip), summary.non_finite)
        && found.differing > 0
        && args.max_error.is_none()
    {
        let what = format!(
            "{} pixels hold NaN or infinity in one picture only",
            found.differing
        );
        lines.push(format!("over a threshold of {asked}: {what}"));
    }
    // Without a PSNR the pictures are the same, and nothing asks for more.
    if let Some((asked, found)) = args
        .min_psnr
        .zip(m.psnr)
        .filter(|(asked, found)| found < asked)
    {
        lines.push(format!("below --min-psnr {asked}: PSNR is {found} dB"));
    }
    lines
}
