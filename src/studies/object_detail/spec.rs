//! A study of object detail as it is written.

use crate::inputs::defaults::count;
use crate::inputs::objects_spec::ObjectsSpec;
use crate::learning::classifiers::ClassifierKind;
use crate::sensing::Ensemble;
use crate::studies::recognition::spec::scene::{SkinSpec, TouchesSpec};
use crate::study_file::study_file;
use serde::{Deserialize, Serialize};

study_file! {
pub struct ObjectDetailStudySpec {
    /// What is touched: meshes.
    pub objects: ObjectsSpec,
    /// What touches; one array.
    pub skin: SkinSpec,
    /// How it touches.
    pub touches: TouchesSpec,
    /// What the meshes become.
    pub object_detail: ObjectDetailSpec,
} }

/// `[object_detail]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectDetailSpec {
    /// How far packed spheres may be from the mesh, mm: one level each.
    pub tolerances_mm: Vec<f64>,
    /// What stands for the mesh.
    pub methods: Vec<DetailMethod>,
    /// Points of a mesh at which the distance to the spheres is measured.
    #[serde(default = "count::<5000>")]
    pub surface_points: usize,
    /// Classifiers that learn from the models and are tested on the meshes; none when left out.
    #[serde(default)]
    pub recognition: Option<DetailRecognitionSpec>,
}

/// `[object_detail.recognition]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DetailRecognitionSpec {
    /// Touches of each object that train, drawn as the study's touches are.
    pub training_touches: usize,
    /// Further touches of each object that test.
    pub test_touches: usize,
    /// How frames are compressed.
    #[serde(default = "default_ensemble")]
    pub ensemble: Ensemble,
    /// To how many measurements.
    pub measurements: usize,
    /// What learns; with the parameters of [`Classifier::new`](crate::learning::classifiers::classifier::Classifier::new).
    pub classifiers: Vec<ClassifierKind>,
}

impl DetailRecognitionSpec {
    /// Touches of each object, those that test included.
    pub(super) fn n_touches(&self) -> usize {
        self.training_touches + self.test_touches
    }
}

/// What stands for a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DetailMethod {
    /// The mesh itself, touched exactly: what the others are compared with. Measured in any case.
    Mesh,
    /// Spheres within each tolerance.
    Packing,
    /// One sphere a vertex \[BT\].
    VertexSpheres,
    /// The same around so many of the vertices, spread evenly, as each packing has spheres (all vertices if it has more).
    DecimatedVertexSpheres,
    /// The largest spheres inside the mesh that touch it at as many points as each packing has spheres
    /// ([`medial_spheres`](crate::packing::medial_spheres)).
    MedialSpheres,
}

fn default_ensemble() -> Ensemble {
    Ensemble::Sbhe
}
