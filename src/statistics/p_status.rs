//! The confidence of intervals in tables, and whether a comparison has a p-value.

use serde::{Deserialize, Serialize};

/// Confidence of every interval in the tables.
pub const CONFIDENCE: f64 = 0.95;

/// Whether a comparison has a p-value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PStatus {
    /// It has; so have all tables of earlier versions.
    #[default]
    Tested,
    /// Too few trials: the test could call next to no difference significant.
    TooFewTrials,
    /// Crossed trials of which some failed.
    TrialsMissing,
}
