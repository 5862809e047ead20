//! Arithmetic with known error, in f64: differences of products, and sums that keep what rounding takes.
//!
//! `two_sum` (Knuth) and `two_prod` (fused multiply-add) return a rounded result and its exact error; [`Twofold`] is an
//! unevaluated pair of the two with a relative error near 2^-104. Exact as long as no product under- or overflows:
//! callers keep operands between about 1e-140 and 1e140. What it leaves out: exponents beyond that.

use crate::math::DVec3;
use crate::math::Each;

/// a + b rounded, and the error of that rounding.
#[inline]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// a b rounded, and the error of that rounding.
#[inline]
pub fn two_prod(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    (p, a.mul_add(b, -p))
}

/// a b - c d to within 1.5 ulp of the result (Kahan; Jeannerod, Louvet and Muller 2013).
#[inline]
pub fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let cd = c * d;
    let error = (-c).mul_add(d, cd);
    a.mul_add(b, -cd) + error
}

/// The exact sign of a b - c d: -1, 0 or 1.
///
/// The plain difference decides where it exceeds its own rounding; the errors of the products decide the rest.
#[inline]
pub fn sign_of_difference(a: f64, b: f64, c: f64, d: f64) -> i32 {
    let (ab, cd) = (a * b, c * d);
    let plain = ab - cd;
    // |plain - exact| <= u (|ab| + |cd|) + u |plain| < 4u (|ab| + |cd|).
    if plain.abs() > 2.0 * f64::EPSILON * (ab.abs() + cd.abs()) {
        return if plain > 0.0 { 1 } else { -1 };
    }
    // Here ab and cd are within a factor of 2 or both 0, so their difference is exact (Sterbenz). What the difference of
    // the two errors loses is below the last place of its rounded value, so it decides only where the rest is 0.
    let (rest, last) = two_sum(a.mul_add(b, -ab), -c.mul_add(d, -cd));
    let sum = plain + rest;
    let sum = if sum == 0.0 { last } else { sum };
    i32::from(sum > 0.0) - i32::from(sum < 0.0)
}

/// Cross product with each component a difference of products.
#[inline]
pub fn cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        difference_of_products(a.y, b.z, a.z, b.y),
        difference_of_products(a.z, b.x, a.x, b.z),
        difference_of_products(a.x, b.y, a.y, b.x),
    )
}

/// `v` scaled to unit length without over- or underflow; zero or non-finite vectors give zero.
#[inline]
pub fn unit(v: DVec3) -> DVec3 {
    DVec3::from_array(crate::math::float::normalize(v.to_array()).0)
}

/// An unevaluated sum of two f64: twice the digits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twofold {
    /// The rounded value.
    pub high: f64,
    /// What rounding took, at most half an ulp of `high`.
    pub low: f64,
}

impl From<f64> for Twofold {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl std::ops::Add for Twofold {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let (s, e) = two_sum(self.high, other.high);
        let (t, f) = two_sum(self.low, other.low);
        let (s, e) = quick_two_sum(s, e + t);
        let (high, low) = quick_two_sum(s, e + f);
        Self { high, low }
    }
}

impl std::ops::Neg for Twofold {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        let (high, low) = (-self.high, -self.low);
        Self { high, low }
    }
}

impl std::ops::Sub for Twofold {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl std::ops::Mul for Twofold {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (p, e) = two_prod(self.high, other.high);
        let e = e + (self.high * other.low + self.low * other.high);
        let (high, low) = quick_two_sum(p, e);
        Self { high, low }
    }
}

impl std::ops::Div for Twofold {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        let (high, low) = quick_two_sum(first, second);
        Self { high, low } + Self::from(rest.high / other.high)
    }
}

impl Twofold {
    /// a - b, exactly.
    #[inline]
    pub fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        Self { high, low }
    }

    /// The value rounded to f64.
    #[inline]
    pub fn value(self) -> f64 {
        self.high + self.low
    }

    /// The square root of a value >= 0.
    #[inline]
    pub fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::default();
        }
        let root = self.high.sqrt();
        let rest = self - Self::from(root) * Self::from(root);
        let (high, low) = quick_two_sum(root, rest.high / (2.0 * root));
        Self { high, low }
    }
}

impl Twofold {
    /// Times a power of two, exactly.
    #[inline]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            high: self.high * factor,
            low: self.low * factor,
        }
    }

    /// Whether this is below another; infinities compare as numbers do.
    #[inline]
    pub fn is_below(self, other: Self) -> bool {
        self.high < other.high || (self.high == other.high && self.low < other.low)
    }

    /// Quotient of two pairs, of which one may leave the number range.
    #[inline]
    pub(super) fn over(self, other: Self) -> Self {
        let plain = self.high / other.high;
        if plain.is_finite() && plain != 0.0 {
            self / other
        } else {
            Self::from(plain)
        }
    }
}

/// Dot product of two vectors of pairs.
#[inline]
pub fn dot2(a: [Twofold; 3], b: [Twofold; 3]) -> Twofold {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Cross product of two vectors of pairs.
#[inline]
pub fn cross2(a: [Twofold; 3], b: [Twofold; 3]) -> [Twofold; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Scaled and added: a + s b.
#[inline]
pub fn add_scaled(a: [Twofold; 3], s: Twofold, b: [Twofold; 3]) -> [Twofold; 3] {
    [0, 1, 2].each(|k| a[k] + s * b[k])
}

/// Each component rounded to f64.
#[inline]
pub fn values(v: [Twofold; 3]) -> DVec3 {
    DVec3::from_array(v.each(Twofold::value))
}

/// A vector as pairs.
#[inline]
pub fn pairs(v: DVec3) -> [Twofold; 3] {
    v.to_array().each(Twofold::from)
}

/// a + b rounded and its error, for |a| >= |b|.
#[inline]
fn quick_two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    (s, b - (s - a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_exact_where_products_cancel() {
        // (1 + e)(1 - e) - 1 * 1 = -e^2, far below the rounding of either product.
        let e = f64::EPSILON;
        assert_eq!(sign_of_difference(1.0 + e, 1.0 - e, 1.0, 1.0), -1);
        assert_eq!(sign_of_difference(1.0, 1.0, 1.0 + e, 1.0 - e), 1);
        assert_eq!(sign_of_difference(3.0, 0.1, 0.1, 3.0), 0);
        assert_eq!(sign_of_difference(0.0, 5.0, -2.0, 0.0), 0);
        assert_eq!(difference_of_products(1.0 + e, 1.0 - e, 1.0, 1.0), -e * e);
    }

    #[test]
    fn pairs_carry_twice_the_digits() {
        let third = Twofold::from(1.0) / Twofold::from(3.0);
        let one = third * Twofold::from(3.0) - Twofold::from(1.0);
        assert!(one.value().abs() < 1e-31);
        let root = Twofold::from(2.0).sqrt();
        assert!((root * root - Twofold::from(2.0)).value().abs() < 1e-30);
        let big = Twofold::from(1e16) + Twofold::from(1.0) - Twofold::from(1e16);
        assert_eq!(big.value(), 1.0);
    }
}
