//! Solved binary problems of a multi-class SVM.

use serde::{Deserialize, Serialize};

use crate::dual::DualSolution;

/// Binary problem of a multi-class SVM (one class against another or against all others), with its solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BinaryProblem {
    /// Position of the positive class, whose rows have the label +1.
    pub positive: usize,
    /// Position of the negative class, whose rows have the label −1. `None` if all classes except the positive class are negative.
    pub negative: Option<usize>,
    /// Indices of the training rows that belong to the two classes of the problem.
    pub rows: Vec<usize>,
    /// Solution of the dual problem, with one coefficient for each entry of `rows`.
    pub solution: DualSolution,
}
