//! Rows of the result tables of an object-detail study: one plain struct for each kind of row, with one field per column.

use crate::studies::object_detail::plan::*;
use crate::studies::prelude::*;

/// Display names of the methods that replace a mesh by a model.
const METHODS: &[(&str, &str)] = &[("mesh", "exact mesh")];

row! {
/// Model of an object, which is identified by the first columns of `object_detail.csv` and `timing.csv`.
pub struct DetailConfiguration {
    /// Name of the object that is touched.
    object: String => Subject;
    /// Method that makes the model from the mesh.
    method: DetailMethod => Choice "model" named METHODS;
    /// Tolerance of the packing (spheres that fill the mesh), mm. Methods without a tolerance have the tolerance of the packing with the same number of
    /// spheres; empty if there is none.
    tolerance_mm: Option<f64> => Choice "packed within" in "mm": Log;
    /// Number of spheres of the model; 0 for the mesh.
    n_spheres: usize => Cost "spheres": Log;
} }

row! {
/// Differences between a model and its mesh. A row of `object_detail.csv` is a [`DetailConfiguration`] followed by a `DetailScore`.
pub struct DetailScore {
    /// Mean distance between the surfaces of model and mesh, mm, measured at points of the mesh: the sum of `protrusion_mean_mm` and `gap_mean_mm`.
    surface_error_mm: f64 => Value(Less) "mean distance of the surfaces" in "mm": Log;
    /// Mean distance by which the spheres of the model protrude from the mesh, mm.
    protrusion_mean_mm: f64 => Value(Less) "mean protrusion" in "mm": Log;
    /// 95th percentile of the distance by which the spheres of the model protrude from the mesh, mm.
    protrusion_p95_mm: f64 => Value(Less) "protrusion, 95th percentile" in "mm": Log;
    /// Largest distance by which the spheres protrude from the mesh, mm.
    protrusion_max_mm: f64 => Value(Less) "largest protrusion" in "mm": Log;
    /// Mean distance by which the mesh protrudes from the spheres of the model, mm.
    gap_mean_mm: f64 => Value(Less) "mean gap" in "mm": Log;
    /// 95th percentile of the distance by which the mesh protrudes from the spheres of the model, mm.
    gap_p95_mm: f64 => Value(Less) "gap, 95th percentile" in "mm": Log;
    /// Largest distance by which the mesh protrudes from the spheres, mm.
    gap_max_mm: f64 => Value(Less) "largest gap" in "mm": Log;
    /// Number of touches that reached the mesh.
    n_touches: usize => Note "touches": Linear;
    /// Number of touches that missed the mesh.
    n_missed: usize => Note "touches that met nothing": Linear;
    /// Number of taxels that the mesh touches, summed over all touches with the mesh.
    n_taxels: usize => Note "touched taxels": Linear;
    /// Deflection error, mm: mean of |δ − δ*| over touched taxels, where δ is the deflection by the model and δ* by the mesh.
    error_mm: f64 => Value(Less) "deflection error" in "mm": Log;
    /// 95th percentile of |δ − δ*| over touched taxels, mm, where δ is the deflection by the model and δ* by the mesh.
    error_p95_mm: f64 => Value(Less) "deflection error, 95th percentile" in "mm": Log;
    /// Distance by which the patch is retracted to minimise `error_after_offset_mm`, mm; negative if the patch is advanced.
    offset_mm: f64 => Note "best constant offset" in "mm": Linear;
    /// Deflection error, defined as `error_mm`, while the patch is retracted by `offset_mm`, mm. The constant offset `offset_mm` minimises the error.
    error_after_offset_mm: f64 => Value(Less) "deflection error after offset" in "mm": Log;
    /// 95th percentile of |δ − δ*| over taxels while the patch is retracted by `offset_mm`, mm. Here δ is the deflection on the model and δ* on the mesh.
    error_after_offset_p95_mm: f64 => Value(Less) "deflection error after offset, 95th percentile" in "mm": Log;
    /// Deflection error for equal depths past the first contact of mesh and model, as in other studies, mm.
    error_own_contact_mm: f64 => Value(Less) "deflection error past own contact" in "mm": Log;
} }

row! {
/// Computing time per touch of a model, and time to compute the model. A row of `timing.csv` is a [`DetailConfiguration`] followed by a `DetailTime`.
pub struct DetailTime {
    /// Computing time per touch of the model on one thread, median over touches, µs.
    us_per_touch: f64 => Cost "time of a touch" in "µs": Log;
    /// Time to compute the model while other threads are busy, or to read it from the cache, s.
    prepare_s: f64 => Cost "time to make the model" in "s": Log;
    /// Whether the model was read from the cache of an earlier run.
    cached: bool => Note "kept from a run before";
} }

row! {
/// Results of one method and tolerance over all objects: a row of `object_detail_summary.csv`.
pub struct DetailSummary {
    /// Method that makes models from the meshes.
    method: DetailMethod => Choice "model" named METHODS;
    /// Tolerance of the packing (spheres that fill the mesh), mm; empty for methods without a tolerance.
    tolerance_mm: Option<f64> => Choice "packed within" in "mm": Log;
    /// Number of objects over which the results are summarised.
    n_objects: usize => Note "objects": Linear;
    /// Lower quartile, over all objects, of the number of spheres of an object's model.
    n_spheres_q1: f64 => Note "quartiles of spheres, lower": Log;
    /// Median, over all objects, of the number of spheres of an object's model.
    n_spheres_median: f64 => Cost "spheres an object": Log between [n_spheres_q1, n_spheres_q3];
    /// Upper quartile, over all objects, of the number of spheres of an object's model.
    n_spheres_q3: f64 => Note "quartiles of spheres, upper": Log;
    /// Lower quartile, over all objects, of `surface_error_mm`: the mean distance between the surfaces of model and mesh, mm.
    surface_error_q1_mm: f64 => Note "quartiles of mean distance of the surfaces, lower" in "mm": Log;
    /// Median, over all objects, of `surface_error_mm`: the mean distance between the surfaces of model and mesh, mm.
    surface_error_median_mm: f64 => Value(Less) "mean distance of the surfaces" in "mm": Log between [surface_error_q1_mm, surface_error_q3_mm];
    /// Upper quartile, over all objects, of `surface_error_mm`: the mean distance between the surfaces of model and mesh, mm.
    surface_error_q3_mm: f64 => Note "quartiles of mean distance of the surfaces, upper" in "mm": Log;
    /// Lower quartile, over all objects, of the largest distance between the surfaces of model and mesh, mm: the larger of `protrusion_max_mm` and
    /// `gap_max_mm`.
    surface_error_max_q1_mm: f64 => Note "quartiles of largest distance of the surfaces, lower" in "mm": Log;
    /// Median, over all objects, of the largest distance between the surfaces of model and mesh, mm: the larger of `protrusion_max_mm` and `gap_max_mm`.
    surface_error_max_median_mm: f64 => Value(Less) "largest distance of the surfaces" in "mm": Log between [surface_error_max_q1_mm, surface_error_max_q3_mm];
    /// Upper quartile, over all objects, of the largest distance between the surfaces of model and mesh, mm: the larger of `protrusion_max_mm` and
    /// `gap_max_mm`.
    surface_error_max_q3_mm: f64 => Note "quartiles of largest distance of the surfaces, upper" in "mm": Log;
    /// Lower quartile, over all objects, of `error_mm`: the mean deflection error of a model, mm.
    error_q1_mm: f64 => Note "quartiles of deflection error, lower" in "mm": Log;
    /// Median, over all objects, of `error_mm`: the mean deflection error of a model, mm.
    error_median_mm: f64 => Value(Less) "deflection error" in "mm": Log between [error_q1_mm, error_q3_mm];
    /// Upper quartile, over all objects, of `error_mm`: the mean deflection error of a model, mm.
    error_q3_mm: f64 => Note "quartiles of deflection error, upper" in "mm": Log;
    /// Largest mean deflection error (`error_mm`) of any object's model, mm.
    error_worst_mm: f64 => Value(Less) "deflection error of the worst object" in "mm": Log;
    /// Lower quartile, over all objects, of `error_after_offset_mm`, the deflection error after the best constant offset of the patch, mm.
    error_after_offset_q1_mm: f64 => Note "quartiles of deflection error after offset, lower" in "mm": Log;
    /// Median, over all objects, of `error_after_offset_mm`, the deflection error after the best constant offset of the patch, mm.
    error_after_offset_median_mm: f64 => Value(Less) "deflection error after offset" in "mm": Log between [error_after_offset_q1_mm, error_after_offset_q3_mm];
    /// Upper quartile, over all objects, of `error_after_offset_mm`, the deflection error after the best constant offset of the patch, mm.
    error_after_offset_q3_mm: f64 => Note "quartiles of deflection error after offset, upper" in "mm": Log;
    /// Largest value of `error_after_offset_mm` (deflection error with the best constant offset of the patch) of any object's model, mm.
    error_after_offset_worst_mm: f64 => Value(Less) "deflection error after offset of the worst object" in "mm": Log;
    /// Median, over all objects, of `error_own_contact_mm`, the deflection error for equal depths past first contact, mm.
    error_own_contact_median_mm: f64 => Value(Less) "deflection error past own contact" in "mm": Log;
    /// Largest deflection error at equal depths past each model's own first contact (`error_own_contact_mm`) of any object, mm.
    error_own_contact_worst_mm: f64 => Value(Less) "deflection error past own contact of the worst object" in "mm": Log;
    /// Error of this method divided by the error of the packing with equal tolerance (`error_after_offset_mm`), median over all objects, dimensionless. Empty
    /// if there is no such packing.
    times_packing: Option<f64> => Value(Less) "times the error of the packing": Log;
} }

row! {
/// Accuracy of a classifier trained on the models of one method and tolerance: a row of `object_detail_recognition.csv`.
pub struct DetailRecognition {
    /// Method that makes the training models from the meshes.
    method: DetailMethod => Choice "learned from" named METHODS;
    /// Tolerance of the packing (spheres that fill the mesh), mm; empty for methods without a tolerance.
    tolerance_mm: Option<f64> => Choice "packed within" in "mm": Log;
    /// Kind of classifier, for example a linear SVM.
    classifier: ClassifierKind => Choice named ClassifierKind::NAMES;
    /// Number of objects that the classifier distinguishes.
    n_objects: usize => Note "objects": Linear;
    /// Number of rows with which the classifier is trained, summed over all objects.
    n_training: usize => Note "training touches": Linear;
    /// Number of rows with which the classifier is tested, summed over all objects.
    n_test: usize => Note "test touches": Linear;
    /// Number of measurements per touch from which the classifier recognises the object.
    n_measurements: usize => Note "measurements": Linear;
    /// Median, over all objects, of `error_own_contact_mm`, mm: the deflection error of the training models. Training touches are also pressed past each
    /// model's own first contact.
    error_own_contact_median_mm: f64 => Value(Less) "median deflection error past own contact" in "mm": Log;
    /// Fraction of the test touches of the exact meshes that are recognised correctly, 0 to 1.
    accuracy_on_mesh: f64 => Value(More) "accuracy on the exact meshes": Share between [accuracy_on_mesh_low, accuracy_on_mesh_high];
    /// Lower end of the 95 % Wilson interval of `accuracy_on_mesh`, 0 to 1.
    accuracy_on_mesh_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end of the 95 % Wilson interval of `accuracy_on_mesh`, 0 to 1.
    accuracy_on_mesh_high: f64 => Note "95 % interval, upper end": Share;
    /// Fraction of correctly recognised test touches, 0 to 1, if the test touches the models used in training instead of the meshes.
    accuracy_on_itself: f64 => Value(More) "accuracy on the models learned from": Share between [accuracy_on_itself_low, accuracy_on_itself_high];
    /// Lower end of the 95 % Wilson interval of `accuracy_on_itself`, 0 to 1.
    accuracy_on_itself_low: f64 => Note "95 % interval, lower end": Share;
    /// Upper end of the 95 % Wilson interval of `accuracy_on_itself`, 0 to 1.
    accuracy_on_itself_high: f64 => Note "95 % interval, upper end": Share;
    /// Number of the classifier's optimisation problems that stopped at the maximum number of iterations.
    n_capped: usize => Note "fits stopped at the iteration cap": Linear;
} }

row! {
/// Computing time per touch for one method and tolerance. A row of `object_detail_cost.csv` is a [`DetailSummary`] followed by a `LevelTime`.
pub struct LevelTime {
    /// Computing time of a touch of the model on one thread, median over objects, µs.
    us_per_touch_median: f64 => Cost "time of a touch, one thread" in "µs": Log;
} }

/// File of the table of classifiers, which only studies with a table `[object_detail.recognition]` have.
pub(super) const RECOGNITION: File<DetailRecognition> = File::new(
    "object_detail_recognition.csv",
    "Classifiers that learned from models",
    "",
);

/// File of the table of deflection errors, one row per object and model.
pub(super) const DETAIL: File<(DetailConfiguration, DetailScore)> =
    File::new("object_detail.csv", "Models of each object", "");
pub(super) const SUMMARY: File<DetailSummary> = File::new(
    "object_detail_summary.csv",
    "Models over all objects",
    "Medians and quartiles over objects. Deflection errors are means of |deflection − deflection of the exact mesh| over touched taxels; \
     errors after offset are without the best constant depth.",
)
.summary();
pub(super) const TIMING: File<(DetailConfiguration, DetailTime)> =
    File::new("timing.csv", "Time of a touch of each model", "").of_times();
pub(super) const COST: File<(DetailSummary, LevelTime)> =
    File::new("object_detail_cost.csv", "Cost of deflection errors", "")
        .of_times()
        .summary();
