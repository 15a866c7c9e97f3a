//! Parameters of linear SVMs that are trained by coordinate descent.

use crate::class_weight::ClassWeight;
use crate::error::check_above_zero;
use crate::{Error, Result};

/// Default maximum number of passes over the rows, as in scikit-learn's LinearSVC.
pub const MAX_PASSES: usize = 1000;

/// Parameters of a linear SVM that is trained by coordinate descent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearSvmParams {
    /// Penalty C for each unit of margin violation, above 0.
    pub c: f64,
    /// Weights of the classes: the penalty of a row is C times the weight of its class. LIBLINEAR's one-vs-rest differs: rows of the other classes have the
    /// weight 1 there.
    pub class_weight: ClassWeight,
    /// Stopping tolerance, above 0: difference between the largest and smallest projected gradient, in units of the margin.
    pub tolerance: f64,
    /// Maximum number of passes over the rows, at least 1. At this limit, the solver stops and marks the problem as capped.
    pub max_passes: usize,
}

impl Default for LinearSvmParams {
    /// Returns the defaults: C = 1, tolerance 1e-3, [`MAX_PASSES`].
    fn default() -> Self {
        Self {
            c: 1.0,
            class_weight: ClassWeight::Uniform,
            tolerance: 1e-3,
            max_passes: MAX_PASSES,
        }
    }
}

impl LinearSvmParams {
    /// Returns an error if C, the tolerance or the maximum number of passes is out of range.
    pub(super) fn check(&self) -> Result<()> {
        check_above_zero("C", self.c)?;
        check_above_zero("tolerance", self.tolerance)?;
        if self.max_passes == 0 {
            return Err(Error::input("passes", 0, "at least 1 is allowed"));
        }
        Ok(())
    }
}
