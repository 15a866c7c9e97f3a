//! Coefficients computed by a solver.

use ndarray::Array2;

/// Dictionary coefficients of frames, and whether the solver stopped at a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Solved {
    /// Dictionary coefficients, shape (n_frames, number of atoms).
    pub coefficients: Array2<f64>,
    /// Whether the solver stopped at its limit of atoms or steps before convergence, for each frame.
    pub capped: Vec<bool>,
}

impl Solved {
    pub(super) fn zeros(n_frames: usize, n_atoms: usize) -> Self {
        Self {
            coefficients: Array2::zeros((n_frames, n_atoms)),
            capped: vec![false; n_frames],
        }
    }
}
