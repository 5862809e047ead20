//! `rastray render`: one picture.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rastray::error::Error;
use rastray::frame::{Frame, Layers, Plane};
use rastray::lanes::Real;
use rastray::math::color::clamp_rgb;
use rastray::report::files::{self, Format, View};
use rastray::report::layered::NamedLayer;
use rastray::scene::Scene;
use rastray::scene::assembly::Assembly;
use rastray::{raster, trace};
use serde_json::{Value, json};

use super::options::{Quality, Verbosity, apply};
use super::{ClampArg, GeometryArg, ModeArg, PrecisionArg, RenderArgs, commands, diagnostic};

/// What a render needs beyond the scene.
struct Job {
    mode: ModeArg,
    geometry: trace::Geometry,
    clamp: bool,
    layers: bool,
    shadows: bool,
    reflection: bool,
    refraction: bool,
    quality: Quality,
}

/// A finished picture as files hold it.
struct Done {
    color: Plane<[f32; 3]>,
    layers: Option<Layers<f32>>,
    triangles: usize,
    counters: Value,
    assemble_seconds: f64,
    plan_seconds: f64,
    render_seconds: f64,
}

pub(crate) fn render(args: &RenderArgs, verbosity: Verbosity) -> Result<(), Error> {
    let output = args.output.clone();
    // A wrong output name is said before the work, not after it.
    let format = match output.as_deref() {
        None => Format::Png,
        Some(path) if path == Path::new("-") => Format::Png,
        Some(path) => Format::of_path(path)?,
    };
    if let Some(path) = &output {
        files::check_target(path, "--output")?;
    }
    if let Some(path) = &args.stats {
        files::check_target(path, "--stats")?;
    }
    if args.layers && format != Format::Exr {
        return Err(
            Error::parameter("--layers", "only .exr files hold named layers")
                .with_help("write to a name that ends in .exr, such as -o layers.exr"),
        );
    }
    let start = Instant::now();
    let mut imported = commands::load(&args.scene, verbosity)?;
    let import_seconds = start.elapsed().as_secs_f64();
    let quality = apply(&args.quality, &mut imported)?;
    let clamp = args
        .clamp
        .map_or(!format.is_float(), |clamp| clamp == ClampArg::Gl);
    let job = Job {
        mode: args.mode,
        geometry: match args.geometry {
            GeometryArg::Exact => trace::Geometry::Exact,
            GeometryArg::Mesh => trace::Geometry::Mesh,
        },
        clamp,
        layers: args.layers,
        shadows: !args.quality.no_shadows,
        reflection: !args.quality.no_reflection,
        refraction: !args.quality.no_refraction,
        quality,
    };
    verbosity.step("rendering");
    let done = match args.quality.precision {
        PrecisionArg::F32 => draw::<f32>(&imported.scene, &job)?,
        PrecisionArg::F64 => draw::<f64>(&imported.scene, &job)?,
    };
    let view = if args.quality.srgb {
        View::Srgb
    } else {
        View::Linear
    };
    let path = output.unwrap_or_else(|| PathBuf::from(format!("{}.png", imported.scene.name)));
    let writing = Instant::now();
    write(&path, &done, view, verbosity)?;
    let stats = json!({
        "scene": imported.scene.name,
        "size": [imported.scene.image.width, imported.scene.image.height],
        "mode": mode_name(args.mode),
        "precision": match args.quality.precision { PrecisionArg::F32 => "f32", PrecisionArg::F64 => "f64" },
        "instruction_set": job.quality.isa.name(),
        "threads": rayon::current_num_threads(),
        "triangles": done.triangles,
        "seconds": {
            "import": import_seconds,
            "assemble": done.assemble_seconds,
            "plan": done.plan_seconds,
            "render": done.render_seconds,
            "write": writing.elapsed().as_secs_f64(),
        },
        "counters": done.counters,
    });
    if let Some(file) = &args.stats {
        files::write_bytes_atomic(file, format!("{stats:#}\n").as_bytes())?;
    }
    if args.json {
        commands::print_json(&stats)
    } else {
        Ok(())
    }
}

fn mode_name(mode: ModeArg) -> &'static str {
    match mode {
        ModeArg::Raster => "raster",
        ModeArg::Cast => "cast",
        ModeArg::Trace => "trace",
    }
}

fn write(path: &Path, done: &Done, view: View, verbosity: Verbosity) -> Result<(), Error> {
    let layers: Vec<NamedLayer<'_>> = done
        .layers
        .iter()
        .flat_map(|layers| layers.names.iter().zip(&layers.planes))
        .map(|(name, plane)| NamedLayer {
            name: name.clone(),
            plane,
        })
        .collect();
    let notes = files::write_picture(path, &done.color, view, &layers)?;
    if verbosity != Verbosity::Quiet {
        notes.iter().for_each(diagnostic::note);
    }
    if path != Path::new("-") {
        verbosity.say(path.display());
    }
    Ok(())
}

fn draw<R: Real>(scene: &Scene, job: &Job) -> Result<Done, Error> {
    let start = Instant::now();
    let assembly = Assembly::<R>::new(scene, job.quality.level)?;
    assembly.check_range(scene)?;
    let assemble_seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let (mut frame, counters, plan_seconds, render_seconds) = match job.mode {
        ModeArg::Raster => {
            let plan = raster::Plan::new(scene, &assembly, job.quality.model);
            let planned = start.elapsed().as_secs_f64();
            let options = raster::Options {
                shading: scene.raster.shading,
                clamp: job.clamp,
                layers: job.layers,
                isa: job.quality.isa,
            };
            let start = Instant::now();
            let (frame, counters) = plan.draw(&options)?;
            (
                frame,
                json!(counters),
                planned,
                start.elapsed().as_secs_f64(),
            )
        }
        ModeArg::Cast | ModeArg::Trace => {
            let plan = trace::Plan::new(scene, &assembly, job.geometry, job.quality.model)?;
            let planned = start.elapsed().as_secs_f64();
            let options = trace_options(scene, job);
            let start = Instant::now();
            let (frame, counters) = plan.draw(&options)?;
            (
                frame,
                json!(counters),
                planned,
                start.elapsed().as_secs_f64(),
            )
        }
    };
    if job.clamp {
        frame.color.data.iter_mut().for_each(|c| *c = clamp_rgb(*c));
    }
    Ok(done(
        &frame,
        assembly.triangles.len(),
        counters,
        [assemble_seconds, plan_seconds, render_seconds],
    ))
}

fn trace_options(scene: &Scene, job: &Job) -> trace::Options {
    let isa = job.quality.isa;
    if job.mode == ModeArg::Cast {
        return trace::Options {
            layers: job.layers,
            ..trace::Options::cast(isa)
        };
    }
    trace::Options {
        shadows: job.shadows,
        reflection: job.reflection,
        refraction: job.refraction,
        layers: job.layers,
        ..trace::Options::of(scene, isa)
    }
}

fn done<R: Real>(frame: &Frame<R>, triangles: usize, counters: Value, seconds: [f64; 3]) -> Done {
    let layers = frame.layers.as_ref().map(Layers::to_f32);
    let [assemble_seconds, plan_seconds, render_seconds] = seconds;
    let color = frame.color_f32();
    Done {
        color,
        layers,
        triangles,
        counters,
        assemble_seconds,
        plan_seconds,
        render_seconds,
    }
}
