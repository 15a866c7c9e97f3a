//! Scores of predicted labels: confusion matrix, accuracy, precision, recall, macro-F1.

use ndarray::{Array1, Array2, ArrayView1, Axis};

use crate::{Error, Result};
use bubbletouch_svm::dataset::check_labels;

/// Confusion matrix: number of rows of each true class (matrix row) that are predicted as each class (matrix column).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfusionMatrix {
    /// Number of test rows per true and predicted class, n_classes × n_classes.
    pub counts: Array2<usize>,
}

impl ConfusionMatrix {
    /// Creates the confusion matrix of the given true and predicted classes.
    ///
    /// # Errors
    /// If there are no rows, the numbers of predictions and true labels differ, or a label is `n_classes` or above.
    pub fn new(
        truth: ArrayView1<usize>,
        predicted: ArrayView1<usize>,
        n_classes: usize,
    ) -> Result<Self> {
        check_labels(truth.len(), predicted)?;
        if truth.is_empty() {
            return Err(Error::input("labels", "no rows", "at least one is needed"));
        }
        let mut counts = Array2::zeros((n_classes, n_classes));
        for (row, (&truth, &predicted)) in truth.iter().zip(predicted).enumerate() {
            let Some(count) = counts.get_mut((truth, predicted)) else {
                return Err(Error::input(
                    format!("labels, row {row}"),
                    format!("class {truth} predicted as {predicted}"),
                    format!("classes below {n_classes} are allowed"),
                ));
            };
            *count += 1;
        }
        Ok(Self { counts })
    }

    /// Creates the confusion matrix of the given counts: (true class, predicted class, number of test rows).
    pub fn of_counts(counts: &[(usize, usize, usize)]) -> Self {
        let labels = counts
            .iter()
            .flat_map(|&(truth, predicted, _)| [truth, predicted]);
        let n_classes = labels.max().map_or(0, |last| last + 1);
        let mut matrix = Array2::zeros((n_classes, n_classes));
        for &(truth, predicted, count) in counts {
            matrix[[truth, predicted]] += count;
        }
        Self { counts: matrix }
    }

    /// Returns the total number of test rows.
    pub fn n_rows(&self) -> usize {
        self.counts.sum()
    }

    /// Returns the number of test rows whose class was predicted correctly.
    pub fn n_correct(&self) -> usize {
        self.counts.diag().sum()
    }

    /// Returns the fraction of test rows whose class was predicted correctly, 0 to 1.
    pub fn accuracy(&self) -> f64 {
        self.n_correct() as f64 / self.n_rows() as f64
    }

    /// Returns the precision of each class: correct predictions of the class divided by all predictions of the class, or 0 without predictions.
    pub fn precision(&self) -> Array1<f64> {
        shares(self.counts.diag(), &self.counts.sum_axis(Axis(0)))
    }

    /// Returns the recall of each class: correct predictions of the class divided by all rows of the class, or 0 without rows.
    pub fn recall(&self) -> Array1<f64> {
        shares(self.counts.diag(), &self.counts.sum_axis(Axis(1)))
    }

    /// Returns the mean recall over all classes that have rows (scikit-learn's `balanced_accuracy_score`).
    pub fn balanced_accuracy(&self) -> f64 {
        let rows = self.counts.sum_axis(Axis(1));
        let n_classes = rows.iter().filter(|&&n| n > 0).count();
        self.recall().sum() / n_classes as f64
    }

    /// Returns the F1 score (harmonic mean of precision and recall) of each class: `2 · correct / (true + predicted)`. The score is 0 if the class does not
    /// occur.
    pub fn f1(&self) -> Array1<f64> {
        let occurrences = self.counts.sum_axis(Axis(0)) + self.counts.sum_axis(Axis(1));
        shares(self.counts.diag(), &occurrences) * 2.0
    }

    /// Returns the mean F1 score over all classes that occur as truth or prediction (scikit-learn's `f1_score(average="macro", zero_division=0)`).
    pub fn macro_f1(&self) -> f64 {
        let occurrences = self.counts.sum_axis(Axis(0)) + self.counts.sum_axis(Axis(1));
        let n_occurring = occurrences.iter().filter(|&&count| count > 0).count();
        self.f1().sum() / n_occurring as f64
    }
}

fn shares(parts: ArrayView1<usize>, wholes: &Array1<usize>) -> Array1<f64> {
    let share = |(&part, &whole): (&usize, &usize)| match whole {
        0 => 0.0,
        _ => part as f64 / whole as f64,
    };
    parts.iter().zip(wholes).map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn scores_are_those_of_scikit_learn() {
        // scikit-learn 1.9.1, zero_division=0. Class 3 is predicted but never true; 4 and 5 do not occur.
        let truth = array![0, 0, 0, 1, 1, 1, 2, 2, 2, 2];
        let predicted = array![0, 0, 1, 1, 1, 3, 2, 2, 0, 3];
        let confusion = ConfusionMatrix::new(truth.view(), predicted.view(), 6).unwrap();
        assert_eq!(confusion.counts.row(0), array![2, 1, 0, 0, 0, 0]);
        assert_eq!(confusion.counts.row(2), array![1, 0, 2, 1, 0, 0]);
        assert_eq!((confusion.n_correct(), confusion.n_rows()), (6, 10));
        assert_eq!(confusion.accuracy(), 0.6);
        let two_thirds = 2.0 / 3.0;
        let precision = array![two_thirds, two_thirds, 1.0, 0.0, 0.0, 0.0];
        assert_eq!(confusion.precision(), precision);
        let recall = array![two_thirds, two_thirds, 0.5, 0.0, 0.0, 0.0];
        assert_eq!(confusion.recall(), recall);
        assert!((confusion.macro_f1() - 0.5).abs() < 1e-15);
        let balanced = (2.0 * two_thirds + 0.5) / 3.0;
        assert!((confusion.balanced_accuracy() - balanced).abs() < 1e-15);
        let counts = confusion.counts.indexed_iter();
        let counts: Vec<_> = counts.map(|((i, j), &n)| (i, j, n)).collect();
        assert_eq!(ConfusionMatrix::of_counts(&counts), confusion);
    }

    #[test]
    fn labels_that_do_not_fit_are_refused() {
        let truth = array![0, 1];
        assert!(ConfusionMatrix::new(truth.view(), array![0].view(), 2).is_err());
        let error = ConfusionMatrix::new(truth.view(), array![0, 2].view(), 2).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("labels, row 1: class 1 predicted as 2")
        );
        let none = Array1::zeros(0);
        assert!(ConfusionMatrix::new(none.view(), none.view(), 2).is_err());
    }
}
