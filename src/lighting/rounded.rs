//! The inputs of the equation rounded to f32, for renders in f64: what the data alone do to a picture.
//!
//! A render in f32 differs from one in f64 by the rounding of what goes into the equation, and by the arithmetic after it.
//! With [`Rounded`] a render in f64 takes the same rounded inputs and computes in f64: what then differs from f32 is the
//! arithmetic, what differs from plain f64 is the conditioning of the inputs. Each is a change of at most half an ulp of f32.
//! A render in f32 pays nothing for it (its numbers are rounded, and the compiler drops the question: callgrind finds none of
//! it); one in f64 pays three tests a point that is to be lit.

use super::{Batches, Light, PointLight, Power, Rig};
use crate::lanes::Real;

/// Which inputs are rounded to f32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rounded {
    /// Positions of points.
    pub positions: bool,
    /// Normals at points.
    pub normals: bool,
    /// Directions to the viewer.
    pub viewers: bool,
    /// Places, directions, axes, attenuation and exponents of the lights.
    pub lights: bool,
}

impl Rounded {
    /// Everything, as a render in f32 has it.
    pub const ALL: Self = Self {
        positions: true,
        normals: true,
        viewers: true,
        lights: true,
    };
}

/// A number as f32 holds it.
pub(super) fn round<R: Real>(x: R) -> R {
    R::from_f64(f64::from(x.to_f64() as f32))
}

/// A vector as f32 holds it, where asked for.
pub(super) fn round_if<R: Real>(yes: bool, v: [R; 3]) -> [R; 3] {
    if yes { v.map(round) } else { v }
}

impl<R: Real> Rig<R> {
    /// The same lights with their parameters rounded to f32, if that is asked for.
    #[must_use]
    pub fn rounding(mut self, rounded: Rounded) -> Self {
        if rounded.lights {
            self.lights.iter_mut().for_each(round_light);
        }
        self
    }
}

impl<R: Real> Batches<R> {
    /// Batches that round what is pushed.
    #[must_use]
    pub fn rounding(mut self, rounded: Rounded) -> Self {
        self.rounded = rounded;
        self
    }
}

fn round_light<R: Real>(light: &mut Light<R>) {
    match light {
        Light::Directional(light) => light.to_light = light.to_light.map(round),
        Light::Point(point) => round_point(point),
        Light::Spot(spot) => {
            round_point(&mut spot.point);
            spot.axis_eye = spot.axis_eye.map(round);
            spot.cos_cutoff = round(spot.cos_cutoff);
            if let Power::Other(exponent) = &mut spot.power {
                *exponent = round(*exponent);
            }
        }
    }
}

fn round_point<R: Real>(point: &mut PointLight<R>) {
    point.position_eye = point.position_eye.map(round);
    point.attenuation = point.attenuation.map(round);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gl;

    #[test]
    fn f64_inputs_become_those_of_f32_and_f32_ones_stay() {
        let source = gl::LightSource {
            position: [0.1, 0.2, 0.3, 1.0],
            attenuation: [0.7, 0.1, 0.0],
            spot_direction: [0.1, 0.2, -0.9],
            spot_cutoff_deg: 33.3,
            spot_exponent: 2.1,
            ..gl::LightSource::default()
        };
        let model = gl::LightModel::default();
        let sources = [source, gl::LightSource::default()];
        let wide = Rig::<f64>::new(&sources, &model).rounding(Rounded::ALL);
        let narrow = Rig::<f32>::new(&sources, &model);
        assert_eq!(
            narrow.clone().rounding(Rounded::ALL).lights(),
            narrow.lights()
        );
        let (Light::Spot(a), Light::Spot(b)) = (&wide.lights()[0], &narrow.lights()[0]) else {
            panic!("a spot light");
        };
        assert_eq!(a.axis_eye, b.axis_eye.map(f64::from));
        assert_eq!(a.point.position_eye, b.point.position_eye.map(f64::from));
        assert_eq!(a.power, Power::Other(f64::from(2.1f32)));
        let mut batches = Batches::<f64>::new(1).rounding(Rounded {
            normals: true,
            ..Rounded::default()
        });
        batches.push(0, 0, [0.1; 3], [0.1; 3], [0.1; 3]);
        let points = &batches.iter().next().expect("a batch").points;
        assert_eq!(points.position[0], [0.1]);
        assert_eq!(points.normal[0], [f64::from(0.1f32)]);
    }
}
