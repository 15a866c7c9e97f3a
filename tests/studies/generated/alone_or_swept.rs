//! Law: a configuration gives the same rows alone as within a sweep.

use super::generator::{GeneratedStudy, Generator, keys, n_studies};
use super::outcome::{Row, rows, run, sorted_without};
use bubbletouch::sensing::Ensemble;
use rand::seq::SliceRandom;
use std::collections::BTreeSet;
use toml::Value;

/// Removes the columns that exist only because of an axis, and that the table of a single study does not have.
fn common(rows: Vec<Row>, columns: &BTreeSet<String>) -> Vec<Row> {
    let names = rows.iter().flat_map(|row| row.keys().cloned());
    let other: Vec<String> = names
        .filter(|name| !columns.contains(name) || name == "configuration")
        .collect();
    let other: Vec<&str> = other.iter().map(String::as_str).collect();
    sorted_without(rows, &other)
}

fn accuracy_rows(study: &GeneratedStudy) -> bubbletouch::Result<Vec<Row>> {
    Ok(rows(&run(&study.load()?)?["accuracy.csv"]))
}

/// Returns the study with axes.
fn with_axes(study: &GeneratedStudy, axes: &[(String, Vec<Value>)]) -> GeneratedStudy {
    let sweep = |study: GeneratedStudy, (key, values): &(String, Vec<Value>)| {
        study.swept(key, values.clone())
    };
    axes.iter().fold(study.clone(), sweep)
}

/// Checks one study in which two keys are swept; returns the number of compared configurations.
fn check(
    generator: &mut Generator,
    first_axis: Option<(&str, Vec<Value>)>,
    is_wanted: fn(&GeneratedStudy) -> bool,
) -> usize {
    let study = generator.study(is_wanted);
    let first_axis = first_axis.map(|(key, values)| (key.to_owned(), values));
    let mut axes = Vec::from_iter(first_axis);
    // Kernel SVMs are solved along C from the previous solution, to an equal tolerance; decisions with an exact value of 0 may differ.
    let classifier = study.get("recognition.classifier").and_then(Value::as_str);
    let is_path = classifier.is_some_and(|name| name.ends_with("_svm"));
    let mut given = keys();
    given.retain(|key| study.get(key).is_some() && !(is_path && key == "recognition.c"));
    given.shuffle(&mut generator.rng);
    for key in given {
        let mut values = generator.values(&key);
        values.truncate(2);
        let is_new = axes.iter().all(|(known, _)| *known != key);
        let swept = with_axes(&study, &axes).swept(&key, values.clone());
        if axes.len() < 2 && is_new && swept.load().is_ok() {
            axes.push((key, values));
        }
    }
    let swept = with_axes(&study, &axes);
    let Ok(together) = accuracy_rows(&swept) else {
        return 0;
    };
    let mut combinations = vec![study];
    for (key, values) in &axes {
        let with = |study: GeneratedStudy| {
            let values = values.iter();
            let studies = values.map(|value| study.with(key, value.clone()));
            studies.collect::<Vec<_>>()
        };
        combinations = combinations.into_iter().flat_map(with).collect();
    }
    let columns = |rows: &[Row]| -> BTreeSet<String> { rows[0].keys().cloned().collect() };
    let mut n_compared = 0;
    for rows in combinations.iter().flat_map(accuracy_rows) {
        let columns = &columns(&rows) & &columns(&together);
        let known = common(together.clone(), &columns);
        for row in common(rows, &columns) {
            let is_known = known.binary_search(&row).is_ok();
            assert!(
                is_known,
                "alone but not in the sweep: {row:#?}\n{}",
                swept.text()
            );
        }
        n_compared += 1;
    }
    n_compared
}

#[test]
fn a_configuration_alone_gives_the_rows_that_it_gives_in_a_sweep() {
    let n_compared = |number| {
        check(&mut Generator::new("alone or swept", number), None, |_| {
            true
        })
    };
    let n_compared: usize = (0..n_studies()).map(n_compared).sum();
    assert!(n_compared as u64 >= 2 * n_studies(), "{n_compared}");
}

/// Returns the axis over the two skins of test touches.
fn test_sensors() -> (&'static str, Vec<Value>) {
    let sensors = ["same_skin", "another_skin"].map(Value::from);
    ("signal.test_sensor", sensors.to_vec())
}

/// Returns whether the ensemble of a study is fitted to training frames, and its sensor errors differ between skins.
fn learns_on_two_skins(study: &GeneratedStudy) -> bool {
    let (key, sensors) = test_sensors();
    let name = study.get("sensing.ensemble").and_then(Value::as_str);
    let all = Ensemble::NAMES.iter().zip(Ensemble::ALL);
    let mut named = all.filter(|((known, _), _)| Some(*known) == name);
    named.any(|(_, ensemble)| ensemble.is_learned()) && study.swept(key, sensors).load().is_ok()
}

#[test]
fn a_test_sensor_alone_gives_the_rows_that_it_gives_beside_another() {
    let n_compared = |number| {
        let mut generator = Generator::new("test sensors", number);
        check(&mut generator, Some(test_sensors()), learns_on_two_skins)
    };
    let n_compared: usize = (0..n_studies()).map(n_compared).sum();
    assert!(n_compared as u64 >= n_studies(), "{n_compared}");
}
