//! The classifier of a study: scaling and C depend only on training rows.

use bubbletouch::Error;
use bubbletouch::random::Seed;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::classifiers::classifier::{
    Classifier, Cost, TrainedClassifier, predict_split,
};
use bubbletouch::recognition::data::dataset::{Dataset, dataset, rows};
use bubbletouch::recognition::data::scaling::Scaling;
use bubbletouch::recognition::data::split::stratified_hold_out;
use bubbletouch::recognition::svm::SvmParams;
use bubbletouch::recognition::svm::cross_validation::choice::Candidates;
use linfa::traits::{Fit, Predict};
use ndarray::{Array1, Array2, array};
use rand::Rng;

/// Returns three overlapping clusters in four features of very different units.
fn clusters() -> Dataset {
    let mut rng = Seed::new(11).rng();
    let features = Array2::from_shape_fn((150, 4), |(i, j)| {
        let centre = ((i % 3) * (j + 1)) as f64 * 0.4;
        (centre + rng.gen_range(-1.0..1.0)) * [1.0, 1e3, 1e-3, 10.0][j]
    });
    dataset(features, Array1::from_iter((0..150).map(|i| i % 3))).unwrap()
}

fn chosen(candidates: &[f64]) -> Cost {
    Cost::Chosen(Candidates {
        c: candidates.to_vec(),
        gamma_scales: Vec::new(),
    })
}

const KINDS: [ClassifierKind; 3] = [
    ClassifierKind::LinearSvm,
    ClassifierKind::RbfSvm,
    ClassifierKind::PolynomialSvm,
];

#[test]
fn test_rows_cannot_influence_scaling_or_c() {
    let data = clusters();
    let split = stratified_hold_out(data.targets.view(), 0.3, &Seed::new(1)).unwrap();
    let mut shaken = data.clone();
    for &row in &split.test {
        shaken.records.row_mut(row).fill(1e9);
        shaken.targets[row] = 2;
    }
    for kind in KINDS {
        let classifier = Classifier {
            c: chosen(&[0.01, 1.0, 100.0]),
            ..Classifier::new(kind)
        };
        let train = |data: &Dataset| {
            let training = rows(data, &split.train).unwrap();
            classifier.train(&training, &Seed::new(2)).unwrap()
        };
        let (a, b) = (train(&data), train(&shaken));
        assert_eq!(a.scaling(), b.scaling());
        assert_eq!(a.chosen(), b.chosen());
        let decisions = |model: &TrainedClassifier| {
            let scaled = model.scaling().apply(data.records.view()).unwrap();
            model.svm().unwrap().decision_values(scaled.view()).unwrap()
        };
        assert_eq!(decisions(&a), decisions(&b));
    }
}

#[test]
fn standard_scaling_forgets_the_units() {
    let data = clusters();
    let mut converted = data.clone();
    // Powers of 2 change no digit.
    converted.records *= &array![0.125, 16.0, 1024.0, 2.0];
    for kind in KINDS {
        let classifier = Classifier::new(kind);
        let a = classifier.fit(&data).unwrap().predict(&data);
        let b = classifier.fit(&converted).unwrap().predict(&converted);
        assert_eq!(a, b);
    }
}

#[test]
fn a_chosen_c_is_the_most_accurate_and_the_smaller_on_a_tie() {
    let data = clusters();
    let classifier = Classifier {
        c: chosen(&[10.0, 1e-5, 1.0, 1.0, 0.1]),
        ..Classifier::new(ClassifierKind::LinearSvm)
    };
    let model = classifier.train(&data, &Seed::new(3)).unwrap();
    let tried = &model.chosen().unwrap().tried;
    let values: Vec<f64> = tried.iter().map(|tried| tried.c).collect();
    assert_eq!(values, [1e-5, 0.1, 1.0, 10.0]);
    let best = tried.iter().map(|tried| tried.accuracy).fold(0.0, f64::max);
    let smallest = tried.iter().find(|tried| tried.accuracy == best).unwrap().c;
    assert_eq!(model.c(), Some(smallest));
    // The final model is trained with the chosen C on all training rows.
    let fixed = Classifier {
        c: Cost::Fixed(smallest),
        ..classifier
    };
    let fixed = fixed.fit(&data).unwrap();
    assert_eq!(fixed.predict(&data), model.predict(&data));
}

#[test]
fn impossible_choices_of_c_are_refused() {
    let data = clusters();
    for c in [
        chosen(&[]),
        chosen(&[1.0, -1.0]),
        chosen(&[f64::NAN]),
        Cost::Fixed(0.0),
    ] {
        let classifier = Classifier {
            c,
            ..Classifier::new(ClassifierKind::RbfSvm)
        };
        assert!(classifier.fit(&data).is_err());
    }
}

#[test]
fn the_classifier_is_its_svm_on_scaled_features() {
    let data = clusters();
    for scaling in [Scaling::None, Scaling::Standard, Scaling::Overall] {
        let classifier = Classifier {
            scaling,
            // Unscaled features of a thousand units need a small C to converge.
            c: Cost::Fixed(1e-4),
            ..Classifier::new(ClassifierKind::LinearSvm)
        };
        let by_hand = scaling.fit(data.records.view()).unwrap();
        let scaled = by_hand.apply(data.records.view()).unwrap();
        let svm = SvmParams {
            c: 1e-4,
            ..SvmParams::default()
        };
        let svm = svm
            .train(&dataset(scaled.clone(), data.targets.clone()).unwrap())
            .unwrap();
        let expected = svm.labels(scaled.view()).unwrap();
        assert_eq!(classifier.fit(&data).unwrap().predict(&data), expected);
    }
}

#[test]
fn parameters_out_of_range_are_bad_input() {
    let data = clusters();
    let split = stratified_hold_out(data.targets.view(), 0.3, &Seed::new(1)).unwrap();
    let bad = SvmParams {
        c: -1.0,
        ..SvmParams::default()
    };
    let error = predict_split(&bad, &data, &split).unwrap_err();
    let expected = "C: -1; a finite number above 0 is allowed";
    assert_eq!(error.to_string(), expected);
    assert!(matches!(Error::from(error), Error::Input { .. }));
}
