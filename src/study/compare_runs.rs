//! Two runs side by side: what moved between cells of the same settings, and whether chance explains it.

use super::evaluation::CONFIDENCE;
use super::repeats::Paired;
use super::table::{Cell, PStatus, TrialScore};
use crate::error::{Error, Result};
use crate::recognition::many_tests::holm_of_some;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// A cell that both runs have (with the [`Cell`] of the second before it: a row of what `bubbletouch compare` writes).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunDifference {
    /// Number of the cell in the first run.
    pub first_cell: usize,
    /// Trials that both have: they are paired, since equal trials of equal seeds split the same touches.
    pub n_trials: usize,
    /// Mean accuracy over these trials in the first run.
    pub first_accuracy: f64,
    /// The same in the second.
    pub second_accuracy: f64,
    /// Second less first.
    pub difference: f64,
    /// Lower end of the 95 % interval of the difference; empty with one trial.
    pub difference_low: Option<f64>,
    /// Upper end of it; empty with one trial.
    pub difference_high: Option<f64>,
    /// Two-sided p-value of no difference; empty where there are too few trials for one.
    pub p_value: Option<f64>,
    /// The same after Holm's correction for all cells that are compared.
    pub p_holm: Option<f64>,
    /// Why there is a p-value or none.
    pub p_status: PStatus,
    /// Trials from which on there is one (with `projections_per_split`: all of so many splits); empty where no number of them is enough.
    pub n_trials_needed: Option<usize>,
}

crate::columns! { RunDifference {
    first_cell: Note "cell of the first run": Linear;
    n_trials: Note "trials of both": Linear;
    first_accuracy: Value(Neither) "accuracy in the first run": Share;
    second_accuracy: Value(Neither) "accuracy in the second run": Share;
    difference: Value(Neither): Linear between [difference_low, difference_high];
    difference_low: Note "95 % interval, lower end": Linear;
    difference_high: Note "95 % interval, upper end": Linear;
    p_value: Note "p-value": Linear;
    p_holm: Value(Neither) "p (Holm)": Linear;
    p_status: Outcome "test";
    n_trials_needed: Note "trials needed": Linear;
} }

impl RunDifference {
    /// Whether chance explains it less than once in twenty such comparisons of runs.
    pub fn is_significant(&self) -> bool {
        self.p_holm.is_some_and(|p| p < 1.0 - CONFIDENCE)
    }
}

/// Two runs.
#[derive(Clone, Debug, PartialEq)]
pub struct RunComparison {
    /// Cells of both, in the order of the second.
    pub both: Vec<(Cell, RunDifference)>,
    /// How many cells only the first has.
    pub n_first_only: usize,
    /// How many cells only the second has.
    pub n_second_only: usize,
}

/// A row of the accuracy table.
type Row = (Cell, TrialScore);

/// Compares the accuracy tables of two runs, cell by cell of equal settings, paired over trials.
///
/// # Errors
/// No cell is in both; trials without training or test rows.
pub fn compare_runs(first: &[Row], second: &[Row]) -> Result<RunComparison> {
    let (first, second) = (by_cell(first), by_cell(second));
    let known: HashMap<String, &[Row]> = first
        .iter()
        .map(|rows| (settings(&rows[0].0), *rows))
        .collect();
    let mut both = Vec::new();
    for ours in &second {
        if let Some(theirs) = known.get(&settings(&ours[0].0)) {
            both.push((ours[0].0.clone(), difference(theirs, ours)?));
        }
    }
    if both.is_empty() {
        return Err(Error::input(
            "two runs",
            "no cell of the one has the settings of a cell of the other",
            "runs that share at least one cell",
        ));
    }
    correct(&mut both);
    Ok(RunComparison {
        n_first_only: first.len() - both.len(),
        n_second_only: second.len() - both.len(),
        both,
    })
}

fn by_cell(rows: &[Row]) -> Vec<&[Row]> {
    rows.chunk_by(|a, b| a.0.cell == b.0.cell).collect()
}

/// All settings in words; the number may be another where other cells came before.
fn settings(cell: &Cell) -> String {
    let unnumbered = Cell {
        cell: 0,
        ..cell.clone()
    };
    format!("{unnumbered:?}")
}

fn difference(first: &[Row], second: &[Row]) -> Result<RunDifference> {
    let paired = Paired::of(second, first);
    if paired.n_trials() == 0 {
        let given = format!("no trial of cell {} is in both", second[0].0.cell);
        return Err(Error::input(
            "two runs",
            given,
            "runs that share their trials",
        ));
    }
    let (ours, theirs) = paired.means();
    let tested = paired.tested()?;
    Ok(RunDifference {
        first_cell: first[0].0.cell,
        n_trials: paired.n_trials(),
        first_accuracy: theirs,
        second_accuracy: ours,
        difference: ours - theirs,
        difference_low: tested.interval.map(|interval| interval.low),
        difference_high: tested.interval.map(|interval| interval.high),
        p_value: tested.p_value,
        p_holm: None,
        p_status: tested.p_status,
        n_trials_needed: tested.n_needed,
    })
}

fn correct(rows: &mut [(Cell, RunDifference)]) {
    let p_values: Vec<Option<f64>> = rows.iter().map(|(_, row)| row.p_value).collect();
    for ((_, row), p_holm) in rows.iter_mut().zip(holm_of_some(&p_values)) {
        row.p_holm = p_holm;
    }
}
