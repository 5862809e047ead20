//! What only the tracer reads of a material; the rasterizer reads K_T alone, and only to blend.

use crate::math::color::{Rgb, clamp01, luma};

/// How reflection and transmission share the light at a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fresnel {
    /// Fixed weights, as in the lecture (the default).
    #[default]
    Off,
    /// The dielectric equations, unpolarised: reflection += K_T F, transmission = K_T (1 - F).
    Dielectric,
    /// Schlick's approximation of the same.
    Schlick,
}

impl Fresnel {
    /// The one table of names: command line, scene file and reports; the first name of a value is the one to print.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("off", Self::Off),
        ("dielectric", Self::Dielectric),
        ("schlick", Self::Schlick),
    ];
}

/// Mirror weight, transmission and index of refraction.
#[derive(Clone, Debug, PartialEq)]
pub struct Optics {
    /// Weight of the mirror ray (K_S of the lecture's `K_S I_R`). Default 0.
    pub reflection: Rgb,
    /// K_T, the weight of the transmitted ray, once per interface. Default 0.
    pub transmission: Rgb,
    /// Index of refraction of the inside. Default 1.
    pub ior: f64,
    /// A thin surface: rays go straight on, no index involved. Default false.
    pub thin: bool,
    /// Whether Fresnel's equations share the weights. Default off.
    pub fresnel: Fresnel,
}

impl Optics {
    /// Casts mirror rays.
    pub fn is_mirror(&self) -> bool {
        self.reflection.iter().any(|x| *x != 0.0)
    }

    /// Casts transmitted rays.
    pub fn is_transmissive(&self) -> bool {
        self.transmission.iter().any(|x| *x != 0.0)
    }

    /// Alpha of GL's stand-in for transparency: 1 - luminance(K_T), limited to [0, 1]; `None` where the luminance is not
    /// above 0, and the surface opaque. One number for three channels, whatever colour K_T has; index of refraction and
    /// Fresnel's equations play no part.
    pub fn blend_alpha(&self) -> Option<f64> {
        let luminance = luma(self.transmission);
        (luminance > 0.0).then(|| 1.0 - clamp01(luminance))
    }
}

impl Default for Optics {
    fn default() -> Self {
        let fresnel = Fresnel::Off;
        Self {
            reflection: [0.0; 3],
            transmission: [0.0; 3],
            ior: 1.0,
            thin: false,
            fresnel,
        }
    }
}
