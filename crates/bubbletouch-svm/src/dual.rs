//! The solution of one binary soft-margin problem, whatever solved it.

/// The solution of one binary dual problem: maximise `Σ_i a_i − ½ Σ_ij a_i a_j y_i y_j K(x_i, x_j)` over `0 ≤ a_i ≤ C`,
/// `Σ_i y_i a_i = 0`, with y = +1 for positive rows and −1 for the others. The decision function is
/// `f(x) = Σ_i y_i a_i K(x_i, x) − ρ`.
#[derive(Clone, Debug, PartialEq)]
pub struct DualSolution {
    /// `y_i a_i`, per row of the problem: positive for positive rows, 0 for rows that are no support vectors.
    pub coefficients: Vec<f64>,
    /// ρ.
    pub rho: f64,
    /// The dual objective that was reached.
    pub objective: f64,
    /// How far the optimality (KKT) conditions are violated, in units of the decision value; `None` where the solver does
    /// not say.
    pub violation: Option<f64>,
    /// Iterations that it took; `None` where the solver does not say.
    pub n_iterations: Option<u64>,
    /// Whether the solver stopped at its iteration cap short of its tolerance.
    pub is_capped: bool,
}
