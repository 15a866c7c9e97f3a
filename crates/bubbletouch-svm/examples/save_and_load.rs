//! An SVM with probabilities that is saved as JSON and read again, bit by bit.
//!
//! `cargo run --release --example save_and_load`

use bubbletouch_svm::SvmParams;
use bubbletouch_svm::dataset::dataset;
use bubbletouch_svm::probabilities::ProbabilisticSvm;
use bubbletouch_svm::split::stratified_k_fold;
use ndarray::{Array1, Array2, s};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let features = Array2::from_shape_fn((300, 4), |(row, column)| {
        (1.3 * ((row % 3) * (column + 1)) as f64).cos() + (1.7 * (row * 5 + column) as f64).sin()
    });
    let data = dataset(features, Array1::from_shape_fn(300, |row| row % 3))?;
    let folds = stratified_k_fold(data.targets.view(), 5, &2018_u64)?;
    let model = SvmParams::default().train_with_probabilities(&data, &folds)?;

    let path = std::env::temp_dir().join("bubbletouch_svm_example.json");
    std::fs::write(&path, serde_json::to_string(&model)?)?;
    let read: ProbabilisticSvm = serde_json::from_str(&std::fs::read_to_string(&path)?)?;
    std::fs::remove_file(&path)?;

    let rows = data.records.slice(s![..3, ..]);
    assert_eq!(read.probabilities(rows)?, model.probabilities(rows)?);
    println!("classes {:?}", read.classes());
    println!("probabilities\n{:.3}", read.probabilities(rows)?);
    Ok(())
}
