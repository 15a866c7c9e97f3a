//! Linear SVMs, trained by coordinate descent to separate each class from all others.

use ndarray::{Array2, ArrayView2, Axis, Zip};
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::class_model::ClassModel;
use crate::dataset::{Dataset, checked_classes, positions};
use crate::linear_model::LinearModel;
use crate::linear_svm::coordinate_descent::{self, Rows, Solved};
use crate::linear_svm::params::LinearSvmParams;
use crate::saved::SavedModel;
use crate::streams::Streams;

/// Result of the solver on one binary problem: objectives, number of passes, and whether it stopped early.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Convergence {
    /// Value of the primal objective, computed from the weights: an upper bound of the optimum.
    pub primal: f64,
    /// Value of the dual objective at the multipliers, which is a lower bound of the optimum. The duality gap is `primal − dual`.
    pub dual: f64,
    /// Number of passes over all training rows.
    pub n_passes: usize,
    /// Whether the solver stopped at the maximum number of passes before reaching its tolerance.
    pub is_capped: bool,
}

/// Trained linear SVM, whose scores are the decision values of the classes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinearSvm {
    classes: Vec<usize>,
    model: LinearModel,
    convergence: Vec<Convergence>,
}

impl LinearSvmParams {
    /// Trains the linear SVM on labelled rows. The rows are visited in an order drawn from `seed`.
    ///
    /// # Errors
    /// If C, the tolerance or the cap is out of range. If the data are empty, or a feature is NaN, infinite or too large to square. If the number of labels
    /// differs from the number of rows, or there is a single class.
    pub fn train(&self, data: &Dataset, seed: &dyn Streams) -> Result<LinearSvm> {
        self.check()?;
        let classes = checked_classes(data)?;
        let rows = Rows::new(data.records.view())?;
        let label = positions(data.targets.view(), &classes);
        let weights = self.class_weight.of_classes(&label, classes.len());
        let penalties: Vec<f64> = label.iter().map(|&class| self.c * weights[class]).collect();
        let signs = |class: usize| -> Vec<f64> {
            let sign = |&label: &usize| if label == class { 1.0 } else { -1.0 };
            label.iter().map(sign).collect()
        };
        let solved = (0..classes.len()).map(|class| {
            let mut rng = seed.named("class").numbered(class as u64).rng();
            coordinate_descent::solve(&rows, (&signs(class), &penalties), self, &mut rng)
        });
        let solved: Vec<Solved> = solved.collect();
        let shape = (classes.len(), label.len());
        let multipliers =
            Array2::from_shape_fn(shape, |(class, row)| solved[class].multipliers[row]);
        // These sums do not contain the rounding errors of the solver's updates.
        let model = LinearModel {
            weights: multipliers.dot(&data.records),
            bias: multipliers.sum_axis(Axis(1)),
        };
        let values = data.records.dot(&model.weights.t()) + &model.bias;
        let squares = model.weights.map_axis(Axis(1), |w| w.dot(&w)) + model.bias.mapv(|b| b * b);
        let convergence = solved.iter().enumerate().map(|(class, solved)| {
            let loss: f64 = Zip::from(values.column(class))
                .and(&signs(class))
                .and(&penalties)
                .fold(0.0, |sum, &value, &sign, &penalty| {
                    sum + penalty * (1.0 - sign * value).max(0.0)
                });
            let half = 0.5 * squares[class];
            Convergence {
                primal: half + loss,
                dual: multipliers.row(class).mapv(f64::abs).sum() - half,
                n_passes: solved.n_passes,
                is_capped: solved.is_capped,
            }
        });
        Ok(LinearSvm {
            convergence: convergence.collect(),
            classes,
            model,
        })
    }
}

impl LinearSvm {
    /// Returns the weights and biases of the trained model.
    pub fn model(&self) -> &LinearModel {
        &self.model
    }

    /// Returns the convergence of the solver for each class, whose problem separates the class from all others.
    pub fn convergence(&self) -> &[Convergence] {
        &self.convergence
    }
}

impl ClassModel for LinearSvm {
    fn saved(&self) -> Option<SavedModel> {
        Some(SavedModel::LinearSvm(self.clone()))
    }

    fn classes(&self) -> &[usize] {
        &self.classes
    }

    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        self.model.scores(features)
    }

    fn n_capped(&self) -> usize {
        self.convergence()
            .iter()
            .filter(|end| end.is_capped)
            .count()
    }
}
