//! A linear model of many classes: one weight vector and one bias a class, all scores by one matrix product.

use ndarray::{Array1, Array2, ArrayView2};

use crate::Result;
use crate::dataset::check_width;

/// `score_k(x) = w_k·x + b_k`.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearModel {
    /// w, n_classes × m, in inverse feature units.
    pub weights: Array2<f64>,
    /// b, n_classes.
    pub bias: Array1<f64>,
}

impl LinearModel {
    /// Scores (n_rows × n_classes).
    ///
    /// # Errors
    /// Another number of columns than the weights have, or a NaN or infinite feature.
    pub fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.weights.ncols())?;
        Ok(features.dot(&self.weights.t()) + &self.bias)
    }
}
