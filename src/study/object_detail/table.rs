//! The result tables of a study of object detail: one plain struct a row, one field a column.

use super::spec::DetailMethod;
use crate::recognition::ClassifierKind;
use serde::{Deserialize, Serialize};

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

/// All result tables of a study of object detail.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectDetailTables {
    /// One row an object and model, objects by name, the mesh itself first.
    pub detail: Vec<(DetailCell, DetailScore)>,
    /// One row a method and level, in the same order.
    pub summary: Vec<DetailSummary>,
    /// One row an object and model, in the same order.
    pub timing: Vec<(DetailCell, DetailTime)>,
    /// One row a method, level and classifier, in the same order; none if nothing was to be learned.
    pub recognition: Vec<DetailRecognition>,
}
