//! `rastray check`: somebody's own picture of a scene, right or explained by a mistake.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use rastray::check::{self, Finding, Given, Mistake, Mode, Options, Report, Telling, Verdict};
use rastray::error::Error;
use rastray::import::{self, Imported, picture};
use rastray::render::{self, Renderer};
use rastray::report::checked::{Checked, verdict_name};
use rastray::report::files;
use rastray::report::formats::png_of_picture;
use rastray::report::numbers::{count, value};
use serde_json::{Value, json};

use super::args::{QualityArgs, SceneArgs, ShadingArg, renderer};
use super::options::{Verbosity, apply};
use super::progress::Progress;
use super::{commands, diagnostic};

pub(super) const EXAMPLES: &str = "Examples:
  rastray render whitted -o mine.png --mode trace --size 160x120
  rastray check whitted mine.png              right or not, and why
  rastray check whitted mine.png --mode trace -o strip.png
  rastray check whitted mine.png --json

Exit codes: 0 the picture is right, 1 it is not, 2 error.";

#[derive(Debug, Args)]
// Parsed only to be refused with a reason.
#[command(mut_arg("size", |size| size.hide(true)))]
pub(super) struct CheckArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// The picture: PNG, JPEG, BMP, PPM, PGM, PFM, HDR or OpenEXR; the scene is drawn at its size
    #[arg(value_name = "IMAGE")]
    pub(super) image: PathBuf,
    /// What the picture is meant to be: raster, cast, trace (default: found by looking)
    #[arg(long, value_parser = renderer(), value_name = "MODE", hide_possible_values = true)]
    pub(super) mode: Option<Renderer>,
    /// Given, with the mistake, right, and their differences: one .png, or a folder
    #[arg(short, long, value_name = "PATH")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    pub(super) quality: QualityArgs,
    /// Print the report as JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Exit code 0 where the picture is right, else 1.
pub(super) fn check(args: &CheckArgs, verbosity: Verbosity) -> Result<ExitCode, Error> {
    refuse(args)?;
    check_output(args.output.as_deref())?;
    let file = picture::read(&args.image, None)?;
    for note in file.notes.iter().filter(|_| verbosity != Verbosity::Quiet) {
        diagnostic::note(note);
    }
    let given = Given::from(file);
    let mut imported = commands::load(&args.scene, &[], verbosity)?;
    imported.resize(given.color.width as u32, given.color.height as u32);
    let render = apply(&args.quality, &mut imported)?;
    let options = options(args, render);
    let report = checked(&imported, &given, &options, verbosity)?;
    let both = Checked {
        report: &report,
        given: &given,
    };
    if let Some(path) = &args.output {
        write(path, &both, args)?;
    }
    if args.json {
        commands::print_json(&as_json(&report, args))?;
    } else {
        let columns = diagnostic::width(std::io::stdout())
            .unwrap_or(100)
            .clamp(60, 100);
        commands::print(
            &Told {
                report: &report,
                args,
                lossy: given.lossy,
                columns,
            }
            .text(),
        )?;
    }
    if let Some(path) = &args.output {
        verbosity.say(path.display());
    }
    Ok(ExitCode::from(u8::from(report.verdict != Verdict::Right)))
}

/// What is asked for in vain, and a picture and a scene that have changed places.
fn refuse(args: &CheckArgs) -> Result<(), Error> {
    if args.quality.size.is_some() {
        let message = "the scene is drawn at the size of the picture";
        return Err(Error::parameter("--size", message).with_help("leave it out"));
    }
    let rays = match args.mode {
        Some(by @ (Renderer::Cast | Renderer::Trace)) => Some(by.name()),
        Some(Renderer::Raster) | None => None,
    };
    if let (Some(rays), Some(_)) = (rays, args.quality.shading) {
        let message = format!("a shading is the rasterizer's, and --mode {rays} asks for rays");
        let help = "leave out one of the two, or say --mode raster";
        return Err(Error::parameter("--shading", message).with_help(help));
    }
    let image = args.image.to_string_lossy();
    let is_scene = import::shipped().iter().any(|s| s.name == image);
    if is_scene && !args.image.is_file() {
        let message = format!("{image}: there is no such file, but a scene of that name");
        let scene = quote(&args.scene.scene);
        let help = format!("the scene comes first: rastray check {image} {scene}");
        return Err(Error::parameter("IMAGE", message).with_help(help));
    }
    Ok(())
}

fn is_png(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("png"))
}

/// Endings of pictures and pages: a folder that is to be made is hardly meant to have one.
const OTHER_ENDINGS: [&str; 17] = [
    "jpg", "jpeg", "bmp", "ppm", "pgm", "pnm", "pfm", "hdr", "exr", "gif", "tif", "tiff", "webp",
    "svg", "html", "htm", "pdf",
];

/// `-`, or what is named like a file that `check` does not write.
fn is_other_file(path: &Path) -> bool {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    path.as_os_str() == "-" || ending.is_some_and(|e| OTHER_ENDINGS.contains(&e.as_str()))
}

fn check_output(output: Option<&Path>) -> Result<(), Error> {
    match output {
        None => Ok(()),
        Some(path) if is_png(path) => files::check_target(path, "--output"),
        Some(path) if is_other_file(path) && !path.is_dir() => {
            let expected = "expected a .png file or the name of a folder";
            let message = format!("{}: {expected}", path.display());
            Err(Error::parameter("--output", message).with_help("for example -o check.png"))
        }
        Some(path) => files::check_folder(path, "--output"),
    }
}

fn options(args: &CheckArgs, render: render::Options) -> Options {
    let shaded = |mode: &Mode| match args.quality.shading {
        None => true,
        Some(shading) => {
            *mode
                == match shading {
                    ShadingArg::Flat => Mode::Flat,
                    ShadingArg::Gouraud => Mode::Gouraud,
                    ShadingArg::Phong => Mode::Phong,
                }
        }
    };
    let meant = |mode: &Mode| match args.mode {
        // A shading is the rasterizer's.
        None => args.quality.shading.is_none() || mode.shading().is_some(),
        Some(by) => mode.renderer() == by,
    };
    let wanted = |mode: &Mode| meant(mode) && (mode.shading().is_none() || shaded(mode));
    Options {
        modes: Mode::ALL.into_iter().filter(wanted).collect(),
        render,
        srgb: args.quality.srgb,
    }
}

fn checked(
    imported: &Imported,
    given: &Given,
    options: &Options,
    verbosity: Verbosity,
) -> Result<Report, Error> {
    // The bar learns its length from the first step.
    let bar = std::sync::OnceLock::new();
    let progress = |done: u64, steps: u64, name: &str| {
        bar.get_or_init(|| Progress::new(verbosity, steps))
            .step(done, name);
    };
    check::check(&imported.scene, given, options, &progress)
}

fn write(path: &Path, both: &Checked<'_>, args: &CheckArgs) -> Result<(), Error> {
    if is_png(path) {
        return files::write_bytes_atomic(path, &png_of_picture(&both.strip()?)?);
    }
    let made = both.files()?;
    let report = format!("{:#}\n", as_json(both.report, args));
    files::create_folder(path)?;
    for file in &made {
        files::write_bytes_atomic(&path.join(&file.name), &file.bytes)?;
    }
    files::write_bytes_atomic(&path.join("check.json"), report.as_bytes())
}

/// A word of a command line.
fn quote(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+".contains(c);
    if word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{word}'")
    }
}

/// The line that explains a pixel.
fn explain(args: &CheckArgs, report: &Report, telling: &Telling) -> String {
    let [width, height] = report.size;
    let scene = quote(&args.scene.scene);
    let mut line = format!(
        "rastray explain {scene} {} {} --size {width}x{height}",
        telling.x, telling.y
    );
    for set in &args.scene.sets {
        line += &format!(" --set {}", quote(set));
    }
    line
}

/// A report in words.
struct Told<'a> {
    report: &'a Report,
    args: &'a CheckArgs,
    /// The file was compressed with a loss.
    lossy: bool,
    columns: usize,
}

impl Told<'_> {
    fn text(&self) -> String {
        let r = self.report;
        let mut text = format!(
            "{}: {}x{}, held against {} pictures of {}\n\n",
            self.args.image.display(),
            r.size[0],
            r.size[1],
            count(r.pictures),
            self.args.scene.scene
        );
        text += &match r.verdict {
            Verdict::Right => self.right(),
            Verdict::Mistake => self.mistake(),
            Verdict::Unexplained => self.unexplained(),
        };
        text + &self.right_as() + &self.cannot_show()
    }

    fn paragraph(&self, indent: usize, words: &str) -> String {
        let lines = diagnostic::wrap(words, Some(self.columns), indent);
        let lines = lines.lines().map(|line| format!("{:indent$}{line}\n", ""));
        lines.collect()
    }

    fn right(&self) -> String {
        let r = self.report;
        let mut words = format!(
            "The picture is right, within rmse {}: it is {}.",
            value(r.error),
            r.mode.describe()
        );
        if !r.also.is_empty() {
            let also: Vec<&str> = r.also.iter().map(|m| m.describe()).collect();
            words += &format!(" On this scene that is the same as {}.", also.join("; "));
        }
        let mut text = self.paragraph(0, &words);
        text += &format!("Largest difference of a value: {}.\n", value(r.largest));
        if !r.findings.is_empty() {
            text += "\nHad it been meant for something else, it would have this mistake:\n";
            for f in &r.findings {
                text +=
                    &self.paragraph(2, &format!("As {}: {}", f.mode.describe(), f.mistake.title));
            }
        }
        text
    }

    fn mistake(&self) -> String {
        let r = self.report;
        let Some(best) = r.findings.first() else {
            return String::new();
        };
        let mut text = self.paragraph(0, &explained(r.mode, best));
        text += &self.finding(1, best, true);
        let (tied, rest): (Vec<&Finding>, Vec<&Finding>) =
            r.findings[1..].iter().partition(|f| f.tied);
        if !tied.is_empty() {
            text += "\nOn this scene these cannot be told from it:\n";
        }
        for (i, f) in tied.iter().enumerate() {
            text += &self.finding(2 + i, f, true);
        }
        if !rest.is_empty() {
            text += "\nLess of it is explained by:\n";
        }
        for (i, f) in rest.iter().enumerate() {
            text += &self.finding(2 + tied.len() + i, f, false);
        }
        text += &format!(
            "\nError (rmse of the stored values): {} against the right picture, {} with the mistake.\n",
            value(r.error),
            value(best.error)
        );
        text + &self.telling()
    }

    fn finding(&self, number: usize, f: &Finding, full: bool) -> String {
        let mut heading = format!(
            "{}  (removes {} of the error",
            f.mistake.title,
            share(f.removed)
        );
        if f.mode != self.report.mode {
            heading += &format!(", as {}", f.mode.describe());
        }
        heading += ")";
        let mut text = if full { "\n".to_owned() } else { String::new() };
        text += &self.paragraph(2, &format!("{number}. {heading}"));
        if full {
            text += &self.paragraph(5, f.mistake.what);
            if let Some(amount) = f.amount {
                text += &self.paragraph(
                    5,
                    &format!("It fits best at {} scene units.", value(amount)),
                );
            }
            text += &self.paragraph(
                5,
                &format!("To put it right: {}", uncapital(f.mistake.remedy)),
            );
        }
        text
    }

    fn telling(&self) -> String {
        if self.report.telling.is_empty() {
            return String::new();
        }
        let mut text = format!(
            "\nThe most telling pixels\n  {:>4} {:>4}   {:17} {:17} {:17}\n",
            "x", "y", "given", "with the mistake", "right"
        );
        for t in &self.report.telling {
            let [given, mistaken, right] = [t.given, t.mistaken, t.right].map(rgb);
            text += &format!(
                "  {:>4} {:>4}   {given:17} {mistaken:17} {right:17}\n",
                t.x, t.y
            );
        }
        text += "Each one explained, with the numbers of the right equation:\n";
        for t in &self.report.telling {
            text += &format!("  {}\n", explain(self.args, self.report, t));
        }
        text
    }

    fn unexplained(&self) -> String {
        let r = self.report;
        let words = format!(
            "The picture is not right, and none of these mistakes explains it: nearest is {}, with an rmse of {}.{} Several \
             mistakes at once are not looked for; is it the same scene, with the same camera?",
            r.mode.describe(),
            value(r.error),
            if self.lossy {
                " The file is a JPEG; a PNG would say more."
            } else {
                ""
            }
        );
        let mut text = self.paragraph(0, &words);
        if !r.findings.is_empty() {
            text += "\nThe most that one of them removes:\n";
            for f in &r.findings {
                text += &format!(
                    "  {} ({} of the error)\n",
                    f.mistake.title,
                    share(f.removed)
                );
            }
        }
        text
    }

    /// What the picture is right as, where that was not asked for, and how to ask.
    fn right_as(&self) -> String {
        let Some(mode) = self.report.right_as else {
            return String::new();
        };
        let asked = [
            self.args.mode.map(|_| "--mode"),
            self.args.quality.shading.map(|_| "--shading"),
        ];
        let asked: Vec<&str> = asked.into_iter().flatten().collect();
        let words = format!(
            "As {} it is right: leave {} out, or say {}.",
            mode.describe(),
            asked.join(" and "),
            asked_for(mode)
        );
        format!("\n{}", self.paragraph(0, &words))
    }

    fn cannot_show(&self) -> String {
        let names: Vec<&str> = self.report.cannot_show.iter().map(|m| m.name).collect();
        if names.is_empty() || self.report.verdict == Verdict::Unexplained {
            return String::new();
        }
        let words = format!(
            "{} of the {} mistakes would not show on this scene, so they are not ruled out: {}.",
            names.len(),
            check::all().len(),
            names.join(", ")
        );
        format!("\n{}", self.paragraph(0, &words))
    }
}

/// The verdict above a mistake, which explains the picture or only shows in it.
fn explained(mode: Mode, best: &Finding) -> String {
    let kind = mode.describe();
    if best.removed < 0.5 {
        format!(
            "The picture is not right. It is {kind} in which one mistake shows, though most of the error is noise:"
        )
    } else {
        format!("The picture is not right. It is {kind} with one mistake that explains it:")
    }
}

/// How the command line asks for a mode.
fn asked_for(mode: Mode) -> &'static str {
    match mode {
        Mode::Gouraud => "--mode raster --shading gouraud",
        Mode::Flat => "--mode raster --shading flat",
        Mode::Phong => "--mode raster --shading phong",
        Mode::Cast => "--mode cast",
        Mode::Trace => "--mode trace",
    }
}

/// "Use" -> "use", where a sentence goes on.
fn uncapital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| {
        first.to_lowercase().collect::<String>() + letters.as_str()
    })
}

/// A part in percent, one decimal, never all where it is not.
fn share(part: f64) -> String {
    let percent = 100.0 * part;
    match percent {
        p if p >= 100.0 => "all".to_owned(),
        p if p > 99.9 => "more than 99.9 %".to_owned(),
        p => format!("{p:.1} %"),
    }
}

fn rgb(color: [f32; 3]) -> String {
    color.map(|x| format!("{x:.3}")).join(" ")
}

fn as_json(r: &Report, args: &CheckArgs) -> Value {
    let finding = |f: &Finding| {
        json!({
            "name": f.mistake.name,
            "group": f.mistake.group.name(),
            "title": f.mistake.title,
            "what": f.mistake.what,
            "remedy": f.mistake.remedy,
            "mode": f.mode.name(),
            "amount": f.amount,
            "rmse": f.error,
            "removed": f.removed,
            "tied": f.tied,
        })
    };
    let telling = |t: &Telling| {
        json!({
            "pixel": [t.x, t.y],
            "given": t.given,
            "mistaken": t.mistaken,
            "right": t.right,
            "explain": explain(args, r, t),
        })
    };
    let name = |m: &&Mistake| m.name;
    json!({
        "size": r.size,
        "verdict": verdict_name(r.verdict),
        "mode": r.mode.name(),
        "also": r.also.iter().map(|m| m.name()).collect::<Vec<_>>(),
        "right_as": r.right_as.map(Mode::name),
        "rmse": r.error,
        "rmse_of_means": r.error_of_means,
        "max": r.largest,
        "findings": r.findings.iter().map(finding).collect::<Vec<_>>(),
        "cannot_show": r.cannot_show.iter().map(name).collect::<Vec<_>>(),
        "pictures": r.pictures,
        "telling": r.telling.iter().map(telling).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistake_that_removes_less_than_half_shows_and_explains_not() {
        let finding = |removed| Finding {
            mistake: &check::all()[0],
            mode: Mode::Trace,
            amount: None,
            error: 0.01,
            removed,
            tied: false,
        };
        let said = |removed| explained(Mode::Trace, &finding(removed));
        assert!(
            said(0.9)
                .ends_with("It is a traced picture (trace) with one mistake that explains it:")
        );
        assert!(said(0.3).contains("one mistake shows, though most of the error is noise"));
        assert!(!said(0.3).contains("explains it"));
    }
}
