//! `bubbletouch audit` reads recordings as studies do, writes a page with tables, and its errors state what is wrong.

use crate::command::{Case, says};
use bubbletouch::random::Seed;
use bubbletouch::study::{write_integers, write_npy, write_texts};
use ndarray::{Array3, Array4, s};
use rand::Rng;
use rand_distr::StandardNormal;

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

fn with_recording() -> Case {
    let case = Case::new();
    std::fs::create_dir(case.path("skin")).unwrap();
    write_npy(&case.path("skin/frames.npy"), &frames()).unwrap();
    write_integers(&case.path("skin/labels.npy"), (0..N).map(label)).unwrap();
    case
}

const FEW: [&str; 2] = ["--permutations", "399"];

fn audit<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [&["audit"], arguments, &FEW[..]].concat()
}

/// Returns the verdicts of a check in `findings.csv`.
fn verdicts(case: &Case, folder: &str, check: &str) -> Vec<String> {
    let mut reader = csv::Reader::from_path(case.path(folder).join("findings.csv")).unwrap();
    let rows = reader.records().map(Result::unwrap);
    let rows = rows.filter(|row| &row[0] == check);
    rows.map(|row| row[2].to_owned()).collect()
}

#[test]
fn a_folder_becomes_a_page_with_tables() {
    let case = with_recording();
    let (said, _) = case.succeeds(&audit(&["skin"]));
    says(&said, &["Page: results/skin_audit/report.html"]);
    let page = std::fs::read_to_string(case.path("results/skin_audit/report.html")).unwrap();
    assert!(page.contains("id=\"findings\"") && page.contains("picture-taxels"));
    assert_eq!(
        verdicts(&case, "results/skin_audit", "missing_readings"),
        ["passed"]
    );
    assert_eq!(
        verdicts(&case, "results/skin_audit", "not_given"),
        ["not_checked"]
    );
    // A second run of the command replaces the files of the first, and the tables are equal.
    let table = || std::fs::read(case.path("results/skin_audit/findings.csv")).unwrap();
    let first = table();
    case.succeeds(&[&audit(&["skin"])[..], &["--threads", "1"]].concat());
    assert_eq!(table(), first);
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
    write_npy(&case.path("over_time.npy"), &over_time).unwrap();
    let given = [
        "over_time.npy",
        "--order",
        "n y x t",
        "--labels",
        "names.npy",
        "--before-contact",
        "0..1",
        "--out",
        "timed",
    ];
    case.succeeds(&audit(&given));
    // The frame before contact is exactly zero and therefore carries no information about the class.
    assert_eq!(verdicts(&case, "timed", "before_contact"), ["passed"]);
    let findings = std::fs::read_to_string(case.path("timed/findings.csv")).unwrap();
    says(&findings, &["chance is 33 %"]);
    std::fs::create_dir(case.path("sessions")).unwrap();
    for (session, from) in [("a", 0), ("b", 30), ("c", 60)] {
        let path = case.path("sessions").join(format!("{session}.npz"));
        let mut archive = ndarray_npy::NpzWriter::new(std::fs::File::create(path).unwrap());
        let own = frames.slice(s![from..from + 30, .., ..]).to_owned();
        archive.add_array("frames", &own).unwrap();
        // One class occurs only in session b.
        let labels =
            (from..from + 30).map(|touch| if from == 30 { 3 } else { label(touch) as i64 });
        archive
            .add_array("labels", &ndarray::Array1::from_iter(labels))
            .unwrap();
        archive.finish().unwrap();
    }
    case.succeeds(&audit(&["sessions", "--out", "by_session"]));
    assert_eq!(verdicts(&case, "by_session", "session"), ["fault"]);
}

#[test]
fn bad_input_is_named_and_nothing_is_written() {
    let case = with_recording();
    write_integers(&case.path("few.npy"), 0..N - 1).unwrap();
    let refused = |arguments: &[&str], said: &str| {
        let error = case.refuses(arguments);
        assert!(error.contains(said), "{arguments:?}: {error}");
        assert!(!case.path("results").exists(), "{arguments:?}");
    };
    refused(
        &audit(&["skin", "--groups", "few.npy"]),
        "few.npy: 89 values; 90, one a touch of",
    );
    refused(&audit(&["nowhere.npz"]), "nowhere.npz: cannot be read");
    refused(&audit(&["skin", "--order", "n y"]), "--order");
    refused(
        &audit(&["skin", "--before-contact", "0..2"]),
        "--before-contact: 0..2; a first frame below the end, which is at most 1",
    );
    refused(
        &audit(&["skin", "--untouched", "3,60..70"]),
        "--untouched: 64; taxels from 0 to 63",
    );
    refused(
        &audit(&["skin", "--not-claimed", "order,weather"]),
        "--not-claimed: weather; order, session, padding",
    );
    refused(
        &audit(&["skin", "--split", "group"]),
        "--split: group; time with these data",
    );
    refused(
        &["audit", "skin", "--permutations", "3"],
        "--permutations: 3; 399 to 100000",
    );
    std::fs::create_dir(case.path("empty")).unwrap();
    refused(
        &audit(&["empty"]),
        "empty: a folder without frames; recorded.toml, a file frames.npy",
    );
    // The output is not written over the input.
    refused(&audit(&["skin", "--out", "skin/frames.npy"]), "frames.npy");
}

#[test]
fn a_given_test_set_is_read_from_the_folder_or_from_recorded_toml() {
    let case = with_recording();
    let table = |name: &str| {
        let table = case.path(&format!("results/{name}_audit/accuracy_by_split.csv"));
        std::fs::read_to_string(table).unwrap()
    };
    case.succeeds(&audit(&["skin"]));
    assert!(!table("skin").contains("\ngiven,"), "{}", table("skin"));
    let test = frames().slice(s![..30, .., ..]).to_owned();
    write_npy(&case.path("skin/frames_test.npy"), &test).unwrap();
    write_integers(&case.path("skin/labels_test.npy"), (0..30).map(label)).unwrap();
    case.succeeds(&audit(&["skin"]));
    let beside = table("skin");
    says(&beside, &["\ngiven,"]);
    // Sessions are those of the training touches, followed by those of the test set.
    write_integers(&case.path("skin/sessions.npy"), (0..N + 30).map(|k| k / 8)).unwrap();
    case.succeeds(&audit(&["skin"]));
    assert!(table("skin").contains("\nsession,"), "{}", table("skin"));
    let counted = verdicts(&case, "results/skin_audit", "shared");
    assert_eq!(counted, ["note"]);
    std::fs::remove_file(case.path("skin/sessions.npy")).unwrap();
    std::fs::create_dir(case.path("other")).unwrap();
    for (from, to) in [
        ("frames", "x"),
        ("labels", "y"),
        ("frames_test", "u"),
        ("labels_test", "v"),
    ] {
        let of = |folder: &str, name: &str| case.path(&format!("{folder}/{name}.npy"));
        std::fs::copy(of("skin", from), of("other", to)).unwrap();
    }
    let recorded = "[recorded]\nframes = \"x.npy\"\nlabels = \"y.npy\"\nframes_test = \"u.npy\"\nlabels_test = \"v.npy\"\n";
    case.file("other/recorded.toml", recorded);
    case.succeeds(&audit(&["other"]));
    assert_eq!(table("other"), beside);
    let said = |arguments: &[&str]| {
        let output = case.run(&audit(arguments));
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    std::fs::remove_file(case.path("skin/labels_test.npy")).unwrap();
    let error = said(&["skin"]);
    says(&error, &["frames_test.npy", "labels_test"]);
    write_npy(
        &case.path("other/u.npy"),
        &test.slice(s![.., 1.., ..]).to_owned(),
    )
    .unwrap();
    let error = said(&["other"]);
    says(&error, &["u.npy", "64"]);
}

/// The file lists the touches from the last to the first in time.
#[test]
fn touches_to_look_at_have_their_numbers_in_the_file() {
    let case = with_recording();
    let mut frames = frames();
    // Touch 68 is a copy of touch 5 and has the same label.
    let copy = frames.slice(s![5, .., ..]).to_owned();
    frames.slice_mut(s![68, .., ..]).assign(&copy);
    write_npy(&case.path("skin/frames.npy"), &frames).unwrap();
    let times = ndarray::Array1::from_iter((0..N).map(|touch| -(touch as f64)));
    write_npy(&case.path("skin/times.npy"), &times).unwrap();
    case.succeeds(&audit(&["skin"]));
    let rows = std::fs::read_to_string(case.path("results/skin_audit/rows.csv")).unwrap();
    let (five, copy) = ("5,class 2,copy,68,", "68,class 2,copy,5,");
    assert!(rows.contains(five) && rows.contains(copy), "{rows}");
}

/// The arrays of the test set have their own names in an archive, as in studies.
#[test]
fn a_test_set_in_the_archive_of_the_frames_has_its_own_labels() {
    let case = Case::new();
    let frames = frames();
    let path = case.path("skin.npz");
    let mut archive = ndarray_npy::NpzWriter::new(std::fs::File::create(path).unwrap());
    let half = |from: usize| frames.slice(s![from..from + N / 2, .., ..]).to_owned();
    // The test touches have labels in another order than the training touches.
    let labels = |from: usize| {
        ndarray::Array1::from_iter((from..from + N / 2).map(|touch| label(touch) as i64))
    };
    let reversed = half(N / 2).slice(s![..;-1, .., ..]).to_owned();
    let labels_test = labels(N / 2).slice(s![..;-1]).to_owned();
    archive.add_array("frames", &half(0)).unwrap();
    archive.add_array("labels", &labels(0)).unwrap();
    archive.add_array("frames_test", &reversed).unwrap();
    archive.add_array("labels_test", &labels_test).unwrap();
    archive.finish().unwrap();
    case.succeeds(&audit(&["skin.npz"]));
    let table = case.path("results/skin_audit/accuracy_by_split.csv");
    let table = std::fs::read_to_string(table).unwrap();
    let line = table
        .lines()
        .find(|line| line.starts_with("given,nearest_row,"));
    let accuracy: f64 = line.unwrap().split(',').nth(2).unwrap().parse().unwrap();
    assert!(accuracy > 0.9, "{table}");
}

#[test]
fn a_fault_ends_with_exit_code_one_if_asked_for() {
    let case = with_recording();
    let clean = case.run(&audit(&["skin", "--fail-on", "fault"]));
    assert_eq!(clean.status.code(), Some(0));
    let by_class = (0..N).map(|touch| if touch % 7 == 0 { 0 } else { label(touch) });
    write_integers(&case.path("skin/sessions.npy"), by_class).unwrap();
    let faulty = audit(&["skin", "--fail-on", "fault"]);
    assert_eq!(case.run(&faulty).status.code(), Some(1));
    assert_eq!(verdicts(&case, "results/skin_audit", "session"), ["fault"]);
    case.succeeds(&audit(&["skin"]));
}
