//! The tables of a study of speed against accuracy: one plain struct a row, one field a column.

use crate::recognition::ClassifierKind;
use crate::row;
use crate::sensing::Ensemble;
use serde::{Deserialize, Serialize};

/// How contact is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactWay {
    /// One evaluation on spheres packed within a tolerance.
    PackedSpheres,
    /// One evaluation on a sphere a vertex.
    VertexSpheres,
    /// One evaluation on the triangles themselves.
    ExactMesh,
    /// One evaluation by marching along each taxel's axis through the distance function of a solid.
    SolidMarching,
    /// The quasi-static model stepped through the whole approach, on packed spheres.
    TimeSteps,
    /// Taxels with mass, semi-implicit Euler with penalty contact.
    SemiImplicit,
    /// Taxels with mass, implicit Euler with exact contact.
    ImplicitEuler,
    /// Taxels as bodies in rapier, tuned for skin.
    Rapier,
    /// [Rows of a flat patch](super::flat_press) in doubles on packed spheres, the pose given.
    RowsInDoubles,
    /// The same in singles.
    RowsInSingles,
}

/// Which set an object is of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Touched {
    /// The study's.
    #[default]
    Object,
    /// One of the meshes that are touched [beside](crate::kinds::speed_accuracy::ScansSpec) them.
    Scan,
}

row! {
/// A way and an object: a row of `contact.csv` begins with it, and one of `contact_timing.csv`.
pub struct ContactCell {
    /// How.
    way: ContactWay => Choice "way to evaluate contact";
    /// Of the spheres, mm.
    tolerance_mm: Option<f64> => Choice "spheres within" in "mm": Log;
    /// Of the time steps, ms.
    dt_ms: Option<f64> => Choice "time step" in "ms": Log;
    /// Which set the object is of.
    touched: Touched => Subject;
    /// What is touched.
    object: String => Subject;
    /// 0 for meshes and solids themselves.
    n_spheres: usize => Cost "spheres": Log;
} }

row! {
/// How near the deflections are to those of exact contact (with the [`ContactCell`] before it: a row of `contact.csv`).
pub struct ContactScore {
    /// Touches.
    n_touches: usize => Note "touches": Linear;
    /// |δ − δ*|, mean over the taxels that either touches, mm; none where a number was not finite.
    error_mm: Option<f64> => Value(Less) "deflection error" in "mm": Log;
    /// 95th percentile of the same, mm.
    error_p95_mm: Option<f64> => Value(Less) "deflection error, 95th percentile" in "mm": Log;
    /// Steps of a touch; none where nothing is stepped.
    n_steps: Option<usize> => Note "steps of a touch": Linear;
} }

row! {
/// What it costs (with the [`ContactCell`] before it: a row of `contact_timing.csv`).
pub struct ContactTime {
    /// Microseconds a touch, one thread, median.
    us_per_touch: f64 => Cost "time of a touch" in "µs": Log;
} }

row! {
/// A chain from touch to answer: a row of `recognition.csv` begins with it, and one of `recognition_timing.csv`.
pub struct ChainCell {
    /// Between taxels, mm.
    pitch_mm: f64 => Choice "pitch" in "mm": Log;
    /// Taxels.
    n_taxels: usize => Cost "taxels": Log;
    /// Detail of the objects that are learned from, mm.
    tolerance_mm: f64 => Choice "spheres within" in "mm": Log;
    /// How frames are compressed.
    ensemble: Ensemble => Choice named Ensemble::NAMES;
    /// Taxels per measurement.
    ratio: f64 => Choice "compression" in ":1": Log;
    /// Measurements.
    measurements: usize => Cost "m": Log;
    /// What answers.
    classifier: ClassifierKind => Choice named ClassifierKind::NAMES;
} }

row! {
/// How often it is right (with the [`ChainCell`] before it: a row of `recognition.csv`).
pub struct ChainScore {
    /// Objects to tell apart.
    n_objects: usize => Note "objects": Linear;
    /// Training touches, all objects.
    n_training: usize => Note "training touches": Linear;
    /// Test touches of the exact objects.
    n_test: usize => Note "test touches": Linear;
    /// Share of right answers, 0 to 1.
    accuracy: f64 => Value(More): Share between [accuracy_low, accuracy_high];
    /// Lower end of its 95 % Wilson interval.
    accuracy_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end.
    accuracy_high: f64 => Note "95 % interval, upper end": Share;
    /// Optimisation problems that stopped at the solver's iteration cap.
    n_capped: usize => Note "SVMs stopped at the iteration cap": Linear;
} }

row! {
/// What it costs on one thread (with the [`ChainCell`] before it: a row of `recognition_timing.csv`). Medians, one touch at a time.
pub struct ChainTime {
    /// The press, microseconds.
    sense_us: f64 => Cost "time of a press" in "µs": Log;
    /// Noise and compression.
    project_us: f64 => Cost "time of noise and compression" in "µs": Log;
    /// Scaling, scores and label.
    classify_us: f64 => Cost "time of an answer" in "µs": Log;
    /// All three.
    decision_us: f64 => Cost "time of a decision" in "µs": Log;
    /// Training, seconds.
    fit_s: f64 => Cost "time of a training" in "s": Log;
} }

/// What another program takes for the same press: a row of `results/peers/contact.csv`, of which the columns that are not here do not
/// matter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeerRow {
    /// When it was measured, year-month-day.
    pub date: String,
    /// Which program.
    pub program: String,
    /// Of the program.
    pub version: String,
    /// How it evaluates contact.
    pub method: String,
    /// Its settings in words.
    pub setting: String,
    /// What was touched.
    pub object: String,
    /// Microseconds a touch, median.
    pub us_per_touch: f64,
    /// |δ − δ*|, mean over the taxels that either touches, mm.
    pub error_mm: f64,
}

row! {
/// A way to evaluate contact over all objects: a row of `contact_pareto.csv`. A way of which an object has no number (a method that
/// diverged) has none.
#[derive(Default)]
pub struct ContactPoint {
    /// How.
    way: String => Choice "way to evaluate contact";
    /// Of the spheres, mm.
    tolerance_mm: Option<f64> => Choice "spheres within" in "mm": Log;
    /// Of the time steps, ms.
    dt_ms: Option<f64> => Choice "time step" in "ms": Log;
    /// Another program's settings in words.
    setting: Option<String> => Choice;
    /// Who measured: this run, or a program with version and date.
    source: String => Note "measured by";
    /// Which set the objects are of.
    touched: Touched => Subject;
    /// Median microseconds a touch.
    us_per_touch: f64 => Cost "time of a touch, one thread" in "µs": Log;
    /// Median error, mm.
    error_mm: f64 => Value(Less) "mean deflection error" in "mm": Log between [error_q1_mm, error_q3_mm];
    /// Lower quartile.
    error_q1_mm: f64 => Note "quartiles over objects, lower" in "mm": Log;
    /// Upper quartile.
    error_q3_mm: f64 => Note "quartiles over objects, upper" in "mm": Log;
} }
