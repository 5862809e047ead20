//! The Pareto front: settings that no other one beats in cost and error at once.

/// Which of some points (cost, error) are on the front: no other point is at most as costly and at most as wrong, and
/// better in one of the two. Of equal points the first is. Points that are not finite never are.
///
/// ```
/// use rastray::trade::front::front;
/// assert_eq!(front(&[(1.0, 9.0), (2.0, 9.0), (3.0, 1.0), (3.0, 1.0)]), [true, false, true, false]);
/// ```
pub fn front(points: &[(f64, f64)]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..points.len())
        .filter(|i| points[*i].0.is_finite() && points[*i].1.is_finite())
        .collect();
    // Cheapest first; of equal cost the most exact, then the first.
    order.sort_by(|a, b| {
        let (a, b) = (points[*a], points[*b]);
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut on = vec![false; points.len()];
    let mut least = f64::INFINITY;
    for i in order {
        if points[i].1 < least {
            (on[i], least) = (true, points[i].1);
        }
    }
    on
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_that_of_the_definition() {
        // A repeatable scatter, held to the definition itself.
        let points: Vec<(f64, f64)> = (0..60u32)
            .map(|i| (f64::from(i * 37 % 23), f64::from(i * 53 % 29)))
            .collect();
        let found = front(&points);
        for (i, a) in points.iter().enumerate() {
            let beaten = points.iter().enumerate().any(|(j, b)| {
                let as_good = b.0 <= a.0 && b.1 <= a.1;
                as_good && (b.0 < a.0 || b.1 < a.1 || j < i)
            });
            assert_eq!(found[i], !beaten, "{i}: {a:?}");
        }
        assert_eq!(front(&[(1.0, f64::NAN), (f64::INFINITY, 0.0)]), [false; 2]);
    }
}
