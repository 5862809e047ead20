//! The lights of a frame, and which parts of the equation are evaluated for them: what the scene requires, and no more.
//!
//! [`Rig::new`] leaves out what each pair of light and material cannot show: terms whose product is 0, directions that
//! nothing uses. [`Rig::planned`] follows a scene's [`Requirements`] instead, one switch a feature: those it lacks are not
//! evaluated, whatever the products say. For a scene's own requirements the two make the same bits, since what is left out
//! is +0, or a factor of 1; under `--model full` every product is evaluated, zero or not, and the bits are the same again.

use super::Light;
use super::faults::Faults;
use super::parts::Has;
use super::{PointLight, Power};
use crate::gl;
use crate::lanes::Real;
use crate::scene::requirements::{Feature, Requirements};

/// Lights resolved for one frame, in eye space.
///
/// ```
/// use rastray::{gl, lighting::Rig};
/// let rig = Rig::<f32>::new(&[gl::LightSource::default()], &gl::LightModel::default());
/// assert_eq!(rig.light_count(), 1);
/// ```
#[derive(Clone, Debug)]
pub struct Rig<R> {
    pub(super) lights: Vec<Light<R>>,
    pub(super) model: gl::LightModel,
    /// Lights that no material can show are passed over.
    pub(super) live: Vec<bool>,
    pub(super) switches: Switches,
    pub(super) faults: Faults,
}

/// Which parts of the equation may be evaluated at all. The others belong to the lights themselves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Switches {
    /// Terms are evaluated even where their product is 0.
    zero_products: bool,
    emission: bool,
    ambient: bool,
    diffuse: bool,
    specular: bool,
    /// Directions to lights that have a position.
    pub(super) light_vector: bool,
    half_vector: bool,
    pow: bool,
}

impl<R: Real> Rig<R> {
    /// Resolves eye-space light sources (the enabled ones, in file order) under a light model.
    pub fn new(lights_eye: &[gl::LightSource], model: &gl::LightModel) -> Self {
        Self {
            lights: lights_eye.iter().map(Light::resolve).collect(),
            model: model.clone(),
            live: vec![true; lights_eye.len()],
            switches: Switches::ALL,
            faults: Faults::default(),
        }
    }

    /// The same lights under an equation with mistakes.
    #[must_use]
    pub fn with_faults(self, faults: Faults) -> Self {
        Self { faults, ..self }
    }

    /// The same, with the parts of the equation that a scene requires; `lights_eye` are that scene's enabled lights.
    ///
    /// ```
    /// use rastray::{gl, lanes::Isa, lighting::*};
    /// use rastray::scene::{Scene, requirements::{Mode, Model, Requirements}};
    /// // A scene without objects has nothing to light: the rig evaluates nothing for its light.
    /// let needs = Requirements::plan(&Scene::default(), Mode::Raster, Model::Required);
    /// let rig = Rig::<f32>::planned(&[], &gl::LightModel::default(), &needs);
    /// let mut points = Points::default();
    /// points.push([0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
    /// let (material, mut sum) = (gl::Material::default(), Default::default());
    /// let counters = shade(Isa::detect(), &rig, &material, &points, None, false, Sink::Sum(&mut sum));
    /// assert_eq!((counters.points, counters.light_evaluations), (1, 0));
    /// ```
    pub fn planned(
        lights_eye: &[gl::LightSource],
        model: &gl::LightModel,
        needs: &Requirements,
    ) -> Self {
        let light = |source| resolve(source, needs);
        Self {
            lights: lights_eye.iter().map(light).collect(),
            model: model.clone(),
            live: needs.live_lights.clone(),
            switches: Switches::of(needs),
            faults: Faults::default(),
        }
    }

    /// How many lights.
    pub fn light_count(&self) -> usize {
        self.lights.len()
    }

    /// The resolved lights, in order.
    pub fn lights(&self) -> &[Light<R>] {
        &self.lights
    }
}

/// A light with the cone, the falloff and the attenuation that are required of it.
fn resolve<R: Real>(source: &gl::LightSource, needs: &Requirements) -> Light<R> {
    let mut source = source.clone();
    // A directional light's spot factor is a constant of its colours: nothing to leave out.
    if source.position[3] != 0.0 {
        if !needs.has(Feature::Spot) {
            source.spot_cutoff_deg = 180.0;
        }
        if !needs.has(Feature::SpotPow) {
            source.spot_exponent = 0.0;
        }
        if !needs.has(Feature::Attenuation) {
            source.attenuation = [1.0, 0.0, 0.0];
        }
    }
    let mut light = Light::resolve(&source);
    let point: Option<&mut PointLight<R>> = match &mut light {
        Light::Directional(_) => None,
        Light::Point(point) => Some(point),
        Light::Spot(spot) => Some(&mut spot.point),
    };
    if let Some(point) = point {
        point.attenuated |= needs.is_full();
    }
    light
}

impl Switches {
    /// Everything that some product asks for.
    const ALL: Self = Self {
        zero_products: false,
        emission: true,
        ambient: true,
        diffuse: true,
        specular: true,
        light_vector: true,
        half_vector: true,
        pow: true,
    };

    fn of(needs: &Requirements) -> Self {
        Self {
            zero_products: needs.is_full(),
            emission: needs.has(Feature::Emission),
            ambient: needs.has(Feature::Ambient),
            diffuse: needs.has(Feature::Diffuse),
            specular: needs.has(Feature::Specular),
            light_vector: needs.has(Feature::LightVector),
            half_vector: needs.has(Feature::HalfVector),
            pow: needs.has(Feature::Pow),
        }
    }

    /// The terms to evaluate, given those whose products are not 0.
    pub(super) fn terms(&self, nonzero: Has) -> Has {
        Has {
            ambient: self.ambient && (nonzero.ambient || self.zero_products),
            diffuse: self.diffuse && (nonzero.diffuse || self.zero_products),
            specular: self.specular && (nonzero.specular || self.zero_products),
        }
    }

    /// The material without the terms that are not evaluated: their colours are black, and follow no vertex colour.
    pub(super) fn material(&self, material: &gl::Material) -> gl::Material {
        let mut material = material.clone();
        let terms = [
            (
                self.emission,
                &mut material.emission,
                &mut material.tracked.emission,
            ),
            (
                self.ambient,
                &mut material.ambient,
                &mut material.tracked.ambient,
            ),
            (
                self.diffuse,
                &mut material.diffuse,
                &mut material.tracked.diffuse,
            ),
            (
                self.specular,
                &mut material.specular,
                &mut material.tracked.specular,
            ),
        ];
        for (on, color, tracked) in terms {
            if !on {
                *color = [0.0; 3];
                *tracked = false;
            }
        }
        material
    }

    /// The power of a highlight with this shininess: without the half vector it is 1, without powers the cosine.
    pub(super) fn power<R: Real>(&self, shininess: f64) -> Power<R> {
        match Power::new(shininess) {
            _ if !self.half_vector => Power::Zero,
            Power::Other(_) if !self.pow => Power::One,
            power => power,
        }
    }
}
