//! Weights of classes in training.

use ndarray::Array1;
use serde::{Deserialize, Serialize};

/// Weights of the classes in training; the errors on a row count as its weight.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ClassWeight {
    /// Each row has the weight 1; frequent classes are favoured.
    #[default]
    Uniform,
    /// A row of class k has the weight n_rows / (n_classes · n_k), where n_k is the number of training rows of the class, as in scikit-learn. All classes then
    /// have the same total weight.
    Balanced,
}

impl ClassWeight {
    /// Returns the weight of each class, shape (n_classes,), given the class of each training row as an index.
    pub fn of_classes(self, label: &[usize], n_classes: usize) -> Array1<f64> {
        let mut sizes = vec![0; n_classes];
        label.iter().for_each(|&class| sizes[class] += 1);
        self.of_sizes(sizes)
    }

    /// Returns the weight of each class, shape (n_classes,), given its number of training rows. A class without training rows does not count.
    pub(crate) fn of_sizes(self, sizes: impl IntoIterator<Item = usize>) -> Array1<f64> {
        let sizes = Array1::from_iter(sizes);
        if self == Self::Uniform {
            return Array1::ones(sizes.len());
        }
        let n_classes = sizes.iter().filter(|&&n| n > 0).count();
        let mean = sizes.sum() as f64 / n_classes as f64;
        sizes.mapv(|n| if n > 0 { mean / n as f64 } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_without_rows_changes_no_balanced_weight() {
        let weights = ClassWeight::Balanced.of_classes(&[0, 2, 0, 0], 3);
        assert_eq!(weights.to_vec(), [2.0 / 3.0, 0.0, 2.0]);
    }
}
