//! Estimates of signal parameters with 95 % intervals.

use crate::text::numbers::short_number;

/// Largest half width of a narrow 95 % interval, relative to the estimated value. An estimate with a wider interval is too inaccurate for a setting.
const NARROW: f64 = 0.1;

/// Value below which the lower end of an interval is written as 0.
const LEAST: f64 = 1e-9;

/// Value below which an effect (such as noise or crosstalk) is negligible, relative to the full scale or to one.
pub(super) const NONE: f64 = 0.01;

/// Estimate of one parameter of the signal chain, such as the noise.
#[derive(Clone, Debug, PartialEq)]
pub enum Estimate {
    /// Estimate of a parameter that the recorded frames determine.
    Found {
        /// Estimated value in the unit of the parameter's key.
        value: f64,
        /// Lower and upper end of the 95 % confidence interval.
        interval: [f64; 2],
    },
    /// The recorded frames do not determine the parameter; contains the reason.
    NotIdentifiable(String),
}

impl Estimate {
    /// Returns the estimated value, or `None` if the parameter is not identifiable.
    pub fn value(&self) -> Option<f64> {
        match self {
            Self::Found { value, .. } => Some(*value),
            Self::NotIdentifiable(_) => None,
        }
    }

    pub(super) fn exactly(value: f64) -> Self {
        Self::Found {
            value,
            interval: [value, value],
        }
    }

    pub(super) fn unknown(why: impl Into<String>) -> Self {
        Self::NotIdentifiable(why.into())
    }

    /// Returns 0 if the interval reaches 0 and lies within the negligible value [`NONE`]. Otherwise returns the estimate if its interval is narrow; a
    /// wider or negative estimate becomes not identifiable.
    pub(super) fn resolved(self) -> Self {
        match self {
            Self::Found {
                interval: [low, high],
                ..
            } if low <= 0.0 && high.max(-low) <= NONE => Self::Found {
                value: 0.0,
                interval: [0.0, high.max(-low)],
            },
            Self::Found {
                interval: [_, high],
                ..
            } if high < 0.0 => {
                Self::unknown("it seems to be negative: the frames have another effect")
            }
            Self::Found {
                value,
                interval: [low, high],
            } if high - low > 2.0 * NARROW * value => Self::unknown(format!(
                "frames tell only that it is from {} to {}",
                short_number(if low < LEAST { 0.0 } else { low }),
                short_number(high)
            )),
            other => other,
        }
    }

    /// Returns the estimate of a quantity whose measured value may be too large by at most `excess`: the interval begins lower, and the value lies in the middle
    /// of the possible ones. An effect that was seen is not absent, so the interval of a positive estimate stays above 0.
    pub(super) fn lowered_by(self, excess: f64) -> Self {
        match self {
            Self::Found {
                value,
                interval: [low, high],
            } => Self::Found {
                value: value - 0.5 * excess,
                interval: match low > 0.0 {
                    true => [(low - excess).max(f64::MIN_POSITIVE), high],
                    false => [low - excess, high],
                },
            },
            unknown @ Self::NotIdentifiable(_) => unknown,
        }
    }

    /// Applies an increasing function to the estimated value and to the ends of its interval.
    pub(super) fn map(self, of: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Found {
                value,
                interval: [low, high],
            } => Self::Found {
                value: of(value),
                interval: [of(low), of(high)],
            },
            unknown @ Self::NotIdentifiable(_) => unknown,
        }
    }
}
