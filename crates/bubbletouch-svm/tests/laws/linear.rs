//! Linear SVMs without a kernel matrix, and logistic regression.
//!
//! Expected numbers: scikit-learn 1.9.1, `LinearSVC(C=0.5, loss="hinge", dual=True, tol=1e-9, max_iter=10**6)` and `LogisticRegression(tol=1e-10)`, on the rows
//! of [`waves`].

use crate::drawn;
use bubbletouch_svm::class_weight::ClassWeight;
use bubbletouch_svm::classifiers::ClassifierKind;
use bubbletouch_svm::classifiers::class_model::ClassModel;
use bubbletouch_svm::classifiers::classifier::{Classifier, Cost, TrainedClassifier};
use bubbletouch_svm::classifiers::logistic_regression::LogisticParams;
use bubbletouch_svm::classifiers::naive_bayes::NaiveBayes;
use bubbletouch_svm::cross_validation::choice::Candidates;
use bubbletouch_svm::dataset::{Dataset, dataset, rows};
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::linear_svm::{LinearSvm, LinearSvmParams};
use bubbletouch_svm::{Multiclass, SvmParams, SvmSolver};
use linfa::traits::Fit;
use ndarray::{Array1, Array2, ArrayView1, s};
use rand::Rng;

/// Returns 60 rows of 5 features in 4 alternating classes.
fn waves() -> Dataset {
    let value = |(i, j): (usize, usize)| {
        let wave = (1.7 * (i * 5 + j) as f64 + 0.3 * (j * j) as f64).sin();
        wave + 0.8 * (2.1 * ((i % 4) * (j + 1)) as f64).cos()
    };
    let features = Array2::from_shape_fn((60, 5), value);
    dataset(features, Array1::from_iter((0..60).map(|i| i % 4))).unwrap()
}

/// Returns 15, 5 and 3 rows of the first three classes of [`waves`].
fn unequal() -> Dataset {
    let is_kept = |row: &usize| row.is_multiple_of(4) || row % 12 == 1 || row % 20 == 2;
    let kept: Vec<usize> = (0..60).filter(is_kept).collect();
    rows(&waves(), &kept).unwrap()
}

/// Returns overlapping clusters of unequal size.
fn clusters(n_rows: usize, m: usize, n_classes: usize, seed: u64) -> Dataset {
    let mut rng = drawn::rng(seed, &["overlapping clusters"]);
    let centres = Array2::from_shape_fn((n_classes, m), |_| rng.gen_range(-1.0..1.0));
    let class = |row: usize| (row % (n_classes + 1)).min(n_classes - 1);
    let features = Array2::from_shape_fn((n_rows, m), |(row, column)| {
        centres[[class(row), column]] + rng.gen_range(-1.5..1.5)
    });
    dataset(features, Array1::from_iter((0..n_rows).map(class))).unwrap()
}

fn train(data: &Dataset, c: f64, tolerance: f64) -> LinearSvm {
    let params = LinearSvmParams {
        c,
        tolerance,
        max_passes: 1_000_000,
        ..LinearSvmParams::default()
    };
    params.train(data, &5_u64).unwrap()
}

fn assert_near(found: impl IntoIterator<Item = f64>, expected: &[f64], tolerance: f64) {
    let found: Vec<f64> = found.into_iter().collect();
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            (found - expected).abs() <= tolerance,
            "{found} is not {expected}"
        );
    }
}

#[test]
fn one_vs_rest_equals_scikit_learns_linear_svc() {
    let svm = train(&waves(), 0.5, 1e-9);
    let ends = svm.convergence();
    let objectives = [
        15.366914573528,
        15.060105298778,
        14.906813368505,
        15.376657926016,
    ];
    assert_near(ends.iter().map(|end| end.primal), &objectives, 1e-6);
    assert_near(ends.iter().map(|end| end.dual), &objectives, 1e-6);
    let first = [
        -0.143818134943,
        0.15983118678,
        -0.186518484283,
        -0.052406494197,
        0.338279044233,
    ];
    assert_near(svm.model().weights.row(0).to_vec(), &first, 1e-6);
    let bias = [
        -0.739283887419,
        -0.324594715372,
        -0.263073204499,
        -0.7490272399,
    ];
    assert_near(svm.model().bias.to_vec(), &bias, 1e-6);
}

#[test]
fn the_duality_gap_is_never_negative_and_closes_with_the_tolerance() {
    for seed in 0..2 {
        let data = clusters(150, 8, 5, seed);
        for c in [0.01, 1.0, 5.0] {
            let gap = |tolerance: f64| {
                let svm = train(&data, c, tolerance);
                assert_eq!(svm.n_capped(), 0);
                let ends = svm.convergence().iter();
                ends.map(|end| {
                    let gap = (end.primal - end.dual) / end.primal;
                    assert!(gap > -1e-12, "{gap}");
                    gap
                })
                .fold(0.0, f64::max)
            };
            let (coarse, fine) = (gap(0.1), gap(1e-5));
            assert!(coarse < 0.2 && fine < 2e-5, "{c} {coarse} {fine}");
        }
    }
}

#[test]
fn a_pass_cap_that_is_hit_is_counted() {
    let data = clusters(200, 4, 3, 3);
    let params = LinearSvmParams {
        c: 100.0,
        tolerance: 1e-9,
        max_passes: 2,
        ..LinearSvmParams::default()
    };
    let svm = params.train(&data, &0_u64).unwrap();
    assert_eq!(svm.n_capped(), 3);
    assert!(svm.convergence().iter().all(|end| end.n_passes == 2));
}

#[test]
fn logistic_regression_reaches_scikit_learns_optimum() {
    let all = waves();
    let two: Vec<usize> = (0..60).filter(|row| row % 4 < 2).collect();
    let two = rows(&all, &two).unwrap();
    // Two classes: only the difference of the weights is regularised.
    let cases = [
        (&all, 0.5, 1.0, 48.674741576237),
        (&all, 0.5, 100.0, 3265.611903134408),
        (&two, 1.0, 1.0, 5.382137411098),
        (&two, 1.0, 100.0, 27.381791327347),
    ];
    for (data, penalty, c, expected) in cases {
        let default = LogisticParams::default().tolerance;
        for (tolerance, within) in [(default, 1e-4), (1e-9, 1e-9)] {
            let params = LogisticParams {
                c,
                tolerance,
                ..LogisticParams::default()
            };
            let model = params.train(data).unwrap();
            assert_eq!(model.n_capped(), 0);
            let log_p = model.log_probabilities(data.records.view()).unwrap();
            let labels = data.targets.iter().enumerate();
            let loss: f64 = labels.map(|(row, &label)| -log_p[[row, label]]).sum();
            let squares = model.model().weights.mapv(|w| w * w).sum();
            let objective = c * loss + penalty * squares;
            let excess = objective / expected - 1.0;
            assert!(
                excess.abs() < within,
                "C = {c}: {objective} is not {expected}"
            );
        }
    }
}

#[test]
fn logistic_regression_reaches_its_tolerance_at_any_penalty_and_in_any_units() {
    let mut units = waves();
    for (column, unit) in [1.0, 1e3, 1e-3, 30.0, 1e-2].into_iter().enumerate() {
        let mut column = units.records.column_mut(column);
        column.mapv_inplace(|x| unit * (x + 5.0));
    }
    let all = [
        waves(),
        units,
        clusters(300, 30, 5, 3),
        clusters(90, 1, 3, 5),
        clusters(60, 30, 3, 7),
    ];
    for (number, data) in all.iter().enumerate() {
        for c in [1e-6, 1e-2, 1.0, 1e2, 1e4, 1e6] {
            // The objective and its gradient by the weights.
            let objective = |tolerance: f64| {
                let params = LogisticParams {
                    c,
                    tolerance,
                    ..LogisticParams::default()
                };
                let model = params.train(data).unwrap();
                assert_eq!(model.n_capped(), 0, "data {number}, C = {c}");
                let mut p = model.log_probabilities(data.records.view()).unwrap();
                let loss: f64 = (data.targets.iter().enumerate())
                    .map(|(row, &label)| -p[[row, label]])
                    .sum();
                p.mapv_inplace(f64::exp);
                for (row, &label) in data.targets.iter().enumerate() {
                    p[[row, label]] -= 1.0;
                }
                let weights = &model.model().weights;
                let gradient = c * p.t().dot(&data.records) + weights;
                let squares = weights.mapv(|w| w * w).sum();
                (c * loss + 0.5 * squares, gradient)
            };
            let (exact, gradient) = objective(1e-10);
            // The objective is strongly convex in the weights, so |gradient|² / 2 bounds its distance from the minimum.
            let gap = 0.5 * gradient.mapv(|g| g * g).sum() / exact;
            assert!(gap < 1e-5, "data {number}, C = {c}: {gap}");
            let (found, _) = objective(LogisticParams::default().tolerance);
            assert!(
                (found / exact - 1.0).abs() < LogisticParams::default().tolerance,
                "data {number}, C = {c}: {found} for {exact}"
            );
        }
    }
}

#[test]
fn labels_are_those_of_the_largest_probability_with_its_prior() {
    let data = clusters(200, 3, 3, 2);
    let rows = &data.records;
    let logistic = LogisticParams::default().train(&data).unwrap();
    let bayes = NaiveBayes::train(&data).unwrap();
    let cases: [(&dyn ClassModel, Array2<f64>); 2] = [
        (&logistic, logistic.log_probabilities(rows.view()).unwrap()),
        (&bayes, bayes.joint_log_likelihoods(rows.view()).unwrap()),
    ];
    let largest = |values: &Array2<f64>| -> Array1<usize> {
        let best = |row: ArrayView1<f64>| (0..3).max_by(|&a, &b| row[a].total_cmp(&row[b]));
        values.outer_iter().filter_map(best).collect()
    };
    for (model, probabilities) in cases {
        let labels = model.labels(rows.view()).unwrap();
        assert_eq!(labels, largest(&probabilities));
        assert_ne!(labels, largest(&model.scores(rows.view()).unwrap()));
    }
}

#[test]
fn balanced_weights_equal_repeated_rows() {
    // Class 0 has three times the rows of class 1 and five times those of class 2; repeating their rows balances the classes.
    let few = unequal();
    let repeated = few.targets.iter().enumerate();
    let repeated = repeated.flat_map(|(row, &class)| vec![row; [1, 3, 5][class]]);
    let repeated = rows(&few, &repeated.collect::<Vec<_>>()).unwrap();
    let scores = |data: &Dataset, class_weight, c| -> [Array2<f64>; 2] {
        let logistic = LogisticParams {
            c,
            class_weight,
            tolerance: 1e-12,
            ..LogisticParams::default()
        };
        let descent = LinearSvmParams {
            c,
            class_weight,
            tolerance: 1e-9,
            max_passes: 1_000_000,
        };
        let models: [Box<dyn ClassModel>; 2] = [
            Box::new(logistic.train(data).unwrap()),
            Box::new(descent.train(data, &5_u64).unwrap()),
        ];
        models.map(|model| model.scores(waves().records.view()).unwrap())
    };
    // The weights of the rows of class 0, 1 and 2 are 23/45, 23/15 and 23/9.
    let balanced = scores(&few, ClassWeight::Balanced, 45.0 / 23.0);
    let repeated = scores(&repeated, ClassWeight::Uniform, 1.0);
    for (balanced, repeated) in balanced.iter().zip(&repeated) {
        let worst = (balanced - repeated).fold(0.0, |worst: f64, error| error.abs().max(worst));
        assert!(worst < 1e-5, "{worst}");
    }
}

#[test]
fn balanced_svms_equal_scikit_learns() {
    // SVC(C=2, kernel, tol=1e-9, class_weight="balanced").
    let data = unequal();
    let gamma = Gamma::Scale;
    for (kernel, expected) in [
        (Kernel::Linear, [0.996787041, 1.850892466, 3.767750455]),
        (
            Kernel::Rbf { gamma },
            [1.001789851, 1.002117366, 0.891388367],
        ),
    ] {
        let params = SvmParams {
            kernel,
            c: 2.0,
            class_weight: ClassWeight::Balanced,
            tolerance: 1e-9,
            ..SvmParams::default()
        };
        let svm = params.train(&data).unwrap();
        let row = waves().records.slice_move(s![3..4, ..]);
        assert_near(svm.decision_values(row.view()).unwrap(), &expected, 1e-6);
    }
}

#[test]
fn the_choice_of_solver_and_margin_is_kept() {
    let data = clusters(120, 6, 3, 4);
    let linear = Classifier {
        solver: SvmSolver::CoordinateDescent,
        multiclass: Multiclass::OneVsRest,
        c: Cost::Chosen(Candidates {
            c: vec![1e-6, 0.1],
            gamma_scales: Vec::new(),
        }),
        ..Classifier::new(ClassifierKind::LinearSvm)
    };
    let trained = linear.fit(&data).unwrap();
    assert!(trained.svm().is_none());
    assert_eq!(trained.c(), trained.chosen().map(|chosen| chosen.best.c));
    let refused = [
        Classifier {
            kind: ClassifierKind::RbfSvm,
            ..linear.clone()
        },
        Classifier {
            multiclass: Multiclass::OneVsOne,
            ..linear
        },
    ];
    for classifier in refused {
        let error = classifier.fit(&data).unwrap_err().to_string();
        assert!(error.contains("linear_svm"), "{error}");
    }
}

#[test]
fn the_chosen_gamma_is_that_of_the_model() {
    let data = clusters(120, 6, 3, 4);
    let chosen = Classifier {
        c: Cost::Chosen(Candidates {
            c: vec![1.0, 10.0],
            gamma_scales: vec![0.01, 0.1],
        }),
        ..Classifier::new(ClassifierKind::RbfSvm)
    };
    let trained = chosen.fit(&data).unwrap();
    let best = trained.chosen().unwrap().best;
    let fixed = Classifier {
        c: Cost::Fixed(best.c),
        ..chosen.with_gamma(Gamma::Value(best.gamma.unwrap()))
    };
    let scores = |model: &TrainedClassifier| model.scores(data.records.view()).unwrap();
    assert_eq!(scores(&trained), scores(&fixed.fit(&data).unwrap()));
}
