//! Keys of an object-detail study, and its plan: the checked values in SI units.

use crate::studies::prelude::*;
use std::path::PathBuf;

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

/// Checked keys of an object-detail study, converted to SI units.
#[derive(Clone, Debug)]
pub struct ObjectDetailPlan {
    /// Specification of the study, with the keys, values and units of the study file.
    pub spec: ObjectDetailStudySpec,
    /// Folder of the objects' mesh files.
    pub meshes: PathBuf,
    /// Array of taxels that touches the objects.
    pub array: TaxelArray,
    /// Distribution from which the poses of touches are drawn.
    pub placement: Placement,
}

impl ObjectDetailPlan {
    /// Creates the plan of a study and checks all its keys.
    ///
    /// # Errors
    /// If a key is out of its range; the error names `place` (the file) and the first such key.
    pub fn new(place: &str, mut spec: ObjectDetailStudySpec) -> Result<Self> {
        let check = Check { place };
        check.objects(&spec.objects)?;
        let meshes = match &spec.objects.meshes {
            Some(folder) if spec.objects.sets.is_empty() => folder.to_path_buf(),
            _ => {
                let allowed = "meshes alone (or --objects FOLDER): solids have no exact contact";
                return Err(check.error("objects", "sets of solids", allowed));
            }
        };
        if spec.objects.model.is_some() {
            let allowed = "no such key: object_detail.methods says what the meshes become";
            return Err(check.error("objects.model", "a model", allowed));
        }
        let array = check.grid(&spec.skin)?;
        spec.objects.settle_sizes(std::slice::from_ref(&array));
        if spec.objects.surface_error_mm.is_some() {
            let allowed = "no such key: object_detail.tolerances_mm says how far spheres may be from the meshes";
            return Err(check.error("objects.surface_error_mm", "a surface error", allowed));
        }
        let placement = check.placement(&spec.touches)?;
        let of_force = "no such key: the study compares deflections at rest";
        check.used_keys(&spec, (&spec.skin, &spec.touches), Some(of_force))?;
        let wanted = &spec.object_detail;
        check.keys("object_detail", wanted, keys_of::<ObjectDetailStudySpec>())?;
        if wanted.methods.contains(&DetailMethod::Mesh) {
            let allowed = "packing, vertex_spheres, decimated_vertex_spheres, medial_spheres: the mesh is what they are compared with";
            return Err(check.error("object_detail.methods", "mesh", allowed));
        }
        let recognition = wanted.recognition.as_ref();
        recognition.map_or(Ok(()), |wanted| check_recognition(&check, wanted, &array))?;
        Ok(Self {
            meshes,
            array,
            placement,
            spec,
        })
    }

    /// Returns the keys of `[object_detail.recognition]`; `None` if the study has no such table.
    pub fn recognition(&self) -> Option<&DetailRecognitionSpec> {
        self.spec.object_detail.recognition.as_ref()
    }
}

fn check_recognition(
    check: &Check,
    wanted: &DetailRecognitionSpec,
    array: &TaxelArray,
) -> Result<()> {
    let key = |name: &str| format!("object_detail.recognition.{name}");
    check.drawn(&key("ensemble"), [wanted.ensemble])?;
    let n_measurements = wanted.measurements;
    let n_taxels = array.n_taxels();
    if n_measurements > n_taxels {
        let allowed = format!("at most {n_taxels}, the taxels of the array");
        return Err(check.error(&key("measurements"), n_measurements, allowed));
    }
    let n_touches = wanted.n_touches();
    // Memory of two objects, the minimum; more objects need more.
    let bytes = 16.0 * n_touches as f64 * n_measurements as f64;
    let what = "the measurements of all touches";
    check.memory(&key("training_touches"), n_touches, bytes, what)
}
