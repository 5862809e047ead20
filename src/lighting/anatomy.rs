//! The factors of one light at one point, one by one, for whoever explains a colour: what the lanes compute on the way to
//! the terms and do not keep.
//!
//! Every number comes out of the functions that the equation itself calls. n.l keeps its sign here; the equation takes
//! nothing below 0. Where the highlight's cosine has no value (a zero half vector), it is 0.

use super::light::Light;
use super::parts::{mirrored, n_dot_h};
use super::vector::dot3;
use super::{Points, Rig};
use crate::gl::SpecularModel;
use crate::lanes::{Lanes, Real};

/// One light seen from one point.
///
/// ```
/// use rastray::{gl, lighting::{Points, Rig}};
/// let light = gl::LightSource {
///     position: [0.0, 2.0, 0.0, 1.0],
///     attenuation: [0.0, 0.0, 1.0],
///     ..gl::LightSource::default()
/// };
/// let rig = Rig::<f64>::new(&[light], &gl::LightModel::default());
/// let mut points = Points::default();
/// points.push([0.0; 3], [0.0, 0.6, 0.8], [0.0, 1.0, 0.0]);
/// let seen = rig.anatomy(0, &points, 0);
/// assert_eq!((seen.to_light, seen.distance), ([0.0, 1.0, 0.0], 2.0));
/// assert_eq!((seen.n_dot_l, seen.attenuation, seen.spot), (0.6, 0.25, 1.0));
/// assert_eq!(seen.highlight, 0.6); // the half vector of two equal directions is that direction
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anatomy<R> {
    /// Unit direction to the light, eye space; zero where the light is at the point.
    pub to_light: [R; 3],
    /// Distance to the light; +infinity for a directional one.
    pub distance: R,
    /// n.l with the length that the normal enters with, signed.
    pub n_dot_l: R,
    /// n.h, or v.r under the reflection form; signed.
    pub highlight: R,
    /// 1 / (k0 + k1 d + k2 d^2); 1 for a directional light.
    pub attenuation: R,
    /// The spot factor: 0 outside the cone, 1 without one.
    pub spot: R,
}

impl<R: Real> Anatomy<R> {
    /// The same factors in f64, exact.
    pub fn to_f64(&self) -> Anatomy<f64> {
        Anatomy {
            to_light: self.to_light.map(Real::to_f64),
            distance: self.distance.to_f64(),
            n_dot_l: self.n_dot_l.to_f64(),
            highlight: self.highlight.to_f64(),
            attenuation: self.attenuation.to_f64(),
            spot: self.spot.to_f64(),
        }
    }
}

impl<R: Real> Rig<R> {
    /// The factors of a light at one point of a list.
    pub fn anatomy(&self, light: usize, points: &Points<R>, point: usize) -> Anatomy<R> {
        let load = |lists: &[Vec<R>; 3]| [0, 1, 2].map(|k: usize| one(lists[k][point]));
        let position = load(&points.position);
        let (incident, attenuation, spot) = match &self.lights[light] {
            Light::Directional(light) => (light.illuminate(), R::ONE, R::from_f64(light.spot)),
            Light::Point(light) => {
                let incident = light.illuminate(&position);
                (incident, incident.factor.lane(0), R::ONE)
            }
            Light::Spot(light) => {
                let incident = light.point.illuminate(&position);
                let spot = light.falloff(incident.to_light, &position);
                (incident, incident.factor.lane(0), spot.lane(0))
            }
        };
        let (normal, viewer) = (load(&points.normal), load(&points.to_viewer));
        let length = points.normal_length.get(point).copied().unwrap_or(R::ONE);
        let to_light = incident.to_light;
        let n_dot_l = dot3(normal, to_light);
        let highlight = match self.model.specular_model {
            SpecularModel::HalfVector => {
                let half = [0, 1, 2].map(|k| to_light[k] + viewer[k]);
                n_dot_h(normal, one(length), half)
            }
            SpecularModel::Reflection => dot3(viewer, mirrored(normal, n_dot_l, to_light)),
        };
        let highlight = highlight.lane(0);
        Anatomy {
            to_light: to_light.map(|x| x.lane(0)),
            distance: incident.distance.lane(0),
            n_dot_l: (n_dot_l * one(length)).lane(0),
            highlight: if highlight.is_finite() {
                highlight
            } else {
                R::ZERO
            },
            attenuation,
            spot,
        }
    }
}

/// A number as one lane.
fn one<R: Real>(x: R) -> R::Single {
    R::Single::splat(x)
}
