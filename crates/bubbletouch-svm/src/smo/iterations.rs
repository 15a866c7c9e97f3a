//! The iterations: pairs of variables moved until the optimality conditions hold, or few variables are left to move.

use super::gram::{Dense, Gram};
use super::passes::{Down, select_down, select_up, step_along};
use super::variables::Variables;
use crate::linalg::scalar::Scalar;

/// Iterations before a look at which variables to leave out.
pub(super) const SHRINK_PERIOD: u64 = 1000;
/// Rows below which leaving variables out gains less than copying costs.
const SHRINK_ROWS: usize = 400;
/// The share of the variables that may remain for the copy to be worth it.
const SHRINK_SHARE: f64 = 0.7;

/// Solves on a part of the Gram matrix, and on parts of that. β of the part's variables, by their index in it.
pub(super) fn solve_part<T: Scalar>(
    mut part: Dense<T>,
    mut variables: Variables<T>,
    search: &mut Search,
) -> Vec<(usize, f64)> {
    let mut indices: Vec<usize> = (0..variables.beta.len()).collect();
    let mut solved = Vec::new();
    loop {
        let stop = run(&mut part, &mut variables, search, SHRINK_PERIOD);
        let beta = indices.iter().zip(&variables.beta);
        solved.extend(beta.map(|(&index, &beta)| (index, beta)));
        match stop {
            Stop::Shrink(keep) => {
                part = part.part(&keep);
                variables = variables.select(&keep);
                indices = keep.iter().map(|&at| indices[at]).collect();
            }
            Stop::Done => return solved,
        }
    }
}

/// How far the search may go, and has gone.
pub(crate) struct Search {
    pub tolerance: f64,
    pub most_iterations: u64,
    pub n_iterations: u64,
}

impl Search {
    pub fn new(most_iterations: u64, tolerance: f64) -> Self {
        Self {
            tolerance,
            most_iterations,
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

/// Moves pairs of variables until the optimality conditions hold, iterations run out, or few variables are left to move.
pub(super) fn run<T: Scalar, G: Gram<T>>(
    gram: &mut G,
    variables: &mut Variables<T>,
    search: &mut Search,
    first_look: u64,
) -> Stop {
    T::run(gram, variables, search, first_look)
}

/// The same with the two passes of any processor.
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
        if search.n_iterations >= search.most_iterations {
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

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    #[test]
    fn the_passes_of_the_processor_go_the_same_way_to_the_bit() {
        let n = 150;
        let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        let at = |i: usize| (i as f64 * 1.7).sin() + 0.2 * sign(i);
        let y: Vec<f64> = (0..n).map(sign).collect();
        let mut gram = Dense::default();
        for (gamma, c) in [(0.1, 1.0), (3.0, 10.0), (300.0, 0.1)] {
            let kernel = |(i, j): (usize, usize)| (-gamma * (at(i) - at(j)).powi(2)).exp() as f32;
            gram.of_whole(Array2::from_shape_fn((n, n), kernel).view());
            let start = Variables::<f32>::new(&vec![0.0; n], &y, &y, c);
            let (mut found, mut expected) = (start.clone(), start);
            let (mut search, mut plain) = (Search::new(100_000, 1e-4), Search::new(100_000, 1e-4));
            run(&mut gram, &mut found, &mut search, 1);
            run_plain(&mut gram, &mut expected, &mut plain, 1);
            assert!(search.n_iterations > 10);
            assert_eq!(search.n_iterations, plain.n_iterations);
            assert_eq!(found.beta, expected.beta);
            assert_eq!(found.f, expected.f);
        }
    }
}
