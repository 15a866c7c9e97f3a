//! Difficult data sets for support vector machines whose solution is known without another program.

use crate::drawn::params;
use bubbletouch_svm::dataset::dataset;
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::{Multiclass, SvmParams};
use ndarray::{Array1, Array2, array};

const RBF: Kernel = Kernel::Rbf {
    gamma: Gamma::Scale,
};
const CUBIC: Kernel = Kernel::Polynomial {
    gamma: Gamma::Scale,
    coef0: 1.0,
    degree: 3,
};

#[test]
fn an_enormous_c_separates_what_can_be_separated() {
    // Six well separated clusters: with C = 1e6, the hard margin is found and no problem is capped.
    let features = Array2::from_shape_fn((60, 2), |(i, j)| {
        [(i % 6) as f64, ((i % 6) * (i % 6)) as f64][j] * 3.0 + (i as f64 * 1.3 + j as f64).sin()
    });
    let data = dataset(features, Array1::from_iter((0..60).map(|i| i % 6))).unwrap();
    for kernel in [Kernel::Linear, RBF] {
        let model = params(kernel, 1e6, 1e-3).train(&data).unwrap();
        assert_eq!(model.n_capped(), 0);
        assert_eq!(model.labels(data.records.view()).unwrap(), data.targets);
    }
}

#[test]
fn a_gaussian_kernel_learns_xor_and_a_linear_one_cannot() {
    let data = dataset(
        array![[0.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0]],
        array![0, 0, 1, 1],
    )
    .unwrap();
    let rbf = params(RBF, 10.0, 1e-3).train(&data).unwrap();
    assert_eq!(rbf.labels(data.records.view()).unwrap(), data.targets);
    // γ = 1 / (2 · 0.25) = 2. By symmetry all multipliers are equal: a (1 + e⁻⁴ − 2 e⁻²) = 1 gives |f| = 1.
    let a = 1.0 / (1.0 + (-4.0_f64).exp() - 2.0 * (-2.0_f64).exp());
    for coefficient in &rbf.problems()[0].solution.coefficients {
        assert!((coefficient.abs() - a).abs() < 2e-3);
    }
    let linear = params(Kernel::Linear, 10.0, 1e-3).train(&data).unwrap();
    assert_ne!(linear.labels(data.records.view()).unwrap(), data.targets);
}

#[test]
fn duplicated_points_with_opposite_labels_end_at_c() {
    let data = dataset(
        array![[0.5, 2.0], [0.5, 2.0], [0.5, 2.0], [0.5, 2.0]],
        array![0, 1, 0, 1],
    )
    .unwrap();
    for kernel in [Kernel::Linear, RBF, CUBIC] {
        let params = params(kernel, 3.0, 1e-3);
        let model = params.train(&data).unwrap();
        assert_eq!(model.n_capped(), 0);
        let coefficients = &model.problems()[0].solution.coefficients;
        assert!(
            coefficients.iter().all(|a| (a.abs() - 3.0).abs() < 1e-9),
            "{coefficients:?}"
        );
        let values = model.decision_values(data.records.view()).unwrap();
        assert!(
            values.iter().all(|value| value.abs() < 1e-9),
            "no reason for either class"
        );
    }
}

#[test]
fn two_to_thirty_classes_are_told_apart_even_with_gaps_between_labels() {
    for n_classes in 2..=30 {
        // Class c lies on an axis of its own in an n-dimensional grid; its label is 3c + 1.
        let features = Array2::from_shape_fn((3 * n_classes, n_classes), |(i, j)| {
            let jitter = 0.1 * ((i * n_classes + j) as f64 * 2.3).sin();
            jitter + if i % n_classes == j { 2.0 } else { 0.0 }
        });
        let labels = Array1::from_iter((0..3 * n_classes).map(|i| 3 * (i % n_classes) + 1));
        let data = dataset(features, labels).unwrap();
        for multiclass in [Multiclass::OneVsOne, Multiclass::OneVsRest] {
            let params = SvmParams {
                multiclass,
                c: 10.0,
                ..SvmParams::default()
            };
            let model = params.train(&data).unwrap();
            assert_eq!(model.labels(data.records.view()).unwrap(), data.targets);
            assert_eq!(model.classes().len(), n_classes);
        }
    }
}

#[test]
fn a_class_of_one_row_is_learnt() {
    let data = dataset(array![[0.0], [0.1], [0.2], [5.0]], array![0, 0, 0, 1]).unwrap();
    for kernel in [Kernel::Linear, RBF] {
        let model = params(kernel, 100.0, 1e-3).train(&data).unwrap();
        assert_eq!(model.labels(data.records.view()).unwrap(), data.targets);
    }
}
