//! Nearest-centroid classifier: predicts the class whose mean training row has the smallest Euclidean distance.
//!
//! The classifier equals scikit-learn's `NearestCentroid`. The model stores n_classes × m numbers and has no parameters. A decision requires one distance per
//! class. Scores are −½|x − μₖ|², which equals `ln p(x | k)` for normal classes of variance 1, up to a constant per row. Scores of several touches of one
//! object can therefore be summed to a joint score. If distances are equal, the lower label is predicted, as in scikit-learn.

use crate::Result;
use crate::class_model::ClassModel;
use crate::classifiers::classifier_about::ClassifierAbout;
use crate::dataset::{Dataset, check_width, checked_classes};
use crate::saved::SavedModel;
use ndarray::{Array2, ArrayView2, Axis};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Trained nearest-centroid classifier, which predicts the class whose mean is nearest to the features.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NearestCentroid {
    classes: Vec<usize>,
    /// Mean of the training rows of each class, n_classes × m.
    #[serde(with = "crate::saved")]
    centroids: Array2<f64>,
}

impl NearestCentroid {
    /// Computes the mean of the training rows of each class.
    ///
    /// # Errors
    /// If the data are empty or have a single class, a feature is not finite, or the numbers of labels and rows differ.
    pub fn train(data: &Dataset) -> Result<Self> {
        let classes = checked_classes(data)?;
        let mut centroids = Array2::zeros((classes.len(), data.records.ncols()));
        for (class, mut centroid) in classes.iter().zip(centroids.outer_iter_mut()) {
            let labels = data.targets.iter().enumerate();
            let rows: Vec<usize> = labels
                .filter(|(_, l)| *l == class)
                .map(|(r, _)| r)
                .collect();
            for &row in &rows {
                centroid += &data.records.row(row);
            }
            centroid /= rows.len() as f64;
        }
        Ok(Self { classes, centroids })
    }

    /// Returns the mean of the training rows of each class, in ascending order of the labels (n_classes × m).
    pub fn centroids(&self) -> ArrayView2<'_, f64> {
        self.centroids.view()
    }
}

impl ClassModel for NearestCentroid {
    fn saved(&self) -> Option<SavedModel> {
        Some(SavedModel::NearestCentroid(self.clone()))
    }

    fn classes(&self) -> &[usize] {
        &self.classes
    }

    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.centroids.ncols())?;
        let mut scores = Array2::zeros((features.nrows(), self.classes.len()));
        for (row, mut scores) in features.axis_iter(Axis(0)).zip(scores.outer_iter_mut()) {
            for (centroid, score) in self.centroids.outer_iter().zip(scores.iter_mut()) {
                let squares = row.iter().zip(centroid).map(|(x, c)| (x - c).powi(2));
                *score = -0.5 * squares.sum::<f64>();
            }
        }
        Ok(scores)
    }
}

pub(crate) const ABOUT: ClassifierAbout =
    ClassifierAbout::new("nearest centroid", |_, scaled, _, _| {
        Ok(Arc::new(NearestCentroid::train(scaled)?))
    });

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    fn trained() -> NearestCentroid {
        // The example in scikit-learn's documentation, with labels 1 and 2.
        let rows = array![
            [-1.0, -1.0],
            [-2.0, -1.0],
            [-3.0, -2.0],
            [1.0, 1.0],
            [2.0, 1.0],
            [3.0, 2.0]
        ];
        NearestCentroid::train(&Dataset::new(rows, array![1, 1, 1, 2, 2, 2])).unwrap()
    }

    #[test]
    fn classes_are_their_means_and_the_nearest_wins() {
        let model = trained();
        let expected = array![[-2.0, -4.0 / 3.0], [2.0, 4.0 / 3.0]];
        assert!(
            (&model.centroids() - &expected)
                .iter()
                .all(|d| d.abs() < 1e-15)
        );
        let rows = array![[-0.8, -1.0], [0.1, 0.0], [2.0, 4.0 / 3.0]];
        assert_eq!(model.labels(rows.view()).unwrap(), array![1, 2, 2]);
        let scores = model.scores(rows.view()).unwrap();
        // |(−0.8, −1) − (−2, −4/3)|² = 1.44 + 1/9.
        assert!((scores[[0, 0]] + 0.5 * (1.44 + 1.0 / 9.0)).abs() < 1e-12);
        assert_eq!(scores[[2, 1]], 0.0);
    }

    #[test]
    fn a_row_between_two_means_is_of_the_lower_label() {
        let halfway = array![[0.0, 0.0]];
        assert_eq!(trained().labels(halfway.view()).unwrap(), array![1]);
    }
}
