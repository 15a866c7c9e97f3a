//! Estimates with 95 % intervals.

use crate::text::numbers::short_number;

/// Half of a 95 % interval, of the number in it: wider ones leave a setting that may be wrong by more.
const NARROW: f64 = 0.1;

/// What is as good as none of something, of the full scale or of one.
pub(super) const NONE: f64 = 0.01;

/// Estimate of a parameter of the signal chain.
#[derive(Clone, Debug, PartialEq)]
pub enum Estimate {
    /// The parameter is identifiable.
    Found {
        /// Value in the unit of the parameter's key.
        value: f64,
        /// Its 95 % interval, lower and upper end.
        interval: [f64; 2],
    },
    /// The parameter is not identifiable, for this reason.
    NotIdentifiable(String),
}

impl Estimate {
    /// Returns the value, or `None` if the parameter is not identifiable.
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

    /// The same where its interval is narrow; 0 where that reaches 0 and has no end above [`NONE`]. What frames tell so loosely is not told.
    pub(super) fn resolved(self) -> Self {
        match self {
            Self::Found {
                interval: [low, high],
                ..
            } if low <= 0.0 && high <= NONE => Self::Found {
                value: 0.0,
                interval: [0.0, high],
            },
            Self::Found {
                value,
                interval: [low, high],
            } if high - low > 2.0 * NARROW * value => Self::unknown(format!(
                "frames tell only that it is from {} to {}",
                short_number(low.max(0.0)),
                short_number(high)
            )),
            other => other,
        }
    }

    /// The same number of something whose value follows from that of this, which must rise with it.
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
