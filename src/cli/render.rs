//! `rastray render`: one picture, or a series of them.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rastray::error::Error;
use rastray::frame::{Layers, Plane};
use rastray::import::Imported;
use rastray::render::{Assembled, Drawn, Job, Options, Renderer, Seconds};
use rastray::report::animation;
use rastray::report::files::{self, Format};
use rastray::report::layered::NamedLayer;
use rastray::report::picture::Picture;
use rastray::scene::Scene;
use rastray::trade::choose::Choice;
use rastray::trade::setting::Setting;
use serde_json::{Value, json};

use super::args::{ClampArg, RenderArgs, Who};
use super::options::{Verbosity, apply, view};
use super::progress::Progress;
use super::series::{Series, fits_memory, is_gif, numbered};
use super::watch::{Made, follow};
use super::{commands, diagnostic, opengl, pick};

/// How a picture of `render` is made.
struct Plan {
    by: Who,
    clamp: bool,
    layers: bool,
    options: Options,
}

/// A finished picture as files hold it.
struct Done {
    color: Plane<[f32; 3]>,
    layers: Option<Layers<f32>>,
    triangles: usize,
    counters: Value,
    /// Who drew it, where it was not this program.
    remark: Option<String>,
    seconds: Seconds,
}

/// A render of a loaded scene.
struct Shot {
    imported: Imported,
    import_seconds: f64,
    by: Who,
    options: Options,
    /// What `--error` or `--time` picked.
    picked: Option<Choice>,
    done: Done,
}

impl Shot {
    /// The picture, linear.
    fn color(&self) -> &Plane<[f32; 3]> {
        &self.done.color
    }
}

pub(super) fn render(args: &RenderArgs, verbosity: Verbosity) -> Result<(), Error> {
    if args.mode == Who::Opengl {
        opengl::check("--mode opengl")?;
    }
    let several = Series::new(args)?;
    // A wrong output name is said before the work, not after it.
    check_output(args, several.is_some())?;
    if let Some(path) = args
        .output
        .as_deref()
        .filter(|path| *path != Path::new("-"))
    {
        files::check_target(path, "--output")?;
    }
    if let Some(path) = &args.stats {
        files::check_target(path, "--stats")?;
    }
    follow(
        args.follow,
        &args.scene.scene,
        verbosity,
        || match &several {
            Some(frames) => all(args, frames, verbosity),
            None => one(args, verbosity),
        },
    )
}

/// Refuses output names that do not go with the other flags.
fn check_output(args: &RenderArgs, several: bool) -> Result<(), Error> {
    let output = args.output.as_deref().unwrap_or(Path::new("a.png"));
    if output == Path::new("-") {
        let flag = match args.follow {
            _ if several => "--output",
            follow if follow.open => "--open",
            follow if follow.watch => "--watch",
            _ => return layers_need_exr(args, Format::Png),
        };
        let message = "standard output takes one picture, and once";
        return Err(Error::parameter(flag, message).with_help("give it a file: -o NAME.png"));
    }
    if is_gif(output) {
        if several {
            return layers_need_exr(args, Format::Png);
        }
        let message = "a .gif holds several frames, and this is one picture";
        let name = output.display().to_string();
        return Err(Error::parameter(name, message)
            .with_help("add --turntable N or --vary KEY=A..B:N, or write a .png"));
    }
    layers_need_exr(args, Format::of_path(output)?)
}

fn layers_need_exr(args: &RenderArgs, format: Format) -> Result<(), Error> {
    if args.layers && args.mode == Who::Opengl {
        let message = "OpenGL gives a picture, not its terms";
        return Err(Error::parameter("--layers", message).with_help("use --mode raster"));
    }
    if args.layers && format != Format::Exr {
        return Err(
            Error::parameter("--layers", "only .exr files hold named layers")
                .with_help("write to a name that ends in .exr, such as -o layers.exr"),
        );
    }
    Ok(())
}

/// One picture into one file.
fn one(args: &RenderArgs, verbosity: Verbosity) -> Result<Made, Error> {
    let shot = shoot(args, &[], verbosity)?;
    let name = || PathBuf::from(format!("{}.png", shot.imported.scene.name));
    let path = args.output.clone().unwrap_or_else(name);
    if let Some(remark) = &shot.done.remark {
        verbosity.say(remark);
    }
    let writing = Instant::now();
    write(&path, &shot, args, verbosity)?;
    if path != Path::new("-") {
        verbosity.say(path.display());
    }
    tell(args, &stats(&shot, writing.elapsed().as_secs_f64()))?;
    Ok(Made {
        inputs: shot.imported.files,
        result: path,
    })
}

/// Loads the scene with further overrides and renders it.
fn shoot(args: &RenderArgs, sets: &[String], verbosity: Verbosity) -> Result<Shot, Error> {
    let start = Instant::now();
    let mut imported = commands::load(&args.scene, sets, verbosity)?;
    let import_seconds = start.elapsed().as_secs_f64();
    let options = apply(&args.quality, &mut imported)?;
    let isa = options.isa;
    let float = args
        .output
        .as_deref()
        .and_then(|path| Format::of_path(path).ok())
        .is_some_and(Format::is_float);
    let mut plan = Plan {
        by: args.mode,
        clamp: args.clamp.map_or(!float, |clamp| clamp == ClampArg::Gl),
        layers: args.layers,
        options: Options {
            geometry: args.geometry,
            ..options
        },
    };
    let picked = pick::pick(args, &imported.scene, isa, verbosity)?;
    if let Some(choice) = &picked {
        imported.scene = choice.setting.apply(&imported.scene);
        plan.take(&choice.setting);
    }
    // After the notes, which must not meet a bar. A series has a bar of its own, and asks for quiet.
    let progress = Progress::new(verbosity, 1);
    progress.step(0, "rendering");
    let done = plan.draw(&imported.scene)?;
    drop(progress);
    Ok(Shot {
        imported,
        import_seconds,
        by: plan.by,
        options: plan.options,
        picked,
        done,
    })
}

impl Plan {
    /// Draws as a setting says; what of it is the scene's, the scene has.
    fn take(&mut self, setting: &Setting) {
        self.by = Who::Ours(setting.renderer);
        self.options.precision = setting.precision;
        self.options.geometry = setting.geometry;
        self.options.level = Some(setting.level);
    }

    /// Draws.
    fn draw(&self, scene: &Scene) -> Result<Done, Error> {
        match self.by {
            Who::Ours(renderer) => self.ours(scene, renderer),
            Who::Opengl => self.theirs(scene),
        }
    }

    fn ours(&self, scene: &Scene, renderer: Renderer) -> Result<Done, Error> {
        let job = Job {
            clamp: self.clamp,
            layers: self.layers,
            ..Job::with(scene, renderer, &self.options)
        };
        let Drawn {
            mut picture,
            counters,
            triangles,
            seconds,
        } = job.draw()?;
        if self.clamp {
            picture = picture.clamped();
        }
        Ok(Done {
            color: picture.color_f32(),
            layers: picture.layers_f32(),
            triangles,
            counters: json!(counters),
            remark: None,
            seconds,
        })
    }

    fn theirs(&self, scene: &Scene) -> Result<Done, Error> {
        let start = Instant::now();
        let assembled = Assembled::new(scene, self.options.level, self.options.precision)?;
        let (assemble, start) = (start.elapsed().as_secs_f64(), Instant::now());
        let drawn = opengl::draw(scene, &assembled, self.clamp)?;
        Ok(Done {
            color: drawn.color,
            layers: None,
            triangles: assembled.triangles().len(),
            counters: drawn.driver,
            remark: Some(drawn.remark),
            seconds: Seconds {
                assemble,
                plan: 0.0,
                render: start.elapsed().as_secs_f64(),
            },
        })
    }
}

/// A picture of a scene as its PNG would hold it, still in float: GL's clamps, exact shapes where it is traced.
pub(super) fn picture(
    scene: &Scene,
    by: Renderer,
    options: &Options,
) -> Result<Plane<[f32; 3]>, Error> {
    let job = Job {
        clamp: true,
        ..Job::with(scene, by, options)
    };
    Ok(job.draw()?.picture.clamped().color_f32())
}

/// Times and counters of a render.
fn stats(shot: &Shot, write_seconds: f64) -> Value {
    let (scene, done) = (&shot.imported.scene, &shot.done);
    json!({
        "scene": scene.name,
        "size": [scene.image.width, scene.image.height],
        "mode": shot.by.name(),
        "picked": shot.picked.as_ref().map(|choice| json!({
            "arguments": choice.arguments,
            "tried": choice.tried,
            "expected_rmse": choice.error,
            "expected_seconds": choice.seconds,
        })),
        "precision": shot.options.precision.name(),
        "instruction_set": shot.options.isa.name(),
        "threads": rayon::current_num_threads(),
        "triangles": done.triangles,
        "seconds": {
            "import": shot.import_seconds,
            "assemble": done.seconds.assemble,
            "plan": done.seconds.plan,
            "render": done.seconds.render,
            "write": write_seconds,
        },
        "counters": done.counters,
    })
}

/// Writes and prints times and counters where they were asked for.
fn tell(args: &RenderArgs, stats: &Value) -> Result<(), Error> {
    if let Some(file) = &args.stats {
        files::write_bytes_atomic(file, format!("{stats:#}\n").as_bytes())?;
    }
    if args.json {
        commands::print_json(stats)?;
    }
    Ok(())
}

/// Writes a picture in the format of the path, and says what the format loses.
fn write(path: &Path, shot: &Shot, args: &RenderArgs, verbosity: Verbosity) -> Result<(), Error> {
    let layers: Vec<NamedLayer<'_>> = shot
        .done
        .layers
        .iter()
        .flat_map(|layers| layers.names.iter().zip(&layers.planes))
        .map(|(name, plane)| NamedLayer {
            name: name.clone(),
            plane,
        })
        .collect();
    let notes = files::write_picture(path, &shot.done.color, view(&args.quality), &layers)?;
    if verbosity != Verbosity::Quiet {
        notes.iter().for_each(diagnostic::note);
    }
    Ok(())
}

/// Renders all frames.
fn all(args: &RenderArgs, series: &Series, verbosity: Verbosity) -> Result<Made, Error> {
    let frames = series.frames();
    let mut base = commands::load(&args.scene, &[], verbosity)?;
    apply(&args.quality, &mut base)?;
    let path = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}.png", base.scene.name)));
    let gif = is_gif(&path);
    if gif {
        fits_memory(&base.scene.image, frames)?;
    }
    let camera = base.scene.camera;
    // The last value is tried before the first is drawn.
    let last = series.sets(frames - 1, &camera);
    commands::load(&args.scene, &last, Verbosity::Quiet).map_err(|e| series.own_words(e))?;
    let progress = Progress::new(verbosity, frames.into());
    let (mut pictures, mut all_stats) = (Vec::new(), Vec::new());
    for frame in 0..frames {
        progress.step(frame.into(), &series.title(frame));
        let sets = series.sets(frame, &camera);
        let shot = shoot(args, &sets, Verbosity::Quiet).map_err(|e| series.own_words(e))?;
        let writing = Instant::now();
        if gif {
            pictures.push(Picture::from_linear(shot.color(), view(&args.quality))?);
        } else {
            // What the format loses is said once.
            let said = if frame == 0 {
                verbosity
            } else {
                Verbosity::Quiet
            };
            write(&numbered(&path, frame), &shot, args, said)?;
        }
        all_stats.push(stats(&shot, writing.elapsed().as_secs_f64()));
    }
    if gif {
        progress.step(frames.into(), "palette and GIF");
        files::write_bytes_atomic(&path, &animation::gif(&pictures, args.fps)?)?;
    }
    drop(progress);
    let (first, end) = if gif {
        (path.clone(), path)
    } else {
        (numbered(&path, 0), numbered(&path, frames - 1))
    };
    if first == end {
        verbosity.say(first.display());
    } else {
        verbosity.say(format!("{} to {}", first.display(), end.display()));
    }
    tell(args, &json!({ "frames": all_stats }))?;
    Ok(Made {
        inputs: base.files,
        result: first,
    })
}
