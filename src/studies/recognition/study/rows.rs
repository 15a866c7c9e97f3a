//! Results of the work items of a recognition study.

use crate::studies::recognition::training::trial::Evaluation;
use serde::{Deserialize, Serialize};

/// Results of work items: configurations in trials, and sets of touches that were simulated or measured.
pub type RecognitionRows = (Vec<CellRow>, Vec<TouchRow>);

/// Result of a configuration in a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellRow {
    /// Index of its group and its index within the group, in the current study.
    #[serde(skip)]
    pub at: (usize, usize),
    /// Scores and times of the configuration.
    pub evaluation: Evaluation,
}

/// Set of touches of an array, with a number of frames per touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TouchRow {
    /// Index of the set of touches in the current study.
    #[serde(skip)]
    pub on: usize,
    /// Whether the touches were simulated; otherwise they were measured.
    pub is_made: bool,
    /// Number of touches.
    pub n_touches: usize,
    /// Number of simulated touches that touched nothing.
    pub n_missed: usize,
    /// Number of simulated touches with at least one taxel at its stroke.
    pub n_saturated: usize,
    /// Processor time, s.
    pub cpu_s: f64,
}
