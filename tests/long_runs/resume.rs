//! An interrupted run can be continued: for any interruption, the tables equal the tables of an undisturbed run.
#![cfg(unix)]

use crate::command::{Case, says};
use crate::faults::{crc32, pieces, said, signal, start, wait_for_work};
use crate::kinds::Kind;
use crate::pieces::Faults;
use bubbletouch::study::write_integers;
use std::fs;
use std::sync::LazyLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Study with two arrays that trains 64 classifiers in less than a second.
const STUDY: &str = include_str!("../fixtures/kinds/recognition.toml");

/// Paths and contents of the results of the study, which all tests share.
static WHOLE: LazyLock<Vec<(String, Vec<u8>)>> = LazyLock::new(|| {
    let case = Faults::new(Kind::named("recognition")).case;
    let file = |name: String| {
        let path = format!("whole/{name}");
        let content = case.bytes(&path);
        (path, content)
    };
    case.names_in("whole").into_iter().map(file).collect()
});

/// Returns the study with its results in the folder `whole`.
fn whole() -> Faults {
    let kind = Kind::named("recognition");
    let case = kind.case();
    for (path, content) in WHOLE.iter() {
        case.file(path, content);
    }
    Faults { kind, case }
}

#[test]
fn ctrl_c_ends_a_run_within_two_seconds_and_says_how_to_go_on() {
    let whole = whole();
    for name in ["INT", "TERM"] {
        let folder = format!("stopped_{name}");
        let arguments = ["run", "study.toml", "--out", &folder];
        let run = start(&whole.case, &arguments);
        wait_for_work(&whole.case, &folder);
        let asked = Instant::now();
        signal(&run, name);
        let output = run.wait_with_output().unwrap();
        assert!(asked.elapsed() < Duration::from_secs(2));
        assert_eq!(output.status.code(), Some(130));
        let error = said(&output);
        says(&error, &["the same command continues the run"]);
        let (_, error) = whole.case.succeeds(&arguments);
        says(&error, &["going on"]);
        whole.assert_same_tables(&folder);
    }
}

#[test]
fn a_signal_ends_a_run_though_nobody_reads_what_it_says() {
    let case = whole().case;
    let mut run = start(&case, &["run", "study.toml", "--out", "unread"]);
    wait_for_work(&case, "unread");
    drop(run.stderr.take());
    let asked = Instant::now();
    signal(&run, "TERM");
    while run.try_wait().unwrap().is_none() {
        assert!(asked.elapsed() < Duration::from_secs(2), "it hangs");
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_changed_study_is_refused_with_what_changed_and_fresh_keeps_the_old_beside_the_new() {
    let case = whole().case;
    let changed = STUDY
        .replace("stroke_mm = 5.0", "stroke_mm = 4.0")
        .replace("per_object = 32", "per_object = 40");
    case.file("study.toml", changed);
    let error = case.refuses("run study.toml --out whole");
    let stroke = "skin.stroke_mm: was 5.0, is 4.0";
    let touches = "touches.per_object: was 32, is 40";
    says(&error, &[stroke, touches, "--fresh"]);
    let read = |file: &str| case.bytes(file);
    let old = read("whole/accuracy.csv");
    let fresh = ["run", "study.toml", "--out", "whole", "--fresh"];
    let (_, error) = case.succeeds(&fresh);
    says(&error, &["whole.1"]);
    assert!(old == read("whole.1/accuracy.csv"));
    assert!(old != read("whole/accuracy.csv"));
    case.succeeds(&fresh);
    assert!(case.path("whole.2/journal.jsonl").exists());
}

/// Returns the lines of the journal in a folder.
fn lines_of(case: &Case, folder: &str) -> Vec<String> {
    let text = case.read(&format!("{folder}/journal.jsonl"));
    text.split_inclusive('\n').map(str::to_owned).collect()
}

/// Returns a journal line in which a text is replaced and the checksum is corrected.
fn forged(line: &str, old: &str, new: &str) -> String {
    let json = line.trim_end().split_once(' ').unwrap().1;
    says(json, &[old]);
    let json = json.replace(old, new);
    format!("{:08x} {json}\n", crc32(0, json.as_bytes()))
}

#[test]
fn a_journal_whose_lines_are_of_no_study_or_of_another_is_refused_and_stays_as_it_is() {
    let case = whole().case;
    let other = STUDY.replace("stroke_mm = 5.0", "stroke_mm = 4.0");
    case.file("other.toml", other);
    case.succeeds("run other.toml --out other");
    let (ours, theirs) = (lines_of(&case, "whole"), lines_of(&case, "other"));
    let header = forged(&ours[0], "stroke_mm = 5.0", "stroke_mm = 4.0");
    let nameless = "line 1: is no record of a study";
    let stroke = "skin.stroke_mm: was 5.0, is 4.0";
    let mismatch = |line: usize| format!("line {line}: does not match its checksum");
    let no_end = mismatch(ours.len() + 1);
    // A wrong line that is followed by others.
    let mut wrong = ours.clone();
    wrong[9] = wrong[9].replacen("key", "kex", 1);
    // A first line that was forged for another study does not fit the lines after it.
    let other = [&[header], &ours[1..]].concat();
    for (study, journal, expected) in [
        ("study.toml", ours[1..].to_vec(), nameless),
        ("study.toml", theirs[1..].to_vec(), nameless),
        ("study.toml", [&ours[..], &theirs[1..]].concat(), &no_end),
        ("study.toml", [&ours[..], &ours[..]].concat(), &no_end),
        ("study.toml", wrong, &mismatch(10)),
        ("other.toml", other, &mismatch(2)),
        ("other.toml", ours.clone(), stroke),
    ] {
        let content = journal.concat();
        let path = case.file("whole/journal.jsonl", &content);
        let error = case.refuses(&["run", study, "--out", "whole"]);
        says(&error, &[expected, "--fresh"]);
        assert!(content == fs::read_to_string(path).unwrap());
    }
    // Shards are checked in the same way.
    fs::create_dir(case.path("parts")).unwrap();
    case.file("parts/journal.1-of-1.jsonl", ours[1..].concat());
    let error = case.refuses("merge study.toml --out parts");
    says(&error, &[nameless]);
    // A repeated line counts once.
    let twice = [&ours[..], &ours[1..]].concat().concat();
    case.file("whole/journal.jsonl", twice);
    case.succeeds("run study.toml --out whole");
    let (said_of, _) = case.succeeds("verify whole --configurations 3");
    says(&said_of, &["3 of 66 work items"]);
}

#[test]
fn a_study_that_has_more_trials_and_values_keeps_its_cells_and_comes_out_as_if_run_at_once() {
    let whole = whole();
    let noises = "[0.05, 0.1, 0.2]\nsteps = [\"crosstalk\", \"noise\"]\ncrosstalk = [0.1, 0.0]";
    let more = STUDY
        .replace("trials = 2", "trials = 3")
        .replace("What is left", "How much is left")
        .replace("[0.05, 0.2]", noises);
    whole.keeps_its_work(&more, [66, 3 * 2 * 3 * 2 * 2 * 2 * 2 + 2]);
    // A study with fewer values also gives the same tables.
    let fewer = STUDY.replace("[0.05, 0.2]", "0.2");
    whole.keeps_its_work(&fewer, [34, 34]);
}

#[test]
fn keys_that_a_cell_does_not_use_keep_its_work_and_others_are_refused() {
    let whole = whole();
    // Trees of another classifier, and an array whose finer pitch changes the notes on objects but not the objects.
    let more = STUDY
        .replace("[\"linear_svm\",", "[\"random_forest\", \"linear_svm\",")
        .replace("[4.0, 8.0]", "[2.0, 4.0, 8.0]")
        + "n_trees = 5\n";
    whole.keeps_its_work(&more, [66, 64 * 9 / 4 + 3]);
    for (key, value) in [("scaling", "\"none\""), ("test_fraction", "0.5")] {
        let other = format!("{STUDY}{key} = {value}\n");
        whole.case.file("other.toml", other);
        let error = whole.case.refuses("run other.toml --out whole");
        says(&error, &[&format!("recognition.{key}: was ")[..], value]);
    }
}

#[test]
fn a_c_more_trains_only_those_again_that_start_from_one_another() {
    whole().keeps_its_work(&(STUDY.to_owned() + "c = [0.1, 1.0]\n"), [34, 66]);
}

#[test]
fn other_words_refuse_nothing_and_train_nothing() {
    let case = whole().case;
    let n_lines = lines_of(&case, "whole").len();
    let words = STUDY.replace("What is left", "Expected or not: what is left");
    let words = format!("expected = \"All of it.\"\n{words}\n[report]\nsamples = [\"mug\"]\n");
    case.file("words.toml", words);
    let (_, error) = case.succeeds("run words.toml --out whole");
    says(&error, &["going on: 66 of 66 work items"]);
    assert_eq!(lines_of(&case, "whole").len(), n_lines);
    let page = case.read("whole/report.html");
    says(&page, &["Expected or not"]);
}

/// Study in which five training touches per object are too few for an own classifier, and twenty are enough.
const FAILING: &str = include_str!("../fixtures/texts/resume_failing.toml");

#[test]
fn a_cell_that_fails_is_recorded_and_the_others_are_done() {
    let case = Case::with("failing.toml", FAILING);
    // Twenty rows of 17 numbers have 2,720 bytes.
    let many =
        "[ $(wc -c < $1) -gt 5000 ] || { echo too few rows >&2; exit 1; }\ncp first.npy $3\n";
    case.file("many.sh", many);
    write_integers(&case.path("first.npy"), [0; 60]).unwrap();
    let run = ["run", "failing.toml", "--out", "failing"];
    let output = case.run(&run);
    assert_eq!(output.status.code(), Some(1));
    says(&said(&output), &["failures.csv: 2 of 9 work items failed"]);
    let rows = |name: &str| {
        let text = case.read(&format!("failing/{name}"));
        text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(rows("accuracy.csv").len(), 6);
    assert_eq!(rows("summary.csv").len(), 3);
    let failures = rows("failures.csv");
    assert_eq!(failures.len(), 2);
    for failure in failures {
        says(&failure, &["many", "too few rows"]);
    }
    // Failed items are tried again, the others are not.
    assert_eq!(case.run(&run).status.code(), Some(1));
    let done = pieces(&case.path("failing/journal.jsonl"));
    assert_eq!(done.len(), 9 + 2, "{done:?}");
    let (output, _) = case.succeeds("verify failing --configurations 9");
    says(&output, &["7 of 9 work items"]);
    let strict = case.refuses("run failing.toml --out strict --fail-fast");
    says(&strict, &["too few rows"]);
}

#[test]
fn more_shards_than_groups_from_folders_of_their_own_make_the_same_tables() {
    let whole = whole();
    for index in 1..=20 {
        let (shard, folder) = (format!("{index}/20"), format!("machine_{}", index % 2));
        let run = ["run", "study.toml", "--out", &folder, "--shard", &shard];
        whole.case.succeeds(&run);
    }
    let merge = "merge study.toml --out machine_0 --from machine_1";
    whole.case.succeeds(merge);
    whole.assert_same_tables("machine_0");
    let other = STUDY.replace("trials = 2", "trials = 3");
    whole.case.file("other.toml", other);
    whole.case.refuses("merge other.toml --out machine_0");
}

#[test]
fn a_program_that_starts_a_run_reads_json_lines_and_nothing_else() {
    let case = whole().case;
    let (output, error) = case.succeeds("run study.toml --out whole --json");
    assert_eq!(error, "");
    let mut events = output
        .lines()
        .map(serde_json::from_str::<serde_json::Value>);
    let last = events.next_back().unwrap().unwrap();
    assert_eq!(last["event"], "finished");
    for field in ["work_items", "finished_before"] {
        assert_eq!(last[field], 66);
    }
    let (output, error) = case.succeeds("run study.toml --out whole --quiet");
    assert_eq!((output.as_str(), error.as_str()), ("", ""));
}

#[test]
fn two_runs_side_by_side_say_what_moved() {
    let case = whole().case;
    for (folder, noises) in [("noisy", "[0.2, 0.4]"), ("other", "0.7")] {
        case.file("study.toml", STUDY.replace("[0.05, 0.2]", noises));
        case.succeeds(&["run", "study.toml", "--out", folder]);
    }
    let (output, _) = case.succeeds("compare whole noisy --out moved.csv");
    let line = output.lines().find(|line| line.starts_with("accuracy.csv"));
    let counts: Vec<&str> = line.unwrap().split_whitespace().skip(1).collect();
    assert_eq!(counts, ["32", "32", "32"], "{output}");
    let moved = case.read("moved.csv");
    let of_accuracy = |line: &&str| line.starts_with("accuracy.csv,accuracy,");
    assert_eq!(moved.lines().filter(of_accuracy).count(), 16);
    let header = moved.lines().next().unwrap();
    assert!(header.ends_with("p_holm,p_status,n_trials_needed"));
    // No row is in both folders: differences cannot be written, but both rank the same designs.
    let error = case.refuses("compare whole other --out none.csv");
    says(&error, &["no row"]);
    assert!(!case.path("none.csv").exists());
    let (output, _) = case.succeeds("compare whole other");
    let ranks = "designs with a Kendall's τ of";
    says(&output, &[ranks, "No row of the one has all settings"]);
}
