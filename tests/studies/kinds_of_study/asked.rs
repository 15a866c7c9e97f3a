//! What studies of every kind are asked: which choice to take, and what moved between two of them.

use crate::command::Case;
use crate::kinds::Kind;
use bubbletouch::kinds::read_tables;
use bubbletouch::table::Table;
use std::fs;

/// Kinds whose tables have choices with a value and a cost, and a cost and a value to ask for.
const OFFERING: [(Kind, &str, &str, &str); 5] = [
    (Kind::RECOGNITION, "cells.csv", "accuracy", "measurements"),
    (Kind::AXES, "cells.csv", "accuracy", "decision_time"),
    (Kind::RECONSTRUCTION, "pareto.csv", "error", "us_per_frame"),
    (
        Kind::OBJECT_DETAIL,
        "object_detail_cost.csv",
        "error_median_mm",
        "us_per_touch_median",
    ),
    (
        Kind::WHOLE_BODY,
        "recognition.csv",
        "accuracy",
        "bytes_per_taxel",
    ),
];

fn json(case: &Case, arguments: &[&str]) -> serde_json::Value {
    let (said, _) = case.succeeds(&[&["advise", "found", "--json"], arguments].concat());
    serde_json::from_str(&said).unwrap()
}

fn refused(case: &Case, arguments: &[&str]) -> String {
    let output = case.run(arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
    error
}

#[test]
fn every_kind_that_offers_choices_is_asked_by_the_roles_of_its_columns() {
    for (kind, file, value, cost) in OFFERING {
        let case = kind.case();
        case.succeeds(&["run", "study.toml", "--out", "found"]);
        let asked = ["--value", value, "--cost", cost];
        let advice = json(&case, &[&asked[..], &["--budget", "1e12"]].concat());
        assert_eq!(
            (&advice["table"], &advice["value"]),
            (&file.into(), &value.into())
        );
        let cost_column = advice["cost"].as_str().unwrap().to_owned();
        let (_, tables) = read_tables(&case.path("found")).unwrap();
        let table = tables.iter().find(|table| table.file == file).unwrap();
        let best = best_of_each_condition(table, value);
        let answers = advice["answers"].as_array().unwrap();
        assert_eq!(answers.len(), best.len(), "{file}: {advice}");
        for (answer, best) in answers.iter().zip(&best) {
            let choice = &answer["choice"];
            assert_eq!(choice[value].as_f64(), Some(*best), "{file}");
            assert!(answer["next_up"].is_null(), "{file}");
            // Who asks for what the best gives is answered by something as good that costs no more.
            let reach = best.to_string();
            let again = json(&case, &[&asked[..], &["--reach", &reach]].concat());
            let again = again["answers"].as_array().unwrap();
            let place = answers.iter().position(|other| other == answer).unwrap();
            assert_eq!(again[place]["choice"][value], choice[value], "{file}");
            assert_eq!(again[place]["choice"][&cost_column], choice[&cost_column]);
        }
        let error = refused(
            &case,
            &["advise", "found", "--budget", "1", "--cost", "colour"],
        );
        assert!(error.contains("--cost: colour; one of"), "{error}");
        if best.len() > 1 {
            let worst = json(
                &case,
                &[&asked[..], &["--budget", "1e12", "--worst"]].concat(),
            );
            assert_eq!(worst["answers"].as_array().unwrap().len(), 1, "{file}");
        }
    }
}

/// In the order in which conditions first come.
fn best_of_each_condition(table: &Table, value: &str) -> Vec<f64> {
    use bubbletouch::table::{Better, Role};
    let (column, _) = table.column(value).unwrap();
    let wants_less = column.role == Role::Value(Better::Less);
    let conditions = table.groups(&table.of_role(Role::Condition), 0..table.n_rows);
    let best = |rows: &Vec<usize>| {
        let values = rows.iter().map(|&row| table.number(value, row));
        values
            .filter(|value| value.is_finite())
            .reduce(|a, b| if wants_less { a.min(b) } else { a.max(b) })
    };
    conditions.iter().filter_map(best).collect()
}

#[test]
fn a_kind_without_choices_that_cost_something_says_so() {
    for kind in [Kind::STABILITY, Kind::BREAKING_POINTS] {
        let case = kind.case();
        case.succeeds(&["run", "study.toml", "--out", "found"]);
        let error = refused(&case, &["advise", "found", "--budget", "1"]);
        assert!(error.contains("no table offers choices"), "{error}");
    }
}

#[test]
fn axes_of_a_study_are_choices_that_are_advised_and_settings_that_are_compared() {
    let case = Case::new();
    let study = "question = \"?\"\n[objects]\nsets = [\"cans\"]\n[skin]\npitch_mm = 8.0\ntaxels = 8\nstroke_mm = 5.0\n[touches]\n\
         per_object = 16\noffset_x_mm = { uniform = [-9.0, 9.0] }\n[signal]\nnoise_std_full_scale = [0.0, 0.3]\n[sensing]\n\
         ratio = 4\n[recognition]\nclassifier = \"linear_svm\"\n[axes]\n\"touches.depth_mm\" = [1.0, 3.0]\n";
    case.file("study.toml", study);
    case.succeeds(&["run", "study.toml", "--out", "found"]);
    let advice = json(&case, &["--budget", "1e9", "--given", "noise=0.3"]);
    let answers = advice["answers"].as_array().unwrap();
    assert_eq!(answers.len(), 1, "{advice}");
    let setting = answers[0]["choice"]["setting"].as_str().unwrap();
    assert!(setting.contains("depth"), "{setting}");
    let error = refused(
        &case,
        &["advise", "found", "--budget", "1", "--given", "depth_mm=1"],
    );
    assert!(error.contains("is a choice"), "{error}");
    case.file("deeper.toml", study.replace("[1.0, 3.0]", "[3.0, 4.0]"));
    case.succeeds(&["run", "deeper.toml", "--out", "deeper"]);
    let (said, _) = case.succeeds(&["compare", "found", "deeper"]);
    assert!(
        said.contains("accuracy.csv: 2 settings are in both runs, 2 in the first alone, 2 in the"),
        "{said}"
    );
    assert!(said.contains("accuracy: 2 the same, 0 better"), "{said}");
}

/// What `compare` writes.
#[derive(serde::Deserialize)]
struct Moved {
    table: String,
    column: String,
    row: usize,
    n_trials: usize,
    second: f64,
    difference: f64,
    moved: String,
}

fn compared(case: &Case, folders: [&str; 2]) -> (String, Vec<Moved>) {
    let [first, second] = folders;
    let arguments = [
        "compare",
        first,
        second,
        "--out",
        "moved.csv",
        "--html",
        "moved.html",
    ];
    let (said, _) = case.succeeds(&arguments);
    let mut rows = csv::Reader::from_path(case.path("moved.csv")).unwrap();
    (said, rows.deserialize().map(|row| row.unwrap()).collect())
}

#[test]
fn two_folders_of_every_kind_stand_side_by_side() {
    for kind in Kind::ALL {
        let case = kind.case();
        let (old, new) = match kind.change {
            // As many touches, since these are a setting.
            ("per_object = 24", ..) => ("[0.0, 360.0]", "[0.0, 90.0]"),
            (old, new, _) => (old, new),
        };
        assert!(kind.study.contains(old));
        case.file("changed.toml", kind.study.replacen(old, new, 1));
        case.succeeds(&["run", "study.toml", "--out", "found"]);
        case.succeeds(&["run", "changed.toml", "--out", "changed"]);
        let (said, same) = compared(&case, ["found", "found"]);
        assert!(
            !same.is_empty() && said.contains("0 in the first alone, 0 in the"),
            "{said}"
        );
        assert!(
            same.iter()
                .all(|row| row.difference == 0.0 && row.moved == "same")
        );
        let (said, moved) = compared(&case, ["found", "changed"]);
        assert!(said.contains("settings are in both runs"), "{said}");
        let (_, tables) = read_tables(&case.path("changed")).unwrap();
        let mut told: Vec<(&str, &str)> = Vec::new();
        for row in &moved {
            let table = tables.iter().find(|table| table.file == row.table).unwrap();
            if row.n_trials == 1 {
                let stands = table.number(&row.column, row.row);
                assert_eq!(row.second, stands, "{}: {}", row.table, row.column);
            }
            let what = (&row.table[..], &row.column[..]);
            if !told.contains(&what) {
                told.push(what);
            }
        }
        // Values, and costs apart from them.
        assert!(told.len() > 1, "{told:?}");
        assert!(said.contains("times that of the first run"), "{said}");
        let page = fs::read_to_string(case.path("moved.html")).unwrap();
        assert!(page.contains("in both runs") && page.contains("Costs of both runs"));
    }
}

#[test]
fn studies_of_two_kinds_have_nothing_to_compare() {
    let case = Case::new();
    for (folder, kind) in [("a", Kind::STABILITY), ("b", Kind::BREAKING_POINTS)] {
        case.file(&format!("{folder}.toml"), kind.study);
        case.succeeds(&["run", &format!("{folder}.toml"), "--out", folder]);
    }
    let error = refused(&case, &["compare", "a", "b"]);
    assert!(
        error.contains("where recognition breaks; a folder of"),
        "{error}"
    );
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
    assert!(said.contains("Nothing here is better"), "{said}");
    // Every requirement is a filter of the same front.
    let all = |more: &[&str]| {
        let (said, _) = case.succeeds(&[&["advise", "results", "--json"], more].concat());
        let advice: serde_json::Value = serde_json::from_str(&said).unwrap();
        advice["answers"][0]["choice"]["measurements"].as_f64()
    };
    assert_eq!(all(&["--max-measurements", "8"]), Some(8.0));
    assert_eq!(
        all(&["--max-measurements", "31", "--accuracy", "0.1"]),
        Some(8.0)
    );
    let (m, taxels) = ("measurements", ["--max-taxels", "64"]);
    assert_eq!(
        all(&[
            &taxels[..],
            &[
                "--max-answer-ms",
                "1e6",
                "--max-training-s",
                "1e6",
                "--reach",
                "0.01",
                "--cost",
                m
            ]
        ]
        .concat()),
        Some(8.0)
    );
    for (arguments, wanted) in [
        (
            &["--max-measurements", "7"][..],
            "measurements a decision 7; the smallest here is measurements a decision 8",
        ),
        (
            &["--accuracy", "0.1", "--budget", "7", "--cost", m],
            "the smallest here is measurements a decision 8",
        ),
        (&["--max-taxels", "-1"], "a positive number"),
        (&["--accuracy", "1.5"], "at most 1"),
        (&[], "--accuracy"),
        (
            &["--accuracy", "0.5", "--reach", "0.5"],
            "cannot be used with",
        ),
    ] {
        let output = case.run(&[&["advise", "results"], arguments].concat());
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(error.contains(wanted), "{arguments:?}: {error}");
    }
    fs::create_dir(case.path("old")).unwrap();
    case.file("old/study.toml", "question = \"?\"\n[speed_accuracy]\n");
    for arguments in [
        &["run", "old/study.toml"][..],
        &["advise", "old", "--accuracy", "0.5"],
    ] {
        let error = refused(&case, arguments);
        let wanted = "key speed_accuracy: a kind of study that exists no more; a recognition study";
        assert!(error.contains(wanted), "{error}");
    }
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
        few.contains("measurements a decision 8") && few.contains("m = 8"),
        "{few}"
    );
    let taxels = advise(&["--cost", "taxels", "--given", "noise=0", "--json"]);
    let taxels: serde_json::Value = serde_json::from_str(&taxels).unwrap();
    assert_eq!(taxels["answers"][0]["choice"]["taxels"], 64.0);
    for (given, said) in [
        ("smoothing_mm=0", "is a choice"),
        ("noise=0.07", "one of 0, 0.05, 0.2"),
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
