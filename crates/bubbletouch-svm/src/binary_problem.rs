//! Solved binary problems of a multi-class SVM.

use crate::dual::DualSolution;

/// A binary problem of a multi-class SVM and its solution.
#[derive(Clone, Debug, PartialEq)]
pub struct BinaryProblem {
    /// The class whose rows are positive.
    pub positive: usize,
    /// The class whose rows are negative; `None` if all other classes are negative.
    pub negative: Option<usize>,
    /// The problem's rows, as indices of training rows.
    pub rows: Vec<usize>,
    /// The solution; its coefficients are in the order of `rows`.
    pub solution: DualSolution,
}
