//! What every trained classifier but the kernel SVM is asked: one score per class.

use std::fmt::Debug;

use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};

use crate::Result;
use crate::predict::voting::first_maximum;

/// A trained classifier that scores every class.
///
/// Scores are made to be summed: the sum of the scores of k touches of one object is the score of all of them. So a
/// model of probabilities scores by `ln p(x | class)` up to a constant of the row, and keeps `ln p(class)` apart as
/// [`log_prior`](Self::log_prior), which is added once however many touches were summed.
pub trait ClassModel: Debug + Send + Sync {
    /// The classes of the training rows, ascending: what can be predicted.
    fn classes(&self) -> &[usize];

    /// Scores (n_rows × n_classes, in the order of [`classes`](Self::classes)): larger speaks for the class.
    ///
    /// # Errors
    /// Another number of columns than in training, or a NaN or infinite feature.
    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>>;

    /// What is added to a sum of scores before the largest wins, per class; `None`: nothing.
    fn log_prior(&self) -> Option<ArrayView1<'_, f64>> {
        None
    }

    /// How many of its optimisation problems stopped at their iteration cap, short of their tolerance.
    fn n_capped(&self) -> usize {
        0
    }

    /// The label of each row of scores: the largest score with the prior added, the lowest label of equals.
    fn labels_of_scores(&self, scores: ArrayView2<f64>) -> Array1<usize> {
        let prior = self
            .log_prior()
            .map_or_else(|| Array1::zeros(self.classes().len()), |p| p.to_owned());
        scores
            .rows()
            .into_iter()
            .map(|row| {
                self.classes()[first_maximum((&row + &prior).as_slice().unwrap_or_default())]
            })
            .collect()
    }

    /// The predicted label of each row.
    ///
    /// # Errors
    /// As [`scores`](Self::scores).
    fn labels(&self, features: ArrayView2<f64>) -> Result<Array1<usize>> {
        Ok(self.labels_of_scores(self.scores(features)?.view()))
    }
}

/// `ln((votes + 1) / (all votes + n_classes))` of each row: Laplace's rule of succession.
///
/// A class without votes is unlikely, not impossible (−∞ would silence it for all touches that follow), and few votes
/// are believed less than many. Keeps order and ties of the votes.
pub fn log_vote_shares(mut votes: Array2<f64>) -> Array2<f64> {
    for mut row in votes.axis_iter_mut(Axis(0)) {
        let all = row.sum() + row.len() as f64;
        row.mapv_inplace(|votes| ((votes + 1.0) / all).ln());
    }
    votes
}

/// `ln(n_class / n_rows)` for these classes.
pub fn log_priors(labels: ArrayView1<usize>, classes: &[usize]) -> Array1<f64> {
    let share = |class: &usize| {
        let n_class = labels.iter().filter(|&label| label == class).count();
        (n_class as f64 / labels.len() as f64).ln()
    };
    classes.iter().map(share).collect()
}
