//! What a run keeps of its work: the cells of a family in a trial, and what happened while an array's touches were made.

use super::evaluation::Evaluation;
use super::journal::Journal;
use super::table::Cell;
use serde::{Deserialize, Serialize};

/// What came of a [family](super::sweep::Group::families) in a trial.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finished {
    /// One evaluation a cell.
    Scored(Vec<Evaluation>),
    /// What went wrong, for all its cells.
    Failed(String),
}

impl Finished {
    /// What a journal has of a family.
    pub fn in_journal(journal: &Journal, family: &[Cell], trial: usize) -> Option<Self> {
        journal.get(&key(family, trial))
    }

    /// Keeps it.
    pub fn keep(&self, journal: &Journal, family: &[Cell], trial: usize) -> crate::Result<()> {
        journal.keep(&key(family, trial), self)
    }
}

/// A family goes by its first cell.
fn key(family: &[Cell], trial: usize) -> String {
    format!("cell {}, trial {trial}", family[0].cell)
}

/// What happened while the touches of an array were made, read in so many frames each.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Simulated {
    /// Touches that met nothing.
    pub n_missed: usize,
    /// Touches with at least one taxel at its stroke.
    pub n_saturated: usize,
    /// Processor-seconds.
    pub cpu_s: f64,
}

impl Simulated {
    /// What a journal has of an array by its number.
    pub fn in_journal(journal: &Journal, array: usize, n_frames: usize) -> Option<Self> {
        journal.get(&array_key(array, n_frames))
    }

    /// Keeps it.
    pub fn keep(&self, journal: &Journal, array: usize, n_frames: usize) -> crate::Result<()> {
        journal.keep(&array_key(array, n_frames), self)
    }
}

/// What measuring an array's touches cost, in all runs together.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Measuring {
    /// Touches, counted as often as they were measured.
    pub n_measured: usize,
    /// Processor-seconds.
    pub cpu_s: f64,
}

impl Measuring {
    /// Adds what earlier runs have spent, and keeps the sum.
    pub fn kept_with_earlier(
        self,
        journal: &Journal,
        array: usize,
        n_frames: usize,
    ) -> crate::Result<Self> {
        let key = format!("{}, measured", array_key(array, n_frames));
        let before: Self = journal.get(&key).unwrap_or_default();
        let sum = Self {
            n_measured: self.n_measured + before.n_measured,
            cpu_s: self.cpu_s + before.cpu_s,
        };
        if self.n_measured > 0 {
            journal.keep(&key, &sum)?;
        }
        Ok(sum)
    }
}

fn array_key(array: usize, n_frames: usize) -> String {
    format!("array {array}, {n_frames} frames")
}
