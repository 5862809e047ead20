//! exp, ln and pow of our own, generic over [`Lanes`]: the same bytes at every width.
//!
//! | function | method | largest error found, f32 | f64 |
//! | - | - | - | - |
//! | [`exp`] | e^r 2^k, \|r\| <= ln 2 / 2, polynomial of degree 6 (f32), 11 (f64) | 0.99 ulp | 0.94 ulp |
//! | [`ln`] | k ln 2 + ln(1 + f), f in [sqrt(1/2) - 1, sqrt(2) - 1]: polynomial of degree 10 (f32), series in f/(2 + f) (f64) | 0.87 ulp | 0.74 ulp |
//! | [`pow`] | exp(y ln x) | 2 + 3 \|y ln x\| ulp | the same |
//!
//! Results of `exp` below the smallest normal number are +0 (subnormal highlights cost time and show nothing).
//! The coefficients are our own minimax fits (Remez, 50 digits), rounded to the precision that uses them.
//! `pow` carries no second word of the logarithm: in the equation its base comes from unit vectors, whose own rounding
//! is amplified by the exponent in the same way.

use super::{Lanes, Real};

/// Coefficients of the polynomials, one set a precision.
pub trait Coefficients: Sized + Copy + 'static {
    /// (e^r - 1 - r) / r^2, lowest power first.
    const EXP: &'static [Self];
    /// Below it `exp` gives +0; above the second it gives infinity.
    const EXP_RANGE: (Self, Self);
    /// 1 / ln 2.
    const LOG2_E: Self;
    /// ln 2 in two parts: the first has so few bits that its product with an exponent is exact.
    const LN_2: (Self, Self);
    /// Whether ln(1 + f) is a series in s = f/(2 + f), else a polynomial in f.
    const LN_BY_DIVISION: bool;
    /// By division: (2 atanh(s)/s - 2) / s^2 in powers of s^2; else (ln(1 + f) - f) / f^2 in powers of f.
    const LN: &'static [Self];
    /// Subnormal numbers times the first are normal; the second is the exponent it stands for.
    const LIFT: (Self, Self);
}

impl Coefficients for f32 {
    const EXP: &'static [f32] = &[
        0.499_999_94,
        0.166_665_2,
        0.041_668_408,
        0.008_368_914,
        0.001_381_419_1,
    ];
    const EXP_RANGE: (f32, f32) = (-87.336_54, 88.722_83);
    const LOG2_E: f32 = std::f32::consts::LOG2_E;
    const LN_2: (f32, f32) = (0.693_115_23, 3.194_618_3e-5);
    const LN_BY_DIVISION: bool = false;
    const LN: &'static [f32] = &[
        -0.499_999_88,
        0.333_333_25,
        -0.250_016_18,
        0.200_020_66,
        -0.166_082_49,
        0.141_793_65,
        -0.132_478_34,
        0.129_233_76,
        -0.076_333_54,
    ];
    const LIFT: (f32, f32) = (16_777_216.0, 24.0);
}

impl Coefficients for f64 {
    const EXP: &'static [f64] = &[
        0.500_000_000_000_001_1,
        0.166_666_666_666_664_05,
        0.041_666_666_666_527_14,
        0.008_333_333_333_498_082,
        0.001_388_888_894_453_964_7,
        0.000_198_412_695_009_399_8,
        2.480_149_205_579_311_6e-5,
        2.755_758_937_945_233e-6,
        2.763_065_183_048_081_3e-7,
        2.499_976_336_586_145_8e-8,
    ];
    const EXP_RANGE: (f64, f64) = (-708.396_418_532_264_1, 709.782_712_893_383_9);
    const LOG2_E: f64 = std::f64::consts::LOG2_E;
    const LN_2: (f64, f64) = (0.693_147_180_559_663, 2.823_529_056_303_157_7e-13);
    const LN_BY_DIVISION: bool = true;
    const LN: &'static [f64] = &[
        0.666_666_666_666_673_8,
        0.399_999_999_993_853_77,
        0.285_714_287_495_11,
        0.222_221_977_847_894_27,
        0.181_836_080_811_413_92,
        0.153_128_642_038_671_35,
        0.148_084_531_163_161_92,
    ];
    const LIFT: (f64, f64) = (18_014_398_509_481_984.0, 54.0);
}

/// Polynomial, Horner's form, lowest power first.
#[inline(always)]
fn polynomial<L: Lanes>(x: L, coefficients: &[L::Scalar]) -> L {
    let mut sum = L::splat(coefficients[coefficients.len() - 1]);
    for c in coefficients[..coefficients.len() - 1].iter().rev() {
        sum = sum.mul_add(x, L::splat(*c));
    }
    sum
}

/// e^x. Results that would be subnormal are +0; NaN gives +0.
///
/// ```
/// use rastray::lanes::{Lanes, Wide, elementary::exp};
/// let e = exp(Wide::<f64, 1, false>::splat(1.0)).lane(0);
/// assert!((e - std::f64::consts::E).abs() < 1e-15);
/// ```
#[inline(always)]
pub fn exp<L: Lanes>(x: L) -> L {
    let one = L::splat(L::Scalar::ONE);
    let (lowest, highest) = L::Scalar::EXP_RANGE;
    let in_range = x.max(L::splat(lowest)).min(L::splat(highest));
    // x = k ln 2 + r with |r| <= ln 2 / 2; k is rounded by adding a number that has no bits for fractions.
    let shifter = L::splat(L::Scalar::SHIFTER);
    let shifted = in_range * L::splat(L::Scalar::LOG2_E) + shifter;
    let k = -(shifted - shifter);
    let r = k.mul_add(L::splat(L::Scalar::LN_2.0), in_range);
    let r = k.mul_add(L::splat(L::Scalar::LN_2.1), r);
    // e^r = 1 + r + r^2 P(r), times 2^k.
    let p = polynomial(r, L::Scalar::EXP).mul_add(r * r, r) + one;
    let value = p.add_exponent(shifted);
    let value = L::select(
        x.gt(L::splat(highest)),
        L::splat(L::Scalar::INFINITY),
        value,
    );
    L::select(x.ge(L::splat(lowest)), value, L::splat(L::Scalar::ZERO))
}

/// k ln 2 + ln(1 + f) for f in [sqrt(1/2) - 1, sqrt(2) - 1].
#[inline(always)]
fn ln_reduced<L: Lanes>(f: L, k: L) -> L {
    let (high, low) = L::Scalar::LN_2;
    let tail = if L::Scalar::LN_BY_DIVISION {
        // ln(1 + f) = 2 atanh(s) = f - s (f - R(s^2)), s = f/(2 + f)
        let s = f / (f + L::splat(L::Scalar::ONE + L::Scalar::ONE));
        let z = s * s;
        s * (polynomial(z, L::Scalar::LN).mul_add(z, -f))
    } else {
        polynomial(f, L::Scalar::LN) * (f * f)
    };
    let small = k.mul_add(L::splat(low), tail) + f;
    k.mul_add(L::splat(high), small)
}

/// Natural logarithm. 0 gives -infinity; negative numbers and NaN are not to be asked for (the answer is finite).
///
/// ```
/// use rastray::lanes::{Lanes, Wide, elementary::ln};
/// let x = ln(Wide::<f64, 1, false>::splat(2.0)).lane(0);
/// assert!((x - std::f64::consts::LN_2).abs() < 1e-15);
/// ```
#[inline(always)]
pub fn ln<L: Lanes>(x: L) -> L {
    let zero = L::splat(L::Scalar::ZERO);
    let one = L::splat(L::Scalar::ONE);
    let (factor, power) = L::Scalar::LIFT;
    let subnormal = x.lt(L::splat(L::Scalar::MIN_POSITIVE));
    let normal = L::select(subnormal, x * L::splat(factor), x);
    let (m, k) = normal.split_exponent();
    let k = k - L::select(subnormal, L::splat(power), zero);
    let value = ln_reduced(m - one, k);
    let value = L::select(x.gt(L::splat(L::Scalar::MAX)), x, value);
    L::select(x.le(zero), L::splat(-L::Scalar::INFINITY), value)
}

/// ln(1 - delta) where `near` says so (there delta <= 1/4), else ln(x) for x > 0 normal: one polynomial for both.
#[inline(always)]
pub fn ln_near_one<L: Lanes>(near: L::Mask, delta: L, x: L) -> L {
    let (m, k) = x.split_exponent();
    let f = L::select(near, -delta, m - L::splat(L::Scalar::ONE));
    ln_reduced(f, L::select(near, L::splat(L::Scalar::ZERO), k))
}

/// x^y for x >= 0, with x^0 = 1 (0^0 too), 0^y = 0 for y > 0 and infinity for y < 0.
///
/// ```
/// use rastray::lanes::{Lanes, Wide, elementary::pow};
/// let one = |x: f64, y: f64| {
///     pow(Wide::<f64, 1, false>::splat(x), Wide::splat(y)).lane(0)
/// };
/// assert!((one(0.5, 10.0) - 0.5f64.powi(10)).abs() < 1e-17);
/// assert_eq!(one(0.0, 0.0), 1.0);
/// assert_eq!(one(0.0, 3.0), 0.0);
/// ```
#[inline(always)]
pub fn pow<L: Lanes>(x: L, y: L) -> L {
    let power = exp(y * ln(x));
    L::select(
        y.same(L::splat(L::Scalar::ZERO)),
        L::splat(L::Scalar::ONE),
        power,
    )
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::lanes::{Isa, Kernel, Wide, dispatch};

    /// A small generator for tests (splitmix64).
    pub(crate) struct Random(pub u64);
    impl Random {
        pub(crate) fn next(&mut self) -> u64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ (z >> 31)
        }
        /// In [low, high).
        pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
            low + (high - low) * ((self.next() >> 11) as f64 / (1u64 << 53) as f64)
        }
    }

    type One<R> = Wide<R, 1, false>;

    fn ulps32(found: f32, exact: f64) -> f64 {
        let near = exact as f32;
        let ulp = f64::from(near.abs().next_up()) - f64::from(near.abs());
        (f64::from(found) - exact).abs() / ulp
    }

    #[test]
    fn f32_errors_are_as_stated() {
        let mut random = Random(1);
        let (mut worst_exp, mut worst_ln) = (0.0f64, 0.0f64);
        for _ in 0..400_000 {
            let x = random.between(-87.3, 88.7) as f32;
            let found = exp(One::<f32>::splat(x)).lane(0);
            worst_exp = worst_exp.max(ulps32(found, libm::exp(f64::from(x))));
            let x = f32::from_bits((random.next() % u64::from(f32::INFINITY.to_bits())) as u32);
            let near = random.between(0.5, 2.0) as f32;
            for x in [x, near] {
                if x > 0.0 {
                    let found = ln(One::<f32>::splat(x)).lane(0);
                    worst_ln = worst_ln.max(ulps32(found, libm::log(f64::from(x))));
                }
            }
        }
        println!("f32 exp {worst_exp} ln {worst_ln}");
        assert!(worst_exp < 1.1, "{worst_exp}");
        assert!(worst_ln < 1.1, "{worst_ln}");
    }

    #[test]
    fn f64_errors_are_as_stated() {
        use astro_float::{BigFloat, Consts, RoundingMode};
        const DIGITS: usize = 128;
        let mut consts = Consts::new().expect("constants cache");
        // (found - exact) in units of the last place, with the exact value as a sum of two f64.
        let ulps = |found: f64, exact: BigFloat| {
            let difference =
                BigFloat::from_f64(found, DIGITS).sub(&exact, DIGITS, RoundingMode::ToEven);
            let ulp = found.abs().next_up() - found.abs();
            let difference: f64 = difference.to_string().parse().expect("a number");
            difference.abs() / ulp
        };
        let mut random = Random(2);
        let (mut worst_exp, mut worst_ln) = (0.0f64, 0.0f64);
        for i in 0..4000 {
            let x = if i % 2 == 0 {
                random.between(-708.0, 709.0)
            } else {
                random.between(-2.0, 2.0)
            };
            let exact =
                BigFloat::from_f64(x, DIGITS).exp(DIGITS, RoundingMode::ToEven, &mut consts);
            worst_exp = worst_exp.max(ulps(exp(One::<f64>::splat(x)).lane(0), exact));
            let x = if i % 2 == 0 {
                libm::exp(x)
            } else {
                random.between(0.6, 1.6)
            };
            let exact = BigFloat::from_f64(x, DIGITS).ln(DIGITS, RoundingMode::ToEven, &mut consts);
            worst_ln = worst_ln.max(ulps(ln(One::<f64>::splat(x)).lane(0), exact));
        }
        println!("f64 exp {worst_exp} ln {worst_ln}");
        assert!(worst_exp < 1.1, "{worst_exp}");
        assert!(worst_ln < 1.1, "{worst_ln}");
    }

    #[test]
    fn pow_is_within_its_bound() {
        let mut random = Random(3);
        for _ in 0..200_000 {
            let x = random.between(0.0, 1.5) as f32;
            let y = libm::exp(random.between(-3.0, 14.0)) as f32;
            let exponent = f64::from(y) * libm::log(f64::from(x));
            if !(-87.0..88.0).contains(&exponent) {
                continue;
            }
            let found = pow(One::<f32>::splat(x), One::splat(y)).lane(0);
            let error = ulps32(found, libm::exp(exponent));
            assert!(error < 2.0 + 3.0 * exponent.abs(), "{x}^{y}: {error}");
        }
    }

    #[test]
    fn extremes_have_values() {
        let exp = |x: f32| exp(One::<f32>::splat(x)).lane(0);
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(-0.0), 1.0);
        assert_eq!(exp(-1e30), 0.0);
        assert_eq!(exp(f32::NEG_INFINITY), 0.0);
        assert_eq!(exp(f32::NAN), 0.0);
        assert_eq!(exp(89.0), f32::INFINITY);
        assert_eq!(exp(f32::INFINITY), f32::INFINITY);
        assert!(exp(88.722_83).is_finite() && exp(-87.336_54) >= f32::MIN_POSITIVE);
        let (low, high) = f64::EXP_RANGE;
        assert!(super::exp(One::<f64>::splat(low)).lane(0) >= f64::MIN_POSITIVE);
        assert!(super::exp(One::<f64>::splat(high)).lane(0).is_finite());
        let ln = |x: f64| ln(One::<f64>::splat(x)).lane(0);
        assert_eq!(ln(1.0), 0.0);
        assert_eq!(ln(0.0), f64::NEG_INFINITY);
        assert_eq!(ln(f64::INFINITY), f64::INFINITY);
        assert!((ln(5e-324) - -744.440_071_921_381_2).abs() < 1e-12);
    }

    /// exp, ln, pow and `ln_near_one` of a list.
    struct All<'a, R>(&'a [R]);
    impl<R: Real> Kernel<R> for All<'_, R> {
        type Output = [Vec<R>; 4];
        #[inline(always)]
        fn run<L: Lanes<Scalar = R>>(self) -> [Vec<R>; 4] {
            let mut out = [0; 4].map(|_| vec![R::ZERO; self.0.len()]);
            for i in (0..self.0.len()).step_by(L::WIDTH) {
                let x = L::load(&self.0[i..]);
                let near = x.lt(L::splat(R::from_f64(0.25)));
                let values = [exp(x), ln(x), pow(x, x), ln_near_one::<L>(near, x, x)];
                for (list, value) in out.iter_mut().zip(values) {
                    value.store(&mut list[i..]);
                }
            }
            out
        }
    }

    fn same_bytes<R: Real>() {
        let mut random = Random(4);
        let list: Vec<R> = (0..999)
            .map(|_| R::from_f64(random.between(0.01, 3.0)))
            .collect();
        let expected = dispatch(Isa::Scalar, All(&list));
        for isa in Isa::available() {
            assert!(dispatch(isa, All(&list)) == expected, "{}", isa.name());
        }
    }

    #[test]
    fn all_widths_agree_bit_for_bit() {
        same_bytes::<f32>();
        same_bytes::<f64>();
    }
}
