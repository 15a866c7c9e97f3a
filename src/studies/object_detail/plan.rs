//! Plan of an object-detail study: checked keys, converted to SI units.

use crate::error::Result;
use crate::inputs::check::Check;
use crate::inputs::keys::KeyAbout;
use crate::inputs::params::keys_of;
use crate::studies::object_detail::spec::{
    DetailMethod, DetailRecognitionSpec, ObjectDetailStudySpec,
};
use crate::studies::recognition::plan::taxel_array::TaxelArray;
use crate::studies::recognition::spec::keys::keys_without_axes;
use crate::world::Placement;
use std::path::PathBuf;

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

/// Returns the descriptions of all keys of an object-detail study.
pub fn object_detail_keys() -> Vec<KeyAbout> {
    keys_without_axes(keys_of::<ObjectDetailStudySpec>(), &["object_detail"])
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
        let array = check.one_array(&spec.skin, "one pitch and one size")?;
        spec.objects.settle_sizes(std::slice::from_ref(&array));
        if spec.objects.surface_error_mm.is_some() {
            let allowed = "no such key: object_detail.tolerances_mm says how far spheres may be from the meshes";
            return Err(check.error("objects.surface_error_mm", "a surface error", allowed));
        }
        let placement = check.placement(&spec.touches)?;
        let of_force = "no such key: the study compares deflections at rest";
        check.used_springs((&spec.skin, &spec.touches), false, of_force)?;
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
