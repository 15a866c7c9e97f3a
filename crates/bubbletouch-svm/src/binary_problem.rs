//! Binary problems of a multi-class SVM, solved.

use crate::dual::DualSolution;

/// A binary problem of a multi-class SVM and its solution.
#[derive(Clone, Debug, PartialEq)]
pub struct BinaryProblem {
    /// The class whose rows are positive.
    pub positive: usize,
    /// The class whose rows are negative; `None`: all others.
    pub negative: Option<usize>,
    /// The problem's rows, as indices of training rows.
    pub rows: Vec<usize>,
    /// The solution; its coefficients go with `rows`.
    pub solution: DualSolution,
}
