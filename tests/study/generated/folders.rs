//! Laws of folders of results: a run that was extended, cut into shards or killed gives what a fresh run gives, and edited results are noticed.

use super::generator::{GeneratedStudy, Generator, n_studies};
use crate::command::Case;
use rand::Rng;
use rand::seq::SliceRandom;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use toml::Value;

/// Studies for each law of folders: each takes several runs of the command.
fn n_folders() -> u64 {
    n_studies().div_ceil(3)
}

/// Tables without times.
fn tables(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let files = entries.filter_map(|entry| {
        let name = entry.file_name().into_string().unwrap();
        let is_time = ["timing.csv", "pareto.csv", "stages.csv"].contains(&&name[..]);
        let is_table = name.ends_with(".csv") && !is_time;
        is_table.then(|| (name, fs::read(entry.path()).unwrap()))
    });
    files.collect()
}

/// A study with an axis of three values, which the command runs.
fn swept(case: &Case, generator: &mut Generator) -> (GeneratedStudy, &'static str, Vec<Value>) {
    let axes = [
        "signal.noise_std_full_scale",
        "recognition.classifier",
        "skin.stroke_mm",
        "seed",
    ];
    loop {
        let axis = axes.choose(&mut generator.rng).copied().unwrap();
        let study = generator.study(|study| study.get(axis).is_some());
        let mut values = generator.values(axis);
        values.truncate(3);
        case.file("study.toml", study.swept(axis, values.clone()).text());
        let output = case.run(&["run", "study.toml", "--out", "fresh"]);
        if output.status.success() {
            return (study, axis, values);
        }
        let _ = fs::remove_dir_all(case.path("fresh"));
    }
}

#[test]
fn an_extended_run_gives_the_tables_of_a_fresh_one() {
    for number in 0..n_folders() {
        let case = Case::new();
        let mut generator = Generator::new("extended runs", number);
        let (study, axis, values) = swept(&case, &mut generator);
        let n_first = generator.rng.gen_range(1..values.len());
        let first = values[values.len() - n_first..].to_vec();
        for values in [first, values] {
            case.file("study.toml", study.swept(axis, values).text());
            case.succeeds(&["run", "study.toml", "--out", "extended"]);
        }
        let (fresh, extended) = (tables(&case.path("fresh")), tables(&case.path("extended")));
        assert!(fresh == extended, "{axis} of\n{}", study.text());
    }
}

#[test]
fn merged_shards_give_the_tables_of_a_fresh_run() {
    for number in 0..n_folders() {
        let case = Case::new();
        let mut generator = Generator::new("merged shards", number);
        let (study, axis, _) = swept(&case, &mut generator);
        for shard in ["1/2", "2/2"] {
            case.succeeds(&["run", "study.toml", "--out", "merged", "--shard", shard]);
        }
        case.succeeds(&["merge", "study.toml", "--out", "merged"]);
        let (fresh, merged) = (tables(&case.path("fresh")), tables(&case.path("merged")));
        assert!(fresh == merged, "{axis} of\n{}", study.text());
    }
}

#[test]
fn a_run_that_lost_the_end_of_its_journal_gives_the_tables_of_a_fresh_one() {
    for number in 0..n_folders() {
        let case = Case::new();
        let mut generator = Generator::new("resumed runs", number);
        let (study, axis, _) = swept(&case, &mut generator);
        case.succeeds(&["run", "study.toml", "--out", "resumed"]);
        let journal = case.path("resumed/journal.jsonl");
        let bytes = fs::read(&journal).unwrap();
        let kept = generator.rng.gen_range(0..bytes.len());
        fs::write(&journal, &bytes[..kept]).unwrap();
        case.succeeds(&["run", "study.toml", "--out", "resumed"]);
        let (fresh, resumed) = (tables(&case.path("fresh")), tables(&case.path("resumed")));
        assert!(fresh == resumed, "{axis} of\n{}", study.text());
    }
}

/// Changes one number of a table that `compare` can read; `None` if the table has no row.
fn edited(csv: &[u8], generator: &mut Generator) -> Option<(String, Vec<u8>)> {
    let mut reader = csv::Reader::from_reader(csv);
    let head = reader.headers().unwrap().clone();
    let mut rows: Vec<Vec<String>> = reader
        .records()
        .map(|row| row.unwrap().iter().map(str::to_owned).collect())
        .collect();
    let values = ["accuracy", "n_correct", "macro_f1", "count"];
    let columns: Vec<usize> = (0..head.len())
        .filter(|&column| values.contains(&&head[column]))
        .collect();
    let column = *columns.choose(&mut generator.rng)?;
    let row = rows.choose_mut(&mut generator.rng)?;
    row[column] = if row[column] == "0" { "1" } else { "0" }.to_owned();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&head).unwrap();
    for row in rows {
        writer.write_record(row).unwrap();
    }
    Some((head[column].to_owned(), writer.into_inner().unwrap()))
}

#[test]
fn an_edited_table_is_noticed() {
    for number in 0..n_folders() {
        let case = Case::new();
        let mut generator = Generator::new("edited tables", number);
        swept(&case, &mut generator);
        let fresh = tables(&case.path("fresh"));
        for name in ["accuracy.csv", "summary.csv", "confusion.csv"] {
            let Some((column, content)) = edited(&fresh[name], &mut generator) else {
                continue;
            };
            if content == fresh[name] {
                continue;
            }
            case.file(&format!("fresh/{name}"), content);
            let verified = case.run(&["verify", "fresh", "--cells", "1"]);
            let error = String::from_utf8_lossy(&verified.stderr);
            assert!(!verified.status.success(), "{name}, {column}");
            assert!(error.contains(name), "{name}, {column}: {error}");
            case.file(&format!("fresh/{name}"), &fresh[name]);
        }
    }
}
