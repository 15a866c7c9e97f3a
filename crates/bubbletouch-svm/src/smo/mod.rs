//! One binary soft-margin problem, solved by sequential minimal optimisation.
//!
//! In terms of `β_i = y_i a_i` the dual problem is: maximise `Σ_i y_i β_i − ½ Σ_ij β_i β_j K_ij` over
//! `0 ≤ y_i β_i ≤ C`, `Σ_i β_i = 0`. With `f = y − Kβ`, its gradient, a β is optimal when no variable that can be raised has
//! a larger f than one that can be lowered. Each iteration takes such a pair, chosen by second-order information
//! [Fan, Chen, Lin 2005], to the optimum along its line: two passes over f ([`passes`]).
//!
//! - **Shrinking** [Joachims 1999]: variables that sit at a bound and want to stay there are left out, and what remains of
//!   the Gram matrix is copied together, so that iterations run over short contiguous rows.
//! - **Warm start along C**: the last solution, stretched by the factor that is best for the objective.
//! - **Legs**: where pairs of variables need many iterations, the way goes on
//!   [by equations](crate::active_set) every now and then.
//! - **Precision**: Gram matrix and f may be f32; whenever the solver believes to be done, an f in f64 follows what β has
//!   changed and has the last word.

mod cached;
mod curvatures;
mod gram;
pub(crate) mod iterations;
mod part;
pub(crate) mod passes;
#[cfg(target_arch = "x86_64")]
pub(crate) mod passes_512;
mod reached;
mod row_sums;
mod start;
pub(crate) mod variables;

pub(crate) use cached::Cached;
pub(crate) use gram::{Dense, Gram, gather};
pub(crate) use part::{Part, Room, part_of_blocks};
pub(crate) use reached::{Reached, violation};
pub(crate) use variables::{bounds, extremes};

use crate::active_set::{ActiveSetGoal, settle};
use crate::dual::DualSolution;
use crate::linalg::scalar::Scalar;
use iterations::{SHRINK_PERIOD, Search, Stop, run, solve_part};
use variables::{Variables, linear_and_quadratic, rho};

/// Iterations after which a problem counts as not solved, as in LIBSVM; or 100 a row, if that is more.
const MOST_ITERATIONS: u64 = 10_000_000;
/// Iterations after which the way goes on by equations, at least, and for each row.
const FEWEST_OF_LEG: u64 = 10_000;
const ROWS_OF_LEG: u64 = 20;
/// Times that f64 may disagree with a solver that believes to be done.
const MOST_REFRESHES: usize = 30;
/// A binary problem on a Gram matrix, and the solution of the C that it was last solved for.
pub(crate) struct Smo<'a, G> {
    gram: &'a mut G,
    /// The labels: 1, −1, or 0 for a row that takes no part.
    y: &'a [f64],
    beta: Vec<f64>,
    /// y − Kβ.
    f: Vec<f64>,
    /// The C that β belongs to; 0 before the first.
    c: f64,
    /// Whether f is summed from β, or only about what it is.
    is_summed: bool,
    /// Iterations after which it counts as not solved.
    most_iterations: u64,
}

impl<'a, G> Smo<'a, G> {
    /// A problem that is not solved yet.
    pub fn new(gram: &'a mut G, y: &'a [f64]) -> Self {
        Self {
            is_summed: true,
            ..Self::going_on(gram, y, (vec![0.0; y.len()], y.to_vec()), 0.0)
        }
    }

    /// The same problem, to be left unsolved after so many iterations.
    pub fn of_at_most(self, most_iterations: u64) -> Self {
        Self {
            most_iterations,
            ..self
        }
    }

    /// A problem that goes on from β and about what its f is; they belong to c, which is 0 where there is none yet.
    pub fn going_on(
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
            most_iterations: MOST_ITERATIONS.max(100 * y.len() as u64),
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
    fn refresh<T: Scalar>(&mut self)
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
    fn follow<T: Scalar>(&mut self, before: Vec<f64>)
    where
        G: Gram<T>,
    {
        let mut change = before;
        for (change, beta) in change.iter_mut().zip(&self.beta) {
            *change = beta - *change;
        }
        self.gram.take_times(&change, &mut self.f);
    }

    /// Solves for this C, starting from the solution of the last one, to a violation of the optimality conditions of at most
    /// `tolerance`.
    pub fn solve<T: Scalar>(&mut self, c: f64, tolerance: f64) -> DualSolution
    where
        G: Gram<T>,
    {
        self.solve_or_from(c, tolerance, |_| None)
    }

    /// [`solve`](Self::solve), or from another start that C allows, β and its f, if the objective is higher there.
    pub fn solve_or_from<T: Scalar>(
        &mut self,
        c: f64,
        tolerance: f64,
        other: impl FnOnce(&mut G) -> Option<(Vec<f64>, Vec<f64>)>,
    ) -> DualSolution
    where
        G: Gram<T>,
    {
        let reached = self.reach(c, tolerance, other);
        let variables = (&self.beta[..], self.y, &self.f[..]);
        DualSolution {
            coefficients: self.beta.clone(),
            ..reached.solution(variables, c)
        }
    }

    /// [`solve_or_from`](Self::solve_or_from), without what a solution says.
    pub fn reach<T: Scalar>(
        &mut self,
        c: f64,
        tolerance: f64,
        other: impl FnOnce(&mut G) -> Option<(Vec<f64>, Vec<f64>)>,
    ) -> Reached
    where
        G: Gram<T>,
    {
        let mut search = Search::new(self.most_iterations, tolerance);
        if !self.is_summed && self.violation(c) <= tolerance {
            self.refresh();
        }
        // Where no multiplier was kept down by its bound, a larger C changes nothing: β stays as it is.
        let stays = self.c <= c && self.violation(c) <= tolerance;
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

    /// `Σ y β − ½ β K β`.
    fn objective(&self) -> f64 {
        let (linear, quadratic) = linear_and_quadratic(&self.beta, self.y, &self.f);
        linear - 0.5 * quadratic
    }

    fn violation(&self, c: f64) -> f64 {
        violation(&self.beta, self.y, &self.f, c)
    }

    /// Whether it ended within the tolerance.
    fn search<T: Scalar>(&mut self, c: f64, search: &mut Search) -> bool
    where
        G: Gram<T>,
    {
        let most_iterations = search.most_iterations;
        let leg = FEWEST_OF_LEG.max(ROWS_OF_LEG * self.y.len() as u64);
        let (mut n_refreshes, mut is_first) = (0, true);
        while n_refreshes < MOST_REFRESHES {
            let before = self.beta.clone();
            search.most_iterations = most_iterations.min(search.n_iterations + leg);
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
            if search.n_iterations >= most_iterations {
                return false;
            }
            if search.n_iterations >= search.most_iterations {
                // Pairs of variables go to and fro; equations take a shorter way.
                let goal = ActiveSetGoal {
                    c,
                    tolerance: search.tolerance,
                    most_ways: self.y.len() as u64,
                };
                let variables = (&mut self.beta[..], &mut self.f[..]);
                search.n_iterations += settle(self.gram, self.y, variables, goal);
            } else {
                n_refreshes += 1;
            }
        }
        false
    }

    /// Searches among all variables, roughly where most are soon left out: what was left out should be looked at again before
    /// much work goes on.
    fn search_once<T: Scalar>(&mut self, c: f64, search: &mut Search, is_first: bool)
    where
        G: Gram<T>,
    {
        let mut all = Variables::<T>::new(&self.beta, self.y, &self.f, c);
        let first_look = if is_first { SHRINK_PERIOD } else { 0 };
        let stop = run(self.gram, &mut all, search, first_look);
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
