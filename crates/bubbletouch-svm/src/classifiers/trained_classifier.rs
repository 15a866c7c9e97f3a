//! A trained classifier: scaling and model, asked the same way whatever they are.

use std::sync::Arc;

use linfa::traits::PredictInplace;
use ndarray::{Array1, Array2, ArrayBase, ArrayView2, Data, Ix2};

use crate::Result;
use crate::class_model::ClassModel;
use crate::cross_validation::choice::Chosen;
use crate::predict::svm_model::SvmModel;
use crate::scaling::FittedScaling;

/// A trained classifier: scaling and model.
#[derive(Clone, Debug)]
pub struct TrainedClassifier {
    scaling: FittedScaling,
    model: Model,
    c: Option<f64>,
    chosen: Option<Chosen>,
}

/// What was trained on scaled features.
#[derive(Clone, Debug)]
pub(crate) enum Model {
    /// A kernel SVM: its scores are decision values of binary problems.
    Svm(Box<SvmModel>),
    /// One score per class.
    Classes(Arc<dyn ClassModel>),
}

impl Model {
    pub(crate) fn labels(&self, scaled: ArrayView2<f64>) -> Result<Array1<usize>> {
        match self {
            Self::Svm(model) => Ok(model.labels(scaled)?),
            Self::Classes(model) => Ok(model.labels(scaled)?),
        }
    }

    /// Solves that stopped at their iteration cap.
    pub(crate) fn n_capped(&self) -> usize {
        match self {
            Self::Svm(model) => model.n_capped(),
            Self::Classes(model) => model.n_capped(),
        }
    }
}

impl TrainedClassifier {
    pub(crate) fn new(
        scaling: FittedScaling,
        model: Model,
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

    /// The predicted label of each row of unscaled features (n_rows × m).
    ///
    /// # Errors
    /// Another number of columns than in training, or a NaN or infinite feature.
    pub fn labels(&self, features: ArrayView2<f64>) -> Result<Array1<usize>> {
        let scaled = self.scaling.apply(features)?;
        self.model.labels(scaled.view())
    }

    /// Scores (n_rows × n_scores) of unscaled features, of which [`labels_of_scores`](Self::labels_of_scores) makes
    /// labels. The sum of the scores of several touches of one object is the score of all of them together.
    ///
    /// | classifier | score |
    /// |---|---|
    /// | SVM | decision value of each binary problem, or of each class |
    /// | logistic regression | `ln p(k given x) − ln p(k)`: the prior is added once, by `labels_of_scores` |
    /// | naive Bayes | `ln p(x given k)`: likewise |
    /// | k nearest neighbours, tree, forest | `ln((v_k + 1) / (Σ v + n_classes))`, v the votes or the leaf's rows: finite without a vote |
    ///
    /// # Errors
    /// As [`labels`](Self::labels).
    pub fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        let scaled = self.scaling.apply(features)?;
        match &self.model {
            Model::Svm(model) => Ok(model.decision_values(scaled.view())?),
            Model::Classes(model) => Ok(model.scores(scaled.view())?),
        }
    }

    /// The label that each row of scores speaks for.
    pub fn labels_of_scores(&self, scores: ArrayView2<f64>) -> Array1<usize> {
        match &self.model {
            Model::Svm(model) => model.labels_of_values(scores),
            Model::Classes(model) => model.labels_of_scores(scores),
        }
    }

    /// The C that it was trained with; `None` for a kind without C.
    pub fn c(&self) -> Option<f64> {
        self.c
    }

    /// How C was chosen, if it was.
    pub fn chosen(&self) -> Option<&Chosen> {
        self.chosen.as_ref()
    }

    /// How many of its optimisation problems stopped at the solver's iteration cap, short of its tolerance.
    pub fn n_capped(&self) -> usize {
        self.model.n_capped()
    }

    /// The trained kernel SVM, if it is one; it takes scaled features, see [`scaling`](Self::scaling).
    pub fn svm(&self) -> Option<&SvmModel> {
        match &self.model {
            Model::Svm(model) => Some(model),
            Model::Classes(_) => None,
        }
    }

    /// The scaling, as fitted on the training rows.
    pub fn scaling(&self) -> &FittedScaling {
        &self.scaling
    }
}

impl<D: Data<Elem = f64>> PredictInplace<ArrayBase<D, Ix2>, Array1<usize>> for TrainedClassifier {
    /// Writes the predicted labels into `targets`.
    ///
    /// # Panics
    /// As [`SvmModel`]'s; [`TrainedClassifier::labels`] returns an error instead.
    fn predict_inplace(&self, features: &ArrayBase<D, Ix2>, targets: &mut Array1<usize>) {
        match self.labels(features.view()) {
            Ok(labels) => targets.assign(&labels),
            Err(error) => panic!("{error}"),
        }
    }

    fn default_target(&self, features: &ArrayBase<D, Ix2>) -> Array1<usize> {
        Array1::zeros(features.nrows())
    }
}
