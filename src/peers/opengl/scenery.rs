//! A scene on its way into a framebuffer: colours in passes, then triangle numbers.
//!
//! In: a scene, its assembly, lights in eye space. Out: a [`Picture`]. Triangles go over in order, in runs of one material,
//! the provoking vertex last, so that equal depths keep the lowest number as in the rasterizer. Where the scene blends,
//! transmissive triangles follow the opaque ones (GL 2.1 section 4.1.8); without a depth test all keep the file's order.

use std::ops::Range;

use super::api::{self, Arrays, Gl};
use super::shader::{Program, Stage};
use super::target::Target;
use super::{Method, Options, Picture, failed, state};
use crate::error::Error;
use crate::frame::{NONE, Plane};
use crate::gl::{self, ColorMaterial, ColorMaterialMode, LightSource, ShadeModel};
use crate::math::color::clamp_rgb;
use crate::render::Assembled;
use crate::sampling;
use crate::scene::{Camera, Material, Scene, Transparency};

/// Triangles that one draw call takes at most.
const RUN: usize = 1 << 15;
/// Triangle numbers are drawn as two colours, low and high part: f32 holds both exactly.
const NUMBER_BASE: u32 = 1 << 16;

/// A scene on its way into a target.
pub(super) struct Scenery<'a> {
    /// The driver.
    pub(super) gl: &'a Gl,
    /// The scene.
    pub(super) scene: &'a Scene,
    /// Its triangles.
    pub(super) assembled: &'a Assembled,
    /// How to draw.
    pub(super) options: &'a Options,
    /// Enabled lights, eye space.
    pub(super) lights: Vec<LightSource>,
    /// The camera as the driver has it.
    pub(super) camera: Camera,
}

impl Scenery<'_> {
    /// All samples, then the triangle numbers of the first.
    pub(super) fn picture(&self, target: &Target<'_>, method: Method) -> Result<Picture, Error> {
        let samples = self.scene.image.samples;
        let mut sum: Vec<[f64; 3]> = Vec::new();
        let mut window_depth = None;
        for sample in 0..samples {
            self.colors(sample, &method)?;
            if window_depth.is_none() {
                window_depth = Some(target.depths());
            }
            let colors = target.colors();
            sum.resize(colors.data.len(), [0.0; 3]);
            for (sum, color) in sum.iter_mut().zip(&colors.data) {
                for (s, c) in sum.iter_mut().zip(color) {
                    *s += f64::from(*c);
                }
            }
        }
        let primitive = self.numbers(target);
        let (width, height) = (primitive.width, primitive.height);
        let data = sum.into_iter();
        Ok(Picture {
            color: Plane {
                width,
                height,
                data: data.map(|s| sampling::resolve(s, samples)).collect(),
            },
            window_depth: window_depth.unwrap_or_else(|| Plane::filled(width, height, 1.0)),
            primitive,
            method,
            camera: self.camera,
        })
    }

    /// State that colours and numbers share, and an empty picture.
    fn start(&self, sample: u32, clear: [f32; 4], clamp: bool) {
        let (gl, image) = (self.gl, &self.scene.image);
        state::set_scene(gl, self.scene, self.options.shading, clamp);
        let (x, y) = sampling::position(image.pattern, image.samples, 0, 0, sample);
        // The sample lies right of and below the centre by this much: the picture moves left and up.
        let [right, down] = [x, y].map(|p| f64::from(p) / f64::from(sampling::SUBPIXEL) - 0.5);
        let size = [image.width, image.height].map(f64::from);
        state::set_matrices(gl, &self.camera, size, [-right, down]);
        // Vertices without colours; drawing with a colour array leaves the current colour undefined.
        let [r, g, b, a] = gl::CURRENT_COLOR.map(|x| x as f32);
        gl.color_4f(r, g, b, a);
        let [r, g, b, a] = clear;
        gl.clear_color(r, g, b, a);
        gl.clear_depth(1.0);
        gl.clear(api::COLOR_BUFFER_BIT | api::DEPTH_BUFFER_BIT);
    }

    /// One sample's colours.
    fn colors(&self, sample: u32, method: &Method) -> Result<(), Error> {
        let (gl, clamp) = (self.gl, self.options.clamp);
        let background = self.scene.image.background;
        let background = if clamp {
            clamp_rgb(background)
        } else {
            background
        };
        self.start(sample, state::rgba(background, 0.0), clamp);
        let stage = match method {
            Method::FixedFunction { .. } => {
                self.fixed_function();
                return Ok(());
            }
            Method::VertexShader { .. } => Stage::Vertex,
            Method::FragmentShader => Stage::Fragment,
        };
        let model = &self.scene.light_model;
        state::switch(gl, api::COLOR_SUM, stage == Stage::Vertex);
        state::switch(gl, api::VERTEX_PROGRAM_TWO_SIDE, model.two_sided);
        let program = Program::new(gl, stage, model, &self.lights, clamp).map_err(failed)?;
        self.each_run(|sides, arrays| {
            program.set_materials(sides);
            gl.draw_triangles(arrays);
        });
        Ok(())
    }

    /// Lights in groups that GL holds: the first pass with emission and scene ambient, further ones added to it.
    fn fixed_function(&self) {
        let gl = self.gl;
        let most = gl.integer(api::MAX_LIGHTS).max(1) as usize;
        let mut groups: Vec<&[LightSource]> = self.lights.chunks(most).collect();
        if groups.is_empty() {
            groups.push(&[]);
        }
        gl.enable(api::LIGHTING);
        for (pass, group) in groups.into_iter().enumerate() {
            let first = pass == 0;
            state::set_light_model(gl, &self.scene.light_model, first);
            for i in 0..most {
                match group.get(i) {
                    Some(light) => state::set_light(gl, i as u32, light),
                    None => gl.disable(api::LIGHT0 + i as u32),
                }
            }
            if !first {
                // The same triangles have the same depths (GL 2.1 appendix A): each adds to what is seen.
                gl.depth_func(api::EQUAL);
                gl.depth_mask(0);
                gl.enable(api::BLEND);
                gl.blend_func(api::ONE, api::ONE);
            }
            self.each_run(|sides, arrays| {
                // Off while materials are set: terms that follow do not take glMaterial's values.
                state::set_color_material(gl, None);
                state::set_material(gl, api::FRONT, sides[0], first);
                state::set_material(gl, api::BACK, sides[1], first);
                // Emission belongs to the first pass alone, the colour in its place, too.
                let setting = ColorMaterial::of(sides.map(|side| side.tracked));
                let adds = |c: &ColorMaterial| first || c.mode != ColorMaterialMode::Emission;
                state::set_color_material(gl, setting.filter(adds));
                gl.draw_triangles(arrays);
            });
        }
        state::set_color_material(gl, None);
        gl.disable(api::LIGHTING);
    }

    /// Which triangle each pixel shows at the first sample.
    fn numbers(&self, target: &Target<'_>) -> Plane<u32> {
        self.start(0, [-1.0; 4], false);
        self.gl.shade_model(api::FLAT);
        let mut number = 0u32;
        let mut arrays = Arrays::default();
        for range in runs(self.assembled.materials()) {
            if self.alpha(range.start).is_some() {
                number += range.len() as u32;
                continue;
            }
            self.gather(range.clone(), &mut arrays);
            for _ in range {
                let (high, low) = (number / NUMBER_BASE, number % NUMBER_BASE);
                let color = [low as f32, high as f32, 0.0, 1.0];
                arrays.colors.extend([color; 3]);
                number += 1;
            }
            self.gl.draw_triangles(&arrays);
        }
        target.colors().map(|&[low, high, ..]| {
            if low < 0.0 {
                NONE
            } else {
                high as u32 * NUMBER_BASE + low as u32
            }
        })
    }

    /// Hands over the triangles in order, in runs of one material, with colours where it follows them; where the scene blends,
    /// opaque ones first.
    fn each_run(&self, mut draw: impl FnMut([&gl::Material; 2], &Arrays)) {
        let (blends, mut arrays) = (self.scene.blends(), Arrays::default());
        let passes: &[&[bool]] = match (blends, self.scene.raster.depth_test) {
            (true, true) => &[&[false], &[true]],
            (true, false) | (false, _) => &[&[false, true]],
        };
        for pass in passes {
            for range in runs(self.assembled.materials()) {
                let alpha = self.alpha(range.start);
                if !pass.contains(&alpha.is_some()) {
                    continue;
                }
                let material =
                    &self.scene.materials[self.assembled.materials()[range.start] as usize];
                let blended = alpha.map(|alpha| with_alpha(material, alpha));
                let material = blended.as_ref().unwrap_or(material);
                let sides = state::sides(material, &self.scene.light_model);
                self.gather(range.clone(), &mut arrays);
                if sides.iter().any(|side| side.tracked.any()) {
                    self.gather_colors(range, alpha, &mut arrays);
                }
                if blends {
                    state::set_blending(self.gl, alpha.is_some());
                }
                draw(sides, &arrays);
            }
        }
        if blends {
            state::set_blending(self.gl, false);
        }
    }

    /// The vertex colours of consecutive triangles, for materials that follow them.
    fn gather_colors(&self, range: Range<usize>, alpha: Option<f64>, arrays: &mut Arrays) {
        let vertices = self.assembled.triangles()[range].iter().flatten();
        let colors = vertices.filter_map(|v| self.assembled.vertex_color(*v));
        let alpha = alpha.unwrap_or(gl::CURRENT_COLOR[3]);
        arrays.colors.extend(colors.map(|c| state::rgba(c, alpha)));
    }

    /// The alpha that a triangle is blended with; `None` where it is opaque.
    fn alpha(&self, triangle: usize) -> Option<f64> {
        let material = self.assembled.materials()[triangle] as usize;
        let blends = self.scene.raster.transparency == Transparency::Blend;
        let alpha = || self.scene.materials[material].optics.blend_alpha();
        blends.then(alpha).flatten()
    }

    /// Eye-space positions and normals of consecutive triangles, the provoking vertex last.
    fn gather(&self, range: Range<usize>, arrays: &mut Arrays) {
        arrays.clear();
        let assembled = self.assembled;
        // The rasterizer's per-fragment lighting interpolates unit normals; lengths count at vertices only.
        let lengths = self.options.shading != ShadeModel::Phong;
        for vertex in assembled.triangles()[range].iter().flatten() {
            let length = match lengths {
                true => assembled.normal_length(*vertex),
                false => 1.0,
            };
            let normal = assembled.vertex_normal(*vertex);
            let place = assembled.vertex_eye(*vertex);
            arrays.positions.push(place.map(|x| x as f32));
            arrays.normals.push(normal.map(|n| (n * length) as f32));
        }
    }
}

/// The material with an alpha, which GL takes from the diffuse colour (GL 2.1 section 2.14.1).
fn with_alpha(material: &Material, alpha: f64) -> Material {
    let mut material = material.clone();
    material.front.alpha = alpha;
    if let Some(back) = &mut material.back {
        back.alpha = alpha;
    }
    material
}

/// Runs of consecutive equal materials, none longer than [`RUN`].
fn runs(materials: &[u32]) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = 0;
    for end in 1..=materials.len() {
        let full = end - start == RUN;
        if full || end == materials.len() || materials[end] != materials[start] {
            found.push(start..end);
            start = end;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_cover_everything_once_and_in_order() {
        let mut materials = vec![0; RUN + 3];
        materials.extend([1, 1, 0, 2, 2]);
        let found = runs(&materials);
        assert_eq!(found.len(), 5);
        assert_eq!(found[0], 0..RUN);
        let joined: Vec<usize> = found.iter().cloned().flatten().collect();
        assert_eq!(joined, (0..materials.len()).collect::<Vec<_>>());
        for run in found {
            assert!(
                materials[run.clone()]
                    .iter()
                    .all(|m| *m == materials[run.start])
            );
        }
        assert!(runs(&[]).is_empty());
    }
}
