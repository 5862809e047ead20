//! How long one render takes as a multiple of another, on a machine that does other things too: a number with its interval,
//! or the word "inconclusive", never a wrong number.
//!
//! Each round runs A B B A and gives one ratio, (b1 + b2) / (a1 + a2), so that what slows the machine for a while slows both.
//! The median of the ratios has a distribution-free 95 % interval: the order statistics that enclose it with that
//! probability whatever the noise is like (binomial with p = 1/2), which exists from 6 rounds on. A ratio counts if the interval lies
//! within 5 % of the median, and if the ratio of the fastest runs, which noise can only have slowed, agrees with
//! the median to 5 %. (Numerics guide, section 6.)

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};

/// Rounds that the numerics guide asks for.
pub const ROUNDS: usize = 31;
/// Fewest rounds that have a 95 % interval.
pub const FEWEST: usize = 6;
/// How far interval and fastest runs may be from the median.
const TOLERANCE: f64 = 0.05;
/// Probability that the interval encloses the median.
const CONFIDENCE: f64 = 0.95;

/// Times of one round in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round {
    /// Both runs of A.
    pub a: [f64; 2],
    /// Both runs of B.
    pub b: [f64; 2],
}

/// Times of B in times of A.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ratio {
    /// Rounds that were run.
    pub rounds: usize,
    /// Median of the rounds' ratios.
    pub median: f64,
    /// 95 % interval of the median; `None` below [`FEWEST`] rounds.
    pub interval: Option<[f64; 2]>,
    /// Fastest run of B over fastest run of A.
    pub minimum: f64,
    /// Fastest run of A, in seconds.
    pub base: f64,
}

impl Ratio {
    /// Of some rounds; `None` where there is none, or a time is not positive.
    pub fn of(rounds: &[Round]) -> Option<Self> {
        let times = |f: fn(&Round) -> [f64; 2]| rounds.iter().flat_map(f);
        let usable = |t: f64| t > 0.0 && t.is_finite();
        if rounds.is_empty() || !times(|r| r.a).chain(times(|r| r.b)).all(usable) {
            return None;
        }
        let mut ratios: Vec<f64> = rounds
            .iter()
            .map(|r| (r.b[0] + r.b[1]) / (r.a[0] + r.a[1]))
            .collect();
        ratios.sort_by(f64::total_cmp);
        let base = times(|r| r.a).fold(f64::INFINITY, f64::min);
        let fastest = times(|r| r.b).fold(f64::INFINITY, f64::min);
        Some(Self {
            rounds: rounds.len(),
            median: median(&ratios),
            interval: rank(ratios.len()).map(|k| [ratios[k], ratios[ratios.len() - 1 - k]]),
            minimum: fastest / base,
            base,
        })
    }

    /// The ratio if it may be told, else why not.
    pub fn verdict(&self) -> Result<f64, String> {
        let Some([low, high]) = self.interval else {
            let rounds = self.rounds;
            return Err(format!("{rounds} rounds, {FEWEST} needed for an interval"));
        };
        let spread = (high / self.median - 1.0).max(1.0 - low / self.median);
        if spread > TOLERANCE {
            let percent = 100.0 * spread;
            return Err(format!(
                "the 95 % interval reaches {percent:.0} % from the median"
            ));
        }
        let apart = (self.minimum / self.median - 1.0).abs();
        if apart > TOLERANCE {
            let percent = 100.0 * apart;
            return Err(format!("fastest runs and median differ by {percent:.0} %"));
        }
        Ok(self.median)
    }
}

/// The middle of a sorted list that is not empty.
fn median(sorted: &[f64]) -> f64 {
    let n = sorted.len();
    f64::midpoint(sorted[(n - 1) / 2], sorted[n / 2])
}

/// How many of `n` sorted values to leave out at each end for a 95 % interval of the median: the largest k with
/// 2 P(fewer than k + 1 of n fair coins show heads) <= 5 %.
fn rank(n: usize) -> Option<usize> {
    // Probability of exactly i heads, one after the other; n is small enough that none is lost to underflow.
    let mut term = 0.5f64.powi(i32::try_from(n).ok()?);
    let mut below = 0.0;
    let mut found = None;
    for i in 0..n / 2 {
        below += term;
        match (2.0 * below).partial_cmp(&(1.0 - CONFIDENCE)) {
            Some(Ordering::Less | Ordering::Equal) => found = Some(i),
            _ => break,
        }
        term *= (n - i) as f64 / (i + 1) as f64;
    }
    found
}

/// Runs rounds of A B B A until there are `most`, or `go_on` says no. `a` and `b` run once and return their seconds.
///
/// # Errors
/// The first error of a run.
pub fn rounds<E>(
    most: usize,
    mut a: impl FnMut() -> Result<f64, E>,
    mut b: impl FnMut() -> Result<f64, E>,
    mut go_on: impl FnMut(usize) -> bool,
) -> Result<Vec<Round>, E> {
    let mut done = Vec::new();
    while done.len() < most && go_on(done.len()) {
        let (a1, b1) = (a()?, b()?);
        let (b2, a2) = (b()?, a()?);
        done.push(Round {
            a: [a1, a2],
            b: [b1, b2],
        });
    }
    Ok(done)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform in 0..1, the same every time.
    struct Random(u64);
    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    /// Rounds of a machine on which B takes `ratio` times as long, each run slowed by `noise`, all of a round by `load`.
    fn machine(n: usize, ratio: f64, noise: f64, load: f64, seed: u64) -> Vec<Round> {
        let mut random = Random(seed);
        (0..n)
            .map(|_| {
                let slow = 1.0 + load * random.next();
                let mut run = |t: f64| t * slow * (1.0 + noise * random.next());
                let (a1, b1) = (run(0.01), run(0.01 * ratio));
                let (b2, a2) = (run(0.01 * ratio), run(0.01));
                Round {
                    a: [a1, a2],
                    b: [b1, b2],
                }
            })
            .collect()
    }

    #[test]
    fn ranks_are_those_of_the_binomial_table() {
        // Tables of the sign test: n = 6: 1..6; 10: 2..9; 20: 6..15; 31: 10..22; 100: 40..61 (counted from 1).
        for (n, first) in [(6, 1), (10, 2), (20, 6), (31, 10), (100, 40)] {
            assert_eq!(rank(n), Some(first - 1), "{n}");
        }
        assert!((1..FEWEST).all(|n| rank(n).is_none()));
    }

    #[test]
    fn a_quiet_machine_gives_the_ratio() {
        let ratio = Ratio::of(&machine(31, 3.0, 0.01, 0.0, 1)).expect("times");
        let found = ratio.verdict().expect("conclusive");
        assert!((found / 3.0 - 1.0).abs() < 0.01, "{ratio:?}");
    }

    #[test]
    fn load_that_slows_whole_rounds_cancels() {
        // Rounds up to 9 times slower, A and B alike.
        let ratio = Ratio::of(&machine(31, 0.25, 0.01, 8.0, 2)).expect("times");
        let [low, high] = ratio.interval.expect("31 rounds");
        assert!(
            low <= 0.2505 && 0.2495 <= high && high / low < 1.02,
            "{ratio:?}"
        );
    }

    #[test]
    fn noise_and_few_rounds_are_inconclusive() {
        let noisy = Ratio::of(&machine(31, 2.0, 3.0, 0.0, 3)).expect("times");
        assert!(noisy.verdict().expect_err("noise").contains("95 %"));
        let few = Ratio::of(&machine(5, 2.0, 0.0, 0.0, 4)).expect("times");
        assert!(few.verdict().expect_err("5 rounds").contains("5 rounds"));
        // B is slowed in most rounds, and only in a few runs as fast as it can be.
        let mut skewed = machine(31, 2.0, 0.01, 0.0, 5);
        for round in skewed.iter_mut().skip(4) {
            round.b = round.b.map(|t| 1.3 * t);
        }
        let skewed = Ratio::of(&skewed).expect("times");
        assert!(
            skewed
                .verdict()
                .expect_err("two answers")
                .contains("fastest")
        );
        assert_eq!(Ratio::of(&[]), None);
        let broken = Round {
            a: [0.0; 2],
            b: [1.0; 2],
        };
        assert_eq!(Ratio::of(&[broken]), None);
    }

    /// The interval encloses the true median about 95 times in 100 (97.1 % for 31 rounds by the binomial).
    #[test]
    fn intervals_keep_their_promise() {
        let inside = (0..400)
            .filter(|seed| {
                let rounds = machine(31, 2.0, 1.0, 1.0, 7919 * seed + 11);
                // A and B are slowed alike, so that the median of the ratio is the ratio.
                let [low, high] = Ratio::of(&rounds).and_then(|r| r.interval).expect("31");
                low <= 2.0 && 2.0 <= high
            })
            .count();
        assert!((374..=399).contains(&inside), "{inside} of 400");
    }

    #[test]
    fn rounds_interleave_and_stop() {
        let order = std::cell::RefCell::new(String::new());
        let run = |name: char| {
            order.borrow_mut().push(name);
            Ok::<f64, ()>(1.0)
        };
        let done = rounds(3, || run('a'), || run('b'), |n| n < 2).expect("no error");
        assert_eq!((done.len(), order.borrow().as_str()), (2, "abbaabba"));
        assert_eq!(rounds(3, || Err(1), || Ok(1.0), |_| true), Err(1));
    }
}
