//! A climbed ladder becomes a [`Report`]: the planes, maps and numbers that the folder of a comparison shows.

use std::time::Instant;

use rastray_compare::{Comparison as Measured, Encoding, ImageView, Map, Viewing, summarize};
use serde_json::{Value, json};

use super::difference::{compared, magnitude, signed};
use super::equation::{Form, Term};
use super::files::View;
use super::page::live::Input;
use super::page::{Live, NamedPlane, Report, explained};
use super::summary::{Cause, Summary};
use crate::decompose::{CAUSES, Ladder, Views};
use crate::error::Error;
use crate::frame::{LayerIndex, Layers, Plane, sum_in_order};
use crate::import::Imported;
use crate::render::Options;

/// A scene and its ladder, on the way to a report.
#[derive(Debug)]
pub struct Comparison<'a> {
    /// The scene, with what its importer said.
    pub imported: &'a Imported,
    /// Its ladder.
    pub ladder: &'a Ladder,
    /// What was drawn beside the ladder.
    pub views: &'a Views,
    /// What the ladder was climbed with.
    pub options: &'a Options,
    /// How linear values are shown.
    pub view: View,
    /// The command line that made it.
    pub command: String,
    /// The command line that explains a pixel, before and after X Y.
    pub explain: [String; 2],
    /// What was rendered how.
    pub settings: Vec<(String, String)>,
    /// When the work began.
    pub start: Instant,
    /// Seconds until everything was rendered.
    pub render_seconds: f64,
}

impl Comparison<'_> {
    /// Everything that the folder shows, except the layers.
    ///
    /// # Errors
    /// Pictures that cannot be compared, explained or packed.
    pub fn report(&self) -> Result<Report, Error> {
        Ok(Report {
            title: self.imported.scene.name.clone(),
            command: self.command.clone(),
            form: Form::of(&self.imported.scene),
            view: self.view,
            raster: to_f32(&self.ladder.rungs[0]),
            trace: to_f32(&self.ladder.rungs[9]),
            difference: signed(&self.ladder.total())?,
            error: magnitude(&self.ladder.total())?,
            cause_maps: self.cause_maps()?,
            terms: self.terms(),
            buildup: self.buildup(),
            summary: self.summary()?,
            notes: [&self.imported.notes[..], &self.ladder.notes].concat(),
            settings: self.settings.clone(),
            live: self.live()?,
        })
    }

    /// What the page's script works on.
    fn live(&self) -> Result<Live, Error> {
        let scene = &self.imported.scene;
        let explained = explained(scene, self.ladder, self.options)?;
        Live::new(&Input {
            ladder: self.ladder,
            views: self.views,
            shading: scene.raster.shading,
            lights: &scene.light_names(),
            view: self.view,
            explained: &explained,
            explain: &self.explain,
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

    fn summary(&self) -> Result<Summary, Error> {
        let ladder = &self.ladder;
        let (raster, trace) = (to_f32(&ladder.rungs[0]), to_f32(&ladder.rungs[9]));
        let (width, height) = (raster.width, raster.height);
        let reference = compared(ImageView::new(
            width,
            height,
            &raster.data,
            Encoding::Linear,
        ))?;
        let test = compared(ImageView::new(width, height, &trace.data, Encoding::Linear))?;
        let mut causes = Vec::new();
        for (i, name) in CAUSES.iter().enumerate() {
            let step = compared(summarize(width, height, &ladder.cause(i).data))?;
            causes.push(Cause::new(*name, &step));
        }
        let measured = compared(Measured::new(&test, &reference, Viewing::default()))?;
        let interior = ladder.silhouette.map(|marked| !marked);
        Ok(Summary {
            size: [width, height],
            metrics: measured.metrics(),
            silhouette: compared(measured.metrics_in(&ladder.silhouette.data))?,
            interior: compared(measured.metrics_in(&interior.data))?,
            agreement: ladder.agreement,
            causes,
            residual_max: ladder.residual_max,
            limited_pixels: ladder.limited_pixels as usize,
            counters: counters(ladder),
            seconds: seconds(ladder, self.start, self.render_seconds),
        })
    }
}

fn to_f32(plane: &Plane<[f64; 3]>) -> Plane<[f32; 3]> {
    plane.map(|c| c.map(|x| x as f32))
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
