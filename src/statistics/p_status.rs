//! Confidence level of the intervals in tables, and the status of p-values.

use serde::{Deserialize, Serialize};

/// Confidence level of every interval in the result tables.
pub const CONFIDENCE: f64 = 0.95;

/// Status of the p-value of a comparison: present, or the reason why it is missing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PStatus {
    /// The comparison has a p-value. Result tables of earlier versions contain no status and are read as this one.
    #[default]
    Tested,
    /// The study has too few trials for significant differences.
    TooFewTrials,
    /// Some trials are missing because they failed, so the trials do not combine every split with every projection.
    TrialsMissing,
}
