//! A study of object detail that can run: every key checked, every unit SI.

use super::spec::{DetailMethod, ObjectDetailStudySpec};
use crate::error::Result;
use crate::study::check::{Check, positive};
use crate::study::plan::MM;
use crate::world::{Patch, Placement};
use std::path::{Path, PathBuf};

/// Settings of a study of object detail, ready to run.
#[derive(Clone, Debug)]
pub struct ObjectDetailPlan {
    /// As it was written.
    pub spec: ObjectDetailStudySpec,
    meshes: PathBuf,
    /// The array.
    pub patch: Patch,
    /// How touches are drawn.
    pub placement: Placement,
    /// How far packed spheres may be from a mesh, metres, as they were written.
    pub tolerances: Vec<f64>,
}

impl ObjectDetailPlan {
    /// Checks a study; the error names `place` (the file) and the first key that is out of its range.
    pub fn new(place: &str, spec: ObjectDetailStudySpec) -> Result<Self> {
        let check = Check { place };
        check.objects(&spec.objects)?;
        let meshes = match &spec.objects.meshes {
            Some(folder) if spec.objects.sets.is_empty() => folder.clone(),
            _ => {
                let allowed = "meshes alone (or --objects FOLDER): solids have no exact contact";
                return Err(check.error("objects", "sets of solids", allowed));
            }
        };
        if spec.objects.model.is_some() {
            let allowed = "no such key: object_detail.methods says what the meshes become";
            return Err(check.error("objects.model", "a model", allowed));
        }
        let patch = check.one_array(&spec.skin, "one pitch and one size")?;
        let placement = check.placement(&spec.touches)?;
        let wanted = &spec.object_detail;
        let key = "object_detail.tolerances_mm";
        let tolerances = check.list(key, wanted.tolerances_mm.clone())?;
        for &tolerance in &tolerances {
            let allowed = "positive numbers of millimetres";
            check.value(key, tolerance, positive, allowed)?;
        }
        let key = "object_detail.methods";
        check.list(key, wanted.methods.clone())?;
        if wanted.methods.contains(&DetailMethod::Mesh) {
            let allowed = "packing, vertex_spheres, decimated_vertex_spheres: the mesh is what they are compared with";
            return Err(check.error(key, "mesh", allowed));
        }
        check.positive_count("object_detail.surface_points", wanted.surface_points)?;
        Ok(Self {
            meshes,
            patch,
            placement,
            tolerances: tolerances.iter().map(|mm| mm * MM).collect(),
            spec,
        })
    }

    /// The folder of meshes.
    pub fn meshes(&self) -> &Path {
        &self.meshes
    }

    /// Models of each mesh, the mesh itself included.
    pub fn n_models(&self) -> usize {
        let levels = |method: &DetailMethod| match method {
            DetailMethod::Mesh | DetailMethod::VertexSpheres => 1,
            DetailMethod::Packing | DetailMethod::DecimatedVertexSpheres => self.tolerances.len(),
        };
        let methods = &self.spec.object_detail.methods;
        1 + methods.iter().map(levels).sum::<usize>()
    }
}
