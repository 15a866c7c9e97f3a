//! An interrupted run can be continued: for any interruption, the tables equal the tables of an undisturbed run.
#![cfg(unix)]

use crate::command::{Case, words};
use crate::faults::{pieces, said, signal, start};
use crate::kinds::Kind;
use bubbletouch::study::write_integers;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Study with two arrays that trains 64 classifiers in less than a second.
const STUDY: &str = Kind::RECOGNITION.study;

/// Tables without times.
const REPEATABLE: [&str; 7] = [
    "accuracy.csv",
    "summary.csv",
    "confusion.csv",
    "comparison.csv",
    "confused.csv",
    "failures.csv",
    "study.toml",
];

fn case() -> Case {
    let case = Case::new();
    case.file("study.toml", STUDY);
    case.succeeds(&["run", "study.toml", "--out", "whole"]);
    case
}

fn assert_same_tables(case: &Case, folder: &str) {
    for name in REPEATABLE {
        let read = |folder: &str| fs::read(case.path(folder).join(name)).unwrap();
        assert!(read("whole") == read(folder), "{folder}/{name}");
    }
}

#[test]
fn a_journal_whose_tail_is_torn_loses_its_last_line_and_nothing_else() {
    let case = case();
    let journal = case.path("whole/journal.jsonl");
    let bytes = fs::read(&journal).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    for round in 0..4 {
        let n = match round {
            0 => 0,
            1 => 10,
            2 => bytes.len() - 1,
            _ => rng.gen_range(0..bytes.len()),
        };
        fs::write(&journal, &bytes[..n]).unwrap();
        let kept = pieces(&journal);
        let folder = case.path("whole");
        let before = fs::read(folder.join("accuracy.csv")).unwrap();
        fs::write(folder.join("accuracy.csv"), "").unwrap();
        let (_, error) = case.succeeds(&["run", "study.toml", "--out", "whole"]);
        assert!(
            before == fs::read(folder.join("accuracy.csv")).unwrap(),
            "{n} bytes"
        );
        assert_eq!(error.contains("going on"), !kept.is_empty(), "{error}");
        assert_eq!(pieces(&journal)[..kept.len()], kept);
    }
    // A wrong line that is followed by others was not caused by an interrupted run.
    let mut wrong = bytes.clone();
    wrong[bytes.len() / 2] ^= 1;
    fs::write(&journal, &wrong).unwrap();
    let output = case.run(&["run", "study.toml", "--out", "whole"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        said(&output).contains("journal.jsonl: line "),
        "{}",
        said(&output)
    );
    assert!(wrong == fs::read(&journal).unwrap());
}

#[test]
fn ctrl_c_ends_a_run_within_two_seconds_and_says_how_to_go_on() {
    let case = case();
    for name in ["INT", "TERM"] {
        let folder = format!("stopped_{name}");
        let run = start(&case, &["run", "study.toml", "--out", &folder]);
        let journal = case.path(&folder).join("journal.jsonl");
        while pieces(&journal).is_empty() {
            sleep(Duration::from_millis(5));
        }
        let asked = Instant::now();
        signal(&run, name);
        let output = run.wait_with_output().unwrap();
        assert!(asked.elapsed() < Duration::from_secs(2));
        assert_eq!(output.status.code(), Some(130));
        assert!(
            said(&output).contains("the same command continues the run"),
            "{}",
            said(&output)
        );
        let (_, error) = case.succeeds(&["run", "study.toml", "--out", &folder]);
        assert!(error.contains("going on"), "{error}");
        assert_same_tables(&case, &folder);
    }
}

#[test]
fn a_signal_ends_a_run_though_nobody_reads_what_it_says() {
    let case = case();
    let mut run = start(&case, &["run", "study.toml", "--out", "unread"]);
    let journal = case.path("unread/journal.jsonl");
    while pieces(&journal).is_empty() {
        sleep(Duration::from_millis(5));
    }
    drop(run.stderr.take());
    let asked = Instant::now();
    signal(&run, "TERM");
    while run.try_wait().unwrap().is_none() {
        assert!(asked.elapsed() < Duration::from_secs(2), "it hangs");
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_second_run_in_a_folder_is_told_of_the_first() {
    let case = case();
    let mut first = start(&case, &["run", "study.toml", "--out", "shared"]);
    let journal = case.path("shared/journal.jsonl");
    while pieces(&journal).is_empty() {
        sleep(Duration::from_millis(5));
    }
    for arguments in [
        &["run", "study.toml", "--out", "shared"][..],
        &["run", "study.toml", "--out", "shared", "--fresh"],
    ] {
        let second = case.run(arguments);
        assert_eq!(second.status.code(), Some(2));
        assert!(
            said(&second).contains("another run is writing to it"),
            "{}",
            said(&second)
        );
    }
    assert!(first.wait().unwrap().success());
    assert_same_tables(&case, "shared");
}

#[test]
fn a_changed_study_is_refused_with_what_changed_and_fresh_keeps_the_old_beside_the_new() {
    let case = case();
    case.file(
        "study.toml",
        STUDY
            .replace("stroke_mm = 5.0", "stroke_mm = 4.0")
            .replace("per_object = 32", "per_object = 40"),
    );
    let output = case.run(&["run", "study.toml", "--out", "whole"]);
    assert_eq!(output.status.code(), Some(2));
    let error = said(&output);
    for expected in [
        "skin.stroke_mm: was 5.0, is 4.0",
        "touches.per_object: was 32, is 40",
        "--fresh",
    ] {
        assert!(error.contains(expected), "{error}");
    }
    let old = fs::read(case.path("whole/accuracy.csv")).unwrap();
    let (_, error) = case.succeeds(&["run", "study.toml", "--out", "whole", "--fresh"]);
    assert!(error.contains("whole.1"), "{error}");
    assert!(old == fs::read(case.path("whole.1/accuracy.csv")).unwrap());
    assert!(old != fs::read(case.path("whole/accuracy.csv")).unwrap());
    case.succeeds(&["run", "study.toml", "--out", "whole", "--fresh"]);
    assert!(case.path("whole.2/journal.jsonl").exists());
}

/// Runs a study in `folder`; returns the lines of its journal.
fn lines_of(case: &Case, folder: &str) -> Vec<String> {
    let text = fs::read_to_string(case.path(folder).join("journal.jsonl")).unwrap();
    text.split_inclusive('\n').map(str::to_owned).collect()
}

/// Returns a journal line in which a text is replaced and the checksum is corrected.
fn forged(line: &str, old: &str, new: &str) -> String {
    let json = line.trim_end().split_once(' ').unwrap().1;
    assert!(json.contains(old), "{json}");
    let json = json.replace(old, new);
    let mut sum = !0u32;
    for &byte in json.as_bytes() {
        sum ^= u32::from(byte);
        for _ in 0..8 {
            sum = (sum >> 1) ^ (0xedb8_8320 & 0u32.wrapping_sub(sum & 1));
        }
    }
    format!("{:08x} {json}\n", !sum)
}

#[test]
fn a_journal_whose_lines_are_of_no_study_or_of_another_is_refused_and_stays_as_it_is() {
    let case = case();
    let other = STUDY.replace("stroke_mm = 5.0", "stroke_mm = 4.0");
    case.file("other.toml", &other);
    case.succeeds(&["run", "other.toml", "--out", "other"]);
    let (ours, theirs) = (lines_of(&case, "whole"), lines_of(&case, "other"));
    let n = ours.len();
    let header = forged(&ours[0], "stroke_mm = 5.0", "stroke_mm = 4.0");
    let journals = [
        (ours[1..].concat(), "line 1: is no record of a study"),
        (theirs[1..].concat(), "line 1: is no record of a study"),
        (
            [&ours[..], &theirs[1..]].concat().concat(),
            &format!("line {}: does not match its checksum", n + 1),
        ),
        (
            [&ours[..], &ours[..]].concat().concat(),
            &format!("line {}: does not match its checksum", n + 1),
        ),
    ];
    let refused = |study: &str, content: &str, expected: &str| {
        let journal = case.file("whole/journal.jsonl", content);
        let output = case.run(&["run", study, "--out", "whole"]);
        assert_eq!(output.status.code(), Some(2), "{expected}");
        let error = said(&output);
        assert!(error.contains(expected), "{error}");
        assert!(error.contains("--fresh"), "{error}");
        assert!(content == fs::read_to_string(journal).unwrap());
    };
    for (content, expected) in &journals {
        refused("study.toml", content, expected);
    }
    // A first line that was forged for another study does not fit the lines after it.
    let [forged, honest] = [&header, &ours[0]].map(|first| first.clone() + &ours[1..].concat());
    refused("other.toml", &forged, "line 2: does not match its checksum");
    refused("other.toml", &honest, "skin.stroke_mm: was 5.0, is 4.0");
    // Shards are checked in the same way.
    fs::create_dir(case.path("parts")).unwrap();
    case.file("parts/journal.1-of-1.jsonl", ours[1..].concat());
    let merge = case.run(&["merge", "study.toml", "--out", "parts"]);
    assert_eq!(merge.status.code(), Some(2));
    let error = said(&merge);
    assert!(error.contains("line 1: is no record of a study"), "{error}");
    // A repeated line counts once.
    let twice = [&ours[..], &ours[1..]].concat().concat();
    case.file("whole/journal.jsonl", twice);
    case.succeeds(&["run", "study.toml", "--out", "whole"]);
    let (said_of, _) = case.succeeds(&["verify", "whole", "--configurations", "3"]);
    assert!(said_of.contains("3 of 66 work items"), "{said_of}");
}

/// Runs a longer study in a copy of the folder, and from nothing; asserts equal tables and the given number of finished items.
fn assert_grows(case: &Case, (more, n_before, n_all): (&str, usize, usize)) {
    case.file("more.toml", more);
    case.succeeds(&words("run more.toml --out fresh --fresh --threads 3"));
    let folder = format!("grown_{n_all}");
    fs::create_dir(case.path(&folder)).unwrap();
    let journal = case.path(&folder).join("journal.jsonl");
    fs::copy(case.path("whole/journal.jsonl"), journal).unwrap();
    let run = ["run", "more.toml", "--out", &folder, "--threads", "1"];
    let (_, error) = case.succeeds(&run);
    let going_on = format!("going on: {n_before} of {n_all} work items");
    assert!(error.contains(&going_on), "{error}");
    for name in REPEATABLE.iter().chain(&["limits.csv"]) {
        let read = |folder: &str| fs::read(case.path(folder).join(name)).unwrap();
        assert!(read("fresh") == read(&folder), "{folder}/{name}");
    }
    case.succeeds(&["verify", &folder, "--configurations", "5"]);
}

#[test]
fn a_study_that_has_more_trials_and_values_keeps_its_cells_and_comes_out_as_if_run_at_once() {
    let case = case();
    let more = STUDY
        .replace("trials = 2", "trials = 3")
        .replace("What is left", "How much is left")
        .replace(
            "[0.05, 0.2]",
            "[0.05, 0.1, 0.2]\nsteps = [\"crosstalk\", \"noise\"]\ncrosstalk = [0.1, 0.0]",
        );
    assert_grows(&case, (&more, 66, 3 * 2 * 3 * 2 * 2 * 2 * 2 + 2));
    // A study with fewer values also gives the same tables.
    let fewer = STUDY.replace("[0.05, 0.2]", "0.2");
    assert_grows(&case, (&fewer, 34, 34));
}

#[test]
fn keys_that_a_cell_does_not_use_keep_its_work_and_others_are_refused() {
    let case = case();
    // Trees of another classifier, and an array whose finer pitch changes the notes on objects but not the objects.
    let more = STUDY
        .replace("[\"linear_svm\",", "[\"random_forest\", \"linear_svm\",")
        .replace("[4.0, 8.0]", "[2.0, 4.0, 8.0]")
        + "n_trees = 5\n";
    assert_grows(&case, (&more, 66, 64 * 9 / 4 + 3));
    for (key, value) in [("scaling", "\"none\""), ("test_fraction", "0.5")] {
        case.file("other.toml", format!("{STUDY}{key} = {value}\n"));
        let output = case.run(&["run", "other.toml", "--out", "whole"]);
        assert_eq!(output.status.code(), Some(2));
        let error = said(&output);
        let expected = format!("recognition.{key}: was ");
        assert!(
            error.contains(&expected) && error.contains(value),
            "{error}"
        );
    }
}

#[test]
fn a_c_more_trains_only_those_again_that_start_from_one_another() {
    let case = case();
    let more = STUDY.to_owned() + "c = [0.1, 1.0]\n";
    assert_grows(&case, (&more, 34, 66));
}

#[test]
fn other_words_refuse_nothing_and_train_nothing() {
    let case = case();
    let n_lines = lines_of(&case, "whole").len();
    let words = STUDY.replace("What is left", "Expected or not: what is left")
        + "\n[report]\nsamples = [\"mug\"]\n";
    case.file(
        "words.toml",
        "expected = \"All of it.\"\n".to_owned() + &words,
    );
    let (_, error) = case.succeeds(&["run", "words.toml", "--out", "whole"]);
    assert!(error.contains("going on: 66 of 66 work items"), "{error}");
    assert_eq!(lines_of(&case, "whole").len(), n_lines);
    let page = fs::read_to_string(case.path("whole/report.html")).unwrap();
    assert!(page.contains("Expected or not"));
}

/// Study in which five training touches per object are too few for an own classifier, and twenty are enough.
const FAILING: &str = include_str!("../fixtures/texts/resume_failing.toml");

#[test]
fn a_cell_that_fails_is_recorded_and_the_others_are_done() {
    let case = Case::new();
    case.file("failing.toml", FAILING);
    // Twenty rows of 17 numbers have 2,720 bytes.
    case.file(
        "many.sh",
        "[ $(wc -c < $1) -gt 5000 ] || { echo too few rows >&2; exit 1; }\ncp first.npy $3\n",
    );
    write_integers(&case.path("first.npy"), [0; 60]).unwrap();
    let output = case.run(&["run", "failing.toml", "--out", "failing"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        said(&output).contains("failures.csv: 2 of 9 work items failed"),
        "{}",
        said(&output)
    );
    let rows = |name: &str| fs::read_to_string(case.path("failing").join(name)).unwrap();
    assert_eq!(rows("accuracy.csv").lines().count(), 1 + 6);
    assert_eq!(rows("summary.csv").lines().count(), 1 + 3);
    let failures = rows("failures.csv");
    assert_eq!(failures.lines().count(), 1 + 2);
    assert!(
        failures
            .lines()
            .skip(1)
            .all(|line| line.contains("many") && line.contains("too few rows"))
    );
    // Failed items are tried again, the others are not.
    let again = case.run(&["run", "failing.toml", "--out", "failing"]);
    assert_eq!(again.status.code(), Some(1));
    let done = pieces(&case.path("failing/journal.jsonl"));
    assert_eq!(done.len(), 9 + 2, "{done:?}");
    let (output, _) = case.succeeds(&["verify", "failing", "--configurations", "9"]);
    assert!(output.contains("7 of 9 work items"), "{output}");
    let strict = case.run(&["run", "failing.toml", "--out", "strict", "--fail-fast"]);
    assert_eq!(strict.status.code(), Some(2));
    assert!(said(&strict).contains("too few rows"), "{}", said(&strict));
}

#[test]
fn more_shards_than_groups_from_folders_of_their_own_make_the_same_tables() {
    let case = case();
    for index in 1..=20 {
        let (shard, folder) = (format!("{index}/20"), format!("machine_{}", index % 2));
        case.succeeds(&["run", "study.toml", "--out", &folder, "--shard", &shard]);
    }
    case.succeeds(&words("merge study.toml --out machine_0 --from machine_1"));
    assert_same_tables(&case, "machine_0");
    case.file("other.toml", STUDY.replace("trials = 2", "trials = 3"));
    let other = case.run(&["merge", "other.toml", "--out", "machine_0"]);
    assert_eq!(other.status.code(), Some(2));
}

#[test]
fn a_program_that_starts_a_run_reads_json_lines_and_nothing_else() {
    let case = case();
    let (output, error) = case.succeeds(&["run", "study.toml", "--out", "whole", "--json"]);
    assert_eq!(error, "");
    let events: Vec<serde_json::Value> = output
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let last = events.last().unwrap();
    assert_eq!(last["event"], "finished");
    assert_eq!(
        (&last["work_items"], &last["finished_before"]),
        (&66.into(), &66.into())
    );
    let (output, error) = case.succeeds(&["run", "study.toml", "--out", "whole", "--quiet"]);
    assert_eq!((output.as_str(), error.as_str()), ("", ""));
}

#[test]
fn two_runs_side_by_side_say_what_moved() {
    let case = case();
    case.file("noisy.toml", STUDY.replace("[0.05, 0.2]", "[0.2, 0.4]"));
    case.succeeds(&["run", "noisy.toml", "--out", "noisy"]);
    let (output, _) = case.succeeds(&["compare", "whole", "noisy", "--out", "moved.csv"]);
    let line = output.lines().find(|line| line.starts_with("accuracy.csv"));
    let counts: Vec<&str> = line.unwrap().split_whitespace().skip(1).collect();
    assert_eq!(counts, ["16", "16", "16"], "{output}");
    let moved = fs::read_to_string(case.path("moved.csv")).unwrap();
    let of_accuracy = |line: &&str| line.starts_with("accuracy.csv,accuracy,");
    assert_eq!(moved.lines().filter(of_accuracy).count(), 16);
    assert!(
        moved
            .lines()
            .next()
            .unwrap()
            .ends_with("p_holm,p_status,n_trials_needed")
    );
    case.file("other.toml", STUDY.replace("[0.05, 0.2]", "0.7"));
    case.succeeds(&["run", "other.toml", "--out", "other"]);
    // No row is in both folders: differences cannot be written, but both rank the same designs.
    let output = case.run(&["compare", "whole", "other", "--out", "none.csv"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("no row"), "{}", said(&output));
    assert!(!case.path("none.csv").exists());
    let (output, _) = case.succeeds(&["compare", "whole", "other"]);
    assert!(output.contains("designs with a Kendall's τ of"), "{output}");
    assert!(
        output.contains("No row of the one has all settings"),
        "{output}"
    );
}
