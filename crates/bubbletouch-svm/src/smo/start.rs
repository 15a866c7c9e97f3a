//! Starting points of the solver.

use super::problem::Smo;
use super::solver_scalar::SolverScalar;
use super::variables::{bounds, linear_and_quadratic};
use crate::gram::row_sums::add_row;

impl<T: SolverScalar> Smo<'_, '_, T> {
    /// Returns the problem with a start for small C: all multipliers are C, except 0 for the surplus rows of the larger class. The surplus rows are its rows
    /// that are farthest from the other class. If the objective with equal multipliers has its maximum below C, or
    /// if rows have weights, all multipliers start at 0. `sums` contains the
    /// product of the Gram matrix with the labels.
    pub fn at_bounds(mut self, c: f64, sums: &[f64]) -> Self {
        let y = &self.y;
        let curvature: f64 = y.iter().zip(sums).map(|(y, sum)| y * sum).sum();
        // The comparison is also false if kernel values are not finite.
        let still_rises = c * curvature <= y.iter().map(|y| y * y).sum::<f64>();
        if !still_rises || self.limits != *y {
            return self;
        }
        let balance: f64 = y.iter().sum();
        let mut larger: Vec<usize> = (0..y.len()).filter(|&i| y[i] * balance > 0.0).collect();
        larger.sort_by(|&i, &j| (y[j] * sums[j]).total_cmp(&(y[i] * sums[i])));
        self.beta = y.iter().map(|y| c * y).collect();
        self.f = y.iter().zip(sums).map(|(y, sum)| y - c * sum).collect();
        for &i in larger.iter().take(balance.abs() as usize) {
            self.beta[i] = 0.0;
            let n = y.len();
            let row = self.gram.row(i);
            add_row(&mut self.f, &row[..n], c * y[i]);
        }
        self.c = c;
        self
    }

    /// Multiplies the coefficients β by the factor that gives the best objective within the bounds for another C.
    pub(super) fn stretch(&mut self, c: f64) {
        let (linear, quadratic) = linear_and_quadratic(&self.beta, &self.y, &self.f);
        if self.c > 0.0 && self.c != c && quadratic > 0.0 {
            let most = c / self.c;
            let factor = (linear / quadratic).clamp(0.0, most);
            for (beta, limit) in self.beta.iter_mut().zip(self.limits) {
                let is_at_bound = *beta == self.c * limit;
                let (lowest, highest) = bounds(*limit, c);
                *beta = if is_at_bound && factor == most {
                    c * limit
                } else {
                    (factor * *beta).clamp(lowest, highest)
                };
            }
            for (f, y) in self.f.iter_mut().zip(&self.y) {
                *f = y - factor * (y - *f);
            }
        }
    }

    /// Replaces the coefficients β and the gradient f by another start (β, f) if the other start has a higher objective.
    pub(super) fn prefer(&mut self, other: (Vec<f64>, Vec<f64>)) {
        let objective = self.objective();
        let own = (
            std::mem::replace(&mut self.beta, other.0),
            std::mem::replace(&mut self.f, other.1),
        );
        // The comparison is also false if kernel values are not finite.
        let is_higher = self.objective() > objective;
        if !is_higher {
            (self.beta, self.f) = own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gram::matrix::Gram;
    use ndarray::Array2;

    /// Returns the kernel matrix and labels of test points on a line; the classes overlap, and one class has five more rows.
    fn problem(gamma: f64) -> (Gram<'static, f64>, Vec<f64>) {
        let n = 45;
        let at = |i: usize| (i as f64 * 1.7).sin() + if i % 9 < 4 { 0.4 } else { 0.0 };
        let kernel =
            Array2::from_shape_fn((n, n), |(i, j)| (-gamma * (at(i) - at(j)).powi(2)).exp());
        (
            Gram::whole(kernel.view()),
            (0..n).map(|i| if i % 9 < 4 { 1.0 } else { -1.0 }).collect(),
        )
    }

    #[test]
    fn the_start_is_allowed_and_f_is_its_gradient() {
        let (mut gram, y) = problem(0.01);
        let sums = gram.times(&y);
        let smo = Smo::new(&mut gram, &y).at_bounds(0.1, &sums);
        assert_eq!(smo.beta.iter().filter(|beta| **beta == 0.0).count(), 5);
        assert!(smo.beta.iter().sum::<f64>().abs() < 1e-12);
        let (beta, f) = (smo.beta.clone(), smo.f.clone());
        let mut resumed = Smo::from_start(&mut gram, &y, (beta, Vec::new()), 0.1);
        resumed.f = vec![0.0; f.len()];
        resumed.refresh();
        for (f, expected) in f.iter().zip(&resumed.f) {
            assert!((f - expected).abs() < 1e-12, "{f} {expected}");
        }
    }

    #[test]
    fn a_gradient_that_only_seems_optimal_is_computed_again() {
        let (mut gram, y) = problem(1.0);
        let expected = Smo::new(&mut gram, &y).solve(1.0, 1e-9);
        let nothing = || vec![0.0; y.len()];
        let mut smo = Smo::from_start(&mut gram, &y, (nothing(), nothing()), 0.0);
        let found = smo.solve(1.0, 1e-9);
        assert!((found.objective - expected.objective).abs() < 1e-8);
    }

    #[test]
    fn a_large_c_starts_from_nothing() {
        let (mut gram, y) = problem(30.0);
        let sums = gram.times(&y);
        let smo = Smo::new(&mut gram, &y).at_bounds(1e4, &sums);
        assert!(smo.c == 0.0 && smo.beta.iter().all(|beta| *beta == 0.0));
    }

    #[test]
    fn another_start_leads_to_the_same_solution_and_the_optimum_itself_takes_no_step() {
        let (mut gram, y) = problem(1.0);
        let expected = Smo::new(&mut gram, &y).solve(1.0, 1e-9);
        for factor in [1.0, 0.5, 0.0] {
            let other = expected.coefficients.iter().map(|beta| factor * beta);
            let other: Vec<f64> = other.collect();
            let products = gram.times(&other);
            let f = y.iter().zip(products).map(|(y, product)| y - product);
            let f: Vec<f64> = f.collect();
            let mut smo = Smo::new(&mut gram, &y);
            let reached = smo.reach(1.0, 1e-9, |_| Some((other, f)));
            assert!((smo.objective() - expected.objective).abs() < 1e-8);
            assert_eq!(reached.n_iterations == 0, factor == 1.0, "{factor}");
        }
    }
}
