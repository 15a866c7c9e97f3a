//! Solver of the binary problem of two classes on rows near the decision boundary: pairwise steps, followed by active-set steps.

use crate::gram::matrix::Gram;
use crate::smo::Smo;
use crate::smo::SolverScalar;
use crate::smo::reached::Reached;
use crate::smo::{ActiveSetGoal, solve_by_active_set};

/// Violation of the optimality conditions below which the solver changes from pairwise steps to active-set steps.
const EQUATIONS_FROM: f64 = 0.03;

/// Stopping criteria of the solver for the binary problem of one pair of classes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairGoal {
    /// Penalty C of the soft-margin problem.
    pub c: f64,
    /// Maximum violation of the optimality conditions, in units of the decision value.
    pub tolerance: f64,
    /// Maximum number of solver iterations; `None` for the solver's default limit.
    pub most_iterations: Option<u64>,
}

/// State of the solver: the coefficients β, and the gradient f of the dual objective.
pub(crate) type State = (Vec<f64>, Vec<f64>);

/// Labels of the rows of a binary problem, and the limits of their coefficients.
type LabelsAndLimits<'a> = (&'a [f64], &'a [f64]);

/// Solves a binary problem from a given start: pairwise steps to a rough tolerance, followed by active-set steps. If the active-set steps do not reach the
/// tolerance, pairwise steps continue. The problem is given with its labels, the limits of its coefficients, and the C of the
/// state.
pub(crate) fn reach_by_equations<T: SolverScalar>(
    gram: &mut Gram<T>,
    (rows, state, c): (LabelsAndLimits, State, f64),
    goal: PairGoal,
) -> (State, Reached) {
    if goal.tolerance >= EQUATIONS_FROM {
        return reach(gram, (rows, state, c), goal);
    }
    let rough = PairGoal {
        tolerance: EQUATIONS_FROM,
        ..goal
    };
    let ((mut beta, mut f), first) = reach(gram, (rows, state, c), rough);
    let by_equations = ActiveSetGoal {
        c: goal.c,
        tolerance: goal.tolerance,
        max_steps: rows.0.len() as u64,
    };
    let n_steps = solve_by_active_set(gram, rows.1, (&mut beta, &mut f), by_equations);
    let (state, last) = reach(gram, (rows, (beta, f), goal.c), goal);
    let n_iterations = first.n_iterations + n_steps + last.n_iterations;
    let reached = Reached {
        n_iterations,
        ..last
    };
    (state, reached)
}

fn reach<T: SolverScalar>(
    gram: &mut Gram<T>,
    ((labels, limits), state, c): (LabelsAndLimits, State, f64),
    goal: PairGoal,
) -> (State, Reached) {
    let mut smo = Smo::from_start(gram, labels, state, c).with_limits(limits);
    if let Some(most_iterations) = goal.most_iterations {
        smo = smo.with_max_iterations(most_iterations);
    }
    let reached = smo.reach(goal.c, goal.tolerance, |_| None);
    (smo.into_variables(), reached)
}
