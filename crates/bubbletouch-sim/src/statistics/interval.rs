//! Confidence intervals of estimates.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::{Error, Result};
use std::collections::BTreeMap;

/// Closed confidence interval of an estimate, from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// Counts of one accuracy test: the number of test rows, and the number of correctly recognised ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowTest {
    /// Index of the tested part of the rows: the fold, or 0 without folds.
    pub part: usize,
    /// Number of test rows.
    pub n_rows: usize,
    /// Number of correctly recognised test rows.
    pub n_correct: usize,
}

impl RowTest {
    fn is_possible(&self) -> bool {
        self.n_rows > 0 && self.n_correct <= self.n_rows
    }

    fn share(&self) -> f64 {
        self.n_correct as f64 / self.n_rows as f64
    }
}

impl Interval {
    /// Returns the Wilson score interval of a proportion, such as an accuracy. The interval stays within 0..=1 and is valid near these ends, unlike the
    /// normal approximation (Wilson 1927; without continuity correction).
    ///
    /// `confidence` is the coverage, such as 0.95. The rows are assumed to be independent. Touches of one object in neighbouring poses are slightly
    /// dependent, so the interval is slightly too narrow. If the split of the data keeps groups of rows together, use an interval over groups instead.
    ///
    /// # Errors
    /// If there are no rows, if more rows are correct than exist, or if the confidence is outside 0..1.
    pub fn wilson(n_correct: usize, n_rows: usize, confidence: f64) -> Result<Self> {
        if n_rows == 0 || n_correct > n_rows {
            return Err(Error::input(
                "interval",
                format!("{n_correct} right of {n_rows}"),
                "at least one row, and no more right than rows, are allowed",
            ));
        }
        check_confidence(confidence)?;
        let z = Normal::standard().inverse_cdf(0.5 + 0.5 * confidence);
        let n = n_rows as f64;
        Ok(Self::score(n_correct as f64 / n, n, z))
    }

    /// Returns the Wilson score interval of the mean accuracy of several tests, such as the trials of a study.
    ///
    /// The proportion is Σ n_correct / Σ n_rows if all tests have equally many rows, otherwise the mean of the tests' accuracies. Tests of one part (fold)
    /// use identical rows, or other rows of identical touches. The interval therefore counts the rows of one test per part. Repeated trials of one part add
    /// no rows; for k folds, the rows of all k parts are added.
    ///
    /// # Errors
    /// If there are no tests, or if the count of a test is invalid.
    pub fn wilson_of_tests(tests: &[RowTest], confidence: f64) -> Result<Self> {
        check_confidence(confidence)?;
        let (Some(first), true) = (tests.first(), tests.iter().all(RowTest::is_possible)) else {
            let allowed = "at least one test, rows in each, and no more right than rows";
            return Err(Error::input("interval", format!("{tests:?}"), allowed));
        };
        let n_tests = tests.len() as f64;
        let share = match tests.iter().all(|test| test.n_rows == first.n_rows) {
            // This branch gives the same bits as `wilson` for equal proportions.
            true => {
                let n_correct: usize = tests.iter().map(|test| test.n_correct).sum();
                n_correct as f64 / (first.n_rows * tests.len()) as f64
            }
            false => tests.iter().map(RowTest::share).sum::<f64>() / n_tests,
        };
        let mut parts = BTreeMap::new();
        for test in tests {
            let n_rows = parts.entry(test.part).or_insert(test.n_rows);
            *n_rows = test.n_rows.min(*n_rows);
        }
        let n_rows: usize = parts.values().sum();
        let z = Normal::standard().inverse_cdf(0.5 + 0.5 * confidence);
        Ok(Self::score(share, n_rows as f64, z))
    }

    /// Returns the Wilson score interval of the proportion `share` of n independent rows, for z standard errors.
    pub fn score(share: f64, n: f64, z: f64) -> Self {
        let z2 = z * z;
        let centre = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
        let variance = share * (1.0 - share) / n + z2 / (4.0 * n * n);
        let half_width = z * variance.sqrt() / (1.0 + z2 / n);
        // At the ends the two terms are equal; clamping prevents rounding from leaving 0..=1 or excluding the estimate.
        Self {
            low: (centre - half_width).clamp(0.0, share),
            high: (centre + half_width).clamp(share, 1.0),
        }
    }
}

/// Checks that a confidence level (coverage) is between 0 and 1.
///
/// # Errors
/// If the confidence level is outside 0..1.
pub fn check_confidence(confidence: f64) -> Result<()> {
    if confidence > 0.0 && confidence < 1.0 {
        return Ok(());
    }
    Err(Error::input(
        "confidence",
        confidence,
        "a number between 0 and 1, both excluded, is allowed",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_intervals_are_those_of_statsmodels() {
        // Reference values: statsmodels 0.15.0, proportion_confint(k, n, alpha, method="wilson").
        let table = [
            (98, 100, 0.95, 0.929988209271456, 0.9944980324498376),
            (0, 20, 0.95, 0.0, 0.1611251580528194),
            (20, 20, 0.95, 0.8388748419471804, 1.0),
            (7, 29, 0.90, 0.13651169044753939, 0.3903849223887107),
            (27_000, 27_864, 0.99, 0.9662037926742987, 0.9715574064144034),
        ];
        for (n_correct, n_rows, confidence, low, high) in table {
            let interval = Interval::wilson(n_correct, n_rows, confidence).unwrap();
            assert!((interval.low - low).abs() < 1e-9, "{interval:?}");
            assert!((interval.high - high).abs() < 1e-9, "{interval:?}");
        }
    }

    #[test]
    fn an_interval_holds_its_estimate_and_stays_within_zero_and_one() {
        for n_rows in 1..60 {
            for n_correct in 0..=n_rows {
                let interval = Interval::wilson(n_correct, n_rows, 0.95).unwrap();
                let share = n_correct as f64 / n_rows as f64;
                assert!(0.0 <= interval.low && interval.low <= share);
                assert!(share <= interval.high && interval.high <= 1.0);
            }
        }
    }

    fn tests_of(parts: usize, counts: &[(usize, usize)]) -> Vec<RowTest> {
        let counts = counts.iter().enumerate();
        let test = |(trial, &(n_correct, n_rows)): (usize, &(usize, usize))| RowTest {
            part: trial % parts,
            n_rows,
            n_correct,
        };
        counts.map(test).collect()
    }

    #[test]
    fn intervals_of_several_tests_come_from_their_counts() {
        let of = |parts, counts: &[(usize, usize)]| {
            Interval::wilson_of_tests(&tests_of(parts, counts), 0.95).unwrap()
        };
        // 222 and 219 of 225 both round to 44 of 45. Reference values: the formula in NumPy with z = 1.959963984540054.
        let (more, less) = (
            of(1, &[(45, 45), (44, 45), (44, 45), (45, 45), (44, 45)]),
            of(1, &[(44, 45), (44, 45), (44, 45), (43, 45), (44, 45)]),
        );
        for (found, low, high) in [
            (more, 0.898_391_127_983, 0.998_387_982_584),
            (less, 0.877_560_897_009, 0.994_648_922_858),
        ] {
            assert!((found.low - low).abs() < 1e-9, "{found:?}");
            assert!((found.high - high).abs() < 1e-9, "{found:?}");
        }
        // Five folds of 24 rows test 120 rows; a second test of a fold adds no rows.
        let folds = [(20, 24), (22, 24), (18, 24), (24, 24), (21, 24)];
        let all = Interval::wilson(105, 120, 0.95).unwrap();
        assert_eq!(of(5, &folds), all);
        assert_eq!(of(5, &[folds, folds].concat()), all);
        // Trials without folds have the rows of one trial, with equal bits if the proportions are equal.
        assert_eq!(
            of(1, &[(18, 24), (20, 24)]),
            Interval::wilson(19, 24, 0.95).unwrap()
        );
        // Unequal tests: the mean of their accuracies.
        let unequal = of(2, &[(10, 20), (30, 30)]);
        assert!(unequal.low < 0.75 && 0.75 < unequal.high, "{unequal:?}");
        assert!(Interval::wilson_of_tests(&[], 0.95).is_err());
        assert!(Interval::wilson_of_tests(&tests_of(1, &[(1, 0)]), 0.95).is_err());
    }

    #[test]
    fn impossible_counts_and_confidences_are_refused() {
        assert!(Interval::wilson(0, 0, 0.95).is_err());
        assert!(Interval::wilson(3, 2, 0.95).is_err());
        for confidence in [0.0, 1.0, 95.0, f64::NAN] {
            assert!(Interval::wilson(1, 2, confidence).is_err());
        }
    }
}
