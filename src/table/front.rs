//! Pareto front of points with a cost and a value.

/// Returns for each point (cost, value) whether it is on the Pareto front; the time is O(n log n).
///
/// A point is on the front if no other point dominates it. Point p dominates q if p is at most as costly and at least as good, and better in one of both.
/// `is_better(a, b)` returns whether value a is better than value b. A point with a NaN is never on the front.
pub fn front(points: &[(f64, f64)], is_better: impl Fn(f64, f64) -> bool) -> Vec<bool> {
    let is_number = |&place: &usize| !(points[place].0.is_nan() || points[place].1.is_nan());
    let mut order: Vec<usize> = (0..points.len()).filter(is_number).collect();
    let by_value = |a: f64, b: f64| match (is_better(a, b), is_better(b, a)) {
        (true, _) => std::cmp::Ordering::Less,
        (_, true) => std::cmp::Ordering::Greater,
        _ => std::cmp::Ordering::Equal,
    };
    // 0 and −0 are equal costs.
    let cost = |place: usize| points[place].0 + 0.0;
    order.sort_by(|&a, &b| {
        let by_cost = cost(a).total_cmp(&cost(b));
        by_cost.then_with(|| by_value(points[a].1, points[b].1))
    });
    let mut on_front = vec![false; points.len()];
    let mut best: Option<(f64, f64)> = None;
    for place in order {
        let (cost, value) = (cost(place), points[place].1);
        on_front[place] = match best {
            None => true,
            Some((at, best)) => is_better(value, best) || (cost == at && !is_better(best, value)),
        };
        if on_front[place] {
            best = Some((cost, value));
        }
    }
    on_front
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    #[test]
    fn whom_nobody_beats_is_on_the_front() {
        let mut rng = Seed::new(3).named("front").rng();
        for n in [0, 1, 2, 5, 40, 300] {
            for steps in [2, 10, 1000] {
                // Few distinct steps give many equal points; some values are infinite or NaN.
                let mut number = || match rng.gen_range(0..steps + 3) {
                    0 => f64::INFINITY,
                    1 if steps > 2 => f64::NAN,
                    2 => -0.0,
                    n => f64::from(n - 3),
                };
                let points: Vec<(f64, f64)> = (0..n).map(|_| (number(), number())).collect();
                let beats =
                    |(a, b): (f64, f64), (x, y): (f64, f64)| a <= x && b >= y && (a < x || b > y);
                let wanted = points.iter().map(|&point| {
                    !point.0.is_nan()
                        && !point.1.is_nan()
                        && !points.iter().any(|&other| beats(other, point))
                });
                let found = front(&points, |a, b| a > b);
                assert_eq!(found, wanted.collect::<Vec<_>>(), "{points:?}");
            }
        }
    }
}
