//! Sums in one order, and percentiles.

/// The sum of all values: each row left to right, then the rows from top to bottom; and how many there are.
pub(crate) fn sum_in_rows<R: Iterator<Item = f64>>(rows: impl Iterator<Item = R>) -> (f64, usize) {
    rows.fold((0.0, 0), |(sum, count), row| {
        let (row, n) = row.fold((0.0, 0), |(s, n), v| (s + v, n + 1));
        (sum + row, count + n)
    })
}

/// The mean in that order; 0 of nothing.
pub(crate) fn mean<R: Iterator<Item = f64>>(rows: impl Iterator<Item = R>) -> f64 {
    let (sum, count) = sum_in_rows(rows);
    sum / count.max(1) as f64
}

/// The mean of the squares of errors, summed row by row: each row left to right, then the rows from top to bottom; 0 of
/// nothing. One row holds all of them where the order of a picture does not matter.
///
/// ```
/// use rastray_compare::mse;
/// let rows = [[0.5, -0.5], [1.0, 0.0]];
/// assert_eq!(mse(rows.into_iter().map(|row| row.into_iter())), 0.375);
/// ```
pub fn mse<R: Iterator<Item = f64>>(rows: impl Iterator<Item = R>) -> f64 {
    mean(rows.map(|row| row.map(|error| error * error)))
}

/// The root of [`mse`], in the unit of the errors.
///
/// ```
/// assert_eq!(rastray_compare::rmse(std::iter::once([3.0, 4.0, 0.0, 0.0].into_iter())), 2.5);
/// ```
pub fn rmse<R: Iterator<Item = f64>>(rows: impl Iterator<Item = R>) -> f64 {
    mse(rows).sqrt()
}

/// Nearest-rank percentile: the smallest value that at least `percent` % of the values do not exceed. There must be one.
pub(crate) fn percentile(values: &mut [f64], percent: usize) -> f64 {
    let rank = (values.len() as u128 * percent as u128)
        .div_ceil(100)
        .max(1) as usize;
    *values.select_nth_unstable_by(rank - 1, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_nearest_rank() {
        let mut values: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(percentile(&mut values, 50), 50.0);
        assert_eq!(percentile(&mut values, 95), 95.0);
        assert_eq!(percentile(&mut values, 99), 99.0);
        assert_eq!(percentile(&mut [7.0], 50), 7.0);
    }

    #[test]
    fn rows_are_summed_first() {
        let big = 9_007_199_254_740_992.0; // 2^53: adding 1 changes nothing, taking 1 away does
        let rows = [[big, 1.0], [1.0, -big]];
        let (sum, count) = sum_in_rows(rows.iter().map(|row| row.iter().copied()));
        assert_eq!((sum, count), (1.0, 4));
        assert_eq!(mean(std::iter::empty::<std::iter::Empty<f64>>()), 0.0);
        // Squares in the same order: 2^54 - 2 is lost one by one, and kept where a row gathers it first.
        let ones = || std::iter::repeat_n(1.0, 2);
        let big = || std::iter::once(134_217_728.0); // its square is 2^54, whose neighbours are 4 apart
        assert_eq!(
            mse(std::iter::once(big().chain(ones()))) * 3.0,
            18_014_398_509_481_984.0
        );
        let rows: [Vec<f64>; 2] = [big().collect(), [1.0; 3].to_vec()];
        let gathered = mse(rows.iter().map(|row| row.iter().copied())) * 4.0;
        assert_eq!(gathered, 18_014_398_509_481_988.0);
        assert_eq!(rmse(std::iter::empty::<std::iter::Empty<f64>>()), 0.0);
    }
}
