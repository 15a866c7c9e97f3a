//! Loop of pairwise steps, which ends if the optimality conditions hold or if few variables can still move.

use super::passes::{Down, select_down, select_up, step_along};
use super::variables::Variables;
use crate::gram::matrix::Gram;
use crate::linalg::scalar::Scalar;

/// Number of iterations between two checks of whether variables can be omitted (shrinking).
pub(super) const SHRINK_PERIOD: u64 = 1000;
/// Minimum number of rows for shrinking (omitting variables that probably stay at their bounds). With fewer rows, copying the submatrix takes longer than it
/// saves.
const SHRINK_ROWS: usize = 400;
/// Maximum fraction of variables that shrinking may leave; otherwise, copying the submatrix costs more time than it saves.
const SHRINK_SHARE: f64 = 0.7;

/// Limits of a solver run, and its number of iterations so far.
pub(crate) struct Search {
    pub tolerance: f64,
    pub max_iterations: u64,
    pub n_iterations: u64,
}

impl Search {
    pub fn new(max_iterations: u64, tolerance: f64) -> Self {
        Self {
            tolerance,
            max_iterations,
            n_iterations: 0,
        }
    }
}

/// Reason why the pairwise steps of the solver stopped.
pub(crate) enum Stop {
    /// The solver reached the tolerance or the maximum number of iterations.
    Done,
    /// The solver should continue with the given variables only, because no other variable can move.
    Shrink(Vec<usize>),
}

/// Runs the pairwise steps of the solver without explicit vector instructions. Stops if the optimality conditions hold, the iteration cap is reached, or few
/// variables can still move.
pub(crate) fn run_plain<T: Scalar>(
    gram: &mut Gram<T>,
    variables: &mut Variables<T>,
    search: &mut Search,
    first_look: u64,
) -> Stop {
    let passes = (select_down::<T>, step_along::<T>);
    run_with((gram, passes), variables, search, first_look)
}

/// Runs the pairwise steps of the solver with two given functions for its passes. The function `select_down` finds the variable to decrease from f, marks,
/// inverse curvatures, the highest f and scratch memory. The function `step_along` makes a step, given f, two rows, the step length and marks; it returns the
/// next variable to increase.
#[inline(always)]
pub(super) fn run_with<T: Scalar>(
    (gram, (select_down, step_along)): (
        &mut Gram<T>,
        (
            impl Fn((&[T], &[T]), &[T], T, &mut [T]) -> Down<T>,
            impl Fn(&mut [T], (&[T], &[T]), T, &[T]) -> Option<usize>,
        ),
    ),
    variables: &mut Variables<T>,
    search: &mut Search,
    first_look: u64,
) -> Stop {
    let Some(mut i) = select_up(&variables.f, &variables.up) else {
        return Stop::Done;
    };
    // Slightly stricter than the requested tolerance, so that the check in f64 succeeds.
    let tolerance = T::from_f64(0.95 * search.tolerance);
    let mut until_look = first_look;
    loop {
        let highest = variables.f[i];
        let inverses = gram.inverse_curvatures(i);
        let state = (&variables.f[..], &variables.low[..]);
        let down = select_down(state, inverses, highest, &mut variables.gains);
        let Some(j) = down.j.filter(|_| down.violation > tolerance) else {
            return Stop::Done;
        };
        if until_look == 0 && gram.len() >= SHRINK_ROWS {
            let keep = variables.worth_keeping(highest, highest - down.violation);
            let few = SHRINK_SHARE * gram.len() as f64;
            if (keep.len() as f64) < few && gram.fits(keep.len()) {
                return Stop::Shrink(keep);
            }
            until_look = SHRINK_PERIOD;
        }
        if search.n_iterations >= search.max_iterations {
            return Stop::Done;
        }
        search.n_iterations += 1;
        until_look = until_look.saturating_sub(1);
        let step = variables.step(i, j, gram.curvature(i, j));
        match step_along(
            &mut variables.f,
            gram.rows(i, j),
            T::from_f64(step),
            &variables.up,
        ) {
            Some(next) => i = next,
            None => return Stop::Done,
        }
    }
}
