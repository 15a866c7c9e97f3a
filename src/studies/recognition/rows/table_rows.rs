//! Row types of the result tables: one struct for each table, with one field per column.
//!
//! A row of `accuracy.csv` is a [`Configuration`] followed by a [`TrialScore`]; the other tables are built the same way.

use crate::row;
use crate::statistics::comparison::TrialSize;
use crate::statistics::p_status::PStatus;
use crate::statistics::repeats::Repeat;
use crate::studies::recognition::rows::Configuration;
use serde::{Deserialize, Serialize};

row! {
/// Accuracy and counts of one configuration in one trial. A row of `accuracy.csv` is a [`Configuration`] followed by a `TrialScore`.
pub struct TrialScore {
    /// Number of the trial, from 0.
    trial: usize => Subject: Linear;
    /// Number of the split that the trial uses. The column is present only if the study has `projections_per_split`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    split: Option<usize> => Note: Linear, optional;
    /// Number of the projection (measurement matrix) that the trial uses. The column is present only if the study has `projections_per_split`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    projection: Option<usize> => Note: Linear, optional;
    /// Number of the first trial (with `projections_per_split`: of the first split) with the same training and test touches. The column is present only if
    /// trials repeat splits, as splits by pose do if there are more trials than parts. Statistical tests count all trials of a split once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    distinct_split: Option<usize> => Note "same split as": Linear, optional;
    /// Number of training touches of the trial, over all objects. Further readings and tilted copies of a touch are not counted.
    n_train: usize => Note "touches trained on": Linear;
    /// Number of test rows of the trial. A test row is a group of `touches_per_decision` test touches.
    n_test: usize => Note "test rows": Linear;
    /// Number of test touches, over all objects, that do not fill a complete group of `touches_per_decision` touches.
    n_left_out: usize => Note "test touches left out": Linear;
    /// Number of test rows whose object is recognised correctly.
    n_correct: usize => Note "test rows recognised": Linear;
    /// Accuracy of the trial, `n_correct / n_test`, 0 to 1.
    accuracy: f64 => Value(More): Share between [accuracy_low, accuracy_high];
    /// Lower end of the 95 % interval of the accuracy, 0 to 1: Wilson's interval over test rows, or the interval over held-out groups.
    accuracy_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end of the 95 % interval of the accuracy, 0 to 1: Wilson's interval over test rows, or the interval over held-out groups.
    accuracy_high: f64 => Note "95 % interval, upper end": Share;
    /// Number of held-out groups over which the interval of the accuracy is computed; if no groups are held out, the number of test rows. The column is present
    /// only if the study holds out groups.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    n_groups: Option<usize> => Note "groups of the interval": Linear, optional;
    /// F1 score (harmonic mean of precision and recall), averaged over all objects, 0 to 1.
    macro_f1: f64 => Value(More) "macro F1": Share;
    /// Fraction of the object's test rows that are recognised correctly, averaged over all objects, 0 to 1. The column is present only if `report.metrics` has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    balanced_accuracy: Option<f64> => Value(More): Share, optional;
    /// Negative natural logarithm of the probability of the touched object (at least 2.2e-16), averaged over all test rows. Empty for classifiers without
    /// probabilities. Votes are counted with one more vote for each class. The column is present only if `report.metrics` has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    log_loss: Option<Option<f64>> => Value(Less) "log-loss": Linear, optional;
    /// Penalty C that the classifier used: given, or chosen by cross-validation within the training rows. Empty if the classifier has no C.
    c_used: Option<f64> => Note "C used": Log;
    /// Kernel parameter γ that the classifier used: given in the study, scaled or selected by cross-validation. Empty if the classifier has no γ.
    gamma_used: Option<f64> => Note "γ used": Log;
    /// Number of the classifier's optimisation problems that stopped at the maximum number of iterations.
    n_capped: usize => Note "solves that stopped at the cap": Linear;
} }

impl TrialScore {
    /// Returns the accuracy of this trial as input of the statistics over trials; each decision uses `n_fused` touches.
    pub fn repeat(&self, n_fused: usize) -> Repeat {
        let split = self.distinct_split.or(self.split);
        Repeat {
            trial: self.trial,
            split: split.unwrap_or(self.trial),
            projection: self.projection,
            score: self.accuracy,
            // The overlap of trials depends on touches, not on decisions.
            size: Some(TrialSize {
                n_train: self.n_train,
                n_test: self.n_test * n_fused,
                n_decisions: self.n_test,
            }),
        }
    }
}

row! {
/// Score of one configuration over all its trials. A row of `summary.csv` is a [`Configuration`] followed by a `ConfigurationScore`.
pub struct ConfigurationScore {
    /// Number of trials of the configuration.
    n_trials: usize => Note "trials": Linear;
    /// Number of test rows of one trial. A test row is a group of `touches_per_decision` test touches.
    n_test: usize => Note "test rows": Linear;
    /// Mean accuracy over trials, 0 to 1.
    accuracy: f64 => Value(More): Share between [accuracy_low, accuracy_high];
    /// Standard deviation of the accuracy over trials, 0 to 1; 0 if there is only one trial.
    accuracy_std: f64 => Note "standard deviation over trials": Share;
    /// Lower end of the 95 % interval of the mean accuracy, 0 to 1.
    ///
    /// The interval is Wilson's for the counts of all trials, at the number of test rows of one trial, or of all folds. If groups are held out, it is the
    /// interval over all groups that the trials hold out. Trials split the same touches again, so counting the test rows of all trials would make the
    /// interval too narrow. Each fold and each group counts once.
    accuracy_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end of the 95 % interval of the mean accuracy, computed as `accuracy_low`.
    accuracy_high: f64 => Note "95 % interval, upper end": Share;
    /// Number of held-out groups from which the interval is computed, over all trials; without groups, the number of test rows of a trial. The column is
    /// present only if the study holds out groups.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    n_groups: Option<usize> => Note "groups of the interval": Linear, optional;
    /// Lower end of the 95 % bootstrap interval of the mean accuracy over trials, 0 to 1; describes variation by split, projection and noise. Empty with fewer
    /// than five trials, splits or projections.
    #[serde(default)]
    bootstrap_low: Option<f64> => Note "mean over trials, lower end": Share;
    /// Upper end of the 95 % bootstrap interval of the mean accuracy over trials. Empty under the conditions under which `bootstrap_low` is empty.
    #[serde(default)]
    bootstrap_high: Option<f64> => Note "mean over trials, upper end": Share;
    /// F1 score (harmonic mean of precision and recall), averaged over all objects and trials, 0 to 1.
    macro_f1: f64 => Value(More) "macro F1": Share;
    /// Fraction of the object's test rows that are recognised correctly, averaged over all objects and trials, 0 to 1. The column is present only if
    /// `report.metrics` has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    balanced_accuracy: Option<f64> => Value(More): Share, optional;
    /// Log-loss of a trial, averaged over trials; see `accuracy.csv`. The column is present only if `report.metrics` has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    log_loss: Option<Option<f64>> => Value(Less) "log-loss": Linear, optional;
    /// Number of optimisation problems, over all trials, that stopped at the solver's maximum number of iterations.
    n_capped: usize => Note "solves that stopped at the cap": Linear;
} }

row! {
/// Number of test rows of one object that were recognised as a particular object, over all trials of a configuration: a row of `confusion.csv`. Zero counts are
/// omitted.
pub struct Confusion {
    /// Number of the configuration, as in `summary.csv`.
    configuration: usize => Subject: Linear;
    /// Name of the object that is touched.
    object: String => Subject;
    /// Name of the recognised object.
    predicted: String => Subject "recognised as";
    /// Number of test rows of `object` that were recognised as `predicted`, summed over all trials.
    // A logarithmic scale makes rare confusions visible.
    count: usize => Value(Neither) "test rows": Log;
} }

row! {
/// Pair of objects that the best configuration confuses most often: a row of `confused.csv`.
///
/// If the study varies `touches_per_decision`, the best configuration with the fewest touches per decision is listed. The confusion of the same pair with the
/// most touches per decision is given beside it.
pub struct Confused {
    /// Number of the best configuration, as in `summary.csv`.
    configuration: usize => Subject: Linear;
    /// Name of the object that is touched.
    object: String => Subject;
    /// Name of the recognised object.
    predicted: String => Subject "recognised as";
    /// Number of test rows of `object` that were recognised as `predicted`, summed over all trials.
    count: usize => Note "test rows": Log;
    /// Number of test rows of `object`, summed over all trials.
    n_test: usize => Note "test rows of the object": Linear;
    /// Fraction of the object's test rows that were recognised as `predicted`, `count / n_test`, 0 to 1.
    fraction: f64 => Value(Less) "fraction of the object's test rows": Share between [fraction_low, fraction_high];
    /// Lower end of the 95 % Wilson interval of `fraction`, 0 to 1.
    fraction_low: f64 => Note "95 % interval, lower end": Share, optional;
    /// Upper end of the 95 % Wilson interval of `fraction`, 0 to 1.
    fraction_high: f64 => Note "95 % interval, upper end": Share, optional;
    /// Largest number of touches per decision in the study. The column is present only if the study combines several touches.
    #[serde(skip_serializing_if = "Option::is_none")]
    max_touches_per_decision: Option<usize> => Note "most touches per decision": Linear, optional;
    /// Fraction of the object's test rows that were recognised as `predicted`, 0 to 1, if each decision uses `max_touches_per_decision` touches. The column is
    /// present only if the study combines several touches.
    #[serde(skip_serializing_if = "Option::is_none")]
    fraction_at_max_touches: Option<f64> => Value(Less) "fraction with most touches": Share, optional;
} }

row! {
/// Comparison of a published accuracy with the accuracy of this study. A row of `published.csv` is a [`Configuration`] followed by a `Published`.
///
/// The [`Configuration`] is the most accurate one to which the claim applies. For each condition of the matching configurations, a claim has one row.
pub struct Published {
    /// Published claim as text, such as `98 % at 64:1`.
    claim: String => Subject;
    /// Publication that contains the claim.
    source: String => Subject;
    /// Published accuracy, 0 to 1.
    published_accuracy: f64 => Value(Neither) "published accuracy": Share;
    /// Mean accuracy of this study's configuration over trials, 0 to 1.
    accuracy: f64 => Value(More): Share between [accuracy_low, accuracy_high];
    /// Lower end of the 95 % interval of `accuracy`, as in `summary.csv`.
    accuracy_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end of the 95 % interval of `accuracy`, as in `summary.csv`.
    accuracy_high: f64 => Note "95 % interval, upper end": Share;
    /// Accuracy of this study minus the published accuracy, `accuracy − published_accuracy`.
    difference: f64 => Value(More) "difference to what was published": Linear;
    /// Number of configurations in this condition to which the claim applies.
    n_matching: usize => Note "configurations that it is about": Linear;
} }

row! {
/// Comparison of a configuration with the best configuration under the same condition, paired by trial: a row of `comparison.csv`.
pub struct Comparison {
    /// Number of the configuration, as in `summary.csv`.
    configuration: usize => Subject: Linear;
    /// Number of the configuration with the highest mean accuracy under the same condition.
    best_configuration: usize => Note "best configuration": Linear;
    /// Number of trials that both configurations have; all trials with the same split count as one.
    n_trials: usize => Note "trials of both": Linear;
    /// Accuracy of the configuration minus accuracy of the best configuration, averaged over trials.
    difference: f64 => Value(More) "difference to the best": Linear between [difference_low, difference_high];
    /// Lower end of the 95 % interval of `difference`; empty if there is only one trial.
    difference_low: Option<f64> => Note "difference, lower end": Linear;
    /// Upper end of the 95 % interval of `difference`; empty if there is only one trial.
    difference_high: Option<f64> => Note "difference, upper end": Linear;
    /// Two-sided p-value of the null hypothesis that the mean difference is zero; empty if there are too few trials.
    p_value: Option<f64> => Value(Neither) "p-value": Linear;
    /// `p_value` after Holm's correction for the number of comparisons, which is the number of configurations that are not the best. Empty for the best ones.
    #[serde(default)]
    p_holm: Option<f64> => Value(Neither) "p-value, Holm": Linear;
    /// Reason why the row has a p-value or has none.
    #[serde(default)]
    p_status: PStatus => Outcome "test";
    /// Minimum number of trials for a p-value; with `projections_per_split`, the minimum number of splits. Empty if no number suffices, because too many rows
    /// are tested or further trials repeat the same splits.
    #[serde(default)]
    n_trials_needed: Option<usize> => Note "trials needed": Linear;
} }

row! {
/// Computing times of a configuration in one trial. A row of `timing.csv` is a [`Configuration`] followed by a `TrialTime`.
pub struct TrialTime {
    /// Number of the trial, from 0.
    trial: usize => Subject: Linear;
    /// Time to train the classifier, including scaling and the choice of C and γ, s. Configurations that differ only in `touches_per_decision` share one fit.
    fit_s: f64 => Cost "time to train" in "s": Log;
    /// Time to score all test touches and to decide all test rows, s. Configurations that differ only in `touches_per_decision` share the scores.
    predict_s: f64 => Cost "time to predict" in "s": Log;
    /// Time to predict the object of one test touch, µs.
    predict_us_per_touch: f64 => Cost "time to predict a touch" in "µs": Log;
} }

row! {
/// Mean accuracy and cost of a configuration. A row of `pareto.csv` is a [`Configuration`] followed by a `Pareto`.
///
/// A configuration is on a Pareto front if no other one under the same condition dominates it. A configuration dominates
/// another one if it is at least as accurate in at most the same time, and better in one of the two.
pub struct Pareto {
    /// Mean accuracy over trials, 0 to 1.
    accuracy: f64 => Value(More): Share;
    /// Time to train the classifier, averaged over trials, s.
    fit_s: f64 => Cost "time to train" in "s": Log;
    /// Training time divided by the number of training touches, averaged over trials, µs.
    fit_us_per_touch: f64 => Cost "time to train, of a training touch" in "µs": Log;
    /// Time of one decision on `touches_per_decision` touches, averaged over trials, µs.
    predict_us_per_decision: f64 => Cost "time of a decision" in "µs": Log;
    /// Whether the configuration is on the Pareto front of accuracy against `fit_s`.
    on_training_front: bool => Note;
    /// Whether the configuration is on the Pareto front of accuracy against `predict_us_per_decision`.
    on_prediction_front: bool => Note;
} }

row! {
/// Processor time of one stage before recognition, for one array: a row of `stages.csv`.
pub struct StageTime {
    /// Name of the stage: `simulate`, or `measure` (signal chain and compression). If touches have several frames, their number is added.
    stage: String => Subject;
    /// Pitch of the array's taxels, mm: side of the square area per taxel.
    pitch_mm: f64 => Subject "pitch" in "mm": Linear;
    /// Number of columns of taxels in the array (along x).
    nx: usize => Subject "taxels along x": Linear;
    /// Number of rows of taxels in the array (along y).
    ny: usize => Subject "taxels along y": Linear;
    /// Number of touches that the stage processed.
    n_touches: usize => Note "touches": Linear;
    /// Processor time of the stage, summed over threads, s.
    cpu_s: f64 => Cost "processor time" in "s": Log;
    /// Processor time of the stage per touch, µs.
    us_per_touch: f64 => Cost "processor time of a touch" in "µs": Log;
} }

row! {
/// Limit of the simulation or of the solver, with the number of times that it was reached: a row of `limits.csv`.
pub struct Limit {
    /// Name of the limit, such as `saturated taxels`.
    limit: String => Subject;
    /// Number of touches or trained classifiers that reached the limit.
    count: u64 => Note: Log;
    /// Total number of touches or trained classifiers that could reach the limit.
    total: u64 => Note: Linear;
    /// Sentence that explains what the limit means for the results.
    meaning: String => Note;
} }

row! {
/// Taxel that the ensemble `selected` reads: a row of `selected.csv`, after the [`Configuration`]. Configurations with equal measurements have equal taxels, and only
/// the first of them has rows.
pub struct SelectedTaxel {
    /// Order in which the taxel was selected, from 1.
    rank: usize => Note "order of selection": Linear;
    /// Index of the taxel in a frame, from 0; frames are stored row by row.
    taxel: usize => Subject: Linear;
    /// Position of the taxel along x of the array, mm; on a curved array, of its projection along the axis of the middle. Several sensors
    /// are side by side. Empty for taxels without a layout.
    x_mm: Option<f64> => Note "x" in "mm": Linear;
    /// Position of the taxel along y of the array, mm; see `x_mm`.
    y_mm: Option<f64> => Value(Neither) "y" in "mm": Linear;
} }

row! {
/// Decision of a configuration on test touches: a row of `predictions.csv`. One column `score_<class>` for each class follows.
pub struct Prediction {
    /// Number of the configuration, as in `summary.csv`.
    configuration: usize => Subject: Linear;
    /// Number of the trial, from 0.
    trial: usize => Subject: Linear;
    /// Test touches of the decision, separated by spaces: the position of each touch in its recording from 0 (touches of a separate test set follow), or its
    /// number in drawing order.
    touch: String => Subject;
    /// Held-out groups of the touches, as their file names them, separated by spaces; empty if no groups are held out.
    group: String => Note;
    /// Name of the object that is touched.
    truth: String => Subject "touched object";
    /// Name of the recognised object.
    answer: String => Subject "recognised as";
} }

row! {
/// Fraction of the decisions on one object that are correct, over all trials of a configuration: a row of `recall.csv`.
pub struct Recall {
    /// Number of the configuration, as in `summary.csv`.
    configuration: usize => Subject: Linear;
    /// Name of the object that is touched.
    object: String => Subject;
    /// Number of test rows of the object, summed over all trials.
    n_test: usize => Note "test rows": Linear;
    /// Number of test rows of the object that are recognised correctly, summed over all trials.
    n_correct: usize => Note "correct test rows": Linear;
    /// `n_correct / n_test`, 0 to 1.
    recall: f64 => Value(More): Share;
} }

/// Rows of `predictions.csv`, with the scores of their classes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Predictions {
    /// Names of all classes, in the order of their columns.
    pub classes: Vec<String>,
    /// Decisions, ordered by configuration and trial, each with a score for each class. Scores are NaN for classes that the configuration does not have.
    pub rows: Vec<(Prediction, Vec<f64>)>,
}

/// All result tables of a recognition study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tables {
    /// Rows of `accuracy.csv`: one per configuration and trial, ordered by configuration.
    pub accuracy: Vec<(Configuration, TrialScore)>,
    /// Rows of `summary.csv`: one per configuration, over all its trials.
    pub summary: Vec<(Configuration, ConfigurationScore)>,
    /// Rows of `confusion.csv`: non-zero counts, ordered by configuration.
    pub confusion: Vec<Confusion>,
    /// Rows of `comparison.csv`: one per configuration, compared with the best configuration under the same condition.
    pub comparison: Vec<Comparison>,
    /// Rows of `timing.csv`: one per configuration and trial.
    pub timing: Vec<(Configuration, TrialTime)>,
    /// Rows of `pareto.csv`: one per configuration, with its accuracy and costs.
    pub pareto: Vec<(Configuration, Pareto)>,
    /// Rows of `stages.csv`: one per array, number of frames and stage.
    pub stages: Vec<StageTime>,
    /// Rows of `confused.csv`: the pairs of objects that the best configuration confuses most often, in descending order of the count.
    pub confused: Vec<Confused>,
    /// Rows of `published.csv`: comparisons of published accuracies with the accuracies of this study.
    pub published: Vec<(Configuration, Published)>,
    /// Rows of `variance.csv`: three per configuration, one for each source of variance. Empty unless the study has `projections_per_split`.
    pub variance: Vec<Variance>,
    /// Rows of `selected.csv`: the selected taxels of the first trial. Empty unless an ensemble of the study selects taxels.
    pub selected: Vec<(Configuration, SelectedTaxel)>,
    /// Rows of `limits.csv`: number of times that each limit of the simulation and of the solver was reached.
    pub limits: Vec<Limit>,
    /// Rows of `predictions.csv`. Empty unless the study keeps predictions.
    pub predictions: Predictions,
    /// Rows of `recall.csv`: one per configuration and object. Empty unless the study has this metric.
    pub recall: Vec<Recall>,
    /// Whether the trials are the folds of a k-fold split.
    pub has_folds: bool,
}

/// Source from which the variance of a configuration's accuracy over trials comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Split of the touches into training and test touches.
    Split,
    /// Random projection (measurement matrix) of the trial.
    Projection,
    /// All random draws of a trial other than its split and projection, such as noise, and the interaction of split and projection.
    Rest,
}

row! {
/// Variance of a configuration's accuracy that is due to one source: a row of `variance.csv`.
pub struct Variance {
    /// Number of the configuration, as in `summary.csv`.
    configuration: usize => Subject: Linear;
    /// Source from which the variance comes: split, projection or rest.
    source: Source => Subject "source of variance";
    /// Number of levels of a source of variance: number of splits, of projections, or of trials for `rest`.
    n_levels: usize => Note "levels": Linear;
    /// Degrees of freedom of the source's mean square, `mean_square`.
    degrees_of_freedom: usize => Note: Linear;
    /// Mean square of the source in the analysis of variance of the accuracies.
    mean_square: f64 => Note: Linear;
    /// Unbiased estimate of the variance due to the source (method of moments). If the variance is small, the estimate may be negative by chance.
    estimate: f64 => Note "variance": Linear;
    /// Standard deviation of the accuracy due to this source alone: the square root of `estimate`, or 0 if the estimate is negative.
    accuracy_std: f64 => Value(Less) "standard deviation of the accuracy": Linear between [accuracy_std_low, accuracy_std_high];
    /// Lower end of the 95 % interval of `accuracy_std`, computed by modified large samples; for `rest`, from the χ² distribution.
    accuracy_std_low: f64 => Note "standard deviation, lower end": Linear;
    /// Upper end of the 95 % interval of `accuracy_std`, computed by modified large samples; for `rest`, from the χ² distribution.
    accuracy_std_high: f64 => Note "standard deviation, upper end": Linear;
    /// Fraction of the variance of a trial's accuracy that is due to the source, 0 to 1; negative variance estimates count as zero. Empty if nothing varies.
    fraction: Option<f64> => Value(Less) "fraction of the variance": Share;
    /// p-value of an F test of the null hypothesis that the source contributes no variance; empty for `rest`.
    p_value: Option<f64> => Value(Neither) "p-value": Linear;
} }
