//! Mirror and transmitted directions, total internal reflection as a value, Fresnel's shares.
//!
//! Directions come out of unit length. Vectors go in with any length; `n` on either side. Snell:
//! n_i sin(i) = n_r sin(r); K = n_r^2 - n_i^2 sin^2(i) decides total internal reflection by its sign, in pairs of f64
//! where it is small, so that 1e-12 rad from the critical angle is decided right (NUMERICS 2, "Refraction"; whitted.md 2).
//! Exactly critical is not total.

use super::exact::{Twofold, cross, cross2, dot2, pairs, unit};
use crate::math::DVec3;
use crate::math::float::gamma;
use crate::scene::Fresnel;

/// What a surface between two media does to a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transmission {
    /// The ray goes on in a direction (unit), with this cosine to the normal behind the surface.
    Through {
        /// Unit direction.
        direction: DVec3,
        /// Cosine of the angle of refraction, 0..=1.
        cosine: f64,
    },
    /// Total internal reflection: no transmitted ray exists.
    Total,
}

/// The mirrored direction d - 2 (d.n) / (n.n) n, of unit length.
///
/// ```
/// use rastray::{math::DVec3, trace::optics::reflect};
/// assert_eq!(reflect(DVec3::new(0.6, -0.8, 0.0), DVec3::Y * 7.0), DVec3::new(0.6, 0.8, 0.0));
/// ```
pub fn reflect(d: DVec3, n: DVec3) -> DVec3 {
    let (d, n) = (unit(d), scaled(n));
    let nn = n.length_squared();
    if nn == 0.0 {
        return d;
    }
    unit(d - n * (2.0 * d.dot(n) / nn))
}

/// The transmitted direction from a medium of index `eta_i` into one of index `eta_t`.
///
/// ```
/// use rastray::{math::DVec3, trace::optics::{Transmission, refract}};
/// let d = DVec3::new(0.8, -0.6, 0.0);
/// assert_eq!(refract(d, DVec3::Y, 1.5, 1.0), Transmission::Total); // sin i = 0.8 > 1 / 1.5
/// let Transmission::Through { direction, .. } = refract(d, DVec3::Y, 1.0, 1.6) else { panic!() };
/// assert!((direction.x - 0.5).abs() < 1e-15);
/// ```
pub fn refract(d: DVec3, n: DVec3, eta_i: f64, eta_t: f64) -> Transmission {
    let (d, n) = (scaled(d), scaled(n));
    let (dd, nn) = (d.length_squared(), n.length_squared());
    if dd == 0.0 || nn == 0.0 {
        let direction = unit(d);
        return Transmission::Through {
            direction,
            cosine: 1.0,
        };
    }
    let sine = cross(d, n); // |d| |n| sin(i)
    // Cosine of refraction: sqrt(K) / eta_t.
    let ratio = eta_i / eta_t;
    let share = 1.0 - ratio * ratio * (sine.length_squared() / (dd * nn));
    let share = if share.abs() < 1e-3 {
        precise_share(d, n, eta_i, eta_t)
    } else {
        share
    };
    if share < 0.0 {
        return Transmission::Total;
    }
    let cosine = share.sqrt();
    // Tangential part n x (d x n), then the normal part on the side that d goes to.
    let tangent = cross(n, sine) * (ratio / (nn * dd.sqrt()));
    let normal = n * (cosine / nn.sqrt());
    let direction = if faces_against(d, n) {
        tangent - normal
    } else {
        tangent + normal
    };
    let direction = unit(direction);
    Transmission::Through { direction, cosine }
}

/// Whether d.n <= 0, decided in pairs of f64 where the plain sum cannot. A ray square to n counts as arriving on its side.
fn faces_against(d: DVec3, n: DVec3) -> bool {
    let plain = d.dot(n);
    // Three products and two sums: off by less than gamma(3) of the products' magnitudes.
    if plain.abs() > gamma::<f64>(3) * (d * n).abs().element_sum() {
        return plain < 0.0;
    }
    dot2(pairs(d), pairs(n)).value() <= 0.0
}

/// K / eta_t^2 in pairs of f64.
fn precise_share(d: DVec3, n: DVec3, eta_i: f64, eta_t: f64) -> f64 {
    let (d, n) = (pairs(d), pairs(n));
    let sine = cross2(d, n);
    let (ei, et) = (Twofold::from(eta_i), Twofold::from(eta_t));
    let lengths = dot2(d, d) * dot2(n, n);
    let k = et * et * lengths - ei * ei * dot2(sine, sine);
    k.value() / (et * et * lengths).value()
}

/// The part of the light that a surface between two dielectrics reflects: 0..=1. Cosines are on either side.
///
/// Dielectric: Fresnel's equations, unpolarised. Schlick: R0 + (1 - R0)(1 - cos)^5 with the cosine on the less dense side.
///
/// ```
/// use rastray::{scene::Fresnel, trace::optics::fresnel};
/// assert!((fresnel(Fresnel::Dielectric, 1.0, 1.0, 1.0, 1.5) - 0.04).abs() < 1e-15);
/// assert!((fresnel(Fresnel::Schlick, 1.0, 1.0, 1.0, 1.5) - 0.04).abs() < 1e-15);
/// ```
pub fn fresnel(model: Fresnel, cos_i: f64, cos_t: f64, eta_i: f64, eta_t: f64) -> f64 {
    match model {
        Fresnel::Off => 0.0,
        Fresnel::Dielectric => {
            let ratio = |a: f64, b: f64| if a + b > 0.0 { (a - b) / (a + b) } else { 1.0 };
            let s = ratio(eta_i * cos_i, eta_t * cos_t);
            let p = ratio(eta_t * cos_i, eta_i * cos_t);
            (s * s + p * p) / 2.0
        }
        Fresnel::Schlick => {
            let r = (eta_i - eta_t) / (eta_i + eta_t);
            let r0 = r * r;
            let m = 1.0 - if eta_i > eta_t { cos_t } else { cos_i };
            let m2 = m * m;
            r0 + (1.0 - r0) * (m2 * m2 * m)
        }
    }
}

/// `v` times a power of two that brings its largest component near 1, so that no square over- or underflows.
fn scaled(v: DVec3) -> DVec3 {
    use crate::lanes::Real;
    let largest = v.abs().max_element();
    if !(largest > 0.0 && v.is_finite()) {
        return DVec3::ZERO;
    }
    let (down, _) = largest.power_of_two_scale();
    v * down
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snell_and_unit_length_hold_at_all_angles() {
        for (ei, et) in [(1.0, 1.5), (1.5, 1.0), (1.33, 2.4), (1.0, 1.0)] {
            for step in 0..90 {
                let i = f64::from(step).to_radians();
                let d = DVec3::new(libm::sin(i), -libm::cos(i), 0.0);
                match refract(d, DVec3::Y * 3.0, ei, et) {
                    Transmission::Total => assert!(libm::sin(i) * ei > et),
                    Transmission::Through { direction, cosine } => {
                        assert!((direction.length() - 1.0).abs() < 1e-15);
                        assert!((direction.x * et - d.x * ei).abs() < 1e-15 * et.max(ei) * 2.0);
                        assert!((direction.y + cosine).abs() < 1e-15);
                    }
                }
            }
        }
    }

    #[test]
    fn critical_angles_are_the_sheets() {
        for (eta, degrees) in [(1.33, 48.7535), (1.5, 41.8103), (2.4, 24.6243)] {
            for (step, total) in [(-1e-4f64, false), (1e-4, true)] {
                let i = (degrees + step).to_radians();
                let d = DVec3::new(libm::sin(i), 0.0, libm::cos(i));
                assert_eq!(refract(d, DVec3::Z, eta, 1.0) == Transmission::Total, total);
            }
        }
    }

    #[test]
    fn fresnel_is_one_at_grazing_and_symmetric() {
        for model in [Fresnel::Dielectric, Fresnel::Schlick] {
            assert!((fresnel(model, 0.0, 0.745_355_992_5, 1.0, 1.5) - 1.0).abs() < 1e-12);
            let (ci, ct) = (0.8, (1.0f64 - 0.36 / 2.25).sqrt());
            let there = fresnel(model, ci, ct, 1.0, 1.5);
            let back = fresnel(model, ct, ci, 1.5, 1.0);
            assert!((there - back).abs() < 1e-15);
        }
        // Brewster's angle: the parallel part vanishes, leaving half of ((n^2 - 1) / (n^2 + 1))^2.
        let n = 1.5f64;
        let cos_i = 1.0 / (1.0 + n * n).sqrt();
        let cos_t = n * cos_i;
        let f = fresnel(Fresnel::Dielectric, cos_i, cos_t, 1.0, n);
        let s = (n * n - 1.0) / (n * n + 1.0);
        assert!((f - s * s / 2.0).abs() < 1e-15);
    }
}
