//! What the pieces of a study of object detail are planned to take, for the time left.

use super::runner::ObjectDetailStudy;
use crate::study::object_files::NamedMesh;
use crate::study::time_left::Piece;

/// Seconds for an object's models, a metre of the side of a square as large as its surface: the median of 37 scans of the YCB set, which
/// took 5 to 91 s. The logarithm of their times goes with that of their surfaces with a slope of 0.52 and a correlation of 0.76.
const MODELS_S_PER_M: f64 = 170.0;
/// Seconds to compare an object's models with its mesh, to feel them, and to time them, and for a classifier.
const SCORE_S: f64 = 1.0;
const FEEL_S: f64 = 0.3;
const TIME_S: f64 = 0.3;
const RECOGNISE_S: f64 = 0.5;

/// Stages.
const MODELS: u8 = 0;
const TIMES: u8 = 1;
const LEARN: u8 = 2;

impl ObjectDetailStudy {
    /// To pack a larger surface takes longer.
    pub(super) fn model_work(&self, mesh: &NamedMesh) -> Piece {
        Piece::of_stage(MODELS, MODELS_S_PER_M * mesh.mesh.area().sqrt())
    }

    /// Each other kind of work of an object takes about as long for every mesh.
    pub(super) fn score_work(&self) -> Piece {
        Piece::of_stage(MODELS, SCORE_S)
    }

    pub(super) fn feel_work(&self) -> Piece {
        Piece::of_stage(MODELS, FEEL_S)
    }

    pub(super) fn time_work(&self) -> Piece {
        Piece::one_by_one(TIMES, TIME_S)
    }

    pub(super) fn recognition_work(&self) -> Piece {
        Piece::of_stage(LEARN, RECOGNISE_S)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriangleMesh;
    use crate::study::object_detail::{ObjectDetailPlan, ObjectDetailStudySpec};
    use glam::DVec3;

    const STUDY: &str = r#"
        question = "How many spheres?"
        [objects]
        meshes = "meshes"
        [skin]
        pitch_mm = 2.0
        taxels = 8
        stroke_mm = 5.0
        [touches]
        per_object = 1
        depth_mm = 3.0
        [object_detail]
        tolerances_mm = [1.0]
        methods = ["packing"]
        surface_points = 10
    "#;

    /// A tetrahedron with three edges along the axes, of so many metres.
    fn corner(name: &str, edge: f64) -> NamedMesh {
        let vertices = vec![
            DVec3::ZERO,
            edge * DVec3::X,
            edge * DVec3::Y,
            edge * DVec3::Z,
        ];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        NamedMesh {
            name: name.to_owned(),
            place: name.to_owned(),
            mesh: TriangleMesh::new(name, vertices, triangles).unwrap(),
        }
    }

    #[test]
    fn models_of_a_mesh_twice_as_wide_are_planned_to_take_twice_as_long() {
        let spec = ObjectDetailStudySpec::parse("study", STUDY).unwrap();
        let study = ObjectDetailStudy {
            plan: ObjectDetailPlan::new("study", spec).unwrap(),
            meshes: vec![corner("small", 0.1), corner("large", 0.2)],
            packings: None,
        };
        let planned_s = |mesh: &NamedMesh| study.model_work(mesh).planned_s;
        let [small_s, large_s] = [0, 1].map(|at| planned_s(&study.meshes[at]));
        assert!(
            (large_s - 2.0 * small_s).abs() < 1e-9,
            "{small_s} {large_s}"
        );
        // Of the scans of the YCB set the one in the middle, 206 cm², took half a minute.
        assert!((20.0..30.0).contains(&(MODELS_S_PER_M * 0.0206f64.sqrt())));
    }
}
