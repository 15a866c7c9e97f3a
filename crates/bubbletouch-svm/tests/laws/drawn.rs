//! Random data sets, and folds of their rows.

use bubbletouch_svm::SvmParams;
use bubbletouch_svm::dataset::{Dataset, dataset};
use bubbletouch_svm::kernel::Kernel;
use bubbletouch_svm::split::Split;
use ndarray::{Array1, Array2};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use sha2::{Digest, Sha256};

/// Returns the parameters of an SVM with the given kernel, penalty C and tolerance.
pub fn params(kernel: Kernel, c: f64, tolerance: f64) -> SvmParams {
    SvmParams {
        kernel,
        c,
        tolerance,
        ..SvmParams::default()
    }
}

/// Returns the random generator of a seed and words: the ChaCha8 stream whose key is their SHA-256. The tolerances of the laws were measured on its rows.
pub fn rng(seed: u64, words: &[&str]) -> ChaCha8Rng {
    let start: [u8; 32] = Sha256::digest(seed.to_le_bytes()).into();
    let key = words.iter().fold(start, |key, word| {
        let hash = Sha256::new().chain_update(key).chain_update(b"word");
        hash.chain_update(word.as_bytes()).finalize().into()
    });
    ChaCha8Rng::from_seed(key)
}

/// Returns Gaussian clusters around the corners of a simplex, `apart` standard deviations from its middle, with the given number of rows per class.
pub fn clusters(counts: &[usize], apart: f64, seed: u64) -> Dataset {
    let mut rng = rng(seed, &["clusters"]);
    let labels: Vec<usize> = (0..*counts.iter().max().unwrap())
        .flat_map(|turn| (0..counts.len()).filter(move |&class| turn < counts[class]))
        .collect();
    let features = Array2::from_shape_fn((labels.len(), counts.len()), |(row, column)| {
        let noise: f64 = rng.sample(StandardNormal);
        noise + if labels[row] == column { apart } else { 0.0 }
    });
    dataset(features, Array1::from(labels)).unwrap()
}

/// Returns `n` folds; the rows of each class are dealt to the folds one after the other.
pub fn folds(labels: &Array1<usize>, n: usize) -> Vec<Split> {
    let mut seen = std::collections::BTreeMap::<usize, usize>::new();
    let fold_of: Vec<usize> = (labels.iter())
        .map(|&label| {
            let count = seen.entry(label).or_default();
            *count += 1;
            *count % n
        })
        .collect();
    let rows = |is_in: &dyn Fn(usize) -> bool| {
        (0..labels.len())
            .filter(|&row| is_in(fold_of[row]))
            .collect()
    };
    let split = |fold| Split {
        train: rows(&|of| of != fold),
        test: rows(&|of| of == fold),
    };
    (0..n).map(split).collect()
}
