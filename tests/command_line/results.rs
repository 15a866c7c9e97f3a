//! Folders of results: edits of their files are noticed, and a folder may keep only the confusion matrices of the best configurations.

use crate::command::{Case, says};
use bubbletouch::study::sha256;
use std::collections::BTreeMap;

/// Study that takes a second.
const STUDY: &str = include_str!("../fixtures/texts/report.toml");

fn found(text: &str) -> Case {
    let case = Case::with("study.toml", text);
    case.succeeds("run study.toml --out found");
    case
}

/// Replaces the text of a table, and its hash in the manifest, so that the manifest hides the edit.
fn replace(case: &Case, name: &str, edited: &str) {
    let [from, to] = [&case.read(name), edited].map(sha256);
    let manifest = case.read("found/manifest.json");
    assert!(manifest.contains(&from), "{name}");
    case.file("found/manifest.json", manifest.replace(&from, &to));
    case.file(name, edited);
}

#[test]
fn every_edit_of_a_folder_of_results_is_noticed_and_its_file_named() {
    let case = found(STUDY);
    let page = case.bytes("found/report.html");
    let names = case.names_in("found").into_iter();
    let names = names.filter(|name| name != "manifest.json" && name != "journal.jsonl");
    let names: Vec<String> = names.collect();
    assert!(names.len() > 12, "{names:?}");
    for name in names {
        let path = format!("found/{name}");
        let bytes = case.bytes(&path);
        let (first, second) = bytes.split_at(bytes.len() / 2);
        let edited = [first, &[second[0] ^ 1], &second[1..]].concat();
        let longer = [&bytes[..], b"\n1,2,3\n"].concat();
        // Charts and pages are drawn again from the tables and the study.
        let is_result = name.ends_with(".csv") || name.ends_with(".toml");
        let commands = match is_result {
            true => &["verify", "report"][..],
            false => &["verify"],
        };
        let is_refused = |said: &str| {
            for command in commands {
                let error = case.refuses(&format!("{command} found"));
                says(&error, &[&path[..], said]);
            }
        };
        for damaged in [&edited[..], &longer, first] {
            case.file(&path, damaged);
            is_refused("was changed after its run");
        }
        if is_result {
            case.remove(&path);
            is_refused("is missing");
            assert!(case.bytes("found/report.html") == page, "{name}");
        }
        case.file(&path, bytes);
    }
    case.succeeds("verify found");
    case.succeeds("report found");
}

#[test]
fn edits_that_the_manifest_hides_are_noticed_when_all_work_runs_again() {
    let case = found(STUDY);
    let manifest = case.read("found/manifest.json");
    for name in ["accuracy", "summary", "confusion"] {
        let name = &format!("found/{name}.csv");
        let table = case.read(name);
        let last = table.lines().last().unwrap();
        replace(&case, name, &format!("{table}{last}\n"));
        says(&case.refuses("verify found --configurations 1000"), &[name]);
        case.file(name, &table);
        case.file("found/manifest.json", &manifest);
    }
}

/// The manifest of an earlier version lists only tables.
#[test]
fn a_folder_whose_manifest_lists_no_other_files_takes_its_study_again() {
    let case = found(STUDY);
    for command in ["report found", "run study.toml --out found"] {
        let mut manifest: serde_json::Value =
            serde_json::from_str(&case.read("found/manifest.json")).unwrap();
        let fields = manifest.as_object_mut().unwrap();
        fields.remove("files_sha256").unwrap();
        case.file("found/manifest.json", manifest.to_string());
        case.succeeds(command);
    }
}

/// Returns the lines of a table after the first one by their configuration, which is their first entry.
fn by_configuration(table: &str) -> BTreeMap<&str, Vec<&str>> {
    let mut lines = BTreeMap::<&str, Vec<&str>>::new();
    for line in table.lines().skip(1) {
        let (configuration, _) = line.split_once(',').unwrap();
        lines.entry(configuration).or_default().push(line);
    }
    lines
}

#[test]
fn confusion_matrices_of_the_best_cells_alone_leave_the_other_tables_as_they_are() {
    // With this noise, objects are confused, and the confusions have a chart.
    let keys = "touches_per_decision = [1, 4]\nclassifier =";
    let all = STUDY.replace("classifier =", keys);
    let all = all.replace("full_scale = 0.05", "full_scale = 0.5");
    let case = Case::with("all.toml", &all);
    case.file("best.toml", all + "\n[report]\nconfusion = \"best\"\n");
    for name in ["all", "best"] {
        case.succeeds(&format!("run {name}.toml --out {name}"));
    }
    let read = |name: &str| ["all", "best"].map(|folder| case.read(&format!("{folder}/{name}")));
    let mut names = case.names_in("best").into_iter();
    let chart = names.find(|name| name.starts_with("accuracy_by")).unwrap();
    let same = [
        "accuracy.csv",
        "summary.csv",
        "confused.csv",
        "comparison.csv",
        &chart,
    ];
    case.same_files(["all", "best"], &same);
    let [all, best] = read("confusion.csv");
    let (mut all, best) = (by_configuration(&all), by_configuration(&best));
    assert!((1..=3).contains(&best.len()) && all.len() == 8, "{best:?}");
    all.retain(|configuration, _| best.contains_key(configuration));
    assert_eq!(all, best);
    // The chart shows the same matrix; the caption below the tiles counts the rows of other configurations.
    let [all, best] = read("confusion.svg");
    let tiles = |svg: &str| svg.split_once("Rows: touched").unwrap().0.to_owned();
    assert_eq!(tiles(&all), tiles(&best));
    says(&read(&chart)[1], &["chance (1 in 3)"]);
    case.succeeds("report best");
    case.succeeds("verify best --configurations 2");
    case.succeeds("verify best --configurations 1000");
    case.succeeds("advise best --accuracy 0.1");
}

/// The columns of groups and of repeated splits exist if any row has them; the rows of a few work items may lack them.
#[test]
fn verify_takes_a_few_work_items_of_a_study_with_groups_and_repeated_splits() {
    let yaws = "depth_mm = 3.0\nyaw_deg = [0.0, 30.0, 60.0, 90.0]";
    let text = STUDY
        .replace("trials = 2", "trials = 4")
        .replace("depth_mm = 3.0", yaws);
    let case = found(&(text + "[axes]\n\"recognition.split\" = [\"random\", \"half_of_yaws\"]\n"));
    let accuracy = case.read("found/accuracy.csv");
    let (header, rows) = accuracy.split_once('\n').unwrap();
    says(header, &["distinct_split", "n_groups"]);
    let verify = |draw: usize| format!("verify found --configurations 1 --draw {draw}");
    for draw in 0..8 {
        case.succeeds(&verify(draw));
    }
    // A differing row is also found in a table with fewer columns.
    let mut columns = header.split(',');
    let n_correct = columns.position(|name| name == "n_correct").unwrap();
    let edited = rows.lines().map(|row| {
        let mut fields: Vec<&str> = row.split(',').collect();
        fields[n_correct] = "1";
        fields.join(",") + "\n"
    });
    let edited = format!("{header}\n{}", edited.collect::<String>());
    replace(&case, "found/accuracy.csv", &edited);
    for draw in 0..8 {
        says(&case.refuses(&verify(draw)), &["found/accuracy.csv:"]);
    }
}
