//! Linear model for several classes: one weight vector and one bias per class. One matrix product computes all scores.

use ndarray::{Array1, Array2, ArrayView2};

use crate::Result;
use crate::dataset::check_width;

/// Linear model with the scores `score_k(x) = w_k·x + b_k`.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearModel {
    /// Weights w, shape n_classes × m, in inverse feature units.
    pub weights: Array2<f64>,
    /// Biases b, shape (n_classes,), dimensionless.
    pub bias: Array1<f64>,
}

impl LinearModel {
    /// Returns the scores `w_k·x + b_k`, shape n_rows × n_classes.
    ///
    /// # Errors
    /// If the number of columns differs from the weights, or a feature is NaN or infinite.
    pub fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.weights.ncols())?;
        Ok(features.dot(&self.weights.t()) + &self.bias)
    }
}
