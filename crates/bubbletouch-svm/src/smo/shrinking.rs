//! Shrinking: variables that stay at a bound are omitted, and the iterations use a submatrix of the Gram matrix.

use super::iterations::{SHRINK_PERIOD, Search, Stop};
use super::solver_scalar::SolverScalar;
use super::variables::Variables;
use crate::gram::matrix::Gram;

/// Solves the problem on a submatrix of the Gram matrix; the submatrix may be reduced further. Returns pairs (index of a variable, its coefficient β).
pub(super) fn solve_part<T: SolverScalar>(
    mut part: Gram<T>,
    mut variables: Variables<T>,
    search: &mut Search,
) -> Vec<(usize, f64)> {
    let mut indices: Vec<usize> = (0..variables.beta.len()).collect();
    let mut solved = Vec::new();
    loop {
        let stop = T::run(&mut part, &mut variables, search, SHRINK_PERIOD);
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
