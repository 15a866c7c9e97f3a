//! The tables of a study of object detail: one plain struct a row, one field a column.

use super::spec::DetailMethod;
use crate::columns;
use crate::recognition::ClassifierKind;
use serde::{Deserialize, Serialize};

/// What people call methods.
const METHODS: &[(&str, &str)] = &[("mesh", "exact mesh")];

/// A model of an object: a row of `object_detail.csv` begins with it, and one of `timing.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DetailCell {
    /// The object's name.
    pub object: String,
    /// What stands for it.
    pub method: DetailMethod,
    /// Of the packing that it is, or has as many spheres as, mm.
    pub tolerance_mm: Option<f64>,
    /// 0 for the mesh.
    pub n_spheres: usize,
}

columns! { DetailCell {
    object: Subject;
    method: Choice "model" named METHODS;
    tolerance_mm: Choice "packed within" in "mm": Log;
    n_spheres: Cost "spheres": Log;
} }

/// How near a model is to its mesh (with the [`DetailCell`] before it: a row of `object_detail.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DetailScore {
    /// Mean distance of the two surfaces, seen from points of the mesh: `protrusion_mean_mm` + `gap_mean_mm`, mm.
    pub surface_error_mm: f64,
    /// Mean distance of the spheres' surface outside the mesh, mm.
    pub protrusion_mean_mm: f64,
    /// 95th percentile of it.
    pub protrusion_p95_mm: f64,
    /// The largest.
    pub protrusion_max_mm: f64,
    /// Mean distance of the mesh outside the spheres, mm.
    pub gap_mean_mm: f64,
    /// 95th percentile of it.
    pub gap_p95_mm: f64,
    /// The largest.
    pub gap_max_mm: f64,
    /// Touches that met the mesh.
    pub n_touches: usize,
    /// Touches that met nothing.
    pub n_missed: usize,
    /// Taxels that the mesh touches, all touches.
    pub n_taxels: usize,
    /// |deflection − that of the mesh|, mean over taxels that either touches, mm.
    pub error_mm: f64,
    /// 95th percentile over the same, mm.
    pub error_p95_mm: f64,
    /// How far the patch is drawn back for `error_after_offset_mm`, mm; negative if it is pushed on.
    pub offset_mm: f64,
    /// `error_mm` with the constant offset that makes it least.
    pub error_after_offset_mm: f64,
    /// `error_p95_mm` with the same offset.
    pub error_after_offset_p95_mm: f64,
    /// `error_mm` where the model is touched as far past its own first contact as the mesh past its, as studies touch.
    pub error_own_contact_mm: f64,
}

columns! { DetailScore {
    surface_error_mm: Value(Less) "mean distance of the surfaces" in "mm": Log;
    protrusion_mean_mm: Value(Less) "mean protrusion" in "mm": Log;
    protrusion_p95_mm: Value(Less) "protrusion, 95th percentile" in "mm": Log;
    protrusion_max_mm: Value(Less) "largest protrusion" in "mm": Log;
    gap_mean_mm: Value(Less) "mean gap" in "mm": Log;
    gap_p95_mm: Value(Less) "gap, 95th percentile" in "mm": Log;
    gap_max_mm: Value(Less) "largest gap" in "mm": Log;
    n_touches: Note "touches": Linear;
    n_missed: Note "touches that met nothing": Linear;
    n_taxels: Note "touched taxels": Linear;
    error_mm: Value(Less) "deflection error" in "mm": Log;
    error_p95_mm: Value(Less) "deflection error, 95th percentile" in "mm": Log;
    offset_mm: Note "best constant offset" in "mm": Linear;
    error_after_offset_mm: Value(Less) "deflection error after offset" in "mm": Log;
    error_after_offset_p95_mm: Value(Less) "deflection error after offset, 95th percentile" in "mm": Log;
    error_own_contact_mm: Value(Less) "deflection error past own contact" in "mm": Log;
} }

/// What a model costs (with the [`DetailCell`] before it: a row of `timing.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DetailTime {
    /// Microseconds a touch, one thread, median over touches.
    pub us_per_touch: f64,
    /// Seconds to make the model beside other work on all threads; to read it, if it was kept.
    pub prepare_s: f64,
    /// Whether the model was kept from a run before.
    pub was_kept: bool,
}

columns! { DetailTime {
    us_per_touch: Cost "time of a touch" in "µs": Log;
    prepare_s: Cost "time to make the model" in "s": Log;
    was_kept: Note "kept from a run before";
} }

/// A method at a level over all objects: a row of `object_detail_summary.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DetailSummary {
    /// What stands for the meshes.
    pub method: DetailMethod,
    /// The level, mm; none for methods without levels.
    pub tolerance_mm: Option<f64>,
    /// Objects.
    pub n_objects: usize,
    /// Lower quartile of the spheres an object.
    pub n_spheres_q1: f64,
    /// Median.
    pub n_spheres_median: f64,
    /// Upper quartile.
    pub n_spheres_q3: f64,
    /// Lower quartile of [`DetailScore::surface_error_mm`].
    pub surface_error_q1_mm: f64,
    /// Median.
    pub surface_error_median_mm: f64,
    /// Upper quartile.
    pub surface_error_q3_mm: f64,
    /// Lower quartile of the larger of `protrusion_max_mm` and `gap_max_mm`.
    pub surface_error_max_q1_mm: f64,
    /// Median.
    pub surface_error_max_median_mm: f64,
    /// Upper quartile.
    pub surface_error_max_q3_mm: f64,
    /// Lower quartile of [`DetailScore::error_mm`].
    pub error_q1_mm: f64,
    /// Median.
    pub error_median_mm: f64,
    /// Upper quartile.
    pub error_q3_mm: f64,
    /// The worst object's.
    pub error_worst_mm: f64,
    /// Lower quartile of [`DetailScore::error_after_offset_mm`].
    pub error_after_offset_q1_mm: f64,
    /// Median.
    pub error_after_offset_median_mm: f64,
    /// Upper quartile.
    pub error_after_offset_q3_mm: f64,
    /// The worst object's.
    pub error_after_offset_worst_mm: f64,
    /// Median of [`DetailScore::error_own_contact_mm`].
    pub error_own_contact_median_mm: f64,
    /// The worst object's.
    pub error_own_contact_worst_mm: f64,
    /// Median over objects of `error_after_offset_mm` / that of the packing of the same level, if there is one.
    pub times_packing: Option<f64>,
}

columns! { DetailSummary {
    method: Choice "model" named METHODS;
    tolerance_mm: Choice "packed within" in "mm": Log;
    n_objects: Note "objects": Linear;
    n_spheres_q1: Note "spheres, quartiles over objects, lower": Log;
    n_spheres_median: Cost "spheres an object": Log between [n_spheres_q1, n_spheres_q3];
    n_spheres_q3: Note "spheres, quartiles over objects, upper": Log;
    surface_error_q1_mm: Note "mean distance of the surfaces, quartiles over objects, lower" in "mm": Log;
    surface_error_median_mm: Value(Less) "mean distance of the surfaces" in "mm": Log between [surface_error_q1_mm, surface_error_q3_mm];
    surface_error_q3_mm: Note "mean distance of the surfaces, quartiles over objects, upper" in "mm": Log;
    surface_error_max_q1_mm: Note "largest distance of the surfaces, quartiles over objects, lower" in "mm": Log;
    surface_error_max_median_mm: Value(Less) "largest distance of the surfaces" in "mm": Log between [surface_error_max_q1_mm, surface_error_max_q3_mm];
    surface_error_max_q3_mm: Note "largest distance of the surfaces, quartiles over objects, upper" in "mm": Log;
    error_q1_mm: Note "deflection error, quartiles over objects, lower" in "mm": Log;
    error_median_mm: Value(Less) "deflection error" in "mm": Log between [error_q1_mm, error_q3_mm];
    error_q3_mm: Note "deflection error, quartiles over objects, upper" in "mm": Log;
    error_worst_mm: Value(Less) "deflection error of the worst object" in "mm": Log;
    error_after_offset_q1_mm: Note "deflection error after offset, quartiles over objects, lower" in "mm": Log;
    error_after_offset_median_mm: Value(Less) "deflection error after offset" in "mm": Log between [error_after_offset_q1_mm, error_after_offset_q3_mm];
    error_after_offset_q3_mm: Note "deflection error after offset, quartiles over objects, upper" in "mm": Log;
    error_after_offset_worst_mm: Value(Less) "deflection error after offset of the worst object" in "mm": Log;
    error_own_contact_median_mm: Value(Less) "deflection error past own contact" in "mm": Log;
    error_own_contact_worst_mm: Value(Less) "deflection error past own contact of the worst object" in "mm": Log;
    times_packing: Value(Less) "times the error of the packing": Log;
} }

/// A classifier that learned from one level of models: a row of `object_detail_recognition.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DetailRecognition {
    /// What stood for the meshes in training.
    pub method: DetailMethod,
    /// The level, mm; none for methods without levels.
    pub tolerance_mm: Option<f64>,
    /// What learned.
    pub classifier: ClassifierKind,
    /// Objects to tell apart.
    pub n_objects: usize,
    /// Training rows, all objects.
    pub n_training: usize,
    /// Test rows, all objects.
    pub n_test: usize,
    /// Measurements a row.
    pub n_measurements: usize,
    /// Median over objects of [`DetailScore::error_own_contact_mm`]: what is learned is felt past the models' own contact.
    pub error_own_contact_median_mm: f64,
    /// Share of right answers to touches of the meshes themselves, 0 to 1.
    pub accuracy_on_mesh: f64,
    /// Lower end of its 95 % Wilson interval.
    pub accuracy_on_mesh_low: f64,
    /// Upper end.
    pub accuracy_on_mesh_high: f64,
    /// Share of right answers to the same touches of the models that it learned from, 0 to 1.
    pub accuracy_on_itself: f64,
    /// Lower end of its 95 % Wilson interval.
    pub accuracy_on_itself_low: f64,
    /// Upper end.
    pub accuracy_on_itself_high: f64,
    /// Optimisation problems that stopped at the solver's iteration cap.
    pub n_capped: usize,
}

columns! { DetailRecognition {
    method: Choice "learned from" named METHODS;
    tolerance_mm: Choice "packed within" in "mm": Log;
    classifier: Choice;
    n_objects: Note "objects": Linear;
    n_training: Note "training touches": Linear;
    n_test: Note "test touches": Linear;
    n_measurements: Note "measurements": Linear;
    error_own_contact_median_mm: Value(Less) "median deflection error past own contact" in "mm": Log;
    accuracy_on_mesh: Value(More) "accuracy on the exact meshes": Share between [accuracy_on_mesh_low, accuracy_on_mesh_high];
    accuracy_on_mesh_low: Note "95 % interval, lower end": Share;
    accuracy_on_mesh_high: Note "95 % interval, upper end": Share;
    accuracy_on_itself: Value(More) "accuracy on the models learned from": Share between [accuracy_on_itself_low, accuracy_on_itself_high];
    accuracy_on_itself_low: Note "95 % interval, lower end": Share;
    accuracy_on_itself_high: Note "95 % interval, upper end": Share;
    n_capped: Note "fits stopped at the iteration cap": Linear;
} }

/// What a touch of a method at a level takes (with the [`DetailSummary`] before it: a row of `object_detail_cost.csv`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelTime {
    /// Microseconds a touch, one thread, median over objects.
    pub us_per_touch_median: f64,
}

columns! { LevelTime {
    us_per_touch_median: Cost "time of a touch, one thread" in "µs": Log;
} }
