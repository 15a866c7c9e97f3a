//! Confidence level of the intervals in tables, and the status of p-values.

use serde::{Deserialize, Serialize};

/// Confidence level of every interval in the tables.
pub const CONFIDENCE: f64 = 0.95;

/// Status of the p-value of a comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PStatus {
    /// The comparison has a p-value. Default, because tables of earlier versions contain no status.
    #[default]
    Tested,
    /// Too few trials: hardly any difference could be significant.
    TooFewTrials,
    /// Some of the crossed trials failed.
    TrialsMissing,
}
