//! A scene's state told to GL in GL's own words: glLight, glMaterial, glLightModel, culling, depth, projection.
//!
//! In: a [`Scene`], values in f64. Out: GL state, each value rounded once to f32. The modelview is the identity: lights are
//! given in eye space, as vertices are (see the head of [`super`]).

use super::api::{self, Gl};
use crate::gl::{
    ColorControl, ColorMaterial, ColorMaterialMode, Face, LightModel, LightSource, Material,
    ShadeModel,
};
use crate::math::color::Rgb;
use crate::math::{DMat4, DVec3};
use crate::scene::{self, Camera, Cull, FrontFace, Scene};

/// A colour as GL takes it.
pub(super) fn rgba(c: Rgb, alpha: f64) -> [f32; 4] {
    [c[0] as f32, c[1] as f32, c[2] as f32, alpha as f32]
}

/// glLight for light `index`, in eye space, and switches it on. GL 2.1 section 2.14.1, table 2.10.
pub(super) fn set_light(gl: &Gl, index: u32, source: &LightSource) {
    let light = api::LIGHT0 + index;
    gl.light_v(light, api::POSITION, &source.position.map(|x| x as f32));
    gl.light_v(light, api::AMBIENT, &rgba(source.ambient, 1.0));
    gl.light_v(light, api::DIFFUSE, &rgba(source.diffuse, 1.0));
    gl.light_v(light, api::SPECULAR, &rgba(source.specular, 1.0));
    gl.light_v(
        light,
        api::SPOT_DIRECTION,
        &rgba(source.spot_direction, 0.0),
    );
    gl.light(light, api::SPOT_EXPONENT, source.spot_exponent as f32);
    gl.light(light, api::SPOT_CUTOFF, source.spot_cutoff_deg as f32);
    let names = [
        api::CONSTANT_ATTENUATION,
        api::LINEAR_ATTENUATION,
        api::QUADRATIC_ATTENUATION,
    ];
    for (name, value) in names.into_iter().zip(source.attenuation) {
        gl.light(light, name, value as f32);
    }
    gl.enable(light);
}

/// glMaterial of a face. Without `whole`, emission and with it all that no light scales is left out: see
/// [`set_light_model`].
pub(super) fn set_material(gl: &Gl, face: u32, material: &Material, whole: bool) {
    let emission = if whole { material.emission } else { [0.0; 3] };
    gl.material_v(face, api::EMISSION, &rgba(emission, 1.0));
    gl.material_v(face, api::AMBIENT, &rgba(material.ambient, 1.0));
    gl.material_v(face, api::DIFFUSE, &rgba(material.diffuse, material.alpha));
    gl.material_v(face, api::SPECULAR, &rgba(material.specular, 1.0));
    gl.material(face, api::SHININESS, material.shininess as f32);
}

/// Front and back material as GL uses them: a side that is missing, or that one-sided lighting does not look at, is the
/// front's.
pub(super) fn sides<'a>(material: &'a scene::Material, model: &LightModel) -> [&'a Material; 2] {
    let back = material.back.as_ref().filter(|_| model.two_sided);
    [&material.front, back.unwrap_or(&material.front)]
}

/// glColorMaterial, or nothing follows the colour. Terms that follow take it at once: materials are set before.
pub(super) fn set_color_material(gl: &Gl, setting: Option<ColorMaterial>) {
    if let Some(ColorMaterial { face, mode }) = setting {
        let face = match face {
            Face::Front => api::FRONT,
            Face::Back => api::BACK,
            Face::FrontAndBack => api::FRONT_AND_BACK,
        };
        let mode = match mode {
            ColorMaterialMode::Emission => api::EMISSION,
            ColorMaterialMode::Ambient => api::AMBIENT,
            ColorMaterialMode::Diffuse => api::DIFFUSE,
            ColorMaterialMode::Specular => api::SPECULAR,
            ColorMaterialMode::AmbientAndDiffuse => api::AMBIENT_AND_DIFFUSE,
        };
        gl.color_material(face, mode);
    }
    switch(gl, api::COLOR_MATERIAL, setting.is_some());
}

/// glLightModel, GL_NORMALIZE and GL_RESCALE_NORMAL. Without `whole`, the scene's ambient light is black: the second and
/// later passes over a scene with more lights than GL holds add lights alone.
pub(super) fn set_light_model(gl: &Gl, model: &LightModel, whole: bool) {
    let ambient = if whole { model.ambient } else { [0.0; 3] };
    gl.light_model_v(api::LIGHT_MODEL_AMBIENT, &rgba(ambient, 1.0));
    gl.light_model(api::LIGHT_MODEL_LOCAL_VIEWER, i32::from(model.local_viewer));
    gl.light_model(api::LIGHT_MODEL_TWO_SIDE, i32::from(model.two_sided));
    let control = match model.color_control {
        ColorControl::Single => api::SINGLE_COLOR,
        ColorControl::SeparateSpecular => api::SEPARATE_SPECULAR_COLOR,
    };
    gl.light_model(api::LIGHT_MODEL_COLOR_CONTROL, control as i32);
    switch(gl, api::NORMALIZE, model.normalize);
    switch(gl, api::RESCALE_NORMAL, model.rescale_normal);
}

/// Everything else that fixed function takes from a scene: depth, facing, shade model, clamps. No light is on after it.
pub(super) fn set_scene(gl: &Gl, scene: &Scene, shading: ShadeModel, clamp: bool) {
    let image = &scene.image;
    gl.viewport(0, 0, image.width as i32, image.height as i32);
    switch(gl, api::DEPTH_TEST, scene.raster.depth_test);
    gl.depth_func(api::LESS);
    gl.depth_mask(1);
    let [near, far] = scene.raster.depth_range;
    gl.depth_range(near, far);
    switch(gl, api::CULL_FACE, scene.raster.cull != Cull::None);
    gl.cull_face(match scene.raster.cull {
        Cull::Front => api::FRONT,
        Cull::Back | Cull::None => api::BACK,
    });
    gl.front_face(match scene.raster.front_face {
        FrontFace::Ccw => api::CCW,
        FrontFace::Cw => api::CW,
    });
    gl.shade_model(match shading {
        ShadeModel::Flat => api::FLAT,
        ShadeModel::Gouraud | ShadeModel::Phong => api::SMOOTH,
    });
    for off in [
        api::BLEND,
        api::DITHER,
        api::COLOR_MATERIAL,
        api::COLOR_SUM,
        api::VERTEX_PROGRAM_TWO_SIDE,
    ] {
        gl.disable(off);
    }
    set_clamps(gl, clamp);
    let lights = gl.integer(api::MAX_LIGHTS).max(0) as u32;
    (0..lights).for_each(|i| gl.disable(api::LIGHT0 + i));
}

/// GL_BLEND for transparency, which writes no depth; or neither, as [`set_scene`] leaves it.
pub(super) fn set_blending(gl: &Gl, on: bool) {
    switch(gl, api::BLEND, on);
    gl.blend_func(api::SRC_ALPHA, api::ONE_MINUS_SRC_ALPHA);
    gl.depth_mask(u8::from(!on));
}

/// glClampColor: of vertices and fragments; what is read back is never clamped.
pub(super) fn set_clamps(gl: &Gl, clamp: bool) {
    gl.clamp_color(api::CLAMP_VERTEX_COLOR, u32::from(clamp));
    gl.clamp_color(api::CLAMP_FRAGMENT_COLOR, u32::from(clamp));
    gl.clamp_color(api::CLAMP_READ_COLOR, 0);
}

/// glEnable or glDisable.
pub(super) fn switch(gl: &Gl, capability: u32, on: bool) {
    if on {
        gl.enable(capability);
    } else {
        gl.disable(capability);
    }
}

/// The projection of a picture of `size` pixels, and the identity as modelview.
///
/// `shift_px` moves the picture to the right and up, in pixels: so that another place of each pixel meets its centre.
pub(super) fn set_matrices(gl: &Gl, camera: &Camera, size: [f64; 2], shift_px: [f64; 2]) {
    let [x, y] = [0, 1].map(|axis| 2.0 * shift_px[axis] / size[axis]);
    let shift = DMat4::from_translation(DVec3::new(x, y, 0.0));
    let matrix = shift * camera.clip_from_eye(size[0] / size[1]);
    gl.matrix_mode(api::PROJECTION);
    gl.load_matrix(&matrix.to_cols_array().map(|x| x as f32));
    gl.matrix_mode(api::MODELVIEW);
    gl.load_identity();
}
