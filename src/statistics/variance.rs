//! Variance components of crossed trials: the contribution of each random source to the variance of scores.

use crate::{Error, Result};
use bubbletouch_sim::statistics::interval::{Interval, check_confidence};
use ndarray::{ArrayView2, Axis};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// Contribution of one random source, such as the splits, to the variance of a score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// Number of random levels of the source (splits or projections); for the residual, the number of scores.
    pub n_levels: usize,
    /// Degrees of freedom of the mean square of the source.
    pub degrees_of_freedom: usize,
    /// Mean square of the source in the analysis of variance.
    pub mean_square: f64,
    /// Unbiased estimate of the variance that the source contributes; a small variance may give a negative estimate by chance.
    pub estimate: f64,
    /// Confidence interval of the variance that the source contributes, at least 0.
    pub interval: Interval,
    /// p-value of the null hypothesis that the variance is 0; `None` for the residual.
    pub p_value: Option<f64>,
}

impl Component {
    /// Returns the estimated variance that the source contributes; negative estimates are replaced by 0.
    pub fn variance(&self) -> f64 {
        self.estimate.max(0.0)
    }
}

/// Variance components of scores from trials in which every split is combined once with every projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Components {
    /// Variance component of the matrix rows (splits).
    pub rows: Component,
    /// Variance component of the matrix columns (projections).
    pub columns: Component,
    /// Residual component: noise of single scores, and the interaction of splits and projections.
    pub rest: Component,
}

/// Estimates the variance components of `scores` (n_rows × n_columns) in the model y_rc = μ + a_r + b_c + e_rc. All effects are random and independent.
///
/// Method of moments (Searle, Casella, McCulloch, *Variance components*, 1992, chapter 4), with the mean squares of rows, columns and residual. σ²_a = (MS_a −
/// MS_e) / n_columns, σ²_b = (MS_b − MS_e) / n_rows, σ²_e = MS_e.
///
/// The interval of the residual is exact (χ²). The intervals of σ²_a and σ²_b use modified large samples. Source: Ting, Burdick, Graybill, Jeyaratnam, Lu,
/// *Confidence intervals on linear combinations of variance components that are unrestricted in sign*, 1990. The p-values are F tests of MS_a / MS_e and
/// MS_b / MS_e.
///
/// # Errors
/// If there are fewer than two rows or columns, a score is not finite, or the confidence is outside 0..1.
pub fn components(scores: ArrayView2<f64>, confidence: f64) -> Result<Components> {
    check_confidence(confidence)?;
    let squares = MeanSquares::new(scores)?;
    let (n_rows, n_columns) = scores.dim();
    Ok(Components {
        rows: squares.effect(squares.rows, (n_rows, n_columns), confidence),
        columns: squares.effect(squares.columns, (n_columns, n_rows), confidence),
        rest: Component {
            n_levels: scores.len(),
            degrees_of_freedom: squares.rest_freedom(),
            mean_square: squares.rest,
            estimate: squares.rest,
            interval: squares.rest_interval(confidence),
            p_value: None,
        },
    })
}

/// Mean squares of a two-way analysis of variance with one score per entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MeanSquares {
    pub mean: f64,
    pub rows: f64,
    pub columns: f64,
    pub rest: f64,
    n_rows: usize,
    n_columns: usize,
}

impl MeanSquares {
    pub fn new(scores: ArrayView2<f64>) -> Result<Self> {
        let (n_rows, n_columns) = scores.dim();
        if n_rows < 2 || n_columns < 2 {
            let given = format!("{n_rows} × {n_columns} scores");
            return Err(Error::input("variance components", given, "at least 2 × 2"));
        }
        if let Some(score) = scores.iter().find(|score| !score.is_finite()) {
            return Err(Error::input("variance components", score, "finite scores"));
        }
        let mean = scores.sum() / scores.len() as f64;
        let means = |axis: usize| {
            let n = scores.len_of(Axis(axis)) as f64;
            scores.sum_axis(Axis(axis)) / n
        };
        let (of_rows, of_columns) = (means(1), means(0));
        let squares = |means: &ndarray::Array1<f64>| -> f64 {
            means.iter().map(|m| (m - mean).powi(2)).sum()
        };
        let rest: f64 = scores
            .indexed_iter()
            .map(|((r, c), y)| (y - of_rows[r] - of_columns[c] + mean).powi(2))
            .sum();
        let freedom = (n_rows - 1) * (n_columns - 1);
        Ok(Self {
            mean,
            rows: n_columns as f64 * squares(&of_rows) / (n_rows - 1) as f64,
            columns: n_rows as f64 * squares(&of_columns) / (n_columns - 1) as f64,
            rest: rest / freedom as f64,
            n_rows,
            n_columns,
        })
    }

    pub fn rest_freedom(&self) -> usize {
        (self.n_rows - 1) * (self.n_columns - 1)
    }
}

impl MeanSquares {
    /// Returns the variance component of one effect from its mean square, its number of levels, and the number `n_each` of scores per level.
    fn effect(
        &self,
        mean_square: f64,
        (n_levels, n_each): (usize, usize),
        confidence: f64,
    ) -> Component {
        let freedom = (n_levels - 1, self.rest_freedom());
        let n_each = n_each as f64;
        let interval = difference_interval((mean_square, self.rest), freedom, confidence);
        let f = fisher(freedom);
        Component {
            n_levels,
            degrees_of_freedom: freedom.0,
            mean_square,
            estimate: (mean_square - self.rest) / n_each,
            interval: Interval {
                low: (interval.low / n_each).max(0.0),
                high: (interval.high / n_each).max(0.0),
            },
            p_value: Some(match (mean_square > 0.0, self.rest > 0.0) {
                (false, _) => 1.0,
                (true, false) => 0.0,
                (true, true) => f.sf(mean_square / self.rest),
            }),
        }
    }

    fn rest_interval(&self, confidence: f64) -> Interval {
        let freedom = self.rest_freedom();
        let chi = chi_squared(freedom);
        let square = freedom as f64 * self.rest;
        let tail = 0.5 - 0.5 * confidence;
        Interval {
            low: square / chi.inverse_cdf(1.0 - tail),
            high: square / chi.inverse_cdf(tail),
        }
    }
}

/// Returns the confidence interval of the difference of two independent expected mean squares. The method is modified large samples, in the notation of Burdick
/// and Graybill, *Confidence intervals on variance components*, 1992, section 3.3.
fn difference_interval(
    (first, second): (f64, f64),
    freedom: (usize, usize),
    confidence: f64,
) -> Interval {
    let tail = 0.5 - 0.5 * confidence;
    let f = fisher(freedom);
    // χ² divided by its degrees of freedom: the F distribution with infinitely many denominator degrees of freedom.
    let far = |n: usize, share: f64| chi_squared(n).inverse_cdf(share) / n as f64;
    let g1 = 1.0 - 1.0 / far(freedom.0, 1.0 - tail);
    let g2 = 1.0 - 1.0 / far(freedom.1, 1.0 - tail);
    let h1 = 1.0 / far(freedom.0, tail) - 1.0;
    let h2 = 1.0 / far(freedom.1, tail) - 1.0;
    let (upper, lower) = (f.inverse_cdf(1.0 - tail), f.inverse_cdf(tail));
    let g12 = ((upper - 1.0).powi(2) - (g1 * upper).powi(2) - h2 * h2) / upper;
    let h12 = ((1.0 - lower).powi(2) - (h1 * lower).powi(2) - g2 * g2) / lower;
    let below = (g1 * first).powi(2) + (h2 * second).powi(2) + g12 * first * second;
    let above = (h1 * first).powi(2) + (g2 * second).powi(2) + h12 * first * second;
    let difference = first - second;
    Interval {
        low: difference - below.max(0.0).sqrt(),
        high: difference + above.max(0.0).sqrt(),
    }
}

/// Returns the F distribution with the degrees of freedom of two mean squares, which [`MeanSquares::new`] makes positive.
fn fisher((first, second): (usize, usize)) -> FisherSnedecor {
    FisherSnedecor::new(first as f64, second as f64).expect("at least 2 × 2 scores")
}

fn chi_squared(freedom: usize) -> ChiSquared {
    ChiSquared::new(freedom as f64).expect("at least 2 × 2 scores")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use crate::standard_errors::{
        assert_at_least, assert_at_most, assert_expected, of_mean, of_share,
    };
    use ndarray::{Array2, array};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    }

    #[test]
    fn components_are_those_of_scipy() {
        // Expected values: the formulas with f and chi2 of SciPy 1.17.1.
        let scores = array![
            [0.80, 0.82, 0.78],
            [0.84, 0.88, 0.83],
            [0.75, 0.79, 0.77],
            [0.81, 0.80, 0.79]
        ];
        let found = components(scores.view(), 0.95).unwrap();
        let Components {
            rows,
            columns,
            rest,
        } = found;
        close(rows.mean_square, 0.0033);
        close(columns.mean_square, 0.000975);
        close(rest.mean_square, 0.00020833333333333362);
        close(rows.estimate, 0.0010305555555555534);
        close(columns.estimate, 0.00019166666666666675);
        close(rows.p_value.unwrap(), 0.0029495237322850116);
        close(columns.p_value.unwrap(), 0.05960464477539073);
        close(rest.interval.low, 8.650893003889519e-05);
        close(rest.interval.high, 0.001010228159424386);
        close(rows.interval.low, 0.00026350883717337676);
        close(rows.interval.high, 0.01521337325718295);
        // SciPy's formula gives −6.4e-5; a variance is not negative.
        assert_eq!(columns.interval.low, 0.0);
        close(columns.interval.high, 0.009566254812384241);
        let levels = [rows, columns, rest].map(|c| (c.n_levels, c.degrees_of_freedom));
        assert_eq!(levels, [(4, 3), (3, 2), (12, 6)]);
    }

    /// Draws test scores with given standard deviations of rows, columns and residual.
    fn draw(
        rng: &mut ChaCha8Rng,
        (n_rows, n_columns): (usize, usize),
        std: [f64; 3],
    ) -> Array2<f64> {
        let mut normal = |std: f64| -> f64 {
            let x: f64 = StandardNormal.sample(rng);
            std * x
        };
        let rows: Vec<f64> = (0..n_rows).map(|_| normal(std[0])).collect();
        let columns: Vec<f64> = (0..n_columns).map(|_| normal(std[1])).collect();
        Array2::from_shape_fn((n_rows, n_columns), |(r, c)| {
            5.0 + rows[r] + columns[c] + normal(std[2])
        })
    }

    #[test]
    fn known_components_come_back_unbiased_and_their_intervals_cover_them() {
        let mut rng = Seed::new(3).rng();
        let n = 3000;
        for std in [[2.0, 1.0, 0.5], [0.2, 1.0, 1.0], [1.0, 0.0, 1.0]] {
            let (mut sums, mut held) = ([0.0; 3], [0; 3]);
            for _ in 0..n {
                let scores = draw(&mut rng, (8, 5), std);
                let found = components(scores.view(), 0.95).unwrap();
                for (k, c) in [found.rows, found.columns, found.rest].iter().enumerate() {
                    sums[k] += c.estimate;
                    let variance = std[k] * std[k];
                    held[k] +=
                        usize::from(c.interval.low <= variance && variance <= c.interval.high);
                }
            }
            for k in 0..3 {
                let what = format!("{std:?}, {k}");
                let (mean, variance) = (sums[k] / n as f64, std[k] * std[k]);
                // At these sizes, the standard deviation of an estimate is √(2/df) (variance + residual / levels).
                let spread = (variance + std[2] * std[2] / 5.0) * (2.0f64 / 4.0).sqrt();
                assert_expected(&what, mean, variance, of_mean(spread, n));
                let share = held[k] as f64 / n as f64;
                // The interval of the residual is exact; the other intervals cover too often if the component is small.
                assert_at_least(&what, share, 0.95, of_share(0.95, n));
                let most = [0.985, 0.985, 0.95][k];
                assert_at_most(&what, share, most, of_share(most, n));
            }
        }
    }

    #[test]
    fn what_adds_nothing_is_called_significant_as_seldom_as_it_should() {
        let mut rng = Seed::new(4).rng();
        let n = 3000;
        let alarms = (0..n).filter(|_| {
            let scores = draw(&mut rng, (4, 6), [1.0, 0.0, 0.3]);
            let columns = components(scores.view(), 0.95).unwrap().columns;
            columns.p_value.unwrap() < 0.05
        });
        let share = alarms.count() as f64 / n as f64;
        assert_expected("alarms", share, 0.05, of_share(0.05, n));
    }

    #[test]
    fn rows_and_columns_change_places_with_the_table() {
        let mut rng = Seed::new(9).rng();
        let scores = draw(&mut rng, (5, 3), [1.0, 2.0, 0.5]);
        let there = components(scores.view(), 0.9).unwrap();
        let back = components(scores.t(), 0.9).unwrap();
        close(there.rows.estimate, back.columns.estimate);
        close(there.columns.interval.high, back.rows.interval.high);
        close(there.rest.estimate, back.rest.estimate);
    }

    #[test]
    fn an_estimate_below_zero_stands_as_it_is_and_is_a_variance_of_zero() {
        // The rows have equal means, but a residual remains.
        let scores = array![
            [0.0, 1.0, 2.0],
            [2.0, 1.0, 0.0],
            [1.0, 2.0, 0.0],
            [1.0, 0.0, 2.0]
        ];
        let rows = components(scores.view(), 0.95).unwrap().rows;
        assert!(rows.estimate < 0.0);
        assert_eq!((rows.variance(), rows.interval.low), (0.0, 0.0));
        assert!(rows.p_value.unwrap() > 0.99);
    }

    #[test]
    fn equal_scores_spread_by_nothing() {
        let found = components(Array2::from_elem((3, 4), 0.5).view(), 0.95).unwrap();
        for component in [found.rows, found.columns, found.rest] {
            assert_eq!((component.estimate, component.interval.high), (0.0, 0.0));
        }
        assert_eq!(found.rows.p_value, Some(1.0));
        // Only the rows differ: the residual is 0.
        let scores = Array2::from_shape_fn((3, 4), |(row, _)| row as f64);
        let found = components(scores.view(), 0.95).unwrap();
        assert_eq!((found.rows.estimate, found.rows.p_value), (1.0, Some(0.0)));
    }

    #[test]
    fn small_tables_and_broken_scores_are_refused() {
        assert!(components(Array2::zeros((1, 5)).view(), 0.95).is_err());
        assert!(components(Array2::zeros((5, 1)).view(), 0.95).is_err());
        assert!(components(array![[0.0, f64::NAN], [0.0, 0.0]].view(), 0.95).is_err());
        assert!(components(Array2::zeros((2, 2)).view(), 1.5).is_err());
    }
}
