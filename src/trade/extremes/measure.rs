//! One cell: the renders, their errors, and what the inputs' rounding explains of them.

use super::{Cell, Condition, Figure, INPUTS, Options};
use crate::error::Error;
use crate::frame::Plane;
use crate::gl::ShadeModel;
use crate::lanes::Isa;
use crate::lighting::Rounded;
use crate::math::color::Rgb;
use crate::render::{self, Job, Picture, Precision, Renderer};
use crate::scene::{LightSpace, Scene};

/// The largest error of a value, relative to max(1, magnitude).
pub const BAR: f64 = 1e-5;
/// The same where a specular or spot exponent is above 1000.
pub const BAR_HIGH_EXPONENT: f64 = 2e-4;

/// Half an ulp of f32, relative: the most that rounding changes an input.
const HALF_ULP: f64 = 1.0 / 16_777_216.0;

/// A picture in f64, whatever drew it.
struct Shot {
    color: Vec<Rgb>,
    object: Vec<u32>,
}

/// A scene about to be drawn in several ways.
struct Bench<'a> {
    scene: &'a Scene,
    level: u32,
    isa: Isa,
}

/// Draws and measures a scene.
pub(super) fn cell(
    name: &'static str,
    setting: String,
    scene: Scene,
    options: &Options,
) -> Result<Cell, Error> {
    let bench = Bench {
        scene: &scene,
        level: options.level,
        isa: options.isa,
    };
    let bar = bench.bar();
    let (raster, raster_picture, mesh) = bench.figure(Renderer::Raster, bar)?;
    let (trace, trace_picture, _) = bench.figure(Renderer::Trace, bar)?;
    let exact = shot(&bench.draw(Renderer::Cast, Precision::F64, Rounded::default())?);
    let same = || (0..mesh.object.len()).filter(|i| mesh.object[*i] == exact.object[*i]);
    let errors = same().flat_map(|i| [0, 1, 2].map(|c| error(mesh.color[i][c], exact.color[i][c])));
    Ok(Cell {
        scene: name,
        setting,
        bar,
        raster,
        trace,
        mesh_rmse: rastray_compare::rmse(std::iter::once(errors)),
        mesh_pixels: mesh.object.len() - same().count(),
        raster_picture,
        trace_picture,
    })
}

/// Of equal infinities none.
fn error(a: f64, b: f64) -> f64 {
    if a == b { 0.0 } else { a - b }
}

fn shot(picture: &Picture) -> Shot {
    Shot {
        color: picture.color_f64().data,
        object: picture.object().data.clone(),
    }
}

impl Bench<'_> {
    fn bar(&self) -> f64 {
        let materials = self.scene.materials.iter();
        let sides = materials.flat_map(|m| m.back.iter().chain([&m.front]));
        let highlights = sides
            .filter(|m| m.specular != [0.0; 3])
            .map(|m| m.shininess);
        let spots = self.scene.enabled_lights().map(|l| l.source.spot_exponent);
        if highlights.chain(spots).any(|exponent| exponent > 1000.0) {
            BAR_HIGH_EXPONENT
        } else {
            BAR
        }
    }

    /// Per fragment on triangles, or on the true shapes: those without shadows and secondary rays are what the rasterizer would
    /// draw of them.
    fn draw(&self, by: Renderer, in_: Precision, rounded: Rounded) -> Result<Picture, Error> {
        let options = render::Options {
            precision: in_,
            level: Some(self.level),
            isa: self.isa,
            ..render::Options::default()
        };
        let mut job = Job::with(self.scene, by, &options).shading(ShadeModel::Phong);
        job.study.rounded = rounded;
        Ok(job.draw()?.picture)
    }

    /// f32 against f64; the picture in f32, and the one in f64.
    fn figure(
        &self,
        renderer: Renderer,
        bar: f64,
    ) -> Result<(Figure, Plane<[f32; 3]>, Shot), Error> {
        let narrow_frame = self.draw(renderer, Precision::F32, Rounded::default())?;
        let narrow = shot(&narrow_frame);
        let wide = shot(&self.draw(renderer, Precision::F64, Rounded::default())?);
        let rounded = shot(&self.draw(renderer, Precision::F64, Rounded::ALL)?);
        let errors = errors(&narrow, &wide);
        let own = errors_explained_by_lights(self, renderer, &narrow, &rounded, bar)?;
        let numbers = narrow.color.iter().chain(&wide.color).flatten();
        let mut figure = Figure {
            error: largest(&errors),
            arithmetic: largest(&own),
            not_numbers: numbers.filter(|x| x.is_nan()).count(),
            objects: objects(&narrow, &wide),
            wrong: objects(&narrow, &rounded),
            over: errors.iter().filter(|e| **e > bar).count(),
            condition: None,
        };
        if !figure.holds(bar) {
            figure.condition = self.condition(renderer, &wide)?;
        }
        Ok((figure, narrow_frame.color_f32(), wide))
    }

    /// The input that changes most when it alone is rounded.
    fn condition(&self, renderer: Renderer, wide: &Shot) -> Result<Option<Condition>, Error> {
        let mut most: Option<Condition> = None;
        for (input, rounded) in INPUTS {
            let moved = shot(&self.draw(renderer, Precision::F64, rounded)?);
            let change = largest(&errors(&moved, wide));
            if most.as_ref().is_none_or(|m| change > m.change) {
                most = Some(Condition {
                    input,
                    change,
                    number: change / HALF_ULP,
                    objects: objects(&moved, wide),
                });
            }
        }
        Ok(most)
    }
}

/// Errors of the arithmetic, pixel by pixel; 0 where it decided at the edge of what a light reaches, and the same decision
/// turns when the lights move by 4 units of roundoff.
fn errors_explained_by_lights(
    bench: &Bench<'_>,
    renderer: Renderer,
    narrow: &Shot,
    rounded: &Shot,
    bar: f64,
) -> Result<Vec<f64>, Error> {
    let mut own = errors(narrow, rounded);
    if largest(&own) <= bar {
        return Ok(own);
    }
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let scene = nudged(bench.scene, axis, sign * 4.0 * HALF_ULP);
            let other = Bench {
                scene: &scene,
                ..*bench
            };
            let moved = errors(
                &shot(&other.draw(renderer, Precision::F64, Rounded::ALL)?),
                rounded,
            );
            for (own, moved) in own.iter_mut().zip(moved) {
                if *own > bar && moved >= 0.5 * *own {
                    *own = 0.0;
                }
            }
        }
    }
    Ok(own)
}

/// The scene with its lights moved along an axis of eye space, by a part of their distance from the eye.
fn nudged(scene: &Scene, axis: usize, part: f64) -> Scene {
    let mut moved = scene.clone();
    let sources = scene.lights_eye();
    let lights = moved.lights.iter_mut().filter(|light| light.enabled);
    for (light, mut source) in lights.zip(sources) {
        let [x, y, z, w] = source.position;
        let length = (x * x + y * y + z * z).sqrt();
        // What a light close to the eye shines on may be farther away than itself.
        let reach = (scene.camera.target - scene.camera.eye).length() * w.abs();
        source.position[axis] += part * length.max(reach);
        (light.source, light.space) = (source, LightSpace::Eye);
    }
    moved
}

/// Largest error of each pixel's values, relative to max(1, magnitude). A value that is no number is infinitely wrong.
fn errors(test: &Shot, truth: &Shot) -> Vec<f64> {
    let error = |a: f64, b: f64| {
        let error = if a == b {
            0.0
        } else {
            (a - b).abs() / b.abs().max(1.0)
        };
        if error.is_nan() { f64::INFINITY } else { error }
    };
    let pixels = test.color.iter().zip(&truth.color);
    pixels
        .map(|(a, b)| (0..3).map(|c| error(a[c], b[c])).fold(0.0, f64::max))
        .collect()
}

fn largest(errors: &[f64]) -> f64 {
    errors.iter().copied().fold(0.0, f64::max)
}

/// Pixels that show different objects.
fn objects(a: &Shot, b: &Shot) -> usize {
    let pairs = a.object.iter().zip(&b.object);
    pairs.filter(|(a, b)| a != b).count()
}
