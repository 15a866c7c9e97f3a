//! The claims of linfa-svm's own tests, on the same data sets. Its tests of ν-SVMs, one-class SVMs and regression have no counterpart here.

use bubbletouch_svm::SvmParams;
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::predict::svm_model::SvmModel;
use linfa::DatasetBase;
use linfa::dataset::{AsSingleTargets, Dataset};
use linfa::prelude::ToConfusionMatrix;
use linfa::traits::{Fit, Predict};
use ndarray::{Array1, Array2, Axis, Ix1, concatenate};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

type Labelled = Dataset<f64, bool, Ix1>;

fn svm(kernel: Kernel) -> SvmParams {
    SvmParams {
        kernel,
        ..SvmParams::default()
    }
}

/// linfa's Gaussian kernel `exp(−‖x − z‖² / ε)`.
fn gaussian(eps: f64) -> Kernel {
    Kernel::Rbf {
        gamma: Gamma::Value(1.0 / eps),
    }
}

/// Gives the rows linfa's `pos_neg_weights`: the penalty of a row is C = 1 times its weight.
fn weighted(data: Labelled, [positive, negative]: [f32; 2]) -> Labelled {
    let weight = |&is_positive: &bool| if is_positive { positive } else { negative };
    let weights = data.targets.map(weight);
    data.with_weights(weights)
}

fn accuracy(params: &SvmParams, data: &Labelled) -> f32 {
    let predicted: Array1<bool> = params.fit(data).unwrap().predict(&data.records);
    predicted
        .confusion_matrix(data.as_single_targets())
        .unwrap()
        .accuracy()
}

/// Good wines, of a quality above 6: 217 of 1,599.
fn good_wines() -> Labelled {
    linfa_datasets::winequality().map_targets(|quality| *quality > 6)
}

/// Returns the mean accuracy of `k` folds whose training rows have the given weights.
fn validated(params: &SvmParams, weights: [f32; 2], k: usize) -> f32 {
    let mut wines = weighted(good_wines(), weights);
    let folds = wines.iter_fold(k, |training| {
        let labels = training.targets.to_owned();
        let data = DatasetBase::new(training.records.to_owned(), labels);
        params.fit(&weighted(data, weights)).unwrap()
    });
    let accuracies = folds.map(|(model, valid)| {
        let predicted: Array1<bool> = model.predict(&valid.records);
        predicted
            .confusion_matrix(valid.as_single_targets())
            .unwrap()
            .accuracy()
    });
    accuracies.sum::<f32>() / k as f32
}

#[test]
fn models_and_parameters_are_send_and_sync() {
    fn has_autotraits<T: Send + Sync + Sized + Unpin>() {}
    has_autotraits::<SvmModel>();
    has_autotraits::<SvmParams>();
}

#[test]
fn two_boxes_are_separated_by_a_line() {
    let mut rng = ChaCha8Rng::seed_from_u64(42);
    let mut corner = |low, high| Array2::from_shape_simple_fn((10, 2), || rng.gen_range(low..high));
    let records = concatenate![Axis(0), corner(-1.0, -0.5), corner(0.5, 1.0)];
    let data = Dataset::new(records, Array1::from_shape_fn(20, |row| row < 10));
    assert_eq!(
        accuracy(&svm(Kernel::Linear), &weighted(data, [1.0, 1.0])),
        1.0
    );
}

#[test]
fn a_parabola_separates_the_middle_of_a_line_from_its_ends() {
    let mut rng = ChaCha8Rng::seed_from_u64(42);
    let records = Array2::from_shape_simple_fn((40, 1), || rng.gen_range(-2.0..2.0));
    let targets = records.map_axis(Axis(1), |row| row[0] * row[0] < 0.5);
    let parabola = Kernel::Polynomial {
        gamma: Gamma::Value(1.0),
        coef0: 0.0,
        degree: 2,
    };
    let accuracy = accuracy(&svm(parabola), &Dataset::new(records, targets));
    assert!(accuracy > 0.9, "{accuracy}");
}

#[test]
fn rings_within_each_other_are_separated() {
    let mut rng = ChaCha8Rng::seed_from_u64(42);
    let mut records = Array2::zeros((20, 2));
    for (row, mut point) in records.outer_iter_mut().enumerate() {
        let (noise, angle) = (rng.gen_range(0.0..0.1), rng.gen_range(0.0..TAU));
        let radius = if row < 10 { 1.0 } else { 5.0 };
        point[0] = radius * f64::cos(angle) + noise;
        point[1] = radius * f64::sin(angle) + noise;
    }
    let data = Dataset::new(records, Array1::from_shape_fn(20, |row| row < 10));
    let accuracy = accuracy(&svm(gaussian(50.0)), &data);
    assert!(accuracy > 0.9, "{accuracy}");
}

/// linfa-svm's own test of the first weights trains on no row, because it has one fold; its accuracy above 0.85 is the fraction of the larger class. The
/// expected accuracies are those of scikit-learn's `SVC` in the same folds; its rows have another order.
#[test]
fn wines_in_folds_have_the_accuracy_of_libsvm() {
    for (eps, weights, k, expected) in [
        (40.0, [50_000.0, 5_000.0], 5, 0.8207),
        (80.0, [7.0, 0.6], 4, 0.6598),
    ] {
        let accuracy = validated(&svm(gaussian(eps)), weights, k);
        assert!((accuracy - expected).abs() < 0.003, "{accuracy}");
    }
}
