//! Platt scaling: the optimum of each sigmoid, calibrated probabilities, and the order of the classes.

use bubbletouch_svm::dataset::Dataset;
use bubbletouch_svm::split::stratified_k_fold;
use bubbletouch_svm::{Multiclass, SvmParams};
use linfa::dataset::{DatasetBase, Pr};
use linfa::prelude::BinaryClassification;
use linfa::traits::{Fit, Predict};
use ndarray::{Array1, Array2, s};
use rand::{Rng, SeedableRng};

/// Rows of `k` normal classes around points of a circle, with the labels 10, 11, ….
fn normal(n_rows: usize, k: usize, seed: u64) -> Dataset {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let label = |row: usize| row % k;
    let features = Array2::from_shape_fn((n_rows, 2), |(row, column)| {
        let angle = std::f64::consts::TAU * label(row) as f64 / k as f64;
        let noise: f64 = rng.sample(rand_distr::StandardNormal);
        [angle.cos(), angle.sin()][column] + 0.8 * noise
    });
    Dataset::new(
        features,
        Array1::from_shape_fn(n_rows, |row| 10 + label(row)),
    )
}

#[test]
fn probabilities_are_calibrated_on_new_rows() {
    for (k, multiclass) in [
        (2, Multiclass::OneVsOne),
        (4, Multiclass::OneVsOne),
        (4, Multiclass::OneVsRest),
    ] {
        // The log-odds of normal classes with one covariance are linear.
        let data = normal(1200, k, 1);
        let params = SvmParams {
            multiclass,
            ..SvmParams::default()
        };
        let folds = stratified_k_fold(data.targets.view(), 5, &0_u64).unwrap();
        let model = params.train_with_probabilities(&data, &folds).unwrap();
        assert_eq!(
            model.svm().problems(),
            params.train(&data).unwrap().problems()
        );
        let test = normal(4000, k, 2);
        let probabilities = model.probabilities(test.records.view()).unwrap();
        assert_eq!(model.classes()[0], 10);
        for row in probabilities.rows() {
            assert!((row.sum() - 1.0).abs() < 1e-9 && row.iter().all(|p| (0.0..=1.0).contains(p)));
        }
        // Of the decisions with a probability near p, a share of p is right.
        for bin in 0..10 {
            let is_in = |p: &&(f64, bool)| (10.0 * p.0) as usize == bin;
            let pairs = probabilities
                .indexed_iter()
                .map(|((row, class), &p)| (p, test.targets[row] == model.classes()[class]));
            let all: Vec<(f64, bool)> = pairs.collect();
            let own: Vec<&(f64, bool)> = all.iter().filter(is_in).collect();
            // The log-odds of a class against all others are not linear.
            if own.len() < 200 || multiclass == Multiclass::OneVsRest {
                continue;
            }
            let n = own.len() as f64;
            let right = own.iter().filter(|(_, is)| *is).count() as f64 / n;
            let said = own.iter().map(|(p, _)| p).sum::<f64>() / n;
            assert!(
                (right - said).abs() < 0.08,
                "{k} {multiclass:?}: {said} {right}"
            );
        }
        let best = probabilities.map_axis(ndarray::Axis(1), |row| {
            let order = |a: &(usize, &f64), b: &(usize, &f64)| a.1.total_cmp(b.1);
            10 + row.iter().enumerate().max_by(order).unwrap().0
        });
        let votes = model.svm().labels(test.records.view()).unwrap();
        let same = best.iter().zip(&votes).filter(|(a, b)| a == b).count();
        assert!(same > 3700, "{same}");
    }
}

#[test]
fn the_probability_of_a_bool_is_that_of_true() {
    let data = normal(400, 2, 3);
    let is_eleven = data.targets.map(|&label| label == 11);
    let all = DatasetBase::new(data.records.view(), is_eleven.view());
    let (training, held_out) = all.split_with_ratio(0.5);
    let model = SvmParams::default().fit(&training).unwrap();
    let model = model
        .with_probabilities(held_out.records, held_out.targets)
        .unwrap();
    assert_eq!(model.classes(), [false, true]);
    let test = normal(1000, 2, 4);
    let truth = test.targets.map(|&label| label == 11);
    let found: Array1<Pr> = model.predict(&test.records);
    let area = found
        .roc(truth.as_slice().unwrap())
        .unwrap()
        .area_under_curve();
    assert!(area > 0.9, "{area}");
    let probabilities = model
        .probabilities(test.records.slice(s![..1, ..]))
        .unwrap();
    assert!((*found[0] - probabilities[(0, 1)] as f32).abs() < 1e-6);
}

#[test]
fn calibration_that_lacks_a_class_is_refused() {
    let data = normal(90, 3, 5);
    let model = SvmParams::default().train(&data).unwrap();
    let without = data.targets.iter().enumerate();
    let without: Vec<usize> = without
        .filter(|(_, l)| **l != 12)
        .map(|(row, _)| row)
        .collect();
    let rows = bubbletouch_svm::dataset::rows(&data, &without).unwrap();
    let said = model
        .clone()
        .with_probabilities(rows.records.view(), rows.targets.view());
    assert!(said.unwrap_err().to_string().starts_with("calibration: "));
    let unknown = Array1::from_elem(90, 7);
    let said = model.with_probabilities(data.records.view(), unknown.view());
    assert!(said.unwrap_err().to_string().starts_with("labels: 7; "));
    let none = SvmParams::default().train_with_probabilities(&data, &[]);
    assert!(none.unwrap_err().to_string().starts_with("folds: none; "));
}
