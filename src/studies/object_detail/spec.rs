//! Specification of an object-detail study: the keys of its TOML file.

use crate::inputs::defaults::count;
use crate::inputs::objects_spec::ObjectsSpec;
use crate::learning::classifiers::ClassifierKind;
use crate::sensing::Ensemble;
use crate::studies::recognition::spec::scene::{SkinSpec, TouchesSpec};
use crate::study_file::study_file;
use serde::{Deserialize, Serialize};

study_file! {
pub struct ObjectDetailStudySpec {
    /// Touched objects, given as meshes.
    pub objects: ObjectsSpec,
    /// The skin, a single array.
    pub skin: SkinSpec,
    /// The touches.
    pub touches: TouchesSpec,
    /// Models that replace the meshes.
    pub object_detail: ObjectDetailSpec,
} }

/// `[object_detail]`: models that replace meshes, and their comparison.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectDetailSpec {
    /// Tolerances, mm: largest distances of packed spheres from the mesh.
    pub tolerances_mm: Vec<f64>,
    /// Methods that replace the mesh.
    pub methods: Vec<DetailMethod>,
    /// Number of points of a mesh at which the distance to the spheres is measured.
    #[serde(default = "count::<5000>")]
    pub surface_points: usize,
    /// Classifiers that are trained on the models and tested on the meshes. Default: none.
    #[serde(default)]
    pub recognition: Option<DetailRecognitionSpec>,
}

/// `[object_detail.recognition]`: classifiers trained on models and tested on meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DetailRecognitionSpec {
    /// Number of training touches of each object, drawn like the study's touches.
    pub training_touches: usize,
    /// Number of further touches of each object for testing.
    pub test_touches: usize,
    /// Ensemble that compresses the frames.
    #[serde(default = "default_ensemble")]
    pub ensemble: Ensemble,
    /// Number of measurements per frame.
    pub measurements: usize,
    /// Classifiers, with the parameters of [`Classifier::new`](crate::learning::classifiers::classifier::Classifier::new).
    pub classifiers: Vec<ClassifierKind>,
}

impl DetailRecognitionSpec {
    /// Returns the number of training and test touches of each object.
    pub(super) fn n_touches(&self) -> usize {
        self.training_touches + self.test_touches
    }
}

/// Method that replaces a mesh by a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DetailMethod {
    /// The exact mesh, which is the reference for all other methods; always measured.
    Mesh,
    /// Packed spheres within each tolerance.
    Packing,
    /// One sphere per vertex \[BT\].
    VertexSpheres,
    /// One sphere at each of a number of evenly spread vertices. For each packing, the number equals the packing's number of spheres, or the number of all
    /// vertices if that is smaller.
    DecimatedVertexSpheres,
    /// The largest spheres inside the mesh that touch it at a number of points equal to the number of spheres of each packing
    /// ([`medial_spheres`](crate::packing::medial_spheres)).
    MedialSpheres,
}

fn default_ensemble() -> Ensemble {
    Ensemble::Sbhe
}
