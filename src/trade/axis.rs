//! The knobs, one at a time, and the grid of all of them.
//!
//! An [`Axis`] is what turning one knob does: series of settings, the truth that judges them, the pixels that count, and
//! the law that the numerics guide (section 6) predicts. The grid gives the Pareto front its points.

use serde::Serialize;

use super::setting::{Setting, bounces, has_curves, shading_name};
use super::truth::Truth;
use crate::gl::ShadeModel;
use crate::render::{Precision, Renderer};
use crate::sampling::Pattern;
use crate::scene::tessellate::DEFAULT_LEVEL;
use crate::scene::{Scene, Snap};
use crate::trace::Geometry;

/// Slices of a full turn that are tried.
pub const LEVELS: [u32; 7] = [8, 16, 32, 64, 128, 256, 512];
/// Samples a pixel that are tried.
pub const SAMPLES: [u32; 4] = [1, 4, 16, 64];
/// Generations of secondary rays that are tried: 0 to this.
pub const DEPTHS: u32 = 8;

/// Which pixels an axis is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// All.
    All,
    /// Those away from silhouettes.
    Interior,
    /// Those of curved shapes, away from silhouettes.
    Curved,
    /// Those at silhouettes.
    Silhouette,
}

/// What theory says of the error along a series.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Law {
    /// error = c knob^-slope, the slope between two numbers.
    Power {
        /// Smallest slope.
        low: f64,
        /// Largest slope.
        high: f64,
    },
    /// Each step multiplies the error by at most this.
    Step {
        /// The factor.
        factor: f64,
    },
    /// Choices without an order.
    None,
}

/// Settings that differ in one knob.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Such as "Gouraud".
    pub name: String,
    /// The knob's value and the setting, the value rising.
    pub settings: Vec<(f64, Setting)>,
    /// What theory says.
    pub law: Law,
}

/// What turning one knob does.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// In a word or two.
    pub name: &'static str,
    /// What the knob counts; empty for choices.
    pub knob: &'static str,
    /// What judges it.
    pub truth: Truth,
    /// Which pixels count.
    pub part: Part,
    /// The series.
    pub series: Vec<Series>,
}

/// The axes of a scene: those that change something on it.
pub fn axes(scene: &Scene, ideal_samples: u32) -> Vec<Axis> {
    let mut all = vec![shading(scene)];
    all.extend(depth(scene));
    all.push(samples(scene, ideal_samples));
    all.push(renderer(scene));
    all.extend(geometry(scene));
    all.push(precision(scene));
    all.push(snap(scene));
    all.push(offset(scene));
    all
}

/// Settings with names as a series of choices.
fn choices(settings: Vec<(&str, Setting)>) -> Vec<Series> {
    settings
        .into_iter()
        .map(|(name, setting)| Series {
            name: name.to_owned(),
            settings: vec![(1.0, setting)],
            law: Law::None,
        })
        .collect()
}

/// Shading, over the tessellation where the scene has curves.
fn shading(scene: &Scene) -> Axis {
    let base = Setting::by(Renderer::Raster, scene);
    let levels: &[u32] = if has_curves(scene) {
        &LEVELS
    } else {
        &[DEFAULT_LEVEL]
    };
    let series = [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong].map(|model| {
        let law = match (model, levels.len()) {
            (_, 1) => Law::None,
            (ShadeModel::Flat, _) => Law::Power {
                low: 0.85,
                high: 1.15,
            },
            // 1.5 with a terminator or a highlight's border in view.
            (ShadeModel::Gouraud, _) => Law::Power {
                low: 1.4,
                high: 2.15,
            },
            (ShadeModel::Phong, _) => Law::Power {
                low: 1.85,
                high: 2.15,
            },
        };
        let at = |level: &u32| (f64::from(*level), base.shaded(model, *level));
        Series {
            name: shading_name(model).to_owned(),
            settings: levels.iter().map(at).collect(),
            law,
        }
    });
    Axis {
        name: "shading and tessellation",
        knob: if levels.len() > 1 { "slices" } else { "" },
        truth: Truth::Local,
        part: if levels.len() > 1 {
            Part::Curved
        } else {
            Part::Interior
        },
        series: series.into(),
    }
}

/// Generations of secondary rays, where there are any.
fn depth(scene: &Scene) -> Option<Axis> {
    let factor = bounce_weight(scene)?;
    let at = |depth: u32| {
        let trace = Setting::by(Renderer::Trace, scene);
        (f64::from(depth), Setting { depth, ..trace })
    };
    Some(Axis {
        name: "recursion depth",
        knob: "generations of rays",
        truth: Truth::Full,
        part: Part::All,
        series: vec![Series {
            name: "trace".to_owned(),
            settings: (0..=DEPTHS).map(at).collect(),
            law: Law::Step { factor },
        }],
    })
}

/// The largest share of light that a bounce passes on; `None` where nothing mirrors or transmits.
pub fn bounce_weight(scene: &Scene) -> Option<f64> {
    if !bounces(scene) {
        return None;
    }
    let used = scene.objects.iter().flat_map(|o| &o.materials);
    let weight = |m: &usize| {
        let optics = &scene.materials[*m].optics;
        let sum = |c: usize| optics.reflection[c].abs() + optics.transmission[c].abs();
        sum(0).max(sum(1)).max(sum(2))
    };
    Some(used.map(weight).fold(0.0, f64::max))
}

fn samples(scene: &Scene, ideal_samples: u32) -> Axis {
    let series = [("grid", Pattern::Grid), ("jitter", Pattern::Jitter)].map(|(name, pattern)| {
        let at = |samples: u32| {
            let setting = Setting {
                samples,
                pattern,
                ..Setting::by(Renderer::Trace, scene)
            };
            (f64::from(samples), setting)
        };
        Series {
            name: name.to_owned(),
            settings: SAMPLES.map(at).into(),
            law: Law::Power {
                low: 0.65,
                high: 0.85,
            },
        }
    });
    Axis {
        name: "samples",
        knob: "samples a pixel",
        truth: Truth::Ideal(ideal_samples),
        part: Part::Silhouette,
        series: series.into(),
    }
}

fn renderer(scene: &Scene) -> Axis {
    let fine = Setting::by(Renderer::Raster, scene).shaded(ShadeModel::Phong, 256);
    Axis {
        name: "renderer",
        knob: "",
        truth: Truth::Full,
        part: Part::All,
        series: choices(vec![
            ("raster, Phong, 256 slices", fine.plain(scene)),
            ("cast", Setting::by(Renderer::Cast, scene)),
            ("trace", Setting::by(Renderer::Trace, scene)),
        ]),
    }
}

/// The tracer on triangles, where exact shapes differ from them.
fn geometry(scene: &Scene) -> Option<Axis> {
    if !has_curves(scene) {
        return None;
    }
    let exact = Setting::by(Renderer::Trace, scene);
    let mesh = |level: u32| Setting {
        geometry: Geometry::Mesh,
        level,
        ..exact
    };
    Some(Axis {
        name: "geometry",
        knob: "",
        truth: Truth::Full,
        part: Part::All,
        series: choices(vec![
            ("mesh of 16 slices", mesh(16)),
            ("mesh of 64 slices", mesh(64)),
            ("mesh of 256 slices", mesh(256)),
            ("exact shapes", exact),
        ]),
    })
}

/// How far off the surface secondary rays start: the bound of the hit's error, or a fixed distance in scene units.
fn offset(scene: &Scene) -> Axis {
    let by_bound = Setting::by(Renderer::Trace, scene);
    let fixed = |distance: f64| Setting {
        offset: Some(distance),
        ..by_bound
    };
    Axis {
        name: "ray offset",
        knob: "",
        truth: Truth::Full,
        part: Part::All,
        series: choices(vec![
            ("bound of the error", by_bound),
            ("fixed 0", fixed(0.0)),
            ("fixed 10⁻⁶", fixed(1e-6)),
            ("fixed 10⁻³", fixed(1e-3)),
            ("fixed 10⁻²", fixed(1e-2)),
        ]),
    }
}

fn precision(scene: &Scene) -> Axis {
    let single = Setting::by(Renderer::Trace, scene);
    let double = Setting {
        precision: Precision::F64,
        ..single
    };
    Axis {
        name: "precision",
        knob: "",
        truth: Truth::Full,
        part: Part::Interior,
        series: choices(vec![("f32", single), ("f64", double)]),
    }
}

/// The sub-pixel grid, judged on the triangles that are drawn, so that their chords do not drown it.
fn snap(scene: &Scene) -> Axis {
    let base = Setting::by(Renderer::Raster, scene).shaded(ShadeModel::Phong, DEFAULT_LEVEL);
    let named = Snap::NAMES.iter().map(|(name, snap)| {
        let setting = Setting {
            snap: *snap,
            ..base
        };
        (*name, setting)
    });
    Axis {
        name: "sub-pixel grid",
        knob: "",
        truth: Truth::Mesh(DEFAULT_LEVEL),
        part: Part::All,
        series: choices(named.collect()),
    }
}

/// Settings of all knobs that move pixels at their centres, cheap renderers first: what the front is taken from.
pub fn grid(scene: &Scene) -> Vec<Setting> {
    let raster = Setting::by(Renderer::Raster, scene);
    let mut all = Vec::new();
    for shading in [ShadeModel::Flat, ShadeModel::Gouraud, ShadeModel::Phong] {
        all.extend(LEVELS.map(|level| raster.shaded(shading, level)));
    }
    for precision in [Precision::F32, Precision::F64] {
        all.push(Setting {
            precision,
            ..Setting::by(Renderer::Cast, scene)
        });
        let depths: Vec<u32> = match bounce_weight(scene) {
            Some(_) => (0..=DEPTHS).chain([12, 16, scene.trace.depth]).collect(),
            None => vec![scene.trace.depth],
        };
        all.extend(depths.into_iter().map(|depth| Setting {
            precision,
            depth,
            ..Setting::by(Renderer::Trace, scene)
        }));
    }
    let mut kept: Vec<Setting> = Vec::new();
    for setting in all.into_iter().map(|s| s.plain(scene)) {
        if !kept.contains(&setting) {
            kept.push(setting);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::{LoadOptions, load};

    fn scene(name: &str) -> Scene {
        load(name, &LoadOptions::default()).expect("shipped").scene
    }

    #[test]
    fn axes_are_those_that_change_something() {
        let names =
            |scene: &Scene| -> Vec<&str> { axes(scene, 16).iter().map(|a| a.name).collect() };
        let all = names(&scene("whitted"));
        assert!(all.contains(&"recursion depth") && all.contains(&"geometry"));
        let local = names(&scene("two-sided"));
        assert!(!local.contains(&"recursion depth"), "{local:?}");
        // Nothing curved: the tessellation is no knob.
        let vase = scene("vase");
        assert!(!has_curves(&vase) && !names(&vase).contains(&"geometry"));
        assert_eq!(axes(&vase, 16)[0].knob, "");
        assert_eq!(axes(&vase, 16)[0].series[0].settings.len(), 1);
    }

    #[test]
    fn the_grid_has_no_doubles_and_the_base() {
        let scene = scene("whitted");
        let grid = grid(&scene);
        assert!(grid.contains(&Setting::of(&scene)));
        for (i, setting) in grid.iter().enumerate() {
            assert!(!grid[..i].contains(setting), "{}", setting.name(&scene));
        }
        // The glass ball: what it mirrors and what it lets through, together.
        let weight = bounce_weight(&scene).expect("mirrors");
        assert!((weight - 1.02).abs() < 1e-12, "{weight}");
    }
}
