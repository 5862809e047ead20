//! `rastray compare`: both pictures and every difference, into a folder.

use std::cell::Cell;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rastray::decompose::{self, CAUSES, Ladder, decompose};
use rastray::error::Error;
use rastray::frame::{LayerIndex, Layers, Plane, sum_in_order};
use rastray::import::Imported;
use rastray::render::Options;
use rastray::report::Report;
use rastray::report::causes;
use rastray::report::equation::{Form, Term};
use rastray::report::files::{self, View};
use rastray::report::layered;
use rastray::report::page::NamedPlane;
use rastray::report::summary::{Agreement, Cause, Coverage, Summary};
use rastray::scene::Scene;
use rastray::scene::tessellate::DEFAULT_LEVEL;
use rastray_compare::{
    Comparison as Measured, Encoding, ImageView, Map, Reduction, Viewing, magnitude_map,
    signed_map, summarize,
};
use serde_json::{Value, json};

use super::args::{AgainstArg, CompareArgs};
use super::options::{Verbosity, apply, view};
use super::progress::Progress;
use super::watch::{Made, follow};
use super::{commands, live, opengl};

/// Steps that progress hears of: those of the ladder, and the report.
const STEPS: u64 = 12;

/// Exit code 1 where a threshold was asked for and is exceeded.
pub(super) fn compare(args: &CompareArgs, verbosity: Verbosity) -> Result<ExitCode, Error> {
    let peer = args.against == AgainstArg::Opengl;
    if peer {
        opengl::check("--against opengl")?;
    }
    let lonely = [
        ("--driver-info", args.driver_info),
        ("--max-error", args.max_error.is_some()),
    ];
    if let Some((flag, _)) = lonely.into_iter().find(|(_, given)| *given && !peer) {
        let message = "compares with a driver, and there is none";
        return Err(Error::parameter(flag, message).with_help("add --against opengl"));
    }
    let over = Cell::new(false);
    follow(args.follow, &args.scene.scene, verbosity, || {
        if !peer {
            return once(args, verbosity);
        }
        let (made, exceeded) = opengl::compare(args, verbosity)?;
        over.set(exceeded);
        Ok(made)
    })?;
    Ok(ExitCode::from(u8::from(over.get())))
}

fn once(args: &CompareArgs, verbosity: Verbosity) -> Result<Made, Error> {
    let start = Instant::now();
    let mut imported = commands::load(&args.scene, &[], verbosity)?;
    let options = apply(&args.quality, &mut imported)?;
    let path = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}-compare", imported.scene.name)));
    files::check_folder(&path, "--output")?;
    let (progress, done) = (Progress::new(verbosity, STEPS), AtomicU64::new(0));
    let step = |name: &str| progress.step(done.fetch_add(1, Ordering::Relaxed), name);
    let ladder = decompose(&imported.scene, &options, &step)?;
    let views = decompose::views(&imported.scene, &options, &ladder, &step)?;
    let render_seconds = start.elapsed().as_secs_f64();
    step("figures and page");
    let comparison = Comparison {
        imported: &imported,
        ladder: &ladder,
        live: &live::Source {
            args,
            scene: &imported.scene,
            ladder: &ladder,
            views: &views,
            options: &options,
        },
    };
    let settings = settings(&imported.scene, &options);
    let view = view(&args.quality);
    let report = comparison.report(view, settings, start, render_seconds)?;
    let exr = || live::layers(&ladder, &views, &imported.scene);
    let exr = || layered::exr(Some(&ladder.trace_color), view, &exr());
    let (layers, files) = rayon::join(exr, || report.files());
    let (layers, files) = (layers?, files?);
    files::create_folder(&path)?;
    files::write_bytes_atomic(&path.join("layers.exr"), &layers)?;
    Report::write_files(&path, &files)?;
    drop(progress);
    let page = path.join("index.html");
    let summary = &report.summary;
    let pixels = summary.size[0] * summary.size[1];
    let digest = causes::digest(summary.metrics.rmse, &summary.causes, pixels);
    verbosity.say(digest);
    verbosity.say(summary.as_seen());
    verbosity.say(page.display());
    if args.json {
        let text = report.summary.to_json();
        commands::print(&text.map_err(|e| Error::limit(format!("summary.json: {e}")))?)?;
    }
    Ok(Made {
        inputs: imported.files,
        result: page,
    })
}

/// Pictures of non-empty, finite planes of one size cannot be refused; if they are, it says so.
pub(super) fn figure<T>(result: Result<T, rastray_compare::CompareError>) -> Result<T, Error> {
    result.map_err(|e| Error::limit(format!("cannot compare the pictures: {e}")))
}

fn to_f32(plane: &Plane<[f64; 3]>) -> Plane<[f32; 3]> {
    plane.map(|c| c.map(|x| x as f32))
}

/// The signed map of a difference.
pub(super) fn signed(difference: &Plane<[f64; 3]>) -> Result<Map, Error> {
    let Plane {
        width,
        height,
        data,
    } = difference;
    figure(signed_map(*width, *height, data, Reduction::Largest))
}

/// The false-colour map of a difference's magnitude.
fn error(difference: &Plane<[f64; 3]>) -> Result<Map, Error> {
    let Plane {
        width,
        height,
        data,
    } = difference;
    figure(magnitude_map(*width, *height, data, Reduction::Largest))
}

/// A scene and its ladder, on the way to a report.
struct Comparison<'a> {
    imported: &'a Imported,
    ladder: &'a Ladder,
    live: &'a live::Source<'a>,
}

impl Comparison<'_> {
    /// Everything that the folder shows, except the layers.
    fn report(
        &self,
        view: View,
        settings: Vec<(String, String)>,
        start: Instant,
        render_seconds: f64,
    ) -> Result<Report, Error> {
        Ok(Report {
            title: self.imported.scene.name.clone(),
            command: command_line(),
            form: Form::of(&self.imported.scene),
            view,
            raster: to_f32(&self.ladder.rungs[0]),
            trace: to_f32(&self.ladder.rungs[9]),
            difference: signed(&self.ladder.total())?,
            error: error(&self.ladder.total())?,
            cause_maps: self.cause_maps()?,
            terms: self.terms(),
            buildup: self.buildup(),
            summary: self.summary(start, render_seconds)?,
            notes: [&self.imported.notes[..], &self.ladder.notes].concat(),
            settings,
            live: self.live.pack(view)?,
        })
    }

    /// One map a cause, in ladder order.
    fn cause_maps(&self) -> Result<Vec<Map>, Error> {
        (0..CAUSES.len())
            .map(|i| signed(&self.ladder.cause(i)))
            .collect()
    }

    /// Each layer of the traced picture; the remainder is rounding, not a term.
    fn terms(&self) -> Vec<NamedPlane> {
        let layers = &self.ladder.trace_layers;
        let named = layers
            .names
            .iter()
            .zip(&layers.planes)
            .filter(|(name, _)| *name != "remainder");
        named
            .map(|(name, plane)| NamedPlane {
                name: name.clone(),
                plane: plane.clone(),
            })
            .collect()
    }

    /// The equation growing term by term: local terms of the primary hits, then shadows, mirror, refraction.
    fn buildup(&self) -> Vec<(Term, Plane<[f32; 3]>)> {
        let local = &self.ladder.local_layers;
        let lights = self.imported.scene.enabled_lights().count();
        let sums = (0..4).map(|kinds| partial_sum(local, lights, kinds));
        let traced = [6, 7, 8].map(|rung| to_f32(&self.ladder.rungs[rung]));
        Term::ALL.into_iter().zip(sums.chain(traced)).collect()
    }

    fn summary(&self, start: Instant, render_seconds: f64) -> Result<Summary, Error> {
        let ladder = &self.ladder;
        let (raster, trace) = (to_f32(&ladder.rungs[0]), to_f32(&ladder.rungs[9]));
        let (width, height) = (raster.width, raster.height);
        let reference = figure(ImageView::new(
            width,
            height,
            &raster.data,
            Encoding::Linear,
        ))?;
        let test = figure(ImageView::new(width, height, &trace.data, Encoding::Linear))?;
        let mut causes = Vec::new();
        for (i, name) in CAUSES.iter().enumerate() {
            let step = figure(summarize(width, height, &ladder.cause(i).data))?;
            causes.push(Cause::new(*name, &step));
        }
        let agreement = &ladder.agreement;
        let coverage = agreement.coverage;
        let measured = figure(Measured::new(&test, &reference, Viewing::default()))?;
        let interior = ladder.silhouette.map(|marked| !marked);
        Ok(Summary {
            size: [width, height],
            metrics: measured.metrics(),
            silhouette: figure(measured.metrics_in(&ladder.silhouette.data))?,
            interior: figure(measured.metrics_in(&interior.data))?,
            agreement: Agreement {
                interior_max: agreement.interior_max,
                interior_mean: agreement.interior_mean,
                edge_pixels: agreement.edge_pixels as usize,
                coverage: Coverage {
                    both: coverage.both as usize,
                    raster_only: coverage.raster_only as usize,
                    trace_only: coverage.trace_only as usize,
                },
            },
            causes,
            residual_max: ladder.residual_max,
            limited_pixels: ladder.limited_pixels as usize,
            counters: counters(ladder),
            seconds: seconds(ladder, start, render_seconds),
        })
    }
}

/// The command line as it could be typed again.
pub(super) fn command_line() -> String {
    let mut words = vec!["rastray".to_owned()];
    words.extend(std::env::args().skip(1).map(|arg| quoted(&arg)));
    words.join(" ")
}

/// A word of a command line, in quotes where a shell would see more in it than a word.
pub(super) fn quoted(arg: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+[]".contains(c);
    if !arg.is_empty() && arg.chars().all(plain) {
        arg.to_owned()
    } else {
        format!("'{}'", arg.replace('\'', "'\\''"))
    }
}

/// What was rendered how, for the page.
pub(super) fn settings(scene: &Scene, options: &Options) -> Vec<(String, String)> {
    let image = &scene.image;
    let pairs = [
        ("size", format!("{}x{}", image.width, image.height)),
        ("samples", image.samples.to_string()),
        (
            "shading",
            format!("{:?}", scene.raster.shading).to_lowercase(),
        ),
        (
            "tessellation",
            options.level.unwrap_or(DEFAULT_LEVEL).to_string(),
        ),
        ("depth", scene.trace.depth.to_string()),
        ("precision", options.precision.name().to_owned()),
        ("snap", scene.raster.snap.name().to_owned()),
        ("isa", options.isa.name().to_owned()),
        ("threads", rayon::current_num_threads().to_string()),
    ];
    pairs.map(|(name, value)| (name.to_owned(), value)).to_vec()
}

/// The picture with emission, then ambient, then diffuse, then specular (`kinds` = 0 to 3), in the stated order.
fn partial_sum(layers: &Layers<f32>, lights: usize, kinds: usize) -> Plane<[f32; 3]> {
    let index = LayerIndex { lights };
    let mut used = vec![LayerIndex::EMISSION];
    if kinds > 0 {
        used.push(LayerIndex::AMBIENT);
        used.extend((0..lights).flat_map(|light| (0..kinds).map(move |k| index.light(light) + k)));
    }
    let first = &layers.planes[0];
    let pixel = |i: usize| {
        sum_in_order(
            used.iter().map(|l| layers.planes[*l].data[i]),
            layers.signed,
        )
    };
    let data = (0..first.data.len()).map(pixel).collect();
    Plane {
        width: first.width,
        height: first.height,
        data,
    }
}

fn counters(ladder: &Ladder) -> serde_json::Map<String, Value> {
    let mut all = serde_json::Map::new();
    all.insert("triangles".into(), json!(ladder.triangles));
    for work in &ladder.work {
        all.insert(format!("rung {}", work.rungs), json!(work.counters));
    }
    all
}

fn seconds(ladder: &Ladder, start: Instant, render: f64) -> serde_json::Map<String, Value> {
    let mut all = serde_json::Map::new();
    for work in &ladder.work {
        all.insert(format!("rung {}", work.rungs), json!(work.seconds));
    }
    all.insert("render".into(), json!(render));
    all.insert("total".into(), json!(start.elapsed().as_secs_f64()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use rastray::import;

    #[test]
    fn the_number_of_steps_is_known() {
        let mut scene = import::load("two-sided", &import::LoadOptions::default())
            .expect("a shipped scene")
            .scene;
        (scene.image.width, scene.image.height) = (8, 6);
        let options = Options {
            level: Some(4),
            ..Options::default()
        };
        let heard = AtomicU64::new(0);
        let step = |_: &str| {
            heard.fetch_add(1, Ordering::Relaxed);
        };
        decompose(&scene, &options, &step).expect("climbs");
        // The views beside the ladder, and the report, are the steps after the ladder's.
        assert_eq!(heard.into_inner() + 2, STEPS);
    }
}
