//! Linear SVMs, trained by coordinate descent to separate each class from all others.

use ndarray::{Array1, Array2, ArrayView2, Axis, Zip, s};
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::class_model::ClassModel;
use crate::dataset::{Dataset, checked_classes, positions};
use crate::linear_model::LinearModel;
use crate::linear_svm::coordinate_descent::{self, Rows};
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
        let mut multipliers = Array2::zeros((classes.len(), label.len()));
        let mut ends = Vec::with_capacity(classes.len());
        for class in 0..classes.len() {
            let sign: Vec<f64> = label
                .iter()
                .map(|&label| if label == class { 1.0 } else { -1.0 })
                .collect();
            let mut rng = seed.named("class").numbered(class as u64).rng();
            let solved = coordinate_descent::solve(&rows, (&sign, &penalties), self, &mut rng);
            multipliers
                .row_mut(class)
                .assign(&Array1::from(solved.multipliers));
            ends.push((solved.n_passes, solved.is_capped));
        }
        Ok(against_rest(
            data,
            classes,
            (&label, &penalties),
            multipliers,
            &ends,
        ))
    }
}

/// Returns the weights and biases of the model, and the duality gap of each binary problem, given the class and the penalty of each row, and the
/// multipliers (n_classes × n_rows).
fn against_rest(
    data: &Dataset,
    classes: Vec<usize>,
    (label, penalties): (&[usize], &[f64]),
    multipliers: Array2<f64>,
    ends: &[(usize, bool)],
) -> LinearSvm {
    let model = weights(&multipliers, data.records.view());
    let values = data.records.dot(&model.weights.t()) + &model.bias;
    let squares = squared_norms(&model);
    let convergence = (0..classes.len())
        .map(|class| {
            let loss: f64 = Zip::from(values.column(class))
                .and(label)
                .and(penalties)
                .fold(0.0, |sum, &value, &label, &penalty| {
                    let sign = if label == class { 1.0 } else { -1.0 };
                    sum + penalty * (1.0 - sign * value).max(0.0)
                });
            let half = 0.5 * squares[class];
            let sum = multipliers.row(class).mapv(f64::abs).sum();
            Convergence {
                primal: half + loss,
                dual: sum - half,
                n_passes: ends[class].0,
                is_capped: ends[class].1,
            }
        })
        .collect();
    LinearSvm {
        classes,
        model,
        convergence,
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

/// Computes the weights `w_k = Σ_i a_ki x_i` and biases `b_k = Σ_i a_ki` of each class k from the signed multipliers a. The result does not contain the
/// rounding errors of the solver's updates.
fn weights(multipliers: &Array2<f64>, features: ArrayView2<f64>) -> LinearModel {
    LinearModel {
        weights: multipliers.dot(&features),
        bias: multipliers.sum_axis(Axis(1)),
    }
}

/// Returns the squared norm of the weights and the bias of each class k: `|w_k|² + b_k²`.
fn squared_norms(model: &LinearModel) -> Array1<f64> {
    let weights = model.weights.slice(s![.., ..]);
    weights.map_axis(Axis(1), |w| w.dot(&w)) + model.bias.mapv(|b| b * b)
}
