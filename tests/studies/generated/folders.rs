//! Laws of result folders: an extended, sharded or killed run gives the results of a fresh run. A run of a changed study also gives the results of a fresh run,
//! or the folder rejects it.

use super::generator::{GeneratedStudy, Generator, is_sample, keys, n_studies};
use super::outcome::{Tables, without_times};
use crate::command::Case;
use bubbletouch::study::all_strengths;
use rand::Rng;
use rand::seq::SliceRandom;
use std::fs;
use toml::Value;

/// Returns the number of studies for each law of folders; each study needs several runs of the command.
pub fn n_folders() -> u64 {
    n_studies().div_ceil(3)
}

/// Returns the tables of a folder without times.
pub fn tables(case: &Case, folder: &str) -> Tables {
    let names = case.names_in(folder).into_iter();
    let tables = names.filter(|name| name.ends_with(".csv"));
    let read = |name: String| {
        let content = case.bytes(&format!("{folder}/{name}"));
        (name, content)
    };
    without_times(tables.map(read).collect())
}

/// Study, a key that is an axis, and the values of the axis.
type Swept = (GeneratedStudy, &'static str, Vec<Value>);

/// Returns a study with an axis of three values, which the command runs into the folder `fresh`.
pub fn swept(case: &Case, generator: &mut Generator) -> Swept {
    let axes = [
        "signal.noise_std_full_scale",
        "recognition.classifier",
        "skin.stroke_mm",
        "seed",
    ];
    loop {
        let axis = axes.choose(&mut generator.rng).copied().unwrap();
        // Each run of the command packs household objects again, which takes long.
        let is_quick = |study: &GeneratedStudy| study.get("objects.surface_error_mm").is_none();
        let study = generator.study(|study| study.get(axis).is_some() && is_quick(study));
        let mut values = generator.values(axis);
        values.truncate(3);
        case.file("study.toml", study.swept(axis, values.clone()).text());
        let output = case.run("run study.toml --out fresh");
        if output.status.success() {
            return (study, axis, values);
        }
        let _ = fs::remove_dir_all(case.path("fresh"));
    }
}

/// Checks studies whose runs into the folder `fresh` are compared with other runs into the folder `other`; `run` returns whether there is one.
fn equals_a_fresh_run(law: &str, run: fn(&Case, &mut Generator, &Swept) -> bool) {
    for number in 0..n_folders() {
        let case = Case::new();
        let mut generator = Generator::new(law, number);
        let swept = swept(&case, &mut generator);
        if run(&case, &mut generator, &swept) {
            let is_same = tables(&case, "fresh") == tables(&case, "other");
            assert!(is_same, "{} of\n{}", swept.1, swept.0.text());
        }
    }
}

#[test]
fn an_extended_run_gives_the_tables_of_a_fresh_one() {
    equals_a_fresh_run("extended runs", |case, generator, (study, axis, values)| {
        let n_first = generator.rng.gen_range(1..values.len());
        let first = &values[values.len() - n_first..];
        if study.swept(axis, first.to_vec()).load().is_err() {
            // Without the other values, a key of the study would have no effect.
            return false;
        }
        for values in [first, values] {
            case.file("study.toml", study.swept(axis, values.to_vec()).text());
            case.succeeds("run study.toml --out other");
        }
        true
    });
}

#[test]
fn merged_shards_give_the_tables_of_a_fresh_run() {
    equals_a_fresh_run("merged shards", |case, _, _| {
        for shard in ["1/2", "2/2"] {
            case.succeeds(&["run", "study.toml", "--out", "other", "--shard", shard]);
        }
        case.succeeds("merge study.toml --out other");
        true
    });
}

#[test]
fn a_run_that_lost_the_end_of_its_journal_gives_the_tables_of_a_fresh_one() {
    equals_a_fresh_run("resumed runs", |case, generator, _| {
        case.succeeds("run study.toml --out other");
        let bytes = case.bytes("other/journal.jsonl");
        let kept = generator.rng.gen_range(0..bytes.len());
        case.file("other/journal.jsonl", &bytes[..kept]);
        case.succeeds("run study.toml --out other");
        true
    });
}

/// Returns the study with another value of a key, or with another signal; it may be the same study, or be refused.
fn changed(study: &GeneratedStudy, generator: &mut Generator) -> GeneratedStudy {
    let steps = study.get("signal.steps").and_then(Value::as_array);
    let mut steps = steps.cloned().unwrap_or_default();
    match generator.rng.gen_range(0..10) {
        0 => {
            steps.shuffle(&mut generator.rng);
            study.with("signal.steps", steps)
        }
        1 => study.with("signal.combine", "one_at_a_time"),
        2 => study.with("signal.test_sensor", "another_skin"),
        3 => match study.get("signal.noise_std_full_scale").cloned() {
            Some(noise) => study
                .without("signal.noise_std_full_scale")
                .with("signal.noise_std_mm", noise),
            None => study.with("signal.smoothing_mm", 4.0),
        },
        4 | 5 => {
            let strengths: Vec<_> = all_strengths().collect();
            let (error, strength) = strengths.choose(&mut generator.rng).copied().unwrap();
            let step = Value::from(error.about().step);
            if !steps.contains(&step) {
                steps.push(step);
            }
            let key = format!("signal.{}", strength.key);
            match generator.values(&key).into_iter().next() {
                Some(value) => study.with("signal.steps", steps).with(&key, value),
                None => study.clone(),
            }
        }
        _ => {
            let keys = keys();
            let key = keys.choose(&mut generator.rng).unwrap();
            let value = generator.values(key).swap_remove(0);
            match generator.rng.gen_bool(0.2) && study.get(key).is_some() {
                true => study.without(key),
                false => study.with(key, value),
            }
        }
    }
}

#[test]
fn a_changed_study_is_refused_by_the_folder_or_gives_the_tables_of_a_fresh_run() {
    let mut n_accepted = 0;
    for number in 0..n_folders() {
        let case = Case::new();
        let mut generator = Generator::new("changed studies", number);
        let (study, axis, values) = swept(&case, &mut generator);
        let mut study = study.swept(axis, values);
        for _ in 0..2 {
            let other = changed(&study, &mut generator);
            if other.table == study.table || other.load().is_err() {
                continue;
            }
            case.file("study.toml", other.text());
            if !case
                .run("run study.toml --fresh --out alone")
                .status
                .success()
            {
                continue;
            }
            let output = case.run("run study.toml --out fresh");
            if !output.status.success() {
                assert_eq!(output.status.code(), Some(2), "{}", other.text());
                continue;
            }
            let is_same = tables(&case, "alone") == tables(&case, "fresh");
            assert!(is_same, "{}\nthen\n{}", study.text(), other.text());
            n_accepted += 1;
            study = other;
        }
    }
    assert!(is_sample() || n_accepted > 0);
}
