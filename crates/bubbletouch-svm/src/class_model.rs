//! Common interface of all trained classifiers, which compute scores of rows.

use std::fmt::Debug;

use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};

use crate::Result;
use crate::predict::svm_model::SvmModel;
use crate::predict::voting::first_maximum;
use crate::saved::SavedModel;

/// Trained classifier that computes one score per class; a [kernel SVM](SvmModel) computes one score per binary problem.
///
/// Scores are additive: the sum of the scores of k touches of one object is the score of all k touches together. A probabilistic model therefore returns `ln
/// p(x | class)` up to a constant per row x. The log-prior `ln p(class)` is separate and is added once for all summed touches.
pub trait ClassModel: Debug + Send + Sync {
    /// Returns the model as data; `None` for a kind that cannot be saved.
    fn saved(&self) -> Option<SavedModel> {
        None
    }

    /// Returns the model if it is a kernel SVM; `None` for other kinds.
    fn svm(&self) -> Option<&SvmModel> {
        None
    }

    /// Returns the class labels of the training rows, ascending. Every predicted label is one of them.
    fn classes(&self) -> &[usize];

    /// Returns the scores of all rows (n_rows × n_classes), in ascending order of the labels. Larger scores favour the class. For a kernel SVM, the scores are
    /// decision values (n_rows × n_problems).
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>>;

    /// Returns the log-prior of each class, or `None` if there is no prior. Log-priors are added to a sum of scores before the class with the largest sum is
    /// predicted.
    fn log_prior(&self) -> Option<ArrayView1<'_, f64>> {
        None
    }

    /// Returns whether the sum of score and log-prior is the log-probability of the class given the row, up to a constant per row.
    fn is_probabilistic(&self) -> bool {
        self.log_prior().is_some()
    }

    /// Returns the number of optimisation problems in training that stopped at the maximum number of iterations before reaching the tolerance.
    fn n_capped(&self) -> usize {
        0
    }

    /// Returns whether `labels` may differ from the classes with the largest sum of score and log-prior.
    fn has_own_labels(&self) -> bool {
        false
    }

    /// Returns whether the model is trained anew in each call that predicts. The time of such a call is training time, too.
    fn trains_in_predictions(&self) -> bool {
        false
    }

    /// Returns for each row of scores the label with the largest sum of score and log-prior; if several are equal, the lowest label. The decision values of a
    /// kernel SVM are combined by votes.
    fn labels_of_scores(&self, scores: ArrayView2<f64>) -> Array1<usize> {
        let scores = self.class_scores(scores);
        let rows = scores.rows().into_iter();
        rows.map(|row| self.classes()[first_maximum(row)]).collect()
    }

    /// Returns one value per class (n_rows × n_classes): the sum of score and log-prior.
    fn class_scores(&self, scores: ArrayView2<f64>) -> Array2<f64> {
        match self.log_prior() {
            Some(prior) => &scores + &prior,
            None => scores.to_owned(),
        }
    }

    /// Returns the predicted label of each row of features (n_rows × m).
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    fn labels(&self, features: ArrayView2<f64>) -> Result<Array1<usize>> {
        Ok(self.labels_of_scores(self.scores(features)?.view()))
    }
}

/// Converts vote counts (one per row and class) to scores: `ln((votes + 1) / (total votes + n_classes))` (Laplace's rule of succession).
///
/// A class without votes has a finite score; a score of −∞ would exclude the class in all further touches. Classes keep the order and the ties of their votes.
#[doc(hidden)]
pub fn log_vote_shares(mut votes: Array2<f64>) -> Array2<f64> {
    for mut row in votes.axis_iter_mut(Axis(0)) {
        let all = row.sum() + row.len() as f64;
        row.mapv_inplace(|votes| ((votes + 1.0) / all).ln());
    }
    votes
}

/// Returns the log-prior of each class: the logarithm of its fraction of the training rows.
#[doc(hidden)]
pub fn log_priors(labels: ArrayView1<usize>, classes: &[usize]) -> Array1<f64> {
    let share = |class: &usize| {
        let n_class = labels.iter().filter(|&label| label == class).count();
        (n_class as f64 / labels.len() as f64).ln()
    };
    classes.iter().map(share).collect()
}

/// Normalises each row of log-scores to log-probabilities, so that the exponentials of a row sum to 1.
pub(crate) fn normalise(values: &mut Array2<f64>) {
    for mut row in values.rows_mut() {
        let max = row.fold(f64::NEG_INFINITY, |max, &value| max.max(value));
        let sum: f64 = row.iter().map(|value| (value - max).exp()).sum();
        row -= max + sum.ln();
    }
}
