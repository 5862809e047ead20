//! The ten parameters of a GL light source.

use crate::math::color::Rgb;

/// A value outside the range that GL accepts (it would answer INVALID_VALUE and keep the old value).
/// rastray evaluates it all the same, and `inspect` says so.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeViolation {
    /// The parameter, as the scene file names it.
    pub parameter: &'static str,
    /// The value found.
    pub value: f64,
    /// GL's legal range, in words.
    pub legal: &'static str,
}

/// One light source, as glLight sets it (GL 2.1 table 2.10).
///
/// ```
/// let light = rastray::gl::LightSource::gl_default(0);
/// assert_eq!(light.position, [0.0, 0.0, 1.0, 0.0]);
/// assert_eq!(light.diffuse, [1.0; 3]);
/// assert_eq!(rastray::gl::LightSource::gl_default(1).diffuse, [0.0; 3]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LightSource {
    /// Ambient colour; attenuated and spot-scaled, never shadowed. Default black.
    pub ambient: Rgb,
    /// Diffuse colour. rastray's default for every light: white.
    pub diffuse: Rgb,
    /// Specular colour. rastray's default: equal to diffuse.
    pub specular: Rgb,
    /// Homogeneous position: w = 0 is a directional light that shines from (x, y, z). Default (0, 0, 1, 0).
    pub position: [f64; 4],
    /// Axis of the spot cone, any length. Default (0, 0, -1).
    pub spot_direction: [f64; 3],
    /// Exponent of the falloff inside the cone. Default 0; GL accepts 0..128.
    pub spot_exponent: f64,
    /// Half angle of the cone in degrees, or 180 for no cone (the default). GL accepts 0..90 and 180.
    pub spot_cutoff_deg: f64,
    /// Constant, linear and quadratic attenuation. Default (1, 0, 0); GL accepts values >= 0.
    pub attenuation: [f64; 3],
}

impl LightSource {
    /// GL's own defaults for light `index`: only light 0 shines.
    pub fn gl_default(index: usize) -> Self {
        let on = if index == 0 { [1.0; 3] } else { [0.0; 3] };
        Self {
            diffuse: on,
            specular: on,
            ..Self::default()
        }
    }

    /// What GL would refuse of these values.
    pub fn range_violations(&self) -> Vec<RangeViolation> {
        let mut found = Vec::new();
        let mut check = |ok: bool, parameter, value, legal| {
            if !ok {
                found.push(RangeViolation {
                    parameter,
                    value,
                    legal,
                });
            }
        };
        let exponent = self.spot_exponent;
        check(
            (0.0..=128.0).contains(&exponent),
            "spot_exponent",
            exponent,
            "0 to 128",
        );
        let cutoff = self.spot_cutoff_deg;
        let cutoff_ok = (0.0..=90.0).contains(&cutoff) || cutoff == 180.0;
        check(cutoff_ok, "spot_cutoff", cutoff, "0 to 90, or 180");
        for k in self.attenuation {
            check(k >= 0.0, "attenuation", k, "0 or more");
        }
        found
    }
}

impl Default for LightSource {
    /// rastray's defaults: GL's, but white for every light.
    fn default() -> Self {
        Self {
            ambient: [0.0; 3],
            diffuse: [1.0; 3],
            specular: [1.0; 3],
            position: [0.0, 0.0, 1.0, 0.0],
            spot_direction: [0.0, 0.0, -1.0],
            spot_exponent: 0.0,
            spot_cutoff_deg: 180.0,
            attenuation: [1.0, 0.0, 0.0],
        }
    }
}
