//! Multinomial logistic regression: `p(k | x) = exp(w_k·x + b_k) / Σ_j exp(w_j·x + b_j)`.
//!
//! The training minimises `C Σ_i −v_i ln p(y_i | x_i) + ½ Σ_k |w_k|²` by Newton's method, where v_i is the weight of the class of row i (1
//! without [class weights](crate::class_weight)). The bias is not regularised, as in scikit-learn. For two classes, only the difference `w_1 − w_0` is
//! regularised (half as much as two vectors), as in scikit-learn.
//!
//! The crate linfa-logistic 0.8.1 is not used, because its log-sum-exp subtracts the maximum of the whole matrix instead of the maximum of each row. If the
//! scores of rows differ by more than 34, linfa's probabilities and gradients are wrong, and linfa stops early without an error. With 600 rows, 5 classes and C
//! = 1,000, for example, linfa's objective is 46.6, while C = 1 reaches 9.8.

use crate::classifiers::classifier_about::ClassifierAbout;
use ndarray::{Array1, Array2, ArrayView1, ArrayView2};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

use crate::Result;
use crate::class_model::{ClassModel, log_priors, normalise};
use crate::class_weight::ClassWeight;
use crate::classifiers::logistic_loss::LogisticLoss;
use crate::dataset::{Dataset, checked_classes, positions, squared_norms};
use crate::error::check_above_zero;
use crate::linear_model::LinearModel;
use crate::saved::SavedModel;

/// Default maximum number of Newton steps. Training usually takes 5 to 30 steps, also with C = 1e9.
pub const MAX_ITERATIONS: usize = 200;

/// Parameters of a logistic regression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogisticParams {
    /// Weight C > 0 of the data relative to the regularisation.
    pub c: f64,
    /// Stopping tolerance, above 0: predicted decrease of the objective in the last step, relative to the objective. The difference between the objective and
    /// its minimum is usually smaller than this fraction of the minimum.
    pub tolerance: f64,
    /// Maximum number of Newton steps, at least 1. If it is reached, the solver stops and the model is marked as capped.
    pub max_iterations: usize,
    /// Weights of the classes in the loss.
    pub class_weight: ClassWeight,
}

impl Default for LogisticParams {
    /// Returns the defaults: C = 1, tolerance 5e-5, [`MAX_ITERATIONS`] and uniform class weights.
    fn default() -> Self {
        Self {
            c: 1.0,
            tolerance: 5e-5,
            max_iterations: MAX_ITERATIONS,
            class_weight: ClassWeight::Uniform,
        }
    }
}

/// Trained logistic regression. The score of class k for features x is `ln p(k | x) − ln p(k)`, where p(k) is the fraction that class k has
/// of the weights of the training rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Logistic {
    classes: Vec<usize>,
    model: LinearModel,
    #[serde(with = "crate::saved")]
    log_prior: Array1<f64>,
    n_iterations: usize,
    is_capped: bool,
}

impl LogisticParams {
    /// Trains the logistic regression on labelled rows. The result is deterministic.
    ///
    /// # Errors
    /// If C or the tolerance is out of range, the data are empty, or a feature is NaN, infinite or too large to square. If the number of labels differs from
    /// the number of rows, or there is a single class.
    pub fn train(&self, data: &Dataset) -> Result<Logistic> {
        check_above_zero("C", self.c)?;
        check_above_zero("tolerance", self.tolerance)?;
        let classes = checked_classes(data)?;
        squared_norms(data.records.view())?;
        let label = positions(data.targets.view(), &classes);
        let two = if classes.len() == 2 { 2.0 } else { 1.0 };
        let penalty = two / (self.c * label.len() as f64);
        let of_classes = self.class_weight.of_classes(&label, classes.len());
        let row_weights = label.iter().map(|&class| of_classes[class]).collect();
        let rows = (data.records.view(), &label[..], row_weights);
        let loss = LogisticLoss::new(rows, classes.len(), penalty);
        let found = loss.minimise(self.tolerance, self.max_iterations);
        Ok(Logistic {
            model: found.model,
            log_prior: log_priors(data.targets.view(), &classes) + of_classes.ln(),
            classes,
            n_iterations: found.n_iterations,
            is_capped: found.is_capped,
        })
    }
}

impl Logistic {
    /// Returns the weights and biases of the trained model.
    pub fn model(&self) -> &LinearModel {
        &self.model
    }

    /// Returns the number of iterations that training took.
    pub fn n_iterations(&self) -> usize {
        self.n_iterations
    }

    /// Returns `ln p(k | x)`, the log-probability of each class k for each row x of features, shape (n_rows, n_classes).
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    pub fn log_probabilities(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        let mut values = self.model.scores(features)?;
        normalise(&mut values);
        Ok(values)
    }
}

impl ClassModel for Logistic {
    fn saved(&self) -> Option<SavedModel> {
        Some(SavedModel::LogisticRegression(self.clone()))
    }

    fn classes(&self) -> &[usize] {
        &self.classes
    }

    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        Ok(self.log_probabilities(features)? - &self.log_prior)
    }

    fn log_prior(&self) -> Option<ArrayView1<'_, f64>> {
        Some(self.log_prior.view())
    }

    fn n_capped(&self) -> usize {
        usize::from(self.is_capped)
    }
}

pub(crate) const ABOUT: ClassifierAbout = ClassifierAbout {
    has_c: true,
    has_class_weights: true,
    ..ClassifierAbout::new("logistic regression", |classifier, scaled, c, _| {
        let params = LogisticParams {
            c,
            tolerance: classifier.tolerance,
            class_weight: classifier.class_weight,
            ..LogisticParams::default()
        };
        Ok(Arc::new(params.train(scaled)?))
    })
};
