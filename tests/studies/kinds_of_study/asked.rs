//! Advice and comparison for studies of every kind: which choice to take, and which differences exist between two folders.

use crate::command::{Case, says};
use crate::kinds::Kind;
use crate::study::changed;

const STUDY: &str = include_str!("../../fixtures/texts/asked.toml");

/// Runs the study with these keys of `[signal]` and these changes into the folder `found`.
fn found(signal: &str, changes: &[(&str, &str)]) -> Case {
    let study = changed(&STUDY.replace("SIGNAL", signal), changes);
    let case = Case::with("study.toml", study);
    case.succeeds("run study.toml --out found");
    case
}

/// Returns the advice for options of the command, as JSON.
fn advice(case: &Case, options: &str) -> serde_json::Value {
    let (said, _) = case.succeeds(&format!("advise found --json {options}"));
    serde_json::from_str(&said).unwrap()
}

/// Asserts that the command refuses these options, each in its words.
fn refuses_options(case: &Case, refusals: &[(&str, &str)]) {
    for (options, wanted) in refusals {
        let error = case.refuses(&format!("advise found {options}"));
        says(&error, &[wanted]);
    }
}

#[test]
fn axes_of_a_study_are_choices_that_are_advised_and_settings_that_are_compared() {
    let axes = "classifier = \"linear_svm\"\n[axes]\n\"touches.depth_mm\" = [1.0, 3.0]";
    let changes = [
        ("depth_mm = 3.0\n", ""),
        ("ratio = [2, 8]", "ratio = 4"),
        ("classifier = \"linear_svm\"", axes),
    ];
    let case = found("noise_std_full_scale = [0.0, 0.3]", &changes);
    let advice = advice(&case, "--budget 1e9 --given noise=0.3");
    let answers = advice["answers"].as_array().unwrap();
    assert_eq!(answers.len(), 1, "{advice}");
    let setting = answers[0]["choice"]["setting"].as_str().unwrap();
    says(setting, &["depth"]);
    refuses_options(&case, &[("--budget 1 --given depth_mm=1", "is a choice")]);
    let study = case.read("study.toml");
    case.file("deeper.toml", study.replace("[1.0, 3.0]", "[3.0, 4.0]"));
    case.succeeds("run deeper.toml --out deeper");
    let (said, _) = case.succeeds("compare found deeper");
    let line = said.lines().find(|line| line.starts_with("accuracy.csv"));
    let counts: Vec<&str> = line.unwrap().split_whitespace().skip(1).collect();
    assert_eq!(counts, ["2", "2", "2"], "{said}");
}

#[test]
fn studies_of_two_kinds_have_nothing_to_compare() {
    let case = Case::new();
    for (folder, kind) in [("a", "stability"), ("b", "test_touches")] {
        case.file("study.toml", Kind::named(kind).study);
        case.succeeds(&["run", "study.toml", "--out", folder]);
    }
    let error = case.refuses("compare a b");
    says(&error, &["recognises objects; a folder of"]);
}

#[test]
fn the_advisor_reads_a_study_that_recognises_objects() {
    let case = found("", &[]);
    let (said, _) = case.succeeds("advise found --budget 1e9");
    says(&said, &["No configuration is better"]);
    // Every requirement is a filter of the same front.
    for options in [
        "--max-measurements 8",
        "--max-measurements 31 --accuracy 0.1",
        "--max-taxels 64 --max-answer-ms 1e6 --max-training-s 1e6 --reach 0.01 --cost measurements",
    ] {
        let choice = &advice(&case, options)["answers"][0]["choice"];
        assert_eq!(choice["measurements"].as_f64(), Some(8.0), "{options}");
    }
    // The limit is in milliseconds, the cost in microseconds.
    let fastest = &advice(&case, "--budget 1e9 --cost decision_time")["answers"][0]["choice"];
    let us = fastest["predict_us_per_decision"].as_f64().unwrap();
    let within = |ms: f64| format!("--max-measurements 64 --max-answer-ms {ms}");
    advice(&case, &within(2e-3 * us));
    refuses_options(
        &case,
        &[(&within(1e-6 * us), "limit of time of a decision")],
    );
    let smallest = "the smallest here is measurements a decision 8";
    let few = format!("measurements a decision 7; {smallest}");
    let refusals = [
        ("--max-measurements 7", &few[..]),
        ("--accuracy 0.1 --budget 7 --cost measurements", smallest),
        ("--max-taxels -1", "a positive number"),
        ("--accuracy 1.5", "at most 1"),
        ("", "--accuracy"),
        ("--accuracy 0.5 --reach 0.5", "cannot be used with"),
    ];
    refuses_options(&case, &refusals);
}

#[test]
fn conditions_of_the_world_are_given_and_never_advised() {
    let signal = "noise_std_full_scale = [0.0, 0.05, 0.2]\nsmoothing_mm = [0.0, 8.0]\nsteps = [\"noise\", \"smoothing\"]";
    let case = found(signal, &[]);
    let advise = |more: &str| {
        let (said, _) = case.succeeds(&format!("advise found --accuracy 0.1 {more}"));
        said
    };
    let said = advise("");
    for noise in ["0 %", "5 %", "20 %"] {
        let head = format!("With noise {noise}:\n");
        assert_eq!(said.matches(&head).count(), 1, "{said}");
    }
    // Noise occurs only here: it is neither part of a setting nor a next choice.
    assert_eq!(said.matches("noise").count(), 3, "{said}");
    says(&said, &["smoothing", "compression"]);
    for key in ["noise=0.05", "noise_std=0.05"] {
        let given = advise(&format!("--given {key}"));
        assert!(given.starts_with("With noise 5 %:\n"), "{given}");
        assert_eq!(given.matches("With noise").count(), 1, "{given}");
        // The answer is the same among all conditions.
        says(&said, &[given.trim_end()]);
    }
    let worst = advise("--worst");
    let head = "With the worst of 3 conditions:\n";
    assert!(worst.starts_with(head), "{worst}");
    // The fewest measurements, and the fewest taxels; all belong to one array.
    let few = advise("--cost measurements --given noise=0");
    says(&few, &["measurements a decision 8", "m = 8"]);
    let taxels = advice(&case, "--accuracy 0.1 --cost taxels --given noise=0");
    assert_eq!(taxels["answers"][0]["choice"]["taxels"], 64.0);
    let other = "is no condition of this study; one of noise_std";
    for (given, words) in [
        ("smoothing_mm=0", "is a choice"),
        ("noise=0.07", "one of 0, 0.05, 0.2"),
        ("gain_std=0.1", other),
        ("noise", "a condition and its value"),
    ] {
        let options = format!("--accuracy 0.1 --given {given}");
        refuses_options(&case, &[(&options, words)]);
    }
}

#[test]
fn training_touches_that_follow_the_split_are_no_choice() {
    let offsets = "offset_x_mm = { grid = [-6.0, 6.0, 4] }\nyaw_deg = { grid = [0.0, 45.0, 4] }";
    let drawn = "per_object = 16\noffset_x_mm = { uniform = [-9.0, 9.0] }";
    let axes = "classifier = [\"linear_svm\", \"nearest_centroid\"]\n[axes]\n\"recognition.split\" = [\"random\", \"half_of_yaws\"]";
    let changes = [
        ("question = \"?\"", "question = \"?\"\ntrials = 2"),
        (drawn, offsets),
        ("[sensing]\nratio = [2, 8]\n", ""),
        ("classifier = \"linear_svm\"", axes),
    ];
    let case = found("", &changes);
    let advice = advice(&case, "--max-measurements 64 --worst");
    let answer = &advice["answers"][0];
    assert_eq!(answer["n_left_out"], 0, "{advice}");
    let setting = answer["choice"]["setting"].as_str().unwrap();
    assert!(setting.starts_with("classifier "), "{setting}");
    assert!(!setting.contains("training"), "{setting}");
    // A value together with a limit of its cost.
    for value in ["--reach 0.01", "--accuracy 0.01"] {
        let error = case.refuses(&format!("advise found --budget 1e-6 {value}"));
        let none = "in none of 2 conditions; with poses held out random: ";
        says(&error, &[none, "limit of time of a decision"]);
    }
}
