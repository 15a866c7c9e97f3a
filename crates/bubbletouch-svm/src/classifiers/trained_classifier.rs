//! Trained classifiers, each consisting of a feature scaling and a model, with a common interface for prediction.

use std::sync::Arc;

use linfa::traits::PredictInplace;
use ndarray::{Array1, Array2, ArrayBase, ArrayView2, Data, Ix2};
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::class_model::{ClassModel, normalise};
use crate::cross_validation::choice::Chosen;
use crate::precision::Precision;
use crate::predict::svm_model::SvmModel;
use crate::saved::{deserialize_model, serialize_model};
use crate::scaling::FittedScaling;

/// Trained classifier: a fitted scaling and a model. The data of serde (see [`saved`](crate::saved)) do not contain how C was chosen.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TrainedClassifier {
    scaling: FittedScaling,
    /// Model that was trained on scaled features.
    #[serde(
        serialize_with = "serialize_model",
        deserialize_with = "deserialize_model"
    )]
    model: Arc<dyn ClassModel>,
    c: Option<f64>,
    #[serde(skip)]
    chosen: Option<Chosen>,
}

impl TrainedClassifier {
    pub(crate) fn new(
        scaling: FittedScaling,
        model: Arc<dyn ClassModel>,
        c: Option<f64>,
        chosen: Option<Chosen>,
    ) -> Self {
        Self {
            scaling,
            model,
            c,
            chosen,
        }
    }

    /// Returns the predicted label of each row of unscaled features (n_rows × m).
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    pub fn labels(&self, features: ArrayView2<f64>) -> Result<Array1<usize>> {
        let scaled = self.scaling.apply(features)?;
        self.model.labels(scaled.view())
    }

    /// Returns the scores (n_rows × n_scores) of unscaled features. Scores are additive: the sum of the scores of several touches of one object is their joint
    /// score.
    ///
    /// | classifier | score |
    /// |---|---|
    /// | SVM | decision value of each binary problem, or of each class |
    /// | logistic regression | `ln p(k given x) − ln p(k)`; `labels_of_scores` adds the prior once |
    /// | own classifier | `ln p(k given x)`, or the smoothed fraction of the votes if it predicts labels alone |
    /// | naive Bayes | `ln p(x given k)`; `labels_of_scores` adds the prior once |
    /// | linfa-svm | `ln p` of the probability that the SVM of class k gives |
    /// | k nearest neighbours, tree, forest | `ln((v_k + 1) / (Σ v + n_classes))`, where v are the votes or the rows of the leaf; finite without votes |
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    pub fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        let scaled = self.scaling.apply(features)?;
        self.model.scores(scaled.view())
    }

    /// Returns the predicted label of each row of scores, by votes or by scores with log-priors, depending on the kind of classifier.
    pub fn labels_of_scores(&self, scores: ArrayView2<f64>) -> Array1<usize> {
        self.model.labels_of_scores(scores)
    }

    /// Returns the labels of the training rows, ascending.
    pub fn classes(&self) -> &[usize] {
        self.model.classes()
    }

    /// Converts scores, or sums of scores, to one value per class (n_rows × n_classes), in ascending order of the labels. Larger values favour the class.
    ///
    /// | classifier | value |
    /// |---|---|
    /// | one-vs-one SVM | votes + s / (3 (\|s\| + 1)), where s is the sum of the class's decision values (scikit-learn's `decision_function_shape="ovr"`) |
    /// | one-vs-rest SVM, nearest centroid, votes of a foreign classifier | score of the class |
    /// | others | natural logarithm of the probability of the class |
    pub fn class_scores(&self, scores: ArrayView2<f64>) -> Array2<f64> {
        let mut values = self.model.class_scores(scores);
        if self.is_probabilistic() {
            normalise(&mut values);
        }
        values
    }

    /// Returns whether [`class_scores`](Self::class_scores) are logarithms of probabilities.
    pub fn is_probabilistic(&self) -> bool {
        self.model.is_probabilistic()
    }

    /// Returns the penalty C used in training; `None` for a kind of classifier without C.
    pub fn c(&self) -> Option<f64> {
        self.c
    }

    /// Returns the result of the cross-validation that chose C; `None` if C was fixed.
    pub fn chosen(&self) -> Option<&Chosen> {
        self.chosen.as_ref()
    }

    /// Returns the number of optimisation problems that stopped at the solver's iteration cap before reaching the tolerance.
    pub fn n_capped(&self) -> usize {
        self.model.n_capped()
    }

    /// Returns whether `labels` may differ from `labels_of_scores` for single rows.
    pub fn has_own_labels(&self) -> bool {
        self.model.has_own_labels()
    }

    /// Returns whether the model is trained anew in each call that predicts.
    pub fn trains_in_predictions(&self) -> bool {
        self.model.trains_in_predictions()
    }

    /// Returns the trained kernel SVM; `None` for other kinds. The SVM expects scaled features.
    pub fn svm(&self) -> Option<&SvmModel> {
        self.model.svm()
    }

    /// Returns the scaling fitted on the training rows.
    pub fn scaling(&self) -> &FittedScaling {
        &self.scaling
    }
}

impl<F: Precision, D: Data<Elem = F>> PredictInplace<ArrayBase<D, Ix2>, Array1<usize>>
    for TrainedClassifier
{
    /// Writes the predicted labels into `targets`.
    ///
    /// # Panics
    /// If the features are invalid or `targets` has a wrong length. The method `labels` returns an error instead.
    fn predict_inplace(&self, features: &ArrayBase<D, Ix2>, targets: &mut Array1<usize>) {
        match self.labels(F::double_features(features).view()) {
            Ok(labels) => targets.assign(&labels),
            Err(error) => panic!("{error}"),
        }
    }

    fn default_target(&self, features: &ArrayBase<D, Ix2>) -> Array1<usize> {
        Array1::zeros(features.nrows())
    }
}
