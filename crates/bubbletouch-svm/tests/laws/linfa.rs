//! The classifiers `linfa_svm` and `linfa_rbf_svm` give the labels of linfa-svm itself.

use bubbletouch_svm::classifiers::ClassifierKind;
use bubbletouch_svm::classifiers::classifier::{Classifier, Cost};
use bubbletouch_svm::classifiers::naive_bayes::{NaiveBayes, VARIANCE_SMOOTHING};
use bubbletouch_svm::dataset::Dataset;
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::scaling::Scaling;
use linfa::composing::MultiClassModel;
use linfa::dataset::Pr;
use linfa::traits::{Fit, Predict};
use linfa_bayes::{GaussianNb, NaiveBayes as _};
use linfa_svm::Svm;
use ndarray::{Array1, Array2};

/// Rows of four overlapping classes with the labels 1, 3, 5, 7.
fn overlapping(n_rows: usize, phase: f64) -> Dataset {
    let value = |(row, column): (usize, usize)| {
        let centre = (1.3 * ((row % 4) * (column + 1)) as f64).cos();
        centre + 0.9 * (1.7 * (row * 3 + column) as f64 + phase).sin()
    };
    let features = Array2::from_shape_fn((n_rows, 3), value);
    Dataset::new(
        features,
        Array1::from_shape_fn(n_rows, |row| 2 * (row % 4) + 1),
    )
}

/// Labels of linfa's own one-vs-all model of probabilities.
fn direct(training: &Dataset, test: &Array2<f64>, gamma: Option<f64>, c: f64) -> Array1<usize> {
    let params = Svm::<f64, Pr>::params().pos_neg_weights(c, c).eps(1e-3);
    let params = match gamma {
        None => params.linear_kernel(),
        Some(gamma) => params.gaussian_kernel(1.0 / gamma),
    };
    let models = training.one_vs_all().unwrap().into_iter();
    let models = models.map(|(label, data)| (label, params.fit(&data).unwrap()));
    let mut models: Vec<(usize, Svm<f64, Pr>)> = models.collect();
    models.sort_by_key(|(label, _)| *label);
    models
        .into_iter()
        .collect::<MultiClassModel<_, _>>()
        .predict(test)
}

#[test]
fn labels_are_those_of_linfas_multi_class_model() {
    let (training, test) = (overlapping(80, 0.0), overlapping(200, 0.4).records);
    let rbf = Kernel::Rbf {
        gamma: Gamma::Scale,
    };
    let scale = rbf.gamma_scale(training.records.view());
    let cases = [
        (ClassifierKind::LinfaSvm, None, None),
        (ClassifierKind::LinfaRbfSvm, Some(0.7), Some(0.7)),
        (ClassifierKind::LinfaRbfSvm, None, Some(scale)),
    ];
    for (kind, given, gamma) in cases {
        for c in [0.1, 1.0, 10.0] {
            let mut classifier = Classifier {
                scaling: Scaling::None,
                c: Cost::Fixed(c),
                ..Classifier::new(kind)
            };
            if let Some(gamma) = given {
                classifier = classifier.with("gamma", gamma).unwrap();
            }
            let model = classifier.train(&training, &1_u64).unwrap();
            let labels = model.labels(test.view()).unwrap();
            assert_eq!(
                labels,
                direct(&training, &test, gamma, c),
                "{kind:?} {gamma:?} {c}"
            );
            assert_eq!((model.c(), model.n_capped()), (Some(c), 0));
            let scores = model.scores(test.view()).unwrap();
            assert!(
                scores
                    .iter()
                    .all(|score| *score <= 0.0 && score.is_finite())
            );
            assert_eq!(labels, model.labels_of_scores(scores.view()));
        }
    }
}

#[test]
fn gamma_belongs_to_the_gaussian_kernel_and_its_grid_to_our_solvers() {
    let (linear, rbf) = (ClassifierKind::LinfaSvm, ClassifierKind::LinfaRbfSvm);
    assert!(rbf.uses("gamma") && !linear.uses("gamma"));
    for kind in [linear, rbf] {
        assert!(kind.uses("c") && kind.uses("c_grid") && kind.uses("tolerance"));
        assert!(!kind.uses("gamma_grid") && !kind.uses("solver") && !kind.uses("multiclass"));
        let mut classifier = Classifier::new(kind);
        classifier.c = Cost::Fixed(-1.0);
        let error = classifier.train(&overlapping(20, 0.0), &1_u64).unwrap_err();
        assert!(error.to_string().contains("above 0"), "{error}");
    }
    let error = Classifier::new(linear)
        .with("gamma", 1.0)
        .unwrap_err()
        .to_string();
    assert!(error.contains("linfa_rbf_svm"), "{error}");
}

#[test]
fn naive_bayes_has_the_joint_log_likelihoods_of_linfa_bayes() {
    let (training, test) = (overlapping(97, 0.0), overlapping(60, 0.5));
    let ours = NaiveBayes::train(&training).unwrap();
    let ours = ours.joint_log_likelihoods(test.records.view()).unwrap();
    let params = GaussianNb::params().var_smoothing(VARIANCE_SMOOTHING);
    let theirs = params.fit(&training).unwrap();
    let theirs = theirs.joint_log_likelihood(test.records.view());
    for (place, class) in [1, 3, 5, 7].iter().enumerate() {
        assert_eq!(ours.column(place), theirs[class]);
    }
}
