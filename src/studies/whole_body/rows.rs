//! Rows of the result tables of a whole-body study: one plain struct for each kind of row, with one field per column.

use crate::studies::prelude::*;

/// Group to which a measured case belongs: the scenes, or one of the scaling series.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Series {
    /// Scenes in which an object touches the robot.
    Scene,
    /// Scaling series in which the number of taxels of the skin grows, while the touch stays constant.
    Skin,
    /// Scaling series in which the number of touched taxels grows, while the skin stays constant.
    Touch,
    /// Scaling series in which the object's number of spheres grows, while skin and touch stay constant.
    Spheres,
}

row! {
/// Measured case: a scene, or one size in a scaling series.
pub struct BodyCase {
    /// Group to which the case belongs: the scenes, or one of the scaling series.
    series: Series => Note;
    /// Name of the scene, or of the size in a scaling series.
    name: String => Subject "scene or rung";
    /// Number of taxels of the whole skin.
    n_taxels: usize => Condition "taxels of the body": Log;
    /// Number of patches of the whole skin.
    n_patches: usize => Condition "patches": Log;
    /// Number of spheres of the object.
    n_spheres: usize => Condition "spheres": Log;
} }

row! {
/// Counts of touched taxels, patches and spheres in a simulated case. A row of `whole_body.csv` is a [`BodyCase`] followed by a `BodyCount`.
pub struct BodyCount {
    /// Number of simulated steps of the case.
    n_steps: usize => Note "steps": Linear;
    /// Number of deflected taxels per step, averaged over all steps.
    touched_mean: f64 => Value(Neither) "touched taxels": Log;
    /// Smallest number of deflected taxels in any step.
    touched_min: usize => Note "fewest touched": Linear;
    /// Largest number of deflected taxels in any step.
    touched_max: usize => Note "most touched": Linear;
    /// Number of saturated taxels per step, averaged over all steps. A saturated taxel has reached its stroke, and the object would push it further.
    saturated_mean: f64 => Value(Neither) "saturated taxels": Linear;
    /// Number of patches near the object, for which contact is searched, averaged over steps.
    patches_visited_mean: f64 => Value(Neither) "patches visited": Linear;
    /// Number of patches with a deflected taxel, averaged over steps.
    patches_touched_mean: f64 => Value(Neither) "patches touched": Linear;
    /// Number of pairs of a patch and a sphere for which the deflections of taxels were computed, averaged over steps.
    spheres_evaluated_mean: f64 => Value(Neither) "spheres evaluated": Linear;
    /// Number of pairs of patch and sphere, near the object, that were rejected before deflections were computed, averaged over steps.
    spheres_rejected_mean: f64 => Value(Neither) "spheres rejected": Linear;
    /// Sum of all deflections over taxels and steps, mm.
    deflection_sum_mm: f64 => Note "sum of deflections" in "mm": Linear;
    /// Memory of the skin and of its state at rest, divided by the number of taxels, bytes.
    bytes_per_taxel: f64 => Cost "memory of a taxel" in "bytes": Linear;
} }

row! {
/// Measurements and decisions of a scene with one compression: a row of `sensed.csv`.
pub struct BodySensed {
    /// Name of the scene in which the object is recognised.
    scene: String => Subject;
    /// Name of the compression (measurement matrix).
    compression: String => Choice;
    /// Sum of the absolute values of all measurements over all steps, mm.
    measurement_sum_mm: f64 => Note "sum of measurements" in "mm": Linear;
    /// Most frequent decision of the classifier over all steps: the name of an object. If two are equally frequent, the one that comes first in the study.
    decision: String => Outcome;
    /// Fraction of the steps in which the classifier's decision is the object in `decision`, 0 to 1.
    decision_fraction: f64 => Note "share of the steps": Share;
} }

row! {
/// Recognition accuracy with a compression: a row of `recognition.csv`.
pub struct BodyRecognition {
    /// Name of the compression (measurement matrix), such as `sbhe_32` with Hadamard blocks of 32 taxels.
    compression: String => Choice;
    /// Number m of measurements per step.
    n_measurements: usize => Choice "measurements": Linear;
    /// Number of non-zero entries of the measurement matrix Φ, divided by the number of taxels.
    entries_per_taxel: f64 => Cost "entries of a taxel": Log;
    /// Fraction of the taxels whose readings affect at least one measurement, 0 to 1.
    read_fraction: f64 => Note "share of the taxels read": Share;
    /// Memory of the measurement matrix Φ (stored by columns) divided by the number of taxels, bytes.
    bytes_per_taxel: f64 => Cost "memory of a taxel" in "bytes": Log;
    /// Number of objects that the classifier distinguishes.
    n_objects: usize => Condition "objects": Linear;
    /// Number of training touches, summed over all objects.
    n_training: usize => Note "training touches": Linear;
    /// Number of test touches, summed over all objects.
    n_test: usize => Note "test touches": Linear;
    /// Fraction of correctly recognised test touches, 0 to 1.
    accuracy: f64 => Value(More): Share between [accuracy_low, accuracy_high];
    /// Lower end of the 95 % interval of `accuracy`, 0 to 1.
    accuracy_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end of the 95 % interval of `accuracy`, 0 to 1.
    accuracy_high: f64 => Note "95 % interval, upper end": Share;
    /// Number of binary SVMs whose training stopped at the solver's maximum number of iterations.
    n_capped: usize => Note "capped SVMs": Linear;
} }

/// Part of a step whose computing time is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StepPart {
    /// Simulation of the contact with the skin.
    Press,
    /// Compression of the touched taxels' readings into measurements.
    Compress,
    /// Classification of the measurements by a support vector machine.
    Classify,
    /// All three stages of a step: press, compression and classification.
    Whole,
}

row! {
/// StepPart of a step whose time is measured. A row of `timing.csv` is a [`BodyCase`], a `BodyStage` and a [`StepTime`].
pub struct BodyStage {
    /// Timed stage of a step: press, compress, classify, or all three together.
    stage: StepPart => Note;
    /// Name of the compression; empty for the stage `press`.
    compression: String => Choice;
    /// Number of threads that share the work of a step.
    n_threads: usize => Choice "threads": Linear;
} }

row! {
/// Number of touched taxels in steps that are timed with all threads in use. A row of `steps.csv` is a [`BodyCase`], a `BodyTouch` and a [`StepTime`].
pub struct BodyTouch {
    /// Number of touched taxels of a size of a scaling series as the study asks for it, if `touched_mean` differs from it by at most 5 %. Otherwise, and for
    /// scenes, `touched_mean` rounded to a whole number.
    touched: f64 => Condition "touched taxels, about": Log;
    /// Number of deflected taxels per step, averaged over all steps.
    touched_mean: f64 => Note "touched taxels": Log;
} }

row! {
/// Median and percentiles of the computing time per step.
pub struct StepTime {
    /// Median of the computing time per step, µs.
    us_median: f64 => Cost "time of a step" in "us": Log between [us_p05, us_p95];
    /// 5th percentile of the computing time per step, µs.
    us_p05: f64 => Note "5th to 95th percentile, lower end" in "us": Log;
    /// 95th percentile of the computing time per step, µs.
    us_p95: f64 => Note "5th to 95th percentile, upper end" in "us": Log;
    /// Number of steps per second: the inverse of the median computing time.
    steps_per_s: f64 => Value(More) "steps a second": Log;
} }

/// Results of a scene or of one size of a scaling series.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Driven {
    /// Measured case: a scene, or one size of a scaling series.
    pub case: BodyCase,
    /// Counts of taxels, patches and spheres in the simulated case.
    pub count: BodyCount,
    /// Times of the press, followed by the times of all stages for each compression. If a step uses several threads, the times of the press on one thread are
    /// added at the end.
    pub times: Vec<(BodyStage, StepTime)>,
    /// Recognition results of the case, one for each compression.
    pub sensed: Vec<BodySensed>,
    /// Number of touched taxels that the sizes of a scaling series share; `None` for a scene.
    #[serde(default)]
    pub n_touched: Option<usize>,
}

/// Results of all work items: recognition accuracies of compressions, and results of scenes and scaling series.
pub type WholeBodyRows = (Vec<BodyRecognition>, Vec<Driven>);

pub(super) const CASES: File<(BodyCase, BodyCount)> =
    File::new("whole_body.csv", "Scenes and scaling points", "");
pub(super) const RECOGNITION: File<BodyRecognition> = File::new(
    "recognition.csv",
    "Recognition",
    "A linear SVM, trained and tested on simulated touches.",
);
pub(super) const SENSED: File<BodySensed> =
    File::new("sensed.csv", "Recognised classes of the scenes", "");
pub(super) const TIMING: File<(BodyCase, BodyStage, StepTime)> = File::new(
    "timing.csv",
    "From touch to answer",
    "Medians over steps, on this machine.",
)
.of_times();
pub(super) const STEPS: File<(BodyCase, BodyTouch, StepTime)> = File::new(
    "steps.csv",
    "Steps of the skin",
    "Medians over steps of a moving object; scaling points press a cushion of spheres, half of them on its far side.",
)
.summary()
.of_times();
