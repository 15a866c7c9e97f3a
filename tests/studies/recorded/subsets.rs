//! Subsets of the sensors of a recording, and recordings that move to another folder.

use super::{LABELS, N, NOISE, RAW, SKIN, has_errors, list, of_file, recordings};
use crate::command::{Case, says};
use crate::study::scores_of_variant;
use ndarray::{Axis, concatenate, s};
use std::fs;

/// First taxel and end of each of three sensors.
const SENSORS: [(&str, usize, usize); 3] = [("palm", 0, 24), ("index", 24, 40), ("thumb", 40, 64)];

/// Creates a folder with a file for each of three sensors, and a file with the taxels of palm and thumb; also returns `[recorded]` with the three sensors.
fn three_sensors() -> (Case, String) {
    let (case, list) = (recordings(), list());
    let mut recorded = LABELS.to_owned();
    for (name, first, end) in SENSORS {
        case.write_array(&format!("{name}.npy"), &list.slice(s![.., first..end]));
        recorded += &format!(
            "[[recorded.sensors]]\nname = \"{name}\"\nframes = \"{name}.npy\"\nfull_scale = 2.0\n"
        );
    }
    let both = concatenate![Axis(1), list.slice(s![.., ..24]), list.slice(s![.., 40..])];
    case.write_array("both.npy", &both);
    (case, recorded)
}

#[test]
fn two_of_three_sensors_give_the_rows_of_the_two_joined_by_hand() {
    let (case, recorded) = three_sensors();
    let rest = format!("{SKIN}{NOISE}{RAW}");
    let [all, expected] = ["list.npy", "both.npy"]
        .map(|name| case.scores(&(of_file(name) + "full_scale = 2.0\n"), &rest));
    assert!(has_errors(&expected));
    let both = [
        r#""palm+thumb""#,
        r#""thumb + palm""#,
        r#"["thumb", "palm"]"#,
    ];
    let choices = both.join(", ");
    let axis = format!("[axes]\n\"recorded.sensor\" = [\"all\", \"index\", {choices}]\n");
    let found = case.scored_rows(&recorded, &format!("{rest}{axis}"));
    assert_eq!(scores_of_variant(&found, 0), all);
    assert_ne!(scores_of_variant(&found, 1), expected);
    for (number, choice) in (2..).zip(both) {
        assert_eq!(scores_of_variant(&found, number), expected, "{choice}");
        let study = case.recorded(&format!("sensor = {choice}\n{recorded}"), &rest);
        let settings = format!("{:?}", study.unwrap().first().touched.settings());
        says(&settings, &["palm (24 taxels), thumb (24 taxels)"]);
    }
}

#[test]
fn tables_name_the_subset_of_sensors() {
    let (case, recorded) = three_sensors();
    let axis = "[axes]\n\"recorded.sensor\" = [\"palm+thumb\", [\"palm\", \"index\"]]\n";
    let study = format!("question = \"?\"\ntrials = 1\n[recorded]\n{recorded}\n{SKIN}{RAW}{axis}");
    case.file("study.toml", study);
    case.succeeds("run study.toml --out results --quiet");
    let summary = case.read("results/summary.csv");
    says(&summary, &[",palm+thumb,", r#","[""palm"", ""index""]","#]);
}

#[test]
fn a_sensor_may_have_a_plus_in_its_name() {
    let (case, recorded) = three_sensors();
    let named = recorded.replace("name = \"index\"", "name = \"palm+thumb\"");
    let rest = format!("{SKIN}{RAW}");
    let index = case.scores(&format!("sensor = \"index\"\n{recorded}"), &rest);
    let found = case.scores(&format!("sensor = \"palm+thumb\"\n{named}"), &rest);
    assert_eq!(found, index);
}

/// A run whose files have moved and have other names computes nothing again. Files with other content are refused.
#[test]
fn a_run_goes_on_after_its_recording_has_moved() {
    let case = recordings();
    fs::create_dir(case.path("moved")).unwrap();
    let study = |recorded: &str, more: &str| {
        let tables = format!("{SKIN}{NOISE}{RAW}{more}");
        let text = format!("question = \"?\"\ntrials = 2\n[recorded]\n{recorded}\n{tables}");
        case.file("study.toml", text);
    };
    let run = ["run", "study.toml", "--out", "results"];
    let read = |name: &str| case.read(&format!("results/{name}"));
    let found = || (read("accuracy.csv"), read("journal.jsonl").lines().count());
    study(&of_file("list.npy"), "");
    case.succeeds(&run);
    let before = found();
    for (from, to) in [
        ("list.npy", "moved/frames.npy"),
        ("labels.npy", "moved/classes.npy"),
    ] {
        fs::rename(case.path(from), case.path(to)).unwrap();
    }
    let labels = "labels = \"moved/classes.npy\"\n";
    let moved = format!("{labels}frames = \"moved/frames.npy\"\n");
    study(&moved, "");
    case.succeeds(&run);
    assert_eq!(found(), before);
    // An axis of recordings may have more values.
    let other = list().mapv(|reading| reading * reading);
    case.write_array("other.npy", &other);
    study(
        labels,
        "[axes]\n\"recorded.frames\" = [\"moved/frames.npy\", \"other.npy\"]\n",
    );
    case.succeeds(&run);
    let (n_before, n) = (before.1, found().1);
    assert!(n > n_before && n < 2 * n_before + N);
    // All frames are other frames.
    fs::remove_dir_all(case.path("results")).unwrap();
    study(&moved, "");
    case.succeeds(&run);
    case.write_array("moved/frames.npy", &other);
    says(&case.refuses(&run), &["object recorded.frames: was "]);
    assert_eq!(read("accuracy.csv"), before.0);
}
