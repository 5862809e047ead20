//! `rastray compare`: both pictures and every difference, into a folder.

use std::path::PathBuf;
use std::time::Instant;

use rastray::decompose::{self, CAUSES, Ladder, decompose};
use rastray::error::Error;
use rastray::frame::{LayerIndex, Layers, Plane, sum_in_order};
use rastray::import::Imported;
use rastray::report::equation::{Form, Term};
use rastray::report::files::{self, View};
use rastray::report::layered::{self, NamedLayer};
use rastray::report::page::NamedPlane;
use rastray::report::picture::Picture;
use rastray::report::summary::{Agreement, Cause, Coverage, Summary};
use rastray::report::{Report, figures, formats};
use rastray::scene::Scene;
use rastray::scene::tessellate::DEFAULT_LEVEL;
use rastray_compare::{Encoding, ImageView, Map, Reduction, metrics, signed_map, summarize};
use serde_json::{Value, json};

use super::options::{Quality, Verbosity, apply};
use super::{CompareArgs, PrecisionArg, commands};

/// Everything that goes into the folder, with the way to write it.
struct Folder<'a> {
    path: PathBuf,
    view: View,
    verbosity: Verbosity,
    imported: &'a Imported,
    ladder: Ladder,
    /// Option and value, as on the command line.
    settings: Vec<(String, String)>,
}

pub(crate) fn compare(args: &CompareArgs, verbosity: Verbosity) -> Result<(), Error> {
    let start = Instant::now();
    let mut imported = commands::load(&args.scene, verbosity)?;
    let quality = apply(&args.quality, &mut imported.scene)?;
    let path = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}-compare", imported.scene.name)));
    if path.is_file() {
        let message = format!("{}: a file, expected a folder", path.display());
        return Err(Error::parameter("--output", message));
    }
    let options = ladder_options(args, &quality);
    let step = |name: &str| verbosity.step(name);
    let ladder = match args.quality.precision {
        PrecisionArg::F32 => decompose::<f32>(&imported.scene, &options, &step)?,
        PrecisionArg::F64 => decompose::<f64>(&imported.scene, &options, &step)?,
    };
    let render_seconds = start.elapsed().as_secs_f64();
    let view = if args.quality.srgb {
        View::Srgb
    } else {
        View::Linear
    };
    let settings = settings(args, &imported.scene, &quality);
    let folder = Folder {
        path,
        view,
        verbosity,
        imported: &imported,
        ladder,
        settings,
    };
    let summary = folder.write(start, render_seconds)?;
    if args.json {
        return commands::print(&summary);
    }
    verbosity.say(folder.path.join("index.html").display());
    Ok(())
}

fn ladder_options(args: &CompareArgs, quality: &Quality) -> decompose::Options {
    decompose::Options {
        level: quality.level,
        isa: quality.isa,
        model: quality.model,
        shadows: !args.quality.no_shadows,
        reflection: !args.quality.no_reflection,
        refraction: !args.quality.no_refraction,
    }
}

/// Pictures of non-empty, finite planes of one size cannot be refused; if they are, it says so.
fn figure<T>(result: Result<T, rastray_compare::CompareError>) -> Result<T, Error> {
    result.map_err(|e| Error::limit(format!("cannot compare the pictures: {e}")))
}

fn to_f32(plane: &Plane<[f64; 3]>) -> Plane<[f32; 3]> {
    plane.map(|c| c.map(|x| x as f32))
}

impl Folder<'_> {
    fn write(&self, start: Instant, render_seconds: f64) -> Result<String, Error> {
        for folder in [
            self.path.clone(),
            self.path.join("causes"),
            self.path.join("terms"),
        ] {
            files::create_folder(&folder)?;
        }
        let raster = Picture::from_linear(&to_f32(&self.ladder.rungs[0]), self.view)?;
        let trace = Picture::from_linear(&to_f32(&self.ladder.rungs[9]), self.view)?;
        self.png("raster.png", &raster)?;
        self.png("trace.png", &trace)?;
        let difference = self.map(&self.ladder.total())?;
        let picture = Picture::from_map(&difference);
        self.difference(
            "difference.png",
            &picture,
            "difference",
            "trace minus raster",
        )?;
        self.png(
            "side-by-side.png",
            &side_by_side(&raster, &trace, &picture)?,
        )?;
        let cause_maps = self.causes()?;
        let terms = self.terms()?;
        let buildup = self.buildup()?;
        self.layers()?;
        let summary = self.summary(start, render_seconds)?;
        let text = summary
            .to_json()
            .map_err(|e| Error::limit(format!("summary.json: {e}")))?;
        self.bytes("summary.json", text.as_bytes())?;
        let report = Report {
            title: self.imported.scene.name.clone(),
            command: command_line(),
            form: self.form(),
            view: self.view,
            raster: to_f32(&self.ladder.rungs[0]),
            trace: to_f32(&self.ladder.rungs[9]),
            difference,
            cause_maps,
            terms,
            buildup,
            summary,
            notes: self.imported.notes.clone(),
            settings: self.settings.clone(),
        };
        self.bytes("index.html", report.to_html()?.as_bytes())?;
        Ok(text)
    }

    fn bytes(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        self.verbosity.step(name);
        files::write_bytes_atomic(&self.path.join(name), bytes)
    }

    fn png(&self, name: &str, picture: &Picture) -> Result<(), Error> {
        self.bytes(name, &formats::png_of_picture(picture)?)
    }

    /// A difference map with its legend.
    fn difference(&self, name: &str, map: &Picture, title: &str, note: &str) -> Result<(), Error> {
        self.png(
            name,
            &figures::map(figures::Panel {
                picture: map,
                title,
                note,
            })?,
        )
    }

    fn map(&self, difference: &Plane<[f64; 3]>) -> Result<Map, Error> {
        let Plane {
            width,
            height,
            data,
        } = difference;
        figure(signed_map(*width, *height, data, Reduction::Largest))
    }

    /// `causes/NN-NAME.png`, in ladder order.
    fn causes(&self) -> Result<Vec<Map>, Error> {
        let mut maps = Vec::new();
        for (i, name) in CAUSES.iter().enumerate() {
            let map = self.map(&self.ladder.cause(i))?;
            let picture = Picture::from_map(&map);
            let note = format!("step {} of {}", i + 1, CAUSES.len());
            self.difference(
                &format!("causes/{:02}-{name}.png", i + 1),
                &picture,
                name,
                &note,
            )?;
            maps.push(map);
        }
        Ok(maps)
    }

    /// `terms/NN-NAME.png`: each layer of the traced picture.
    fn terms(&self) -> Result<Vec<NamedPlane>, Error> {
        let layers = &self.ladder.trace_layers;
        let mut terms = Vec::new();
        for (i, (name, plane)) in layers.names.iter().zip(&layers.planes).enumerate() {
            if name == "remainder" {
                continue; // rounding, not a term
            }
            let picture = Picture::from_linear(plane, self.view)?;
            self.png(&format!("terms/{i:02}-{}.png", file_name(name)), &picture)?;
            terms.push(NamedPlane {
                name: name.clone(),
                plane: plane.clone(),
            });
        }
        Ok(terms)
    }

    /// `buildup.png`: the equation growing term by term: local terms of the primary hits, then shadows, mirror, refraction.
    fn buildup(&self) -> Result<Vec<(Term, Plane<[f32; 3]>)>, Error> {
        let local = &self.ladder.local_layers;
        let lights = self.imported.scene.enabled_lights().count();
        let mut pictures = Vec::new();
        for kinds in 0..4 {
            pictures.push(partial_sum(local, lights, kinds));
        }
        pictures.extend([6, 7, 8].map(|rung| to_f32(&self.ladder.rungs[rung])));
        let small = pictures
            .iter()
            .map(|plane| Picture::from_linear(plane, self.view))
            .collect::<Result<Vec<_>, _>>()?;
        let steps: Vec<(Term, &Picture)> = Term::ALL.into_iter().zip(&small).collect();
        self.png("buildup.png", &figures::buildup(&steps, self.form())?)?;
        Ok(Term::ALL.into_iter().zip(pictures).collect())
    }

    /// How this scene writes the equation: its specular form, and whether every mirror weight is K_S.
    fn form(&self) -> Form {
        let scene = &self.imported.scene;
        let mut mirrors = scene.materials.iter().filter(|m| m.optics.is_mirror());
        Form {
            specular: scene.light_model.specular_model,
            mirror_is_specular: mirrors.all(|m| m.optics.reflection == m.front.specular),
        }
    }

    /// `layers.exr`: the traced picture, its layers, and the rasterizer's under `raster.*`.
    fn layers(&self) -> Result<(), Error> {
        let ladder = &self.ladder;
        let named = |prefix: &str, layers| -> Vec<NamedLayer<'_>> {
            let layers: &Layers<f32> = layers;
            let pairs = layers.names.iter().zip(&layers.planes);
            pairs
                .map(|(n, plane)| NamedLayer {
                    name: format!("{prefix}{n}"),
                    plane,
                })
                .collect()
        };
        let mut all = named("", &ladder.trace_layers);
        all.extend(named("raster.", &ladder.raster_layers));
        let bytes = layered::exr(Some(&ladder.trace_color), self.view, &all)?;
        self.bytes("layers.exr", &bytes)
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
        Ok(Summary {
            size: [width, height],
            metrics: figure(metrics(&test, &reference))?.into(),
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
fn command_line() -> String {
    let quote = |arg: String| {
        let plain = |c: char| c.is_alphanumeric() || "-_./=,:+[]".contains(c);
        if !arg.is_empty() && arg.chars().all(plain) {
            arg
        } else {
            format!("'{arg}'")
        }
    };
    let mut words = vec!["rastray".to_owned()];
    words.extend(std::env::args().skip(1).map(quote));
    words.join(" ")
}

/// What was rendered how, for the page.
fn settings(args: &CompareArgs, scene: &Scene, quality: &Quality) -> Vec<(String, String)> {
    let image = &scene.image;
    let precision = match args.quality.precision {
        PrecisionArg::F32 => "f32",
        PrecisionArg::F64 => "f64",
    };
    let pairs = [
        ("size", format!("{}x{}", image.width, image.height)),
        ("samples", image.samples.to_string()),
        (
            "shading",
            format!("{:?}", scene.raster.shading).to_lowercase(),
        ),
        (
            "tessellation",
            quality.level.unwrap_or(DEFAULT_LEVEL).to_string(),
        ),
        ("depth", scene.trace.depth.to_string()),
        ("precision", precision.to_owned()),
        ("snap", scene.raster.snap.bits().to_string()),
        ("isa", quality.isa.name().to_owned()),
        ("threads", rayon::current_num_threads().to_string()),
    ];
    pairs.map(|(name, value)| (name.to_owned(), value)).to_vec()
}

/// Layer names hold dots and the user's words; file names keep letters, digits, dots and dashes.
fn file_name(layer: &str) -> String {
    let safe = |c: char| {
        if c.is_alphanumeric() || c == '.' || c == '-' {
            c
        } else {
            '_'
        }
    };
    layer.chars().map(safe).collect()
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

fn side_by_side(raster: &Picture, trace: &Picture, map: &Picture) -> Result<Picture, Error> {
    figures::strip(&[
        figures::Panel {
            picture: raster,
            title: "raster",
            note: "OpenGL: local illumination",
        },
        figures::Panel {
            picture: trace,
            title: "trace",
            note: "Whitted: global illumination",
        },
        figures::Panel {
            picture: map,
            title: "difference",
            note: "trace minus raster",
        },
    ])
}

fn counters(ladder: &Ladder) -> serde_json::Map<String, Value> {
    let mut all = serde_json::Map::new();
    all.insert("triangles".into(), json!(ladder.triangles));
    for work in &ladder.work {
        let value = match (&work.raster, &work.trace) {
            (Some(raster), _) => json!(raster),
            (_, Some(trace)) => json!(trace),
            _ => continue,
        };
        all.insert(format!("rung {}", work.rungs), value);
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
