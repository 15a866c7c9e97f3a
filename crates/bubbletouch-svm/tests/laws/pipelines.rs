//! linfa's pipelines: views, targets of every type, folds, cross-validation, weights of rows, and saved models.

use bubbletouch_svm::classifiers::ClassifierKind;
use bubbletouch_svm::classifiers::classifier::Classifier;
use bubbletouch_svm::cross_validation::choice::{Candidates, choose};
use bubbletouch_svm::dataset::{Dataset, rows};
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::predict::svm_model::SvmModel;
use bubbletouch_svm::split::stratified_k_fold;
use bubbletouch_svm::{Multiclass, SvmParams};
use linfa::dataset::{CountedTargets, DatasetBase};
use linfa::prelude::ToConfusionMatrix;
use linfa::traits::{Fit, Predict};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, s};

/// Overlapping rows of three classes with the labels 2, 5 and 9.
fn overlapping(n_rows: usize) -> Dataset {
    let features = Array2::from_shape_fn((n_rows, 4), |(row, column)| {
        let centre = (1.3 * ((row % 3) * (column + 1)) as f64).cos();
        centre + 0.8 * (1.7 * (row * 5 + column) as f64).sin()
    });
    Dataset::new(
        features,
        Array1::from_shape_fn(n_rows, |row| [2, 5, 9][row % 3]),
    )
}

fn rbf() -> SvmParams {
    SvmParams {
        kernel: Kernel::Rbf {
            gamma: Gamma::Value(0.4),
        },
        c: 3.0,
        ..SvmParams::default()
    }
}

#[test]
fn views_and_owned_arrays_give_one_model() {
    let data = overlapping(90);
    let expected = rbf().train(&data).unwrap();
    let of_view = rbf().fit(&data.view()).unwrap();
    assert_eq!(of_view.problems(), expected.problems());
    assert_eq!(of_view.classes(), [2, 5, 9]);
    // Columns in reverse order: a view without contiguous rows.
    let reversed = data.records.slice(s![.., ..;-1]);
    let of_reversed = rbf()
        .fit(&DatasetBase::new(reversed, data.targets.view()))
        .unwrap();
    let owned = Dataset::new(reversed.to_owned(), data.targets.clone());
    assert_eq!(
        of_reversed.problems(),
        rbf().train(&owned).unwrap().problems()
    );
    let probes: ArrayView2<f64> = data.records.slice(s![..20, ..]);
    let labels: Array1<usize> = of_view.predict(&probes);
    assert_eq!(labels, expected.labels(probes).unwrap());
    let classifier = Classifier::new(ClassifierKind::NaiveBayes);
    let of_view = classifier.fit(&data.view()).unwrap();
    let of_owned = classifier.fit(&data).unwrap();
    assert_eq!(of_view.predict(&probes), of_owned.predict(&probes));
}

#[test]
fn labels_of_every_type_give_the_answers_of_numbers() {
    let data = overlapping(90);
    let numbers = rbf().fit(&data).unwrap();
    let expected: Array1<usize> = numbers.predict(&data.records);
    let name = |label: &usize| format!("class {label}");
    let texts = DatasetBase::new(data.records.view(), data.targets.map(name));
    let of_texts = rbf().fit(&texts).unwrap();
    assert_eq!(of_texts.classes(), ["class 2", "class 5", "class 9"]);
    assert_eq!(of_texts.predict(&data.records), expected.map(name));
    let counted = CountedTargets::new(data.targets.clone());
    let of_counted = rbf()
        .fit(&DatasetBase::new(data.records.view(), counted))
        .unwrap();
    assert_eq!(of_counted.problems(), numbers.problems());
    let is_nine = data.targets.map(|&label| label == 9);
    let of_bool = rbf()
        .fit(&DatasetBase::new(data.records.view(), is_nine.view()))
        .unwrap();
    assert_eq!(of_bool.classes(), [false, true]);
    let as_numbers = Dataset::new(data.records.clone(), is_nine.mapv(usize::from));
    let predicted: Array1<bool> = of_bool.predict(&data.records);
    let wanted: Array1<usize> = rbf().fit(&as_numbers).unwrap().predict(&data.records);
    assert_eq!(predicted.mapv(usize::from), wanted);
}

#[test]
fn cross_validation_of_linfa_is_that_of_its_folds() {
    let mut data = overlapping(90);
    let candidates = [0.1, 3.0].map(|c| SvmParams { c, ..rbf() });
    let accuracy = |predicted: &Array1<usize>, truth: &ArrayView1<usize>| {
        Ok(predicted.confusion_matrix(truth)?.accuracy())
    };
    let found = data
        .cross_validate_single(5, &candidates, accuracy)
        .unwrap();
    for (params, found) in candidates.iter().zip(found) {
        let of_folds = (0..5).map(|fold| {
            let is_held_out = |row: &usize| (fold * 18..(fold + 1) * 18).contains(row);
            let (test, train): (Vec<_>, Vec<_>) = (0..90).partition(is_held_out);
            let test = rows(&data, &test).unwrap();
            let model = params.train(&rows(&data, &train).unwrap()).unwrap();
            let predicted: Array1<usize> = model.predict(&test.records);
            let right = predicted.iter().zip(&test.targets).filter(|(a, b)| a == b);
            right.count() as f32 / 18.0
        });
        let expected = of_folds.sum::<f32>() / 5.0;
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
    let of_folds = data.iter_fold(3, |training| rbf().fit(training).unwrap());
    assert_eq!(of_folds.count(), 3);
}

#[test]
fn a_weight_of_two_is_the_row_twice() {
    let data = overlapping(60);
    let weights = Array1::from_shape_fn(60, |row| if row % 4 == 0 { 2.0 } else { 1.0 });
    let twice: Vec<usize> = (0..60)
        .flat_map(|row| vec![row; weights[row] as usize])
        .collect();
    let twice = rows(&data, &twice).unwrap();
    let weighted = data.clone().with_weights(weights);
    for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
        for kernel in [Kernel::Linear, rbf().kernel] {
            let params = SvmParams {
                kernel,
                multiclass,
                tolerance: 1e-8,
                ..SvmParams::default()
            };
            let values = |data: &Dataset| {
                let model = params.train(data).unwrap();
                model
                    .decision_values(overlapping(33).records.view())
                    .unwrap()
            };
            let (found, expected) = (values(&weighted), values(&twice));
            let farthest = (&found - &expected).fold(0.0, |far: f64, d| far.max(d.abs()));
            assert!(farthest < 1e-6, "{kernel:?} {multiclass:?}: {farthest}");
            let plain = values(&data);
            assert!((found - plain).iter().any(|d: &f64| d.abs() > 1e-3));
        }
    }
    let few_rows_of_many_features = Array2::from_shape_fn((160, 140), |(row, column)| {
        (1.3 * ((row % 2) * (column + 1)) as f64).cos() + (1.7 * (row * 5 + column) as f64).sin()
    });
    let wide = Dataset::new(
        few_rows_of_many_features,
        Array1::from_shape_fn(160, |row| row % 2),
    );
    let values = |data: &Dataset| {
        let params = SvmParams {
            c: 1e-3,
            tolerance: 1e-8,
            ..SvmParams::default()
        };
        params
            .train(data)
            .unwrap()
            .decision_values(wide.records.view())
            .unwrap()
    };
    // Equal weights multiply C. Without weights, this many features are solved near the margin.
    let doubled = wide.clone().with_weights(Array1::from_elem(160, 2.0));
    let all_twice: Vec<usize> = (0..160).flat_map(|row| [row, row]).collect();
    let all_twice = rows(&wide, &all_twice).unwrap();
    let farthest =
        (values(&doubled) - values(&all_twice)).fold(0.0, |far: f64, d| far.max(d.abs()));
    assert!(farthest < 1e-6, "{farthest}");
}

#[test]
fn weights_that_would_be_ignored_or_are_wrong_are_refused() {
    let data = overlapping(30);
    let weighted = |weights: Vec<f32>| data.clone().with_weights(Array1::from(weights));
    let said = |weights| rbf().train(&weighted(weights)).unwrap_err().to_string();
    assert!(said(vec![1.0; 29]).starts_with("weights: 29 of 30 rows; "));
    let mut zero = vec![1.0; 30];
    zero[7] = 0.0;
    assert!(said(zero).starts_with("weights, row 7: 0; "));
    let data = weighted(vec![1.0; 30]);
    for &kind in ClassifierKind::ALL {
        let refused = Classifier::new(kind).fit(&data).unwrap_err().to_string();
        assert!(refused.starts_with("weights: "), "{kind:?}: {refused}");
    }
    let folds = stratified_k_fold(data.targets.view(), 3, &0_u64).unwrap();
    let candidates = Candidates {
        c: vec![1.0],
        gamma_scales: Vec::new(),
    };
    let refused = choose(&rbf(), &data, &folds, &candidates).unwrap_err();
    assert!(refused.to_string().starts_with("weights: "));
}

#[test]
fn a_saved_model_gives_the_same_bits_and_a_damaged_one_is_refused() {
    let data = overlapping(60);
    let texts = DatasetBase::new(data.records.view(), data.targets.map(|l| l.to_string()));
    for params in [rbf(), SvmParams::default()] {
        let model = params.fit(&texts).unwrap();
        let saved = serde_json::to_value(&model).unwrap();
        let read: SvmModel<String> = serde_json::from_value(saved.clone()).unwrap();
        let probes = overlapping(99).records;
        let bits = |model: &SvmModel<String>| model.decision_values(probes.view()).unwrap();
        assert_eq!(bits(&read), bits(&model));
        assert_eq!(read.predict(&probes), model.predict(&probes));
        let refused = |key: &str, value: serde_json::Value| {
            let mut damaged = saved.clone();
            damaged[key] = value;
            serde_json::from_value::<SvmModel<String>>(damaged)
                .unwrap_err()
                .to_string()
        };
        assert!(refused("version", 99.into()).contains("version 99"));
        assert!(refused("n_features", 3.into()).contains("different sizes"));
        assert!(refused("classes", serde_json::json!(["2", "5"])).contains("different sizes"));
        assert!(refused("problems", serde_json::json!([])).contains("different sizes"));
        let mut damaged = saved.clone();
        let double = &mut damaged["decision"]["Double"];
        double["rho"] = saved["decision"]["Double"]["centre"].clone();
        let said = serde_json::from_value::<SvmModel<String>>(damaged).unwrap_err();
        assert!(said.to_string().contains("different sizes"), "{said}");
    }
}
