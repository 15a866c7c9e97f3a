//! Comparison of two configurations of a study, paired by trial.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::statistics::variance::MeanSquares;
use crate::{Error, Result};
use bubbletouch_sim::statistics::interval::{Interval, check_confidence};
use ndarray::ArrayView2;

/// Comparison of the scores of two configurations in the trials that both have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Mean of the score differences `a − b` over the trials.
    pub mean_difference: f64,
    /// Confidence interval of the mean difference.
    pub interval: Interval,
    /// Two-sided p-value of the null hypothesis that there is no difference.
    pub p_value: f64,
    /// Number of trials that both configurations have.
    pub n_trials: usize,
}

/// Numbers of training rows, test rows and decisions of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrialSize {
    /// Number of training rows of the trial.
    pub n_train: usize,
    /// Number of test rows of the trial.
    pub n_test: usize,
    /// Number of decisions on test rows, each of which is right or wrong; at most `n_test`.
    pub n_decisions: usize,
}

/// Tests whether the scores (accuracy or macro-F1) of two configurations differ, using the trials that both have. Returns `None` for fewer than two trials.
///
/// The method is the corrected resampled t-test (Nadeau & Bengio, *Inference for the generalization error*, Machine Learning 52, 2003). With J trials and
/// differences d_j of sample variance s²,
///
/// `t = mean(d) / sqrt((1/J + n_test/n_train) s²)` with J − 1 degrees of freedom.
///
/// If trials differ in their numbers of rows (splits by unequal groups), n_test/n_train is the mean over trials. `sizes` contains one size per trial, or a
/// single size for all trials.
///
/// All trials split one set of touches, so their scores are not independent. The plain paired t-test (1/J alone) would find differences that do not exist.
/// Scores are multiples of about 1/n_decisions, so s² is at least the variance of such rounding, `1/(12 n_decisions²)`. Equal differences in a few trials are
/// therefore not significant.
///
/// # Errors
/// If `a` and `b` differ in length, or a score is not finite. If a trial has no training or no test rows, or the confidence is outside 0..1.
pub fn compare(
    a: &[f64],
    b: &[f64],
    sizes: &[TrialSize],
    confidence: f64,
) -> Result<Option<Comparison>> {
    check(a, b, sizes)?;
    check_confidence(confidence)?;
    let n_trials = a.len();
    if n_trials < 2 {
        return Ok(None);
    }
    let n = n_trials as f64;
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let mean = differences.iter().sum::<f64>() / n;
    let squares: f64 = differences.iter().map(|d| (d - mean) * (d - mean)).sum();
    let variance = (squares / (n - 1.0)).max(rounding(sizes));
    let estimate = Estimate {
        mean,
        variance: (1.0 / n + overlap(sizes)) * variance,
        freedom: n - 1.0,
    };
    Ok(Some(estimate.test(n_trials, confidence)))
}

/// Tests whether the scores of two configurations differ, if their trials combine every split with every projection. Splits are the rows of `a` and `b`,
/// projections the columns. Returns `None` for fewer than two splits or two projections, or if `a` and `b` differ in shape.
///
/// With S splits, P projections, and the mean squares of the differences by splits, projections and residual, the variance of the mean difference is
///
/// `(1/S + n_test/n_train) MS_splits / P  +  max(0, MS_projections − MS_rest) / (S P)`
///
/// The result therefore generalises to other splits and to other projections. The degrees of freedom are Satterthwaite's.
///
/// # Errors
/// If `a` and `b` differ in length, or a score is not finite. If a trial has no training or no test rows, or the confidence is outside 0..1.
pub fn compare_crossed(
    a: ArrayView2<f64>,
    b: ArrayView2<f64>,
    sizes: &[TrialSize],
    confidence: f64,
) -> Result<Option<Comparison>> {
    let in_a_row = |scores: ArrayView2<f64>| scores.iter().copied().collect::<Vec<_>>();
    check(&in_a_row(a), &in_a_row(b), sizes)?;
    check_confidence(confidence)?;
    if a.dim() != b.dim() || a.nrows() < 2 || a.ncols() < 2 {
        return Ok(None);
    }
    let differences = &a - &b;
    let squares = MeanSquares::new(differences.view())?;
    let (n_splits, n_projections) = (a.nrows() as f64, a.ncols() as f64);
    let n_trials = n_splits * n_projections;
    let of_splits =
        (1.0 / n_splits + overlap(sizes)) * (squares.rows / n_projections).max(rounding(sizes));
    let of_projections = (squares.columns - squares.rest) / n_trials;
    let mut estimate = Estimate {
        mean: squares.mean,
        variance: of_splits,
        freedom: n_splits - 1.0,
    };
    if of_projections > 0.0 {
        let part = |variance: f64, freedom: f64| variance * variance / freedom;
        estimate.variance += of_projections;
        let parts = part(of_splits, n_splits - 1.0)
            + part(squares.columns / n_trials, n_projections - 1.0)
            + part(squares.rest / n_trials, squares.rest_freedom() as f64);
        // Lower bound: the degrees of freedom of the smaller number of draws.
        let fewest = (n_splits - 1.0).min(n_projections - 1.0);
        estimate.freedom = part(estimate.variance, parts).max(fewest);
    }
    Ok(Some(estimate.test(a.len(), confidence)))
}

/// Threshold of a difference between two configurations, in standard deviations over trials; above it, nearly all trials agree on the sign.
const AGREED: f64 = 3.0;
/// Maximum number of trials that [`trials_needed`] considers.
const MAX_TRIALS: usize = 1000;

/// Returns the smallest number of trials that can give a significant result; for crossed trials, the smallest number of splits. With J trials, [`compare`]
/// finds a difference of three standard deviations between trials significant. Practically all trials agree on the sign of such a difference. The condition is
///
/// `t(J − 1) · sqrt(1/J + n_test/n_train) ≤ 3`
///
/// with Student's two-sided quantile t. With three training rows for each test row, J is 4; three trials would need 3.5 standard deviations, two trials 11.6.
/// Returns `None` if 1,000 trials are not enough, because there are more than twice as many test rows as training rows.
///
/// # Errors
/// If a trial has no training or no test rows, or the confidence is outside 0..1.
pub fn trials_needed(sizes: &[TrialSize], confidence: f64) -> Result<Option<usize>> {
    check(&[], &[], sizes)?;
    check_confidence(confidence)?;
    let is_enough = |&n_trials: &usize| {
        let n = n_trials as f64;
        let quantile = student(n - 1.0).inverse_cdf(0.5 + 0.5 * confidence);
        quantile * (1.0 / n + overlap(sizes)).sqrt() <= AGREED
    };
    // If the maximum is too few, every smaller number is too few.
    Ok(match is_enough(&MAX_TRIALS) {
        true => (2..=MAX_TRIALS).find(is_enough),
        false => None,
    })
}

/// Returns the ratio of test rows to training rows, averaged over trials; the ratio corrects the variance for shared touches.
fn overlap(sizes: &[TrialSize]) -> f64 {
    mean_of(sizes, |size| size.n_test as f64 / size.n_train as f64)
}

/// Returns the variance, averaged over trials, that a score gains by rounding to multiples of 1 / (number of decisions).
fn rounding(sizes: &[TrialSize]) -> f64 {
    mean_of(sizes, |size| {
        let n_decisions = size.n_decisions as f64;
        1.0 / (12.0 * n_decisions * n_decisions)
    })
}

/// Returns the mean of a quantity over trials; if all values are equal, the result is exact, without rounding.
fn mean_of(sizes: &[TrialSize], value: impl Fn(&TrialSize) -> f64) -> f64 {
    let first = value(&sizes[0]);
    let above: f64 = sizes.iter().map(|size| value(size) - first).sum();
    first + above / sizes.len() as f64
}

/// Mean difference of two configurations, the variance of this mean, and the degrees of freedom of the variance.
struct Estimate {
    mean: f64,
    variance: f64,
    freedom: f64,
}

impl Estimate {
    fn test(&self, n_trials: usize, confidence: f64) -> Comparison {
        let (mean, error) = (self.mean, self.variance.sqrt());
        let student = student(self.freedom);
        let half_width = student.inverse_cdf(0.5 + 0.5 * confidence) * error;
        Comparison {
            mean_difference: mean,
            interval: Interval {
                low: mean - half_width,
                high: mean + half_width,
            },
            p_value: (2.0 * student.sf((mean / error).abs())).min(1.0),
            n_trials,
        }
    }
}

/// Returns Student's t distribution with the given degrees of freedom.
///
/// # Panics
/// If the degrees of freedom are not positive, as for a single trial.
pub(super) fn student(freedom: f64) -> StudentsT {
    StudentsT::new(0.0, 1.0, freedom).expect("at least two trials")
}

fn check(a: &[f64], b: &[f64], sizes: &[TrialSize]) -> Result<()> {
    if a.len() != b.len() {
        return Err(Error::input(
            "comparison",
            format!("{} and {} trials", a.len(), b.len()),
            "the same trials of both are needed",
        ));
    }
    if let Some(score) = a.iter().chain(b).find(|score| !score.is_finite()) {
        return Err(Error::input(
            "comparison",
            score,
            "finite scores are needed",
        ));
    }
    let is_empty = |size: &&TrialSize| [size.n_train, size.n_test, size.n_decisions].contains(&0);
    let given = match sizes.iter().find(is_empty) {
        Some(size) => format!("{} training and {} test rows", size.n_train, size.n_test),
        None if sizes.is_empty() => "no sizes of trials".to_owned(),
        None => return Ok(()),
    };
    let allowed = "at least one of each is needed";
    Err(Error::input("comparison", given, allowed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard_errors::{assert_at_most, of_share};
    use ndarray::{Array2, array};
    use rand_distr::{Distribution, StandardNormal};

    const SIZE: TrialSize = TrialSize {
        n_train: 300,
        n_test: 100,
        n_decisions: 100,
    };

    #[test]
    fn the_comparison_is_the_formula_evaluated_with_scipy() {
        // Expected values: the formula above with Student's t of SciPy 1.17.1. The plain paired t-test (ttest_rel) gives p = 0.034.
        let a = [0.91, 0.93, 0.90, 0.94, 0.92];
        let b = [0.88, 0.92, 0.89, 0.90, 0.91];
        let comparison = compare(&a, &b, &[SIZE], 0.95).unwrap().unwrap();
        assert!((comparison.mean_difference - 0.02).abs() < 1e-15);
        assert!((comparison.interval.low + 0.008675001744240358).abs() < 1e-9);
        assert!((comparison.interval.high - 0.04867500174424035).abs() < 1e-9);
        assert!((comparison.p_value - 0.12487982574290779).abs() < 1e-9);
        assert_eq!(comparison.n_trials, 5);
    }

    #[test]
    fn too_few_trials_are_those_that_miss_three_standard_deviations() {
        // Differences of mean 0.3 and standard deviation 0.1, far above rounding.
        let of_trials = |n: usize, size| {
            let step = 0.1 * ((n - 1) as f64 / n as f64).sqrt();
            let mut a: Vec<f64> = (0..n)
                .map(|k| 0.3 + if k % 2 == 0 { step } else { -step })
                .collect();
            if n % 2 == 1 {
                // An odd number of trials: the middle value equals the mean, and the others are further apart.
                let wider = 0.1;
                a = (0..n).map(|k| 0.3 + wider * [1.0, -1.0][k % 2]).collect();
                a[n - 1] = 0.3;
            }
            let test = compare(&a, &vec![0.0; n], &[size], 0.95).unwrap().unwrap();
            test.p_value < 0.05
        };
        for (n_train, needed) in [(100, 6), (300, 4), (1000, 3)] {
            let size = TrialSize {
                n_train,
                n_test: 100,
                n_decisions: 100,
            };
            assert_eq!(trials_needed(&[size], 0.95).unwrap(), Some(needed));
            assert!(of_trials(needed, size), "{needed} of {n_train}");
            assert!(!of_trials(needed - 1, size), "one less of {n_train}");
        }
        let size = TrialSize {
            n_train: 100,
            n_test: 300,
            n_decisions: 300,
        };
        assert_eq!(trials_needed(&[size], 0.95).unwrap(), None);
    }

    #[test]
    fn the_rounding_of_a_score_is_that_of_its_decisions() {
        // Equal differences: the variance is that of rounding, 1/(12 · 20²), and the overlap counts touches.
        let size = TrialSize {
            n_decisions: 20,
            ..SIZE
        };
        let test = compare(&[0.6; 4], &[0.55; 4], &[size], 0.95)
            .unwrap()
            .unwrap();
        let error = ((1.0 / 4.0 + 1.0 / 3.0) / (12.0 * 400.0_f64)).sqrt();
        let expected = 2.0 * student(3.0).sf(0.05 / error);
        assert!((test.p_value - expected).abs() < 1e-9, "{}", test.p_value);
    }

    #[test]
    fn swapping_the_cells_swaps_the_sign_alone() {
        let (a, b) = ([0.5, 0.7, 0.6], [0.4, 0.7, 0.3]);
        let forth = compare(&a, &b, &[SIZE], 0.9).unwrap().unwrap();
        let back = compare(&b, &a, &[SIZE], 0.9).unwrap().unwrap();
        assert_eq!(forth.mean_difference, -back.mean_difference);
        assert_eq!(forth.interval.low, -back.interval.high);
        assert_eq!(forth.p_value, back.p_value);
    }

    #[test]
    fn the_crossed_comparison_is_the_formula_evaluated_with_scipy() {
        // Expected values: the formula above with Student's t of SciPy 1.17.1.
        let a = array![
            [0.80, 0.82, 0.78],
            [0.84, 0.88, 0.83],
            [0.75, 0.79, 0.77],
            [0.81, 0.80, 0.79]
        ];
        let b = array![
            [0.78, 0.81, 0.74],
            [0.85, 0.84, 0.80],
            [0.72, 0.77, 0.71],
            [0.80, 0.79, 0.74]
        ];
        let crossed = compare_crossed(a.view(), b.view(), &[SIZE], 0.95)
            .unwrap()
            .unwrap();
        for (found, expected) in [
            (crossed.mean_difference, 0.025833333333333337),
            (crossed.interval.low, -0.013794941044046539),
            (crossed.interval.high, 0.06546160771071322),
            (crossed.p_value, 0.11465901183764156),
        ] {
            assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
        }
        assert_eq!(crossed.n_trials, 12);
    }

    #[test]
    fn crossed_trials_that_differ_by_nothing_are_told_apart_as_seldom_as_it_should() {
        // Few test rows for many training rows, so that the overlap is negligible.
        let size = TrialSize {
            n_train: 1_000_000,
            n_test: 100,
            n_decisions: 100,
        };
        let mut rng = crate::random::Seed::new(6).rng();
        for [split, projection, rest] in [[0.02, 0.02, 0.01], [0.02, 0.0, 0.01], [0.0, 0.02, 0.01]]
        {
            let mut normal = |std: f64| -> f64 {
                let x: f64 = StandardNormal.sample(&mut rng);
                std * x
            };
            let n = 2000;
            let alarms = (0..n).filter(|_| {
                let splits: Vec<f64> = (0..6).map(|_| normal(split)).collect();
                let projections: Vec<f64> = (0..5).map(|_| normal(projection)).collect();
                let differences = Array2::from_shape_fn((6, 5), |(s, p)| {
                    splits[s] + projections[p] + normal(rest)
                });
                let none = Array2::zeros((6, 5));
                let test = compare_crossed(differences.view(), none.view(), &[size], 0.95);
                test.unwrap().unwrap().p_value < 0.05
            });
            let share = alarms.count() as f64 / n as f64;
            let what = format!("{split}, {projection}");
            assert_at_most(&what, share, 0.05, of_share(0.05, n));
            // The lower bound of the degrees of freedom makes the test conservative.
            assert!(share > 0.01, "{what}: {share}");
        }
    }

    #[test]
    fn equal_scores_are_no_difference_and_equal_differences_no_certainty() {
        let same = compare(&[0.9; 3], &[0.9; 3], &[SIZE], 0.95)
            .unwrap()
            .unwrap();
        assert_eq!((same.mean_difference, same.p_value), (0.0, 1.0));
        assert!(same.interval.low < 0.0 && same.interval.high > 0.0);
        let constant = compare(&[0.9; 3], &[0.8; 3], &[SIZE], 0.95)
            .unwrap()
            .unwrap();
        assert!(constant.p_value > 0.0 && constant.p_value < 0.01);
    }

    #[test]
    fn trials_of_unequal_sizes_overlap_by_the_mean_of_their_ratios() {
        let size = |n_train, n_test| TrialSize {
            n_train,
            n_test,
            n_decisions: n_test,
        };
        let (a, b) = ([0.9, 0.8, 0.85, 0.95], [0.8, 0.75, 0.85, 0.85]);
        let test = |sizes: &[TrialSize]| compare(&a, &b, sizes, 0.95).unwrap().unwrap();
        // Ratios of 1/9, 1, 1/4 and 1/4.
        let unequal = [
            size(900, 100),
            size(500, 500),
            size(800, 200),
            size(800, 200),
        ];
        let ratio = (1.0 / 9.0 + 1.0 + 0.25 + 0.25) / 4.0;
        // Student's t of SciPy 1.17.1: t = mean / sqrt((1/4 + ratio) s²), far above rounding.
        let differences = [0.1, 0.05, 0.0, 0.1];
        let mean = differences.iter().sum::<f64>() / 4.0;
        let squares: f64 = differences.iter().map(|d| (d - mean) * (d - mean)).sum();
        let error = ((0.25 + ratio) * squares / 3.0).sqrt();
        let found = test(&unequal);
        let half = 3.182_446_305_284_263 * error; // t.ppf(0.975, 3)
        assert!(
            (found.interval.high - mean - half).abs() < 1e-9,
            "{found:?}"
        );
        // The order of the trials does not matter.
        let mut turned = unequal;
        turned.reverse();
        assert!((test(&turned).p_value - found.p_value).abs() < 1e-12);
        // Equal sizes are equivalent to one common size.
        assert_eq!(test(&[SIZE; 4]), test(&[SIZE]));
        assert!(compare(&a, &b, &[], 0.95).is_err());
    }

    #[test]
    fn one_trial_tells_nothing() {
        assert_eq!(compare(&[0.9], &[0.8], &[SIZE], 0.95).unwrap(), None);
        assert_eq!(compare(&[], &[], &[SIZE], 0.95).unwrap(), None);
    }

    #[test]
    fn unpaired_or_broken_scores_are_refused() {
        assert!(compare(&[0.9, 0.8], &[0.8], &[SIZE], 0.95).is_err());
        assert!(compare(&[0.9, f64::NAN], &[0.8, 0.8], &[SIZE], 0.95).is_err());
        assert!(compare(&[0.9, 0.8], &[0.8, 0.8], &[SIZE], 95.0).is_err());
        let none = TrialSize {
            n_train: 0,
            n_test: 1,
            n_decisions: 1,
        };
        assert!(compare(&[0.9, 0.8], &[0.8, 0.8], &[none], 0.95).is_err());
    }
}
