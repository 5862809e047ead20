//! Light sources resolved once per frame: w divided out, axes normalised, cosines exact where GL's angles are.
//!
//! In: [`gl::LightSource`] in eye space. Out: one of three small structs, each of which answers one question,
//! `illuminate`: where is the light, how far, and how much of it arrives (GL 2.1 section 2.14.1, equations for
//! `att_i` and `spot_i`). w = 0 and a cutoff of 180 degrees are never tested again after [`Light::resolve`].

use super::cone::Cone;
use super::vector::{cross_squared, dot3, finite, ln_cosine, unit_and_length, zero_to};
use crate::gl;
use crate::lanes::elementary::exp;
use crate::lanes::{Lanes, Mask, Real};
use crate::math::Each;
use crate::math::color::Rgb;
use crate::math::float::{dot, normalize};

/// What a light sends to some points: the answer of `illuminate`.
#[derive(Clone, Copy, Debug)]
pub struct Incident<L> {
    /// Unit direction from the point to the light; zero where the light is at the point.
    pub to_light: [L; 3],
    /// Distance to the light; +infinity for directional lights.
    pub distance: L,
    /// Attenuation times spot factor.
    pub factor: L,
}

/// Ambient, diffuse and specular colour of a light (unitless, unclamped, may be negative).
///
/// ```
/// use rastray::{gl::LightSource, lighting::Light};
/// let light = Light::<f32>::resolve(&LightSource { ambient: [0.1; 3], ..LightSource::default() });
/// assert_eq!(light.colors().ambient, [0.1; 3]);
/// assert_eq!(light.colors().diffuse, [1.0; 3]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightColors {
    /// Attenuated and spot-scaled, never shadowed.
    pub ambient: Rgb,
    /// See [`gl::LightSource`].
    pub diffuse: Rgb,
    /// See [`gl::LightSource`].
    pub specular: Rgb,
}

/// A light infinitely far away (w = 0). Its spot factor, a constant, is folded into its colours.
///
/// ```
/// use rastray::{gl::LightSource, lighting::Light};
/// let source = LightSource { position: [0.0, 3.0, 4.0, 0.0], ..LightSource::default() };
/// let Light::Directional(light) = Light::<f64>::resolve(&source) else { panic!() };
/// assert_eq!(light.to_light, [0.0, 0.6, 0.8]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionalLight<R> {
    /// Colours, times the spot factor.
    pub colors: LightColors,
    /// The spot factor that the colours hold; 1 without a cone.
    pub spot: f64,
    /// Unit direction to the light (zero for a zero position), eye space.
    pub to_light: [R; 3],
}

/// A light at a place (w != 0), shining everywhere.
///
/// ```
/// use rastray::{gl::LightSource, lighting::Light};
/// let source = LightSource { position: [2.0, 4.0, 6.0, 2.0], ..LightSource::default() };
/// let Light::Point(light) = Light::<f32>::resolve(&source) else { panic!() };
/// assert_eq!(light.position_eye, [1.0, 2.0, 3.0]);
/// assert!(!light.attenuated);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PointLight<R> {
    /// Colours.
    pub colors: LightColors,
    /// Position divided by w, eye space.
    pub position_eye: [R; 3],
    /// Constant, linear, quadratic attenuation.
    pub attenuation: [R; 3],
    /// The attenuation is not (1, 0, 0).
    pub attenuated: bool,
}

/// A power with its two cheap special cases: x^0 = 1 and x^1 = x exactly.
///
/// ```
/// use rastray::lighting::Power;
/// assert_eq!(Power::<f32>::new(0.0), Power::Zero);
/// assert_eq!(Power::<f32>::new(1.0), Power::One);
/// assert_eq!(Power::<f32>::new(200.0), Power::Other(200.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Power<R> {
    /// Exponent 0: the factor is 1, 0^0 included.
    Zero,
    /// Exponent 1: the factor is the cosine.
    One,
    /// Any other exponent, also above GL's 128.
    Other(R),
}

/// A point light with a cone.
///
/// ```
/// use rastray::{gl::LightSource, lighting::Light};
/// let source = LightSource {
///     position: [0.0, 0.0, 0.0, 1.0],
///     spot_direction: [0.0, 0.0, -9.0],
///     spot_cutoff_deg: 60.0,
///     ..LightSource::default()
/// };
/// let Light::Spot(light) = Light::<f32>::resolve(&source) else { panic!() };
/// assert_eq!(light.axis_eye, [0.0, 0.0, -1.0]);
/// assert_eq!(light.cos_cutoff, 0.5); // exactly
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SpotLight<R> {
    /// Place and attenuation.
    pub point: PointLight<R>,
    /// Unit axis of the cone, the way the light travels, eye space; zero if none was given.
    pub axis_eye: [R; 3],
    /// Cosine of the cutoff.
    pub cos_cutoff: R,
    /// Falloff inside the cone.
    pub power: Power<R>,
    /// The exact test, for points near the edge.
    pub cone: Cone,
}

/// A resolved light.
///
/// ```
/// use rastray::{gl::LightSource, lighting::Light};
/// assert!(matches!(Light::<f64>::resolve(&LightSource::default()), Light::Directional(_)));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Light<R> {
    /// w = 0.
    Directional(DirectionalLight<R>),
    /// w != 0, cutoff 180.
    Point(PointLight<R>),
    /// w != 0, any other cutoff.
    Spot(SpotLight<R>),
}

impl<R: Real> Power<R> {
    /// The class of an exponent. One that is not finite counts as 0.
    pub fn new(exponent: f64) -> Self {
        let rounded = R::from_f64(exponent);
        if !rounded.is_finite() || rounded == R::ZERO {
            Self::Zero
        } else if rounded == R::ONE {
            Self::One
        } else {
            Self::Other(rounded)
        }
    }
}

impl<R: Real> Light<R> {
    /// Resolves an eye-space light source.
    pub fn resolve(source: &gl::LightSource) -> Self {
        let colors = LightColors {
            ambient: source.ambient,
            diffuse: source.diffuse,
            specular: source.specular,
        };
        let [x, y, z, w] = source.position;
        // An angle that GL knows no meaning for is read as the nearest one that has: above 90, the half space.
        let cone = (source.spot_cutoff_deg < 180.0)
            .then(|| Cone::new(source.spot_direction, source.spot_cutoff_deg));
        if w == 0.0 {
            return Self::Directional(directional([x, y, z], colors, cone.as_ref(), source));
        }
        let attenuation = source.attenuation.each(finite::<R>);
        let point = PointLight {
            colors,
            position_eye: divide_by_w(source.position),
            attenuation,
            attenuated: attenuation != [R::ONE, R::ZERO, R::ZERO],
        };
        match cone {
            None => Self::Point(point),
            Some(cone) => Self::Spot(SpotLight {
                point,
                axis_eye: normalize(source.spot_direction).0.each(R::from_f64),
                cos_cutoff: R::from_f64(cone.cos_cutoff()),
                power: Power::new(source.spot_exponent),
                cone,
            }),
        }
    }

    /// The light's colours.
    pub fn colors(&self) -> &LightColors {
        match self {
            Self::Directional(light) => &light.colors,
            Self::Point(light) => &light.colors,
            Self::Spot(light) => &light.point.colors,
        }
    }

    /// An upper bound of attenuation times spot factor; +infinity where there is none (a denominator that can reach 0,
    /// a negative spot exponent): then 0 times infinity has to be looked after.
    pub fn largest_factor(&self) -> f64 {
        let bound = |light: &PointLight<R>| {
            let [constant, linear, quadratic] = light.attenuation;
            if linear < R::ZERO || quadratic < R::ZERO || constant <= R::ZERO {
                f64::INFINITY
            } else {
                1.0 / constant.to_f64()
            }
        };
        match self {
            Self::Directional(_) => 1.0,
            Self::Point(light) => bound(light),
            Self::Spot(light) => match light.power {
                Power::Other(exponent) if exponent < R::ZERO => f64::INFINITY,
                _ => bound(&light.point),
            },
        }
    }
}

/// A directional light, its spot factor folded in.
fn directional<R: Real>(
    position: [f64; 3],
    colors: LightColors,
    cone: Option<&Cone>,
    source: &gl::LightSource,
) -> DirectionalLight<R> {
    let (to_light, _) = normalize(position);
    let from_light = to_light.each(|x| -x);
    let spot = match cone {
        None => 1.0,
        // The light travels from its position through the point: the position itself is the point's offset, negated.
        Some(cone) if cone.contains(position.map(|x| -x)) => {
            let q = dot(from_light, normalize(source.spot_direction).0);
            match Power::<f64>::new(source.spot_exponent) {
                Power::Zero => 1.0,
                _ => libm::pow(q.max(0.0), source.spot_exponent),
            }
        }
        Some(_) => 0.0,
    };
    let scale = |c: Rgb| c.each(|x| if x == 0.0 { 0.0 } else { x * spot });
    DirectionalLight {
        colors: LightColors {
            ambient: scale(colors.ambient),
            diffuse: scale(colors.diffuse),
            specular: scale(colors.specular),
        },
        spot,
        to_light: to_light.each(R::from_f64),
    }
}

/// xyz/w, rounded once; a place too far for `R` is brought back along its direction to where `R` still reaches.
fn divide_by_w<R: Real>(position: [f64; 4]) -> [R; 3] {
    let [x, y, z, w] = position;
    let limit = R::MAX.to_f64() / 8.0;
    let divided = [x / w, y / w, z / w];
    let largest = divided.into_iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    if largest <= limit {
        return divided.each(R::from_f64);
    }
    let (unit, _) = normalize([x, y, z]);
    unit.each(|c| R::from_f64(c.copysign(c * w) * limit))
}

impl<R: Real> DirectionalLight<R> {
    /// The same answer everywhere.
    #[inline(always)]
    pub fn illuminate<L: Lanes<Scalar = R>>(&self) -> Incident<L> {
        let [x, y, z] = self.to_light;
        Incident {
            to_light: [L::splat(x), L::splat(y), L::splat(z)],
            distance: L::splat(R::INFINITY),
            factor: L::splat(R::ONE),
        }
    }
}

impl<R: Real> PointLight<R> {
    /// What arrives at some points (GL 2.1 section 2.14.1): VP = ^(P - V), att = 1/(k0 + d (k1 + d k2)), which is
    /// +infinity where the denominator is not positive.
    #[inline(always)]
    pub fn illuminate<L: Lanes<Scalar = R>>(&self, position: &[L; 3]) -> Incident<L> {
        let [x, y, z] = self.position_eye;
        let raw = [
            L::splat(x) - position[0],
            L::splat(y) - position[1],
            L::splat(z) - position[2],
        ];
        let (to_light, distance) = unit_and_length(raw);
        let one = L::splat(R::ONE);
        let factor = if self.attenuated {
            let [constant, linear, quadratic] = self.attenuation;
            // Horner's form: the square of a distance may leave the range, its product with k2 does not.
            let slope = L::splat(quadratic).mul_add(distance, L::splat(linear));
            let denominator = slope.mul_add(distance, L::splat(constant));
            let positive = denominator.gt(L::splat(R::ZERO));
            L::select(positive, one / denominator, L::splat(R::INFINITY))
        } else {
            one
        };
        Incident {
            to_light,
            distance,
            factor,
        }
    }
}

impl<R: Real> SpotLight<R> {
    /// What arrives at some points: nothing outside the cone, q^exponent inside, q = (-VP).s; the edge is inside.
    #[inline(always)]
    pub fn illuminate<L: Lanes<Scalar = R>>(&self, position: &[L; 3]) -> Incident<L> {
        let zero = L::splat(R::ZERO);
        let mut incident = self.point.illuminate(position);
        let spot = self.falloff(incident.to_light, position);
        // 0 times infinity is 0: outside, and where the spot factor is 0, nothing arrives.
        incident.factor = L::select(spot.gt(zero), incident.factor * spot, zero);
        incident
    }

    /// The spot factor: 0 outside the cone.
    #[inline(always)]
    pub(super) fn falloff<L: Lanes<Scalar = R>>(&self, to_light: [L; 3], position: &[L; 3]) -> L {
        let zero = L::splat(R::ZERO);
        let [x, y, z] = self.axis_eye;
        let axis = [L::splat(x), L::splat(y), L::splat(z)];
        let q = -dot3(to_light, axis);
        let inside = self.inside(q, position);
        let spot = match self.power {
            Power::Zero => L::splat(R::ONE),
            Power::One => q.max(zero),
            Power::Other(exponent) => {
                let sin_squared = cross_squared(to_light, axis);
                let log = ln_cosine(sin_squared, q * q);
                let power = exp(L::splat(exponent) * log);
                L::select(q.gt(zero), power, L::splat(zero_to(exponent)))
            }
        };
        L::select(inside & spot.gt(zero), spot, zero)
    }

    /// The cone test: a filter with a margin of 16 units of roundoff (the cosine of two rounded unit vectors is off by
    /// less than 8), and the exact test for the points that it leaves open.
    #[inline(always)]
    fn inside<L: Lanes<Scalar = R>>(&self, q: L, position: &[L; 3]) -> L::Mask {
        let margin = R::ROUNDOFF * R::from_f64(16.0);
        let inside = q.gt(L::splat(self.cos_cutoff + margin));
        let outside = q.lt(L::splat(self.cos_cutoff - margin));
        if (inside | outside).all() {
            return inside;
        }
        let mut answer = [R::ZERO; 16];
        for (i, answer) in answer.iter_mut().enumerate().take(L::WIDTH) {
            let yes = inside.lane(i)
                || (!outside.lane(i) && self.contains([0, 1, 2].each(|a| position[a].lane(i))));
            *answer = if yes { R::ONE } else { R::ZERO };
        }
        L::load(&answer).gt(L::splat(R::ZERO))
    }

    /// Whether a point is inside the cone, edge included: exact.
    #[cold]
    #[inline(never)]
    fn contains(&self, position: [R; 3]) -> bool {
        let offset = [0, 1, 2].each(|a| position[a].to_f64() - self.point.position_eye[a].to_f64());
        self.cone.contains(offset)
    }
}
