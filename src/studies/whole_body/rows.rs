//! The result tables of a study of a whole body: one plain struct a row, one field a column.

use crate::row;
use serde::{Deserialize, Serialize};

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

row! {
/// What was measured: a scene, or a rung of a ladder.
pub struct BodyCase {
    /// What it belongs to.
    series: Series => Note;
    /// The scene, or the rung.
    name: String => Subject "scene or rung";
    /// Taxels of the body.
    n_taxels: usize => Condition "taxels of the body": Log;
    /// Its patches.
    n_patches: usize => Condition "patches": Log;
    /// Spheres of the object.
    n_spheres: usize => Condition "spheres": Log;
} }

row! {
/// What happened on the way (with the [`BodyCase`] before it: a row of `whole_body.csv`).
pub struct BodyCount {
    /// Steps.
    n_steps: usize => Note "steps": Linear;
    /// Taxels with a deflection, mean over steps.
    touched_mean: f64 => Value(Neither) "touched taxels": Log;
    /// The fewest.
    touched_min: usize => Note "fewest touched": Linear;
    /// The most.
    touched_max: usize => Note "most touched": Linear;
    /// Taxels at their stroke that the object would push further, mean over steps.
    saturated_mean: f64 => Value(Neither) "saturated taxels": Linear;
    /// Patches that were looked at, mean over steps.
    patches_visited_mean: f64 => Value(Neither) "patches visited": Linear;
    /// Patches with a touched taxel, mean over steps.
    patches_touched_mean: f64 => Value(Neither) "patches touched": Linear;
    /// Spheres for which rows, rings or tiles of taxels were looked at, counted on each patch where they were, mean over steps.
    spheres_evaluated_mean: f64 => Value(Neither) "spheres evaluated": Linear;
    /// Spheres that were left out before that, counted on each patch near the object, mean over steps.
    spheres_rejected_mean: f64 => Value(Neither) "spheres rejected": Linear;
    /// Sum of all deflections over taxels and steps, mm.
    deflection_sum_mm: f64 => Note "sum of deflections" in "mm": Linear;
    /// Memory of the body and what it remembers at rest, bytes a taxel.
    bytes_per_taxel: f64 => Cost "memory of a taxel" in "bytes": Linear;
} }

row! {
/// What a scene was taken for (a row of `sensed.csv`).
pub struct BodySensed {
    /// The scene.
    scene: String => Subject;
    /// The compression.
    compression: String => Choice;
    /// Sum of all measurements' sizes over steps, mm.
    measurement_sum_mm: f64 => Note "sum of measurements" in "mm": Linear;
    /// What most steps were taken for; of equals the first of the objects.
    decision: String => Outcome;
    /// By how many of the steps.
    decision_share: f64 => Note "share of the steps": Share;
} }

row! {
/// How well objects are told apart from a compression (a row of `recognition.csv`).
pub struct BodyRecognition {
    /// The compression: `sbhe_32` has blocks of 32 taxels.
    compression: String => Choice;
    /// m.
    n_measurements: usize => Choice "measurements": Linear;
    /// Numbers of Φ that are not zero, a taxel.
    entries_per_taxel: f64 => Cost "entries of a taxel": Log;
    /// Share of the taxels that some measurement reads.
    read_share: f64 => Note "share of the taxels read": Share;
    /// Memory of Φ by columns, bytes a taxel.
    bytes_per_taxel: f64 => Cost "memory of a taxel" in "bytes": Log;
    /// Objects that are told apart.
    n_objects: usize => Condition "objects": Linear;
    /// Training touches, all objects.
    n_training: usize => Note "training touches": Linear;
    /// Test touches, all objects.
    n_test: usize => Note "test touches": Linear;
    /// Share of the test touches that were recognised.
    accuracy: f64 => Value(More): Share between [accuracy_low, accuracy_high];
    /// Lower end of its 95 % interval.
    accuracy_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end of it.
    accuracy_high: f64 => Note "95 % interval, upper end": Share;
    /// Binary SVMs that stopped at the solver's iteration cap.
    n_capped: usize => Note "capped SVMs": Linear;
} }

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

row! {
/// What was timed (between [`BodyCase`] and [`StepTime`]: a row of `timing.csv`).
pub struct BodyStage {
    /// What.
    stage: Stage => Note;
    /// The compression; empty for `press`.
    compression: String => Choice;
    /// Threads that a large touch is shared by.
    n_threads: usize => Choice "threads": Linear;
} }

row! {
/// How much was touched while a step of the skin was timed with all threads (between [`BodyCase`] and [`StepTime`]: a row of `steps.csv`).
pub struct BodyTouch {
    /// Taxels with a deflection, to two digits.
    touched: f64 => Condition "touched taxels, about": Log;
    /// The same, mean over steps.
    touched_mean: f64 => Note "touched taxels": Log;
} }

row! {
/// What a step cost.
pub struct StepTime {
    /// Median over steps, µs.
    us_median: f64 => Cost "time of a step" in "us": Log between [us_p05, us_p95];
    /// 5th percentile, µs.
    us_p05: f64 => Note "5th to 95th percentile, lower end" in "us": Log;
    /// 95th percentile, µs.
    us_p95: f64 => Note "5th to 95th percentile, upper end" in "us": Log;
    /// By the median.
    steps_per_s: f64 => Value(More) "steps a second": Log;
} }

/// What came of a scene or a rung.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Driven {
    /// Which.
    pub case: BodyCase,
    /// What happened.
    pub count: BodyCount,
    /// The press, then of each compression all stages; where there are threads, at the end the press with one.
    pub times: Vec<(BodyStage, StepTime)>,
    /// One a compression.
    pub sensed: Vec<BodySensed>,
}

/// Rows of work items: of compressions, and of scenes and rungs.
pub type WholeBodyRows = (Vec<BodyRecognition>, Vec<Driven>);
