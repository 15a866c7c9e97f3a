//! Specification of an object-detail study: the keys of its TOML file.

use crate::inputs::objects_spec::ObjectsSpec;
use crate::inputs::params::{params, words};
use crate::inputs::range::Range::{Any, Count};
use crate::inputs::range::{SURFACE_ERROR, TOUCHES};
use crate::learning::classifiers::ClassifierKind;
use crate::sensing::Ensemble;
use crate::studies::recognition::spec::scene::{SkinSpec, TouchesSpec};
use crate::study_file::study_file;

study_file! {
pub struct ObjectDetailStudySpec {
    /// Table `[objects]`: the touched objects, given as meshes.
    objects: ObjectsSpec;
    /// Table `[skin]`: a single array of taxels.
    skin: SkinSpec;
    /// Table `[touches]`: poses and depths of the touches.
    touches: TouchesSpec;
    /// Table `[object_detail]`: models that replace the meshes.
    object_detail: ObjectDetailSpec;
} }

/// Maximum number of mesh points at which distances are measured; all points are kept in memory.
const MAX_POINTS: usize = 10_000_000;

params! {
    /// Keys of `[object_detail]`: models that replace the meshes, and their comparison with the meshes.
    pub struct ObjectDetailSpec {
        /// Tolerances of the packing (maximum distance between spheres and mesh surface), mm, each at least 1e-6.
        tolerances_mm: Vec<f64> => SURFACE_ERROR, Choice, Table;
        /// Methods that make models from the meshes.
        methods: Vec<DetailMethod> => Any, Choice, Table;
        /// Number of points of a mesh at which the distance to the spheres is measured, at least 1. Default: 5000.
        surface_points: usize = 5000 => Count(1, MAX_POINTS), Note, Never;
        /// Table `[object_detail.recognition]`: classifiers that are trained on models and tested on meshes. Default: none.
        recognition: Option<DetailRecognitionSpec>;
    }
}

params! {
    /// Keys of `[object_detail.recognition]`: classifiers that are trained on models and tested on meshes.
    pub struct DetailRecognitionSpec {
        /// Number of training touches per object, at least 1, drawn as in `[touches]`.
        training_touches: usize => TOUCHES, Choice, Never;
        /// Number of test touches per object, in addition to the training touches, at least 1.
        test_touches: usize => TOUCHES, Condition, Never;
        /// Ensemble of the measurement matrix that compresses the frames. Default: `sbhe`.
        ensemble: Ensemble = Ensemble::Sbhe => Any, Choice, Never;
        /// Number m of measurements per frame, at least 1.
        measurements: usize => TOUCHES, Choice, Never;
        /// Kinds of classifiers to train, each with its default parameters.
        classifiers: Vec<ClassifierKind> => Any, Choice, Table;
    }
}

impl DetailRecognitionSpec {
    /// Returns the number of touches per object, which is the sum of its training and test touches.
    pub(super) fn n_touches(&self) -> usize {
        self.training_touches + self.test_touches
    }
}

words! {
    /// Method by which a model is made from a mesh.
    pub enum DetailMethod {
        /// Exact mesh, which is the reference for all other methods and is always measured.
        Mesh = "mesh",
        /// Spheres that fill the mesh (packing); one model for each tolerance.
        Packing = "packing",
        /// One sphere at each vertex of the mesh \[BT\].
        VertexSpheres = "vertex_spheres",
        /// One sphere at each of n evenly spread vertices of the mesh. For each packing, n is the number of its spheres; if the mesh has fewer vertices, n is their
        /// number.
        DecimatedVertexSpheres = "decimated_vertex_spheres",
        /// Largest spheres inside the mesh that touch the mesh at n points (medial spheres). For each packing, n is the number of its spheres.
        MedialSpheres = "medial_spheres",
    }
}
