//! The study of what accuracy costs, and the advisor.

use crate::command::Case;
use bubbletouch::kinds;
use bubbletouch::kinds::speed_accuracy::rows::{
    ChainScore, ChainTime, ContactCell, ContactPoint, ContactScore, ContactWay,
};
use bubbletouch::kinds::speed_accuracy::{SpeedAccuracyPlan, SpeedAccuracyStudySpec};
use bubbletouch::report::csv_tables::read_rows;
use std::fs;
use std::path::Path;

const QUICK: &str = r#"
question = "What does accuracy cost?"

[objects]
sets = ["cans"]

[skin]
pitch_mm = 4.0
taxels = 16
stroke_mm = 5.0

[touches]
offset_x_mm = { uniform = [-10.0, 10.0] }
offset_y_mm = { uniform = [-10.0, 10.0] }
tilt_x_deg = { uniform = [-5.0, 5.0] }
depth_mm = 3.0

[speed_accuracy]
tolerances_mm = [0.2, 1.0]

[speed_accuracy.contact]
objects = 3
touches = 3
stepped_objects = 1
stepped_touches = 1
dt_ms = [10.0, 1.0]
peers = "peers.csv"

[speed_accuracy.recognition]
objects = 4
pitch_mm = [4.0, 8.0]
size_mm = 64.0
tolerances_mm = [1.0]
ensemble = ["gaussian", "block_average"]
ratio = [4.0, 16.0]
classifier = ["linear_svm", "k_nearest"]
noise_std_full_scale = 0.01
training_touches = 12
test_touches = 6
timed_touches = 5
"#;

const PEERS: &str = "date,program,version,method,setting,object,us_per_touch,error_mm\n\
                     2026-11-22,MuJoCo,4.0.0,mujoco_tactile,octree depth 6,can,400.0,0.05\n";

#[test]
fn every_point_is_a_row_fronts_are_fronts_and_threads_change_no_byte_but_times() {
    let case = Case::new();
    case.file("study.toml", QUICK);
    case.file("peers.csv", PEERS);
    let (said, _) = case.succeeds(&["run", "study.toml", "--threads", "1", "--out", "1"]);
    assert!(
        said.contains("against the time of a touch, the front:"),
        "{said}"
    );
    case.succeeds(&["run", "study.toml", "--threads", "2", "--out", "2"]);
    for name in ["contact.csv", "recognition.csv", "study.toml"] {
        let [one, two] = ["1", "2"].map(|folder| fs::read(case.path(folder).join(name)).unwrap());
        assert!(!one.is_empty() && one == two, "{name}");
    }
    let contact = case.path("1/contact.csv");
    let cells: Vec<ContactCell> = read_rows(&contact).unwrap();
    let scores: Vec<ContactScore> = read_rows(&contact).unwrap();
    let mean = |way, tolerance_mm| {
        let of_it = cells.iter().zip(&scores);
        let of_it = of_it.filter(|(c, _)| c.way == way && c.tolerance_mm == tolerance_mm);
        let errors: Vec<f64> = of_it.filter_map(|(_, score)| score.error_mm).collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    };
    let [coarse, fine] = [1.0, 0.2].map(|mm| mean(ContactWay::PackedSpheres, Some(mm)));
    assert!(
        fine < coarse && fine > 0.0 && fine < 0.2 && coarse < 1.0,
        "{fine} {coarse}"
    );
    // Singles are as right as doubles, beside the error of the model.
    let [doubles, singles] =
        [ContactWay::RowsInDoubles, ContactWay::RowsInSingles].map(|way| mean(way, Some(0.2)));
    assert!(
        (doubles - fine).abs() < 1e-9 && (singles - doubles).abs() < 1e-4,
        "{doubles} {singles} {fine}"
    );
    // Steps of the quasi-static model end where one evaluation does.
    let stepped = mean(ContactWay::TimeSteps, Some(0.2));
    assert!((stepped - fine).abs() < fine, "{stepped} {fine}");
    let contact: Vec<ContactPoint> = read_rows(&case.path("1/contact_pareto.csv")).unwrap();
    let peer = contact.iter().find(|p| p.source.starts_with("MuJoCo"));
    let peer = peer.unwrap();
    assert_eq!((peer.us_per_touch, peer.error_mm), (400.0, 0.05));
    let times: Vec<ChainTime> = read_rows(&case.path("1/pareto.csv")).unwrap();
    assert_eq!(times.len(), 2 * 2 * 2 * 2);
    for time in times {
        let parts = time.sense_us + time.project_us + time.classify_us;
        assert!(parts == time.decision_us && time.fit_s > 0.0, "{time:?}");
    }
    for name in ["contact", "decision", "training"] {
        let svg =
            fs::read_to_string(case.path("1").join(format!("speed_accuracy_{name}.svg"))).unwrap();
        assert!(svg.contains("Pareto front"));
    }
    let page = fs::read_to_string(case.path("1/report.html")).unwrap();
    assert!(page.contains("Contact: error of the deflections"));
    let answers: Vec<ChainScore> = read_rows(&case.path("1/recognition.csv")).unwrap();
    let chance = 0.25;
    let best = answers.iter().map(|row| row.accuracy).fold(0.0, f64::max);
    assert!(best > 2.0 * chance, "{best}");
}

#[test]
fn keys_that_are_out_of_range_are_named() {
    assert_eq!(kinds::about(QUICK).unwrap().table, "speed_accuracy");
    for (old, new, said) in [
        (
            "tolerances_mm = [0.2, 1.0]",
            "tolerances_mm = []",
            "key speed_accuracy.tolerances_mm: an empty list",
        ),
        (
            "tolerances_mm = [1.0]",
            "tolerances_mm = [0.7]",
            "key speed_accuracy.recognition.tolerances_mm: 0.7",
        ),
        (
            "dt_ms = [10.0, 1.0]",
            "dt_ms = [0.0]",
            "key speed_accuracy.contact.dt_ms: 0",
        ),
        (
            "stepped_touches = 1",
            "stepped_touches = 0",
            "key speed_accuracy.contact.stepped_touches: 0",
        ),
        (
            "ratio = [4.0, 16.0]\nclassifier",
            "ratio = [0.5]\nclassifier",
            "key speed_accuracy.recognition.ratio: 0.5",
        ),
        (
            "\"block_average\"]",
            "\"principal_components\"]",
            "key speed_accuracy.recognition.ensemble: principal components",
        ),
        (
            "objects = 4",
            "objects = 1",
            "key speed_accuracy.recognition.objects: 1",
        ),
        (
            "sets = [\"cans\"]",
            "sets = [\"cans\"]\nsurface_error_mm = 0.1",
            "no such key",
        ),
    ] {
        assert!(QUICK.contains(old), "{old}");
        let text = QUICK.replacen(old, new, 1);
        let plan = SpeedAccuracyStudySpec::parse("study.toml", &text)
            .and_then(|spec| SpeedAccuracyPlan::new("study.toml", Path::new(""), spec));
        let error = plan.unwrap_err().to_string();
        assert!(
            error.contains(said) && error.starts_with("study.toml"),
            "{error}"
        );
    }
}

#[test]
fn poses_of_a_file_are_pressed_as_one_press_presses_them() {
    let case = Case::new();
    case.file("ball.csv", "x,y,z,r\n0,0,0,0.02\n");
    case.file(
        "poses.csv",
        "x,y,z,qw,qx,qy,qz\n0,0,0.019,1,0,0,0\n0.004,-0.002,0.5,0,1,0,0\n",
    );
    let arguments = [
        "press",
        "--spheres",
        "ball.csv",
        "--poses",
        "poses.csv",
        "--json",
    ];
    let presses = |more: &[&str]| -> Vec<serde_json::Value> {
        let (said, _) = case.succeeds(&[&arguments[..], more].concat());
        let said: serde_json::Value = serde_json::from_str(&said).unwrap();
        said["presses"].as_array().unwrap().clone()
    };
    let still = presses(&["--out", "frames.npy", "--repeat", "3"]);
    assert!(still[0]["n_touched"].as_u64() > Some(0) && still[1]["n_touched"] == 0);
    assert!(still[0]["us"].as_f64() > Some(0.0));
    let frames = fs::read(case.path("frames.npy")).unwrap();
    assert!(frames.len() > 2 * 64 * 64 * 8);
    let deep = presses(&["--depth-mm", "2"]);
    assert!(
        deep.iter()
            .all(|press| press["n_touched"].as_u64() > Some(4)),
        "{deep:?}"
    );
    for (file, text, said) in [
        ("a.csv", "x,y\n1,2\n", "a.csv, line 2"),
        (
            "b.csv",
            "x,y,z,qw,qx,qy,qz\n0,0,0,0,0,0,0\n",
            "b.csv, row 1",
        ),
        ("c.csv", "x,y,z,qw,qx,qy,qz\n", "no poses"),
    ] {
        case.file(file, text);
        let output = case.run(&["press", "--spheres", "ball.csv", "--poses", file]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(said), "{error}");
    }
}
