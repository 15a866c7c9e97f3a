//! The study of what accuracy costs, and the advisor.

use crate::command::Case;
use bubbletouch::kinds;
use bubbletouch::kinds::speed_accuracy::rows::{
    ChainScore, ChainTime, ContactCell, ContactPoint, ContactScore, ContactWay, Resolved, StudySize,
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

[speed_accuracy.resolution]
touches = [8, 24]
trials = [3, 9]
ratio = [4.0, 16.0]
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
    for name in [
        "contact.csv",
        "recognition.csv",
        "resolution.csv",
        "study.toml",
    ] {
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
    for name in [
        "contact",
        "decision",
        "training",
        "resolution",
        "difference",
    ] {
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
    let sizes: Vec<StudySize> = read_rows(&case.path("1/resolution.csv")).unwrap();
    let resolved: Vec<Resolved> = read_rows(&case.path("1/resolution.csv")).unwrap();
    let half = |touches, trials| {
        let place = sizes
            .iter()
            .position(|s| (s.touches, s.trials) == (touches, trials));
        resolved[place.unwrap()].clone()
    };
    assert!(half(24, 3).accuracy_half_width < half(8, 3).accuracy_half_width);
    // Three trials say little of their own spread: both sizes together.
    let of_difference = |trials| -> f64 {
        [8, 24]
            .map(|n| half(n, trials).difference_half_width)
            .iter()
            .sum()
    };
    assert!(of_difference(9) < of_difference(3));
}

#[test]
fn the_advisor_answers_from_what_was_measured_and_says_what_is_nearest() {
    let case = Case::new();
    let header = "pitch_mm,n_taxels,tolerance_mm,ensemble,ratio,measurements,classifier,n_objects,n_training,n_test,accuracy,accuracy_low,\
                  accuracy_high,n_capped,sense_us,project_us,classify_us,decision_us,fit_s\n";
    let chain = |m: usize, accuracy: &str, decision_us: f64| {
        let ratio = 256 / m;
        format!(
            "8.0,256,1.0,block_average,{ratio},{m},linear_svm,4,96,48,{accuracy},0,1,1,1,{decision_us},0.1\n"
        )
    };
    let rows = chain(4, "0.6,0.55,0.65", 10.0)
        + &chain(16, "0.9,0.87,0.93", 50.0)
        + &chain(64, "0.97,0.95,0.98", 200.0);
    fs::create_dir(case.path("results")).unwrap();
    case.file("results/pareto.csv", format!("{header}{rows}"));
    let (said, _) = case.succeeds(&["advise", "results", "--accuracy", "0.9"]);
    assert!(
        said.starts_with("linear SVM, block average, m = 16, pitch 8 mm"),
        "{said}"
    );
    assert!(
        said.contains("0.870 to 0.930") && said.contains("50.0 µs"),
        "{said}"
    );
    assert!(
        said.contains("costs 150 µs a decision more (4.0 times as much)"),
        "{said}"
    );
    assert!(
        said.contains("With the whole interval above: 0.970"),
        "{said}"
    );
    let (said, _) = case.succeeds(&["advise", "results", "--budget", "49", "--json"]);
    let advice: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(advice["cost"], "decision_time");
    let answer = &advice["answers"][0];
    assert_eq!(answer["choice"]["costs"]["measurements"], 4.0);
    assert_eq!(answer["next_up"]["costs"]["decision_us"], 50.0);
    for (arguments, wanted) in [
        (
            &["advise", "results", "--accuracy", "0.99"][..],
            "at most 0.970",
        ),
        (&["advise", "results", "--budget", "5"], "at least 0.600"),
        (
            &["advise", "results", "--budget", "5", "--cost", "taxels"],
            "for 256 taxels",
        ),
        (
            &["advise", "results", "--budget", "5", "--given", "noise=0"],
            "made in one condition",
        ),
        (&["advise", "results", "--accuracy", "1.5"], "at most 1"),
        (
            &["advise", "nowhere", "--accuracy", "0.5"],
            "nowhere/pareto.csv",
        ),
        (&["advise", "results"], "--accuracy"),
    ] {
        let output = case.run(arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(error.contains(wanted), "{arguments:?}: {error}");
    }
    for (columns, said) in [
        ("a,b", "other columns"),
        ("chart,cost_us", "an earlier version"),
    ] {
        case.file("results/pareto.csv", format!("{columns}\n1,2\n"));
        let output = case.run(&["advise", "results", "--accuracy", "0.5"]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn the_advisor_reads_a_study_that_recognises_objects() {
    let case = Case::new();
    case.file(
        "study.toml",
        "question = \"?\"\n[objects]\nsets = [\"cans\"]\n[skin]\npitch_mm = 8.0\ntaxels = 8\nstroke_mm = 5.0\n[touches]\n\
         per_object = 16\noffset_x_mm = { uniform = [-9.0, 9.0] }\ndepth_mm = 3.0\n[sensing]\nratio = [2, 8]\n[recognition]\n\
         classifier = \"linear_svm\"\n",
    );
    case.succeeds(&["run", "study.toml", "--out", "results"]);
    let (said, _) = case.succeeds(&["advise", "results", "--budget", "1e9"]);
    assert!(said.contains("Nothing here is more accurate"), "{said}");
}

#[test]
fn conditions_of_the_world_are_given_and_never_advised() {
    let case = Case::new();
    case.file(
        "study.toml",
        "question = \"?\"\n[objects]\nsets = [\"cans\"]\n[skin]\npitch_mm = 8.0\ntaxels = 8\nstroke_mm = 5.0\n[touches]\n\
         per_object = 16\noffset_x_mm = { uniform = [-9.0, 9.0] }\ndepth_mm = 3.0\n[signal]\nnoise_std_full_scale = [0.0, 0.05, 0.2]\n\
         smoothing_mm = [0.0, 8.0]\nsteps = [\"noise\", \"smoothing\"]\n[sensing]\nratio = [2, 8]\n[recognition]\n\
         classifier = \"linear_svm\"\n",
    );
    case.succeeds(&["run", "study.toml", "--out", "r"]);
    let advise = |more: &[&str]| {
        let (said, _) = case.succeeds(&[&["advise", "r", "--accuracy", "0.1"], more].concat());
        said
    };
    let said = advise(&[]);
    for noise in ["0 %", "5 %", "20 %"] {
        let head = format!("With noise {noise}:\n");
        assert_eq!(said.matches(&head).count(), 1, "{said}");
    }
    // Nothing else speaks of noise: it is no part of a setting, and no step up.
    assert_eq!(said.matches("noise").count(), 3, "{said}");
    assert!(said.contains("smoothing") && said.contains("compression"));
    for key in ["noise=0.05", "noise_std=0.05"] {
        let given = advise(&["--given", key]);
        assert!(given.starts_with("With noise 5 %:\n"), "{given}");
        assert_eq!(given.matches("With noise").count(), 1, "{given}");
        assert!(
            said.contains(given.trim_end()),
            "as among all conditions: {given}"
        );
    }
    let worst = advise(&["--worst"]);
    assert!(
        worst.starts_with("With the worst of 3 conditions:\n"),
        "{worst}"
    );
    // The fewest measurements, and the fewest taxels: one array has them all.
    let few = advise(&["--cost", "measurements", "--given", "noise=0"]);
    assert!(
        few.contains("8 measurements a decision") && few.contains("m = 8"),
        "{few}"
    );
    let taxels = advise(&["--cost", "taxels", "--given", "noise=0", "--json"]);
    let taxels: serde_json::Value = serde_json::from_str(&taxels).unwrap();
    assert_eq!(taxels["answers"][0]["choice"]["costs"]["taxels"], 64.0);
    for (given, said) in [
        ("smoothing_mm=0", "is a choice"),
        ("noise=0.07", "one of 0.0, 0.05, 0.2"),
        (
            "gain_std=0.1",
            "is no condition of this study; one of noise_std",
        ),
        ("noise", "a condition and its value"),
    ] {
        let output = case.run(&["advise", "r", "--accuracy", "0.1", "--given", given]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{given}: {error}");
        assert!(error.contains(said), "{given}: {error}");
    }
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
            "objects = 4",
            "objects = 1",
            "key speed_accuracy.recognition.objects: 1",
        ),
        (
            "trials = [3, 9]",
            "trials = [1]",
            "key speed_accuracy.resolution.trials: 1",
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
