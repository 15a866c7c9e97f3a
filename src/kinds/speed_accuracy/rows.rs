//! The tables of a study of speed against accuracy: one plain struct a row, one field a column.

use crate::columns;
use crate::recognition::ClassifierKind;
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
    /// [Rows of a flat patch](crate::contact::flat_rows) in doubles on packed spheres, the pose given.
    RowsInDoubles,
    /// The same in singles.
    RowsInSingles,
}

/// Whose an object is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Touched {
    /// The study's.
    Object,
    /// One of the meshes that are touched [beside](crate::kinds::speed_accuracy::ScansSpec) them.
    Scan,
}

/// A way and an object: a row of `contact.csv` begins with it, and one of `contact_timing.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactCell {
    /// How.
    pub way: ContactWay,
    /// Of the spheres, mm.
    pub tolerance_mm: Option<f64>,
    /// Of the time steps, ms.
    pub dt_ms: Option<f64>,
    /// Whose it is that is touched.
    pub touched: Touched,
    /// What is touched.
    pub object: String,
    /// 0 for meshes and solids themselves.
    pub n_spheres: usize,
}

columns! { ContactCell {
    way: Choice "way to evaluate contact";
    tolerance_mm: Choice "spheres within" in "mm": Log;
    dt_ms: Choice "time step" in "ms": Log;
    touched: Subject;
    object: Subject;
    n_spheres: Cost "spheres": Log;
} }

/// How near the deflections are to those of exact contact (with the [`ContactCell`] before it: a row of `contact.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactScore {
    /// Touches.
    pub n_touches: usize,
    /// |δ − δ*|, mean over the taxels that either touches, mm; none where a number was not finite.
    pub error_mm: Option<f64>,
    /// 95th percentile of the same, mm.
    pub error_p95_mm: Option<f64>,
    /// Steps of a touch; none where nothing is stepped.
    pub n_steps: Option<usize>,
}

columns! { ContactScore {
    n_touches: Note "touches": Linear;
    error_mm: Value(Less) "deflection error" in "mm": Log;
    error_p95_mm: Value(Less) "deflection error, 95th percentile" in "mm": Log;
    n_steps: Note "steps of a touch": Linear;
} }

/// What it costs (with the [`ContactCell`] before it: a row of `contact_timing.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactTime {
    /// Microseconds a touch, one thread, median.
    pub us_per_touch: f64,
}

columns! { ContactTime {
    us_per_touch: Cost "time of a touch" in "µs": Log;
} }

/// A chain from touch to answer: a row of `recognition.csv` begins with it, and one of `recognition_timing.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChainCell {
    /// Between taxels, mm.
    pub pitch_mm: f64,
    /// Taxels.
    pub n_taxels: usize,
    /// Detail of the objects that are learned from, mm.
    pub tolerance_mm: f64,
    /// How frames are compressed.
    pub ensemble: Ensemble,
    /// Taxels per measurement.
    pub ratio: f64,
    /// Measurements.
    pub measurements: usize,
    /// What answers.
    pub classifier: ClassifierKind,
}

columns! { ChainCell {
    pitch_mm: Choice "pitch" in "mm": Log;
    n_taxels: Cost "taxels": Log;
    tolerance_mm: Choice "spheres within" in "mm": Log;
    ensemble: Choice;
    ratio: Choice "compression" in ":1": Log;
    measurements: Cost "m": Log;
    classifier: Choice;
} }

/// How often it is right (with the [`ChainCell`] before it: a row of `recognition.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChainScore {
    /// Objects to tell apart.
    pub n_objects: usize,
    /// Training touches, all objects.
    pub n_training: usize,
    /// Test touches of the exact objects.
    pub n_test: usize,
    /// Share of right answers, 0 to 1.
    pub accuracy: f64,
    /// Lower end of its 95 % Wilson interval.
    pub accuracy_low: f64,
    /// Upper end.
    pub accuracy_high: f64,
    /// Optimisation problems that stopped at the solver's iteration cap.
    pub n_capped: usize,
}

columns! { ChainScore {
    n_objects: Note "objects": Linear;
    n_training: Note "training touches": Linear;
    n_test: Note "test touches": Linear;
    accuracy: Value(More): Share between [accuracy_low, accuracy_high];
    accuracy_low: Note "95 % interval, lower end": Share;
    accuracy_high: Note "95 % interval, upper end": Share;
    n_capped: Note "SVMs stopped at the iteration cap": Linear;
} }

/// What it costs on one thread (with the [`ChainCell`] before it: a row of `recognition_timing.csv`). Medians, one touch at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChainTime {
    /// The press, microseconds.
    pub sense_us: f64,
    /// Noise and compression.
    pub project_us: f64,
    /// Scaling, scores and label.
    pub classify_us: f64,
    /// All three.
    pub decision_us: f64,
    /// Training, seconds.
    pub fit_s: f64,
}

columns! { ChainTime {
    sense_us: Cost "time of a press" in "µs": Log;
    project_us: Cost "time of noise and compression" in "µs": Log;
    classify_us: Cost "time of an answer" in "µs": Log;
    decision_us: Cost "time of a decision" in "µs": Log;
    fit_s: Cost "time of a training" in "s": Log;
} }

/// A study of some size: a row of `resolution.csv` begins with it, and one of `resolution_timing.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudySize {
    /// Touches an object, three quarters of which train.
    pub touches: usize,
    /// Trials.
    pub trials: usize,
}

columns! { StudySize {
    touches: Choice "touches an object": Log;
    trials: Choice: Log;
} }

/// What it resolves (with the [`StudySize`] before it: a row of `resolution.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Resolved {
    /// Test touches of a trial, all objects.
    pub n_test: usize,
    /// Mean accuracy at the first ratio.
    pub accuracy: f64,
    /// Half the width of its 95 % Wilson interval at one trial's test touches, as studies report it.
    pub accuracy_half_width: f64,
    /// Accuracy at the first ratio − at the second.
    pub difference: f64,
    /// Half the width of its 95 % interval, by the corrected resampled t-test.
    pub difference_half_width: f64,
}

columns! { Resolved {
    n_test: Note "test touches": Linear;
    accuracy: Value(Neither): Share;
    accuracy_half_width: Value(Less) "half width of the interval of an accuracy": Log;
    difference: Value(Neither) "difference of two accuracies": Share;
    difference_half_width: Value(Less) "half width of the interval of a difference": Log;
} }

/// What it costs (with the [`StudySize`] before it: a row of `resolution_timing.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyTime {
    /// Processor-seconds: touches, measurements, fits and predictions of both ratios.
    pub cpu_s: f64,
}

columns! { StudyTime {
    cpu_s: Cost "processor time of the study" in "s": Log;
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
    /// The way it goes about contact.
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

/// A way to evaluate contact over all objects: a row of `contact_pareto.csv`. A way of which an object has no number (a method that
/// diverged) has none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactPoint {
    /// How.
    pub way: String,
    /// Of the spheres, mm.
    pub tolerance_mm: Option<f64>,
    /// Of the time steps, ms.
    pub dt_ms: Option<f64>,
    /// Another program's settings in words.
    pub setting: Option<String>,
    /// Who measured: this run, or a program with version and date.
    pub source: String,
    /// Whose the objects are.
    pub touched: Touched,
    /// Median microseconds a touch.
    pub us_per_touch: f64,
    /// Median error, mm.
    pub error_mm: f64,
    /// Lower quartile.
    pub error_q1_mm: f64,
    /// Upper quartile.
    pub error_q3_mm: f64,
}

columns! { ContactPoint {
    way: Choice "way to evaluate contact";
    tolerance_mm: Choice "spheres within" in "mm": Log;
    dt_ms: Choice "time step" in "ms": Log;
    setting: Choice;
    source: Note "measured by";
    touched: Subject;
    us_per_touch: Cost "time of a touch, one thread" in "µs": Log;
    error_mm: Value(Less) "mean deflection error" in "mm": Log between [error_q1_mm, error_q3_mm];
    error_q1_mm: Note "quartiles over objects, lower" in "mm": Log;
    error_q3_mm: Note "quartiles over objects, upper" in "mm": Log;
} }
