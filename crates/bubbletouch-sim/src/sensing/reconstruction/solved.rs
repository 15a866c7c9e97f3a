//! Coefficients computed by a solver.

use ndarray::Array2;

/// Coefficients of frames, and whether a solver stopped at a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Solved {
    /// Coefficients, shape (n_frames, k).
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
