//! Parameters of linear SVMs.

use crate::{Error, Result};

/// Passes over the rows after which a solver gives up: scikit-learn's default for LinearSVC.
pub const MAX_PASSES: usize = 1000;

/// Parameters of a linear SVM.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearSvmParams {
    /// C > 0: what a unit of margin violation costs.
    pub c: f64,
    /// The largest violation of the optimality conditions (spread of projected gradients) when the solver stops, in
    /// units of the margin; above 0. scikit-learn's default for LinearSVC is 1e-4.
    pub tolerance: f64,
    /// Passes over the rows after which the solver gives up and says so; at least 1.
    pub max_passes: usize,
}

impl Default for LinearSvmParams {
    /// C = 1, tolerance 1e-3, [`MAX_PASSES`].
    fn default() -> Self {
        Self {
            c: 1.0,
            tolerance: 1e-3,
            max_passes: MAX_PASSES,
        }
    }
}

impl LinearSvmParams {
    /// Returns an error if a parameter is out of range.
    pub(super) fn check(&self) -> Result<()> {
        for (name, value) in [("C", self.c), ("tolerance", self.tolerance)] {
            if !(value > 0.0 && value.is_finite()) {
                let allowed = "a finite number above 0 is allowed";
                return Err(Error::input(name, value, allowed));
            }
        }
        if self.max_passes == 0 {
            return Err(Error::input("passes", 0, "at least 1 is allowed"));
        }
        Ok(())
    }
}
