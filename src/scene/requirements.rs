//! Which features of the model a scene needs, and why: model only what the scene requires.
//!
//! One pass over lights, used materials and flags gives the set (numerics guide, section 7). Only *used* materials and
//! *enabled* lights count; a light whose products with all used materials are zero is dead. The plans of both renderers
//! are built from it, and `inspect` prints it with its reasons. Forcing every feature on ([`Requirements::full`]) must
//! not change a byte.
//!
//! A term that follows the vertex colour counts as not zero, whatever the colours are.
//!
//! Not claimed: that normals are already exactly unit length after the transform. The rotation to eye space rounds, so
//! `normalize` is needed wherever normals are and the flag is on.

use super::{Cull, Fresnel, Scene, Tir};
use crate::gl;
use crate::math::color::Rgb;

/// A feature of the model that a scene can do without.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feature {
    /// Some ambient product is not 0.
    Ambient,
    /// A live positional light's attenuation is not (1, 0, 0).
    Attenuation,
    /// Some diffuse product is not 0.
    Diffuse,
    /// Some used material's emission is not 0.
    Emission,
    /// A specular product is not 0 and its shininess is not 0.
    HalfVector,
    /// A live positional light shades, attenuates or spots.
    LightVector,
    /// Some diffuse or specular product is not 0.
    Normal,
    /// Normals have to be made unit length.
    Normalize,
    /// A specular exponent is neither 0 nor 1.
    Pow,
    /// The tracer casts mirror rays.
    ReflectionRays,
    /// The tracer casts transmitted rays.
    RefractionRays,
    /// The tracer casts shadow rays.
    ShadowRays,
    /// Some specular product is not 0.
    Specular,
    /// A live positional light has a cone.
    Spot,
    /// That cone has an exponent that is not 0.
    SpotPow,
    /// A transmitted ray can meet total internal reflection.
    Tir,
    /// Back faces are lit apart.
    TwoSide,
    /// The direction to the viewer has to be computed.
    ViewVector,
}

impl Feature {
    /// Every feature with its name in `inspect --json`, sorted by name.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("ambient", Self::Ambient),
        ("attenuation", Self::Attenuation),
        ("diffuse", Self::Diffuse),
        ("emission", Self::Emission),
        ("half_vector", Self::HalfVector),
        ("light_vector", Self::LightVector),
        ("normal", Self::Normal),
        ("normalize", Self::Normalize),
        ("pow", Self::Pow),
        ("reflection_rays", Self::ReflectionRays),
        ("refraction_rays", Self::RefractionRays),
        ("shadow_rays", Self::ShadowRays),
        ("specular", Self::Specular),
        ("spot", Self::Spot),
        ("spot_pow", Self::SpotPow),
        ("tir", Self::Tir),
        ("two_side", Self::TwoSide),
        ("view_vector", Self::ViewVector),
    ];

    /// The name in reports.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }

    /// What a scene without this feature is spared.
    pub fn saves(self) -> &'static str {
        match self {
            Self::Ambient => "the ambient term of the scene and of each light",
            Self::Attenuation => "a division a point and light",
            Self::Diffuse => "the diffuse term of each light",
            Self::Emission => "a constant term",
            Self::HalfVector => "half vectors and n.h, for each point that a light faces",
            Self::LightVector => "a square root and a division a point and light",
            Self::Normal => "the interpolation of normals, and n.l for each light",
            Self::Normalize => "a square root a normal",
            Self::Pow => "a logarithm and an exponential a highlight",
            Self::ReflectionRays => "mirror rays, and all that they meet",
            Self::RefractionRays => "transmitted rays, and all that they meet",
            Self::ShadowRays => "a ray for each light that faces a hit",
            Self::Specular => "highlights: half vectors and powers with them",
            Self::Spot => "a cone test a point and light",
            Self::SpotPow => "a logarithm and an exponential a point and light",
            Self::Tir => "the bending of transmitted rays, and the test for total reflection",
            Self::TwoSide => "turned normals, and a second material",
            Self::ViewVector => "a square root and a division a point",
        }
    }
}

/// The renderer that the requirements are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The rasterizer: local terms only.
    Raster,
    /// The tracer.
    Trace,
}

/// How much of the model a render evaluates; the bytes are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// Only what the scene requires (the default).
    #[default]
    Required,
    /// Everything, needed or not.
    Full,
}

/// The features a scene needs, each with its first reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Requirements {
    reasons: [Option<String>; Feature::NAMES.len()],
    /// Per enabled light: it shades or adds ambient to some used material. A dead light is skipped.
    pub live_lights: Vec<bool>,
    full: bool,
}

impl Requirements {
    /// What a plan is built from: the scene's needs at any depth, since a plan is drawn at several; or everything.
    pub fn plan(scene: &Scene, mode: Mode, model: Model) -> Self {
        match model {
            Model::Required => Self::at_depth(scene, mode, 1),
            Model::Full => Self::full(scene),
        }
    }

    /// What a scene needs in a renderer.
    pub fn of(scene: &Scene, mode: Mode) -> Self {
        Self::at_depth(scene, mode, scene.trace.depth)
    }

    fn at_depth(scene: &Scene, mode: Mode, depth: u32) -> Self {
        let mut used = vec![false; scene.materials.len()];
        for material in scene.objects.iter().flat_map(|o| &o.materials) {
            used[*material] = true;
        }
        let materials = || {
            scene
                .materials
                .iter()
                .zip(&used)
                .filter(|(_, u)| **u)
                .map(|(m, _)| m)
        };
        // Rays meet back faces whatever the rasterizer culls.
        let culled = mode == Mode::Raster && scene.raster.cull == Cull::Back;
        let two_sided = scene.light_model.two_sided && !culled;
        let mut needs = Self {
            reasons: Default::default(),
            live_lights: Vec::new(),
            full: false,
        };
        for material in materials() {
            needs.scene_terms(scene, material, two_sided);
            if mode == Mode::Trace && depth > 0 {
                needs.secondary_rays(scene, material);
            }
        }
        for light in scene.enabled_lights() {
            let mut live = false;
            for material in materials() {
                live |= needs.light_terms(scene, light, material, mode, two_sided);
            }
            needs.live_lights.push(live);
        }
        if scene.light_model.normalize && needs.has(Feature::Normal) {
            needs.add(Feature::Normalize, || {
                "normalize is on and normals are used".into()
            });
        }
        needs
    }

    /// Every feature on and every light alive: `--model full`.
    pub fn full(scene: &Scene) -> Self {
        Self {
            reasons: std::array::from_fn(|_| Some("--model full".into())),
            live_lights: scene.enabled_lights().map(|_| true).collect(),
            full: true,
        }
    }

    /// Whether this is [`Self::full`]: terms are evaluated even where their product is 0.
    ///
    /// What stays decided by the scene's flags: whether the viewer is local, normals are normalised, sides are lit apart, a
    /// light has a cone; and x^0 = 1, x^1 = x, which are the model's own words. They are not savings.
    pub fn is_full(&self) -> bool {
        self.full
    }

    /// What it was made for: see [`Self::is_full`].
    pub fn model(&self) -> Model {
        if self.full {
            Model::Full
        } else {
            Model::Required
        }
    }

    /// The same without one feature. A plan made of this draws a wrong picture wherever the feature was needed: so tests
    /// show that nothing reported is superfluous.
    #[must_use]
    pub fn without(&self, feature: Feature) -> Self {
        let mut less = self.clone();
        less.reasons[feature as usize] = None;
        less
    }

    /// Whether a feature is needed.
    pub fn has(&self, feature: Feature) -> bool {
        self.reasons[feature as usize].is_some()
    }

    /// The needed features with their reasons, sorted by name.
    pub fn iter(&self) -> impl Iterator<Item = (Feature, &str)> {
        Feature::NAMES
            .iter()
            .filter_map(|(_, f)| self.reasons[*f as usize].as_deref().map(|why| (*f, why)))
    }

    /// The features that are not needed, sorted by name, with what that saves.
    pub fn absent(&self) -> impl Iterator<Item = (Feature, &'static str)> {
        let features = Feature::NAMES.iter().map(|(_, feature)| *feature);
        let absent = features.filter(|feature| !self.has(*feature));
        absent.map(|feature| (feature, feature.saves()))
    }

    fn add(&mut self, feature: Feature, why: impl FnOnce() -> String) {
        let slot = &mut self.reasons[feature as usize];
        if slot.is_none() {
            *slot = Some(why());
        }
    }

    fn scene_terms(&mut self, scene: &Scene, material: &super::Material, two_sided: bool) {
        let name = &material.name;
        for side in &sides(material, two_sided) {
            if nonzero(&side.emission) {
                self.add(Feature::Emission, || format!("material {name} emits"));
            }
            if product(&side.ambient, &scene.light_model.ambient) {
                self.add(Feature::Ambient, || {
                    format!("material {name} under the scene's ambient")
                });
            }
        }
        if two_sided && material.back.is_some() {
            self.add(Feature::TwoSide, || {
                format!("two-sided lighting, and material {name} has a back material")
            });
        }
    }

    fn secondary_rays(&mut self, scene: &Scene, material: &super::Material) {
        let (name, optics) = (&material.name, &material.optics);
        let bends = optics.is_transmissive() && optics.ior != 1.0 && !optics.thin;
        let shares = optics.is_transmissive() && optics.fresnel != Fresnel::Off
            || bends && scene.trace.tir == Tir::Reflect;
        if optics.is_mirror() || shares {
            self.add(Feature::ReflectionRays, || {
                format!("material {name} mirrors")
            });
        }
        if optics.is_transmissive() {
            self.add(Feature::RefractionRays, || {
                format!("material {name} transmits")
            });
            if bends {
                self.add(Feature::Tir, || {
                    format!("material {name} has ior {}", optics.ior)
                });
            }
        }
    }

    /// Adds what one light needs on one material; says whether the light is live there.
    fn light_terms(
        &mut self,
        scene: &Scene,
        light: &super::Light,
        material: &super::Material,
        mode: Mode,
        two_sided: bool,
    ) -> bool {
        let on = || format!("light {} on material {}", light.name, material.name);
        let source = &light.source;
        let mut live = false;
        let mut shades = false;
        for side in &sides(material, two_sided) {
            let diffuse = product(&side.diffuse, &source.diffuse);
            let specular = product(&side.specular, &source.specular);
            let ambient = product(&side.ambient, &source.ambient);
            live |= diffuse || specular || ambient;
            shades |= diffuse || specular;
            if ambient {
                self.add(Feature::Ambient, on);
            }
            if diffuse {
                self.add(Feature::Diffuse, on);
            }
            if specular {
                self.specular(scene, side.shininess, on);
            }
        }
        if shades {
            self.add(Feature::Normal, on);
            if two_sided {
                self.add(Feature::TwoSide, || {
                    format!("two-sided lighting, and {}", on())
                });
            }
            if mode == Mode::Trace {
                self.add(Feature::ShadowRays, on);
            }
        }
        if live && source.position[3] != 0.0 {
            self.positional(light, shades);
        }
        live
    }

    fn specular(&mut self, scene: &Scene, shininess: f64, on: impl Fn() -> String) {
        self.add(Feature::Specular, &on);
        if shininess == 0.0 {
            return;
        }
        self.add(Feature::HalfVector, || {
            format!("{}, shininess {shininess}", on())
        });
        if scene.light_model.local_viewer {
            self.add(Feature::ViewVector, || format!("local viewer, {}", on()));
        }
        if shininess != 1.0 {
            self.add(Feature::Pow, || format!("{}, shininess {shininess}", on()));
        }
    }

    fn positional(&mut self, light: &super::Light, shades: bool) {
        let source = &light.source;
        let attenuates = source.attenuation != [1.0, 0.0, 0.0];
        let spots = source.spot_cutoff_deg != 180.0;
        let name = &light.name;
        if shades || attenuates || spots {
            self.add(Feature::LightVector, || {
                format!("light {name} has a position")
            });
        }
        if attenuates {
            self.add(Feature::Attenuation, || {
                format!("light {name} has attenuation {:?}", source.attenuation)
            });
        }
        if spots {
            self.add(Feature::Spot, || {
                format!(
                    "light {name} has a cone of {} degrees",
                    source.spot_cutoff_deg
                )
            });
            if source.spot_exponent != 0.0 {
                self.add(Feature::SpotPow, || {
                    format!("light {name} has spot exponent {}", source.spot_exponent)
                });
            }
        }
    }
}

/// The GL materials that can be seen: the front, and the back under two-sided lighting. Terms that follow the vertex colour
/// count as white: any colour may come.
fn sides(material: &super::Material, two_sided: bool) -> Vec<gl::Material> {
    let back = material.back.as_ref().filter(|_| two_sided);
    let sides = std::iter::once(&material.front).chain(back);
    sides
        .map(|side| side.with_color(gl::CURRENT_COLOR))
        .collect()
}

fn nonzero(c: &Rgb) -> bool {
    c.iter().any(|x| *x != 0.0)
}

fn product(a: &Rgb, b: &Rgb) -> bool {
    a.iter().zip(b).any(|(x, y)| *x != 0.0 && *y != 0.0)
}
