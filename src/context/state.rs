//! Lights, materials, the light model and the fixed state around them (GL 2.1 sections 2.14, 2.11.1, 3.5.1, 4.1.6).
//!
//! A value outside GL's range records `InvalidValue` and keeps the old value. Positions and spot directions are transformed
//! when they are set, by the modelview of that moment (section 2.14.1).

use super::{Capability, Context, GlError, MAX_LIGHTS};
use crate::gl::{self, ColorControl, ColorMaterial, ColorMaterialMode, Face, LightSource};
use crate::math::{DMat3, DVec3, DVec4};
use crate::scene::{FrontFace, Optics};

/// What glLight sets: the ten parameters of a light source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightParameter {
    /// GL_AMBIENT.
    Ambient([f64; 4]),
    /// GL_DIFFUSE.
    Diffuse([f64; 4]),
    /// GL_SPECULAR.
    Specular([f64; 4]),
    /// GL_POSITION in object coordinates; w = 0 is a direction.
    Position([f64; 4]),
    /// GL_SPOT_DIRECTION in object coordinates.
    SpotDirection([f64; 3]),
    /// GL_SPOT_EXPONENT, 0 to 128.
    SpotExponent(f64),
    /// GL_SPOT_CUTOFF in degrees, 0 to 90, or 180.
    SpotCutoff(f64),
    /// GL_CONSTANT_ATTENUATION, 0 or more.
    ConstantAttenuation(f64),
    /// GL_LINEAR_ATTENUATION, 0 or more.
    LinearAttenuation(f64),
    /// GL_QUADRATIC_ATTENUATION, 0 or more.
    QuadraticAttenuation(f64),
}

/// What glMaterial sets. Colour indices are left out, as is colour-index mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaterialParameter {
    /// GL_AMBIENT.
    Ambient([f64; 4]),
    /// GL_DIFFUSE; its alpha is the fragment's.
    Diffuse([f64; 4]),
    /// GL_AMBIENT_AND_DIFFUSE.
    AmbientAndDiffuse([f64; 4]),
    /// GL_SPECULAR.
    Specular([f64; 4]),
    /// GL_EMISSION.
    Emission([f64; 4]),
    /// GL_SHININESS, 0 to 128.
    Shininess(f64),
}

/// What glLightModel sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightModelParameter {
    /// GL_LIGHT_MODEL_AMBIENT.
    Ambient([f64; 4]),
    /// GL_LIGHT_MODEL_LOCAL_VIEWER.
    LocalViewer(bool),
    /// GL_LIGHT_MODEL_TWO_SIDE.
    TwoSide(bool),
    /// GL_LIGHT_MODEL_COLOR_CONTROL.
    ColorControl(ColorControl),
}

fn rgb([r, g, b, _]: [f64; 4]) -> [f64; 3] {
    [r, g, b]
}

impl Context {
    /// glEnable.
    pub fn enable(&mut self, capability: Capability) {
        self.switch(capability, true);
    }

    /// glDisable.
    pub fn disable(&mut self, capability: Capability) {
        self.switch(capability, false);
    }

    /// glIsEnabled. A light beyond [`MAX_LIGHTS`] is not.
    pub fn is_enabled(&self, capability: Capability) -> bool {
        let on = &self.enabled;
        match capability {
            Capability::Lighting => on.lighting,
            Capability::Light(i) => self.lit.get(i).copied().unwrap_or(false),
            Capability::DepthTest => on.depth_test,
            Capability::CullFace => on.cull_face,
            Capability::Normalize => on.normalize,
            Capability::RescaleNormal => on.rescale_normal,
            Capability::ColorMaterial => on.color_material,
        }
    }

    fn switch(&mut self, capability: Capability, on: bool) {
        if !self.outside() {
            return;
        }
        let state = &mut self.enabled;
        match capability {
            Capability::Lighting => state.lighting = on,
            Capability::DepthTest => state.depth_test = on,
            Capability::CullFace => state.cull_face = on,
            Capability::Normalize => state.normalize = on,
            Capability::RescaleNormal => state.rescale_normal = on,
            Capability::ColorMaterial => {
                state.color_material = on;
                self.follow_color();
            }
            Capability::Light(i) => match self.lit.get_mut(i) {
                Some(lit) => *lit = on,
                None => self.error(GlError::InvalidValue),
            },
        }
    }

    /// glLight. Error `InvalidValue` for a value out of range, or a light beyond [`MAX_LIGHTS`]; the old value stays.
    pub fn light(&mut self, light: usize, parameter: LightParameter) {
        use LightParameter as P;
        if !self.outside() {
            return;
        }
        let Some(mut source) = self.lights.get(light).cloned() else {
            return self.error(GlError::InvalidValue);
        };
        let modelview = self.modelview.top();
        match parameter {
            P::Ambient(c) => source.ambient = rgb(c),
            P::Diffuse(c) => source.diffuse = rgb(c),
            P::Specular(c) => source.specular = rgb(c),
            P::Position(p) => source.position = (modelview * DVec4::from_array(p)).to_array(),
            P::SpotDirection(d) => {
                let linear = DMat3::from_mat4(modelview);
                source.spot_direction = (linear * DVec3::from_array(d)).to_array();
            }
            P::SpotExponent(x) => source.spot_exponent = x,
            P::SpotCutoff(x) => source.spot_cutoff_deg = x,
            P::ConstantAttenuation(k) => source.attenuation[0] = k,
            P::LinearAttenuation(k) => source.attenuation[1] = k,
            P::QuadraticAttenuation(k) => source.attenuation[2] = k,
        }
        if source.range_violations().is_empty() {
            self.lights[light] = source;
        } else {
            self.error(GlError::InvalidValue);
        }
    }

    /// A light's parameters, position and spot direction in eye space (glGetLight); `None` beyond [`MAX_LIGHTS`].
    pub fn get_light(&self, light: usize) -> Option<&LightSource> {
        self.lights.get(light)
    }

    /// glLightModel.
    pub fn light_model(&mut self, parameter: LightModelParameter) {
        if !self.outside() {
            return;
        }
        match parameter {
            LightModelParameter::Ambient(c) => self.model.ambient = rgb(c),
            LightModelParameter::LocalViewer(on) => self.model.local_viewer = on,
            LightModelParameter::TwoSide(on) => self.model.two_sided = on,
            LightModelParameter::ColorControl(control) => self.model.color_control = control,
        }
    }

    /// glMaterial; also between begin and end. Terms that follow the current colour do not change (section 2.14.3).
    pub fn material(&mut self, face: Face, parameter: MaterialParameter) {
        use MaterialParameter as P;
        if let P::Shininess(s) = parameter
            && !(0.0..=128.0).contains(&s)
        {
            return self.error(GlError::InvalidValue);
        }
        for (side, back) in [(0, false), (1, true)] {
            if !face.includes(back) {
                continue;
            }
            let material = &mut self.surface.sides[side];
            match parameter {
                P::Ambient(c) => material.ambient = rgb(c),
                P::Diffuse(c) => (material.diffuse, material.alpha) = (rgb(c), c[3]),
                P::AmbientAndDiffuse(c) => {
                    material.ambient = rgb(c);
                    (material.diffuse, material.alpha) = (rgb(c), c[3]);
                }
                P::Specular(c) => material.specular = rgb(c),
                P::Emission(c) => material.emission = rgb(c),
                P::Shininess(s) => material.shininess = s,
            }
        }
        self.follow_color();
    }

    /// The material of a side (glGetMaterial).
    pub fn get_material(&self, back: bool) -> &gl::Material {
        &self.surface.sides[usize::from(back)]
    }

    /// What only the tracer reads of the material from here on: mirror weight, transmission, index of refraction. Not GL's.
    pub fn optics(&mut self, optics: Optics) {
        self.surface.optics = optics;
    }

    /// glColorMaterial: which terms follow the current colour while `ColorMaterial` is enabled.
    pub fn color_material(&mut self, face: Face, mode: ColorMaterialMode) {
        if self.outside() {
            self.color_material = ColorMaterial { face, mode };
            self.follow_color();
        }
    }

    /// The current colour into the terms that follow it; they keep it when `ColorMaterial` is disabled.
    pub(super) fn follow_color(&mut self) {
        if !self.enabled.color_material {
            return;
        }
        for (side, material) in self.surface.sides.iter_mut().enumerate() {
            material.tracked = self.color_material.tracked(side == 1);
            *material = material.with_color(self.color);
        }
    }

    /// glShadeModel: `Gouraud` is GL_SMOOTH (the default). `Phong`, lighting per fragment, is this program's addition.
    pub fn shade_model(&mut self, model: gl::ShadeModel) {
        if self.outside() {
            self.shade_model = model;
        }
    }

    /// glFrontFace.
    pub fn front_face(&mut self, winding: FrontFace) {
        if self.outside() {
            self.front_face = winding;
        }
    }

    /// glCullFace: which side `CullFace` drops. Back by default.
    pub fn cull_face(&mut self, face: Face) {
        if self.outside() {
            self.cull_face = face;
        }
    }

    /// glViewport: the rectangle of the window that ndc fills, from the lower left. Error `InvalidValue` for a negative size.
    pub fn viewport(&mut self, x: i32, y: i32, width: i32, height: i32) {
        if !self.outside() {
            return;
        }
        match (u32::try_from(width), u32::try_from(height)) {
            (Ok(width), Ok(height)) => {
                self.viewport = super::Viewport {
                    x,
                    y,
                    width,
                    height,
                }
            }
            _ => self.error(GlError::InvalidValue),
        }
    }

    /// glDepthRange: window depth of the near and the far plane, each clamped to 0..1.
    pub fn depth_range(&mut self, near: f64, far: f64) {
        if self.outside() {
            self.depth_range = [near, far].map(crate::math::color::clamp01);
        }
    }

    /// glClearColor. Components are clamped to 0..1.
    pub fn clear_color(&mut self, red: f64, green: f64, blue: f64, alpha: f64) {
        if self.outside() {
            self.clear_color = [red, green, blue, alpha].map(crate::math::color::clamp01);
        }
    }
}

/// The lights of a new context.
pub(super) fn default_lights() -> Vec<LightSource> {
    (0..MAX_LIGHTS).map(LightSource::gl_default).collect()
}
