//! Curved faces: a carrier with its extents in object space, and whether two lie on one carrier.
//!
//! Carriers of one kind are the same surface if they agree in a few rings of points, so points of one face are held
//! against the other: where they lie within its extents they must lie on it, to the error of both. Whatever the parameters
//! are, and however the two are placed: a cylinder and a straight piece of a profile are compared as surfaces.

use crate::math::{DAffine3, DMat3, DVec2, DVec3};
use crate::scene::profile::Piece;

/// A carrier, object space.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Sphere {
        center: DVec3,
        radius: f64,
    },
    Tube {
        base: DVec3,
        axis: DVec3,
        radius: f64,
    },
    /// `axis` leads from the apex to the base, where the radius is.
    Cone {
        apex: DVec3,
        axis: DVec3,
        radius: f64,
    },
    Torus {
        center: DVec3,
        axis: DVec3,
        major: f64,
        minor: f64,
    },
    /// A piece of a profile about a unit axis.
    Band {
        base: DVec3,
        axis: DVec3,
        piece: Piece,
    },
}

/// A carrier in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curved {
    kind: Kind,
    place: DAffine3,
    inverse: DMat3,
    /// How much longer lengths get in the world at most.
    stretch: f64,
    /// By how much going to object space and back may enlarge an error.
    gain: f64,
}

/// Rings of points on a face, and points of a ring.
const RINGS: u32 = 64;
const POINTS: u32 = 5;
/// Rings that decide: two curved carriers may meet in one or two by chance.
const ENOUGH: u32 = 3;

impl Kind {
    /// The largest coordinate that it reaches, about.
    pub(super) fn size(&self) -> f64 {
        match self {
            Self::Sphere { center, radius } => center.abs().max_element() + radius,
            Self::Tube { base, axis, radius } => (base.abs() + axis.abs()).max_element() + radius,
            Self::Cone { apex, axis, radius } => (apex.abs() + axis.abs()).max_element() + radius,
            Self::Torus {
                center,
                major,
                minor,
                ..
            } => center.abs().max_element() + major + minor,
            Self::Band { base, piece, .. } => {
                let reach = |x: &[f64; 4]| x.iter().fold(0.0f64, |most, x| most.max(x.abs()));
                base.abs().max_element() + reach(&piece.r) + reach(&piece.z)
            }
        }
    }

    /// A point of the surface: `s` and `turn` in 0..1.
    fn at(&self, s: f64, turn: f64) -> DVec3 {
        let (sin, cos) = libm::sincos(turn * std::f64::consts::TAU);
        let about = |axis: DVec3| {
            let (x, y) = axis.normalize_or_zero().any_orthonormal_pair();
            cos * x + sin * y
        };
        match self {
            Self::Sphere { center, radius } => {
                let height = 2.0 * s - 1.0;
                let across = (1.0 - height * height).max(0.0).sqrt();
                *center + *radius * DVec3::new(across * cos, height, across * sin)
            }
            Self::Tube { base, axis, radius } => *base + s * *axis + *radius * about(*axis),
            Self::Cone { apex, axis, radius } => *apex + s * (*axis + *radius * about(*axis)),
            Self::Torus {
                center,
                axis,
                major,
                minor,
            } => {
                let out = about(*axis);
                let (up, across) = libm::sincos(s * std::f64::consts::TAU);
                *center + *major * out + *minor * (across * out + up * *axis)
            }
            Self::Band { base, axis, piece } => {
                let p = piece.at(s);
                *base + p.y * *axis + p.x * about(*axis)
            }
        }
    }

    /// Distance of a point from the surface; `None` where it lies beyond its ends.
    fn distance(&self, p: DVec3) -> Option<f64> {
        let split = |q: DVec3, axis: DVec3| {
            let height = q.dot(axis) / axis.length_squared();
            (height, (q - height * axis).length())
        };
        let inner = |s: f64| s > 0.0 && s < 1.0;
        match self {
            Self::Sphere { center, radius } => Some(((p - *center).length() - radius).abs()),
            Self::Tube { base, axis, radius } => {
                let (height, across) = split(p - *base, *axis);
                inner(height).then(|| (across - radius).abs())
            }
            Self::Cone { apex, axis, radius } => {
                let (height, across) = split(p - *apex, *axis);
                let slant = axis.length() / axis.length().hypot(*radius);
                inner(height).then(|| (across - height * radius).abs() * slant)
            }
            Self::Torus {
                center,
                axis,
                major,
                minor,
            } => {
                let (height, across) = split(p - *center, *axis);
                Some(((across - major).hypot(height) - minor).abs())
            }
            Self::Band { base, axis, piece } => {
                let (height, across) = split(p - *base, *axis);
                distance_from_piece(piece, DVec2::new(across, height))
            }
        }
    }
}

/// Distance of a point of the half plane from a monotone piece; `None` where it lies beyond its ends.
fn distance_from_piece(piece: &Piece, p: DVec2) -> Option<f64> {
    let (from, to) = (piece.at(0.0), piece.at(1.0));
    let way = to - from;
    // The coordinate that changes more has one parameter.
    let by_height = way.y.abs() >= way.x.abs();
    let pick = |q: DVec2| if by_height { q.y } else { q.x };
    let rises = pick(to) > pick(from);
    let (mut low, mut high) = (0.0f64, 1.0f64);
    if (pick(p) - pick(from)) * (pick(to) - pick(p)) <= 0.0 {
        return None;
    }
    let s = if piece.degree == 1 {
        (pick(p) - pick(from)) / pick(way)
    } else {
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break middle;
            }
            if (pick(piece.at(middle)) < pick(p)) == rises {
                low = middle;
            } else {
                high = middle;
            }
        }
    };
    let away = p - piece.at(s);
    let tangent = piece.tangent(s);
    let length = tangent.length();
    Some(away.perp_dot(tangent).abs() / length).filter(|d| d.is_finite())
}

impl Curved {
    /// `None` where the transform flattens it.
    pub(super) fn new(kind: Kind, place: &DAffine3) -> Option<Self> {
        let inverse = place.matrix3.inverse();
        let norm = |m: &DMat3| {
            let rows = m.transpose();
            let squares = [rows.x_axis, rows.y_axis, rows.z_axis].map(DVec3::length_squared);
            squares.iter().sum::<f64>().sqrt()
        };
        let stretch = norm(&place.matrix3);
        let gain = stretch * norm(&inverse);
        (inverse.is_finite() && gain.is_finite()).then_some(Self {
            kind,
            place: *place,
            inverse,
            stretch,
            gain,
        })
    }

    /// Points of `self` on `other`: `None` where one is off it, else how many rings lie within its ends.
    fn rings_on(&self, other: &Self, error: f64) -> Option<u32> {
        let allowed = 2.0 * error * other.gain;
        let mut rings = 0;
        for ring in 0..RINGS {
            let s = (f64::from(ring) + 0.5) / f64::from(RINGS);
            let mut inside = false;
            for i in 0..POINTS {
                let turn = (f64::from(i) + 0.37 * f64::from(ring)) / f64::from(POINTS);
                let world = self.place.transform_point3(self.kind.at(s, turn));
                let local = other.inverse * (world - other.place.translation);
                let Some(distance) = other.kind.distance(local) else {
                    continue;
                };
                if !(distance * other.stretch <= allowed) {
                    return None;
                }
                inside = true;
            }
            rings += u32::from(inside);
        }
        Some(rings)
    }
}

/// Whether two faces lie on one carrier and overlap; `error` is that of both.
pub(super) fn on_each_other(a: &Curved, b: &Curved, error: f64) -> bool {
    // The smaller of the two has the more points within the other.
    let enough = |rings: Option<u32>| rings.is_some_and(|n| n >= ENOUGH);
    enough(a.rings_on(b, error)) || enough(b.rings_on(a, error))
}
