//! The equation, plain: one point, one number at a time, in the order of the specification (GL 2.1 section 2.14.1). To be
//! read top to bottom, beside the specification or the lecture's notes; no renderer calls it.
//!
//! In goes one point in eye space, as GL's vertex or the tracer's hit has it after the transforms of section 2.11: lights are
//! in eye space, too, the normal is of the length that it enters the equation with, and what color material and two-sided
//! lighting decide (sections 2.14.3 and 2.14.1) is decided: the material and the side of the normal are those that apply.
//! Out come the primary and the secondary colour, unclamped. The symbols are the specification's; [`super`] has the table.
//!
//! **What the lanes do otherwise**, and why they are longer: they take many points at once and leave out what a light and a
//! material cannot show; they compute a power from the angle's sine and cosine, so that a sharp highlight keeps its last
//! digits near the peak; they decide exactly what lies inside a cone; and they give a value to what the specification leaves
//! open (`Undefined inputs` of the module head). Here such inputs have whatever f64 makes of them.
//!
//! `tests/pictures/lighting_reference.rs` holds the two to each other over all 2094 plain reference cases, in both specular
//! models and with S_L: in f64 they differ by less than 2e-14 of the sum of the absolute values of the terms (1.96e-14 at
//! most, 2026-12). It cannot be 0: a power is `libm::pow` here and exp of a logarithm there, and a cosine that is off by its
//! last bit is a power off by s bits.

use crate::gl::{ColorControl, LightModel, LightSource, Material, SpecularModel};
use crate::math::DVec3;
use crate::math::color::Rgb;

/// The primary and the secondary colour of a point at `v` (eye space) with the normal `n`; `s_l` is S_L of each light, a
/// colour: 1 where nothing stands between, and always 1 for the rasterizer.
///
/// ```
/// use rastray::{gl, lighting::plain, math::DVec3};
/// let light = gl::LightSource { position: [0.0, 0.6, 0.8, 0.0], ..gl::LightSource::default() };
/// let (material, model) = (gl::Material::default(), gl::LightModel::default());
/// let at = |s_l| plain::lit(DVec3::NEG_Z, DVec3::Z, &material, &model, &[(&light, [s_l; 3])]);
/// let [primary, secondary] = at(1.0);
/// assert!((primary[0] - (0.2 * 0.2 + 0.8 * 0.8)).abs() < 1e-15); // a_cm a_cs + [n.VP]+ d_cm d_li
/// assert_eq!(secondary, [0.0; 3]);
/// assert_eq!(at(0.0)[0], [0.2 * 0.2; 3]); // in shadow
/// ```
pub fn lit(
    v: DVec3,
    n: DVec3,
    material: &Material,
    model: &LightModel,
    lights: &[(&LightSource, Rgb)],
) -> [Rgb; 2] {
    let [e_cm, a_cm] = [material.emission, material.ambient].map(DVec3::from_array);
    let [d_cm, s_cm] = [material.diffuse, material.specular].map(DVec3::from_array);
    let a_cs = DVec3::from_array(model.ambient);

    // The viewer: at the eye, or infinitely far along z.
    let at_eye = unit(-v);
    let to_viewer = if model.local_viewer { at_eye } else { DVec3::Z };

    // Emission and scene ambient: scaled by nothing.
    let mut primary = e_cm + a_cm * a_cs;
    let mut secondary = DVec3::ZERO;

    for (light, s_l) in lights {
        let [a_li, d_li, s_li] =
            [light.ambient, light.diffuse, light.specular].map(DVec3::from_array);
        let s_l = DVec3::from_array(*s_l);

        // VP, from the point to the light, and its length before it is made a unit vector.
        let [x, y, z, w] = light.position;
        let directional = w == 0.0;
        let vp = DVec3::new(x, y, z);
        let vp = if directional { vp } else { vp / w - v };
        let (d, vp) = (vp.length(), unit(vp));

        // att: only lights at a place grow dimmer with distance.
        let [k0, k1, k2] = light.attenuation;
        let falloff = k0 + k1 * d + k2 * d * d;
        let att = if directional { 1.0 } else { 1.0 / falloff };

        // spot: 1 without a cone, 0 outside it, the edge inside.
        let axis = unit(DVec3::from_array(light.spot_direction));
        let q = (-vp).dot(axis).max(0.0);
        let spot = if light.spot_cutoff_deg == 180.0 {
            1.0
        } else if q < libm::cos(light.spot_cutoff_deg.to_radians()) {
            0.0
        } else {
            libm::pow(q, light.spot_exponent)
        };

        // [n.VP]+, and the gate: no highlight where the light is at or below the horizon.
        let n_dot_vp = n.dot(vp).max(0.0);
        let f = if n_dot_vp != 0.0 { 1.0 } else { 0.0 };

        // The highlight's cosine: OpenGL's half vector, or the lecture's mirrored light (of the unit normal).
        let cosine = match model.specular_model {
            SpecularModel::HalfVector => n.dot(unit(vp + to_viewer)),
            SpecularModel::Reflection => {
                let n = unit(n);
                to_viewer.dot(2.0 * n.dot(vp) * n - vp)
            }
        };
        let highlight = libm::pow(cosine.max(0.0), material.shininess);

        // The terms. Ambient is dimmed as the others are, and never shadowed.
        let ambient = a_cm * a_li;
        let diffuse = n_dot_vp * d_cm * d_li;
        let specular = f * highlight * s_cm * s_li;
        primary += att * spot * (ambient + diffuse * s_l);
        match model.color_control {
            ColorControl::Single => primary += att * spot * specular * s_l,
            ColorControl::SeparateSpecular => secondary += att * spot * specular * s_l,
        }
    }
    [primary.to_array(), secondary.to_array()]
}

/// A vector of unit length, or zero for zero.
fn unit(v: DVec3) -> DVec3 {
    v.normalize_or_zero()
}
