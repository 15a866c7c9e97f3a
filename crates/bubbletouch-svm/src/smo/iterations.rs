//! The iterations: pairs of variables moved until the optimality conditions hold, or few variables are left to move.

use super::passes::{Down, select_down, select_up, step_along};
use super::variables::Variables;
use crate::gram::matrix::Gram;
use crate::linalg::scalar::Scalar;

/// Iterations before a look at which variables to leave out.
pub(super) const SHRINK_PERIOD: u64 = 1000;
/// Rows below which leaving variables out gains less than copying costs.
const SHRINK_ROWS: usize = 400;
/// The share of the variables that may remain for the copy to be worth it.
const SHRINK_SHARE: f64 = 0.7;

/// How far the search may go, and has gone.
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

/// Why the iteration stopped.
pub(crate) enum Stop {
    /// Within the tolerance, or at the cap.
    Done,
    /// Only these variables may still move.
    Shrink(Vec<usize>),
}

/// Moves pairs of variables until the optimality conditions hold, iterations run out, or few variables are left to move; with the two passes of
/// any processor.
pub(crate) fn run_plain<T: Scalar, G: Gram<T>>(
    gram: &mut G,
    variables: &mut Variables<T>,
    search: &mut Search,
    first_look: u64,
) -> Stop {
    let passes = (select_down::<T>, step_along::<T>);
    run_with((gram, passes), variables, search, first_look)
}

/// The same with these passes: what finds the variable to lower, given f, marks, inverse curvatures, the highest f and scratch;
/// and what takes a step, given f, two rows, its length and marks, and finds the next variable to raise.
#[inline(always)]
pub(super) fn run_with<T: Scalar, G: Gram<T>>(
    (gram, (select_down, step_along)): (
        &mut G,
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
    // A little more than asked, so that f64 agrees.
    let tolerance = T::of(0.95 * search.tolerance);
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
        let (row_i, diagonal) = gram.row_and_diagonal(i);
        let curvature = (diagonal[i] + diagonal[j]).wide() - 2.0 * row_i[j].wide();
        let step = variables.step(i, j, curvature.max(gram.smallest_curvature().wide()));
        match step_along(
            &mut variables.f,
            gram.rows(i, j),
            T::of(step),
            &variables.up,
        ) {
            Some(next) => i = next,
            None => return Stop::Done,
        }
    }
}
