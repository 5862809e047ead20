//! Error-aware arithmetic: the toolbox of the numerics guide.
//!
//! No absolute epsilon stands here: bounds come from the operands.

use super::Each;
use crate::lanes::Real;

/// `v` scaled to unit length, and its length; zero or non-finite vectors give the zero vector and length 0.
///
/// The largest component is first divided by its own power of two, so that no square over- or underflows.
pub fn normalize<R: Real>(v: [R; 3]) -> ([R; 3], R) {
    let largest = v[0].abs().max(v[1].abs()).max(v[2].abs());
    if !(largest > R::ZERO && v.iter().all(|x| x.is_finite())) {
        return ([R::ZERO; 3], R::ZERO);
    }
    let (down, up) = largest.power_of_two_scale();
    let s = v.each(|x| x * down);
    let length = dot(s, s).sqrt();
    (s.each(|x| x / length), length * up)
}

/// Dot product, plain left-to-right sum.
pub fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a + b as (rounded sum, its error): the two add up exactly (Knuth), barring overflow.
#[inline(always)]
pub fn two_sum<R: Real>(a: R, b: R) -> (R, R) {
    let sum = a + b;
    let b_virtual = sum - a;
    (sum, (a - (sum - b_virtual)) + (b - b_virtual))
}

/// a b as (rounded product, its error): the two add up exactly, barring underflow of the error.
#[inline(always)]
pub fn two_prod<R: Real>(a: R, b: R) -> (R, R) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

/// a b - c d to within 1.5 ulp, and 0 exactly where the products are equal (Kahan; Jeannerod, Louvet and Muller 2013).
#[inline(always)]
pub fn difference_of_products<R: Real>(a: R, b: R, c: R, d: R) -> R {
    let (cd, error) = two_prod(c, d);
    a.mul_add(b, -cd) - error
}

/// Cross product, each component a [`difference_of_products`].
#[inline(always)]
pub fn cross<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [
        difference_of_products(a[1], b[2], a[2], b[1]),
        difference_of_products(a[2], b[0], a[0], b[2]),
        difference_of_products(a[0], b[1], a[1], b[0]),
    ]
}

/// Dot product as if computed in twice the precision and rounded (Ogita, Rump and Oishi 2005).
#[inline(always)]
pub fn dot_compensated<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    let (mut sum, mut error) = two_prod(a[0], b[0]);
    for i in 1..3 {
        let (product, product_error) = two_prod(a[i], b[i]);
        let (next, sum_error) = two_sum(sum, product);
        sum = next;
        error += product_error + sum_error;
    }
    sum + error
}

/// gamma(n) = n u / (1 - n u): the relative error of n roundings in a row is below it (Higham).
#[inline(always)]
pub fn gamma<R: Real>(n: u32) -> R {
    let nu = R::from_f64(f64::from(n)) * R::ROUNDOFF;
    nu / (R::ONE - nu)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_products_keep_their_errors() {
        assert_eq!(two_sum(1e16, 1.0), (1e16, 1.0));
        assert_eq!(two_sum(1.0f32, 1e-9), (1.0, 1e-9));
        let x = 1.0 + f64::EPSILON;
        assert_eq!(
            two_prod(x, x),
            (1.0 + 2.0 * f64::EPSILON, f64::EPSILON * f64::EPSILON)
        );
    }

    #[test]
    fn differences_of_products_survive_cancellation() {
        // (1 + e)(1 - e) - 1 * 1 = -e^2
        let e = f64::from(f32::EPSILON) * 2f64.powi(-6);
        assert_eq!(difference_of_products(1.0 + e, 1.0 - e, 1.0, 1.0), -e * e);
        assert_eq!(difference_of_products(0.1f32, 0.7, 0.7, 0.1), 0.0);
        let a = [0.1f32, 0.2, 0.3];
        assert_eq!(cross(a, a.map(|x| 4.0 * x)), [0.0; 3]);
        assert_eq!(cross([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn compensated_dot_is_right_where_the_plain_one_is_not() {
        let (a, b) = ([1e10, 1.0, -1e10], [1e10, 1.0, 1e10]);
        assert_eq!(dot(a, b), 0.0);
        assert_eq!(dot_compensated(a, b), 1.0);
    }

    #[test]
    fn unit_vectors_at_every_scale() {
        for scale in [1e-44f32, 1e-37, 1e-20, 1.0, 1e20, 1e37] {
            let (unit, length) = normalize([3.0 * scale, 0.0, 4.0 * scale]);
            let length_ok = (length / scale - 5.0).abs() < 1e-5 || scale < 1e-38;
            assert!(length_ok, "{scale}: {length}");
            assert!((unit[0] - 0.6).abs() < 0.02 && (unit[2] - 0.8).abs() < 0.02);
        }
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(normalize([1.0, bad, 0.0]), ([0.0; 3], 0.0));
            assert_eq!(normalize([bad, 1.0, 0.0]), ([0.0; 3], 0.0));
        }
        assert_eq!(normalize([0.0f64; 3]), ([0.0; 3], 0.0));
    }

    #[test]
    fn gamma_bounds_roundings() {
        assert_eq!(gamma::<f32>(1), 2f32.powi(-24) / (1.0 - 2f32.powi(-24)));
        assert!(gamma::<f64>(3) > 3.0 * f64::EPSILON / 2.0);
    }
}
