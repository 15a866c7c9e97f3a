//! Results of the work items of a recognition study.

use crate::studies::recognition::training::trial::Evaluation;
use serde::{Deserialize, Serialize};

/// Results of all work items: rows of configurations, and rows of touches. Some items evaluate configurations in a trial; the others simulate or measure sets
/// of touches.
pub type RecognitionRows = (Vec<ConfigurationRow>, Vec<TouchRow>);

/// Result of one configuration in one trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConfigurationRow {
    /// Position of the configuration in the current study: index of its group, and index within the group.
    #[serde(skip)]
    pub at: (usize, usize),
    /// Scores and times of the configuration in the trial.
    pub evaluation: Evaluation,
}

/// Result of simulating or measuring a set of touches on an array.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TouchRow {
    /// Index in the list of all sets of touches of the current study.
    #[serde(skip)]
    pub on: usize,
    /// Whether the row describes the simulation of touches; otherwise it describes the computation of measurements.
    pub is_made: bool,
    /// Number of touches that were simulated or measured.
    pub n_touches: usize,
    /// Number of simulated touches that deflected no taxel.
    pub n_missed: usize,
    /// Number of simulated touches with at least one taxel at its stroke.
    pub n_saturated: usize,
    /// Processor time of the simulation or measurement, summed over threads, s.
    pub cpu_s: f64,
}
