//! Classes that classifiers predict for the rows of a fold, after training without it.

use crate::Result;
use crate::class_model::ClassModel;
use crate::classifiers::nearest_centroid::NearestCentroid;
use crate::dataset::dataset;
use crate::linear_svm::LinearSvmParams;
use crate::scaling::Scaling;
use crate::streams::Streams;
use ndarray::{Array1, ArrayView2, Axis};

/// Maximum number of passes of the linear SVM. More passes change accuracies by less than their intervals and take longer.
const MAX_PASSES: usize = 12;
/// Penalty C of the linear SVM, for features of mean squared norm 1.
const C: f64 = 10.0;
/// Stopping tolerance of the linear SVM, in units of the margin.
const TOLERANCE: f64 = 0.05;

/// Classifier that an audit trains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeldOutMethod {
    /// Nearest class mean.
    NearestCentroid,
    /// Linear SVM, each class against all others, C = 10 for features of mean squared norm 1.
    LinearSvm,
}

/// Labelled rows of which one fold is held out.
#[derive(Clone, Copy, Debug)]
pub struct HeldOut<'a> {
    /// Features, shape (n, m).
    pub features: ArrayView2<'a, f64>,
    /// Class of each row.
    pub labels: &'a [usize],
    /// Fold of each row; a row without a fold is neither trained on nor tested.
    pub folds: &'a [Option<usize>],
}

impl HeldOut<'_> {
    /// Trains a classifier on all rows outside `fold` and returns the rows of the fold with their predicted classes.
    ///
    /// # Errors
    /// If a feature is not finite, or fewer than two classes have training rows.
    pub fn predicted(
        &self,
        method: HeldOutMethod,
        fold: usize,
        seed: &dyn Streams,
    ) -> Result<Vec<(usize, usize)>> {
        let rows = 0..self.labels.len();
        let is_test = |row: &usize| self.folds[*row] == Some(fold);
        let is_train = |row: &usize| self.folds[*row].is_some_and(|own| own != fold);
        let test: Vec<usize> = rows.clone().filter(is_test).collect();
        let train: Vec<usize> = rows.filter(is_train).collect();
        if test.is_empty() {
            return Ok(Vec::new());
        }
        let features = self.features.select(Axis(0), &train);
        let labels = Array1::from_iter(train.iter().map(|&row| self.labels[row]));
        let scaling = Scaling::Overall.fit(features.view())?;
        let tested = scaling.apply(self.features.select(Axis(0), &test).view())?;
        let data = dataset(scaling.apply(features.view())?, labels)?;
        let model: Box<dyn ClassModel> = match method {
            HeldOutMethod::NearestCentroid => Box::new(NearestCentroid::train(&data)?),
            HeldOutMethod::LinearSvm => {
                let params = LinearSvmParams {
                    // The squared norm of a row of m features with standard deviation 1 is m.
                    c: C / tested.ncols() as f64,
                    tolerance: TOLERANCE,
                    max_passes: MAX_PASSES,
                    ..LinearSvmParams::default()
                };
                Box::new(params.train(&data, seed)?)
            }
        };
        let predicted = model.labels(tested.view())?;
        Ok(test.into_iter().zip(predicted).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;
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
        // The unit and the zero of the features have no effect.
        for (unit, zero) in [(1.0, 0.0), (1e-6, 5.0)] {
            let features = unit * (&features + zero);
            let held = HeldOut {
                features: features.view(),
                labels: &labels,
                folds: &folds,
            };
            for method in [HeldOutMethod::NearestCentroid, HeldOutMethod::LinearSvm] {
                let found = held.predicted(method, 1, &5_u64).unwrap();
                let expected: Vec<_> = (18..36).map(|row| (row, labels[row])).collect();
                assert_eq!(found, expected);
            }
        }
    }
}
