//! The choice of the next touch as an axis of a study, compared with a choice touch by touch.

use crate::study::{Study, features, trials_of};
use bubbletouch::random::Seed;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::classifiers::classifier::{Classifier, Cost};
use bubbletouch::recognition::data::dataset::rows;
use bubbletouch::recognition::data::split::stratified_k_fold;
use bubbletouch::recognition::evaluation::fusion::{fuse_rows, fuse_scores};
use bubbletouch::recognition::evaluation::next_touch::{
    AnswerModel, NextTouch, PoseAnswers, Poses, most_informative,
};
use bubbletouch::study::FeatureSet;
use bubbletouch::study::table::Configuration;
use ndarray::{Array2, Axis};
use std::f64::consts::TAU;

const STUDY: &str = include_str!("../fixtures/texts/next_touch.toml");

const ALL: &str = r#"next_touch = ["random", "farthest", "most_informative"]"#;

fn with(keys: &str) -> String {
    format!("{STUDY}{keys}\n")
}

/// Counts the correct decisions of a configuration, computed touch by touch.
fn n_correct_by_hand(study: &Study, set: &FeatureSet, cell: (&Configuration, usize)) -> usize {
    let (configuration, trial) = cell;
    let classifier = Classifier {
        c: Cost::Fixed(1.0),
        ..Classifier::new(ClassifierKind::LinearSvm)
    };
    let (training, test) = (set.training(None).unwrap(), set.test().unwrap());
    let seed = Seed::new(2018).named("validation").numbered(trial as u64);
    let trained = classifier.train(&training, &seed).unwrap();
    let scores = trained.scores(test.records.view()).unwrap();
    let answers = trained.labels_of_scores(scores.view()).to_vec();
    // Predicted labels of training touches by classifiers that were not trained on them.
    let mut told = Vec::new();
    for fold in stratified_k_fold(training.targets.view(), 5, &seed).unwrap() {
        let of_fold = classifier.train(&rows(&training, &fold.train).unwrap(), &seed);
        let held_out = training.records.select(Axis(0), &fold.test);
        let labels = of_fold.unwrap().labels(held_out.view()).unwrap();
        for (&row, answer) in fold.test.iter().zip(labels) {
            told.push((set.split.train[row], training.targets[row], answer));
        }
    }
    let touches = study.touches();
    let coordinates = Array2::from_shape_fn((touches.len(), 3), |(touch, axis)| {
        let touch = touches[touch].1;
        [touch.offset[0] / 20e-3, touch.yaw / TAU, touch.depth / 3e-3][axis]
    });
    let poses = Poses {
        coordinates,
        turns: vec![None, Some(1.0), None],
    };
    let model = AnswerModel::new(&poses, &told, 6);
    let tested = set.split.test.iter();
    let at: Vec<PoseAnswers> = tested.map(|&touch| model.at(touch)).collect();
    let numbers = |places: &[usize]| -> Vec<usize> {
        places.iter().map(|&place| set.split.test[place]).collect()
    };
    let seed = Seed::new(2018).named("fused_touches");
    let n_touches = configuration.touches_per_decision;
    let fused = fuse_rows(test.targets.view(), n_touches, &seed.numbered(trial as u64));
    let mut n_correct = 0;
    for group in &fused.groups {
        let object = test.targets[group[0]];
        let mut made = vec![group[0]];
        while made.len() < n_touches {
            let all = 0..test.targets.len();
            let left = all.filter(|place| test.targets[*place] == object && !made.contains(place));
            let left: Vec<usize> = left.collect();
            let next = match configuration.next_touch.unwrap() {
                NextTouch::Random => group[made.len()],
                NextTouch::Farthest => left[poses.farthest(&numbers(&made), &numbers(&left))],
                NextTouch::MostInformative => left[most_informative((&at, &answers), &made, &left)],
            };
            made.push(next);
        }
        let sums = fuse_scores(scores.view(), &[made]);
        n_correct += usize::from(trained.labels_of_scores(sums.view())[0] == object);
    }
    n_correct
}

#[test]
fn each_choice_scores_what_a_robot_that_makes_it_touch_by_touch_does() {
    let text = with(&format!("{ALL}\ntouches_per_decision = [1, 2, 4]"));
    let study = Study::new(&text);
    let tables = study.run();
    let sets = [0, 1].map(|trial| features(&text, (0, trial)));
    // With one touch per decision, there is no next touch.
    assert_eq!(tables.accuracy.len(), 2 * (1 + 3 + 3));
    let mut found = Vec::new();
    for (configuration, score) in &tables.accuracy {
        let by_hand = n_correct_by_hand(&study, &sets[score.trial], (configuration, score.trial));
        assert_eq!(score.n_correct, by_hand, "{configuration:?}");
        assert_eq!(score.n_test, 72 / configuration.touches_per_decision);
        found.push(score.n_correct);
    }
    let random = |configurations: [usize; 2]| configurations.map(|of| &found[2 * of..][..2]);
    assert_ne!(random([1, 4]), random([2, 5]));
    assert_ne!(random([1, 4]), random([3, 6]));
}

#[test]
fn random_is_what_a_study_without_the_key_does_and_neither_changes_beside_others() {
    let run =
        |keys: &str| Study::new(&with(&format!("touches_per_decision = [1, 3]\n{keys}"))).run();
    let random = run("next_touch = \"random\"");
    let among = run(&format!("{ALL}\nc = [0.1, 1.0]"));
    for (configuration, score) in &run("").accuracy {
        let mut named = configuration.clone();
        named.next_touch = Some(NextTouch::Random);
        assert!(trials_of(&random, &named).contains(&score));
        named.c = Some(1.0);
        assert!(trials_of(&among, &named).contains(&score));
    }
}
