//! Bootstrap confidence intervals of a mean over trials.

use crate::quantile::of_sorted;
use crate::random::Seed;
use crate::statistics::comparison::student;
use crate::{Error, Result};
use bubbletouch_sim::statistics::interval::{Interval, check_confidence};
use ndarray::ArrayView2;
use rand::Rng;
use statrs::distribution::{ContinuousCDF, Normal};
use std::collections::BTreeMap;

/// Minimum number of trials for a bootstrap interval; four trials give too few distinct resamples for a coverage of 95 %.
pub const FEWEST: usize = 5;

/// Number of bootstrap resamples. For five trials, fewer distinct resamples exist; each of them is then used once and nothing is drawn.
const RESAMPLES: usize = 4000;

/// Returns the true coverage of the 95 % bootstrap interval for `n_trials` trials, rounded to 0.01; `None` if there is no interval. The value is the lowest
/// coverage among normal scores and accuracies of 0.9 and 0.98 at 100 test rows (20,000 draws each). Source: the test `print_the_table_of_the_guide`.
pub fn coverage_of_95(n_trials: usize) -> Option<f64> {
    match n_trials {
        0..FEWEST => None,
        5 => Some(0.92),
        6 => Some(0.93),
        7..15 => Some(0.94),
        _ => Some(0.95),
    }
}

/// Bootstrap intervals of mean scores. Resamples are drawn once for each number of trials and cached. The draws do not depend on a study's seed, so equal
/// scores always have equal intervals.
#[derive(Debug, Default)]
pub struct Bootstrap {
    drawn: BTreeMap<(&'static str, usize), Vec<u32>>,
}

impl Bootstrap {
    /// Returns the bootstrap confidence interval of the mean of `scores`. The shape of `scores` is (n_trials, 1), or splits × projections for crossed trials.
    /// Returns `None` for fewer than [`FEWEST`] rows, or for 2 to 4 columns.
    ///
    /// Rows are drawn with replacement. If there are several columns, columns are drawn too, independently of the rows (Owen, *The pigeonhole bootstrap*,
    /// Annals of Applied Statistics 2007).
    ///
    /// The interval is the expanded percentile interval (Hesterberg, *What teachers should know about the bootstrap*, American Statistician 2015). The
    /// percentiles of the resampled means are moved outwards. The two reasons are that Student's t is wider than a normal distribution, and that s² exceeds
    /// the variance of the resamples. Let n be the smaller number of rows or columns (of rows alone, if there is one column). The tail is Φ(−√(n/(n−1)) ·
    /// t). Plain percentiles of five trials would cover 83 % instead of 95 %.
    ///
    /// # Errors
    /// If a score is not finite, there are no columns, or the confidence is outside 0..1.
    pub fn mean(&mut self, scores: ArrayView2<f64>, confidence: f64) -> Result<Option<Interval>> {
        check_confidence(confidence)?;
        if let Some(score) = scores.iter().find(|score| !score.is_finite()) {
            return Err(Error::input("bootstrap", score, "finite scores"));
        }
        let (n_rows, n_columns) = scores.dim();
        if n_columns == 0 {
            return Err(Error::input("bootstrap", "no columns", "at least one"));
        }
        if n_rows < FEWEST || (2..FEWEST).contains(&n_columns) {
            return Ok(None);
        }
        let (n, mut means) = match n_columns {
            1 => {
                let scores: Vec<f64> = scores.iter().copied().collect();
                (n_rows, means_of_rows(&scores, self.drawn("trials", n_rows)))
            }
            _ => {
                self.drawn("projections", n_columns);
                self.drawn("splits", n_rows);
                let (rows, columns) = (("splits", n_rows), ("projections", n_columns));
                let means = means_of_blocks(scores, &self.drawn[&rows], &self.drawn[&columns]);
                (n_rows.min(n_columns), means)
            }
        };
        means.sort_unstable_by(f64::total_cmp);
        let tail = tail(n, confidence);
        Ok(Some(Interval {
            low: of_sorted(&means, tail),
            high: of_sorted(&means, 1.0 - tail),
        }))
    }

    /// Returns all resamples of `n` trials in sequence; each resample is a block of `n` trial indices.
    fn drawn(&mut self, what: &'static str, n: usize) -> &[u32] {
        self.drawn.entry((what, n)).or_insert_with(|| {
            let n_different = (n as u128).checked_pow(n as u32);
            match n_different {
                Some(all) if what == "trials" && all <= RESAMPLES as u128 => all_of(n),
                _ => {
                    let seed = Seed::new(0).named("bootstrap").named(what);
                    let mut rng = seed.numbered(n as u64).rng();
                    let draws = (0..RESAMPLES * n).map(|_| rng.gen_range(0..n as u32));
                    draws.collect()
                }
            }
        })
    }
}

/// Returns all possible resamples of `n` trials in sequence: all numbers with n digits in base n.
fn all_of(n: usize) -> Vec<u32> {
    let digit = |number: usize, place: usize| (number / n.pow(place as u32) % n) as u32;
    (0..n.pow(n as u32))
        .flat_map(|number| (0..n).map(move |place| digit(number, place)))
        .collect()
}

fn means_of_rows(scores: &[f64], drawn: &[u32]) -> Vec<f64> {
    let n = scores.len();
    let mean = |rows: &[u32]| rows.iter().map(|&row| scores[row as usize]).sum::<f64>() / n as f64;
    drawn.chunks_exact(n).map(mean).collect()
}

fn means_of_blocks(scores: ArrayView2<f64>, rows: &[u32], columns: &[u32]) -> Vec<f64> {
    let (n_rows, n_columns) = scores.dim();
    let resamples = rows
        .chunks_exact(n_rows)
        .zip(columns.chunks_exact(n_columns));
    let mean = |(rows, columns): (&[u32], &[u32])| {
        let of_row = |&row: &u32| -> f64 {
            let scores = scores.row(row as usize);
            columns.iter().map(|&column| scores[column as usize]).sum()
        };
        rows.iter().map(of_row).sum::<f64>() / (n_rows * n_columns) as f64
    };
    resamples.map(mean).collect()
}

/// Returns the fraction of the sorted resampled means that is excluded at each end of the confidence interval; `n` is the number of trials.
fn tail(n: usize, confidence: f64) -> f64 {
    let n = n as f64;
    let t = student(n - 1.0).inverse_cdf(0.5 + 0.5 * confidence);
    Normal::standard().cdf(-(n / (n - 1.0)).sqrt() * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard_errors::{assert_at_least, assert_at_most, assert_expected, of_share};
    use ndarray::{Array2, ArrayView2};
    use rand_distr::{Binomial, Distribution, StandardNormal};

    fn column(scores: &[f64]) -> ArrayView2<'_, f64> {
        ArrayView2::from_shape((scores.len(), 1), scores).unwrap()
    }

    #[test]
    fn five_trials_give_what_all_their_resamples_give_in_numpy() {
        // Expected values: itertools.product(x, repeat=5), means, and quantiles at norm.cdf(-sqrt(5/4) t.ppf(0.975, 4)) and 1 minus this (NumPy and SciPy).
        for (scores, low, high) in [
            ([0.91, 0.93, 0.90, 0.94, 0.92], 0.902, 0.938),
            ([0.91, 0.93, 0.70, 0.94, 0.99], 0.742, 0.98),
        ] {
            let interval = Bootstrap::default().mean(column(&scores), 0.95);
            let interval = interval.unwrap().unwrap();
            assert!((interval.low - low).abs() < 1e-9, "{interval:?}");
            assert!((interval.high - high).abs() < 1e-9, "{interval:?}");
        }
    }

    #[test]
    fn many_trials_come_close_to_the_interval_of_a_normal_mean() {
        let mut rng = Seed::new(5).rng();
        let scores: Vec<f64> = (0..60).map(|_| StandardNormal.sample(&mut rng)).collect();
        let mean = scores.iter().sum::<f64>() / 60.0;
        let squares: f64 = scores.iter().map(|x| (x - mean).powi(2)).sum();
        let error = (squares / 59.0 / 60.0).sqrt();
        let half = 2.000_995 * error; // t.ppf(0.975, 59) of SciPy
        let found = Bootstrap::default().mean(column(&scores), 0.95);
        let found = found.unwrap().unwrap();
        // Standard error of a quantile of 4,000 normal draws: √(p(1 − p)/4000)/φ(2) standard deviations.
        let of_quantile = error * of_share(0.022, RESAMPLES) / 0.0540;
        assert_expected("low", found.low, mean - half, of_quantile);
        assert_expected("high", found.high, mean + half, of_quantile);
    }

    /// Returns the fraction of bootstrap intervals that contain the expectation of the scores that `draw` draws.
    fn coverage(
        n_draws: usize,
        expected: f64,
        mut draw: impl FnMut(&mut rand_chacha::ChaCha8Rng) -> Array2<f64>,
    ) -> f64 {
        let mut rng = Seed::new(11).rng();
        let mut bootstrap = Bootstrap::default();
        let holds = (0..n_draws).filter(|_| {
            let interval = bootstrap.mean(draw(&mut rng).view(), 0.95);
            let interval = interval.unwrap().unwrap();
            // The means of equal scores have rounding errors.
            interval.low <= expected + 1e-12 && expected - 1e-12 <= interval.high
        });
        holds.count() as f64 / n_draws as f64
    }

    /// Returns the coverage of bootstrap intervals for normal scores, and for accuracies of 0.9 and 0.98 with 100 test rows.
    fn coverages(n_draws: usize, n_trials: usize) -> [f64; 3] {
        let of_accuracy = |p: f64| {
            let rows = Binomial::new(100, p).unwrap();
            coverage(n_draws, p, |rng| {
                Array2::from_shape_fn((n_trials, 1), |_| rows.sample(rng) as f64 / 100.0)
            })
        };
        let normal = coverage(n_draws, 0.0, |rng| {
            Array2::from_shape_fn((n_trials, 1), |_| StandardNormal.sample(rng))
        });
        [normal, of_accuracy(0.9), of_accuracy(0.98)]
    }

    #[test]
    fn intervals_hold_the_mean_as_often_as_is_said_of_them() {
        const N_DRAWS: usize = 1000;
        for n_trials in [5, 6, 8, 10, 20] {
            let said = coverage_of_95(n_trials).unwrap();
            let error = of_share(said, N_DRAWS);
            let found = coverages(N_DRAWS, n_trials);
            for held in found {
                // The tabulated coverage is rounded.
                let what = format!("{n_trials} trials");
                assert_at_least(&what, held, said - 0.005, error);
            }
            assert_at_most("normal", found[0], said + 0.005, error);
        }
        assert_eq!(coverage_of_95(4), None);
    }

    #[test]
    fn intervals_of_crossed_trials_hold_the_mean_rather_too_often() {
        const N_DRAWS: usize = 600;
        for (split, projection, rest) in [(1.0, 0.1, 0.1), (0.1, 1.0, 0.1), (1.0, 1.0, 1.0)] {
            let draw = |rng: &mut _| crossed(rng, (8, 6), [split, projection, rest]);
            let held = coverage(N_DRAWS, 0.0, draw);
            let what = format!("{split}, {projection}, {rest}");
            assert_at_least(&what, held, 0.94, of_share(0.94, N_DRAWS));
        }
    }

    /// Prints the coverage of bootstrap intervals for the table in `guide/statistics.md`.
    #[test]
    #[ignore = "prints the table of guide/statistics.md"]
    fn print_the_table_of_the_guide() {
        for n_trials in [5, 6, 7, 8, 9, 10, 15, 20] {
            let [normal, lower, upper] = coverages(20_000, n_trials);
            println!("| {n_trials} | {normal:.3} | {lower:.3} | {upper:.3} |");
        }
        for size in [(5, 5), (8, 6)] {
            let held = coverage(4_000, 0.0, |rng| crossed(rng, size, [1.0, 1.0, 1.0]));
            println!("| {} splits x {} projections | {held:.3} |", size.0, size.1);
        }
    }

    /// Draws scores of crossed trials with given standard deviations of the splits, the projections and the residual.
    fn crossed(
        rng: &mut rand_chacha::ChaCha8Rng,
        (n_splits, n_projections): (usize, usize),
        [split, projection, rest]: [f64; 3],
    ) -> Array2<f64> {
        let mut normal = |std: f64| -> f64 {
            let x: f64 = StandardNormal.sample(rng);
            std * x
        };
        let splits: Vec<f64> = (0..n_splits).map(|_| normal(split)).collect();
        let projections: Vec<f64> = (0..n_projections).map(|_| normal(projection)).collect();
        Array2::from_shape_fn((n_splits, n_projections), |(s, p)| {
            splits[s] + projections[p] + normal(rest)
        })
    }

    #[test]
    fn equal_scores_have_an_interval_of_no_width_and_few_trials_have_none() {
        let mut bootstrap = Bootstrap::default();
        let same = bootstrap.mean(column(&[0.75; 9]), 0.95).unwrap().unwrap();
        assert_eq!((same.low, same.high), (0.75, 0.75));
        assert_eq!(
            bootstrap.mean(column(&[0.1, 0.2, 0.3, 0.4]), 0.95).unwrap(),
            None
        );
        let few = Array2::<f64>::zeros((9, 3));
        assert_eq!(bootstrap.mean(few.view(), 0.95).unwrap(), None);
    }

    #[test]
    fn an_interval_does_not_depend_on_what_was_asked_before() {
        let scores: Vec<f64> = (0..12).map(|k| f64::from(k * k % 7)).collect();
        let alone = Bootstrap::default().mean(column(&scores), 0.95).unwrap();
        let mut bootstrap = Bootstrap::default();
        for n in [12, 5, 11] {
            bootstrap.mean(column(&scores[..n]), 0.9).unwrap();
        }
        assert_eq!(bootstrap.mean(column(&scores), 0.95).unwrap(), alone);
    }

    #[test]
    fn broken_scores_and_confidences_are_refused() {
        let mut bootstrap = Bootstrap::default();
        assert!(
            bootstrap
                .mean(column(&[0.1, f64::NAN, 0.2, 0.1, 0.2]), 0.95)
                .is_err()
        );
        assert!(bootstrap.mean(column(&[0.1; 5]), 95.0).is_err());
        assert!(bootstrap.mean(Array2::zeros((5, 0)).view(), 0.95).is_err());
    }
}
