//! Results of the work items of a recognition study.

use crate::studies::recognition::training::trial::Evaluation;
use serde::{Deserialize, Serialize};

/// Results of work items: of configurations in trials, and of sets of touches that were simulated or measured.
pub type RecognitionRows = (Vec<ConfigurationRow>, Vec<TouchRow>);

/// Result of one configuration in one trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConfigurationRow {
    /// Index of the configuration's group and its index within the group, in the current study.
    #[serde(skip)]
    pub at: (usize, usize),
    /// Scores and times of the configuration.
    pub evaluation: Evaluation,
}

/// Result of simulating or measuring a set of touches on an array.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TouchRow {
    /// Index of the set of touches in the current study.
    #[serde(skip)]
    pub on: usize,
    /// Whether the row describes simulation; otherwise it describes measurement.
    pub is_made: bool,
    /// Number of touches.
    pub n_touches: usize,
    /// Number of simulated touches that deflected no taxel.
    pub n_missed: usize,
    /// Number of simulated touches with at least one taxel at its stroke.
    pub n_saturated: usize,
    /// Processor time summed over threads, s.
    pub cpu_s: f64,
}
