//! Result of a solver run.

use super::variables::{extremes, linear_and_quadratic, rho, signs};
use crate::dataset::all_finite;
use crate::dual::DualSolution;

/// Result of a solver run: whether the run converged, and its number of iterations.
pub(crate) struct Reached {
    /// Whether the solver reached its tolerance.
    pub is_solved: bool,
    pub n_iterations: u64,
}

impl Reached {
    /// Creates the dual solution without its coefficients, given the coefficients β, their limits for the penalty `c`, and the gradient f.
    pub fn solution(self, beta: &[f64], limits: &[f64], f: &[f64], c: f64) -> DualSolution {
        let (linear, quadratic) = linear_and_quadratic(beta, &signs(limits), f);
        DualSolution {
            coefficients: Vec::new(),
            rho: rho(beta, limits, f, c),
            is_capped: !self.is_solved,
            objective: linear - 0.5 * quadratic,
            violation: Some(violation(beta, limits, f, c).max(0.0)),
            n_iterations: Some(self.n_iterations),
        }
    }
}

/// Returns the violation of the optimality conditions at the coefficients `beta` with the given limits for the penalty `c`. The value is negative if the conditions hold strictly,
/// and infinite if the gradient is not finite.
pub(crate) fn violation(beta: &[f64], limits: &[f64], f: &[f64], c: f64) -> f64 {
    if !all_finite(f) {
        return f64::INFINITY;
    }
    let (highest, lowest) = extremes(beta, limits, f, c);
    highest - lowest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gradient_that_is_no_number_violates_the_conditions() {
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(violation(&[0.0], &[1.0], &[bad], 1.0), f64::INFINITY);
        }
    }
}
