//! The result tables of a study of a whole body: one plain struct a row, one field a column.

use crate::columns;
use serde::{Deserialize, Serialize};

columns! { BodyCase {
    series: Note;
    name: Subject "scene or rung";
    n_taxels: Condition "taxels of the body": Log;
    n_patches: Condition "patches": Log;
    n_spheres: Condition "spheres": Log;
} }
columns! { BodyCount {
    n_steps: Note "steps": Linear;
    touched_mean: Value(Neither) "touched taxels": Log;
    touched_min: Note "fewest touched": Linear;
    touched_max: Note "most touched": Linear;
    saturated_mean: Value(Neither) "saturated taxels": Linear;
    patches_visited_mean: Value(Neither) "patches visited": Linear;
    patches_touched_mean: Value(Neither) "patches touched": Linear;
    spheres_evaluated_mean: Value(Neither) "spheres evaluated": Linear;
    spheres_rejected_mean: Value(Neither) "spheres rejected": Linear;
    deflection_sum_mm: Note "sum of deflections" in "mm": Linear;
    bytes_per_taxel: Cost "memory of a taxel" in "bytes": Linear;
} }
columns! { BodySensed {
    scene: Subject;
    compression: Choice;
    measurement_sum_mm: Note "sum of measurements" in "mm": Linear;
    decision: Outcome;
    decision_share: Note "share of the steps": Share;
} }
columns! { BodyRecognition {
    compression: Choice;
    n_measurements: Choice "measurements": Linear;
    entries_per_taxel: Cost "entries of a taxel": Log;
    read_share: Note "share of the taxels read": Share;
    bytes_per_taxel: Cost "memory of a taxel" in "bytes": Log;
    n_objects: Condition "objects": Linear;
    n_training: Note "training touches": Linear;
    n_test: Note "test touches": Linear;
    accuracy: Value(More): Share between [accuracy_low, accuracy_high];
    accuracy_low: Note "accuracy, lower end": Share;
    accuracy_high: Note "accuracy, upper end": Share;
    n_capped: Note "capped SVMs": Linear;
} }
columns! { BodyTime {
    stage: Note;
    compression: Choice;
    n_threads: Choice "threads": Linear;
    us_median: Cost "time of a step" in "us": Log between [us_p05, us_p95];
    us_p05: Note "5th to 95th percentile, lower end" in "us": Log;
    us_p95: Note "5th to 95th percentile, upper end" in "us": Log;
    steps_per_s: Value(More) "steps a second": Log;
} }
columns! { BodyStep {
    touched: Condition "touched taxels, about": Log;
    touched_mean: Note "touched taxels": Log;
    us_median: Cost "time of a step" in "us": Log between [us_p05, us_p95];
    us_p05: Note "5th to 95th percentile, lower end" in "us": Log;
    us_p95: Note "5th to 95th percentile, upper end" in "us": Log;
    steps_per_s: Value(More) "steps a second": Log;
} }

/// What a row belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Series {
    /// An object on the robot.
    Scene,
    /// The skin grows, the touch does not.
    Skin,
    /// The touch grows, the skin does not.
    Touch,
    /// The object's spheres grow, skin and touch do not.
    Spheres,
}

/// What was measured: a scene, or a rung of a ladder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyCase {
    /// What it belongs to.
    pub series: Series,
    /// The scene, or the rung.
    pub name: String,
    /// Taxels of the body.
    pub n_taxels: usize,
    /// Its patches.
    pub n_patches: usize,
    /// Spheres of the object.
    pub n_spheres: usize,
}

/// What happened on the way (with the [`BodyCase`] before it: a row of `whole_body.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyCount {
    /// Steps.
    pub n_steps: usize,
    /// Taxels with a deflection, mean over steps.
    pub touched_mean: f64,
    /// The fewest.
    pub touched_min: usize,
    /// The most.
    pub touched_max: usize,
    /// Taxels at their stroke that the object would push further, mean over steps.
    pub saturated_mean: f64,
    /// Patches that were looked at, mean over steps.
    pub patches_visited_mean: f64,
    /// Patches with a touched taxel, mean over steps.
    pub patches_touched_mean: f64,
    /// Spheres for which rows, rings or tiles of taxels were looked at, counted on each patch where they were, mean over steps.
    pub spheres_evaluated_mean: f64,
    /// Spheres that were left out before that, counted on each patch near the object, mean over steps.
    pub spheres_rejected_mean: f64,
    /// Sum of all deflections over taxels and steps, mm.
    pub deflection_sum_mm: f64,
    /// Memory of the body and what it remembers at rest, bytes a taxel.
    pub bytes_per_taxel: f64,
}

/// What a scene was taken for (a row of `sensed.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodySensed {
    /// The scene.
    pub scene: String,
    /// The compression.
    pub compression: String,
    /// Sum of all measurements' sizes over steps, mm.
    pub measurement_sum_mm: f64,
    /// What most steps were taken for; of equals the first of the objects.
    pub decision: String,
    /// By how many of the steps.
    pub decision_share: f64,
}

/// How well objects are told apart from a compression (a row of `recognition.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyRecognition {
    /// The compression: `sbhe_32` has blocks of 32 taxels.
    pub compression: String,
    /// m.
    pub n_measurements: usize,
    /// Numbers of Φ that are not zero, a taxel.
    pub entries_per_taxel: f64,
    /// Share of the taxels that some measurement reads.
    pub read_share: f64,
    /// Memory of Φ by columns, bytes a taxel.
    pub bytes_per_taxel: f64,
    /// Objects that are told apart.
    pub n_objects: usize,
    /// Training touches, all objects.
    pub n_training: usize,
    /// Test touches, all objects.
    pub n_test: usize,
    /// Share of the test touches that were recognised.
    pub accuracy: f64,
    /// Lower end of its 95 % interval.
    pub accuracy_low: f64,
    /// Upper end of it.
    pub accuracy_high: f64,
    /// Binary SVMs that stopped at the solver's iteration cap.
    pub n_capped: usize,
}

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// The step of the skin.
    Press,
    /// Measurements of what is touched.
    Compress,
    /// The decision.
    Classify,
    /// All three.
    Whole,
}

/// What a step cost (with the [`BodyCase`] before it: a row of `timing.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyTime {
    /// What was timed.
    pub stage: Stage,
    /// The compression; empty for `press`.
    pub compression: String,
    /// Threads that a large touch is shared by.
    pub n_threads: usize,
    /// Median over steps, µs.
    pub us_median: f64,
    /// 5th percentile, µs.
    pub us_p05: f64,
    /// 95th percentile, µs.
    pub us_p95: f64,
    /// By the median.
    pub steps_per_s: f64,
}

/// What a step of the skin cost with all threads (with the [`BodyCase`] before it: a row of `steps.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyStep {
    /// Taxels with a deflection, to two digits.
    pub touched: f64,
    /// The same, mean over steps.
    pub touched_mean: f64,
    /// Median over steps, µs.
    pub us_median: f64,
    /// 5th percentile, µs.
    pub us_p05: f64,
    /// 95th percentile, µs.
    pub us_p95: f64,
    /// By the median.
    pub steps_per_s: f64,
}

/// Rows of work items.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WholeBodyRows {
    /// One a scene or rung.
    pub cases: Vec<(BodyCase, BodyCount)>,
    /// One a scene and compression.
    pub sensed: Vec<BodySensed>,
    /// One a compression.
    pub recognition: Vec<BodyRecognition>,
    /// One a scene or rung, stage and compression.
    pub timing: Vec<(BodyCase, BodyTime)>,
}
