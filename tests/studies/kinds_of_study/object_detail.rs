//! Packed meshes in studies, and object-detail studies.

use crate::command::{Case, says};
use crate::mesh_shapes::{cuboid, icosphere};
use bubbletouch::kinds::object_detail::DetailMethod;
use bubbletouch::kinds::object_detail::rows::{
    DetailConfiguration, DetailRecognition, DetailScore, DetailSummary, DetailTime,
};
use bubbletouch::mesh::TriangleMesh;
use bubbletouch::study::{Plan, StudySpec};
use glam::DVec3;
use std::fmt::Write;
use std::fs;

const DETAIL: &str = include_str!("../../fixtures/texts/object_detail_detail.toml");

const RECOGNITION: &str = include_str!("../../fixtures/texts/object_detail_recognition.toml");

fn ply(mesh: &TriangleMesh) -> String {
    let (vertices, triangles) = (mesh.vertices(), mesh.triangles());
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
        element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices.len(),
        triangles.len()
    );
    for v in vertices {
        writeln!(text, "{} {} {}", v.x, v.y, v.z).unwrap();
    }
    for [a, b, c] in triangles {
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    text
}

/// Creates a ball and a box, and a study of them.
fn case(study: &str) -> Case {
    let case = Case::with("study.toml", study);
    case.file("meshes/ball.ply", ply(&icosphere(0.03, 2)));
    let half = DVec3::new(0.02, 0.015, 0.01);
    case.file("meshes/box.ply", ply(&cuboid(half)));
    case
}

#[test]
fn a_study_of_packed_meshes_packs_once() {
    let case = case(RECOGNITION);
    case.succeeds("run study.toml --out 1");
    let kept = case.names_in("packings");
    assert_eq!(kept.len(), 2, "a packing each");
    // A packing that is computed again would be written again.
    let written = |name: &String| {
        let path = case.path("packings").join(name);
        path.metadata().unwrap().modified().unwrap()
    };
    let before: Vec<_> = kept.iter().map(written).collect();
    case.succeeds("run study.toml --out 2");
    assert_eq!(case.names_in("packings"), kept);
    assert_eq!(kept.iter().map(written).collect::<Vec<_>>(), before);
    // Without the cache, the packings are the same.
    case.create_folder("elsewhere");
    case.succeeds("run study.toml --out elsewhere/3");
    let names = ["accuracy.csv", "summary.csv", "confusion.csv", "study.toml"];
    case.same_files(["1", "2"], &names);
    case.same_files(["1", "elsewhere/3"], &names);
    let press = "press --mesh meshes/box.ply --model packed --surface-error-mm 2 --out a.csv";
    case.succeeds(press);
}

#[test]
fn packed_meshes_are_as_fine_as_a_tenth_of_the_finest_pitch_unless_a_study_says() {
    let settled = |text: &str| {
        let spec = StudySpec::parse("study.toml", text).unwrap();
        let plans = Plan::variants("study.toml", spec).unwrap();
        let all = plans
            .iter()
            .map(|(_, plan)| plan.spec.objects.surface_error_mm);
        let all: Vec<_> = all.collect();
        assert!(all.iter().all(|one| *one == all[0]), "{all:?}");
        all[0]
    };
    assert_eq!(settled(RECOGNITION), Some(2.0));
    let left_out = RECOGNITION.replace("surface_error_mm = 2.0\n", "");
    assert_eq!(settled(&left_out), Some(0.4));
    let sweep = left_out.replace("pitch_mm = 4.0", "pitch_mm = [4.0, 2.0]");
    assert_eq!(settled(&sweep), Some(0.2));
    let vertices = left_out.replace("model = \"packed\"\n", "");
    assert_eq!(settled(&vertices), Some(0.25));
}

#[test]
fn a_kept_packing_that_is_broken_is_named_and_made_again() {
    let case = case(RECOGNITION);
    case.succeeds("run study.toml --out 1");
    let name = case.names_in("packings").swap_remove(0);
    let kept = format!("packings/{name}");
    let whole = case.bytes(&kept);
    case.file(&kept, "x,y,z,r\n0,0,zero,1\n");
    let (_, said) = case.succeeds("run study.toml --out 2");
    says(&said, &[name]);
    assert!(whole == case.bytes(&kept));
    let table = |folder: &str| fs::read(case.path(folder).join("accuracy.csv")).unwrap();
    assert!(table("1") == table("2"));
}

#[test]
fn a_mesh_that_cannot_be_packed_is_named_with_what_it_lacks() {
    for study in [RECOGNITION, DETAIL] {
        let case = case(study);
        let closed = cuboid(DVec3::splat(0.02));
        let triangles = closed.triangles()[1..].to_vec();
        let open = TriangleMesh::new("open", closed.vertices().to_vec(), triangles).unwrap();
        case.file("meshes/open.ply", ply(&open));
        let said = case.refuses("run study.toml --out 1 --fail-fast");
        says(&said, &["open.ply: a hole ", "a closed mesh"]);
    }
}

#[test]
fn detail_tables_obey_their_laws() {
    let case = case(DETAIL);
    let (said, _) = case.succeeds("run study.toml --out 1");
    says(&said, &["Best deflection error: ", "model packing"]);
    let configurations: Vec<DetailConfiguration> = case.rows("1/object_detail.csv");
    let scores: Vec<DetailScore> = case.rows("1/object_detail.csv");
    assert_eq!(configurations.len(), 2 * (1 + 1 + 3 + 3 + 3));
    for (configuration, score) in configurations.iter().zip(&scores) {
        let about = format!("{configuration:?} {score:?}");
        assert_eq!((score.n_touches, score.n_missed), (8, 0), "{about}");
        assert!(score.n_taxels > 100, "{about}");
        assert!(score.error_after_offset_mm <= score.error_mm, "{about}");
        match (configuration.method, configuration.tolerance_mm) {
            (DetailMethod::Mesh, _) => {
                assert_eq!((score.error_mm, score.error_p95_mm), (0.0, 0.0), "itself");
                assert_eq!(score.error_own_contact_mm, 0.0);
                assert_eq!(configuration.n_spheres, 0);
            }
            (DetailMethod::Packing, Some(tolerance)) => {
                let farthest = score.protrusion_max_mm.max(score.gap_max_mm);
                assert!(farthest <= tolerance, "{about}");
            }
            _ => assert!(score.surface_error_mm > 0.0),
        }
    }
    let summary: Vec<DetailSummary> = case.rows("1/object_detail_summary.csv");
    let packed = summary.iter();
    let packed = packed.filter(|row| row.method == DetailMethod::Packing);
    let packed: Vec<&DetailSummary> = packed.collect();
    assert_eq!(packed.len(), 3);
    for pair in packed.windows(2) {
        assert!(pair[1].tolerance_mm < pair[0].tolerance_mm);
        // A finer packing is no worse.
        assert!(pair[1].error_median_mm <= pair[0].error_median_mm);
        assert_eq!(pair[1].times_packing, Some(1.0));
    }
    let times: Vec<DetailTime> = case.rows("1/timing.csv");
    assert_eq!(times.len(), configurations.len());
    assert!(times.iter().all(|time| time.us_per_touch > 0.0));
    for chart in ["surface_error_by_spheres", "deflection_error_by_spheres"] {
        let svg = case.read(&format!("1/{chart}.svg"));
        assert!(svg.contains("spheres an object") && svg.contains("(mm)"));
    }
    // Classifiers that were trained on models are tested on the meshes.
    let rows: Vec<DetailRecognition> = case.rows("1/object_detail_recognition.csv");
    // Levels and classifiers.
    assert_eq!(rows.len(), (1 + 1 + 3 + 3 + 3) * 2);
    for row in &rows {
        assert_eq!((row.n_objects, row.n_training, row.n_test), (2, 24, 16));
        assert!(row.accuracy_on_mesh_low <= row.accuracy_on_mesh);
        assert!(row.accuracy_on_mesh <= row.accuracy_on_mesh_high);
        // A classifier trained on coarse models distinguishes a ball and a box of the same coarseness.
        assert!(row.accuracy_on_itself >= 0.9, "{row:?}");
        if row.method == DetailMethod::Mesh {
            assert_eq!(row.accuracy_on_mesh, row.accuracy_on_itself);
        }
    }
    let svg = case.read("1/recognition_by_deflection_error.svg");
    assert!(svg.contains("median deflection error past own contact (mm)"));
    fs::remove_file(case.path("meshes/box.ply")).unwrap();
    case.refuses("run study.toml --out 2");
}
