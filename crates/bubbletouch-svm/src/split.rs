//! Rows to train on and rows to test on.

use std::collections::BTreeMap;

use ndarray::ArrayView1;

use crate::{Error, Result};

/// Rows to train on and rows to test on, by index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Split {
    /// Training rows in drawing order: one of each class in turn, each class's rows shuffled. So a smaller training
    /// set is a prefix of a larger one; see [`at_most`](Split::at_most).
    pub train: Vec<usize>,
    /// Test rows, ascending.
    pub test: Vec<usize>,
}

impl Split {
    /// The split with only the first `per_class` training rows of each class; the test rows stay.
    ///
    /// The training rows are a prefix of this split's, so the sets of a learning curve are nested.
    /// `labels` holds the label of every row of the data set.
    ///
    /// # Errors
    /// `per_class` is 0 or above the number of training rows of some class.
    pub fn at_most(&self, labels: ArrayView1<usize>, per_class: usize) -> Result<Split> {
        let mut counts = BTreeMap::<usize, usize>::new();
        for &row in &self.train {
            *counts.entry(labels[row]).or_default() += 1;
        }
        let fewest = counts.values().copied().min().unwrap_or(0);
        if per_class == 0 || per_class > fewest {
            return Err(Error::input(
                "training touches per object",
                per_class,
                format!("1 to {fewest} is allowed, the fewest training rows of a class"),
            ));
        }
        let n_train = per_class * counts.len();
        Ok(Split {
            train: self.train[..n_train].to_vec(),
            test: self.test.clone(),
        })
    }

    /// A split of this split's training rows (such as a validation split), given in positions within `train`, as
    /// rows of the whole data set.
    ///
    /// # Panics
    /// If `inner` holds a position beyond the training rows.
    pub fn within_train(&self, inner: &Split) -> Split {
        let whole = |positions: &[usize]| positions.iter().map(|&i| self.train[i]).collect();
        let mut test: Vec<usize> = whole(&inner.test);
        test.sort_unstable();
        Split {
            train: whole(&inner.train),
            test,
        }
    }
}
