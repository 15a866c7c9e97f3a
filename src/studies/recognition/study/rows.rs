//! What work items of a recognition study find.

use crate::studies::recognition::training::trial::Evaluation;
use serde::{Deserialize, Serialize};

/// What work items found: cells in a trial, and touches that were made or measured.
pub type RecognitionRows = (Vec<CellRow>, Vec<TouchRow>);

/// A cell in a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellRow {
    /// Its group and its place there, in the study as it is today.
    #[serde(skip)]
    pub at: (usize, usize),
    /// What it scored.
    pub evaluation: Evaluation,
}

/// Touches of an array, read in so many frames each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TouchRow {
    /// Which touches, by their place in the study as it is today.
    #[serde(skip)]
    pub on: usize,
    /// Whether they were made; else measured.
    pub is_made: bool,
    /// How many.
    pub n_touches: usize,
    /// Those that met nothing, of those that were made.
    pub n_missed: usize,
    /// Those with at least one taxel at its stroke, of those that were made.
    pub n_saturated: usize,
    /// Processor-seconds.
    pub cpu_s: f64,
}
