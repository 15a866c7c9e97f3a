//! Gaussian naive Bayes classifier. The features of a class are assumed to be normal and independent.
//!
//! The joint log-likelihoods are those of linfa-bayes, to the last bit. linfa's own prediction is not used: it resolves ties in the order of a `HashMap`, and it
//! normalises probabilities without subtracting the maximum first. With 64 features all its probabilities underflow to 0.

use crate::classifiers::classifier_about::ClassifierAbout;
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::sync::Arc;

use crate::class_model::{ClassModel, log_priors};
use crate::dataset::{Dataset, check_width, checked_classes};
use crate::saved::SavedModel;
use crate::{Error, Result};

/// Fraction of the largest feature variance that naive Bayes adds to every variance; 1e-9 is scikit-learn's default.
pub const VARIANCE_SMOOTHING: f64 = 1e-9;

/// Trained Gaussian naive Bayes classifier. The score of class k for features x is `ln p(x | k)`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NaiveBayes {
    classes: Vec<usize>,
    /// Mean of each feature in each class, n_classes × m.
    #[serde(with = "crate::saved")]
    mean: Array2<f64>,
    /// Variance of each feature in each class, with the smoothing, n_classes × m.
    #[serde(with = "crate::saved")]
    variance: Array2<f64>,
    #[serde(with = "crate::saved")]
    log_prior: Array1<f64>,
}

impl NaiveBayes {
    /// Estimates the mean and variance of every feature in each class from labelled rows.
    ///
    /// # Errors
    /// If the data are empty, or a feature is NaN or infinite. If the number of labels differs from the number of rows, or there is a single class. If all
    /// features are constant (no variance for smoothing).
    pub fn train(data: &Dataset) -> Result<Self> {
        let classes = checked_classes(data)?;
        let is_constant = |column: ArrayView1<f64>| column.iter().all(|x| *x == column[0]);
        if data.records.columns().into_iter().all(is_constant) {
            return Err(Error::input(
                "features",
                "every one is constant",
                "naive Bayes needs one that varies",
            ));
        }
        let of_all = data.records.var_axis(Axis(0), 0.0);
        let smoothing = VARIANCE_SMOOTHING * of_all.fold(0.0, |a: f64, b| a.max(*b));
        let shape = (classes.len(), data.records.ncols());
        let (mut mean, mut variance) = (Array2::zeros(shape), Array2::zeros(shape));
        let rows = mean.outer_iter_mut().zip(variance.outer_iter_mut());
        for (class, (mut mean, mut variance)) in classes.iter().zip(rows) {
            let labels = data.targets.iter().enumerate();
            let own = labels.filter_map(|(row, label)| (label == class).then_some(row));
            let own = data.records.select(Axis(0), &own.collect::<Vec<_>>());
            mean.assign(&own.mean_axis(Axis(0)).expect("a class has rows"));
            variance.assign(&(own.var_axis(Axis(0), 0.0) + smoothing));
        }
        Ok(Self {
            log_prior: log_priors(data.targets.view(), &classes),
            classes,
            mean,
            variance,
        })
    }

    /// Returns the joint log-likelihood `ln p(x, k)` of each row x of features and each class k (n_rows × n_classes).
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    pub fn joint_log_likelihoods(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.mean.ncols())?;
        let mut values = Array2::zeros((features.nrows(), self.classes.len()));
        for (class, mut column) in values.columns_mut().into_iter().enumerate() {
            let (mean, variance) = (self.mean.row(class), self.variance.row(class));
            let constant = -0.5 * variance.mapv(|v| (2.0 * PI * v).ln()).sum();
            let squares = (&features - &mean).mapv(|x| x.powi(2)) / variance;
            let squares = squares.sum_axis(Axis(1));
            column.assign(&squares.mapv(|sum| constant - 0.5 * sum + self.log_prior[class]));
        }
        Ok(values)
    }
}

impl ClassModel for NaiveBayes {
    fn saved(&self) -> Option<SavedModel> {
        Some(SavedModel::NaiveBayes(self.clone()))
    }

    fn classes(&self) -> &[usize] {
        &self.classes
    }

    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        Ok(self.joint_log_likelihoods(features)? - &self.log_prior)
    }

    fn log_prior(&self) -> Option<ArrayView1<'_, f64>> {
        Some(self.log_prior.view())
    }
}

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout::new("naive Bayes", |_, scaled, _, _| {
    Ok(Arc::new(NaiveBayes::train(scaled)?))
});
