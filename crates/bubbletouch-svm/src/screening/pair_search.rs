//! The solver of a pair near its margin: pairs of variables, then equations of those that are free.

use crate::gram::matrix::Gram;
use crate::smo::Smo;
use crate::smo::SolverScalar;
use crate::smo::reached::Reached;
use crate::smo::{ActiveSetGoal, solve_by_active_set};

/// The violation of the optimality conditions from which on the way goes by equations.
const EQUATIONS_FROM: f64 = 0.03;

/// What to solve a pair for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairGoal {
    /// C.
    pub c: f64,
    /// The largest violation of the optimality conditions, in units of the decision value.
    pub tolerance: f64,
    /// Iterations after which a solve is left as it is; `None`: after those that count as unsolvable.
    pub most_iterations: Option<u64>,
}

/// β and f.
pub(crate) type State = (Vec<f64>, Vec<f64>);

/// Goes from a state, with the labels of its rows and the C that it belongs to, to what is asked for: roughly by pairs of
/// variables, then by equations, and by pairs where those left something.
pub(crate) fn reach_by_equations<T: SolverScalar, G: Gram<T>>(
    gram: &mut G,
    (labels, state, c): (&[f64], State, f64),
    goal: PairGoal,
) -> (State, Reached) {
    if goal.tolerance >= EQUATIONS_FROM {
        return reach(gram, (labels, state, c), goal);
    }
    let rough = PairGoal {
        tolerance: EQUATIONS_FROM,
        ..goal
    };
    let ((mut beta, mut f), first) = reach(gram, (labels, state, c), rough);
    let by_equations = ActiveSetGoal {
        c: goal.c,
        tolerance: goal.tolerance,
        most_ways: labels.len() as u64,
    };
    let n_ways = solve_by_active_set(gram, labels, (&mut beta, &mut f), by_equations);
    let (state, last) = reach(gram, (labels, (beta, f), goal.c), goal);
    let n_iterations = first.n_iterations + n_ways + last.n_iterations;
    let reached = Reached {
        n_iterations,
        ..last
    };
    (state, reached)
}

fn reach<T: SolverScalar, G: Gram<T>>(
    gram: &mut G,
    (labels, state, c): (&[f64], State, f64),
    goal: PairGoal,
) -> (State, Reached) {
    let mut smo = Smo::from_start(gram, labels, state, c);
    if let Some(most_iterations) = goal.most_iterations {
        smo = smo.with_max_iterations(most_iterations);
    }
    let reached = smo.reach(goal.c, goal.tolerance, |_| None);
    (smo.into_variables(), reached)
}
