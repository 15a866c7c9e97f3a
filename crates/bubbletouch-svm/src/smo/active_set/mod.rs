//! Active-set method: solution of a binary problem by linear equations [Scheinberg 2006].
//!
//! Pairwise steps approach the optimum quickly, but may need a million steps to reach it. If the variables at bounds are known, the optimum solves linear
//! equations: f is equal on all free variables, and their changes sum to 0. If the solution exceeds a bound, the step ends at the bound, and the variable is
//! removed from the free variables. If the solution is within all bounds, the variable at a bound with the largest violation of the optimality conditions
//! becomes free. The method ends when no variable violates the conditions. Few features imply few free variables, so their equations (`free_factor`) are small.

mod free_factor;

use free_factor::FreeFactor;

use crate::gram::matrix::Gram;
use crate::linalg::scalar::Scalar;
use crate::smo::reached::violation;
use crate::smo::variables::bounds;

/// Maximum number of free variables (multipliers between 0 and C) in the system of equations; others are added later.
const MAX_FREE: usize = 384;
/// Maximum number of variables at bounds that become free in one step.
const MAX_ENTERING: usize = 8;
/// Minimum violation of the optimality conditions for a variable to become free, relative to the largest violation.
const SHARE_OF_FARTHEST: f64 = 0.5;
/// Maximum number of repeated solutions of the equations, which linearly dependent rows can require.
const MAX_REPEATS: u64 = 8;

/// Penalty and stopping criteria of one solver run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SolverGoal {
    /// Penalty C of the soft-margin problem.
    pub c: f64,
    /// Maximum violation of the optimality conditions, in units of the decision value.
    pub tolerance: f64,
    /// Maximum number of steps. An active-set step ends at the optimum of the free variables, or at a bound that removes one variable.
    pub max_steps: u64,
}

/// Improves the coefficients β by active-set steps and updates their gradient f, given the limits of the coefficients. Returns the number of steps; 0 if fewer than two variables are free.
pub(crate) fn solve_by_active_set<T: Scalar>(
    gram: &mut Gram<T>,
    limits: &[f64],
    (beta, f): (&mut [f64], &mut [f64]),
    goal: SolverGoal,
) -> u64 {
    let Some(mut active_set) = ActiveSet::new(gram, limits, (beta, f), goal.c) else {
        return 0;
    };
    let (mut n_steps, mut n_repeats) = (0, 0);
    while n_steps < goal.max_steps {
        // At least one step is counted, so that the loop ends if nothing can move.
        n_steps += active_set.solve_free(goal.max_steps - n_steps).max(1);
        active_set.follow(gram);
        if active_set.violation() <= goal.tolerance {
            break;
        }
        let entering = active_set.entering();
        n_repeats += u64::from(entering.is_empty());
        if n_repeats > MAX_REPEATS || !active_set.join(gram, &entering) {
            break;
        }
    }
    n_steps
}

/// State of the active-set method: coefficients, gradient, and factors of the linear equations.
struct ActiveSet<'a> {
    /// Limit of each coefficient: its label times its weight in training.
    limits: &'a [f64],
    beta: &'a mut [f64],
    /// Gradient `y − Kβ` of the dual objective before the latest changes of β; y are the labels and K is the Gram matrix.
    f: &'a mut [f64],
    /// Changes of the coefficients β since the gradient f was last updated.
    changes: Vec<f64>,
    c: f64,
    factor: FreeFactor,
    /// Whether each variable is free, that is, whether it has a position in the factors.
    has_place: Vec<bool>,
    /// Value of the gradient f, equal for all free variables, after the last solution of the equations.
    level: f64,
}

impl<'a> ActiveSet<'a> {
    /// Creates the state of the active-set method; returns `None` if fewer than two variables are between their bounds.
    fn new<T: Scalar>(
        gram: &mut Gram<T>,
        limits: &'a [f64],
        (beta, f): (&'a mut [f64], &'a mut [f64]),
        c: f64,
    ) -> Option<Self> {
        let is_free = |&i: &usize| {
            let (lowest, highest) = bounds(limits[i], c);
            beta[i] > lowest && beta[i] < highest
        };
        let free: Vec<usize> = (0..limits.len()).filter(is_free).take(MAX_FREE).collect();
        (free.len() > 1).then(|| {
            let mut own = Self {
                changes: vec![0.0; limits.len()],
                factor: FreeFactor::default(),
                has_place: Vec::new(),
                limits,
                beta,
                f,
                c,
                level: 0.0,
            };
            own.take(gram, &free);
            own
        })
    }

    /// Factorises the kernel matrix of the given free variables.
    fn take<T: Scalar>(&mut self, gram: &mut Gram<T>, free: &[usize]) {
        self.factor = FreeFactor::new(gram, free);
        self.has_place = vec![false; self.limits.len()];
        for (_, variable) in self.factor.variables() {
            self.has_place[variable] = true;
        }
    }

    /// Moves the free variables to their common optimum; variables that reach a bound stay there. Returns the number of steps.
    fn solve_free(&mut self, max_steps: u64) -> u64 {
        let mut f = self.factor.values(&self.f[..]);
        for n_steps in 0..max_steps {
            let Some((steps, level)) = self.factor.solve(&f) else {
                return n_steps;
            };
            self.level = level;
            let (share, blocked) = self.step_fraction(&steps);
            let ridge = self.factor.ridge();
            for (place, variable) in self.factor.variables() {
                let step = share * steps[place];
                self.beta[variable] += step;
                self.changes[variable] += step;
                f[place] -= share * (f[place] - level) - ridge * step;
            }
            let Some((place, bound)) = blocked else {
                return n_steps + 1;
            };
            let variable = self.factor.variable(place);
            self.changes[variable] += bound - self.beta[variable];
            self.beta[variable] = bound;
            f[place] = 0.0;
            self.has_place[variable] = false;
            self.factor.leave(place);
        }
        max_steps
    }

    /// Returns the fraction of the given steps at which the first variable reaches a bound, at most 1. If a variable blocks the step, returns its position and
    /// the bound.
    fn step_fraction(&self, steps: &[f64]) -> (f64, Option<(usize, f64)>) {
        let (mut share, mut blocked) = (1.0, None);
        for (place, variable) in self.factor.variables() {
            let (beta, step) = (self.beta[variable], steps[place]);
            let (lowest, highest) = bounds(self.limits[variable], self.c);
            let bound = if step > 0.0 { highest } else { lowest };
            if step != 0.0 && (bound - beta) / step <= share {
                (share, blocked) = ((bound - beta) / step, Some((place, bound)));
            }
        }
        (share, blocked)
    }

    /// Updates the gradient f after changes of the coefficients β.
    fn follow<T: Scalar>(&mut self, gram: &mut Gram<T>) {
        gram.take_times(&self.changes, self.f);
        self.changes.fill(0.0);
    }

    fn violation(&self) -> f64 {
        violation(self.beta, self.limits, self.f, self.c)
    }

    /// Returns the variables at bounds that violate the optimality conditions most, if they violate them more than all free variables.
    fn entering(&self) -> Vec<usize> {
        let mut beyond = vec![0.0; self.beta.len()];
        let mut farthest = [0.0_f64; 2];
        for (i, beyond) in beyond.iter_mut().enumerate() {
            let (lowest, highest) = bounds(self.limits[i], self.c);
            let by = self.f[i] - self.level;
            let rises = if self.beta[i] < highest { by } else { 0.0 };
            let falls = if self.beta[i] > lowest { -by } else { 0.0 };
            let farthest = &mut farthest[usize::from(self.has_place[i])];
            *beyond = rises.max(falls);
            *farthest = beyond.max(*farthest);
        }
        if farthest[0] <= farthest[1] {
            return Vec::new();
        }
        let least = SHARE_OF_FARTHEST * farthest[0];
        let is_far = |&i: &usize| !self.has_place[i] && beyond[i] >= least;
        let mut entering: Vec<usize> = (0..beyond.len()).filter(is_far).collect();
        entering.sort_by(|&i, &j| beyond[j].total_cmp(&beyond[i]));
        entering.truncate(MAX_ENTERING);
        entering
    }

    /// Adds the given variables to the free variables, as far as memory for the factors is available. Returns true if at least one variable was added, or if
    /// none had to be added.
    fn join<T: Scalar>(&mut self, gram: &mut Gram<T>, entering: &[usize]) -> bool {
        for (number, &variable) in entering.iter().enumerate() {
            if !self.factor.join(gram, variable) {
                // Entering variables come first; variables that depend on them linearly are omitted for now.
                let free = self.factor.variables().map(|(_, variable)| variable);
                let all = entering[number..].iter().copied().chain(free);
                let all: Vec<usize> = all.take(MAX_FREE).collect();
                self.take(gram, &all);
                return self.has_place[variable];
            }
            self.has_place[variable] = true;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::smo::Smo;
    use crate::smo::variables::extremes;
    use ndarray::{Array1, Array2};

    /// Returns inner products and labels of n test rows with m features; the first half is separated from the second half by `apart`.
    fn problem(n: usize, m: usize, apart: f64) -> (Array2<f64>, Vec<f64>) {
        let rows = Array2::from_shape_fn((n, m), |(i, j)| {
            let side = if i < n / 2 { apart } else { -apart };
            // The sine's last digits give linearly independent rows.
            (((i * m + j) as f64).sin() * 1e4).fract() + side
        });
        (
            rows.dot(&rows.t()),
            (0..n).map(|i| if i < n / 2 { 1.0 } else { -1.0 }).collect(),
        )
    }

    fn objective(beta: &[f64], f: &[f64], labels: &[f64]) -> f64 {
        let terms = (0..f.len()).map(|i| beta[i] * (labels[i] + f[i]) / 2.0);
        terms.sum()
    }

    fn f_of(kernel: &Array2<f64>, beta: &[f64], labels: &[f64]) -> Vec<f64> {
        let product = kernel.dot(&Array1::from(beta.to_vec()));
        labels.iter().zip(product).map(|(y, p)| y - p).collect()
    }

    fn goal(c: f64, tolerance: f64) -> SolverGoal {
        SolverGoal {
            c,
            tolerance,
            max_steps: 5000,
        }
    }

    /// Asserts that active-set steps from `start` reach the same objective as pairwise steps.
    fn assert_settles((kernel, labels): &(Array2<f64>, Vec<f64>), start: Vec<f64>, c: f64) {
        let mut gram = Gram::whole(kernel.view());
        let expected = Smo::new(&mut gram, labels).solve(c, 1e-7).objective;
        let (mut beta, mut f) = (start.clone(), f_of(kernel, &start, labels));
        let before = objective(&beta, &f, labels);
        let n_steps = solve_by_active_set(&mut gram, labels, (&mut beta, &mut f), goal(c, 1e-7));
        assert!(n_steps > 0);
        let found = objective(&beta, &f, labels);
        assert!(found >= before, "{found} {before}");
        assert!(
            (found - expected).abs() < 1e-6 * expected,
            "{found} {expected}"
        );
        let (highest, lowest) = extremes(&beta, labels, &f, c);
        assert!(highest - lowest <= 1e-7, "{}", highest - lowest);
        for (f, expected) in f.iter().zip(f_of(kernel, &beta, labels)) {
            assert!((f - expected).abs() < 1e-8 * c.max(1.0), "{f} {expected}");
        }
        assert!((beta.iter().sum::<f64>() - start.iter().sum::<f64>()).abs() < 1e-9 * c.max(1.0));
        for (beta, y) in beta.iter().zip(labels) {
            assert!((0.0..=c).contains(&(beta * y)), "{beta} of {c}");
        }
    }

    #[test]
    fn from_a_rough_solution_the_optimum_is_reached() {
        for (n, m, apart, c) in [
            (40, 60, 0.1, 10.0),
            (60, 200, 0.3, 1.0),
            (50, 70, 0.0, 0.02),
            (90, 12, 0.1, 30.0),
        ] {
            let (kernel, labels) = problem(n, m, apart);
            let mut gram = Gram::whole(kernel.view());
            let mut smo = Smo::new(&mut gram, &labels);
            assert!(smo.reach(c, 0.05, |_| None).is_solved);
            let rough = smo.variables().0.to_vec();
            assert_settles(&(kernel, labels), rough, c);
        }
    }

    #[test]
    fn of_rows_that_depend_on_each_other_more_are_free_than_there_are_equations() {
        // Three features allow at most four free variables. In the last case, more variables than the capacity are free at first.
        for n in [20, MAX_FREE + 60] {
            let problem = problem(n, 3, 0.1);
            let start = problem.1.iter().map(|y| 0.1 * y).collect();
            assert_settles(&problem, start, 1.0);
        }
    }

    #[test]
    fn rows_that_take_no_part_keep_out() {
        let (kernel, mut labels) = problem(60, 8, 0.1);
        // The numbers of rows of both classes are equal.
        for label in labels.iter_mut().step_by(5) {
            *label = 0.0;
        }
        let start = labels.iter().map(|y| 0.1 * y).collect();
        assert_settles(&(kernel, labels), start, 1.0);
    }

    #[test]
    fn it_goes_no_further_than_it_may() {
        let (kernel, labels) = problem(60, 20, 0.1);
        let mut gram = Gram::whole(kernel.view());
        let start: Vec<f64> = labels.iter().map(|y| 0.1 * y).collect();
        for max_steps in [0, 1, 7] {
            let (mut beta, mut f) = (start.clone(), f_of(&kernel, &start, &labels));
            let goal = SolverGoal {
                max_steps,
                ..goal(1.0, 1e-9)
            };
            let n_steps = solve_by_active_set(&mut gram, &labels, (&mut beta, &mut f), goal);
            assert_eq!(n_steps, max_steps);
            for (f, expected) in f.iter().zip(f_of(&kernel, &beta, &labels)) {
                assert!((f - expected).abs() < 1e-9, "{f} {expected}");
            }
        }
        let (mut beta, mut f) = (vec![0.0; 60], labels.clone());
        assert_eq!(
            solve_by_active_set(&mut gram, &labels, (&mut beta, &mut f), goal(1.0, 1e-9)),
            0
        );
    }
}
