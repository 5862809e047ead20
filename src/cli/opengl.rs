//! The system's OpenGL on the command line: `render --mode opengl` and `compare --against opengl`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rastray::error::{Error, Note};
use rastray::frame::Plane;
use rastray::math::color::quantize8;
use rastray::peers::agreement::{Agreement, Pair};
use rastray::peers::opengl::{Info, Options, Picture, with_driver};
use rastray::render::{self, Assembled, Job, Rasterizer, Renderer};
use rastray::report::difference::compared;
use rastray::report::files;
use rastray::report::origin;
use rastray::report::peer::{Both, PeerReport, PeerSummary, Seconds};
use rastray::sampling::Pattern;
use rastray::scene::Scene;
use rastray_compare::{
    Encoding, ImageView, Map, Metrics, Reduction, magnitude_map, metrics, signed_map,
};
use serde_json::{Value, json};

use super::args::CompareArgs;
use super::commands::{self, command_line};
use super::options::{Verbosity, apply, view};
use super::progress::Progress;
use super::watch::Made;

/// A picture by the driver.
pub(super) struct Drawn {
    /// Linear colour.
    pub(super) color: Plane<[f32; 3]>,
    /// One line: who drew it, and with what.
    pub(super) remark: String,
    /// The same for programs.
    pub(super) driver: Value,
}

/// OpenGL is in the program; whether the system has it is found when it draws.
#[expect(
    clippy::unnecessary_wraps,
    reason = "a program without OpenGL refuses here"
)]
pub(super) fn check(_flag: &str) -> Result<(), Error> {
    Ok(())
}

/// Draws the scene's triangles with the system's OpenGL.
pub(super) fn draw(scene: &Scene, assembled: &Assembled, clamp: bool) -> Result<Drawn, Error> {
    let options = Options {
        shading: scene.raster.shading,
        clamp,
    };
    let (info, picture) = with_driver(|driver| {
        let picture = driver.draw(scene, assembled, &options)?;
        Ok((driver.info().clone(), picture))
    })?;
    let method = picture.method.to_string();
    Ok(Drawn {
        remark: format!("{} · OpenGL {}: {method}", info.renderer, info.version),
        driver: json!({"driver": info, "method": method}),
        color: picture.color,
    })
}

/// Both pictures of a scene into a folder; whether they differ by more than was asked.
pub(super) fn compare(args: &CompareArgs, verbosity: Verbosity) -> Result<(Made, bool), Error> {
    let mut imported = commands::load(&args.scene, &[], verbosity)?;
    let render = apply(&args.quality, &mut imported)?;
    let scene = &imported.scene;
    let name = || PathBuf::from(format!("{}-opengl", scene.name));
    let path = args.output.clone().unwrap_or_else(name);
    files::check_folder(&path, "--output")?;
    let progress = Progress::new(verbosity, 1);
    progress.step(0, "rendering");
    let measured = measure(scene, &render)?;
    let report = PeerReport {
        title: scene.name.clone(),
        command: command_line(),
        view: view(&args.quality),
        difference: difference(&measured)?,
        same_triangle: same_triangle(&measured)?,
        raster: measured.raster,
        opengl: measured.opengl,
        summary: measured.summary,
        notes: [&imported.notes[..], &outlines(scene)[..]].concat(),
        settings: origin::settings(scene, &render),
    };
    write(&path, &report)?;
    drop(progress);
    tell(args, &report.summary, verbosity)?;
    let page = path.join("index.html");
    verbosity.say(page.display());
    let worst = report.summary.agreement.unclamped.same_triangle.max;
    let made = Made {
        inputs: imported.files,
        result: page,
    };
    Ok((made, args.max_error.is_some_and(|most| worst > most)))
}

/// What the agreement does not set apart where the scene blends.
fn outlines(scene: &Scene) -> Vec<Note> {
    let message = "raster.transparency = \"blend\": both blend in the same order; the agreement sets apart edges of opaque \
                   triangles only, so a pixel at the outline of a blended one may count as an error";
    let note = scene.blends().then(|| Note {
        place: None,
        message: message.to_owned(),
    });
    note.into_iter().collect()
}

fn write(path: &Path, report: &PeerReport) -> Result<(), Error> {
    let encoded = report.files()?;
    files::create_folder(path)?;
    encoded
        .iter()
        .try_for_each(|file| files::write_bytes_atomic(&path.join(&file.name), &file.bytes))
}

/// The result in lines, or as JSON.
fn tell(args: &CompareArgs, summary: &PeerSummary, verbosity: Verbosity) -> Result<(), Error> {
    if args.json {
        return commands::print(&summary.to_json()?);
    }
    if verbosity != Verbosity::Quiet {
        commands::print(&summary.to_text())?;
    }
    if args.driver_info {
        let d = &summary.driver;
        commands::print(&format!(
            "driver\n  renderer        {}\n  version         {}\n  vendor          {}\n  GLSL            {}\n  \
             EGL platform    {}\n  lights          {}\n  sub-pixel bits  {}\n",
            d.renderer,
            d.version,
            d.vendor,
            d.shading_language,
            d.platform,
            d.max_lights,
            d.subpixel_bits
        ))?;
    }
    Ok(())
}

/// Pictures and numbers of a comparison.
struct Measured {
    raster: Plane<[f32; 3]>,
    opengl: Plane<[f32; 3]>,
    /// Where both show the same triangle.
    same: Vec<bool>,
    summary: PeerSummary,
}

/// What the driver draws of a scene.
struct Theirs {
    info: Info,
    /// At pixel centres.
    unclamped: Picture,
    /// At pixel centres.
    clamped: Picture,
    /// Clamped, with the scene's own samples where those are not the centres.
    shown: Option<Picture>,
    seconds: f64,
}

/// All of the driver's pictures.
fn theirs(scene: &Scene, centers: &Scene, assembled: &Assembled) -> Result<Theirs, Error> {
    let start = Instant::now();
    let options = |clamp| Options {
        shading: scene.raster.shading,
        clamp,
    };
    with_driver(|driver| {
        let sampled = centers.image != scene.image;
        let shown = sampled.then(|| driver.draw(scene, assembled, &options(true)));
        Ok(Theirs {
            info: driver.info().clone(),
            unclamped: driver.draw(centers, assembled, &options(false))?,
            clamped: driver.draw(centers, assembled, &options(true))?,
            shown: shown.transpose()?,
            seconds: start.elapsed().as_secs_f64(),
        })
    })
}

/// The rasterizer, and the time that it takes.
struct Ours<'a> {
    assembled: &'a Assembled,
    render: &'a render::Options,
    seconds: f64,
}

impl Ours<'_> {
    fn draw(&mut self, scene: &Scene, clamp: bool) -> Result<render::Picture, Error> {
        let start = Instant::now();
        let job = Job {
            clamp,
            ..Job::with(scene, Renderer::Raster, self.render)
        };
        let mut picture = job.draw_of(self.assembled)?.picture;
        if clamp {
            picture = picture.clamped();
        }
        self.seconds += start.elapsed().as_secs_f64();
        Ok(picture)
    }

    /// Our picture against theirs, at pixel centres.
    fn agreement(
        &self,
        scene: &Scene,
        ours: &render::Picture,
        peer: &Picture,
        info: &Info,
    ) -> Agreement {
        let plan = Rasterizer::new(scene, self.assembled, self.render.model);
        let own = scene.raster.snap.bits().unwrap_or(u32::MAX);
        let bits = info.subpixel_bits.min(own);
        Agreement::of(&Pair {
            scene,
            plan: &plan,
            ours: &ours.to_f64(),
            peer,
            shading: scene.raster.shading,
            edge_px: 0.5f64.powi(bits as i32),
        })
    }
}

fn measure(scene: &Scene, render: &render::Options) -> Result<Measured, Error> {
    let assembled = Assembled::new(scene, render.level, render.precision)?;
    // Agreement is judged at pixel centres, whatever the samples of the picture.
    let mut centers = scene.clone();
    (centers.image.samples, centers.image.pattern) = (1, Pattern::Grid);
    let theirs = theirs(scene, &centers, &assembled)?;
    let mut ours = Ours {
        assembled: &assembled,
        render,
        seconds: 0.0,
    };
    let (unclamped, clamped) = (ours.draw(&centers, false)?, ours.draw(&centers, true)?);
    let agreement = Both {
        unclamped: ours.agreement(&centers, &unclamped, &theirs.unclamped, &theirs.info),
        clamped: ours.agreement(&centers, &clamped, &theirs.clamped, &theirs.info),
    };
    let method = Both {
        unclamped: theirs.unclamped.method.to_string(),
        clamped: theirs.clamped.method.to_string(),
    };
    let numbers = [&clamped.primitive().data, &theirs.clamped.primitive.data];
    let same = numbers[0].iter().zip(numbers[1]).map(|(a, b)| a == b);
    let same = same.collect();
    let (raster, opengl) = match theirs.shown {
        Some(shown) => (ours.draw(scene, true)?.color_f32(), shown.color),
        None => (clamped.color_f32(), theirs.clamped.color),
    };
    let summary = PeerSummary {
        size: [raster.width, raster.height],
        driver: theirs.info,
        method,
        metrics: stored_metrics(&raster, &opengl)?,
        agreement,
        triangles: assembled.triangles().len(),
        seconds: Seconds {
            raster: ours.seconds,
            opengl: theirs.seconds,
        },
    };
    Ok(Measured {
        raster,
        opengl,
        same,
        summary,
    })
}

/// Metrics of the values that 8-bit files hold.
fn stored_metrics(raster: &Plane<[f32; 3]>, opengl: &Plane<[f32; 3]>) -> Result<Metrics, Error> {
    let stored =
        |plane: &Plane<[f32; 3]>| plane.map(|c| c.map(|x| f32::from(quantize8(x)) / 255.0));
    let (test, reference) = (stored(raster), stored(opengl));
    let (width, height) = (test.width, test.height);
    let image = |data| compared(ImageView::new(width, height, data, Encoding::Linear));
    compared(metrics(&image(&test.data)?, &image(&reference.data)?))
}

/// Raster minus OpenGL.
fn differences(m: &Measured) -> Vec<[f64; 3]> {
    let pairs = m.raster.data.iter().zip(&m.opengl.data);
    pairs
        .map(|(a, b)| [0, 1, 2].map(|c| f64::from(a[c]) - f64::from(b[c])))
        .collect()
}

fn difference(m: &Measured) -> Result<Map, Error> {
    let (width, height) = (m.raster.width, m.raster.height);
    compared(signed_map(
        width,
        height,
        &differences(m),
        Reduction::Largest,
    ))
}

fn same_triangle(m: &Measured) -> Result<Map, Error> {
    let (width, height) = (m.raster.width, m.raster.height);
    let all = differences(m).into_iter().zip(&m.same);
    let same: Vec<[f64; 3]> = all
        .map(|(d, same)| if *same { d } else { [0.0; 3] })
        .collect();
    compared(magnitude_map(width, height, &same, Reduction::Largest))
}
