//! Where an accuracy falls to half of its best.
//!
//! The interval is by draws: each mean accuracy a of n test rows is drawn anew from Beta(a n + ½, (1 − a) n + ½), what Jeffreys'
//! prior leaves of it, and the place found again, the best staying at its value; the middle 95 % of the places are the
//! interval. A draw that does not fall so far counts as a place beyond the last value.

use super::rows::{BreakingPoint, CellScore, Side};
use super::scale::WayScale;
use super::spec::WaySpec;
use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::recognition::interval::Interval;
use crate::study::evaluation::CONFIDENCE;
use rand_distr::{Beta, Distribution};

/// Draws of all accuracies. More: the ends of intervals move by less than is drawn in a chart; fewer: they jump with the seed.
const N_DRAWS: usize = 4000;

/// A curve of mean accuracies over ascending values.
struct Curve<'a> {
    pub values: &'a [f64],
    /// Mean accuracies, one a value.
    pub accuracy: &'a [f64],
    /// Test rows that each counts for.
    pub n_test: &'a [usize],
    pub scale: WayScale,
}

/// Where a curve breaks on a side; places beyond the last value are infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Half {
    pub at: f64,
    pub interval: Interval,
}

impl Curve<'_> {
    /// The index of the highest accuracy, the first of equals.
    pub fn best(&self) -> usize {
        let mut best = 0;
        for (index, accuracy) in self.accuracy.iter().enumerate() {
            if *accuracy > self.accuracy[best] {
                best = index;
            }
        }
        best
    }

    /// The sides on which there are values beside the best.
    pub fn sides(&self) -> Vec<Side> {
        let best = self.best();
        let mut sides = Vec::new();
        if best > 0 {
            sides.push(Side::Smaller);
        }
        if best + 1 < self.values.len() {
            sides.push(Side::Larger);
        }
        sides
    }

    /// Where it breaks on a side.
    pub fn half(&self, side: Side, seed: &Seed) -> Half {
        let start = WayScale::start(self.values.iter().copied());
        let places: Vec<f64> = self
            .values
            .iter()
            .map(|&value| self.scale.place(value, start))
            .collect();
        let best = self.best();
        let found = |accuracy: &[f64]| crossing(&places, accuracy, best, side);
        let mut rng = seed.rng();
        let beta = |(accuracy, n): (&f64, &usize)| {
            let n = *n as f64;
            let right = accuracy * n;
            Beta::new(right + 0.5, n - right + 0.5).expect("both are positive")
        };
        let betas: Vec<Beta<f64>> = self.accuracy.iter().zip(self.n_test).map(beta).collect();
        let mut drawn = vec![0.0; betas.len()];
        let mut draws: Vec<f64> = (0..N_DRAWS)
            .map(|_| {
                for (drawn, beta) in drawn.iter_mut().zip(&betas) {
                    *drawn = beta.sample(&mut rng);
                }
                found(&drawn)
            })
            .collect();
        draws.sort_by(f64::total_cmp);
        let tail = 0.5 * (1.0 - CONFIDENCE) * N_DRAWS as f64;
        let value = |place: f64| match place.is_finite() {
            true => self.scale.value(place, start),
            false => place,
        };
        let (low, high) = (draws[tail as usize], draws[N_DRAWS - 1 - tail as usize]);
        Half {
            at: value(found(self.accuracy)),
            interval: Interval {
                low: value(low),
                high: value(high),
            },
        }
    }
}

/// One row a side of the best of a curve: the values of a way, ascending, with what a classifier scored.
pub(super) fn breaking_points(
    (way, classifier): (&WaySpec, ClassifierKind),
    points: &[(f64, CellScore)],
    n_objects: usize,
    seed: &Seed,
) -> Vec<BreakingPoint> {
    let values: Vec<f64> = points.iter().map(|(value, _)| *value).collect();
    let accuracy: Vec<f64> = points.iter().map(|(_, score)| score.accuracy).collect();
    let n_test: Vec<usize> = points.iter().map(|(_, score)| score.n_test).collect();
    let curve = Curve {
        values: &values,
        accuracy: &accuracy,
        n_test: &n_test,
        scale: way.scale,
    };
    let (best, last) = (curve.best(), values.len() - 1);
    let row = |side| {
        let half = curve.half(side, &seed.numbered(side as u64));
        let end = match side {
            Side::Smaller => 0,
            Side::Larger => last,
        };
        let finite = |value: f64| value.is_finite().then_some(value);
        BreakingPoint {
            way: way.name.clone(),
            classifier,
            side,
            best: accuracy[best],
            best_low: points[best].1.accuracy_low,
            best_high: points[best].1.accuracy_high,
            best_at: values[best],
            half: 0.5 * accuracy[best],
            chance: 1.0 / n_objects as f64,
            is_reached: half.at.is_finite(),
            breaks_at: finite(half.at),
            breaks_at_low: finite(half.interval.low),
            breaks_at_high: finite(half.interval.high),
            end: values[end],
            accuracy_at_end: accuracy[end],
        }
    };
    curve.sides().into_iter().map(row).collect()
}

/// The place at which the accuracy, going outwards from its best, first falls to half of it; infinite if it does not.
fn crossing(places: &[f64], accuracy: &[f64], best: usize, side: Side) -> f64 {
    let half = 0.5 * accuracy[best];
    let step = |from: usize, to: usize| -> Option<f64> {
        let (before, after) = (accuracy[from], accuracy[to]);
        if after > half {
            return None;
        }
        let part = (before - half) / (before - after);
        Some(places[from] + part * (places[to] - places[from]))
    };
    match side {
        Side::Larger => {
            let mut steps = (best + 1..places.len()).filter_map(|to| step(to - 1, to));
            steps.next().unwrap_or(f64::INFINITY)
        }
        Side::Smaller => {
            let mut steps = (0..best).rev().filter_map(|to| step(to + 1, to));
            steps.next().unwrap_or(f64::NEG_INFINITY)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve<'a>(values: &'a [f64], accuracy: &'a [f64], n_test: &'a [usize]) -> Curve<'a> {
        Curve {
            values,
            accuracy,
            n_test,
            scale: WayScale::Logarithmic,
        }
    }

    #[test]
    fn it_breaks_where_a_line_between_the_points_meets_half_of_the_best() {
        let values = [0.01, 0.1, 1.0, 10.0, 100.0];
        let accuracy = [0.2, 0.6, 0.8, 0.4, 0.1];
        let curve = curve(&values, &accuracy, &[1_000_000; 5]);
        assert_eq!(curve.sides(), [Side::Smaller, Side::Larger]);
        let larger = curve.half(Side::Larger, &Seed::new(1));
        assert!((larger.at - 10.0).abs() < 1e-9, "exactly at a point");
        // Half way between 0.01 and 0.1 in the logarithm.
        let smaller = curve.half(Side::Smaller, &Seed::new(1));
        assert!((smaller.at - 0.1f64.powf(1.5)).abs() < 1e-9, "{smaller:?}");
        for half in [larger, smaller] {
            let Interval { low, high } = half.interval;
            assert!(low < half.at && half.at < high && high < 1.05 * low);
        }
    }

    #[test]
    fn a_curve_that_does_not_fall_so_far_has_no_breaking_point() {
        let values = [0.0, 1.0, 2.0];
        let flat = curve(&values, &[0.9, 0.8, 0.6], &[100_000; 3]);
        assert_eq!(flat.sides(), [Side::Larger]);
        let half = flat.half(Side::Larger, &Seed::new(1));
        assert_eq!(half.at, f64::INFINITY);
        assert_eq!(half.interval.low, f64::INFINITY);
        // With few test rows it may have one all the same.
        let unsure = curve(&values, &[0.9, 0.8, 0.5], &[12; 3]);
        let half = unsure.half(Side::Larger, &Seed::new(1));
        assert!(half.at.is_infinite() && half.interval.low < 2.0);
        assert_eq!(half.interval.high, f64::INFINITY);
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
        let exact = curve(&values, &truth, &[n; 9])
            .half(Side::Larger, &Seed::new(0))
            .at;
        let n_cases = 300;
        let mut n_held = 0;
        for case in 0..n_cases {
            let mut rng = Seed::new(9).named("cases").numbered(case).rng();
            let seen: Vec<f64> = truth
                .iter()
                .map(|&p| Binomial::new(n as u64, p).unwrap().sample(&mut rng) as f64 / n as f64)
                .collect();
            let half = curve(&values, &seen, &[n; 9]).half(Side::Larger, &Seed::new(case));
            n_held += usize::from(half.interval.low <= exact && exact <= half.interval.high);
        }
        let share = n_held as f64 / n_cases as f64;
        assert!((0.9..=0.995).contains(&share), "{share}");
    }
}
