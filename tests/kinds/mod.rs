//! A small study of every kind that is made of pieces.

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
        study: r#"
question = "What breaks?"

[[stability.parts]]
scene = "rest"
methods = ["quasi_static", "implicit_euler", "semi_implicit"]
taxels = 8
stiffness_n_per_m = [1e1, 1e5]
object_mass_kg = [1e-3, 1e3]
taxel_mass_kg = 1e-2
dt_s = [1e-3, 1e-1]

[[stability.parts]]
scene = "press"
methods = ["quasi_static", "implicit_euler", "semi_implicit"]
taxels = 8
stiffness_n_per_m = 1e3
taxel_mass_kg = [1e-6, 1e-2]
dt_s = [1e-4, 1e-1]
"#,
        repeatable: &["stability.csv", "stability_summary.csv"],
        times: "timing.csv",
        change: ("[1e1, 1e5]", "[1e1, 1e4]", "stability.parts: was"),
    };

    pub const BREAKING_POINTS: Self = Self {
        study: r#"
question = "What breaks?"
trials = 2

[objects]
sets = ["cans"]
surface_error_mm = 2.0

[skin]
pitch_mm = 8.0
size_mm = 128.0
stroke_mm = 5.0

[touches]
per_object = 24
offset_x_mm = { uniform = [-5.0, 5.0] }
depth_mm = { uniform = [2.0, 4.0] }

[sensing]
ratio = 4

[recognition]
classifier = ["linear_svm", "k_nearest"]

[[breaking_points]]
name = "noise"
label = "noise (share of full scale)"
keys = ["signal.noise_std_full_scale"]
values = [0.0, 0.005, 0.05, 0.5, 10.0]

[[breaking_points]]
name = "place"
label = "test touches off the middle, up to (mm)"
keys = ["touches.offset_x_mm", "touches.offset_y_mm"]
values = [0.0, 5.0, 20.0, 80.0]
as = "half_width"
touches = "test"
"#,
        repeatable: &["accuracy.csv", "summary.csv", "breaking_points.csv"],
        times: "timing.csv",
        change: ("trials = 2", "trials = 3", "trials: was 2, is 3"),
    };

    pub const RECONSTRUCTION: Self = Self {
        study: r#"
question = "What comes back?"
seed = 7

[objects]
sets = ["household"]
names = ["mug", "banana", "scissors", "power_drill"]
surface_error_mm = 2.0

[skin]
pitch_mm = 4.0
taxels = 16
stroke_mm = 5.0

[touches]
per_object = 20
offset_x_mm = { uniform = [-8.0, 8.0] }
depth_mm = { uniform = [2.0, 4.0] }

[signal]
noise_std_full_scale = [0.0, 0.1]

[sensing]
ensemble = ["sbhe", "identity"]
ratio = [4, 16]

[reconstruction]
solver = ["omp", "lmmse"]
dictionary = ["dct", "pca"]
atoms = 40
isometry_sparsity = 4
isometry_subsets = 30
"#,
        repeatable: &["reconstruction.csv", "ensembles.csv"],
        times: "timing.csv",
        change: ("ratio = [4, 16]", "ratio = [4, 8]", "sensing.ratio: was"),
    };

    pub const OBJECT_DETAIL: Self = Self {
        study: r#"
question = "How many spheres?"
seed = 7

[objects]
meshes = "meshes"

[skin]
pitch_mm = 2.0
taxels = 16
stroke_mm = 5.0

[touches]
per_object = 6
offset_x_mm = { uniform = [-4.0, 4.0] }
depth_mm = 3.0

[object_detail]
tolerances_mm = [2.0]
methods = ["packing", "decimated_vertex_spheres"]
surface_points = 500

[object_detail.recognition]
training_touches = 10
test_touches = 6
measurements = 16
classifiers = ["linear_svm"]
"#,
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
    };

    pub const WHOLE_BODY: Self = Self {
        study: r#"
question = "What does a post of skin cost?"
seed = 7

[whole_body]
robot = "robots/post.urdf"
pitch_mm = 3.0
patch_mm = 60.0
steps = 10
surface_error_mm = 1.0

[[whole_body.scenes]]
name = "nothing"
object = "tennis_ball"
link = "base"
at_mm = [500.0, 0.0, 0.0]

[[whole_body.scenes]]
name = "ball"
object = "tennis_ball"
link = "base"
at_mm = [60.0, 0.0, 100.0]
depth_mm = 1.5
moves_mm = [0.0, 0.0, 2.0]
period_ms = 40.0

[whole_body.sensing]
measurements = 64
ensembles = ["sbhe"]
sbhe_blocks = [32, 256]

[whole_body.recognition]
objects = ["tennis_ball", "cracker_box"]
link = "base"
at_mm = [60.0, 0.0, 100.0]
offset_mm = 3.0
yaw_deg = 10.0
depth_mm = [1.0, 1.8]
training_touches = 10
test_touches = 5

[whole_body.ladders]
taxels = [2000, 20000]
touched_at_taxels = [200]
touched = [100, 400]
taxels_at_touch = 30000
spheres = [200, 600]
touched_at_spheres = 400
"#,
        repeatable: &["whole_body.csv", "recognition.csv", "sensed.csv"],
        times: "timing.csv",
        change: (
            "steps = 10",
            "steps = 11",
            "whole_body.steps: was 10, is 11",
        ),
    };

    pub const SPEED_ACCURACY: Self = Self {
        study: r#"
question = "What does accuracy cost?"

[objects]
sets = ["cans"]

[skin]
pitch_mm = 4.0
taxels = 16
stroke_mm = 5.0

[touches]
offset_x_mm = { uniform = [-10.0, 10.0] }
tilt_x_deg = { uniform = [-5.0, 5.0] }
depth_mm = 3.0

[speed_accuracy]
tolerances_mm = [0.5, 1.0]

[speed_accuracy.contact]
objects = 3
touches = 3
stepped_objects = 1
stepped_touches = 1
dt_ms = [10.0]

[speed_accuracy.recognition]
objects = 4
pitch_mm = [4.0, 8.0]
size_mm = 64.0
tolerances_mm = [1.0]
ensemble = ["gaussian"]
ratio = [4.0, 16.0]
classifier = ["linear_svm", "k_nearest"]
noise_std_full_scale = 0.01
training_touches = 10
test_touches = 6
timed_touches = 5

[speed_accuracy.resolution]
touches = [8, 12]
trials = [2, 3]
ratio = [4.0, 16.0]
"#,
        repeatable: &["contact.csv", "recognition.csv", "resolution.csv"],
        times: "recognition_timing.csv",
        change: (
            "dt_ms = [10.0]",
            "dt_ms = [5.0]",
            "speed_accuracy.contact.dt_ms: was",
        ),
    };
}

/// A way whose last value leaves nothing to learn from.
pub const IMBALANCED: &str = r#"
question = "What if some values cannot be?"
trials = 1

[objects]
sets = ["cans"]
surface_error_mm = 2.0

[skin]
pitch_mm = 8.0
size_mm = 128.0
stroke_mm = 5.0

[touches]
per_object = 12
depth_mm = { uniform = [2.0, 4.0] }

[sensing]
ratio = 4

[recognition]
classifier = "linear_svm"

[[breaking_points]]
name = "imbalance"
label = "class imbalance"
keys = ["recognition.class_imbalance"]
values = [1.0, 2.0, 4.0, 1000.0]
"#;

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
