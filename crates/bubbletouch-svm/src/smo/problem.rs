//! A binary problem, and the solution of the C for which it was solved last.

use super::reached::violation;
use super::solver_scalar::SolverScalar;
use super::variables::{linear_and_quadratic, rho};
use crate::gram::matrix::Gram;

/// Iterations after which a problem counts as not solved, as in LIBSVM; 100 per row if that is more. Larger: hard problems take hours; smaller:
/// problems that LIBSVM solves are reported as not solved.
const MAX_ITERATIONS: u64 = 10_000_000;

/// Binary problem on a Gram matrix, with the solution of the C for which it was solved last.
pub(crate) struct Smo<'a, G> {
    pub(super) gram: &'a mut G,
    /// The labels: 1, −1, or 0 for a row that takes no part.
    pub(super) y: &'a [f64],
    pub(super) beta: Vec<f64>,
    /// y − Kβ.
    pub(super) f: Vec<f64>,
    /// The C that β belongs to; 0 before the first.
    pub(super) c: f64,
    /// Whether f was summed from β in f64.
    pub(super) is_summed: bool,
    /// Iterations after which the problem counts as not solved.
    pub(super) max_iterations: u64,
}

impl<'a, G> Smo<'a, G> {
    /// Creates an unsolved problem.
    pub fn new(gram: &'a mut G, y: &'a [f64]) -> Self {
        Self {
            is_summed: true,
            ..Self::from_start(gram, y, (vec![0.0; y.len()], y.to_vec()), 0.0)
        }
    }

    /// Limits the iterations: after `max_iterations` the problem is left unsolved.
    pub fn with_max_iterations(self, max_iterations: u64) -> Self {
        Self {
            max_iterations,
            ..self
        }
    }

    /// Creates a problem with a start β and an approximate f of it, for the penalty `c`; 0 if they belong to none.
    pub fn from_start(
        gram: &'a mut G,
        y: &'a [f64],
        (beta, f): (Vec<f64>, Vec<f64>),
        c: f64,
    ) -> Self {
        Self {
            gram,
            y,
            beta,
            f,
            c,
            is_summed: false,
            max_iterations: MAX_ITERATIONS.max(100 * y.len() as u64),
        }
    }

    /// β, and f of it.
    pub fn variables(&self) -> (&[f64], &[f64]) {
        (&self.beta, &self.f)
    }

    /// ρ of the solution for a C.
    pub fn rho(&self, c: f64) -> f64 {
        rho(&self.beta, self.y, &self.f, c)
    }

    /// β, and f of it.
    pub fn into_variables(self) -> (Vec<f64>, Vec<f64>) {
        (self.beta, self.f)
    }

    /// Sums f again in f64.
    pub(super) fn refresh<T: SolverScalar>(&mut self)
    where
        G: Gram<T>,
    {
        let products = self.gram.times(&self.beta);
        for ((f, product), y) in self.f.iter_mut().zip(products).zip(self.y) {
            *f = y - product;
        }
        self.is_summed = true;
    }

    /// Takes f, which belongs to another β, to this one.
    pub(super) fn follow<T: SolverScalar>(&mut self, before: Vec<f64>)
    where
        G: Gram<T>,
    {
        let mut change = before;
        for (change, beta) in change.iter_mut().zip(&self.beta) {
            *change = beta - *change;
        }
        self.gram.take_times(&change, &mut self.f);
    }

    /// `Σ y β − ½ β K β`.
    pub(super) fn objective(&self) -> f64 {
        let (linear, quadratic) = linear_and_quadratic(&self.beta, self.y, &self.f);
        linear - 0.5 * quadratic
    }

    pub(super) fn violation(&self, c: f64) -> f64 {
        violation(&self.beta, self.y, &self.f, c)
    }
}
