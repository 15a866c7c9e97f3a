//! A grid of C and γ by cross-validation, with the time that it takes.
//!
//! `cargo run --release --example grid`

use bubbletouch_svm::SvmParams;
use bubbletouch_svm::cross_validation::choice::{Candidates, choose};
use bubbletouch_svm::dataset::dataset;
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::split::stratified_k_fold;
use ndarray::{Array1, Array2};
use std::time::Instant;

fn main() -> Result<(), bubbletouch_svm::Error> {
    let features = Array2::from_shape_fn((1200, 16), |(row, column)| {
        (1.3 * ((row % 6) * (column + 1)) as f64).cos() + (1.7 * (row * 5 + column) as f64).sin()
    });
    let data = dataset(features, Array1::from_shape_fn(1200, |row| row % 6))?;
    let folds = stratified_k_fold(data.targets.view(), 5, &2018_u64)?;
    let params = SvmParams {
        kernel: Kernel::Rbf {
            gamma: Gamma::Scale,
        },
        ..SvmParams::default()
    };
    let candidates = Candidates {
        c: vec![0.1, 1.0, 10.0, 100.0],
        gamma_scales: vec![0.25, 0.5, 1.0, 2.0],
    };
    let start = Instant::now();
    let chosen = choose(&params, &data, &folds, &candidates)?;
    println!(
        "{} candidates on 5 folds: {:.2?}",
        chosen.tried.len(),
        start.elapsed()
    );
    println!("best: {:?}", chosen.best);
    Ok(())
}
