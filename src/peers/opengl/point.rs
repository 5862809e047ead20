//! One vertex lit by the driver: for holding drivers against the specification case by case.
//!
//! In: a [`LightPoint`], state as glLight, glMaterial and glVertex take it. Out: the colour (primary plus secondary) of a
//! point that is drawn there. Unlike in [`super::Driver::draw`], the modelview, the matrix under which lights are set and the
//! normal's transform are the driver's own.

use super::target::Target;
use super::{Driver, api, failed, state};
use crate::error::Error;
use crate::gl::{
    ColorMaterial, ColorMaterialMode, Face, LightModel, LightSource, Material, ShadeModel,
};
use crate::scene::Scene;

/// A vertex, and the state that lights it. Matrices are in OpenGL's order, column by column.
#[derive(Clone, Debug, PartialEq)]
pub struct LightPoint {
    /// Modelview of the vertex.
    pub modelview: [f32; 16],
    /// Modelview under which the lights are set.
    pub light_modelview: [f32; 16],
    /// glVertex4.
    pub vertex: [f32; 4],
    /// glNormal3.
    pub normal: [f32; 3],
    /// The lights, in the space of `light_modelview`.
    pub lights: Vec<LightSource>,
    /// The material of front faces, which points show.
    pub material: Material,
    /// The material of back faces; `None` = the same. Drivers may choose their program by it.
    pub back: Option<Material>,
    /// The light model.
    pub model: LightModel,
    /// GL_COLOR_MATERIAL's tracked parameter of front faces, as glColorMaterial names it.
    pub color_material: Option<ColorMaterialMode>,
    /// glColor4.
    pub color: [f32; 4],
}

impl Driver {
    /// The colour of a point (points show front faces), with or without GL's clamps.
    ///
    /// # Errors
    /// [`Error::Unsupported`] where the driver fails or the point has more lights than GL holds.
    pub fn light_point(&self, point: &LightPoint, clamp: bool) -> Result<[f32; 4], Error> {
        let gl = &self.gl;
        gl.make_current().map_err(failed)?;
        if point.lights.len() > self.info.max_lights {
            return Err(failed(format!(
                "GL holds {} lights, and the point has {}",
                self.info.max_lights,
                point.lights.len()
            )));
        }
        let target = Target::new(gl, 1, 1).map_err(failed)?;
        let mut scene = Scene::default();
        (scene.image.width, scene.image.height) = (1, 1);
        state::set_scene(gl, &scene, ShadeModel::Gouraud, clamp);
        gl.disable(api::DEPTH_TEST);
        state::set_light_model(gl, &point.model, true);
        gl.matrix_mode(api::PROJECTION);
        gl.load_matrix(&to_center(point));
        gl.matrix_mode(api::MODELVIEW);
        gl.load_matrix(&point.light_modelview);
        for (i, light) in point.lights.iter().enumerate() {
            state::set_light(gl, i as u32, light);
        }
        gl.load_matrix(&point.modelview);
        let back = point.back.as_ref().unwrap_or(&point.material);
        state::set_material(gl, api::FRONT, &point.material, true);
        state::set_material(gl, api::BACK, back, true);
        gl.enable(api::LIGHTING);
        if let Some(mode) = point.color_material {
            let face = Face::Front;
            state::set_color_material(gl, Some(ColorMaterial { face, mode }));
        }
        gl.clear_color(0.0, 0.0, 0.0, 0.0);
        gl.clear(api::COLOR_BUFFER_BIT);
        let ([r, g, b, a], [nx, ny, nz]) = (point.color, point.normal);
        let [x, y, z, w] = point.vertex;
        gl.color_4f(r, g, b, a);
        gl.begin(api::POINTS);
        gl.normal_3f(nx, ny, nz);
        gl.vertex_4f(x, y, z, w);
        gl.end();
        gl.color_4f(1.0, 1.0, 1.0, 1.0);
        for off in [api::COLOR_MATERIAL, api::LIGHTING] {
            gl.disable(off);
        }
        let colors = target.colors();
        match gl.get_error() {
            0 => Ok(colors.data[0]),
            code => Err(failed(format!("the driver reports error 0x{code:04X}"))),
        }
    }
}

/// A projection that shows every vertex with this one's w in the middle of the picture: lighting does not look at it.
fn to_center(point: &LightPoint) -> [f32; 16] {
    let m = &point.modelview;
    let w: f64 = (0..4)
        .map(|c| f64::from(m[4 * c + 3]) * f64::from(point.vertex[c]))
        .sum();
    let mut projection = [0.0; 16];
    projection[15] = if w < 0.0 { -1.0 } else { 1.0 };
    projection
}
