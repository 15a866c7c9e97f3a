//! Solved binary problems of a multi-class SVM.

use crate::dual::DualSolution;

/// A binary problem of a multi-class SVM and its solution.
#[derive(Clone, Debug, PartialEq)]
pub struct BinaryProblem {
    /// Positive class: its rows have y = +1.
    pub positive: usize,
    /// Negative class: its rows have y = −1. `None` if all other classes are negative.
    pub negative: Option<usize>,
    /// Rows of the problem, as indices of training rows.
    pub rows: Vec<usize>,
    /// Solution of the dual problem; its coefficients are in the order of `rows`.
    pub solution: DualSolution,
}
