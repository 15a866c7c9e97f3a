//! The tables of a study of object detail: one plain struct a row, one field a column.

use crate::learning::classifiers::ClassifierKind;
use crate::row;
use crate::studies::object_detail::spec::DetailMethod;

/// What people call methods.
const METHODS: &[(&str, &str)] = &[("mesh", "exact mesh")];

row! {
/// A model of an object: a row of `object_detail.csv` begins with it, and one of `timing.csv`.
pub struct DetailCell {
    /// The object's name.
    object: String => Subject;
    /// What stands for it.
    method: DetailMethod => Choice "model" named METHODS;
    /// Of the packing that it is, or has as many spheres as, mm.
    tolerance_mm: Option<f64> => Choice "packed within" in "mm": Log;
    /// 0 for the mesh.
    n_spheres: usize => Cost "spheres": Log;
} }

row! {
/// How near a model is to its mesh (with the [`DetailCell`] before it: a row of `object_detail.csv`).
pub struct DetailScore {
    /// Mean distance of the two surfaces, seen from points of the mesh: `protrusion_mean_mm` + `gap_mean_mm`, mm.
    surface_error_mm: f64 => Value(Less) "mean distance of the surfaces" in "mm": Log;
    /// Mean distance of the spheres' surface outside the mesh, mm.
    protrusion_mean_mm: f64 => Value(Less) "mean protrusion" in "mm": Log;
    /// 95th percentile of it.
    protrusion_p95_mm: f64 => Value(Less) "protrusion, 95th percentile" in "mm": Log;
    /// The largest.
    protrusion_max_mm: f64 => Value(Less) "largest protrusion" in "mm": Log;
    /// Mean distance of the mesh outside the spheres, mm.
    gap_mean_mm: f64 => Value(Less) "mean gap" in "mm": Log;
    /// 95th percentile of it.
    gap_p95_mm: f64 => Value(Less) "gap, 95th percentile" in "mm": Log;
    /// The largest.
    gap_max_mm: f64 => Value(Less) "largest gap" in "mm": Log;
    /// Touches that met the mesh.
    n_touches: usize => Note "touches": Linear;
    /// Touches that met nothing.
    n_missed: usize => Note "touches that met nothing": Linear;
    /// Taxels that the mesh touches, all touches.
    n_taxels: usize => Note "touched taxels": Linear;
    /// |deflection − that of the mesh|, mean over taxels that either touches, mm.
    error_mm: f64 => Value(Less) "deflection error" in "mm": Log;
    /// 95th percentile over the same, mm.
    error_p95_mm: f64 => Value(Less) "deflection error, 95th percentile" in "mm": Log;
    /// How far the patch is drawn back for `error_after_offset_mm`, mm; negative if it is pushed on.
    offset_mm: f64 => Note "best constant offset" in "mm": Linear;
    /// `error_mm` with the constant offset that makes it least.
    error_after_offset_mm: f64 => Value(Less) "deflection error after offset" in "mm": Log;
    /// `error_p95_mm` with the same offset.
    error_after_offset_p95_mm: f64 => Value(Less) "deflection error after offset, 95th percentile" in "mm": Log;
    /// `error_mm` where the model is touched as far past its own first contact as the mesh past its, as studies touch.
    error_own_contact_mm: f64 => Value(Less) "deflection error past own contact" in "mm": Log;
} }

row! {
/// What a model costs (with the [`DetailCell`] before it: a row of `timing.csv`).
pub struct DetailTime {
    /// Microseconds a touch, one thread, median over touches.
    us_per_touch: f64 => Cost "time of a touch" in "µs": Log;
    /// Seconds to make the model beside other work on all threads; to read it, if it was kept.
    prepare_s: f64 => Cost "time to make the model" in "s": Log;
    /// Whether the model was kept from a run before.
    was_kept: bool => Note "kept from a run before";
} }

row! {
/// A method at a level over all objects: a row of `object_detail_summary.csv`.
pub struct DetailSummary {
    /// What stands for the meshes.
    method: DetailMethod => Choice "model" named METHODS;
    /// The level, mm; none for methods without levels.
    tolerance_mm: Option<f64> => Choice "packed within" in "mm": Log;
    /// Objects.
    n_objects: usize => Note "objects": Linear;
    /// Lower quartile of the spheres an object.
    n_spheres_q1: f64 => Note "quartiles of spheres, lower": Log;
    /// Median.
    n_spheres_median: f64 => Cost "spheres an object": Log between [n_spheres_q1, n_spheres_q3];
    /// Upper quartile.
    n_spheres_q3: f64 => Note "quartiles of spheres, upper": Log;
    /// Lower quartile of [`DetailScore::surface_error_mm`].
    surface_error_q1_mm: f64 => Note "quartiles of mean distance of the surfaces, lower" in "mm": Log;
    /// Median.
    surface_error_median_mm: f64 => Value(Less) "mean distance of the surfaces" in "mm": Log between [surface_error_q1_mm, surface_error_q3_mm];
    /// Upper quartile.
    surface_error_q3_mm: f64 => Note "quartiles of mean distance of the surfaces, upper" in "mm": Log;
    /// Lower quartile of the larger of `protrusion_max_mm` and `gap_max_mm`.
    surface_error_max_q1_mm: f64 => Note "quartiles of largest distance of the surfaces, lower" in "mm": Log;
    /// Median.
    surface_error_max_median_mm: f64 => Value(Less) "largest distance of the surfaces" in "mm": Log between [surface_error_max_q1_mm, surface_error_max_q3_mm];
    /// Upper quartile.
    surface_error_max_q3_mm: f64 => Note "quartiles of largest distance of the surfaces, upper" in "mm": Log;
    /// Lower quartile of [`DetailScore::error_mm`].
    error_q1_mm: f64 => Note "quartiles of deflection error, lower" in "mm": Log;
    /// Median.
    error_median_mm: f64 => Value(Less) "deflection error" in "mm": Log between [error_q1_mm, error_q3_mm];
    /// Upper quartile.
    error_q3_mm: f64 => Note "quartiles of deflection error, upper" in "mm": Log;
    /// The worst object's.
    error_worst_mm: f64 => Value(Less) "deflection error of the worst object" in "mm": Log;
    /// Lower quartile of [`DetailScore::error_after_offset_mm`].
    error_after_offset_q1_mm: f64 => Note "quartiles of deflection error after offset, lower" in "mm": Log;
    /// Median.
    error_after_offset_median_mm: f64 => Value(Less) "deflection error after offset" in "mm": Log between [error_after_offset_q1_mm, error_after_offset_q3_mm];
    /// Upper quartile.
    error_after_offset_q3_mm: f64 => Note "quartiles of deflection error after offset, upper" in "mm": Log;
    /// The worst object's.
    error_after_offset_worst_mm: f64 => Value(Less) "deflection error after offset of the worst object" in "mm": Log;
    /// Median of [`DetailScore::error_own_contact_mm`].
    error_own_contact_median_mm: f64 => Value(Less) "deflection error past own contact" in "mm": Log;
    /// The worst object's.
    error_own_contact_worst_mm: f64 => Value(Less) "deflection error past own contact of the worst object" in "mm": Log;
    /// Median over objects of `error_after_offset_mm` / that of the packing of the same level, if there is one.
    times_packing: Option<f64> => Value(Less) "times the error of the packing": Log;
} }

row! {
/// A classifier that learned from one level of models: a row of `object_detail_recognition.csv`.
pub struct DetailRecognition {
    /// What stood for the meshes in training.
    method: DetailMethod => Choice "learned from" named METHODS;
    /// The level, mm; none for methods without levels.
    tolerance_mm: Option<f64> => Choice "packed within" in "mm": Log;
    /// What learned.
    classifier: ClassifierKind => Choice named ClassifierKind::NAMES;
    /// Objects to tell apart.
    n_objects: usize => Note "objects": Linear;
    /// Training rows, all objects.
    n_training: usize => Note "training touches": Linear;
    /// Test rows, all objects.
    n_test: usize => Note "test touches": Linear;
    /// Measurements a row.
    n_measurements: usize => Note "measurements": Linear;
    /// Median over objects of [`DetailScore::error_own_contact_mm`]: what is learned is felt past the models' own contact.
    error_own_contact_median_mm: f64 => Value(Less) "median deflection error past own contact" in "mm": Log;
    /// Share of right answers to touches of the meshes themselves, 0 to 1.
    accuracy_on_mesh: f64 => Value(More) "accuracy on the exact meshes": Share between [accuracy_on_mesh_low, accuracy_on_mesh_high];
    /// Lower end of its 95 % Wilson interval.
    accuracy_on_mesh_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end.
    accuracy_on_mesh_high: f64 => Note "95 % interval, upper end": Share;
    /// Share of right answers to the same touches of the models that it learned from, 0 to 1.
    accuracy_on_itself: f64 => Value(More) "accuracy on the models learned from": Share between [accuracy_on_itself_low, accuracy_on_itself_high];
    /// Lower end of its 95 % Wilson interval.
    accuracy_on_itself_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end.
    accuracy_on_itself_high: f64 => Note "95 % interval, upper end": Share;
    /// Optimisation problems that stopped at the solver's iteration cap.
    n_capped: usize => Note "fits stopped at the iteration cap": Linear;
} }

row! {
/// What a touch of a method at a level takes (with the [`DetailSummary`] before it: a row of `object_detail_cost.csv`).
pub struct LevelTime {
    /// Microseconds a touch, one thread, median over objects.
    us_per_touch_median: f64 => Cost "time of a touch, one thread" in "µs": Log;
} }
