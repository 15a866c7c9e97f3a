//! The result tables: one plain struct a row, one field a column.
//!
//! A row of `accuracy.csv` is a [`Cell`] followed by a [`TrialScore`]; the other tables are built the same way.

use crate::recognition::ClassifierKind;
use crate::sensing::Ensemble;
use crate::signal::NoiseUnit;
use serde::{Deserialize, Serialize};

/// The settings of one cell of a sweep: every axis at one value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Number of the cell, from 0, in sweep order.
    pub cell: usize,
    /// Millimetres between taxels.
    pub pitch_mm: f64,
    /// Taxel columns.
    pub nx: usize,
    /// Taxel rows.
    pub ny: usize,
    /// Side length of the array along x: nx × pitch.
    pub size_mm: f64,
    /// Noise standard deviation, in `noise_unit`.
    pub noise_std: f64,
    /// What `noise_std` is measured in.
    pub noise_unit: NoiseUnit,
    /// Standard deviation of the Gaussian smoothing, millimetres; 0 for none.
    pub smoothing_mm: f64,
    /// How measurements are made.
    pub ensemble: Ensemble,
    /// Measurements a touch, m.
    pub measurements: usize,
    /// Compression ratio n / m.
    pub ratio: f64,
    /// Which classifier.
    pub classifier: ClassifierKind,
    /// Soft-margin penalty C; empty when it is chosen on a validation split.
    pub c: Option<f64>,
    /// Training touches an object, at most.
    pub train_touches: usize,
}

/// How one trial of a cell went (with the [`Cell`] before it: a row of `accuracy.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialScore {
    /// Number of the trial, from 0.
    pub trial: usize,
    /// Training rows.
    pub n_train: usize,
    /// Test rows.
    pub n_test: usize,
    /// Test rows recognised.
    pub n_correct: usize,
    /// `n_correct / n_test`.
    pub accuracy: f64,
    /// Lower end of the 95 % Wilson interval.
    pub accuracy_low: f64,
    /// Upper end of the 95 % Wilson interval.
    pub accuracy_high: f64,
    /// Mean over classes of the F1 score.
    pub macro_f1: f64,
    /// The C that was used (given, or chosen on a validation split of the training rows).
    pub c_used: Option<f64>,
    /// Binary SVMs that stopped at the iteration cap.
    pub n_capped: usize,
}

/// A cell over its trials (with the [`Cell`] before it: a row of `summary.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellScore {
    /// How many trials.
    pub n_trials: usize,
    /// Test rows of one trial.
    pub n_test: usize,
    /// Mean accuracy over trials.
    pub accuracy: f64,
    /// Standard deviation of the accuracy over trials (0 for one trial).
    pub accuracy_std: f64,
    /// Lower end of the 95 % Wilson interval at one trial's test rows.
    ///
    /// Trials split the same touches again, so counting all their rows would promise too much.
    pub accuracy_low: f64,
    /// Upper end of the same interval.
    pub accuracy_high: f64,
    /// Mean macro-F1 over trials.
    pub macro_f1: f64,
    /// Binary SVMs that stopped at the iteration cap, all trials.
    pub n_capped: usize,
}

/// How often one object was taken for another, all trials of a cell: a row of `confusion.csv`. Zero counts are left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Confusion {
    /// Number of the cell.
    pub cell: usize,
    /// What was touched.
    pub object: String,
    /// What it was taken for.
    pub predicted: String,
    /// How many test rows.
    pub count: usize,
}

/// A cell against the best cell, paired over trials: a row of `comparison.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Number of the cell.
    pub cell: usize,
    /// Number of the cell it is compared with: the one with the highest mean accuracy.
    pub best_cell: usize,
    /// Trials both have.
    pub n_trials: usize,
    /// Mean over trials of (accuracy − best cell's accuracy).
    pub difference: f64,
    /// Lower end of the 95 % interval of the difference; empty with one trial.
    pub difference_low: Option<f64>,
    /// Upper end of it; empty with one trial.
    pub difference_high: Option<f64>,
    /// Two-sided p-value of no difference; empty with one trial.
    pub p_value: Option<f64>,
}

/// What a trial of a cell cost (with the [`Cell`] before it: a row of `timing.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialTime {
    /// Number of the trial, from 0.
    pub trial: usize,
    /// Seconds to fit (scaling and C's choice included).
    pub fit_s: f64,
    /// Seconds to predict all test rows.
    pub predict_s: f64,
    /// Microseconds to predict one test row.
    pub predict_us_per_touch: f64,
}

/// What a stage before recognition cost: a row of `stages.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageTime {
    /// `simulate` or `measure` (signal and projection).
    pub stage: String,
    /// Millimetres between taxels.
    pub pitch_mm: f64,
    /// Taxel columns.
    pub nx: usize,
    /// Taxel rows.
    pub ny: usize,
    /// Touches that went through.
    pub n_touches: usize,
    /// Processor-seconds, summed over threads.
    pub cpu_s: f64,
    /// Processor-microseconds a touch.
    pub us_per_touch: f64,
}

/// All result tables of a study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tables {
    /// One row per cell and trial, cell by cell.
    pub accuracy: Vec<(Cell, TrialScore)>,
    /// One row per cell.
    pub summary: Vec<(Cell, CellScore)>,
    /// Non-zero confusion counts, cell by cell.
    pub confusion: Vec<Confusion>,
    /// One row per cell.
    pub comparison: Vec<Comparison>,
    /// One row per cell and trial.
    pub timing: Vec<(Cell, TrialTime)>,
    /// One row per array and stage.
    pub stages: Vec<StageTime>,
}
