//! State of a binary problem: its Gram matrix, and its solution for the most recent penalty C.

use super::reached::violation;
use super::solver_scalar::SolverScalar;
use super::variables::{linear_and_quadratic, rho, signs};
use crate::gram::matrix::Gram;

/// Default maximum number of iterations, as in LIBSVM; for many rows, 100 times the number of rows. With a larger value, hard problems take hours; with a
/// smaller value, problems that LIBSVM solves are reported as not solved.
const MAX_ITERATIONS: u64 = 10_000_000;

/// Binary problem, given by a Gram matrix and labels, with its solution for the last penalty C.
pub(crate) struct Smo<'a, 'k, T> {
    pub(super) gram: &'a mut Gram<'k, T>,
    /// Limit of each coefficient β: its label times its weight in training, or 0 for a row that is excluded from the problem. β is between 0 and C times its
    /// limit.
    pub(super) limits: &'a [f64],
    /// Label of each row: 1, −1, or 0 for an excluded row.
    pub(super) y: Vec<f64>,
    pub(super) beta: Vec<f64>,
    /// Gradient `y − Kβ` of the dual objective, where y are the labels and K is the Gram matrix.
    pub(super) f: Vec<f64>,
    /// Penalty C for which the coefficients β were computed; 0 if the problem has not been solved.
    pub(super) c: f64,
    /// Whether the gradient f was recomputed in f64 from the coefficients β; otherwise it was updated step by step.
    pub(super) is_summed: bool,
    /// Maximum number of iterations of the solver; a problem that reaches it is reported as unsolved.
    pub(super) max_iterations: u64,
}

impl<'a, 'k, T: SolverScalar> Smo<'a, 'k, T> {
    /// Creates an unsolved binary problem, given the limits of its coefficients.
    pub fn new(gram: &'a mut Gram<'k, T>, limits: &'a [f64]) -> Self {
        Self {
            is_summed: true,
            ..Self::from_start(gram, limits, (vec![0.0; limits.len()], signs(limits)), 0.0)
        }
    }

    /// Creates a problem that starts from coefficients β and their approximate gradient f. The penalty for which β was computed is `c`, or 0 if there is none.
    pub fn from_start(
        gram: &'a mut Gram<'k, T>,
        limits: &'a [f64],
        (beta, f): (Vec<f64>, Vec<f64>),
        c: f64,
    ) -> Self {
        Self {
            gram,
            limits,
            y: signs(limits),
            beta,
            f,
            c,
            is_summed: false,
            max_iterations: MAX_ITERATIONS.max(100 * limits.len() as u64),
        }
    }

    /// Returns the coefficients β and the gradient f of the problem.
    pub fn variables(&self) -> (&[f64], &[f64]) {
        (&self.beta, &self.f)
    }

    /// Returns the offset ρ of the decision function, given the C of the solution.
    pub fn rho(&self, c: f64) -> f64 {
        rho(&self.beta, self.limits, &self.f, c)
    }

    /// Converts the problem to its coefficients β and its gradient f.
    pub fn into_variables(self) -> (Vec<f64>, Vec<f64>) {
        (self.beta, self.f)
    }

    /// Returns whether no coefficient has reached its limit for the penalty `c`, except 0.
    pub fn is_below_limits(&self, c: f64) -> bool {
        let mut both = self.beta.iter().zip(self.limits);
        both.all(|(beta, limit)| *beta == 0.0 || beta.abs() < c * limit.abs())
    }

    /// Recomputes the gradient f from the coefficients β in f64.
    pub(super) fn refresh(&mut self) {
        let products = self.gram.times(&self.beta);
        for ((f, product), y) in self.f.iter_mut().zip(products).zip(&self.y) {
            *f = y - product;
        }
        self.is_summed = true;
    }

    /// Updates the gradient f after a change of the coefficients β, given the previous coefficients `before`.
    pub(super) fn follow(&mut self, before: Vec<f64>) {
        let mut change = before;
        for (change, beta) in change.iter_mut().zip(&self.beta) {
            *change = beta - *change;
        }
        self.gram.take_times(&change, &mut self.f);
    }

    /// Returns the dual objective `Σ y β − ½ β K β`, with labels y, coefficients β and Gram matrix K.
    pub(super) fn objective(&self) -> f64 {
        let (linear, quadratic) = linear_and_quadratic(&self.beta, &self.y, &self.f);
        linear - 0.5 * quadratic
    }

    pub(super) fn violation(&self, c: f64) -> f64 {
        violation(&self.beta, self.limits, &self.f, c)
    }
}
