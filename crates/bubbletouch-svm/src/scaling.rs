//! Scaling of features, fitted on training rows only.

use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::dataset::{check_features, check_width};

/// Scaling of features before training and prediction.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Scaling {
    /// No scaling.
    None,
    /// Standardises each feature to mean 0 and standard deviation 1.
    #[default]
    Standard,
    /// Scales all features to mean 0 and mean square 1 with one common factor; preserves angles and ratios of distances.
    Overall,
}

/// Scaling of features that is fitted to training rows: subtracts the offset of each feature, then divides by its scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FittedScaling {
    /// Offset that is subtracted from each feature (m values), in feature units.
    #[serde(with = "crate::saved")]
    pub offset: Array1<f64>,
    /// Divisor of each feature (m values), in feature units; 1 if the feature is constant.
    #[serde(with = "crate::saved")]
    pub scale: Array1<f64>,
}

impl Scaling {
    /// Fits the scaling to the training features (n_rows × m).
    ///
    /// Standard deviations are population values (divided by n), as in scikit-learn's `StandardScaler`. A feature counts as constant if its spread is within
    /// the rounding error of its mean.
    ///
    /// # Errors
    /// If the features are empty, or a feature is NaN or infinite.
    pub fn fit(self, features: ArrayView2<f64>) -> Result<FittedScaling> {
        check_features(features)?;
        let n_columns = features.ncols();
        let n_rows = features.nrows() as f64;
        if self == Self::None {
            return Ok(FittedScaling {
                offset: Array1::zeros(n_columns),
                scale: Array1::ones(n_columns),
            });
        }
        let offset = features.sum_axis(Axis(0)) / n_rows;
        let variance = variances(features, offset.view());
        let scale = if self == Self::Standard {
            variance.mapv(root_or_one)
        } else {
            Array1::from_elem(n_columns, root_or_one(variance.sum() / n_columns as f64))
        };
        Ok(FittedScaling { offset, scale })
    }
}

impl FittedScaling {
    /// Returns the scaled features (n_rows × m).
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    pub fn apply(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.offset.len())?;
        if self.changes_nothing() {
            return Ok(features.to_owned());
        }
        Ok((&features - &self.offset) / &self.scale)
    }

    /// Returns whether the scaling leaves all features unchanged.
    pub fn changes_nothing(&self) -> bool {
        self.offset.iter().all(|&offset| offset == 0.0)
            && self.scale.iter().all(|&scale| scale == 1.0)
    }
}

/// Returns the population variance of each feature; exactly 0 if the spread is within the rounding error of the mean.
fn variances(features: ArrayView2<f64>, mean: ArrayView1<f64>) -> Array1<f64> {
    let n_rows = features.nrows() as f64;
    let mut variance = Array1::<f64>::zeros(features.ncols());
    for row in features.rows() {
        ndarray::Zip::from(&mut variance)
            .and(row)
            .and(mean)
            .for_each(|sum, &value, &mean| *sum += (value - mean) * (value - mean) / n_rows);
    }
    ndarray::Zip::from(&mut variance)
        .and(mean)
        .for_each(|variance, &mean| {
            // The error of the computed mean is up to about n/2 roundings; scikit-learn uses a bound of equal form.
            let rounding = n_rows * f64::EPSILON * mean.abs();
            if *variance <= rounding * rounding {
                *variance = 0.0;
            }
        });
    variance
}

fn root_or_one(variance: f64) -> f64 {
    if variance > 0.0 { variance.sqrt() } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn standard_features_have_mean_zero_and_deviation_one() {
        let features = array![[1.0, -3.0], [2.0, 5.0], [6.0, 4.0]];
        let fitted = Scaling::Standard.fit(features.view()).unwrap();
        let scaled = fitted.apply(features.view()).unwrap();
        for column in scaled.columns() {
            assert!(column.sum().abs() < 1e-12);
            assert!((column.dot(&column) / 3.0 - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_constant_feature_becomes_zero_and_not_noise() {
        // 0.1 has no exact binary representation: the mean of 1,000 copies is not exactly 0.1.
        let features = Array2::from_elem((1000, 1), 0.1);
        for scaling in [Scaling::Standard, Scaling::Overall] {
            let fitted = scaling.fit(features.view()).unwrap();
            let scaled = fitted.apply(features.view()).unwrap();
            assert!(
                scaled.iter().all(|value| value.abs() < 1e-13),
                "{scaling:?}"
            );
        }
    }

    #[test]
    fn overall_scaling_keeps_ratios_of_distances() {
        let features = array![[1.0, 10.0], [2.0, 30.0], [5.0, -20.0]];
        let fitted = Scaling::Overall.fit(features.view()).unwrap();
        let scaled = fitted.apply(features.view()).unwrap();
        let distance = |x: &Array2<f64>, i: usize, j: usize| {
            let difference = &x.row(i) - &x.row(j);
            difference.dot(&difference).sqrt()
        };
        let ratio = |x: &Array2<f64>| distance(x, 0, 1) / distance(x, 1, 2);
        assert!((ratio(&features) - ratio(&scaled)).abs() < 1e-14);
        assert!((scaled.mapv(|x| x * x).mean().unwrap() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn no_scaling_changes_nothing() {
        let features = array![[1.0, -3.0], [2.0, 5.0]];
        let fitted = Scaling::None.fit(features.view()).unwrap();
        assert_eq!(fitted.apply(features.view()).unwrap(), features);
    }
}
