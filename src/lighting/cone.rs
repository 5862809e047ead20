//! The spot cone's edge: a hard decision, made exactly.
//!
//! Positions and axes enter as f64 (exact for f32 data). Squared quantities are compared in double-double arithmetic,
//! whose own error, below 2^-98 of the operands, is the only tolerance: what is closer than that to the edge is on it,
//! and the edge belongs to the cone (GL 2.1 section 2.14.1: dark only if (-VP).s < cos(cutoff)). Squared sines and
//! cosines are exact for cutoffs of 0, 30, 45, 60 and 90 degrees.

use crate::lanes::Real;
use crate::math::Each;
use crate::math::float::{two_prod, two_sum};

/// A cone with a hard edge.
///
/// ```
/// use rastray::lighting::Cone;
/// let cone = Cone::new([0.0, 0.0, -2.0], 45.0);
/// assert!(cone.contains([3.0, 0.0, -3.0])); // on the edge
/// assert!(!cone.contains([3.000001, 0.0, -3.0]));
/// assert!(!cone.contains([0.0, 0.0, 5.0])); // behind
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Cone {
    axis: [f64; 3],
    cutoff_deg: f64,
    cos_squared: f64,
    sin_squared: f64,
}

/// A number as the unevaluated sum of two f64.
type Pair = (f64, f64);

impl Cone {
    /// A cone around an axis of any length, in degrees of half angle. Cutoffs above 90 count as 90 (behind the light is
    /// always outside), those below 0 and NaN as 0.
    pub fn new(axis: [f64; 3], cutoff_deg: f64) -> Self {
        let cutoff_deg = if cutoff_deg > 0.0 {
            cutoff_deg.min(90.0)
        } else {
            0.0
        };
        let (cos_squared, sin_squared) = if cutoff_deg == 0.0 {
            (1.0, 0.0)
        } else if cutoff_deg == 30.0 {
            (0.75, 0.25)
        } else if cutoff_deg == 45.0 {
            (0.5, 0.5)
        } else if cutoff_deg == 60.0 {
            (0.25, 0.75)
        } else if cutoff_deg == 90.0 {
            (0.0, 1.0)
        } else {
            let (sin, cos) = libm::sincos(cutoff_deg.to_radians());
            (cos * cos, sin * sin)
        };
        Self {
            axis: scaled(axis),
            cutoff_deg,
            cos_squared,
            sin_squared,
        }
    }

    /// Cosine of the cutoff: exact for 0, 60 and 90 degrees.
    pub fn cos_cutoff(&self) -> f64 {
        self.cos_squared.sqrt()
    }

    /// Whether a point at this offset from the apex is inside or on the edge. The apex itself, and every point of a
    /// cone without an axis, is inside only at a cutoff of 90 degrees.
    pub fn contains(&self, offset: [f64; 3]) -> bool {
        let offset = scaled(offset);
        if offset == [0.0; 3] || self.axis == [0.0; 3] {
            return self.cutoff_deg == 90.0;
        }
        let along = dot(offset, self.axis);
        if along.0 < 0.0 {
            return false;
        }
        let lengths = product(dot(offset, offset), dot(self.axis, self.axis));
        // Compare the smaller of sine and cosine: it knows the angle better.
        if self.cos_squared >= 0.5 {
            let across = cross_squared(offset, self.axis);
            not_above(across, times(lengths, self.sin_squared))
        } else {
            not_above(times(lengths, self.cos_squared), product(along, along))
        }
    }
}

/// The vector over the power of two of its largest component: exact, and all products stay in range.
fn scaled(v: [f64; 3]) -> [f64; 3] {
    let largest = v[0].abs().max(v[1].abs()).max(v[2].abs());
    if !(largest > 0.0 && v.iter().all(|x| x.is_finite())) {
        return [0.0; 3];
    }
    let (down, _) = largest.power_of_two_scale();
    v.each(|x| x * down)
}

fn add(a: Pair, b: Pair) -> Pair {
    let (sum, error) = two_sum(a.0, b.0);
    let (low, low_error) = two_sum(a.1, b.1);
    let (sum, error) = two_sum(sum, error + low);
    two_sum(sum, error + low_error)
}

fn product(a: Pair, b: Pair) -> Pair {
    let (high, error) = two_prod(a.0, b.0);
    two_sum(high, error + (a.0 * b.1 + a.1 * b.0))
}

fn times(a: Pair, b: f64) -> Pair {
    product(a, (b, 0.0))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> Pair {
    let [x, y, z] = [0, 1, 2].each(|i| two_prod(a[i], b[i]));
    add(add(x, y), z)
}

fn cross_squared(a: [f64; 3], b: [f64; 3]) -> Pair {
    let component = |i: usize, j: usize| {
        let (p, q) = (two_prod(a[i], b[j]), two_prod(a[j], b[i]));
        let difference = add(p, (-q.0, -q.1));
        product(difference, difference)
    };
    add(add(component(1, 2), component(2, 0)), component(0, 1))
}

/// a <= b, to within the error of the arithmetic above.
fn not_above(a: Pair, b: Pair) -> bool {
    let difference = add(a, (-b.0, -b.1));
    const ROUNDOFF: f64 = 1.0 / (1u128 << 96) as f64;
    let bound = b.0.abs() * ROUNDOFF;
    difference.0 <= bound
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_belong_to_the_cone() {
        // On the axis of a cone that is only its axis; with components that f64 products cannot hold.
        let axis = [0.1f32, 0.7, -0.3].map(f64::from);
        let cone = Cone::new(axis, 0.0);
        assert!(cone.contains(axis.map(|x| 3.0 * x)));
        assert!(!cone.contains([axis[0], axis[1].next_up(), axis[2]]));
        assert!(!cone.contains(axis.map(|x| -x)));
        // 60 degrees between (1,1,0) and (0,1,1), scaled by numbers with full mantissas.
        let (a, b) = (0.123_456_789_012_345_67, 9.876_543_210_987_654);
        let cone = Cone::new([0.0, b, b], 60.0);
        assert!(cone.contains([a, a, 0.0]));
        assert!(!cone.contains([a.next_up(), a, 0.0]));
        // 90 degrees: perpendicular is inside, however the products round.
        let cone = Cone::new([a, b, 0.0], 90.0);
        assert!(cone.contains([b, -a, 5.0]));
        assert!(!cone.contains([b.next_down(), -a, 5.0]));
        // 30 degrees: sin = 1/2; (1,1,0) against (1,2,1): cos^2 = 9/12.
        assert!(Cone::new([1.0, 2.0, 1.0], 30.0).contains([7.0, 7.0, 0.0]));
    }

    #[test]
    fn odd_cones_have_answers() {
        assert!(!Cone::new([0.0; 3], 45.0).contains([0.0, 0.0, 1.0]));
        assert!(Cone::new([0.0; 3], 90.0).contains([0.0, 0.0, 1.0]));
        assert!(!Cone::new([0.0, 0.0, 1.0], 89.9).contains([0.0; 3]));
        assert!(!Cone::new([0.0, 0.0, 1.0], 120.0).contains([0.0, 0.0, -1.0]));
        assert!(!Cone::new([f64::NAN, 0.0, 1.0], 45.0).contains([0.0, 0.0, 1.0]));
        assert!(Cone::new([0.0, 0.0, 1e-300], 45.0).contains([0.0, 0.0, 1e300]));
    }
}
