//! Linear model for several classes: one weight vector and one bias per class. One matrix product computes all scores.

use ndarray::{Array1, Array2, ArrayView2};
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::dataset::check_width;

/// Linear model, which computes the score `w_k·x + b_k` of each class k from the features x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinearModel {
    /// Weights of the features per class, shape n_classes × m, in inverse feature units.
    #[serde(with = "crate::saved")]
    pub weights: Array2<f64>,
    /// Constant part of the score of each class, shape (n_classes,), dimensionless.
    #[serde(with = "crate::saved")]
    pub bias: Array1<f64>,
}

impl LinearModel {
    /// Returns the score of each class for each row of features, shape n_rows × n_classes.
    ///
    /// # Errors
    /// If the number of columns differs from the weights, or a feature is NaN or infinite.
    pub fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.weights.ncols())?;
        Ok(features.dot(&self.weights.t()) + &self.bias)
    }
}
