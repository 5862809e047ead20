//! Plain arrays as lanes.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::{Lanes, Mask, Real};

/// `N` numbers side by side, without a token of the instruction set: [`super::dispatch`] decides what the loops become.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wide<R, const N: usize, const FMA: bool>([R; N]);

/// `N` answers: all bits set for yes, none for no.
#[derive(Clone, Copy, Debug)]
pub struct WideMask<R: Real, const N: usize>([R::Bits; N]);

macro_rules! wide_operator {
    ($trait:ident, $method:ident) => {
        impl<R: Real, const N: usize, const FMA: bool> $trait for Wide<R, N, FMA> {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for (a, b) in self.0.iter_mut().zip(&other.0) {
                    *a = a.$method(*b);
                }
                self
            }
        }
    };
}
wide_operator!(Add, add);
wide_operator!(Sub, sub);
wide_operator!(Mul, mul);
wide_operator!(Div, div);

impl<R: Real, const N: usize, const FMA: bool> Neg for Wide<R, N, FMA> {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        for a in &mut self.0 {
            *a = -*a;
        }
        self
    }
}

macro_rules! mask_operator {
    ($trait:ident, $method:ident) => {
        impl<R: Real, const N: usize> $trait for WideMask<R, N> {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for (a, b) in self.0.iter_mut().zip(&other.0) {
                    *a = a.$method(*b);
                }
                self
            }
        }
    };
}
mask_operator!(BitAnd, bitand);
mask_operator!(BitOr, bitor);

impl<R: Real, const N: usize> Not for WideMask<R, N> {
    type Output = Self;
    #[inline(always)]
    fn not(mut self) -> Self {
        for a in &mut self.0 {
            *a = !*a;
        }
        self
    }
}

impl<R: Real, const N: usize> Mask for WideMask<R, N> {
    #[inline(always)]
    fn any(self) -> bool {
        let mut any = R::NO_BITS;
        for a in self.0 {
            any = any | a;
        }
        any != R::NO_BITS
    }
    #[inline(always)]
    fn all(self) -> bool {
        let mut all = R::ALL_BITS;
        for a in self.0 {
            all = all & a;
        }
        all != R::NO_BITS
    }
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        self.0[i] != R::NO_BITS
    }
}

/// The last numbers of a list and zeros. Kept out of line: inlined, it turns every load into a copy of unknown length.
#[cold]
#[inline(never)]
fn load_tail<R: Real, const N: usize>(list: &[R]) -> [R; N] {
    let mut padded = [R::ZERO; N];
    for (a, b) in padded.iter_mut().zip(list) {
        *a = *b;
    }
    padded
}

/// Out of line for the same reason.
#[cold]
#[inline(never)]
fn store_tail<R: Real>(lanes: &[R], list: &mut [R]) {
    for (a, b) in list.iter_mut().zip(lanes) {
        *a = *b;
    }
}

macro_rules! comparison {
    ($name:ident, $operator:tt) => {
        #[inline(always)]
        fn $name(self, other: Self) -> Self::Mask {
            let mut mask = [R::NO_BITS; N];
            for ((m, a), b) in mask.iter_mut().zip(&self.0).zip(&other.0) {
                *m = if *a $operator *b { R::ALL_BITS } else { R::NO_BITS };
            }
            WideMask(mask)
        }
    };
}

impl<R: Real, const N: usize, const FMA: bool> Lanes for Wide<R, N, FMA> {
    type Scalar = R;
    type Mask = WideMask<R, N>;
    const WIDTH: usize = N;

    #[inline(always)]
    fn splat(x: R) -> Self {
        Self([x; N])
    }

    #[inline(always)]
    fn load(list: &[R]) -> Self {
        match list.first_chunk::<N>() {
            Some(chunk) => Self(*chunk),
            None => Self(load_tail(list)),
        }
    }

    #[inline(always)]
    fn store(self, list: &mut [R]) {
        match list.first_chunk_mut::<N>() {
            Some(chunk) => *chunk = self.0,
            None => store_tail(&self.0, list),
        }
    }

    #[inline(always)]
    fn lane(self, i: usize) -> R {
        self.0[i]
    }

    #[inline(always)]
    fn mul_add(mut self, b: Self, c: Self) -> Self {
        for ((a, b), c) in self.0.iter_mut().zip(&b.0).zip(&c.0) {
            *a = if FMA {
                a.mul_add(*b, *c)
            } else {
                a.mul_add_emulated(*b, *c)
            };
        }
        self
    }

    #[inline(always)]
    fn sqrt(mut self) -> Self {
        for a in &mut self.0 {
            *a = a.sqrt();
        }
        self
    }

    #[inline(always)]
    fn abs(mut self) -> Self {
        for a in &mut self.0 {
            *a = a.abs();
        }
        self
    }

    #[inline(always)]
    fn min(mut self, other: Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(&other.0) {
            *a = if *a < *b { *a } else { *b };
        }
        self
    }

    #[inline(always)]
    fn max(mut self, other: Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(&other.0) {
            *a = if *a > *b { *a } else { *b };
        }
        self
    }

    comparison!(lt, <);
    comparison!(le, <=);
    comparison!(gt, >);
    comparison!(ge, >=);
    comparison!(same, ==);

    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        let mut out = no.0;
        for ((o, y), m) in out.iter_mut().zip(&yes.0).zip(&mask.0) {
            *o = R::from_bits((y.to_bits() & *m) | (o.to_bits() & !*m));
        }
        Self(out)
    }

    #[inline(always)]
    fn power_of_two_scale(self) -> (Self, Self) {
        let (mut down, mut up) = (self.0, self.0);
        for ((a, d), u) in self.0.iter().zip(&mut down).zip(&mut up) {
            (*d, *u) = a.power_of_two_scale();
        }
        (Self(down), Self(up))
    }

    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        let (mut mantissa, mut exponent) = (self.0, self.0);
        for ((a, m), k) in self.0.iter().zip(&mut mantissa).zip(&mut exponent) {
            (*m, *k) = a.split_exponent();
        }
        (Self(mantissa), Self(exponent))
    }

    #[inline(always)]
    fn add_exponent(mut self, shifted: Self) -> Self {
        for (a, s) in self.0.iter_mut().zip(&shifted.0) {
            *a = a.add_exponent(*s);
        }
        self
    }
}
