//! Small and fast whole-body studies.

use crate::command::Case;
use bubbletouch::kinds;
use bubbletouch::kinds::whole_body::rows::{
    BodyCase, BodyCount, BodyRecognition, BodySensed, BodyStage, BodyTouch, Series, Stage, StepTime,
};
use bubbletouch::kinds::whole_body::{WholeBodyPlan, WholeBodyStudySpec};
use bubbletouch::report::csv_tables::read_rows;
use std::fs;

const ROBOT: &str = r#"<robot name="post">
  <link name="base">
    <collision><origin xyz="0 0 0.1"/><geometry><capsule radius="0.06" length="0.2"/></geometry></collision>
  </link>
  <link name="arm">
    <collision><origin xyz="0 0 -0.1"/><geometry><cylinder radius="0.03" length="0.2"/></geometry></collision>
    <collision><origin xyz="0 0 -0.2"/><geometry><sphere radius="0.03"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="arm"/><origin xyz="0 0.12 0.2"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="1" effort="1"/>
  </joint>
</robot>"#;

const STUDY: &str = r#"
question = "What does a post of skin cost?"
expected = "Little."
seed = 7

[whole_body]
robot = "robots/post.urdf"
pitch_mm = 3.0
patch_mm = 60.0
steps = 20
surface_error_mm = 0.5

[[whole_body.scenes]]
name = "nothing"
object = { name = "ball", object = "tennis_ball", centered = true, link = "base", at = { position_mm = [500.0, 0.0, 0.0] } }

[[whole_body.scenes]]
name = "ball"
depth_mm = 1.5
joints = { time_s = [0.0], positions = { shoulder_deg = [-90.0] } }

[whole_body.scenes.object]
name = "tennis"
object = "tennis_ball"
centered = true
link = "arm"
at = { position_mm = [30.0, 0.0, -100.0] }
motion = { oscillation = { linear_mm = [0.0, 0.0, 2.0], period_s = 0.04 } }

[[whole_body.scenes]]
name = "fingertip"
from = [0.0, 0.0, -1.0]
depth_mm = 1.0

[whole_body.scenes.object]
name = "finger"
parts = [{ shape = "capsule", diameter_mm = 16.0, length_mm = 40.0 }]
link = "arm"
at = { position_mm = [0.0, 0.0, -230.0], rotation_deg = [0.0, 20.0, 0.0] }

[whole_body.sensing]
measurements = 256
ensembles = ["sbhe", "sparse"]
sbhe_blocks = [32, 256]

[whole_body.recognition]
objects = ["tennis_ball", "cracker_box"]
link = "base"
at_mm = [60.0, 0.0, 100.0]
offset_mm = 3.0
yaw_deg = 10.0
depth_mm = [1.0, 1.8]
training_touches = 20
test_touches = 10

[whole_body.ladders]
taxels = [2000, 20000]
touched_at_taxels = [200, 900]
touched = [100, 400]
taxels_at_touch = 30000
spheres = [200, 600]
touched_at_spheres = 400
"#;

fn case(study: &str) -> Case {
    let case = Case::new();
    fs::create_dir(case.path("robots")).unwrap();
    case.file("robots/post.urdf", ROBOT);
    case.file("study.toml", study);
    case
}

#[test]
fn tables_obey_their_laws() {
    let case = case(STUDY);
    let (said, _) = case.succeeds(&["run", "study.toml", "--threads", "1", "--out", "1"]);
    assert!(
        said.contains("From touch to answer on 18118 taxels") && said.contains("bytes a taxel"),
        "{said}"
    );
    let read = |name: &str| fs::read_to_string(case.path("1").join(name)).unwrap();
    let cases: Vec<BodyCase> = read_rows(&case.path("1/whole_body.csv")).unwrap();
    let counts: Vec<BodyCount> = read_rows(&case.path("1/whole_body.csv")).unwrap();
    // 900 of 2,000 taxels are too many for a cushion.
    assert_eq!(cases.len(), 3 + 3 + 2 + 2);
    for (case, count) in cases.iter().zip(&counts) {
        assert_eq!(count.n_steps, 20);
        assert!(count.touched_min <= count.touched_max && count.bytes_per_taxel < 64.0);
        match (case.series, case.name.as_str()) {
            (Series::Scene, "nothing") => {
                assert_eq!((count.touched_max, count.deflection_sum_mm), (0, 0.0));
            }
            (Series::Scene, _) => assert!(count.touched_min > 3, "{case:?} {count:?}"),
            _ => {
                let asked: f64 = match case.series {
                    Series::Skin if case.name.ends_with(" 200 touched") => 200.0,
                    Series::Skin => 900.0,
                    Series::Touch if case.name == "100 touched" => 100.0,
                    _ => 400.0,
                };
                assert!((count.touched_mean / asked - 1.0).abs() < 0.1, "{case:?}");
            }
        }
        assert!(count.patches_touched_mean <= count.patches_visited_mean);
    }
    let sensed: Vec<BodySensed> = read_rows(&case.path("1/sensed.csv")).unwrap();
    assert_eq!(sensed.len(), 3 * 3, "scenes and compressions");
    for row in &sensed {
        assert_eq!(
            row.measurement_sum_mm == 0.0,
            row.scene == "nothing",
            "{row:?}"
        );
    }
    let learned: Vec<BodyRecognition> = read_rows(&case.path("1/recognition.csv")).unwrap();
    assert_eq!(learned.len(), 3);
    for row in &learned {
        assert_eq!((row.n_objects, row.n_training, row.n_test), (2, 40, 20));
        assert!(
            row.accuracy >= 0.9,
            "a ball and a box feel different: {row:?}"
        );
    }
    assert!(
        learned[0].read_fraction < learned[1].read_fraction,
        "larger blocks read more"
    );
    let timed: Vec<BodyCase> = read_rows(&case.path("1/timing.csv")).unwrap();
    let stages: Vec<BodyStage> = read_rows(&case.path("1/timing.csv")).unwrap();
    let times: Vec<StepTime> = read_rows(&case.path("1/timing.csv")).unwrap();
    assert_eq!(times.len(), 3 * (1 + 3 * 3) + 7);
    for ((case, of), time) in timed.iter().zip(&stages).zip(&times) {
        assert!(time.us_p05 <= time.us_median && time.us_median <= time.us_p95);
        assert_eq!(
            of.compression.is_empty(),
            of.stage == Stage::Press,
            "{case:?}"
        );
    }
    let steps: Vec<BodyTouch> = read_rows(&case.path("1/steps.csv")).unwrap();
    let times: Vec<StepTime> = read_rows(&case.path("1/steps.csv")).unwrap();
    assert_eq!(steps.len(), cases.len(), "one with all threads of each");
    for ((step, time), count) in steps.iter().zip(&times).zip(&counts) {
        assert_eq!(step.touched_mean, count.touched_mean);
        assert!((step.touched - step.touched_mean).abs() <= 0.05 * step.touched_mean);
        assert!((time.steps_per_s * time.us_median / 1e6 - 1.0).abs() < 1e-12);
    }
    for chart in [
        "time_by_taxels",
        "time_by_touched",
        "time_by_spheres",
        "time_by_stage",
    ] {
        let svg = read(&format!("{chart}.svg"));
        assert!(svg.contains("time of a step") && svg.contains("a millisecond"));
    }
    let page = read("report.html");
    assert!(page.contains("What does a post of skin cost?") && page.contains("timing.csv"));
    assert!(!page.contains("{{") && !page.contains("(no value"));
}

#[test]
fn scaling_points_are_named_and_grouped_by_what_was_measured() {
    let changed = STUDY
        .replace("taxels = [2000, 20000]", "taxels = [20000, 5000, 2000]")
        .replace(
            "touched_at_taxels = [200, 900]",
            "touched_at_taxels = [200, 6000]",
        )
        .replace("touched = [100, 400]", "touched = [100, 30000]")
        .replace("steps = 20", "steps = 5");
    let case = case(&changed);
    let (said, _) = case.succeeds(&["plan", "study.toml"]);
    assert!(said.contains("on a body of about 18118 taxels"), "{said}");
    case.succeeds(&["run", "study.toml", "--out", "1"]);
    let path = case.path("1/steps.csv");
    let cases: Vec<BodyCase> = read_rows(&path).unwrap();
    let steps: Vec<BodyTouch> = read_rows(&path).unwrap();
    let number = |text: &str| -> f64 { text.split(' ').next().unwrap().parse().unwrap() };
    let mut groups = Vec::new();
    for (case, step) in cases.iter().zip(&steps) {
        let about = format!("{case:?} {step:?}");
        match case.series {
            Series::Touch => {
                let named = number(&case.name);
                assert!((named / step.touched_mean - 1.0).abs() <= 0.05, "{about}");
            }
            Series::Skin => {
                assert_eq!(number(&case.name), case.n_taxels as f64, "{about}");
                let (_, touched) = case.name.split_once(", ").unwrap();
                assert_eq!(number(touched), step.touched, "{about}");
                groups.push(step.touched);
            }
            _ => {}
        }
    }
    // Of the sizes of one touch, all belong to one group.
    assert_eq!(groups[..3], [200.0; 3]);
    assert_eq!(groups.len(), 4);
}

#[test]
fn a_study_of_a_body_takes_no_objects_and_misses_none() {
    let case = case(STUDY);
    for command in ["plan", "run"] {
        let output = case.run(&[command, "study.toml", "--objects", "robots"]);
        assert_eq!(output.status.code(), Some(2), "{command}");
    }
    let away = STUDY.replace("[30.0, 0.0, -100.0]", "[900.0, 900.0, 0.0]");
    case.file("away.toml", away);
    let output = case.run(&["run", "away.toml", "--out", "1", "--fail-fast"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        output.status.code() == Some(2) && said.contains("scene ball, approach: no contact"),
        "{said}"
    );
}

#[test]
fn keys_of_a_body_study_that_are_out_of_range_are_named() {
    assert_eq!(kinds::about(STUDY).unwrap().table, "whole_body");
    let case = case(STUDY);
    let plan = |text: &str| {
        WholeBodyStudySpec::parse("study.toml", text)
            .and_then(|spec| WholeBodyPlan::new("study.toml", case.folder(), spec))
    };
    assert!(plan(STUDY).is_ok());
    for (old, new, said) in [
        (
            "pitch_mm = 3.0",
            "pitch_mm = 0.0",
            "key whole_body.pitch_mm: 0",
        ),
        ("steps = 20", "steps = 0", "key whole_body.steps: 0"),
        ("steps = 20", "stepps = 20", "unknown field `stepps`"),
        (
            "link = \"arm\"",
            "link = \"leg\"",
            "key whole_body.scenes[1].object.link: ",
        ),
        (
            "shoulder_deg = [-90.0]",
            "hip_deg = [-90.0]",
            "key whole_body.scenes[1].joints.positions: `hip_deg`",
        ),
        (
            "time_s = [0.0], positions = { shoulder_deg = [-90.0] }",
            "time_s = [0.0, 1.0], positions = { shoulder_deg = [0.0, 10.0] }",
            "key whole_body.scenes[1].joints: 2 times",
        ),
        (
            "motion = { oscillation = { linear_mm = [0.0, 0.0, 2.0], period_s = 0.04 } }",
            "motion = { phases = [{ duration_s = 1.0 }] }",
            "key whole_body.scenes[1].object.motion: phases",
        ),
        (
            "period_s = 0.04",
            "period_s = 0.0",
            "key whole_body.scenes[1].object.motion.oscillation.period_s: 0",
        ),
        (
            "name = \"tennis\"",
            "name = \"tennis\"\nfree = { mass_kg = 0.1 }",
            "key whole_body.scenes[1].object.free: given",
        ),
        (
            "name = \"tennis\"",
            "name = \"tennis\"\nrobot = \"other\"",
            "key whole_body.scenes[1].object.robot: `other`",
        ),
        (
            "object = \"tennis_ball\"\ncentered = true\nlink = \"arm\"",
            "object = \"tennis_balls\"\ncentered = true\nlink = \"arm\"",
            "key whole_body.scenes[1].object.object: object: `tennis_balls`",
        ),
        (
            "shape = \"capsule\"",
            "shape = \"torus\"",
            "key whole_body.scenes[2].object.parts, part 1 (torus): ",
        ),
        (
            "parts = [{ shape = \"capsule\", diameter_mm = 16.0, length_mm = 40.0 }]",
            "",
            "key whole_body.scenes[2].object.parts: ",
        ),
        (
            "depth_mm = 1.5",
            "depth_mm = -1.5",
            "key whole_body.scenes[1].depth_mm: -1.5",
        ),
        (
            "from = [0.0, 0.0, -1.0]",
            "from = [0.0, 0.0, 0.0]",
            "key whole_body.scenes[2].from",
        ),
        (
            "name = \"fingertip\"",
            "name = \"ball\"",
            "key whole_body.scenes: \"ball\" twice",
        ),
        (
            "[\"sbhe\", \"sparse\"]",
            "[\"gaussian\"]",
            "key whole_body.sensing.ensembles: Gaussian",
        ),
        (
            "[32, 256]",
            "[32, 100]",
            "key whole_body.sensing.sbhe_blocks: 100",
        ),
        (
            "[\"tennis_ball\", \"cracker_box\"]",
            "[\"mug\"]",
            "key whole_body.recognition.objects: one object",
        ),
        (
            "depth_mm = [1.0, 1.8]",
            "depth_mm = [1.8, 1.0]",
            "key whole_body.recognition.depth_mm",
        ),
        (
            "training_touches = 20",
            "training_touches = 0",
            "key whole_body.recognition.training_touches: 0",
        ),
        (
            "touched_at_taxels = [200, 900]",
            "touched_at_taxels = [200, 9000]",
            "key whole_body.ladders.touched_at_taxels: 9000; at most 8000",
        ),
        (
            "touched = [100, 400]",
            "touched = []",
            "key whole_body.ladders.touched: an empty list",
        ),
    ] {
        assert!(STUDY.contains(old), "{old}");
        let error = plan(&STUDY.replace(old, new)).unwrap_err().to_string();
        assert!(
            error.contains(said) && error.starts_with("study.toml"),
            "{error}"
        );
    }
    let missing = plan(&STUDY.replace("robots/post.urdf", "robots/none.urdf")).unwrap_err();
    assert!(
        missing.to_string().contains("none.urdf") && missing.exit_code() == 2,
        "{missing}"
    );
}
