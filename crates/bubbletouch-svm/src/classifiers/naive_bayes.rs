//! Gaussian naive Bayes classifier, fitted by linfa-bayes. The features of a class are assumed to be normal and independent.
//!
//! linfa's own prediction is not used: it resolves ties in the order of a `HashMap`, and it normalises probabilities without subtracting the maximum first.
//! With 64 features all its probabilities underflow to 0. linfa's joint log-likelihoods are correct and are used.

use crate::classifiers::classifier_about::ClassifierAbout;
use linfa::traits::Fit;
use linfa_bayes::{GaussianNb, NaiveBayes as _};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2};
use std::sync::Arc;

use crate::class_model::{ClassModel, log_priors};
use crate::dataset::{Dataset, check_width, checked_classes};
use crate::{Error, Result};

/// Fraction of the largest feature variance that naive Bayes adds to every variance; 1e-9 is scikit-learn's default.
pub const VARIANCE_SMOOTHING: f64 = 1e-9;

/// Trained Gaussian naive Bayes classifier. The score of class k for features x is `ln p(x | k)`.
#[derive(Clone, Debug)]
pub struct NaiveBayes {
    classes: Vec<usize>,
    model: GaussianNb<f64, usize>,
    log_prior: Array1<f64>,
    n_features: usize,
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
        let model = GaussianNb::params()
            .var_smoothing(VARIANCE_SMOOTHING)
            .fit(data)
            .map_err(|error| {
                Error::input("classifier", error, "see linfa-bayes's documentation")
            })?;
        Ok(Self {
            log_prior: log_priors(data.targets.view(), &classes),
            classes,
            model,
            n_features: data.records.ncols(),
        })
    }

    /// Returns the joint log-likelihood `ln p(x, k)` of each row x of features and each class k (n_rows × n_classes).
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    pub fn joint_log_likelihoods(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.n_features)?;
        let by_class = self.model.joint_log_likelihood(features);
        let mut values = Array2::zeros((features.nrows(), self.classes.len()));
        for (mut column, class) in values.columns_mut().into_iter().zip(&self.classes) {
            column.assign(&by_class[class]);
        }
        Ok(values)
    }
}

impl ClassModel for NaiveBayes {
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
