//! Ranks of feature values; growing trees needs only ranks, and integers are faster to sort.

use ndarray::{Array2, ArrayView2, Axis};

/// Feature values replaced by ranks: the distinct values of each feature in ascending order, and the rank of each row's value.
#[derive(Clone, Debug)]
pub(crate) struct Ranked {
    /// Rank of each row's value among the distinct values of the feature, m × n_rows.
    ranks: Array2<u32>,
    /// Distinct values of each feature, in ascending order.
    values: Vec<Vec<f64>>,
}

impl Ranked {
    /// Computes the ranks of finite features (n_rows × m).
    pub(crate) fn new(features: ArrayView2<f64>) -> Self {
        let mut ranks = Array2::zeros((features.ncols(), features.nrows()));
        let mut values = Vec::with_capacity(features.ncols());
        for (column, mut ranks) in features.axis_iter(Axis(1)).zip(ranks.rows_mut()) {
            let mut order: Vec<(f64, u32)> = column.iter().copied().zip(0..).collect();
            order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            let mut distinct: Vec<f64> = Vec::new();
            for (value, row) in order {
                // −0 and 0 count as equal, although total_cmp orders them.
                if distinct.last() != Some(&value) {
                    distinct.push(value);
                }
                ranks[row as usize] = distinct.len() as u32 - 1;
            }
            values.push(distinct);
        }
        Self { ranks, values }
    }

    pub(crate) fn n_features(&self) -> usize {
        self.values.len()
    }

    pub(crate) fn n_rows(&self) -> usize {
        self.ranks.ncols()
    }

    pub(crate) fn rank(&self, feature: usize, row: u32) -> u32 {
        self.ranks[[feature, row as usize]]
    }

    /// Returns the split threshold between two adjacent ranks of a feature: the midpoint of their values. If the midpoint rounds to the upper value, returns
    /// the lower value.
    pub(crate) fn threshold(&self, feature: usize, lower: u32, upper: u32) -> f64 {
        let (low, high) = (
            self.values[feature][lower as usize],
            self.values[feature][upper as usize],
        );
        let middle = 0.5 * low + 0.5 * high;
        if middle < high { middle.max(low) } else { low }
    }
}
