//! A classifier that is a command: its files, its errors, its time limit, and its version.
#![cfg(unix)]

use crate::bad_input::refused;
use crate::command::{Case, says};
use bubbletouch::study::write_integers;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::os::unix::fs::PermissionsExt;

/// Returns a study with these values of `recognition.classifier`.
fn study(classifiers: &str) -> String {
    format!(
        "question = \"q\"\ntrials = 2\nobjects = {{ sets = [\"cans\"], surface_error_mm = 1.0 }}\n\
        skin = {{ pitch_mm = 8.0, size_mm = 64.0, stroke_mm = 5.0 }}\n\
        touches = {{ per_object = 8, offset_x_mm = {{ uniform = [-8.0, 8.0] }}, depth_mm = 3.0 }}\n\
        sensing = {{ ratio = 4.0 }}\n[recognition]\nclassifier = {classifiers}\n"
    )
}

/// Number of test rows: two of eight touches of each of nine cans.
const N_TEST: usize = 18;

/// Creates a case with a program `mine.sh` that predicts the first object for each row, and logs its arguments.
fn case_of_first_object() -> Case {
    let case = Case::new();
    write_integers(&case.path("first.npy"), [0; N_TEST]).unwrap();
    case.file(
        "mine.sh",
        "echo \"$# $(wc -c < $2) $(wc -c < $3)\" >> calls\ncp $1 $4\n",
    );
    case
}

const FIRST: &str = "{ command = [\"sh\", \"mine.sh\", \"first.npy\"], version = \"2\" }";

fn n_calls(case: &Case) -> usize {
    let calls = fs::read_to_string(case.path("calls")).unwrap_or_default();
    calls.lines().count()
}

#[test]
fn a_command_is_a_classifier_of_a_study() {
    let case = case_of_first_object();
    case.file("study.toml", study(&format!("[\"linear_svm\", {FIRST}]")));
    let run = ["run", "study.toml", "--out", "out"];
    case.succeeds(&run);
    let calls = fs::read_to_string(case.path("calls")).unwrap();
    let bytes =
        |line: &str| -> Vec<usize> { line.split(' ').map(|n| n.parse().unwrap()).collect() };
    for line in calls.lines() {
        // 54 training and 18 test rows of 16 features.
        let [n_arguments, train, test] = bytes(line)[..] else {
            panic!("{line}")
        };
        assert_eq!(n_arguments, 4);
        assert!((54 * 17 * 8..54 * 17 * 8 + 2000).contains(&train), "{line}");
        assert!((18 * 16 * 8..18 * 16 * 8 + 1000).contains(&test), "{line}");
    }
    let table = fs::read_to_string(case.path("out/accuracy.csv")).unwrap();
    let mut rows = csv::Reader::from_reader(table.as_bytes());
    let headers = rows.headers().unwrap().clone();
    let place = |name: &str| headers.iter().position(|header| header == name).unwrap();
    let rows: Vec<_> = rows
        .records()
        .map(Result::unwrap)
        .filter(|row| &row[place("classifier")] == "mine")
        .collect();
    assert_eq!(rows.len(), 2);
    assert!(
        rows.iter()
            .all(|row| &row[place("n_correct")] == "2" && &row[place("n_test")] == "18")
    );
    assert!(
        fs::read_to_string(case.path("out/report.html"))
            .unwrap()
            .contains("mine")
    );

    // The program trains and decides in one call, whose time is the time of decisions and a part of the training time.
    let table = fs::read_to_string(case.path("out/timing.csv")).unwrap();
    let mut times = csv::Reader::from_reader(table.as_bytes());
    let headers = times.headers().unwrap().clone();
    let place = |name: &str| headers.iter().position(|header| header == name).unwrap();
    for row in times.records().map(Result::unwrap) {
        let seconds = |name: &str| -> f64 { row[place(name)].parse().unwrap() };
        if &row[place("classifier")] == "mine" {
            assert!(seconds("predict_s") > 1e-4, "{row:?}");
            assert!(seconds("fit_s") >= seconds("predict_s"), "{row:?}");
        }
    }

    // A second run and a report use the stored results and do not call the program.
    assert_eq!(n_calls(&case), 2);
    case.succeeds(&run);
    case.succeeds(&["report", "out"]);
    assert_eq!(n_calls(&case), 2);
    // If the program or its version changes, its results are computed again; results of other classifiers are not.
    case.file("mine.sh", "echo new >> calls\ncp $1 $4\n");
    case.succeeds(&run);
    assert_eq!(n_calls(&case), 4);
    let later = FIRST.replace("\"2\"", "\"3\"");
    case.file("study.toml", study(&format!("[\"linear_svm\", {later}]")));
    case.succeeds(&run);
    assert_eq!(n_calls(&case), 6);
    // The study file in the result folder gives equal results in another folder.
    case.succeeds(&["run", "out/study.toml", "--out", "elsewhere"]);
    assert_eq!(
        fs::read(case.path("out/summary.csv")).unwrap(),
        fs::read(case.path("elsewhere/summary.csv")).unwrap()
    );
}

/// Program that predicts the first object for each row if `alpha` is 1, and the second object otherwise.
const SWEPT: &str = "{ command = [\"sh\", \"mine.sh\", \"first.npy\", \"--alpha={alpha}\"] }";

fn case_of_alpha() -> Case {
    let case = case_of_first_object();
    write_integers(&case.path("second.npy"), [1; N_TEST]).unwrap();
    case.file(
        "mine.sh",
        "echo $2 >> calls\nif [ $2 = --alpha=1 ]; then cp $1 $5; else cp second.npy $5; fi\n",
    );
    case
}

#[test]
fn a_parameter_of_a_command_is_an_axis_with_a_column_of_its_name() {
    let case = case_of_alpha();
    let text = study(&format!("[\"nearest_centroid\", {SWEPT}]"))
        + "[axes]\n\"recognition.parameters.mine.alpha\" = [1, 2.5]\n";
    case.file("study.toml", &text);
    case.succeeds(&["run", "study.toml", "--out", "out"]);
    let calls = fs::read_to_string(case.path("calls")).unwrap();
    let mut calls: Vec<&str> = calls.lines().collect();
    calls.sort_unstable();
    assert_eq!(
        calls,
        ["--alpha=1", "--alpha=1", "--alpha=2.5", "--alpha=2.5"]
    );
    let rows = |table: &str| -> Vec<BTreeMap<String, String>> {
        let mut reader = csv::Reader::from_path(case.path(table)).unwrap();
        reader.deserialize().map(Result::unwrap).collect()
    };
    // The program answers with the object that its value of alpha selects.
    let answers = rows("out/confusion.csv");
    let answers_of = |alpha: &str| -> BTreeSet<String> {
        let of =
            |row: &BTreeMap<String, String>| row["classifier"] == "mine" && row["alpha"] == alpha;
        let row = rows("out/summary.csv").into_iter().find(of).unwrap();
        let of = |one: &&BTreeMap<String, String>| {
            one["configuration"] == row["configuration"] && one["count"] != "0"
        };
        answers
            .iter()
            .filter(of)
            .map(|one| one["predicted"].clone())
            .collect()
    };
    let (first, second) = (answers_of("1"), answers_of("2.5"));
    assert_eq!((first.len(), second.len()), (1, 1));
    assert_ne!(first, second);
    // A continued run calls the program for new values alone.
    case.file("study.toml", text.replace("[1, 2.5]", "[1, 2.5, 4]"));
    case.succeeds(&["run", "study.toml", "--out", "out"]);
    assert_eq!(n_calls(&case), 6);
    case.succeeds(&["run", "out/study.toml", "--out", "elsewhere"]);
    let bytes = |folder: &str| fs::read(case.path(folder).join("summary.csv")).unwrap();
    assert_eq!(bytes("out"), bytes("elsewhere"));
}

#[test]
fn a_parameter_that_no_classifier_of_your_own_has_is_refused() {
    let case = case_of_alpha();
    for (classifier, keys, words) in [
        (
            SWEPT,
            "parameters.mine.beta = 1",
            "key recognition.parameters.mine: classifier mine: parameter beta; {beta} in a word of its command",
        ),
        (
            SWEPT,
            "parameters.random_forest.n_trees = 3",
            "key recognition.parameters.random_forest: given, but the study has no classifier or features of your own",
        ),
        (
            SWEPT,
            "parameters.mine = 3",
            "study.toml:9:19: invalid type: integer `3`; expected a map",
        ),
        (
            SWEPT,
            "",
            "classifier mine: {alpha} without a value; a value of recognition.parameters.mine.alpha",
        ),
        (
            SWEPT,
            "[axes]\n\"recognition.parameters.mine.{alpha,beta}\" = [1, 2]",
            "parameter beta",
        ),
    ] {
        case.file("study.toml", study(classifier) + keys + "\n");
        refused(&case.run(&["run", "study.toml"]), 2, &[words]);
    }
}

#[test]
fn a_command_that_fails_is_named_with_its_message() {
    let case = case_of_first_object();
    write_integers(&case.path("few.npy"), [0; 3]).unwrap();
    write_integers(&case.path("unknown.npy"), [9; N_TEST]).unwrap();
    for (number, (program, words)) in [
        (
            "echo first >&2; echo 'no convergence' >&2; exit 3",
            ["exit status: 3: no convergence", "exit code 0"],
        ),
        ("exit 1", ["exit status: 1: no message", "exit code 0"]),
        ("kill -9 $$", ["signal: 9", "exit code 0"]),
        ("true", ["labels.npy", "exit code 0"]),
        ("echo 3 > $4", ["labels.npy", "exit code 0"]),
        ("cp few.npy $4", ["3 labels for 18 rows", "one label a row"]),
        (
            "cp unknown.npy $4",
            ["label 9", "labels of the training rows"],
        ),
        (
            "sleep 60",
            ["longer than its time limit, 0.5 s", "exit code 0"],
        ),
    ]
    .into_iter()
    .enumerate()
    {
        case.file("mine.sh", format!("{program}\n"));
        let classifier = FIRST.replace("version = \"2\"", "time_limit_s = 0.5");
        case.file("study.toml", study(&classifier));
        let out = format!("out{number}");
        let run = ["run", "study.toml", "--out", &out, "--fail-fast"];
        refused(
            &case.run(&run),
            2,
            &[
                "configuration 0 (mine, raw), trial ",
                "classifier mine: ",
                words[0],
                words[1],
            ],
        );
        assert!(!case.path(&out).join("summary.csv").exists());
    }
    case.file("study.toml", study("{ command = [\"./nothing\"] }"));
    refused(
        &case.run(&["run", "study.toml", "--fail-fast"]),
        2,
        &["classifier nothing: ./nothing cannot be run"],
    );
    // Without --fail-fast, other classifiers are finished.
    case.file("mine.sh", "echo 'no convergence' >&2; exit 3\n");
    case.file(
        "study.toml",
        study(&format!("[\"nearest_centroid\", {FIRST}]")),
    );
    let output = case.run(&["run", "study.toml", "--out", "others"]);
    assert!(!output.status.success());
    let said = String::from_utf8_lossy(&output.stderr);
    let reason = "others/failures.csv: 2 of 5 work items failed; the file says why, and the same command tries them again. The first reason: \
        configuration 1 (mine, raw), trial 0, classifier mine: sh ended with exit status: 3: no convergence";
    assert!(said.contains(reason), "{said}");
    let failures = fs::read_to_string(case.path("others/failures.csv")).unwrap();
    assert_eq!(failures.matches("no convergence").count(), 2, "{failures}");
    assert!(case.path("others/summary.csv").exists());
}

#[test]
fn a_classifier_that_cannot_be_trained_is_refused_before_a_file_is_written() {
    let case = case_of_first_object();
    for (classifier, words) in [
        (
            "[\"nearest_centroid\", \"mine@1\"]",
            ["classifier mine: no code for version 1", "bubbletouch.run"],
        ),
        (
            "{ command = [\"no_such_program\"] }",
            [
                "classifier no_such_program: no_such_program cannot be run",
                "PATH",
            ],
        ),
        (
            "[\"nearest_centroid\", { command = [\"./no_such.sh\"], name = \"mine\" }]",
            ["classifier mine: ./no_such.sh cannot be run", "PATH"],
        ),
    ] {
        case.file("study.toml", study(classifier));
        let before = case.names();
        for command in [
            &["run"][..],
            &["run", "--fresh"],
            &["run", "--shard", "1/2"],
            &["slurm", "--array", "2"],
        ] {
            // A program in a folder of PATH may be installed on the nodes of the cluster alone.
            if command[0] == "slurm" && words[0].contains("no_such_program") {
                continue;
            }
            let arguments = [command, &["study.toml", "--out", "new"]].concat();
            refused(&case.run(&arguments), 2, &words);
            assert_eq!(case.names(), before, "{command:?}");
        }
    }
    // Old results stay where they are, and finished results need no code.
    case.file("study.toml", study("\"nearest_centroid\""));
    assert!(
        case.run(&["run", "study.toml", "--out", "old"])
            .status
            .success()
    );
    let journal = fs::read(case.path("old/journal.jsonl")).unwrap();
    case.file("study.toml", study("[\"nearest_centroid\", \"mine@1\"]"));
    let before = case.names();
    for fresh in [&[][..], &["--fresh"]] {
        let arguments = [&["run", "study.toml", "--out", "old"], fresh].concat();
        refused(&case.run(&arguments), 2, &["classifier mine: no code"]);
    }
    assert_eq!(case.names(), before);
    assert_eq!(fs::read(case.path("old/journal.jsonl")).unwrap(), journal);
}

#[test]
fn a_program_that_only_the_nodes_have_is_a_note_of_slurm() {
    let case = Case::new();
    let two = "[\"linear_svm\", { command = [\"no_such_program\"] }, { command = [\"no_such_program\", \"2\"], name = \"other\" }]";
    case.file("study.toml", study(two));
    case.file("squeue", "#!/bin/sh\n");
    case.file("sbatch", "#!/bin/sh\necho 7\n");
    for name in ["squeue", "sbatch"] {
        fs::set_permissions(case.path(name), fs::Permissions::from_mode(0o755)).unwrap();
    }
    let mut command = case.command(&["slurm", "study.toml", "--out", "new", "--array", "2"]);
    let path = std::env::var("PATH").unwrap();
    let output = command.env("PATH", format!("{}:{path}", case.folder().display()));
    let output = output.output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{error}");
    for name in ["no_such_program", "other"] {
        let line = format!(
            "note: the nodes have to have it: classifier {name}: no_such_program cannot be run: no such program;"
        );
        assert_eq!(error.matches(&line).count(), 1, "{error}");
    }
    let said = String::from_utf8(output.stdout).unwrap();
    says(&said, &["submitted 2 of 2 shards as job 7"]);
}

#[test]
fn a_merge_without_any_results_writes_nothing() {
    let case = case_of_first_object();
    case.file("study.toml", study("\"nearest_centroid\""));
    let before = case.names();
    refused(
        &case.run(&["merge", "study.toml", "--out", "new"]),
        2,
        &["are in none of the 0 journals"],
    );
    assert_eq!(case.names(), before);
}
