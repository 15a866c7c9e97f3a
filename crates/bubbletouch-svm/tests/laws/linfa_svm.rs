//! The wines of linfa-svm's own tests, with weights of the classes, in folds.

use bubbletouch_svm::SvmParams;
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::predict::svm_model::SvmModel;
use linfa::DatasetBase;
use linfa::dataset::{AsSingleTargets, Dataset};
use linfa::prelude::ToConfusionMatrix;
use linfa::traits::{Fit, Predict};
use ndarray::{Array1, Ix1};

type Labelled = Dataset<f64, bool, Ix1>;

/// Returns the parameters of an SVM with linfa's Gaussian kernel `exp(−‖x − z‖² / ε)`.
fn gaussian(eps: f64) -> SvmParams {
    let gamma = Gamma::Value(1.0 / eps);
    SvmParams {
        kernel: Kernel::Rbf { gamma },
        ..SvmParams::default()
    }
}

/// Gives the rows linfa's `pos_neg_weights`: the penalty of a row is C = 1 times its weight.
fn weighted(data: Labelled, [positive, negative]: [f32; 2]) -> Labelled {
    let weight = |&is_positive: &bool| if is_positive { positive } else { negative };
    let weights = data.targets.map(weight);
    data.with_weights(weights)
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

/// linfa-svm's own test of the first weights trains on no row, because it has one fold; its accuracy above 0.85 is the fraction of the larger class. The
/// expected accuracies are those of scikit-learn's `SVC` in the same folds; its rows have another order.
#[test]
fn wines_in_folds_have_the_accuracy_of_libsvm() {
    for (eps, weights, k, expected) in [
        (40.0, [50_000.0, 5_000.0], 5, 0.8207),
        (80.0, [7.0, 0.6], 4, 0.6598),
    ] {
        let accuracy = validated(&gaussian(eps), weights, k);
        assert!((accuracy - expected).abs() < 0.003, "{accuracy}");
    }
}
