//! An SVM among linfa's classifiers: folds, cross-validation over C, and a confusion matrix.
//!
//! `cargo run --release --example pipeline`

use bubbletouch_svm::SvmParams;
use bubbletouch_svm::kernel::{Gamma, Kernel};
use linfa::Dataset;
use linfa::prelude::ToConfusionMatrix;
use linfa::traits::{Fit, Predict};
use ndarray::{Array1, Array2, ArrayView1};

/// Returns rows of two classes, an inner and an outer ring.
fn rings(n_rows: usize) -> Dataset<f64, bool, ndarray::Ix1> {
    let features = Array2::from_shape_fn((n_rows, 2), |(row, column)| {
        let angle = 2.4 * row as f64;
        let radius = 1.0 + f64::from(u8::from(row % 2 == 0)) + 0.4 * (1.7 * row as f64).sin();
        radius
            * if column == 0 {
                angle.cos()
            } else {
                angle.sin()
            }
    });
    Dataset::new(features, Array1::from_shape_fn(n_rows, |row| row % 2 == 0))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut data = rings(300);
    let with_c = |c| SvmParams {
        kernel: Kernel::Rbf {
            gamma: Gamma::Scale,
        },
        c,
        ..SvmParams::default()
    };
    let candidates = [0.01, 0.1, 1.0, 10.0];
    let accuracy = |predicted: &Array1<bool>, truth: &ArrayView1<bool>| {
        Ok(predicted.confusion_matrix(truth)?.accuracy())
    };
    let params = candidates.map(with_c);
    let accuracies = data.cross_validate_single(5, &params, accuracy)?;
    for (c, accuracy) in candidates.iter().zip(&accuracies) {
        println!("C = {c}: {accuracy:.3} of the held-out rows are right");
    }
    let (training, test) = data.split_with_ratio(0.8);
    let model = with_c(1.0).fit(&training)?;
    let predicted: Array1<bool> = model.predict(test.records());
    println!("{:?}", predicted.confusion_matrix(&test)?);
    Ok(())
}
