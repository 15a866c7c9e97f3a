//! Scores of rows by classifiers that were trained without the rows' fold.

use crate::Result;
use crate::class_model::ClassModel;
use crate::dataset::dataset;
use crate::linear_svm::LinearSvmParams;
use crate::streams::Streams;
use ndarray::{Array1, Array2, ArrayView2, Axis};

/// Maximum number of passes of the linear SVM. More passes change accuracies by less than their intervals and take longer.
const MAX_PASSES: usize = 12;
/// Penalty C of the linear SVM, for features of mean squared norm 1.
const C: f64 = 10.0;
/// Stopping tolerance of the linear SVM, in units of the margin.
const TOLERANCE: f64 = 0.05;

/// Classifier whose scores an audit compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeldOutMethod {
    /// Nearest class mean; the score of a class is the negative squared distance to its mean.
    NearestCentroid,
    /// Linear SVM, each class against all others, C = 10 for features of mean squared norm 1.
    LinearSvm,
}

/// Labelled rows of which one fold is held out.
#[derive(Clone, Copy, Debug)]
pub struct HeldOut<'a> {
    /// Features, shape (n, m).
    pub features: ArrayView2<'a, f64>,
    /// Class of each row, in 0..n_classes.
    pub labels: &'a [usize],
    /// Number of classes.
    pub n_classes: usize,
    /// Fold of each row; a row without a fold is neither trained on nor tested.
    pub folds: &'a [Option<usize>],
}

impl HeldOut<'_> {
    /// Trains a classifier on all rows outside `fold` and returns the rows of the fold with their scores, shape (n_rows, n_classes). A class without training
    /// rows has the score −∞.
    ///
    /// # Errors
    /// If a feature is not finite, or fewer than two classes have training rows.
    pub fn scores(
        &self,
        method: HeldOutMethod,
        fold: usize,
        seed: &dyn Streams,
    ) -> Result<(Vec<usize>, Array2<f64>)> {
        let rows = 0..self.labels.len();
        let is_test = |row: &usize| self.folds[*row] == Some(fold);
        let is_train = |row: &usize| self.folds[*row].is_some_and(|own| own != fold);
        let test: Vec<usize> = rows.clone().filter(is_test).collect();
        let train: Vec<usize> = rows.filter(is_train).collect();
        let mut features = self.features.select(Axis(0), &train);
        let labels = Array1::from_iter(train.iter().map(|&row| self.labels[row]));
        let mean = features.mean_axis(Axis(0));
        let mean = mean.unwrap_or_else(|| Array1::zeros(features.ncols()));
        features -= &mean;
        let mut tested = self.features.select(Axis(0), &test);
        tested -= &mean;
        let scores = match method {
            HeldOutMethod::NearestCentroid => self.centroid_scores(&features, &labels, &tested),
            HeldOutMethod::LinearSvm => {
                let std =
                    (features.iter().map(|x| x * x).sum::<f64>() / features.len() as f64).sqrt();
                let factor = if std > 0.0 { 1.0 / std } else { 1.0 };
                features *= factor;
                tested *= factor;
                let params = LinearSvmParams {
                    // The squared norm of a row of m features with standard deviation 1 is m.
                    c: C / features.ncols() as f64,
                    tolerance: TOLERANCE,
                    max_passes: MAX_PASSES,
                    ..LinearSvmParams::default()
                };
                let model = params.train(&dataset(features, labels)?, seed)?;
                let values = match tested.nrows() {
                    0 => Array2::zeros((0, model.classes().len())),
                    _ => model.scores(tested.view())?,
                };
                let mut scores = Array2::from_elem((test.len(), self.n_classes), f64::NEG_INFINITY);
                for (column, &class) in values.columns().into_iter().zip(model.classes()) {
                    scores.column_mut(class).assign(&column);
                }
                scores
            }
        };
        Ok((test, scores))
    }

    fn centroid_scores(
        &self,
        train: &Array2<f64>,
        labels: &Array1<usize>,
        tested: &Array2<f64>,
    ) -> Array2<f64> {
        let mut means = Array2::zeros((self.n_classes, train.ncols()));
        let mut counts = vec![0.0; self.n_classes];
        for (row, &label) in train.rows().into_iter().zip(labels) {
            let mut mean = means.row_mut(label);
            mean += &row;
            counts[label] += 1.0;
        }
        for (mut mean, &count) in means.rows_mut().into_iter().zip(&counts) {
            mean /= f64::max(count, 1.0);
        }
        let mut scores = 2.0 * tested.dot(&means.t());
        for (class, mut column) in scores.columns_mut().into_iter().enumerate() {
            let mean = means.row(class);
            column -= mean.dot(&mean);
            if counts[class] == 0.0 {
                column.fill(f64::NEG_INFINITY);
            }
        }
        scores
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    #[test]
    fn held_out_rows_of_separate_classes_are_recognised() {
        let labels: Vec<usize> = (0..90).map(|row| row % 3).collect();
        let folds: Vec<Option<usize>> = (0..90).map(|row| Some(row / 18)).collect();
        let mut rng = 3_u64.rng();
        let features = Array2::from_shape_fn((90, 4), |(row, column)| {
            let level = if column == row % 3 { 3.0 } else { 0.0 };
            level + rng.r#gen::<f64>()
        });
        let held = HeldOut {
            features: features.view(),
            labels: &labels,
            n_classes: 3,
            folds: &folds,
        };
        for method in [HeldOutMethod::NearestCentroid, HeldOutMethod::LinearSvm] {
            let (rows, scores) = held.scores(method, 1, &5_u64).unwrap();
            assert_eq!(rows, (18..36).collect::<Vec<_>>());
            for (row, scores) in rows.into_iter().zip(scores.rows()) {
                assert!((0..3).all(|class| scores[labels[row]] >= scores[class]));
            }
        }
    }
}
