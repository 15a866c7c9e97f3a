//! The result tables: one plain struct a row, one field a column.
//!
//! A row of `accuracy.csv` is a [`Cell`] followed by a [`TrialScore`]; the other tables are built the same way.

pub use super::cell::Cell;
#[cfg(test)]
pub(crate) use super::cell::tests;
pub use super::variance_table::{Source, Variance};
use crate::columns;
use serde::{Deserialize, Serialize};

/// How one trial of a cell went (with the [`Cell`] before it: a row of `accuracy.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialScore {
    /// Number of the trial, from 0.
    pub trial: usize,
    /// Number of its split. This column and the next are there only if the study has `projections_per_split`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub split: Option<usize>,
    /// Number of its projection.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub projection: Option<usize>,
    /// Training rows.
    pub n_train: usize,
    /// Test rows: groups of `fused_touches` test touches.
    pub n_test: usize,
    /// Test touches that no whole group was left for, all objects.
    pub n_left_out: usize,
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
    /// The C that was used (given, or chosen by cross-validation within the training rows); empty without one.
    pub c_used: Option<f64>,
    /// The γ of the RBF or polynomial kernel that was used (given, scaled or chosen); empty without one.
    pub gamma_used: Option<f64>,
    /// Binary SVMs that stopped at the iteration cap.
    pub n_capped: usize,
}

/// A cell over its trials (with the [`Cell`] before it: a row of `summary.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellScore {
    /// How many trials.
    pub n_trials: usize,
    /// Test rows of one trial: groups of `fused_touches` test touches.
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
    /// Lower end of the 95 % bootstrap interval of the mean over trials: where it would be with other splits, projections and
    /// noise on the same touches. Empty with fewer than five trials (or splits, or projections).
    #[serde(default)]
    pub bootstrap_low: Option<f64>,
    /// Upper end of the same interval.
    #[serde(default)]
    pub bootstrap_high: Option<f64>,
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

/// A pair of objects that the best cell confuses most often: a row of `confused.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Confused {
    /// Number of the best cell.
    pub cell: usize,
    /// What was touched.
    pub object: String,
    /// What it was taken for.
    pub predicted: String,
    /// How many of the object's test rows, all trials.
    pub count: usize,
    /// The object's test rows, all trials.
    pub n_test: usize,
    /// `count / n_test`.
    pub share: f64,
}

/// A published accuracy beside ours (with the [`Cell`] before it, the most accurate of those it is about in a condition: a row of
/// `published.csv`). A claim has a row for each condition that its cells have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Published {
    /// What was claimed, in words.
    pub claim: String,
    /// Where it was published.
    pub source: String,
    /// The published accuracy.
    pub published_accuracy: f64,
    /// Our mean accuracy over trials.
    pub accuracy: f64,
    /// Lower end of its 95 % Wilson interval at one trial's test rows.
    pub accuracy_low: f64,
    /// Upper end of the same interval.
    pub accuracy_high: f64,
    /// `accuracy − published_accuracy`.
    pub difference: f64,
    /// Cells that the claim is about, in this condition.
    pub n_matching: usize,
}

/// A cell against the best cell of its condition, paired over trials: a row of `comparison.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Number of the cell.
    pub cell: usize,
    /// Number of the cell it is compared with: the one with the highest mean accuracy in the same condition.
    pub best_cell: usize,
    /// Trials both have.
    pub n_trials: usize,
    /// Mean over trials of (accuracy − best cell's accuracy).
    pub difference: f64,
    /// Lower end of the 95 % interval of the difference; empty with one trial.
    pub difference_low: Option<f64>,
    /// Upper end of it; empty with one trial.
    pub difference_high: Option<f64>,
    /// Two-sided p-value of no difference; empty where there are too few trials for one.
    pub p_value: Option<f64>,
    /// The same after Holm's correction for all cells but the best ones; empty for those.
    #[serde(default)]
    pub p_holm: Option<f64>,
    /// Why there is a p-value or none.
    #[serde(default)]
    pub p_status: PStatus,
    /// [Trials from which on](crate::recognition::comparison::trials_needed) there is one (with `projections_per_split`: all of so many splits);
    /// empty where no number of them is enough, because too many rows are tested.
    #[serde(default)]
    pub n_trials_needed: Option<usize>,
}

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

/// What a trial of a cell cost (with the [`Cell`] before it: a row of `timing.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialTime {
    /// Number of the trial, from 0.
    pub trial: usize,
    /// Seconds to fit (scaling and the choice of C and γ included). Cells that differ in `fused_touches` share one fit.
    pub fit_s: f64,
    /// Seconds to score all test touches (shared in the same way) and to decide all test rows.
    pub predict_s: f64,
    /// The same for one test touch, microseconds.
    pub predict_us_per_touch: f64,
}

/// What a cell's accuracy costs (with the [`Cell`] before it: a row of `pareto.csv`).
///
/// A cell is on a front if no cell of the same [condition](crate::study::Role::Condition) is at least as accurate in at most the same
/// time and better in one of the two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pareto {
    /// Mean accuracy over trials.
    pub accuracy: f64,
    /// Mean seconds to fit.
    pub fit_s: f64,
    /// Mean microseconds of fitting for one training touch.
    pub fit_us_per_touch: f64,
    /// Mean microseconds to decide once: to predict `fused_touches` touches.
    pub predict_us_per_decision: f64,
    /// Whether it is on the front of accuracy against `fit_s`.
    pub on_training_front: bool,
    /// Whether it is on the front of accuracy against `predict_us_per_decision`.
    pub on_prediction_front: bool,
}

/// What a stage before recognition cost: a row of `stages.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageTime {
    /// `simulate` or `measure` (signal and projection), with the number of frames a touch if it is not one.
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

columns! { TrialScore {
    trial: Subject: Linear;
    split: Note: Linear, optional;
    projection: Note: Linear, optional;
    n_train: Note "training rows": Linear;
    n_test: Note "test rows": Linear;
    n_left_out: Note "test touches left out": Linear;
    n_correct: Note "test rows recognised": Linear;
    accuracy: Value(More): Share between [accuracy_low, accuracy_high];
    accuracy_low: Note "95 % interval, lower end": Share;
    accuracy_high: Note "95 % interval, upper end": Share;
    macro_f1: Value(More) "macro F1": Share;
    c_used: Note "C used": Log;
    gamma_used: Note "γ used": Log;
    n_capped: Note "solves that stopped at the cap": Linear;
} }

columns! { CellScore {
    n_trials: Note "trials": Linear;
    n_test: Note "test rows": Linear;
    accuracy: Value(More): Share between [accuracy_low, accuracy_high];
    accuracy_std: Note "standard deviation over trials": Share;
    accuracy_low: Note "95 % interval, lower end": Share;
    accuracy_high: Note "95 % interval, upper end": Share;
    bootstrap_low: Note "mean over trials, lower end": Share;
    bootstrap_high: Note "mean over trials, upper end": Share;
    macro_f1: Value(More) "macro F1": Share;
    n_capped: Note "solves that stopped at the cap": Linear;
} }

columns! { Confusion {
    cell: Subject: Linear;
    object: Subject;
    predicted: Subject "taken for";
    // Rare confusions are seen, too.
    count: Value(Neither) "test rows": Log;
} }

columns! { Confused {
    cell: Subject: Linear;
    object: Subject;
    predicted: Subject "taken for";
    count: Note "test rows": Log;
    n_test: Note "test rows of the object": Linear;
    share: Value(Less) "share of the object's test rows": Share;
} }

columns! { Published {
    claim: Subject;
    source: Subject;
    published_accuracy: Value(Neither) "published accuracy": Share;
    accuracy: Value(More): Share between [accuracy_low, accuracy_high];
    accuracy_low: Note "95 % interval, lower end": Share;
    accuracy_high: Note "95 % interval, upper end": Share;
    difference: Value(More) "difference to what was published": Linear;
    n_matching: Note "configurations that it is about": Linear;
} }

columns! { Comparison {
    cell: Subject: Linear;
    best_cell: Note "best cell": Linear;
    n_trials: Note "trials of both": Linear;
    difference: Value(More) "difference to the best": Linear between [difference_low, difference_high];
    difference_low: Note "difference, lower end": Linear;
    difference_high: Note "difference, upper end": Linear;
    p_value: Value(Neither) "p-value": Linear;
    p_holm: Value(Neither) "p-value, Holm": Linear;
    p_status: Outcome "test";
    n_trials_needed: Note "trials needed": Linear;
} }

columns! { TrialTime {
    trial: Subject: Linear;
    fit_s: Cost "time to train" in "s": Log;
    predict_s: Cost "time to predict" in "s": Log;
    predict_us_per_touch: Cost "time to predict a touch" in "µs": Log;
} }

columns! { Pareto {
    accuracy: Value(More): Share;
    fit_s: Cost "time to train" in "s": Log;
    fit_us_per_touch: Cost "time to train, of a training touch" in "µs": Log;
    predict_us_per_decision: Cost "time of a decision" in "µs": Log;
    on_training_front: Note;
    on_prediction_front: Note;
} }

columns! { StageTime {
    stage: Subject;
    pitch_mm: Subject "pitch" in "mm": Linear;
    nx: Subject "taxels along x": Linear;
    ny: Subject "taxels along y": Linear;
    n_touches: Note "touches": Linear;
    cpu_s: Cost "processor time" in "s": Log;
    us_per_touch: Cost "processor time of a touch" in "µs": Log;
} }

/// How often a limit of the model was reached: a row of `limits.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// What happened: `saturated taxels`.
    pub what: String,
    /// How often.
    pub count: u64,
    /// Out of how many.
    pub of: u64,
    /// What it means for the reader.
    pub meaning: String,
}

columns! { Limit {
    what: Subject "limit";
    count: Note: Log;
    of: Note: Linear;
    meaning: Note;
} }

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
    /// One row per cell.
    pub pareto: Vec<(Cell, Pareto)>,
    /// One row per array, number of frames and stage.
    pub stages: Vec<StageTime>,
    /// The pairs of objects that the best cell confuses most often, the worst first.
    pub confused: Vec<Confused>,
    /// One row per published accuracy.
    pub published: Vec<(Cell, Published)>,
    /// Three rows per cell, for studies with `projections_per_split`.
    pub variance: Vec<Variance>,
    /// How often limits of the model were reached.
    pub limits: Vec<Limit>,
}
