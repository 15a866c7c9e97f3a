//! The result tables: one plain struct a row, one field a column.
//!
//! A row of `accuracy.csv` is a [`Cell`] followed by a [`TrialScore`]; the other tables are built the same way.

use crate::row;
use crate::statistics::comparison::TrialSize;
use crate::statistics::p_status::PStatus;
use crate::statistics::repeats::Repeat;
use crate::studies::recognition::rows::cell::Cell;
use serde::{Deserialize, Serialize};

row! {
/// How one trial of a cell went (with the [`Cell`] before it: a row of `accuracy.csv`).
pub struct TrialScore {
    /// Number of the trial, from 0.
    trial: usize => Subject: Linear;
    /// Number of its split. This column and the next are there only if the study has `projections_per_split`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    split: Option<usize> => Note: Linear, optional;
    /// Number of its projection.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    projection: Option<usize> => Note: Linear, optional;
    /// Number of the first trial (with `projections_per_split`: the first split) that has the same training and test touches. Only if trials repeat
    /// splits, as those of splits by pose do when there are more trials than parts: for tests, trials of one split are one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    distinct_split: Option<usize> => Note "same split as": Linear, optional;
    /// Training rows.
    n_train: usize => Note "training rows": Linear;
    /// Test rows: groups of `fused_touches` test touches.
    n_test: usize => Note "test rows": Linear;
    /// Test touches that no whole group was left for, all objects.
    n_left_out: usize => Note "test touches left out": Linear;
    /// Test rows recognised.
    n_correct: usize => Note "test rows recognised": Linear;
    /// `n_correct / n_test`.
    accuracy: f64 => Value(More): Share between [accuracy_low, accuracy_high];
    /// Lower end of the 95 % interval: Wilson's of the test rows, or [of the groups](crate::statistics::grouped) that are held out.
    accuracy_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end of the 95 % interval.
    accuracy_high: f64 => Note "95 % interval, upper end": Share;
    /// Groups that it comes from; test rows where none are held out. Only if the study holds out groups.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    n_groups: Option<usize> => Note "groups of the interval": Linear, optional;
    /// Mean over classes of the F1 score.
    macro_f1: f64 => Value(More) "macro F1": Share;
    /// The C that was used (given, or chosen by cross-validation within the training rows); empty without one.
    c_used: Option<f64> => Note "C used": Log;
    /// The γ of the RBF or polynomial kernel that was used (given, scaled or chosen); empty without one.
    gamma_used: Option<f64> => Note "γ used": Log;
    /// Binary SVMs that stopped at the iteration cap.
    n_capped: usize => Note "solves that stopped at the cap": Linear;
} }

impl TrialScore {
    /// The accuracy of a trial whose decisions are on so many touches each.
    pub fn repeat(&self, n_fused: usize) -> Repeat {
        let split = self.distinct_split.or(self.split);
        Repeat {
            trial: self.trial,
            split: split.unwrap_or(self.trial),
            projection: self.projection,
            score: self.accuracy,
            // How much trials overlap is a matter of touches, however many of them one decision takes.
            size: Some(TrialSize {
                n_train: self.n_train,
                n_test: self.n_test * n_fused,
            }),
        }
    }
}

row! {
/// A cell over its trials (with the [`Cell`] before it: a row of `summary.csv`).
pub struct CellScore {
    /// How many trials.
    n_trials: usize => Note "trials": Linear;
    /// Test rows of one trial: groups of `fused_touches` test touches.
    n_test: usize => Note "test rows": Linear;
    /// Mean accuracy over trials.
    accuracy: f64 => Value(More): Share between [accuracy_low, accuracy_high];
    /// Standard deviation of the accuracy over trials (0 for one trial).
    accuracy_std: f64 => Note "standard deviation over trials": Share;
    /// Lower end of the 95 % Wilson interval of the counts of all trials, at the test rows of one trial or of all folds; or of the interval of the
    /// groups that all trials hold out.
    ///
    /// Trials split the same touches again, so counting all their rows would promise too much; the row of a fold and a group count once.
    accuracy_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end of the same interval.
    accuracy_high: f64 => Note "95 % interval, upper end": Share;
    /// Groups that it comes from, all trials; test rows of a trial where none are held out. Only if the study holds out groups.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    n_groups: Option<usize> => Note "groups of the interval": Linear, optional;
    /// Lower end of the 95 % bootstrap interval of the mean over trials: where it would be with other splits, projections and
    /// noise on the same touches. Empty with fewer than five trials (or splits, or projections).
    #[serde(default)]
    bootstrap_low: Option<f64> => Note "mean over trials, lower end": Share;
    /// Upper end of the same interval.
    #[serde(default)]
    bootstrap_high: Option<f64> => Note "mean over trials, upper end": Share;
    /// Mean macro-F1 over trials.
    macro_f1: f64 => Value(More) "macro F1": Share;
    /// Binary SVMs that stopped at the iteration cap, all trials.
    n_capped: usize => Note "solves that stopped at the cap": Linear;
} }

row! {
/// How often one object was taken for another, all trials of a cell: a row of `confusion.csv`. Zero counts are left out.
pub struct Confusion {
    /// Number of the cell.
    cell: usize => Subject: Linear;
    /// What was touched.
    object: String => Subject;
    /// What it was taken for.
    predicted: String => Subject "taken for";
    /// How many test rows.
    // Rare confusions are seen, too.
    count: usize => Value(Neither) "test rows": Log;
} }

row! {
/// A pair of objects that the best cell confuses most often: a row of `confused.csv`. Where touches are fused it is the best of the fewest touches, and
/// what is left of it in the same cell of the most touches stands beside it.
pub struct Confused {
    /// Number of the best cell.
    cell: usize => Subject: Linear;
    /// What was touched.
    object: String => Subject;
    /// What it was taken for.
    predicted: String => Subject "taken for";
    /// How many of the object's test rows, all trials.
    count: usize => Note "test rows": Log;
    /// The object's test rows, all trials.
    n_test: usize => Note "test rows of the object": Linear;
    /// `count / n_test`.
    share: f64 => Value(Less) "share of the object's test rows": Share between [share_low, share_high];
    /// Lower end of its 95 % Wilson interval.
    share_low: f64 => Note "95 % interval, lower end": Share, optional;
    /// Upper end of the same interval.
    share_high: f64 => Note "95 % interval, upper end": Share, optional;
    /// The most touches that are fused; only if the study fuses some.
    #[serde(skip_serializing_if = "Option::is_none")]
    most_fused: Option<usize> => Note "most touches fused": Linear, optional;
    /// The same share of decisions on so many; only if the study fuses some.
    #[serde(skip_serializing_if = "Option::is_none")]
    share_fused: Option<f64> => Value(Less) "share with most touches fused": Share, optional;
} }

row! {
/// A published accuracy beside ours (with the [`Cell`] before it, the most accurate of those it is about in a condition: a row of
/// `published.csv`). A claim has a row for each condition that its cells have.
pub struct Published {
    /// What was claimed, in words.
    claim: String => Subject;
    /// Where it was published.
    source: String => Subject;
    /// The published accuracy.
    published_accuracy: f64 => Value(Neither) "published accuracy": Share;
    /// Our mean accuracy over trials.
    accuracy: f64 => Value(More): Share between [accuracy_low, accuracy_high];
    /// Lower end of its 95 % interval, as in `summary.csv`.
    accuracy_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end of the same interval.
    accuracy_high: f64 => Note "95 % interval, upper end": Share;
    /// `accuracy − published_accuracy`.
    difference: f64 => Value(More) "difference to what was published": Linear;
    /// Cells that the claim is about, in this condition.
    n_matching: usize => Note "configurations that it is about": Linear;
} }

row! {
/// A cell against the best cell of its condition, paired over trials: a row of `comparison.csv`.
pub struct Comparison {
    /// Number of the cell.
    cell: usize => Subject: Linear;
    /// Number of the cell it is compared with: the one with the highest mean accuracy in the same condition.
    best_cell: usize => Note "best cell": Linear;
    /// Trials both have; trials of one split count once.
    n_trials: usize => Note "trials of both": Linear;
    /// Mean over trials of (accuracy − best cell's accuracy).
    difference: f64 => Value(More) "difference to the best": Linear between [difference_low, difference_high];
    /// Lower end of the 95 % interval of the difference; empty with one trial.
    difference_low: Option<f64> => Note "difference, lower end": Linear;
    /// Upper end of it; empty with one trial.
    difference_high: Option<f64> => Note "difference, upper end": Linear;
    /// Two-sided p-value of no difference; empty where there are too few trials for one.
    p_value: Option<f64> => Value(Neither) "p-value": Linear;
    /// The same after Holm's correction for all cells but the best ones; empty for those.
    #[serde(default)]
    p_holm: Option<f64> => Value(Neither) "p-value, Holm": Linear;
    /// Why there is a p-value or none.
    #[serde(default)]
    p_status: PStatus => Outcome "test";
    /// [Trials from which on](crate::statistics::comparison::trials_needed) there is one (with `projections_per_split`: all of so many splits);
    /// empty where no number of them is enough, because too many rows are tested, or further trials repeat the same splits.
    #[serde(default)]
    n_trials_needed: Option<usize> => Note "trials needed": Linear;
} }

row! {
/// What a trial of a cell cost (with the [`Cell`] before it: a row of `timing.csv`).
pub struct TrialTime {
    /// Number of the trial, from 0.
    trial: usize => Subject: Linear;
    /// Seconds to fit (scaling and the choice of C and γ included). Cells that differ in `fused_touches` share one fit.
    fit_s: f64 => Cost "time to train" in "s": Log;
    /// Seconds to score all test touches (shared in the same way) and to decide all test rows.
    predict_s: f64 => Cost "time to predict" in "s": Log;
    /// The same for one test touch, microseconds.
    predict_us_per_touch: f64 => Cost "time to predict a touch" in "µs": Log;
} }

row! {
/// What a cell's accuracy costs (with the [`Cell`] before it: a row of `pareto.csv`).
///
/// A cell is on a front if no cell of the same [condition](crate::table::Role::Condition) is at least as accurate in at most the same
/// time and better in one of the two.
pub struct Pareto {
    /// Mean accuracy over trials.
    accuracy: f64 => Value(More): Share;
    /// Mean seconds to fit.
    fit_s: f64 => Cost "time to train" in "s": Log;
    /// Mean microseconds of fitting for one training touch.
    fit_us_per_touch: f64 => Cost "time to train, of a training touch" in "µs": Log;
    /// Mean microseconds to decide once: to predict `fused_touches` touches.
    predict_us_per_decision: f64 => Cost "time of a decision" in "µs": Log;
    /// Whether it is on the front of accuracy against `fit_s`.
    on_training_front: bool => Note;
    /// Whether it is on the front of accuracy against `predict_us_per_decision`.
    on_prediction_front: bool => Note;
} }

row! {
/// What a stage before recognition cost: a row of `stages.csv`.
pub struct StageTime {
    /// `simulate` or `measure` (signal and projection), with the number of frames a touch if it is not one.
    stage: String => Subject;
    /// Millimetres between taxels.
    pitch_mm: f64 => Subject "pitch" in "mm": Linear;
    /// Taxel columns.
    nx: usize => Subject "taxels along x": Linear;
    /// Taxel rows.
    ny: usize => Subject "taxels along y": Linear;
    /// Touches that went through.
    n_touches: usize => Note "touches": Linear;
    /// Processor-seconds, summed over threads.
    cpu_s: f64 => Cost "processor time" in "s": Log;
    /// Processor-microseconds a touch.
    us_per_touch: f64 => Cost "processor time of a touch" in "µs": Log;
} }

row! {
/// How often a limit of the model was reached: a row of `limits.csv`.
pub struct Limit {
    /// What happened: `saturated taxels`.
    what: String => Subject "limit";
    /// How often.
    count: u64 => Note: Log;
    /// Out of how many.
    of: u64 => Note: Linear;
    /// What it means for the reader.
    meaning: String => Note;
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
    /// Whether trials test the folds of the touches in turn.
    pub has_folds: bool,
}

/// What makes the accuracies of a cell's trials differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Which touches train and which test.
    Split,
    /// The random projection.
    Projection,
    /// Noise and what else is drawn in each trial, and what a split and a projection do together.
    Rest,
}

row! {
/// What a source adds to the variance of a cell's accuracy: a row of `variance.csv`, for studies with `projections_per_split`.
pub struct Variance {
    /// Number of the cell.
    cell: usize => Subject: Linear;
    /// The source.
    source: Source => Subject "source of variance";
    /// How many of it were drawn; of the rest: trials.
    n_levels: usize => Note "levels": Linear;
    /// Degrees of freedom of its mean square.
    degrees_of_freedom: usize => Note: Linear;
    /// Its mean square.
    mean_square: f64 => Note: Linear;
    /// Unbiased estimate of its variance (method of moments); below zero by chance if it is small.
    estimate: f64 => Note "variance": Linear;
    /// Standard deviation that it alone gives the accuracy: the root of the estimate, 0 if that is below zero.
    accuracy_std: f64 => Value(Less) "standard deviation of the accuracy": Linear between [accuracy_std_low, accuracy_std_high];
    /// Lower end of the 95 % interval of that standard deviation (modified large samples; of the rest χ²).
    accuracy_std_low: f64 => Note "standard deviation, lower end": Linear;
    /// Upper end of the same interval.
    accuracy_std_high: f64 => Note "standard deviation, upper end": Linear;
    /// Share of the variance of a trial, estimates below zero taken as zero; empty if nothing varies.
    share: Option<f64> => Value(Less) "share of the variance": Share;
    /// p-value of the F test that it adds nothing; empty for the rest.
    p_value: Option<f64> => Value(Neither) "p-value": Linear;
} }
