//! Output of the command on its own abilities and on planned work.

use crate::command::{Case, says};
use std::path::Path;

const STUDY: &str = include_str!("../fixtures/texts/surface.toml");

/// Returns the words of the line that starts with `first`.
fn line<'a>(said: &'a str, first: &str) -> Vec<&'a str> {
    said.lines()
        .map(|line| line.split_whitespace().collect::<Vec<_>>())
        .find(|words| words.first() == Some(&first))
        .unwrap_or_else(|| panic!("no line starts with '{first}': {said}"))
}

#[test]
fn a_plan_prints_items_touches_and_memory_and_writes_nothing() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    let (said, error) = case.succeeds(&["plan", "study.toml", "--threads", "2"]);
    says(&said, &["What would it do?"]);
    assert_eq!(line(&said, "objects"), ["objects", "3"]);
    assert_eq!(
        line(&said, "touches")[..6],
        ["touches", "60", "on", "each", "of", "2"]
    );
    // Touches of two arrays; for each array three ratios, two classifiers and three trials.
    assert_eq!(
        line(&said, "items"),
        ["items", "38,", "of", "12", "configurations"]
    );
    assert_eq!(line(&said, "memory")[3..], ["MiB", "on", "2", "threads"]);
    assert!(!said.contains("time"), "{said}");
    assert_eq!(error, "");
    assert_eq!(case.names(), ["study.toml"]);
}

#[test]
fn a_plan_estimates_the_time_from_a_sample_and_writes_nothing() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    let sampled = |option| {
        let (said, _) = case.succeeds(&["plan", "study.toml", option]);
        line(&said, "time").join(" ")
    };
    // All 38 work items take less than a minute, and the first takes more than a microsecond.
    let whole = sampled("--time=60");
    says(&whole, &["(38 of 38 work items took "]);
    let begun = sampled("--time=0.000001");
    says(&begun, &["no work item finished in "]);
    assert!(begun.ends_with("; --time=1 samples longer"), "{begun}");
    for wrong in ["--time=0", "--time=nan", "--time=-1", "--time=long"] {
        case.refuses(&["plan", "study.toml", wrong]);
    }
    assert_eq!(case.names(), ["study.toml"]);
}

#[test]
fn a_plan_counts_the_rows_that_a_run_writes() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    case.succeeds(&["run", "study.toml", "--out", "results"]);
    let table = std::fs::read_to_string(case.path("results/accuracy.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 36);
}

#[test]
fn the_objects_are_listed_by_name_set_and_size() {
    let case = Case::new();
    let (said, _) = case.succeeds(&["objects"]);
    let names: Vec<&str> = said
        .lines()
        .skip(1)
        .filter_map(|line| line.split_whitespace().nth(1))
        .collect();
    assert!(names.len() >= 60, "{} objects: {said}", names.len());
    for name in ["mug", "power_drill", "golf", "box_158x60x210"] {
        assert!(names.contains(&name), "{name} is in {names:?}");
    }
    assert!(!said.contains('\u{1b}'), "no escape codes when piped");
    let (boxes, _) = case.succeeds(&["objects", "box_158x60x210"]);
    assert_eq!(boxes.lines().count(), 2, "{boxes}");
    says(&boxes, &["158 × 60 × 210"]);
    let (set, _) = case.succeeds(&["objects", "--set", "cans"]);
    assert_eq!(set.lines().count(), 1 + 9, "{set}");
    assert!(case.names().is_empty(), "nothing is written");
}

#[test]
fn an_object_and_a_sheet_of_them_are_drawn() {
    let case = Case::new();
    case.succeeds(&["objects", "mug", "--out", "mug.png"]);
    case.succeeds(&["objects", "mug", "banana", "key", "--out", "sheet.png"]);
    for name in ["mug.png", "sheet.png"] {
        let file = std::fs::File::open(case.path(name)).unwrap();
        let mut picture = png::Decoder::new(std::io::BufReader::new(file))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; picture.output_buffer_size().unwrap()];
        picture.next_frame(&mut pixels).unwrap();
        assert!(
            pixels.iter().any(|&p| p != pixels[0]),
            "{name} shows something"
        );
    }
}

#[test]
fn every_subcommand_explains_itself() {
    let case = Case::new();
    let (said, _) = case.succeeds(&["--help"]);
    for subcommand in ["run", "plan", "touches", "press", "objects"] {
        assert!(line(&said, subcommand).len() > 3, "{said}");
        let (help, _) = case.succeeds(&[subcommand, "--help"]);
        says(&help, &[&format!("Usage: bubbletouch {subcommand}")]);
        let (again, _) = case.succeeds(&["help", subcommand]);
        assert_eq!(help, again);
    }
    let (version, _) = case.succeeds(&["--version"]);
    assert_eq!(
        version.trim(),
        concat!("bubbletouch ", env!("CARGO_PKG_VERSION"))
    );
    assert!(case.names().is_empty(), "nothing is written");
}

#[test]
fn one_thread_is_not_called_threads() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    let (said, _) = case.succeeds(&["plan", "study.toml", "--threads", "1"]);
    assert!(
        line(&said, "memory").join(" ").ends_with("on 1 thread"),
        "{said}"
    );
}

#[test]
fn without_a_subcommand_the_quickstart_is_what_would_run() {
    // The study takes half a minute, so it is only planned here, in a folder without experiments.
    let case = Case::new();
    let (said, _) = case.succeeds(&["plan", "experiments/quickstart.toml"]);
    assert!(said.starts_with("quickstart: "), "{said}");
    let (help, _) = case.succeeds(&["--help"]);
    says(&help, &["experiments/quickstart.toml"]);
}

#[test]
fn the_bare_command_keeps_results_of_another_commit() {
    let case = Case::new();
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/quickstart");
    std::fs::create_dir_all(case.path("results/quickstart")).unwrap();
    for name in ["manifest.json", "summary.csv", "study.toml"] {
        let text = std::fs::read_to_string(results.join(name)).unwrap();
        case.file(&format!("results/quickstart/{name}"), &text);
    }
    let before = std::fs::read(case.path("results/quickstart/summary.csv")).unwrap();
    let (said, _) = case.succeeds(&[]);
    says(&said, &["results of another commit", "--fresh"]);
    let after = std::fs::read(case.path("results/quickstart/summary.csv")).unwrap();
    assert!(before == after && !case.path("results/quickstart/report.html").exists());
}
