//! A small study of every kind that is made of pieces.
// Each test file uses its part of this.
#![allow(dead_code)]

use crate::command::Case;
use std::fs;

/// A study, and what is known of it.
pub struct Kind {
    pub study: &'static str,
    /// Its tables without times; the first of them has a row of every kind of piece or of most.
    pub repeatable: &'static [&'static str],
    /// A table of times that were measured.
    pub times: &'static str,
    /// What of the study is replaced by what, and what is said of that.
    pub change: (&'static str, &'static str, &'static str),
    /// What of the study is replaced by what that only adds work to it.
    pub more: &'static [(&'static str, &'static str)],
}

impl Kind {
    /// A folder with the study and all that any of them needs.
    pub fn case(&self) -> Case {
        let case = Case::new();
        fs::create_dir(case.path("robots")).unwrap();
        case.file("robots/post.urdf", ROBOT);
        fs::create_dir(case.path("meshes")).unwrap();
        case.file("meshes/box.obj", cuboid([0.02, 0.015, 0.01]));
        case.file("meshes/plate.obj", cuboid([0.03, 0.02, 0.006]));
        case.file("study.toml", self.study);
        case
    }

    pub const STABILITY: Self = Self {
        study: include_str!("stability.toml"),
        repeatable: &["stability.csv", "stability_summary.csv"],
        times: "timing.csv",
        change: (
            "question = \"What breaks?\"",
            "question = \"What breaks?\"\n[stability]\npitch_mm = 5.0",
            "stability.pitch_mm: was 4.0, is 5.0",
        ),
        more: &[
            ("What breaks?", "What breaks first?"),
            ("[1e1, 1e5]", "[1e1, 1e3, 1e5]"),
            ("[1e-4, 1e-1]", "[1e-3, 1e-4, 1e-1]"),
        ],
    };

    pub const BREAKING_POINTS: Self = Self {
        study: include_str!("breaking_points.toml"),
        repeatable: &["accuracy.csv", "summary.csv", "breaking_points.csv"],
        times: "timing.csv",
        change: ("trials = 2", "trials = 3", "trials: was 2, is 3"),
        more: &[
            ("What breaks?", "What breaks first?"),
            (
                "[0.0, 0.005, 0.05, 0.5, 10.0]",
                "[0.0, 0.005, 0.05, 0.1, 0.5, 10.0]",
            ),
            ("[0.0, 5.0, 20.0, 80.0]", "[0.0, 2.0, 5.0, 20.0, 80.0]"),
        ],
    };

    pub const RECONSTRUCTION: Self = Self {
        study: include_str!("reconstruction.toml"),
        repeatable: &["reconstruction.csv", "ensembles.csv"],
        times: "timing.csv",
        change: (
            "atoms = 40",
            "atoms = 41",
            "reconstruction.atoms: was 40, is 41",
        ),
        more: &[
            ("What comes back?", "How much comes back?"),
            ("ratio = [4, 16]", "ratio = [2, 4, 16]"),
            ("[0.0, 0.1]", "[0.05, 0.0, 0.1]"),
            ("[\"dct\", \"pca\"]", "[\"haar\", \"dct\", \"pca\"]"),
        ],
    };

    pub const OBJECT_DETAIL: Self = Self {
        study: include_str!("object_detail.toml"),
        repeatable: &[
            "object_detail.csv",
            "object_detail_recognition.csv",
            "object_detail_summary.csv",
        ],
        times: "timing.csv",
        change: (
            "tolerances_mm = [2.0]",
            "tolerances_mm = [3.0]",
            "object_detail.tolerances_mm: was",
        ),
        more: &[
            ("How many spheres?", "How many spheres are enough?"),
            ("[\"linear_svm\"]", "[\"k_nearest\", \"linear_svm\"]"),
        ],
    };

    pub const WHOLE_BODY: Self = Self {
        study: include_str!("whole_body.toml"),
        repeatable: &["whole_body.csv", "recognition.csv", "sensed.csv"],
        times: "timing.csv",
        change: (
            "steps = 10",
            "steps = 11",
            "whole_body.steps: was 10, is 11",
        ),
        more: &[
            ("What does a post", "How much does a post"),
            (
                "[[whole_body.scenes]]\nname = \"ball\"",
                "[[whole_body.scenes]]\nname = \"box\"\nobject = \"cracker_box\"\nlink = \"base\"\nat_mm = [60.0, 0.0, 100.0]\ndepth_mm = 1.0\n\n[[whole_body.scenes]]\nname = \"ball\"",
            ),
            ("touched = [100, 400]", "touched = [100, 200, 400]"),
        ],
    };

    pub const SPEED_ACCURACY: Self = Self {
        study: include_str!("speed_accuracy.toml"),
        repeatable: &["contact.csv", "recognition.csv", "resolution.csv"],
        times: "recognition_timing.csv",
        change: (
            "stepped_touches = 1",
            "stepped_touches = 2",
            "speed_accuracy.contact.stepped_touches: was 1, is 2",
        ),
        more: &[
            ("What does accuracy cost?", "How much does accuracy cost?"),
            ("dt_ms = [10.0]", "dt_ms = [5.0, 10.0]"),
            ("[4.0, 16.0]\nclassifier", "[4.0, 8.0, 16.0]\nclassifier"),
            ("touches = [8, 12]", "touches = [10, 8, 12]"),
        ],
    };
}

/// A way whose last value leaves nothing to learn from.
pub const IMBALANCED: &str = include_str!("imbalanced.toml");

const ROBOT: &str = r#"<robot name="post">
  <link name="base">
    <collision><origin xyz="0 0 0.1"/><geometry><capsule radius="0.06" length="0.2"/></geometry></collision>
  </link>
</robot>"#;

/// A closed box of these half sides, metres, as OBJ: 8 lines of corners and 12 of triangles.
fn cuboid(half: [f64; 3]) -> String {
    const TRIANGLES: [[usize; 3]; 12] = [
        [1, 2, 4],
        [1, 4, 3],
        [5, 7, 8],
        [5, 8, 6],
        [1, 5, 6],
        [1, 6, 2],
        [3, 4, 8],
        [3, 8, 7],
        [1, 3, 7],
        [1, 7, 5],
        [2, 6, 8],
        [2, 8, 4],
    ];
    let corner = |number: usize| {
        let side = |axis: usize| half[axis] * [-1.0, 1.0][number >> (2 - axis) & 1];
        format!("v {} {} {}\n", side(0), side(1), side(2))
    };
    let triangle = |[a, b, c]: &[usize; 3]| format!("f {a} {b} {c}\n");
    (0..8)
        .map(corner)
        .chain(TRIANGLES.iter().map(triangle))
        .collect()
}
