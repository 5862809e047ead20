//! The conformance adapter: answers reference cases by calling the functions that the renderers call.
//!
//! `probe cases --cases FILE.json[.gz] --precision f32|f64`, `probe gl-lights --precision f32|f64 < light-cases.jsonl`,
//! `probe lighting < cases.jsonl`, `probe trace < rays.jsonl`, `probe requirements < requirements.json`,
//! `probe gl-scene SCENE.json[.gz] -o PREFIX --shading flat|gouraud|phong`, `probe lighting-bench ROW TIMES`. Answers go to
//! standard output, one JSON value a line, those of `gl-scene` to files; errors to standard error, exit code 2.

mod gl_lights;
mod gl_scene;
mod lighting_bench;
mod numerics;
mod rays;
mod requirements;
mod trace;

use std::io::{Read, Write};
use std::process::ExitCode;

use rastray::render::Precision;
use rastray::scene::Snap;

/// Anything that stops the program, as one sentence.
type Failure = Box<dyn std::error::Error>;

const USAGE: &str = "usage: probe cases --cases FILE.json[.gz] --precision f32|f64 [--snap 8|12|exact]
       probe gl-lights --precision f32|f64 < light-cases.jsonl
       probe gl-scene SCENE.json[.gz] -o PREFIX --shading flat|gouraud|phong [--precision f32|f64] [--snap 8|12|exact]
       probe lighting < cases.jsonl
       probe trace [--precision f32|f64] < rays.jsonl
       probe requirements < requirements.json
       probe lighting-bench ROW TIMES";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("probe: {failure}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> Result<(), Failure> {
    let command = arguments.first().map_or("", String::as_str);
    match command {
        "gl-scene" => return gl_scene(arguments),
        "trace" => return trace(arguments),
        _ => {}
    }
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    match (command, precision(arguments)?) {
        ("cases", Precision::F32) => {
            let (text, snap) = (cases_file(arguments)?, snap(arguments)?);
            numerics::answer::<f32>(&text, snap, rays::answer::<f32>, &mut out)?
        }
        ("cases", Precision::F64) => {
            let (text, snap) = (cases_file(arguments)?, snap(arguments)?);
            numerics::answer::<f64>(&text, snap, rays::answer::<f64>, &mut out)?
        }
        ("gl-lights", Precision::F32) => each_line(&mut out, gl_lights::answer::<f32>)?,
        ("gl-lights", Precision::F64) => each_line(&mut out, gl_lights::answer::<f64>)?,
        ("lighting", _) => each_line(&mut out, gl_lights::terms)?,
        ("lighting-bench", _) => {
            let [row, times] = [1, 2].map(|i| arguments.get(i).map_or("", String::as_str));
            writeln!(out, "{}", lighting_bench::run(row, times)?)?;
        }
        ("requirements", _) => {
            let text = std::io::read_to_string(std::io::stdin())?;
            writeln!(out, "{}", requirements::answer(&text)?)?;
        }
        _ => return Err(USAGE.into()),
    }
    out.flush()?;
    Ok(())
}

/// Traces the rays of standard input; those that cannot be traced are told in their lines, and at the end.
fn trace(arguments: &[String]) -> Result<(), Failure> {
    let precision = precision(arguments)?;
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let good = trace::answer(std::io::stdin().lock(), precision, &mut out)?;
    out.flush()?;
    if good {
        Ok(())
    } else {
        Err("some rays could not be traced: see their lines".into())
    }
}

/// Draws a scene into the files of a prefix; f32, as OpenGL computes, unless told otherwise.
fn gl_scene(arguments: &[String]) -> Result<(), Failure> {
    let path = arguments.get(1).ok_or(USAGE)?;
    let prefix = option(arguments, "-o").ok_or(USAGE)?;
    let shading = gl_scene::shading(option(arguments, "--shading").ok_or(USAGE)?)?;
    let folder = std::path::Path::new(path).parent().unwrap_or("".as_ref());
    let text = file(path)?;
    let stated = option(arguments, "--precision").is_some();
    let precision = match precision(arguments)? {
        Precision::F64 if stated => Precision::F64,
        _ => Precision::F32,
    };
    let buffers = gl_scene::draw(&text, folder, shading, precision, snap(arguments)?);
    buffers.map_err(|e| format!("{path}: {e}"))?.write(prefix)
}

fn snap(arguments: &[String]) -> Result<Snap, Failure> {
    match option(arguments, "--snap") {
        None | Some("8") => Ok(Snap::Bits8),
        Some("12") => Ok(Snap::Bits12),
        Some("exact") => Ok(Snap::Exact),
        Some(other) => Err(format!("--snap: expected 8, 12 or exact, found {other:?}").into()),
    }
}

/// The value after a flag.
fn option<'a>(arguments: &'a [String], flag: &str) -> Option<&'a str> {
    let at = arguments.iter().position(|a| a == flag)?;
    arguments.get(at + 1).map(String::as_str)
}

fn precision(arguments: &[String]) -> Result<Precision, Failure> {
    match option(arguments, "--precision") {
        Some("f32") => Ok(Precision::F32),
        Some("f64") | None => Ok(Precision::F64),
        Some(other) => Err(format!("--precision: expected f32 or f64, found {other:?}").into()),
    }
}

/// The text of `--cases FILE`.
fn cases_file(arguments: &[String]) -> Result<String, Failure> {
    file(option(arguments, "--cases").ok_or(USAGE)?)
}

/// The text of a file, unpacked where its name says so.
fn file(path: &str) -> Result<String, Failure> {
    let bytes = std::fs::read(path).map_err(|e| format!("{path}: {e}"))?;
    let mut text = String::new();
    if path.ends_with(".gz") {
        flate2::read::GzDecoder::new(&bytes[..]).read_to_string(&mut text)?;
    } else {
        text = String::from_utf8(bytes)?;
    }
    Ok(text)
}

/// Answers every line of standard input with a line.
fn each_line(
    out: &mut impl Write,
    answer: fn(&str) -> Result<serde_json::Value, Failure>,
) -> Result<(), Failure> {
    for (number, line) in std::io::stdin().lines().enumerate() {
        let line = line?;
        if line.trim().is_empty() {
            continue;
        }
        let value = answer(&plain_json(&line)).map_err(|e| format!("line {}: {e}", number + 1))?;
        writeln!(out, "{value}")?;
    }
    Ok(())
}

/// The line with NaN, Infinity and -Infinity, which some writers leave outside strings, as null: JSON has no word for
/// them, and only figures about the case, not its inputs, are ever such.
fn plain_json(line: &str) -> String {
    let mut out = String::with_capacity(line.len());
    for (i, part) in line.split('"').enumerate() {
        if i > 0 {
            out.push('"');
        }
        // Every second part stands inside quotes (the cases escape none).
        if i % 2 == 1 {
            out.push_str(part);
        } else {
            let part = part.replace("-Infinity", "null");
            out.push_str(&part.replace("Infinity", "null").replace("NaN", "null"));
        }
    }
    out
}

/// A number as the reference data writes it: what JSON has no number for is a string.
fn number(x: f64) -> serde_json::Value {
    if x.is_finite() {
        x.into()
    } else if x.is_nan() {
        "nan".into()
    } else if x > 0.0 {
        "inf".into()
    } else {
        "-inf".into()
    }
}
