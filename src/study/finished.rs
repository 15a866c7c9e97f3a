//! What a journal keeps of a recognition study: what came of each cell in a trial, and how an array's touches were made.

use super::cell_content::cell_names;
use super::evaluation::Evaluation;
use super::journal::Journal;
use super::plan::Plan;
use super::table::Cell;
use crate::error::Result;
use crate::world::Patch;
use serde::{Deserialize, Serialize};

/// What came of a cell in a trial.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finished {
    /// Its evaluation.
    Scored(Box<Evaluation>),
    /// What went wrong.
    Failed(String),
}

impl Finished {
    /// What a journal has of the cells of a [family](super::sweep::Group::families), in their order.
    pub fn in_journal(
        journal: &Journal,
        plan: &Plan,
        (family, trial): (&[Cell], usize),
    ) -> Vec<Option<Self>> {
        if journal.n_before() == 0 {
            return vec![None; family.len()];
        }
        let names = cell_names(plan, family).into_iter();
        let found = names.map(|name| journal.get(&key(&name, trial)));
        found
            .map(|found| found.filter(|found| Self::is_of(found, trial)))
            .collect()
    }

    /// Keeps what came of the cells of a family, but for those of which the journal has as much.
    ///
    /// # Errors
    /// The journal cannot be written.
    pub fn keep_all(
        all: &[Self],
        journal: &Journal,
        plan: &Plan,
        (family, trial): (&[Cell], usize),
    ) -> Result<()> {
        let before = Self::in_journal(journal, plan, (family, trial));
        for ((finished, before), name) in all.iter().zip(before).zip(cell_names(plan, family)) {
            if !matches!(before, Some(Self::Scored(_))) {
                journal.keep(&key(&name, trial), finished)?;
            }
        }
        Ok(())
    }

    fn is_of(&self, trial: usize) -> bool {
        match self {
            Self::Scored(evaluation) => evaluation.score.trial == trial,
            Self::Failed(_) => true,
        }
    }
}

fn key(name: &str, trial: usize) -> String {
    format!("cell {name}, trial {trial}")
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
    /// What a journal has of an array.
    pub fn in_journal(journal: &Journal, array: &Patch, n_frames: usize) -> Option<Self> {
        journal.get(&array_key(array, n_frames))
    }

    /// Keeps it.
    pub fn keep(&self, journal: &Journal, array: &Patch, n_frames: usize) -> Result<()> {
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
        array: &Patch,
        n_frames: usize,
    ) -> Result<Self> {
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

fn array_key(array: &Patch, n_frames: usize) -> String {
    let grid = &array.grid;
    let (nx, ny, pitch) = (grid.nx, grid.ny, grid.pitch);
    format!("array {nx}x{ny} at {pitch} m, {n_frames} frames")
}
