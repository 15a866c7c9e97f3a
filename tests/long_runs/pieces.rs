//! Runs that are killed, interrupted, extended or limited in memory give the tables of an undisturbed run.
#![cfg(unix)]

use crate::command::{Case, says};
use crate::faults::{full_disk, keys, pieces, said, signal, start, wait_for_work};
use crate::kinds::Kind;
use bubbletouch::contact::Instructions;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::thread::sleep;
use std::time::Duration;

/// Study that has been run once, with results in the folder `whole`.
pub struct Faults {
    pub kind: Kind,
    pub case: Case,
}

/// Asserts that no stage exceeds its total, and that no time remains at the end.
fn assert_progress_ends(said: &str) {
    let events = said.lines().map(|line| serde_json::from_str(line).unwrap());
    let progress = events.filter(|event: &serde_json::Value| event["event"] == "progress");
    let progress: Vec<_> = progress.collect();
    let of = |event: &serde_json::Value, field: &str| event[field].as_u64().expect("a count");
    for event in &progress {
        assert!(of(event, "done") <= of(event, "total"), "{event}");
    }
    let left = progress.iter().map(|event| event["run_left_s"].as_f64());
    let left: Vec<f64> = left.flatten().collect();
    assert!(left.iter().all(|&seconds| seconds >= 0.0), "{left:?}");
    assert_eq!(left.last(), Some(&0.0), "{left:?}");
}

/// Returns the numbers and words after a word in the output of `plan`.
pub fn planned(said: &str, word: &str) -> Vec<String> {
    let line = said
        .lines()
        .find(|line| line.trim_start().starts_with(word));
    let line = line.unwrap_or_else(|| panic!("no line starts with '{word}': {said}"));
    line.split_whitespace().skip(1).map(str::to_owned).collect()
}

impl Faults {
    pub fn new(kind: Kind) -> Self {
        let case = kind.case();
        let (said, _) = case.succeeds("run study.toml --out whole --json");
        assert_progress_ends(&said);
        let faults = Self { kind, case };
        let manifest = fs::read_to_string(faults.case.path("whole/manifest.json")).unwrap();
        let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
        assert_eq!(manifest["n_configurations"], faults.n_pieces());
        assert_eq!(manifest["n_failed"], 0);
        let best = serde_json::to_value(Instructions::here().last()).unwrap();
        assert_eq!(manifest["instructions"], best);
        let hashes = manifest["tables_sha256"].as_object().unwrap();
        let mut expected = faults.kind.repeatable.clone();
        expected.push("failures.csv".to_owned());
        expected.sort_unstable();
        assert!(hashes.keys().eq(&expected), "{hashes:?}");
        faults
    }

    pub fn n_pieces(&self) -> usize {
        pieces(&self.case.path("whole/journal.jsonl")).len()
    }

    /// Asserts that the tables without times equal the tables of the whole run, and that no table is empty.
    pub fn assert_same_tables(&self, folder: &str) {
        self.case
            .same_files(["whole", folder], &self.kind.repeatable);
        self.case.same_files(["whole", folder], &["study.toml"]);
    }

    /// Kills runs after some work items until there were enough kills; each run continues the previous one.
    fn is_killed_at_work_items_and_does_none_twice(&self) {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let n_pieces = self.n_pieces();
        let (mut n_kills, mut n_folders) = (0, 0);
        while n_kills < n_kills_wanted() {
            let folder = format!("killed_{n_folders}");
            n_folders += 1;
            let journal = self.case.path(&folder).join("journal.jsonl");
            let mut n_left = n_pieces;
            while n_left > 0 {
                let n = rng.gen_range(1..=n_left.min(1 + n_pieces / 4));
                let run = ["run", "study.toml", "--out", &folder];
                let mut run = start(&self.case, &run);
                // A short run may end before it is killed.
                while pieces(&journal).len() < n_pieces - n_left + n
                    && run.try_wait().unwrap().is_none()
                {
                    sleep(Duration::from_millis(1));
                }
                run.kill().unwrap();
                run.wait().unwrap();
                n_kills += 1;
                let n_left_now = n_pieces - pieces(&journal).len();
                assert!(n_left_now < n_left, "a run keeps what it finished");
                n_left = n_left_now;
            }
            let (_, error) = self.case.succeeds(&["run", "study.toml", "--out", &folder]);
            let all = format!("going on: {n_pieces} of {n_pieces} ");
            says(&error, &[&all]);
            let done = pieces(&journal);
            let different: BTreeSet<&String> = done.iter().collect();
            assert_eq!(done.len(), different.len(), "a piece was done twice");
            self.assert_same_tables(&folder);
        }
    }

    fn loses_no_more_than_a_torn_last_line(&self) {
        let whole = self.case.bytes("whole/journal.jsonl");
        fs::create_dir(self.case.path("torn")).unwrap();
        let journal = self.case.path("torn/journal.jsonl");
        for n in [0, 10, whole.len() / 2, whole.len() - 1] {
            fs::write(&journal, &whole[..n]).unwrap();
            let kept = pieces(&journal);
            let (_, error) = self.case.succeeds("run study.toml --out torn");
            assert_eq!(error.contains("going on"), !kept.is_empty(), "{error}");
            assert_eq!(pieces(&journal)[..kept.len()], kept);
            self.assert_same_tables("torn");
        }
        // Measured times are unchanged.
        let times = |folder: &str| fs::read(self.case.path(folder).join(&self.kind.times)).unwrap();
        fs::write(&journal, &whole).unwrap();
        self.case.succeeds("run study.toml --out torn");
        assert!(times("whole") == times("torn"));
    }

    fn ends_on_a_full_disk_and_goes_on_where_there_is_room(&self) {
        let arguments = ["run", "study.toml", "--out", "full"];
        let output = full_disk(&self.case, 3, &arguments);
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        self.case.succeeds(&arguments);
        self.assert_same_tables("full");
    }

    fn tells_a_second_run_of_the_first(&self) {
        let arguments = ["run", "study.toml", "--out", "shared"];
        let first = start(&self.case, &arguments);
        while keys(&self.case.path("shared/journal.jsonl")).is_empty() {
            sleep(Duration::from_millis(1));
        }
        signal(&first, "STOP");
        for more in [&[][..], &["--fresh"]] {
            let error = self.case.refuses(&[&arguments[..], more].concat());
            says(&error, &["another run is writing to it"]);
        }
        signal(&first, "CONT");
        // After the first finished work item, a signal ends the run without loss.
        wait_for_work(&self.case, "shared");
        signal(&first, "TERM");
        let output = first.wait_with_output().unwrap();
        let stopped = output.status.code() == Some(130);
        assert!(stopped || output.status.success(), "{}", said(&output));
        self.case.succeeds(&arguments);
        self.assert_same_tables("shared");
    }

    fn refuses_a_changed_study(&self) {
        let [old, new, expected] = &self.kind.change;
        assert!(self.kind.study.contains(old));
        let changed = self.kind.study.replace(old, new);
        self.case.file("changed.toml", changed);
        let error = self.case.refuses("run changed.toml --out whole");
        says(&error, &[expected, "--fresh"]);
    }

    fn keeps_its_work_when_there_is_more_of_it(&self) {
        let mut more = self.kind.study.clone();
        for [old, new] in &self.kind.more {
            assert!(more.contains(old), "{old}");
            more = more.replacen(old, new, 1);
        }
        let n_before = self.n_pieces();
        let n_all = self.keeps_its_work(&more, [n_before, 0]);
        assert!(n_before < n_all, "{n_before} of {n_all}");
    }

    /// Runs another study in a copy of the folder, and from nothing; asserts equal tables and the numbers of kept and of all work items. Returns the number of
    /// all work items; 0 is any number.
    pub fn keeps_its_work(&self, study: &str, [n_before, n_all]: [usize; 2]) -> usize {
        let case = &self.case;
        case.file("more.toml", study);
        case.succeeds("run more.toml --out fresh --fresh --threads 3");
        let n = pieces(&case.path("fresh/journal.jsonl")).len();
        assert!(n_all == n || n_all == 0, "{n} work items");
        let folder = format!("grown_{n}");
        fs::create_dir(case.path(&folder)).unwrap();
        let journal = case.path(&folder).join("journal.jsonl");
        fs::copy(case.path("whole/journal.jsonl"), journal).unwrap();
        let (_, error) = case.succeeds(&["run", "more.toml", "--out", &folder, "--threads", "1"]);
        says(&error, &[format!("going on: {n_before} of {n} work items")]);
        case.same_files(["fresh", &folder], &self.kind.repeatable);
        case.succeeds(&["verify", &folder, "--configurations", "5"]);
        n
    }

    /// Asserts that a run is refused below its memory requirement, with the required amount, and gives the same tables from there on.
    fn is_the_same_within_a_ceiling_of_memory(&self) {
        let run = |gib: &str| format!("run study.toml --out below --memory-gib {gib}");
        let error = self.case.refuses(&run("0.001"));
        let (_, after) = error.split_once("at least ").expect("how much it takes");
        let (least, _) = after.split_once(" GiB").expect("a unit");
        // The number is rounded to hundredths.
        let least = format!("{:.2}", least.parse::<f64>().unwrap() + 0.01);
        let plan = format!("plan study.toml --memory-gib {least}");
        assert!(!planned(&self.case.succeeds(&plan).0, "memory").is_empty());
        self.case.succeeds(&run(&least));
        self.assert_same_tables("below");
    }

    /// Asserts that charts and page made from the files of a folder equal the charts and the page of the run.
    fn is_reported_again_from_its_tables(&self) {
        let drawn = || -> BTreeMap<String, Vec<u8>> {
            let names = self.case.names_in("whole").into_iter();
            let charts = names.filter(|name| name.ends_with(".svg"));
            let content = |name: String| {
                let bytes = self.case.bytes(&format!("whole/{name}"));
                (name, bytes)
            };
            charts.map(content).collect()
        };
        let before = drawn();
        for name in before.keys().map(String::as_str).chain(["report.html"]) {
            fs::remove_file(self.case.path("whole").join(name)).unwrap();
        }
        self.case.succeeds("report whole");
        assert!(before == drawn(), "{:?}", before.keys());
        let page = self.case.read("whole/report.html");
        says(&page, &["<html"]);
    }
}

/// Returns the number of times that a run is killed in each way: few in short test runs, more in long ones.
fn n_kills_wanted() -> usize {
    match std::env::var_os("BUBBLETOUCH_LONG") {
        None => 3,
        Some(_) => 50,
    }
}

fn goes_through_all_faults(kind: Kind) {
    let faults = Faults::new(kind);
    faults.is_killed_at_work_items_and_does_none_twice();
    faults.loses_no_more_than_a_torn_last_line();
    faults.ends_on_a_full_disk_and_goes_on_where_there_is_room();
    faults.tells_a_second_run_of_the_first();
    faults.refuses_a_changed_study();
    faults.keeps_its_work_when_there_is_more_of_it();
    faults.is_the_same_within_a_ceiling_of_memory();
    faults.is_reported_again_from_its_tables();
}

macro_rules! through_all_faults {
    ($($(#[$ignored:meta])? $name:ident: $kind:literal;)*) => {
        $(#[test]
        $(#[$ignored])?
        fn $name() {
            goes_through_all_faults(Kind::named($kind));
        })*
    };
}

through_all_faults! {
    a_study_of_stability_goes_through_all_faults: "stability";
    #[ignore = "`.ci/long engine`"] a_study_of_recognition_goes_through_all_faults: "recognition";
    #[ignore = "`.ci/long engine`"] a_study_with_axes_of_its_own_goes_through_all_faults: "axes";
    #[ignore = "`.ci/long engine`"] a_study_of_reconstruction_goes_through_all_faults: "reconstruction";
    #[ignore = "`.ci/long engine`"] a_study_of_object_detail_goes_through_all_faults: "object_detail";
    #[ignore = "`.ci/long engine`"] a_study_of_a_whole_body_goes_through_all_faults: "whole_body";
    #[ignore = "`.ci/long engine`"] a_study_with_test_touches_of_their_own_goes_through_all_faults: "test_touches";
}

#[test]
fn what_a_whole_group_needs_and_cannot_be_had_fails_its_pieces_and_no_others() {
    let case = Kind::named("object_detail").case();
    let plate = case.read("meshes/plate.obj");
    let open: Vec<&str> = plate.lines().take(8 + 11).collect();
    case.file("meshes/open.obj", open.join("\n"));
    let output = case.run("run study.toml --out open");
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let failures = case.read("open/failures.csv");
    // The object's models, their times, and all classifiers that need every object.
    assert_eq!(failures.lines().count(), 1 + 2 + 3, "{failures}");
    for failure in failures.lines().skip(1) {
        says(failure, &["open.obj: a hole "]);
    }
    let detail = case.read("open/object_detail.csv");
    assert_eq!(detail.lines().count(), 1 + 2 * 3, "{detail}");
    // After the mesh is repaired, the study continues with the pending items.
    case.file("meshes/open.obj", plate.replace("0.02", "0.018"));
    // Another object is another study.
    case.refuses("run study.toml --out open");
}
