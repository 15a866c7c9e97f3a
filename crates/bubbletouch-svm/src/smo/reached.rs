//! What a search reached.

use super::variables::{extremes, linear_and_quadratic, rho};
use crate::dataset::all_finite;
use crate::dual::DualSolution;

/// How a search ended.
pub(crate) struct Reached {
    /// Whether within its tolerance.
    pub is_solved: bool,
    pub n_iterations: u64,
}

impl Reached {
    /// What is to be said of a solution, but its coefficients: of β, the labels of its rows, and f of it.
    pub fn solution(self, variables: (&[f64], &[f64], &[f64]), c: f64) -> DualSolution {
        let (beta, y, f) = variables;
        let (linear, quadratic) = linear_and_quadratic(beta, y, f);
        DualSolution {
            coefficients: Vec::new(),
            rho: rho(beta, y, f, c),
            is_capped: !self.is_solved,
            objective: linear - 0.5 * quadratic,
            violation: Some(violation(beta, y, f, c).max(0.0)),
            n_iterations: Some(self.n_iterations),
        }
    }
}

/// How far the optimality conditions for a C are violated; below 0 when they hold with room to spare, infinite when kernel
/// values have left nothing to go by.
pub(crate) fn violation(beta: &[f64], y: &[f64], f: &[f64], c: f64) -> f64 {
    if !all_finite(f) {
        return f64::INFINITY;
    }
    let (highest, lowest) = extremes(beta, y, f, c);
    highest - lowest
}
