//! `bubbletouch audit` reads recordings as studies do, writes a page with tables, and its errors state what is wrong.

use crate::arrays::{npy, npz};
use crate::command::{Case, says};
use bubbletouch::random::Seed;
use bubbletouch::study::write_texts;
use ndarray::{Array1, Array3, Array4, s};
use rand::Rng;
use rand_distr::StandardNormal;
use std::collections::BTreeMap;

const N: usize = 90;
const SIDE: usize = 8;

fn label(touch: usize) -> usize {
    touch * 7 % 3
}

/// Returns frames of a disc whose size depends on the class, at random places, with noise.
fn frames() -> Array3<f32> {
    let mut rng = Seed::new(6).rng();
    let mut frames = Array3::zeros((N, SIDE, SIDE));
    for (touch, mut frame) in frames.outer_iter_mut().enumerate() {
        let (y, x): (f32, f32) = (rng.gen_range(3.0..4.0), rng.gen_range(3.0..4.0));
        for ((row, column), reading) in frame.indexed_iter_mut() {
            let away = (row as f32 - y).hypot(column as f32 - x);
            let noise: f32 = rng.sample(StandardNormal);
            *reading = (1.0 + label(touch) as f32 - away).clamp(0.0, 1.0) + 0.02 * noise;
        }
    }
    frames
}

/// Returns the labels of some touches.
fn labels(touches: impl Iterator<Item = usize>) -> Array1<i64> {
    touches.map(|touch| label(touch) as i64).collect()
}

fn with_recording() -> Case {
    let case = Case::with("skin/frames.npy", npy(&frames()));
    case.file("skin/labels.npy", npy(&labels(0..N)));
    case
}

/// Returns the command of an audit with few permutations.
fn audit(arguments: &str) -> String {
    format!("audit {arguments} --permutations 399")
}

/// Returns the verdicts of a check in `findings.csv`.
fn verdicts(case: &Case, folder: &str, check: &str) -> Vec<String> {
    let rows: Vec<BTreeMap<String, String>> = case.rows(&format!("{folder}/findings.csv"));
    let rows = rows.into_iter().filter(|row| row["check"] == check);
    rows.map(|mut row| row.remove("verdict").unwrap()).collect()
}

#[test]
fn a_folder_becomes_a_page_with_tables() {
    let case = with_recording();
    let (said, _) = case.succeeds(&audit("skin"));
    says(&said, &["Page: results/skin_audit/report.html"]);
    let page = case.read("results/skin_audit/report.html");
    says(&page, &["id=\"findings\"", "picture-taxels"]);
    let found = |check: &str| verdicts(&case, "results/skin_audit", check);
    assert_eq!(found("missing_readings"), ["passed"]);
    assert_eq!(found("not_given"), ["not_checked"]);
    // A second run of the command replaces the files of the first, and the tables are equal.
    let first = case.bytes("results/skin_audit/findings.csv");
    case.succeeds(&audit("skin --threads 1"));
    assert_eq!(case.bytes("results/skin_audit/findings.csv"), first);
}

#[test]
fn axes_texts_and_archives_of_sessions_are_read() {
    let case = with_recording();
    let frames = frames();
    let names: Vec<String> = (0..N)
        .map(|touch| ["cup", "ball", "pen"][label(touch)].to_owned())
        .collect();
    write_texts(&case.path("names.npy"), &names).unwrap();
    // Three frames of each touch, time as the last axis.
    let over_time = Array4::from_shape_fn((N, SIDE, SIDE, 3), |(touch, y, x, t)| {
        frames[(touch, y, x)] * t as f32 / 2.0
    });
    case.file("over_time.npy", npy(&over_time));
    let options = "--labels names.npy --before-contact 0..1 --out timed";
    let words = audit(&format!("over_time.npy {options}"));
    let mut words: Vec<&str> = words.split(' ').collect();
    words.extend(["--order", "n y x t"]);
    case.succeeds(&words);
    // The frame before contact is exactly zero and therefore carries no information about the class.
    assert_eq!(verdicts(&case, "timed", "before_contact"), ["passed"]);
    says(&case.read("timed/findings.csv"), &["chance is 33 %"]);
    for (session, from) in [("a", 0), ("b", 30), ("c", 60)] {
        let own = frames.slice(s![from..from + 30, .., ..]).to_owned();
        // One class occurs only in session b.
        let labels = match session {
            "b" => Array1::from_elem(30, 3),
            _ => labels(from..from + 30),
        };
        let archive = npz(|npz| {
            npz.add_array("frames", &own).unwrap();
            npz.add_array("labels", &labels).unwrap();
        });
        case.file(&format!("sessions/{session}.npz"), archive);
    }
    case.succeeds(&audit("sessions --out by_session"));
    assert_eq!(verdicts(&case, "by_session", "session"), ["fault"]);
}

#[test]
fn bad_input_is_named_and_nothing_is_written() {
    let case = with_recording();
    case.file("few.npy", npy(&labels(0..N - 1)));
    case.create_folder("empty");
    let few = "few.npy: 89 values; 90, one a touch of";
    let range = "--before-contact: 0..2; a first frame below the end, which is at most 1";
    let claim = "--not-claimed: weather; order, session, padding";
    let split = "--split: group; time with these data";
    let without = "empty: a folder without frames; recorded.toml, a file frames.npy";
    for (options, words) in [
        ("skin --groups few.npy", few),
        ("nowhere.npz", "nowhere.npz: cannot be read"),
        ("skin --order n_y", "--order"),
        ("skin --before-contact 0..2", range),
        (
            "skin --untouched 3,60..70",
            "--untouched: 64; taxels from 0 to 63",
        ),
        ("skin --not-claimed order,weather", claim),
        ("skin --split group", split),
        ("empty", without),
        // The output is not written over the input.
        ("skin --out skin/frames.npy", "frames.npy"),
    ] {
        says(&case.refuses(&audit(options)), &[words]);
    }
    let said = case.refuses("audit skin --permutations 3");
    says(&said, &["--permutations: 3; 399 to 100000"]);
    assert!(!case.path("results").exists());
}

#[test]
fn a_given_test_set_is_read_from_the_folder_or_from_recorded_toml() {
    let case = with_recording();
    let table = |name: &str| {
        case.succeeds(&audit(name));
        case.read(&format!("results/{name}_audit/accuracy_by_split.csv"))
    };
    assert!(!table("skin").contains("\ngiven,"));
    let test = frames().slice(s![..30, .., ..]).to_owned();
    case.file("skin/frames_test.npy", npy(&test));
    case.file("skin/labels_test.npy", npy(&labels(0..30)));
    let beside = table("skin");
    says(&beside, &["\ngiven,"]);
    // Sessions are those of the training touches, followed by those of the test set.
    let sessions: Array1<i64> = (0..N as i64 + 30).map(|touch| touch / 8).collect();
    case.file("skin/sessions.npy", npy(&sessions));
    says(&table("skin"), &["\nsession,"]);
    assert_eq!(verdicts(&case, "results/skin_audit", "shared"), ["note"]);
    let keys = ["frames", "labels", "frames_test", "labels_test"];
    let mut recorded = "[recorded]\n".to_owned();
    for (key, name) in keys.into_iter().zip(["x", "y", "u", "v"]) {
        recorded += &format!("{key} = \"{name}.npy\"\n");
        let bytes = case.bytes(&format!("skin/{key}.npy"));
        case.file(&format!("other/{name}.npy"), bytes);
    }
    case.file("other/recorded.toml", recorded);
    assert_eq!(table("other"), beside);
    case.remove("skin/sessions.npy");
    case.remove("skin/labels_test.npy");
    let error = case.refuses(&audit("skin"));
    says(&error, &["frames_test.npy", "labels_test"]);
    case.file("other/u.npy", npy(&test.slice(s![.., 1.., ..]).to_owned()));
    let error = case.refuses(&audit("other"));
    says(&error, &["u.npy", "7 × 8 taxels", "8 × 8 taxels"]);
}

/// The file lists the touches from the last to the first in time.
#[test]
fn touches_to_look_at_have_their_numbers_in_the_file() {
    let case = with_recording();
    let mut frames = frames();
    // Touch 68 is a copy of touch 5 and has the same label.
    let copy = frames.slice(s![5, .., ..]).to_owned();
    frames.slice_mut(s![68, .., ..]).assign(&copy);
    case.file("skin/frames.npy", npy(&frames));
    let times = Array1::from_shape_fn(N, |touch| -(touch as f64));
    case.file("skin/times.npy", npy(&times));
    case.succeeds(&audit("skin"));
    let rows = case.read("results/skin_audit/rows.csv");
    says(&rows, &["5,class 2,copy,68,", "68,class 2,copy,5,"]);
}

#[test]
fn a_fault_ends_with_exit_code_one_if_asked_for() {
    let case = with_recording();
    case.succeeds(&audit("skin --fail-on fault"));
    let of_class = |touch: usize| match touch % 7 {
        0 => 0,
        _ => label(touch) as i64,
    };
    let by_class: Array1<i64> = (0..N).map(of_class).collect();
    case.file("skin/sessions.npy", npy(&by_class));
    let faulty = case.run(&audit("skin --fail-on fault"));
    assert_eq!(faulty.status.code(), Some(1));
    assert_eq!(verdicts(&case, "results/skin_audit", "session"), ["fault"]);
    case.succeeds(&audit("skin"));
}
