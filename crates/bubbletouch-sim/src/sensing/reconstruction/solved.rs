//! Coefficients that a solver found.

use ndarray::Array2;

/// Coefficients of frames, and whether a solver stopped at a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Solved {
    /// n_frames × k.
    pub coefficients: Array2<f64>,
    /// Of each frame: whether it stopped at its cap of atoms or steps before it was done.
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
