//! Solver of a binary problem: pairwise steps, checked in f64, and active-set steps if convergence is slow.

use super::active_set::{SolverGoal, solve_by_active_set};
use super::iterations::{SHRINK_PERIOD, Search, Stop};
use super::problem::Smo;
use super::reached::Reached;
use super::shrinking::solve_part;
use super::solver_scalar::SolverScalar;
use super::variables::Variables;
use crate::dual::DualSolution;
use crate::gram::matrix::Gram;

/// Minimum number of pairwise steps before the solver may use active-set steps. With a larger value, slowly converging problems take longer; with a smaller
/// value, equations are solved without need.
const MIN_PAIR_STEPS: u64 = 10_000;
/// Minimum number of pairwise steps per row before active-set steps.
const PAIR_STEPS_PER_ROW: u64 = 20;
/// Violation of the optimality conditions below which problems of few rows change from pairwise steps to active-set steps.
const EQUATIONS_FROM: f64 = 0.03;
/// Maximum number of solver restarts; a restart is needed if a check in f64 finds a violation that the matrix in f32 hides. With a larger value, time is spent
/// on rounding errors; with a smaller value, solutions may miss their tolerance.
const MAX_REFRESHES: usize = 30;

impl<'k, T: SolverScalar> Smo<'_, 'k, T> {
    /// Solves the binary problem for a given C, starting from the last solution. The violation of the optimality conditions is at most `tolerance`.
    pub fn solve(&mut self, c: f64, tolerance: f64) -> DualSolution {
        let reached = self.reach(c, tolerance, |_| None);
        DualSolution {
            coefficients: self.beta.clone(),
            ..reached.solution(&self.beta, self.limits, &self.f, c)
        }
    }

    /// Solves the problem from the last solution: pairwise steps to a rough tolerance, followed by active-set steps. If the active-set steps do not reach the
    /// tolerance, pairwise steps continue.
    pub fn reach_by_equations(&mut self, goal: SolverGoal) -> Reached {
        self.max_iterations = self.max_iterations.min(goal.max_steps);
        if goal.tolerance >= EQUATIONS_FROM {
            return self.reach(goal.c, goal.tolerance, |_| None);
        }
        let first = self.reach(goal.c, EQUATIONS_FROM, |_| None);
        let n_steps = self.solve_equations(goal.c, goal.tolerance);
        self.is_summed = false;
        let last = self.reach(goal.c, goal.tolerance, |_| None);
        Reached {
            n_iterations: first.n_iterations + n_steps + last.n_iterations,
            ..last
        }
    }

    /// Improves the solution by at most one active-set step per row. Returns the number of steps.
    fn solve_equations(&mut self, c: f64, tolerance: f64) -> u64 {
        let goal = SolverGoal {
            c,
            tolerance,
            max_steps: self.limits.len() as u64,
        };
        let variables = (&mut self.beta[..], &mut self.f[..]);
        solve_by_active_set(self.gram, self.limits, variables, goal)
    }

    /// Solves the problem from the last solution or, if its objective is higher, from another start (coefficients β and gradient f). Returns whether the solver
    /// converged, and the number of iterations.
    pub fn reach(
        &mut self,
        c: f64,
        tolerance: f64,
        other: impl FnOnce(&mut Gram<'k, T>) -> Option<(Vec<f64>, Vec<f64>)>,
    ) -> Reached {
        let mut search = Search::new(self.max_iterations, tolerance);
        if !self.is_summed && self.violation(c) <= tolerance {
            self.refresh();
        }
        // C never falls. If no multiplier was limited by its bound, a larger C does not change β.
        let stays = self.violation(c) <= tolerance;
        if !stays {
            self.stretch(c);
            if let Some(other) = other(self.gram) {
                self.prefer(other);
            }
        }
        let is_solved = stays || self.violation(c) <= tolerance || self.search(c, &mut search);
        self.c = c;
        Reached {
            is_solved,
            n_iterations: search.n_iterations,
        }
    }

    /// Runs the solver until it reaches the tolerance or the maximum number of iterations; returns whether it reached the tolerance.
    fn search(&mut self, c: f64, search: &mut Search) -> bool {
        let max_iterations = search.max_iterations;
        let pair_steps = MIN_PAIR_STEPS.max(PAIR_STEPS_PER_ROW * self.limits.len() as u64);
        let (mut n_refreshes, mut is_first) = (0, true);
        while n_refreshes < MAX_REFRESHES {
            let before = self.beta.clone();
            search.max_iterations = max_iterations.min(search.n_iterations + pair_steps);
            self.search_once(c, search, is_first);
            is_first = false;
            if self.is_summed {
                self.follow(before);
            } else {
                self.refresh();
            }
            if self.violation(c) <= search.tolerance {
                return true;
            }
            if search.n_iterations >= max_iterations {
                return false;
            }
            if search.n_iterations >= search.max_iterations {
                // Pairwise steps converge slowly here.
                search.n_iterations += self.solve_equations(c, search.tolerance);
            } else {
                n_refreshes += 1;
            }
        }
        false
    }

    /// Runs the pairwise steps of the solver once on all variables. If most variables are soon omitted, the tolerance is rough at first, because omitted
    /// variables must be checked again before further work.
    fn search_once(&mut self, c: f64, search: &mut Search, is_first: bool) {
        let mut all = Variables::<T>::new(&self.beta, self.limits, &self.f, c);
        let first_look = if is_first { SHRINK_PERIOD } else { 0 };
        let stop = T::run(self.gram, &mut all, search, first_look);
        self.beta.copy_from_slice(&all.beta);
        if let Stop::Shrink(indices) = &stop {
            let part = self.gram.part(indices);
            let tolerance = search.tolerance;
            if is_first {
                search.tolerance *= 10.0;
            }
            let beta = solve_part(part, all.select(indices), search);
            search.tolerance = tolerance;
            beta.into_iter()
                .for_each(|(at, value)| self.beta[indices[at]] = value);
        }
    }
}
