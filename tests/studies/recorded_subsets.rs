//! Subsets of the sensors of a recording, and recordings that move to another folder.

use crate::command::{Case, says};
use crate::recorded_sensors::{LABELS, N, NOISE, RAW, SKIN, planned, rows, scores, written};
use bubbletouch::study::table::TrialScore;
use bubbletouch::study::write_npy;
use ndarray::{Array2, Axis, concatenate, s};
use ndarray_npy::read_npy;

/// First taxel and end of each of three sensors.
const SENSORS: [(&str, usize, usize); 3] = [("palm", 0, 24), ("index", 24, 40), ("thumb", 40, 64)];

/// Writes a file for each of three sensors, and a file with the taxels of palm and thumb; returns `[recorded]` with the three sensors.
fn three_sensors(case: &Case) -> String {
    let list: Array2<f64> = read_npy(case.path("list.npy")).unwrap();
    let mut recorded = LABELS.to_owned();
    for (name, first, end) in SENSORS {
        let own = list.slice(s![.., first..end]).to_owned();
        write_npy(&case.path(&format!("{name}.npy")), &own).unwrap();
        recorded.push_str(&format!(
            "[[recorded.sensors]]\nname = \"{name}\"\nframes = \"FOLDER/{name}.npy\"\nfull_scale = 2.0\n"
        ));
    }
    let both = concatenate![Axis(1), list.slice(s![.., ..24]), list.slice(s![.., 40..])];
    write_npy(&case.path("both.npy"), &both).unwrap();
    recorded
}

#[test]
fn two_of_three_sensors_give_the_rows_of_the_two_joined_by_hand() {
    let case = written();
    let recorded = three_sensors(&case);
    let rest = format!("{SKIN}{NOISE}{RAW}");
    let by_hand = format!("{LABELS}frames = \"FOLDER/both.npy\"\nfull_scale = 2.0\n");
    let expected = scores(&case, &by_hand, &rest);
    assert!(expected.iter().any(|score| score.n_correct < score.n_test));
    let choices = [
        "\"all\"",
        "\"palm+thumb\"",
        "\"thumb + palm\"",
        "[\"thumb\", \"palm\"]",
        "\"index\"",
    ];
    let axis = format!("[axes]\n\"recorded.sensor\" = [{}]\n", choices.join(", "));
    let found = rows(&case, &recorded, &format!("{rest}{axis}"));
    let part = |number: usize| -> Vec<TrialScore> {
        let rows = found.iter().filter(|(of, _)| of.variant.number == number);
        rows.map(|(_, score)| score.clone()).collect()
    };
    for (number, choice) in choices.iter().enumerate().take(4).skip(1) {
        assert_eq!(part(number), expected, "{choice}");
    }
    let all = format!("{LABELS}frames = \"FOLDER/list.npy\"\nfull_scale = 2.0\n");
    assert_eq!(part(0), scores(&case, &all, &rest));
    assert_ne!(part(4), expected);
    for choice in &choices[1..4] {
        let study = planned(&case, &format!("sensor = {choice}\n{recorded}"), &rest).unwrap();
        let settings = format!("{:?}", study.first().touched.settings());
        says(&settings, &["palm (24 taxels), thumb (24 taxels)"]);
    }
}

#[test]
fn tables_name_the_subset_of_sensors() {
    let case = written();
    let recorded = three_sensors(&case).replace("FOLDER/", "");
    let axis = "[axes]\n\"recorded.sensor\" = [\"palm+thumb\", [\"palm\", \"index\"]]\n";
    let study = format!("question = \"?\"\ntrials = 1\n[recorded]\n{recorded}\n{SKIN}{RAW}{axis}");
    case.file("study.toml", study);
    case.succeeds(&["run", "study.toml", "--out", "results", "--quiet"]);
    let summary = std::fs::read_to_string(case.path("results/summary.csv")).unwrap();
    assert!(
        summary.contains(",palm+thumb,") && summary.contains(r#","[""palm"", ""index""]","#),
        "{summary}"
    );
}

#[test]
fn a_sensor_may_have_a_plus_in_its_name() {
    let case = written();
    let recorded = three_sensors(&case);
    let named = recorded.replace("name = \"index\"", "name = \"palm+thumb\"");
    let rest = format!("{SKIN}{RAW}");
    let index = scores(&case, &format!("sensor = \"index\"\n{recorded}"), &rest);
    assert_eq!(
        scores(&case, &format!("sensor = \"palm+thumb\"\n{named}"), &rest),
        index
    );
}

/// A run whose files have moved and have other names computes nothing again. Files with other content are refused.
#[test]
fn a_run_goes_on_after_its_recording_has_moved() {
    let case = written();
    let list: Array2<f64> = read_npy(case.path("list.npy")).unwrap();
    std::fs::create_dir(case.path("moved")).unwrap();
    let study = |frames: &str, labels: &str, more: &str| {
        format!(
            "question = \"?\"\ntrials = 2\n[recorded]\nframes = \"{frames}\"\nlabels = \"{labels}\"\n{SKIN}{NOISE}{RAW}{more}"
        )
    };
    let run = |text: String| {
        case.file("study.toml", text);
        case.run(&["run", "study.toml", "--out", "results"])
    };
    assert!(run(study("list.npy", "labels.npy", "")).status.success());
    let tables = || std::fs::read(case.path("results/accuracy.csv")).unwrap();
    let n_lines = || {
        std::fs::read_to_string(case.path("results/journal.jsonl"))
            .unwrap()
            .lines()
            .count()
    };
    let (table, n) = (tables(), n_lines());
    for (from, to) in [
        ("list.npy", "moved/frames.npy"),
        ("labels.npy", "moved/classes.npy"),
    ] {
        std::fs::rename(case.path(from), case.path(to)).unwrap();
    }
    let output = run(study("moved/frames.npy", "moved/classes.npy", ""));
    assert!(output.status.success(), "{output:?}");
    assert_eq!((tables(), n_lines()), (table.clone(), n));
    // An axis of recordings may have more values.
    write_npy(
        &case.path("other.npy"),
        &list.mapv(|reading| reading * reading),
    )
    .unwrap();
    let axis = "[axes]\n\"recorded.frames\" = [\"moved/frames.npy\", \"other.npy\"]\n";
    let both = study("?", "moved/classes.npy", axis).replace("frames = \"?\"\n", "");
    let output = run(both);
    assert!(output.status.success(), "{output:?}");
    assert!(n_lines() > n && n_lines() < 2 * n + N);
    // All frames are other frames.
    std::fs::remove_dir_all(case.path("results")).unwrap();
    assert!(
        run(study("moved/frames.npy", "moved/classes.npy", ""))
            .status
            .success()
    );
    write_npy(
        &case.path("moved/frames.npy"),
        &list.mapv(|reading| reading * reading),
    )
    .unwrap();
    let output = run(study("moved/frames.npy", "moved/classes.npy", ""));
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    says(&said, &["object recorded.frames: was "]);
    assert_eq!(tables(), table);
}
