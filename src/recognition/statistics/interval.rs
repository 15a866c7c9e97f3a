//! Intervals around estimates.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::{Error, Result};

/// An interval `low..=high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Interval {
    /// The Wilson score interval of a share, such as an accuracy: stays within 0..=1 and is right near its ends, where
    /// the normal approximation is not (Wilson 1927; without continuity correction).
    ///
    /// `confidence` is the coverage, such as 0.95. The rows are taken as independent: touches of one object in
    /// neighbouring poses are not quite, so the interval is rather too narrow than too wide. Of rows that are held out in
    /// groups it is [of the groups](super::grouped::interval_of_groups).
    ///
    /// # Errors
    /// No rows, more correct than rows, or a confidence outside 0..1.
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

    /// The score interval of a share of n independent rows, z standard errors to either side.
    pub(super) fn score(share: f64, n: f64, z: f64) -> Self {
        let z2 = z * z;
        let centre = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
        let variance = share * (1.0 - share) / n + z2 / (4.0 * n * n);
        let half_width = z * variance.sqrt() / (1.0 + z2 / n);
        // At the ends the two terms are equal; rounding must not leave 0..=1 or exclude the estimate.
        Self {
            low: (centre - half_width).clamp(0.0, share),
            high: (centre + half_width).clamp(share, 1.0),
        }
    }
}

pub(crate) fn check_confidence(confidence: f64) -> Result<()> {
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
        // statsmodels 0.15.0, proportion_confint(k, n, alpha, method="wilson").
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

    #[test]
    fn impossible_counts_and_confidences_are_refused() {
        assert!(Interval::wilson(0, 0, 0.95).is_err());
        assert!(Interval::wilson(3, 2, 0.95).is_err());
        for confidence in [0.0, 1.0, 95.0, f64::NAN] {
            assert!(Interval::wilson(1, 2, confidence).is_err());
        }
    }
}
