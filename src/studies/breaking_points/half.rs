//! Where an accuracy falls to half of its best.
//!
//! The interval is by simulation: each mean accuracy a of n independent test rows (where groups are held out, fewer than there are) is drawn from its posterior Beta(a n + ½, (1 − a) n + ½) under
//! Jeffreys' prior, and the place is found again, with the best at the same value; the middle 95 % of the places are the interval. In a
//! draw that does not fall so far the place is beyond the last value.

use crate::random::Seed;
use crate::statistics::p_status::CONFIDENCE;
use crate::studies::breaking_points::rows::{BreakingPoint, Side, WayCell};
use crate::studies::breaking_points::scale::WayScale;
use crate::studies::recognition::rows::table_rows::CellScore;
use rand_distr::{Beta, Distribution};

/// Draws of all accuracies. More: the ends of intervals move by less than is drawn in a chart; fewer: they jump with the seed.
const N_DRAWS: usize = 4000;

/// A curve of mean accuracies over ascending values.
struct Curve {
    scale: WayScale,
    values: Vec<f64>,
    /// Mean accuracies, one a value.
    accuracy: Vec<f64>,
    /// Independent test rows that each counts for.
    n_test: Vec<f64>,
}

impl Curve {
    /// The index of the highest accuracy, the first of equals.
    fn best(&self) -> usize {
        let accuracy = &self.accuracy;
        let backwards = (0..accuracy.len()).rev();
        let best = backwards.max_by(|&a, &b| accuracy[a].total_cmp(&accuracy[b]));
        best.unwrap_or(0)
    }

    /// Indices from the best to the last value on a side.
    fn outwards(&self, side: Side) -> Vec<usize> {
        match side {
            Side::Smaller => (0..=self.best()).rev().collect(),
            Side::Larger => (self.best()..self.values.len()).collect(),
        }
    }

    /// Where it breaks on a side, and both ends of the interval of that place; none beyond the last value.
    fn half(&self, side: Side, seed: &Seed) -> [Option<f64>; 3] {
        let start = WayScale::start(self.values.iter().copied());
        let place = |&value: &f64| self.scale.place(value, start);
        let places: Vec<f64> = self.values.iter().map(place).collect();
        let outwards = self.outwards(side);
        let beyond = match side {
            Side::Smaller => f64::NEG_INFINITY,
            Side::Larger => f64::INFINITY,
        };
        let found = |accuracy: &[f64]| {
            let half = 0.5 * accuracy[outwards[0]];
            let mut steps = outwards.windows(2);
            let crossing = steps.find_map(|step| {
                let (before, after) = (accuracy[step[0]], accuracy[step[1]]);
                let part = (before - half) / (before - after);
                let way = places[step[1]] - places[step[0]];
                (after <= half).then(|| places[step[0]] + part * way)
            });
            crossing.unwrap_or(beyond)
        };
        let beta = |(accuracy, &n): (&f64, &f64)| {
            let right = accuracy * n;
            Beta::new(right + 0.5, n - right + 0.5).expect("both are positive")
        };
        let betas: Vec<Beta<f64>> = self.accuracy.iter().zip(&self.n_test).map(beta).collect();
        let mut rng = seed.rng();
        let mut draw = || {
            let drawn = betas.iter().map(|beta| beta.sample(&mut rng));
            found(&drawn.collect::<Vec<_>>())
        };
        let mut draws: Vec<f64> = (0..N_DRAWS).map(|_| draw()).collect();
        draws.sort_by(f64::total_cmp);
        let tail = (0.5 * (1.0 - CONFIDENCE) * N_DRAWS as f64) as usize;
        let ends = [
            found(&self.accuracy),
            draws[tail],
            draws[N_DRAWS - 1 - tail],
        ];
        ends.map(|place| {
            let is_there = place.is_finite();
            is_there.then(|| self.scale.value(place, start))
        })
    }
}

/// A row of the summary with the number of independent test rows that it counts for.
pub(super) type ScoredCell<'a> = (&'a (WayCell, CellScore), f64);

/// Where a classifier breaks along a way, on each side of its best: a row each. Its scores are by ascending values.
pub(super) fn breaking_points(
    scores: &[&ScoredCell],
    scale: WayScale,
    n_objects: usize,
    seed: &Seed,
) -> Vec<BreakingPoint> {
    let curve = Curve {
        scale,
        values: scores.iter().map(|((cell, _), _)| cell.value).collect(),
        accuracy: scores
            .iter()
            .map(|((_, score), _)| score.accuracy)
            .collect(),
        n_test: scores.iter().map(|(_, n_rows)| *n_rows).collect(),
    };
    let ((cell, best), _) = scores[curve.best()];
    let row = |side| {
        let outwards = curve.outwards(side);
        let end = outwards[1..].last()?;
        let [breaks_at, breaks_at_low, breaks_at_high] =
            curve.half(side, &seed.numbered(side as u64));
        Some(BreakingPoint {
            way: cell.way.clone(),
            classifier: cell.classifier,
            side,
            best: best.accuracy,
            best_low: best.accuracy_low,
            best_high: best.accuracy_high,
            best_at: cell.value,
            half: 0.5 * best.accuracy,
            chance: 1.0 / n_objects as f64,
            is_reached: breaks_at.is_some(),
            breaks_at,
            breaks_at_low,
            breaks_at_high,
            end: curve.values[*end],
            accuracy_at_end: curve.accuracy[*end],
        })
    };
    [Side::Smaller, Side::Larger]
        .into_iter()
        .filter_map(row)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(values: &[f64], accuracy: &[f64], n_test: &[f64]) -> Curve {
        Curve {
            values: values.to_vec(),
            accuracy: accuracy.to_vec(),
            n_test: n_test.to_vec(),
            scale: WayScale::Logarithmic,
        }
    }

    #[test]
    fn it_breaks_where_a_line_between_the_points_meets_half_of_the_best() {
        let values = [0.01, 0.1, 1.0, 10.0, 100.0];
        let accuracy = [0.2, 0.6, 0.8, 0.4, 0.1];
        let curve = curve(&values, &accuracy, &[1e6; 5]);
        let halves = [Side::Larger, Side::Smaller].map(|side| {
            let half = curve.half(side, &Seed::new(1));
            half.map(|place| place.unwrap())
        });
        assert!((halves[0][0] - 10.0).abs() < 1e-9, "exactly at a point");
        // Half way between 0.01 and 0.1 in the logarithm.
        assert!((halves[1][0] - 0.1f64.powf(1.5)).abs() < 1e-9, "{halves:?}");
        for [at, low, high] in halves {
            assert!(low < at && at < high && high < 1.05 * low);
        }
    }

    #[test]
    fn a_curve_that_does_not_fall_so_far_has_no_breaking_point() {
        let values = [0.0, 1.0, 2.0];
        let flat = curve(&values, &[0.9, 0.8, 0.6], &[1e5; 3]);
        assert_eq!(flat.outwards(Side::Smaller), [0]);
        assert_eq!(flat.outwards(Side::Larger), [0, 1, 2]);
        let [at, low, _] = flat.half(Side::Larger, &Seed::new(1));
        assert_eq!((at, low), (None, None));
        // With few test rows it may have one all the same.
        let unsure = curve(&values, &[0.9, 0.8, 0.5], &[12.0; 3]);
        let [at, low, high] = unsure.half(Side::Larger, &Seed::new(1));
        assert!(at.is_none() && low.unwrap() < 2.0);
        assert_eq!(high, None);
    }

    /// Of many experiments on a curve that is known, the interval holds the true place in about 95 %.
    #[test]
    fn the_interval_holds_the_true_place_as_often_as_it_says() {
        use rand_distr::Binomial;
        let values: Vec<f64> = (0..9).map(|k| f64::from(k) + 1.0).collect();
        let truth: Vec<f64> = values
            .iter()
            .map(|x| 0.9 / (1.0 + (x / 5.0).powi(4)))
            .collect();
        let n = 400;
        let half = |accuracy: &[f64], seed| {
            let half =
                curve(&values, accuracy, &[n as f64; 9]).half(Side::Larger, &Seed::new(seed));
            half.map(|place| place.unwrap_or(f64::INFINITY))
        };
        let [exact, ..] = half(&truth, 0);
        let n_cases = 300;
        let mut n_held = 0;
        for case in 0..n_cases {
            let mut rng = Seed::new(9).named("cases").numbered(case).rng();
            let seen: Vec<f64> = truth
                .iter()
                .map(|&p| Binomial::new(n as u64, p).unwrap().sample(&mut rng) as f64 / n as f64)
                .collect();
            let [_, low, high] = half(&seen, case);
            n_held += usize::from(low <= exact && exact <= high);
        }
        let share = n_held as f64 / n_cases as f64;
        assert!((0.9..=0.995).contains(&share), "{share}");
    }
}
