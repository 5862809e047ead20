//! Somebody's own picture of a scene: is it right, and if not, which single named mistake explains it?
//!
//! In: a scene, a picture of it ([`Given`]) whoever made it, and [`Options`]. Out: a [`Report`]. The picture is held
//! against the right pictures of five [`Mode`]s (what it is meant to be is found, not asked), and in each of them against
//! every [`Mistake`]: the scene rendered with exactly that wrong. Both renderers make them with the one equation; what cannot
//! be said by changing the scene or the finished picture is a switch of `lighting::Faults`, `trace::Faults` or
//! `raster::Faults`.
//!
//! | module | does |
//! | - | - |
//! | `mistakes` | the named mistakes, each with what it is, how to put it right, and how to make it |
//! | `change` | what a mistake changes; `lens`: in the camera |
//! | `stage` | the scene, set up once and rendered with changes |
//! | `measure` | errors between pictures, and what counts as noise |
//! | `judge` | right, or which mistakes explain the picture, and which of them cannot be told apart |
//! | `telling` | the pixels that show it |
//!
//! **Error.** rmse of the stored values: the right picture is clamped, rounded and encoded as the given file is. **Noise.**
//! The picture agrees with another one where their rmse, and that of the means of 16 x 16 pixels, are within [`Noise`]: so
//! 8-bit rounding and JPEG pass, a changed tone does not. Below that, a mistake is believed where it removes at least half of
//! what it changes, in squares half of |mistaken - right|^2, and this is no chance; in a lossy file, whose noise follows the
//! picture, only where it also removes half of the error, or its change is larger than the noise where it is made. **Ties.** Two mistakes whose pictures
//! differ by less than [`SAME`] on this scene, or that noise hides from each other, are named together.
//!
//! **Speed.** Pictures above [`FIRST_PASS`] pixels are first judged on every k-th pixel of every k-th row, k odd, which is
//! the picture of a smaller camera; what remains is rendered in full. The answer is the same for any number of threads.

mod change;
mod judge;
mod lens;
mod measure;
mod mistakes;
mod stage;
mod telling;

pub use judge::{Finding, Verdict};
pub use measure::{Noise, SAME};
pub use mistakes::{Group, Mistake, all};
pub use telling::Telling;

use crate::error::Error;
use crate::frame::Plane;
use crate::gl::ShadeModel;
use crate::import::picture::{PictureFile, PictureFormat};
use crate::render::{self, Renderer};
use crate::scene::Scene;
use judge::{Candidate, Right, judge};
use measure::{Stored, rmse};
use stage::{Made, Setup};

/// Pixels of the first pass, at most.
pub const FIRST_PASS: usize = 20_000;

/// Candidates of the first pass that are rendered in full.
const FINALISTS: usize = 8;

/// What a picture may be meant to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mode {
    /// The rasterizer's, lit at the vertices.
    Gouraud,
    /// The rasterizer's, one colour a triangle.
    Flat,
    /// The rasterizer's, lit at every fragment.
    Phong,
    /// Primary rays only, nothing blocked.
    Cast,
    /// The tracer's.
    Trace,
}

impl Mode {
    /// All of them, those of the rasterizer first.
    pub const ALL: [Self; 5] = [
        Self::Gouraud,
        Self::Flat,
        Self::Phong,
        Self::Cast,
        Self::Trace,
    ];

    /// As the command line of `render` asks for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gouraud => "raster, gouraud",
            Self::Flat => "raster, flat",
            Self::Phong => "raster, phong",
            Self::Cast => "cast",
            Self::Trace => "trace",
        }
    }

    /// In words, after "it is".
    pub fn describe(self) -> &'static str {
        match self {
            Self::Gouraud => "a rasterized picture, lit at the vertices (Gouraud)",
            Self::Flat => "a rasterized picture, one colour a triangle (flat)",
            Self::Phong => "a rasterized picture, lit at every pixel (Phong)",
            Self::Cast => "a picture of primary rays only (cast)",
            Self::Trace => "a traced picture (trace)",
        }
    }

    /// Who draws it.
    pub fn renderer(self) -> Renderer {
        match self {
            Self::Gouraud | Self::Flat | Self::Phong => Renderer::Raster,
            Self::Cast => Renderer::Cast,
            Self::Trace => Renderer::Trace,
        }
    }

    /// The rasterizer's shading; `None` for rays.
    pub fn shading(self) -> Option<ShadeModel> {
        match self {
            Self::Gouraud => Some(ShadeModel::Gouraud),
            Self::Flat => Some(ShadeModel::Flat),
            Self::Phong => Some(ShadeModel::Phong),
            Self::Cast | Self::Trace => None,
        }
    }
}

/// Somebody's picture.
#[derive(Clone, Debug)]
pub struct Given {
    /// The values as the file stores them, 8-bit ones over 255; top row first.
    pub color: Plane<[f32; 3]>,
    /// The file holds 8 bits a channel.
    pub eight_bits: bool,
    /// The file was compressed with a loss.
    pub lossy: bool,
}

impl From<PictureFile> for Given {
    fn from(file: PictureFile) -> Self {
        Self {
            color: file.pixels,
            eight_bits: file.bits == Some(8),
            lossy: file.format == PictureFormat::Jpeg,
        }
    }
}

/// How to check.
#[derive(Clone, Debug)]
pub struct Options {
    /// What the picture may be meant to be; at least one.
    pub modes: Vec<Mode>,
    /// How its scene is rendered.
    pub render: render::Options,
    /// The file is meant to hold sRGB values.
    pub srgb: bool,
}

/// The answer.
#[derive(Clone, Debug)]
pub struct Report {
    /// Width and height of the picture.
    pub size: [usize; 2],
    /// The short answer.
    pub verdict: Verdict,
    /// What the picture is taken for.
    pub mode: Mode,
    /// Other modes whose right picture it is just as well.
    pub also: Vec<Mode>,
    /// A mode that was not asked for, as which a picture that is not right would be right.
    pub right_as: Option<Mode>,
    /// rmse against the right picture of that mode.
    pub error: f64,
    /// Of the means of 16 x 16 pixels.
    pub error_of_means: f64,
    /// Largest difference of a value to the right picture.
    pub largest: f64,
    /// Mistakes, best first: those that explain the picture where the verdict is [`Verdict::Mistake`]; those that would
    /// have made it in another mode where it is [`Verdict::Right`]; the nearest ones where it is [`Verdict::Unexplained`].
    pub findings: Vec<Finding>,
    /// Mistakes that change nothing here.
    pub cannot_show: Vec<&'static Mistake>,
    /// How many pictures it was held against.
    pub pictures: usize,
    /// The pixels that show the best mistake.
    pub telling: Vec<Telling>,
    /// The right picture, as the file would store it.
    pub right: Plane<[f32; 3]>,
    /// The picture with the best mistake; `None` without one.
    pub mistaken: Option<Plane<[f32; 3]>>,
}

/// Holds a picture against a scene. `progress` hears how many steps are done, of how many, and the name
/// of the next one. The size of the picture must be that of `scene.image`.
///
/// # Errors
/// [`Error::Parameter`] for a picture of another size, without modes, or with values that are not finite; what the renderers
/// refuse.
pub fn check(
    scene: &Scene,
    given: &Given,
    options: &Options,
    progress: &(dyn Fn(u64, u64, &str) + Sync),
) -> Result<Report, Error> {
    refuse(scene, given, options)?;
    let mut report = held_against(scene, given, options, progress)?;
    if report.verdict != Verdict::Right {
        report.right_as = right_as(scene, given, options)?;
    }
    Ok(report)
}

/// The mode that was not asked for, as which the picture is right: the nearest, held against its mistakes like the others.
fn right_as(scene: &Scene, given: &Given, options: &Options) -> Result<Option<Mode>, Error> {
    let mut others = Mode::ALL.to_vec();
    others.retain(|mode| !options.modes.contains(mode));
    if others.is_empty() {
        return Ok(None);
    }
    let stored = Stored::of(given, options.srgb);
    let setup = Setup::new(scene, options, stored, 1)?;
    let near = setup.with_stage(|stage| {
        let mut near: Vec<Right> = Vec::new();
        for mode in others {
            let picture = stored.apply(&stage.right(mode)?);
            if Noise::of(given).hides(&picture, &given.color) {
                near.push(Right::new(mode, picture, &given.color));
            }
        }
        Ok(near)
    })?;
    let nearest = near.iter().min_by(|a, b| a.error.total_cmp(&b.error));
    let Some(mode) = nearest.map(|right| right.mode) else {
        return Ok(None);
    };
    let options = Options {
        modes: vec![mode],
        ..options.clone()
    };
    let report = held_against(scene, given, &options, &|_, _, _| {})?;
    Ok((report.verdict == Verdict::Right).then_some(mode))
}

/// [`check`], in the modes that were asked for.
fn held_against(
    scene: &Scene,
    given: &Given,
    options: &Options,
    progress: &(dyn Fn(u64, u64, &str) + Sync),
) -> Result<Report, Error> {
    let stored = Stored::of(given, options.srgb);
    let pixels = given.color.data.len();
    let step = measure::odd_step(pixels, FIRST_PASS);
    let steps = (options.modes.len() * (1 + all().len()) + FINALISTS) as u64;
    let setup = Setup::new(scene, options, stored, step)?;
    let mut held = Held::default();
    setup.with_stage(|stage| {
        let small = measure::every(&given.color, step);
        for (i, mode) in options.modes.iter().enumerate() {
            let done = (i * (1 + all().len())) as u64;
            let say = |k: u64, name: &str| progress(done + k, steps, name);
            held.hold(stage, *mode, &small, &given.color, step, &stored, &say)?;
        }
        held.fit_amounts(stage, &small)
    })?;
    let pictures = held.pictures;
    let (shown, unshown) = (held.shown.clone(), held.unshown.clone());
    if step > 1 {
        progress(steps - FINALISTS as u64, steps, "in full");
        let finals = Setup::new(scene, options, stored, 1)?;
        held = finals.with_stage(|stage| held.in_full(stage, &given.color, &stored))?;
    }
    let judged = judge(
        &given.color,
        Noise::of(given),
        &held.rights,
        &held.candidates,
    );
    let cannot_show = unshown
        .into_iter()
        .filter(|(mode, m)| *mode == judged.mode && !shown.contains(&(*mode, *m)))
        .map(|(_, m)| &all()[m])
        .collect();
    Ok(report(given, judged, &held, cannot_show, pictures))
}

fn refuse(scene: &Scene, given: &Given, options: &Options) -> Result<(), Error> {
    let Plane { width, height, .. } = given.color;
    let image = &scene.image;
    if (image.width as usize, image.height as usize) != (width, height) {
        let message = format!(
            "{width}x{height}, but the scene is to be drawn at {}x{}",
            image.width, image.height
        );
        return Err(Error::parameter("IMAGE", message));
    }
    let bad = given
        .color
        .data
        .iter()
        .position(|c| !c.iter().all(|x| x.is_finite()));
    if let Some(i) = bad {
        let message = format!(
            "pixel {} {} holds a value that is not finite",
            i % width,
            i / width
        );
        let help = "a NaN comes from 0/0, the root or the power of a negative number, or a zero vector made unit";
        return Err(Error::parameter("IMAGE", message).with_help(help));
    }
    if options.modes.is_empty() {
        return Err(Error::parameter("modes", "expected at least one"));
    }
    Ok(())
}

/// Right and mistaken pictures with their errors.
#[derive(Default)]
struct Held {
    rights: Vec<Right>,
    candidates: Vec<Candidate>,
    /// Modes and mistakes that change the picture, and those that do not.
    shown: Vec<(Mode, usize)>,
    unshown: Vec<(Mode, usize)>,
    pictures: usize,
}

impl Held {
    /// One mode: its right picture, and that of every mistake in it.
    #[expect(clippy::too_many_arguments, reason = "one call, from one place")]
    fn hold(
        &mut self,
        stage: &stage::Stage<'_>,
        mode: Mode,
        small: &Plane<[f32; 3]>,
        whole: &Plane<[f32; 3]>,
        step: usize,
        stored: &Stored,
        say: &dyn Fn(u64, &str),
    ) -> Result<(), Error> {
        say(0, mode.name());
        let right = stage.right(mode)?;
        let view = stored.apply(&right);
        self.pictures += 1;
        for (number, mistake) in all().iter().enumerate() {
            say(1 + number as u64, mistake.title);
            if !mistake.of.includes(mode) {
                continue;
            }
            let mut shows = false;
            for amount in mistake.amounts(stage.scene()) {
                let made = stage.mistaken(mistake, mode, amount, &right, small)?;
                let Some(Made { picture, turn }) = made else {
                    continue;
                };
                self.pictures += 1;
                let change = rmse(&picture, &view);
                if change <= measure::SHOWS {
                    continue;
                }
                shows = true;
                // A turned picture is compared turned back, since every k-th row of it is not a row of the small one.
                let error = match turn {
                    Some(turn) if step > 1 => rmse(&measure::every(&turn.of(whole), step), &view),
                    _ => rmse(&picture, small),
                };
                self.candidates.push(Candidate {
                    mistake: number,
                    mode,
                    amount,
                    error,
                    picture,
                });
            }
            let list = if shows {
                &mut self.shown
            } else {
                &mut self.unshown
            };
            list.push((mode, number));
        }
        self.rights.push(Right::new(mode, view, small));
        Ok(())
    }

    /// Improves the amount of a mistake that has one, where it is among the best.
    fn fit_amounts(
        &mut self,
        stage: &stage::Stage<'_>,
        small: &Plane<[f32; 3]>,
    ) -> Result<(), Error> {
        self.sort();
        let best = self.candidates.iter().take(FINALISTS);
        let Some(found) = best.clone().find(|c| all()[c.mistake].has_amount()) else {
            return Ok(());
        };
        let (mistake, mode, mut middle) = (found.mistake, found.mode, found.clone());
        let right = stage.right(mode)?;
        let mut ratio = mistakes::AMOUNT_STEP.sqrt();
        for _ in 0..5 {
            for factor in [1.0 / ratio, ratio] {
                let amount = middle.amount * factor;
                let made = stage.mistaken(&all()[mistake], mode, amount, &right, small)?;
                let Some(Made { picture, .. }) = made else {
                    continue;
                };
                let error = rmse(&picture, small);
                self.pictures += 1;
                if error < middle.error {
                    middle = Candidate {
                        amount,
                        error,
                        picture,
                        ..middle
                    };
                    break;
                }
            }
            ratio = ratio.sqrt();
        }
        self.candidates.push(middle);
        self.sort();
        Ok(())
    }

    fn sort(&mut self) {
        self.candidates.sort_by(|a, b| a.error.total_cmp(&b.error));
    }

    /// The best of them again, at the picture's own size.
    fn in_full(
        mut self,
        stage: &stage::Stage<'_>,
        given: &Plane<[f32; 3]>,
        stored: &Stored,
    ) -> Result<Self, Error> {
        self.sort();
        self.rights.sort_by(|a, b| a.error.total_cmp(&b.error));
        let mut best: Vec<Candidate> = Vec::new();
        for candidate in std::mem::take(&mut self.candidates) {
            let known = best.iter().filter(|b| b.mistake == candidate.mistake);
            if best.len() < FINALISTS && known.count() < 2 {
                best.push(candidate);
            }
        }
        let mut full = Self::default();
        let wanted = |mode: Mode| best.iter().any(|c| c.mode == mode);
        let least = self.rights.first().map_or(0.0, |r| r.error);
        for mode in self
            .rights
            .iter()
            .filter(|r| wanted(r.mode) || r.error <= 1.2 * least + Noise::LOSSY.pixels)
        {
            let mode = mode.mode;
            let right = stage.right(mode)?;
            for c in best.iter().filter(|c| c.mode == mode) {
                let mistake = &all()[c.mistake];
                let made = stage.mistaken(mistake, mode, c.amount, &right, given)?;
                if let Some(Made { picture, .. }) = made {
                    let error = rmse(&picture, given);
                    full.candidates.push(Candidate {
                        error,
                        picture,
                        ..c.clone()
                    });
                }
            }
            full.rights
                .push(Right::new(mode, stored.apply(&right), given));
        }
        full.rights.sort_by_key(|r| r.mode);
        full.sort();
        Ok(full)
    }
}

fn report(
    given: &Given,
    judged: judge::Judged,
    held: &Held,
    cannot_show: Vec<&'static Mistake>,
    pictures: usize,
) -> Report {
    let right = &held.rights[judged.right];
    let mistaken = judged.best.map(|best| &held.candidates[best].picture);
    let telling = mistaken.map_or_else(Vec::new, |m| {
        telling::telling(&given.color, m, &right.picture)
    });
    Report {
        size: [given.color.width, given.color.height],
        verdict: judged.verdict,
        mode: judged.mode,
        also: judged.also,
        right_as: None,
        error: right.error,
        error_of_means: measure::rmse_of_means(&right.picture, &given.color),
        largest: measure::largest(&right.picture, &given.color),
        findings: judged.findings,
        cannot_show,
        pictures,
        telling,
        right: right.picture.clone(),
        mistaken: mistaken.cloned(),
    }
}
