//! All kinds of classifiers with one interface; nearest neighbours and random forests compared with their definitions.

use crate::command::says;
use bubbletouch::random::Seed;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::classifiers::class_model::ClassModel;
use bubbletouch::recognition::classifiers::classifier::{Classifier, Cost, predict_split};
use bubbletouch::recognition::classifiers::k_nearest::KNearest;
use bubbletouch::recognition::classifiers::naive_bayes::NaiveBayes;
use bubbletouch::recognition::classifiers::random_forest::RandomForest;
use bubbletouch::recognition::data::dataset::{Dataset, dataset, rows};
use bubbletouch::recognition::data::split::stratified_hold_out;
use bubbletouch::recognition::svm::class_weight::ClassWeight;
use bubbletouch::recognition::svm::cross_validation::choice::Candidates;
use linfa::traits::Fit;
use ndarray::{Array1, Array2, ArrayView1, Axis, array};
use rand::Rng;

const KINDS: [ClassifierKind; 7] = [
    ClassifierKind::LinearSvm,
    ClassifierKind::RbfSvm,
    ClassifierKind::PolynomialSvm,
    ClassifierKind::LogisticRegression,
    ClassifierKind::KNearest,
    ClassifierKind::NaiveBayes,
    ClassifierKind::RandomForest,
];

/// Returns miniature touches: a bump with the width and height of its class, at a random position on 6 × 6 taxels.
fn bumps(n_classes: usize, n_per_class: usize) -> Dataset {
    let n_rows = n_classes * n_per_class;
    let mut rng = Seed::new(4).rng();
    let mut features = Array2::zeros((n_rows, 36));
    for (row, mut frame) in features.rows_mut().into_iter().enumerate() {
        let class = (row % n_classes) as f64;
        let (x, y) = (rng.gen_range(2.0..3.0), rng.gen_range(2.0..3.0));
        for (taxel, value) in frame.iter_mut().enumerate() {
            let (u, v) = ((taxel % 6) as f64 - x, (taxel / 6) as f64 - y);
            let height = 1.0 + 0.2 * class - (u * u + v * v) / (3.0 + 2.0 * class);
            *value = height.max(0.0) + 0.02 * rng.gen_range(-1.0..1.0);
        }
    }
    let labels = (0..n_rows).map(|row| row % n_classes);
    dataset(features, labels.collect()).unwrap()
}

/// Splits the rows into the first `n` and the rest.
fn at(data: &Dataset, n: usize) -> (Dataset, Dataset) {
    let indices: Vec<usize> = (0..data.records.nrows()).collect();
    let (first, rest) = indices.split_at(n);
    (rows(data, first).unwrap(), rows(data, rest).unwrap())
}

fn accuracy(predicted: &Array1<usize>, truth: &Array1<usize>) -> f64 {
    let n_correct = predicted.iter().zip(truth).filter(|(a, b)| a == b).count();
    n_correct as f64 / truth.len() as f64
}

#[test]
fn every_kind_recognises_small_touches_and_repeats_itself() {
    let data = bumps(6, 40);
    let split = stratified_hold_out(data.targets.view(), 0.25, &Seed::new(1)).unwrap();
    let truth = data.targets.select(Axis(0), &split.test);
    for kind in KINDS {
        let classifier = Classifier::new(kind);
        let predicted = predict_split(&classifier, &data, &split).unwrap();
        let accuracy = accuracy(&predicted, &truth);
        // Chance level is one sixth.
        assert!(accuracy > 0.8, "{kind:?}: {accuracy}");
        let again = predict_split(&classifier, &data, &split).unwrap();
        assert_eq!(predicted, again);
    }
}

#[test]
fn labels_are_those_of_the_scores_and_sums_of_scores_fuse_touches() {
    let (training, test) = at(&bumps(6, 40), 120);
    for kind in KINDS {
        let model = Classifier::new(kind).fit(&training).unwrap();
        let scores = model.scores(test.records.view()).unwrap();
        assert!(scores.iter().all(|score| score.is_finite()), "{kind:?}");
        let labels = model.labels(test.records.view()).unwrap();
        assert_eq!(labels, model.labels_of_scores(scores.view()));
        // Five touches of each object: rows 6i + k, i = 0 … 4, are of class k.
        let fused = Array2::from_shape_fn((6, scores.ncols()), |(class, column)| {
            (0..5).map(|i| scores[[6 * i + class, column]]).sum()
        });
        let fused = model.labels_of_scores(fused.view());
        let single = accuracy(&labels, &test.targets);
        let fused = accuracy(&fused, &Array1::from_iter(0..6));
        assert!(fused >= single, "{kind:?}: {single} alone, {fused} of five");
    }
}

#[test]
fn a_prior_counts_once_however_many_touches_are_summed() {
    // A feature without information: for one touch or a hundred, the more frequent class keeps its posterior.
    let features = Array2::from_shape_fn((40, 1), |(i, _)| ((i / 4) % 2) as f64);
    let labels = Array1::from_iter((0..40).map(|i| usize::from(i % 4 == 0)));
    let data = dataset(features, labels).unwrap();
    for kind in [
        ClassifierKind::NaiveBayes,
        ClassifierKind::LogisticRegression,
    ] {
        let exact = Classifier {
            tolerance: 1e-6,
            ..Classifier::new(kind)
        };
        let model = exact.fit(&data).unwrap();
        let scores = model.scores(data.records.view()).unwrap();
        let differences = &scores.column(0) - &scores.column(1);
        let are_equal = differences.iter().all(|d| d.abs() < 1e-3);
        assert!(are_equal, "{kind:?}: {differences}");
        let labels = model.labels(data.records.view()).unwrap();
        assert!(labels.iter().all(|&label| label == 0));
    }
}

#[test]
fn only_kinds_with_c_have_one() {
    let data = bumps(3, 20);
    for kind in KINDS {
        let classifier = Classifier {
            c: Cost::Chosen(Candidates {
                c: vec![0.1, 1.0],
                gamma_scales: Vec::new(),
            }),
            ..Classifier::new(kind)
        };
        let model = classifier.fit(&data).unwrap();
        assert_eq!(model.c().is_some(), kind.has_c());
        assert_eq!(model.chosen().is_some(), kind.has_c());
        assert_eq!(model.n_capped(), 0);
    }
}

#[test]
fn options_out_of_range_are_refused() {
    let data = bumps(3, 20);
    for n_neighbours in [0, 61] {
        let error = KNearest::train(&data, n_neighbours).unwrap_err();
        says(&error.to_string(), &["1 to the 60 training rows"]);
    }
    let seed = Seed::new(0);
    assert!(RandomForest::train(&data, 0, None, ClassWeight::Uniform, &seed).is_err());
    assert!(RandomForest::train(&data, 1, Some(0), ClassWeight::Uniform, &seed).is_err());
    let constant = dataset(Array2::ones((4, 2)), array![0, 1, 0, 1]).unwrap();
    assert!(NaiveBayes::train(&constant).is_err());
    assert!(KNearest::train(&dataset(array![[1e200], [0.0]], array![0, 1]).unwrap(), 1).is_err());
}

/// Returns the labels of k nearest neighbours by definition: one distance at a time, ties to the lower index and label.
fn by_brute_force(training: &Dataset, row: ArrayView1<f64>, k: usize) -> (Vec<usize>, usize) {
    let distance = |other: usize| {
        let pairs = row.iter().zip(training.records.row(other));
        pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
    };
    let mut order: Vec<usize> = (0..training.records.nrows()).collect();
    order.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    order.truncate(k);
    let votes = |class: usize| {
        let own = order.iter().filter(|&&row| training.targets[row] == class);
        own.count()
    };
    let label = (0..10).rev().max_by_key(|&class| votes(class)).unwrap();
    (order, label)
}

#[test]
fn neighbours_are_those_of_a_search_one_pair_at_a_time() {
    let mut rng = Seed::new(8).rng();
    // Coarse values cause equal distances and equal rows; an offset removes digits from the products.
    for offset in [0.0, 1e7] {
        let features =
            Array2::from_shape_fn((160, 12), |_| offset + f64::from(rng.gen_range(0..3)) * 0.1);
        let labels = Array1::from_iter((0..160).map(|_| rng.gen_range(0..7)));
        let (training, test) = at(&dataset(features, labels).unwrap(), 100);
        for k in [1, 2, 5, 100] {
            let model = KNearest::train(&training, k).unwrap();
            let neighbours = model.neighbours(test.records.view()).unwrap();
            let labels = model.labels(test.records.view()).unwrap();
            for (row, features) in test.records.rows().into_iter().enumerate() {
                let (nearest, label) = by_brute_force(&training, features, k);
                assert_eq!(neighbours.row(row).to_vec(), nearest);
                assert_eq!(labels[row], label);
            }
        }
    }
}

#[test]
fn a_forest_is_better_than_its_trees_and_follows_its_seed() {
    let mut data = bumps(8, 60);
    let mut rng = Seed::new(6).rng();
    data.records
        .mapv_inplace(|value| value + rng.gen_range(-0.5..0.5));
    let (training, test) = at(&data, 240);
    let share = |n_trees: usize, seed: u64| {
        let (weight, seed) = (ClassWeight::Uniform, Seed::new(seed));
        let forest = RandomForest::train(&training, n_trees, None, weight, &seed);
        let forest = forest.unwrap();
        let scores = forest.scores(test.records.view()).unwrap();
        let labels = forest.labels_of_scores(scores.view());
        (accuracy(&labels, &test.targets), scores)
    };
    let (single, _) = share(1, 3);
    let (many, scores) = share(60, 3);
    assert!(many > single + 0.03, "{single} alone, {many} together");
    assert_eq!(scores, share(60, 3).1);
    assert_ne!(scores, share(60, 4).1);
}

#[test]
fn a_classifier_of_linfas_plugs_in() {
    let data = bumps(6, 40);
    let split = stratified_hold_out(data.targets.view(), 0.25, &Seed::new(1)).unwrap();
    let truth = data.targets.select(Axis(0), &split.test);
    let foreign = linfa_bayes::GaussianNb::<f64, usize>::params();
    let foreign = predict_split(&foreign, &data, &split).unwrap();
    let ours = predict_split(&Classifier::new(ClassifierKind::NaiveBayes), &data, &split).unwrap();
    assert_eq!(foreign, ours, "naive Bayes does not care for scaling");
    assert!(accuracy(&foreign, &truth) > 0.8);
}
