//! Advice and comparison for studies of every kind: which choice to take, and which differences exist between two folders.

use crate::command::{Case, says};
use crate::kinds::Kind;

fn json(case: &Case, arguments: &[&str]) -> serde_json::Value {
    let (said, _) = case.succeeds(&[&["advise", "found", "--json"], arguments].concat());
    serde_json::from_str(&said).unwrap()
}

fn refused(case: &Case, arguments: &[&str]) -> String {
    case.refuses(arguments)
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
    says(setting, &["depth"]);
    let error = refused(
        &case,
        &["advise", "found", "--budget", "1", "--given", "depth_mm=1"],
    );
    says(&error, &["is a choice"]);
    case.file("deeper.toml", study.replace("[1.0, 3.0]", "[3.0, 4.0]"));
    case.succeeds(&["run", "deeper.toml", "--out", "deeper"]);
    let (said, _) = case.succeeds(&["compare", "found", "deeper"]);
    let line = said.lines().find(|line| line.starts_with("accuracy.csv"));
    let counts: Vec<&str> = line.unwrap().split_whitespace().skip(1).collect();
    assert_eq!(counts, ["2", "2", "2"], "{said}");
}

#[test]
fn studies_of_two_kinds_have_nothing_to_compare() {
    let case = Case::new();
    for (folder, kind) in [("a", Kind::STABILITY), ("b", Kind::TEST_TOUCHES)] {
        case.file(&format!("{folder}.toml"), kind.study);
        case.succeeds(&["run", &format!("{folder}.toml"), "--out", folder]);
    }
    let error = refused(&case, &["compare", "a", "b"]);
    says(&error, &["recognises objects; a folder of"]);
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
    says(&said, &["No configuration is better"]);
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
        let error = case.refuses(&[&["advise", "results"], arguments].concat());
        assert!(error.contains(wanted), "{arguments:?}: {error}");
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
    // Noise occurs only here: it is neither part of a setting nor a next choice.
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
    // The fewest measurements, and the fewest taxels; all belong to one array.
    let few = advise(&["--cost", "measurements", "--given", "noise=0"]);
    says(&few, &["measurements a decision 8", "m = 8"]);
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
        let error = case.refuses(&["advise", "r", "--accuracy", "0.1", "--given", given]);
        assert!(error.contains(said), "{given}: {error}");
    }
}

#[test]
fn training_touches_that_follow_the_split_are_no_choice() {
    let case = Case::new();
    let study = "question = \"?\"\ntrials = 2\n[objects]\nsets = [\"cans\"]\n[skin]\npitch_mm = 8.0\ntaxels = 8\nstroke_mm = 5.0\n\
         [touches]\noffset_x_mm = { grid = [-6.0, 6.0, 4] }\nyaw_deg = { grid = [0.0, 45.0, 4] }\ndepth_mm = 3.0\n\
         [recognition]\nclassifier = [\"linear_svm\", \"nearest_centroid\"]\n";
    let axes = "[axes]\n\"recognition.split\" = [\"random\", \"half_of_yaws\"]\n";
    case.file("study.toml", format!("{study}{axes}"));
    case.succeeds(&["run", "study.toml", "--out", "found"]);
    let advice = json(&case, &["--max-measurements", "64", "--worst"]);
    let answer = &advice["answers"][0];
    assert_eq!(answer["n_left_out"], 0, "{advice}");
    let setting = answer["choice"]["setting"].as_str().unwrap();
    assert!(
        setting.starts_with("classifier ") && !setting.contains("training"),
        "{setting}"
    );
    // A value together with a limit of its cost.
    for arguments in [["--reach", "0.01"], ["--accuracy", "0.01"]] {
        let arguments = [&["advise", "found", "--budget", "1e-6"][..], &arguments].concat();
        let error = refused(&case, &arguments);
        says(
            &error,
            &["in none of 2 conditions; with poses held out random: "],
        );
        says(&error, &["limit of time of a decision"]);
    }
}
