//! Law: a configuration gives the same rows alone as within a sweep.

use super::generator::{GeneratedStudy, Generator, n_studies};
use super::outcome::{Row, rows, run, sorted_without};
use bubbletouch::sensing::Ensemble;
use std::collections::BTreeSet;
use toml::Value;

/// Keys of a generated study that may be axes.
const AXES: &[&str] = &[
    "seed",
    "skin.pitch_mm",
    "skin.taxels",
    "skin.stroke_mm",
    "skin.layout",
    "skin.stiffness_n_per_m",
    "touches.depth_mm",
    "touches.frames",
    "touches.per_object",
    "touches.speed_mm_per_s",
    "skin.damping_n_s_per_m",
    "skin.friction",
    "signal.noise_std_full_scale",
    "signal.smoothing_mm",
    "sensing.ensemble",
    "sensing.ratio",
    "recognition.features",
    "recognition.classifier",
    "recognition.scaling",
    "recognition.c",
    "recognition.n_neighbours",
    "recognition.train_touches",
    "recognition.mislabelled_fraction",
    "recognition.class_imbalance",
    "recognition.touches_per_decision",
    "recognition.readings_per_touch",
    "recognition.test_fraction",
    "recognition.temporal_features",
    "recognition.tilt_augmentation",
    "recognition.depth_window_full_scale",
    "recognition.gamma",
];

/// Removes the columns that exist only because of an axis, and that the table of a single study does not have.
fn common(rows: Vec<Row>, columns: &BTreeSet<String>) -> Vec<Row> {
    let other: Vec<String> = rows
        .iter()
        .flat_map(|row| row.keys())
        .filter(|column| !columns.contains(*column) || *column == "configuration")
        .cloned()
        .collect();
    let other: Vec<&str> = other.iter().map(String::as_str).collect();
    sorted_without(rows, &other)
}

fn accuracy_rows(study: &GeneratedStudy) -> bubbletouch::Result<Vec<Row>> {
    Ok(rows(&run(&study.load()?)?["accuracy.csv"]))
}

/// Checks one study in which two keys are swept; returns the number of compared configurations.
fn check(
    generator: &mut Generator,
    first_axis: Option<(&str, Vec<Value>)>,
    is_wanted: fn(&GeneratedStudy) -> bool,
) -> usize {
    let study = generator.study(is_wanted);
    let mut axes: Vec<(String, Vec<Value>)> = Vec::new();
    if let Some((key, values)) = first_axis {
        axes.push((key.to_owned(), values));
    }
    // Kernel SVMs are solved along C from the previous solution, to an equal tolerance; decisions with an exact value of 0 may differ.
    let classifier = study.get("recognition.classifier").and_then(Value::as_str);
    let is_path = classifier.is_some_and(|name| name.ends_with("_svm"));
    let given = AXES.iter().filter(|key| study.get(key).is_some());
    let given = given.filter(|key| !(is_path && **key == "recognition.c"));
    let mut given: Vec<&str> = given.copied().collect();
    rand::seq::SliceRandom::shuffle(&mut given[..], &mut generator.rng);
    for key in given {
        let mut values = generator.values(key);
        values.truncate(2);
        let is_new = axes.iter().all(|(known, _)| known != key);
        let swept = axes.iter().fold(study.clone(), |study, (key, values)| {
            study.swept(key, values.clone())
        });
        if axes.len() < 2 && is_new && swept.swept(key, values.clone()).load().is_ok() {
            axes.push((key.to_owned(), values));
        }
    }
    let swept = axes.iter().fold(study.clone(), |study, (key, values)| {
        study.swept(key, values.clone())
    });
    let Ok(together) = accuracy_rows(&swept) else {
        return 0;
    };
    let combinations = axes
        .iter()
        .fold(vec![study.clone()], |studies, (key, values)| {
            let with = |study: &GeneratedStudy| {
                let values = values.iter();
                values
                    .map(|value| study.with(key, value.clone()))
                    .collect::<Vec<_>>()
            };
            studies.iter().flat_map(with).collect()
        });
    let mut alone = Vec::new();
    let mut n_compared = 0;
    for study in &combinations {
        if let Ok(rows) = accuracy_rows(study) {
            n_compared += 1;
            alone.push(rows);
        }
    }
    let columns = |rows: &[Row]| -> BTreeSet<String> { rows[0].keys().cloned().collect() };
    for rows in alone {
        let columns = &columns(&rows) & &columns(&together);
        let known = common(together.clone(), &columns);
        for row in common(rows, &columns) {
            assert!(
                known.binary_search(&row).is_ok(),
                "alone but not in the sweep: {row:#?}\n{}",
                swept.text()
            );
        }
    }
    n_compared
}

#[test]
fn a_configuration_alone_gives_the_rows_that_it_gives_in_a_sweep() {
    let mut n_compared = 0;
    for number in 0..n_studies() {
        n_compared += check(&mut Generator::new("alone or swept", number), None, |_| {
            true
        });
    }
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
    let mut n_compared = 0;
    for number in 0..n_studies() {
        n_compared += check(
            &mut Generator::new("test sensors", number),
            Some(test_sensors()),
            learns_on_two_skins,
        );
    }
    assert!(n_compared as u64 >= n_studies(), "{n_compared}");
}
