//! Roots of a polynomial of degree 2 or 6 in Bernstein form: brackets that hold one each, and the root in a bracket.
//!
//! The coefficients are plain f64 with a bound of their error and only say where no root, one root or one extremum can be;
//! whether two values differ in sign is asked of somebody who knows better ([`Signs`]). An interval is settled where its
//! coefficients have one sign, where their differences have (one root if the signs at its ends differ), or where their
//! second differences have (at most two, on both sides of the extremum); else it is halved. So the brackets alternate, and
//! their number is odd or even as the signs at the ends of the whole demand, whatever is rounded.

use super::exact::Twofold;

/// Bernstein coefficients of degree 2 (the first three) or 6.
pub(super) type Coefficients = [f64; 7];

/// Newton steps and halvings together; halving alone needs about 1100 from anywhere to anywhere, and here about 60.
const MAX_STEPS: u32 = 128;
/// Halvings of the whole interval.
const DEPTH: u32 = 44;

/// What decides.
pub(super) trait Signs {
    /// Whether the value at a parameter is >= 0.
    fn is_positive(&self, s: f64) -> bool;
    /// The derivative at a parameter, about.
    fn slope(&self, s: f64) -> f64;
}

/// An interval with the signs at its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bracket {
    pub(super) ends: [f64; 2],
    /// Whether the value is >= 0 there.
    pub(super) positive: [bool; 2],
}

/// Shows the brackets of the roots in an interval, in order. `n` is the degree.
pub(super) fn isolate(
    signs: &impl Signs,
    c: &Coefficients,
    n: usize,
    error: f64,
    whole: Bracket,
    found: &mut impl FnMut(Bracket),
) {
    descend(signs, c, n, error, whole, DEPTH, found);
}

fn descend(
    signs: &impl Signs,
    c: &Coefficients,
    n: usize,
    error: f64,
    at: Bracket,
    depth: u32,
    found: &mut impl FnMut(Bracket),
) {
    let crosses = at.positive[0] != at.positive[1];
    let first = differences(c, n);
    if sign(&c[..=n], error).is_some() || sign(&first[..n], 2.0 * error).is_some() {
        if crosses {
            found(at);
        }
        return;
    }
    let second = differences(&first, n - 1);
    let convex = sign(&second[..n - 1], 4.0 * error);
    let flat = c[..=n].iter().all(|x| x.abs() <= error);
    if convex.is_some() || flat || depth == 0 {
        if crosses {
            found(at);
        } else if convex == Some(at.positive[0]) {
            around_extremum(signs, at, found);
        }
        return;
    }
    let [a, b] = at.ends;
    let middle = a + 0.5 * (b - a);
    let sign = signs.is_positive(middle);
    let (before, after) = halves(c, n, 0.5);
    let part = |ends, positive| Bracket { ends, positive };
    let parts = [
        (before, part([a, middle], [at.positive[0], sign])),
        (after, part([middle, b], [sign, at.positive[1]])),
    ];
    for (c, at) in parts {
        descend(signs, &c, n, error, at, depth - 1, found);
    }
}

/// Both roots beside the extremum of a convex or concave stretch, if it reaches the other side.
fn around_extremum(signs: &impl Signs, at: Bracket, found: &mut impl FnMut(Bracket)) {
    let [a, b] = at.ends;
    let positive = at.positive[0];
    // Towards the other side at first, back at last.
    let falls = |s: f64| (signs.slope(s) < 0.0) == positive;
    if !falls(a) || falls(b) {
        return;
    }
    let (mut low, mut high) = (a, b);
    loop {
        let middle = low + 0.5 * (high - low);
        if middle <= low || middle >= high {
            break;
        }
        if falls(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    let other = signs.is_positive(low);
    if other != positive {
        let part = |ends, positive| Bracket { ends, positive };
        found(part([a, low], [positive, other]));
        found(part([low, b], [other, positive]));
    }
}

/// Whether all values are above (true) or below (false) what an error could bring to 0.
fn sign(values: &[f64], error: f64) -> Option<bool> {
    if values.iter().all(|x| *x > error) {
        Some(true)
    } else if values.iter().all(|x| *x < -error) {
        Some(false)
    } else {
        None
    }
}

fn differences(c: &Coefficients, n: usize) -> Coefficients {
    let mut d = [0.0; 7];
    for i in 0..n {
        d[i] = c[i + 1] - c[i];
    }
    d
}

/// The coefficients before and after a place in 0..=1 (de Casteljau).
pub(super) fn halves(c: &Coefficients, n: usize, s: f64) -> (Coefficients, Coefficients) {
    let (mut before, mut after, mut row) = (*c, *c, *c);
    for level in 1..=n {
        for i in 0..=n - level {
            row[i] += s * (row[i + 1] - row[i]);
        }
        before[level] = row[0];
        after[n - level] = row[n - level];
    }
    (before, after)
}

/// The root between two parameters of a function (value, slope) that is below 0 at the first of them if `rises`, else at
/// the other: found in plain f64 first, then in pairs, and polished once.
pub(super) fn root(
    ends: [f64; 2],
    rises: bool,
    plain: impl Fn(f64) -> (f64, f64),
    f: impl Fn(f64) -> (Twofold, f64),
) -> Twofold {
    let width = ends[1] - ends[0];
    let guess = newton(ends, rises, ends[0] + 0.5 * width, plain);
    let s = newton(ends, rises, guess, |s| {
        let (value, slope) = f(s);
        (value.value(), slope)
    });
    // The last place is reached: what is left goes to the low part, unless the slope is too small to say.
    let (value, slope) = f(s);
    let rest = value.value() / slope;
    if rest.abs() <= 4.0 * f64::EPSILON * (s.abs() + width) {
        Twofold::from(s) - Twofold::from(rest)
    } else {
        Twofold::from(s)
    }
}

/// Newton's method from a place in a bracket, held in it.
fn newton(
    [mut low, mut high]: [f64; 2],
    rises: bool,
    mut s: f64,
    f: impl Fn(f64) -> (f64, f64),
) -> f64 {
    let mut step = high - low;
    for _ in 0..MAX_STEPS {
        let (value, slope) = f(s);
        if value == 0.0 {
            return s;
        }
        if (value < 0.0) == rises {
            low = s;
        } else {
            high = s;
        }
        let newton = value / slope;
        let next = s - newton;
        // Newton, unless it leaves the bracket or no longer halves its step.
        if next >= low && next <= high && newton.abs() <= 0.5 * step.abs() {
            step = newton;
            if next == s {
                break;
            }
            s = next;
        } else {
            step = 0.5 * (high - low);
            let middle = low + step;
            if middle <= low || middle >= high {
                break;
            }
            s = middle;
        }
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polynomial by its roots, evaluated as their product.
    struct Roots<'a>(&'a [f64]);

    impl Signs for Roots<'_> {
        fn is_positive(&self, s: f64) -> bool {
            self.value(s) >= 0.0
        }

        fn slope(&self, s: f64) -> f64 {
            (self.value(s + 1e-7) - self.value(s - 1e-7)) / 2e-7
        }
    }

    impl Roots<'_> {
        fn value(&self, s: f64) -> f64 {
            self.0.iter().map(|r| s - r).product()
        }

        /// Bernstein coefficients of degree 6 by multiplying factors, each raised from degree k to k + 1.
        fn coefficients(&self) -> Coefficients {
            let mut c = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            for (k, root) in self.0.iter().enumerate() {
                let n = (k + 1) as f64;
                let old = c;
                for i in 0..=k + 1 {
                    let i_f = i as f64;
                    let left = if i > 0 { old[i - 1] } else { 0.0 };
                    let right = if i <= k { old[i] } else { 0.0 };
                    c[i] = (i_f * left * (1.0 - root) + (n - i_f) * right * -root) / n;
                }
            }
            c
        }
    }

    fn brackets(roots: &[f64]) -> Vec<[f64; 2]> {
        let signs = Roots(roots);
        let mut found = Vec::new();
        let whole = Bracket {
            ends: [0.0, 1.0],
            positive: [signs.is_positive(0.0), signs.is_positive(1.0)],
        };
        let c = signs.coefficients();
        isolate(&signs, &c, roots.len(), 1e-15, whole, &mut |b| {
            assert_ne!(b.positive[0], b.positive[1]);
            found.push(b.ends);
        });
        found
    }

    #[test]
    fn every_root_has_its_bracket() {
        let sets: [&[f64]; 5] = [
            &[0.1, 0.25, 0.5, 0.7, 0.71, 0.95],
            &[0.3, 0.300001, 2.0, -1.0, 0.9, 5.0],
            &[-0.5, 1.5, 1.25, -2.0, 0.5, 7.0],
            &[0.2, 0.9],
            &[1.5, 2.5],
        ];
        for roots in sets {
            let mut inside: Vec<f64> = roots
                .iter()
                .copied()
                .filter(|r| (0.0..=1.0).contains(r))
                .collect();
            inside.sort_by(f64::total_cmp);
            let found = brackets(roots);
            assert_eq!(found.len(), inside.len(), "{roots:?}: {found:?}");
            for (b, r) in found.iter().zip(&inside) {
                assert!(b[0] <= *r && *r <= b[1], "{roots:?}: {found:?}");
            }
        }
    }

    #[test]
    fn nothing_but_zero_ends_soon() {
        struct Zero(std::cell::Cell<u32>);
        impl Signs for Zero {
            fn is_positive(&self, _: f64) -> bool {
                self.0.set(self.0.get() + 1);
                true
            }
            fn slope(&self, _: f64) -> f64 {
                0.0
            }
        }
        let zero = Zero(std::cell::Cell::new(0));
        let whole = Bracket {
            ends: [0.0, 1.0],
            positive: [true, true],
        };
        isolate(&zero, &[0.0; 7], 6, 1e-15, whole, &mut |b| {
            panic!("{b:?}");
        });
        assert!(zero.0.get() < 4);
    }
}
