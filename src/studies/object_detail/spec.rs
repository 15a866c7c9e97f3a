//! Specification of an object-detail study: the keys of its TOML file.

use crate::inputs::defaults::count;
use crate::inputs::objects_spec::ObjectsSpec;
use crate::inputs::schema_types::Names;
use crate::learning::classifiers::ClassifierKind;
use crate::sensing::Ensemble;
use crate::studies::recognition::spec::scene::{SkinSpec, TouchesSpec};
use crate::study_file::study_file;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

study_file! {
pub struct ObjectDetailStudySpec {
    /// Table `[objects]`: the touched objects, given as meshes.
    pub objects: ObjectsSpec,
    /// Table `[skin]`: a single array of taxels.
    pub skin: SkinSpec,
    /// Table `[touches]`: poses and depths of the touches.
    pub touches: TouchesSpec,
    /// Table `[object_detail]`: models that replace the meshes.
    pub object_detail: ObjectDetailSpec,
} }

/// Keys of `[object_detail]`: models that replace the meshes, and their comparison with the meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectDetailSpec {
    /// Tolerances of the packing (maximum distance between spheres and mesh surface), mm, each at least 1e-6.
    pub tolerances_mm: Vec<f64>,
    /// Methods that make models from the meshes.
    pub methods: Vec<DetailMethod>,
    /// Number of points of a mesh at which the distance to the spheres is measured, at least 1. Default: 5000.
    #[serde(default = "count::<5000>")]
    pub surface_points: usize,
    /// Table `[object_detail.recognition]`: classifiers that are trained on models and tested on meshes. Default: none.
    #[serde(default)]
    pub recognition: Option<DetailRecognitionSpec>,
}

/// Keys of `[object_detail.recognition]`: classifiers that are trained on models and tested on meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DetailRecognitionSpec {
    /// Number of training touches per object, at least 1, drawn as in `[touches]`.
    pub training_touches: usize,
    /// Number of test touches per object, in addition to the training touches, at least 1.
    pub test_touches: usize,
    /// Ensemble of the measurement matrix that compresses the frames. Default: `sbhe`.
    #[serde(default = "default_ensemble")]
    #[schemars(with = "Names<Ensemble>")]
    pub ensemble: Ensemble,
    /// Number m of measurements per frame, at least 1.
    pub measurements: usize,
    /// Kinds of classifiers to train, each with its default parameters.
    #[schemars(with = "Vec<Names<ClassifierKind>>")]
    pub classifiers: Vec<ClassifierKind>,
}

impl DetailRecognitionSpec {
    /// Returns the number of touches per object, which is the sum of its training and test touches.
    pub(super) fn n_touches(&self) -> usize {
        self.training_touches + self.test_touches
    }
}

/// Method by which a model is made from a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DetailMethod {
    /// Exact mesh, which is the reference for all other methods and is always measured.
    Mesh,
    /// Spheres that fill the mesh (packing); one model for each tolerance.
    Packing,
    /// One sphere at each vertex of the mesh \[BT\].
    VertexSpheres,
    /// One sphere at each of n evenly spread vertices of the mesh. For each packing, n is the number of its spheres; if the mesh has fewer vertices, n is their
    /// number.
    DecimatedVertexSpheres,
    /// Largest spheres inside the mesh that touch the mesh at n points (medial spheres). For each packing, n is the number of its spheres.
    MedialSpheres,
}

fn default_ensemble() -> Ensemble {
    Ensemble::Sbhe
}
