//! Estimates of signal parameters with 95 % intervals.

use crate::text::numbers::short_number;

/// Largest half width of a narrow 95 % interval, relative to the estimated value. An estimate with a wider interval is too inaccurate for a setting.
const NARROW: f64 = 0.1;

/// Value below which the lower end of an interval is written as 0.
const LEAST: f64 = 1e-9;

/// Value below which an effect (such as noise or crosstalk) is negligible, relative to the full scale or to one.
pub(super) const NONE: f64 = 0.01;

/// Estimate of one parameter of the signal chain, such as the noise; the error is the reason why the recorded frames do not determine the parameter.
pub type Estimate = Result<Measured, NotIdentifiable>;

/// Estimated value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Estimated value in the unit of the parameter's key.
    pub value: f64,
    /// Lower and upper end of the 95 % confidence interval.
    pub interval: [f64; 2],
}

/// Reason why the recorded frames do not determine a parameter.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("not identifiable: {0}")]
pub struct NotIdentifiable(pub String);

impl From<&str> for NotIdentifiable {
    fn from(why: &str) -> Self {
        Self(why.to_owned())
    }
}

/// Returns the estimated value, or `None` if the parameter is not identifiable.
pub(super) fn value(estimate: &Estimate) -> Option<f64> {
    estimate.as_ref().ok().map(|found| found.value)
}

impl Measured {
    pub(super) fn exactly(value: f64) -> Self {
        Self {
            value,
            interval: [value, value],
        }
    }

    /// Returns 0 if the interval reaches 0 and lies within the negligible value [`NONE`]. Otherwise returns the estimate if its interval is narrow; a
    /// wider or negative estimate becomes not identifiable.
    pub(super) fn resolved(self) -> Estimate {
        let [low, high] = self.interval;
        if low <= 0.0 && high.max(-low) <= NONE {
            return Ok(Self {
                value: 0.0,
                interval: [0.0, high.max(-low)],
            });
        }
        if high < 0.0 {
            return Err("it seems to be negative: the frames have another effect".into());
        }
        if high - low > 2.0 * NARROW * self.value {
            return Err(NotIdentifiable(format!(
                "frames tell only that it is from {} to {}",
                short_number(if low < LEAST { 0.0 } else { low }),
                short_number(high)
            )));
        }
        Ok(self)
    }

    /// Returns the estimate of a quantity whose measured value may be too large by at most `excess`: the interval begins lower, and the value lies in the middle
    /// of the possible ones. An effect that was seen is not absent, so the interval of a positive estimate stays above 0.
    pub(super) fn lowered_by(self, excess: f64) -> Self {
        let [low, high] = self.interval;
        let lowest = if low > 0.0 {
            f64::MIN_POSITIVE
        } else {
            f64::NEG_INFINITY
        };
        Self {
            value: self.value - 0.5 * excess,
            interval: [(low - excess).max(lowest), high],
        }
    }

    /// Applies an increasing function to the estimated value and to the ends of its interval.
    pub(super) fn map(self, of: impl Fn(f64) -> f64) -> Self {
        Self {
            value: of(self.value),
            interval: self.interval.map(of),
        }
    }
}
