//! Several readings of each training touch, each with its own noise.

use crate::standard_errors::{assert_expected, of_std};
use crate::study::{features, laid_out, run};
use bubbletouch::random::Seed;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::classifiers::classifier::{Classifier, Cost};
use bubbletouch::study::FeatureSet;
use bubbletouch::study::progress::Silent;
use ndarray::{Axis, s};
use std::collections::BTreeSet;

const STUDY: &str = include_str!("../fixtures/texts/readings.toml");

fn with(keys: &str) -> String {
    format!("{STUDY}{keys}\n")
}

/// Returns the number of correct rows for every trial.
fn n_correct(text: &str) -> Vec<usize> {
    let tables = run(text);
    let scores = tables.accuracy.iter().map(|(_, score)| score.n_correct);
    scores.collect()
}

#[test]
fn readings_differ_by_their_noise_alone_and_only_training_learns_of_them() {
    let (once, thrice) = (
        features(STUDY, (0, 0)),
        features(&with("readings_per_touch = 3"), (0, 0)),
    );
    let n = once.data.targets.len();
    let records = &thrice.data.records;
    let reading = |k: usize| records.slice(s![k * n..(k + 1) * n, ..]).to_owned();
    assert_eq!(reading(0), once.data.records);
    assert_eq!(thrice.split.test, once.split.test);
    let trained = once.split.train.iter();
    let trained = (0..3).flat_map(|k| trained.clone().map(move |row| k * n + row));
    assert_eq!(thrice.split.train, trained.collect::<Vec<_>>());
    for (row, label) in thrice.data.targets.iter().enumerate() {
        assert_eq!(*label, once.data.targets[row % n]);
    }
    // With independent noise of 0.1 of 5 mm, differences of two readings have √2 times its standard deviation.
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let difference = reading(a) - reading(b);
        let std = (difference.mapv(|d| d * d).mean().unwrap() / 2.0).sqrt();
        let standard_error = of_std(5e-4, difference.len());
        assert_expected(&format!("{a} {b}"), std, 5e-4, standard_error);
    }
}

/// Compares the run with separate training on every reading.
#[test]
fn a_run_learns_all_readings_and_is_tested_on_one() {
    let trials = |text: &str| text.replace("trials = 1", "trials = 5");
    let text = trials(&with("readings_per_touch = 4"));
    let study = laid_out(&text).unwrap();
    let by_hand = (0..5).map(|trial| {
        let set = study.first().features((0, trial), &Silent).unwrap();
        let classifier = Classifier {
            c: Cost::Fixed(0.1),
            ..Classifier::new(ClassifierKind::LinearSvm)
        };
        let trained = classifier.train(&set.training(None).unwrap(), &Seed::new(1));
        let test = set.test().unwrap();
        let found = trained.unwrap().labels(test.records.view()).unwrap();
        let pairs = found.iter().zip(&test.targets);
        pairs.filter(|(found, truth)| found == truth).count()
    });
    let found = n_correct(&text);
    assert_eq!(found, by_hand.collect::<Vec<_>>());
    assert_ne!(found, n_correct(&trials(STUDY)));
}

#[test]
fn without_noise_a_touch_is_learned_once() {
    // The first configuration has no noise.
    let silent = |text: &str| text.replace("full_scale = 0.1", "full_scale = [0.0, 0.1]");
    let (once, twice) = (silent(STUDY), silent(&with("readings_per_touch = 2")));
    assert_eq!(features(&twice, (0, 0)).data, features(&once, (0, 0)).data);
    assert_eq!(features(&once, (0, 0)).data.records.len_of(Axis(0)), 120);
}

/// Tests that the choice of C does not use other readings of held-out touches in training.
#[test]
fn tilted_copies_come_after_all_readings_and_are_of_the_first() {
    let tilted = "features = \"descriptors\"\ntilt_augmentation = 2";
    let two = format!("{tilted}\nreadings_per_touch = 2");
    let [once, twice] = [tilted, &two].map(|keys| features(&with(keys), (0, 0)));
    let (n, n_train) = (120, 90);
    assert_eq!(once.data.targets.len(), n + 2 * n_train);
    assert_eq!(twice.data.targets.len(), 2 * n + 2 * n_train);
    assert_eq!(twice.split.train.len(), 4 * n_train);
    let copies =
        |set: &FeatureSet, first: usize| set.data.records.slice(s![first.., ..]).to_owned();
    assert_eq!(copies(&once, n), copies(&twice, 2 * n));
    let labels = |set: &FeatureSet, first: usize| set.data.targets.slice(s![first..]).to_owned();
    assert_eq!(labels(&once, n), labels(&twice, 2 * n));
}

#[test]
fn readings_and_copies_are_of_the_group_of_their_touch() {
    let keys = "features = \"descriptors\"\ntilt_augmentation = 2\nreadings_per_touch = 2\n\
                group_by = \"yaw\"\ngroup_by_deg = 12.0";
    let study = laid_out(&with(keys)).unwrap();
    let keys = study.first().sweep.group_keys.as_ref().unwrap();
    let set = study.first().features((0, 0), &Silent).unwrap();
    let groups = set.groups.unwrap();
    let (n, n_train) = (120, set.split.train.len() / 4);
    assert_eq!(groups.len(), 2 * n + 2 * n_train);
    for (row, &group) in groups.iter().enumerate() {
        let touch = match row.checked_sub(2 * n) {
            None => row % n,
            Some(copy) => set.split.train[copy % n_train],
        };
        assert_eq!(group, keys[touch], "row {row}");
    }
    let of = |rows: &[usize]| rows.iter().map(|&row| groups[row]).collect::<BTreeSet<_>>();
    assert!(of(&set.split.train).is_disjoint(&of(&set.split.test)));
    assert_eq!(features(STUDY, (0, 0)).groups, None);
}

#[test]
fn a_choice_of_c_sees_first_readings_alone() {
    let choose =
        |keys: &str| STUDY.replace("c = 0.1", &format!("c_grid = [0.001, 0.1, 10.0]\n{keys}"));
    let chosen = |keys: &str| {
        let tables = run(&choose(keys));
        tables.accuracy[0].1.c_used
    };
    assert_eq!(chosen("readings_per_touch = 5"), chosen(""));
}
