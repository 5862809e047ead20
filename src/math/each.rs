//! `array::map` for short arrays in kernels, written out.
//!
//! The standard library's `map` goes through an iterator that stops early; closures that it is given are not always inlined,
//! and every closure gets a copy of it (hundreds, 6 to 7 % of the library's code before optimization, 2026-12).
//! [`Each::each`] calls the closure once an element, in order, and is always inlined. Elsewhere `map` reads as well and costs
//! nothing.

/// An array whose elements a function is applied to, one by one, in order.
pub(crate) trait Each {
    type Element;
    type Of<U>;
    fn each<U>(self, f: impl FnMut(Self::Element) -> U) -> Self::Of<U>;
}

macro_rules! written_out {
    ($n:literal: $($x:ident)*) => {
        impl<T> Each for [T; $n] {
            type Element = T;
            type Of<U> = [U; $n];

            #[inline(always)]
            fn each<U>(self, mut f: impl FnMut(T) -> U) -> [U; $n] {
                let [$($x),*] = self;
                [$(f($x)),*]
            }
        }
    };
}

written_out!(2: a b);
written_out!(3: a b c);
written_out!(4: a b c d);

#[cfg(test)]
mod tests {
    use super::Each;

    #[test]
    fn elements_are_taken_in_order() {
        let mut seen = Vec::new();
        let doubled = [3, 1, 2, 0].each(|x| {
            seen.push(x);
            2 * x
        });
        assert_eq!((doubled, seen), ([6, 2, 4, 0], vec![3, 1, 2, 0]));
        assert_eq!(
            [1.5, -0.0].each(f64::to_bits),
            [1.5, -0.0].map(f64::to_bits)
        );
        assert_eq!(["a", "bc", ""].each(str::len), [1, 2, 0]);
    }
}
