//! Solution of a binary soft-margin problem, common to all solvers.

use serde::{Deserialize, Serialize};

/// Solution of a binary SVM's dual problem. The problem is: maximise `Σ_i a_i − ½ Σ_ij a_i a_j y_i y_j K(x_i, x_j)` subject to `0 ≤ a_i ≤ C` and `Σ_i y_i a_i =
/// 0`. Positive rows have y = +1, negative rows y = −1. The decision function is `f(x) = Σ_i y_i a_i K(x_i, x) − ρ`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DualSolution {
    /// Coefficient per row, label times multiplier: positive for positive rows, negative for negative rows, and 0 for rows that are not support vectors.
    pub coefficients: Vec<f64>,
    /// Offset ρ that is subtracted in the decision function.
    pub rho: f64,
    /// Value of the dual objective at the solution, dimensionless.
    pub objective: f64,
    /// Largest violation of the optimality (KKT) conditions, in units of the decision value; `None` if the solver does not compute it.
    pub violation: Option<f64>,
    /// Number of solver iterations; `None` if the solver does not count them.
    pub n_iterations: Option<u64>,
    /// Whether the solver stopped at its iteration cap before reaching its tolerance.
    pub is_capped: bool,
}
