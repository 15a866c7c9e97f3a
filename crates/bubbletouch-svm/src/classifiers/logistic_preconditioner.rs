//! Approximate inverse of the Hessian of a multinomial logistic regression, by which its conjugate gradients are preconditioned.
//!
//! With row weights v_i, probabilities p_i and features x_i (with a 1 for the bias), the Hessian is the mean of `v_i (diag p_i − p_i p_iᵀ) ⊗ x_i x_iᵀ`, plus the
//! penalties. It is approximated by a Kronecker product [Van Loan & Pitsianis 1993]:
//!
//! `H ≈ (K A / h + ε I) ⊗ (B / K + penalties / (1 + ε))`,
//!
//! where K is the number of classes, A the mean of `v_i (diag p_i − p_i p_iᵀ)`, h the trace of A, and B the mean of `h_i x_i x_iᵀ` with
//! `h_i = v_i Σ_k p_ik (1 − p_ik)`. The damping ε is the square root of the smallest penalty relative to the mean curvature h / K. The diagonal of H is a second
//! approximation, which needs less time and memory.

use ndarray::linalg::general_mat_mul;
use ndarray::{Array1, Array2, ArrayView2, Axis, concatenate, s};

use crate::classifiers::logistic_loss::sums;

/// Constant on the diagonals before their inversion, relative to the largest entry. If smaller, rounding errors of collinear features predominate; if larger,
/// the approximation has errors where features are almost collinear.
const RIDGE: f64 = 1e-13;

/// Approximate Hessian, positive definite.
pub(super) enum Preconditioner {
    /// Diagonal, shape K × (m + 1).
    Diagonal(Array2<f64>),
    /// Inverses of the factors of a Kronecker product.
    Kronecker {
        /// Shape K × K.
        of_classes: Array2<f64>,
        /// Shape (m + 1) × (m + 1).
        of_features: Array2<f64>,
    },
}

impl Preconditioner {
    /// Creates the diagonal at the point with probabilities `p`, shape n × K, if the features have a mean square of 1.
    pub fn diagonal(p: &Array2<f64>, row_weights: &Array1<f64>, penalties: &Array1<f64>) -> Self {
        let weights = row_weights.view().insert_axis(Axis(1));
        let curvature = p.mapv(|p| p * (1.0 - p)) * weights;
        let curvature = curvature.mean_axis(Axis(0)).expect("at least one row");
        let mut diagonal = &curvature.insert_axis(Axis(1)) + penalties;
        // Probabilities of 0 and 1 have no curvature.
        diagonal.mapv_inplace(|value| value.max(f64::MIN_POSITIVE.sqrt()));
        Self::Diagonal(diagonal)
    }

    /// Creates the Kronecker product at the point with probabilities `p`, shape n × K.
    pub fn kronecker(
        features: &Array2<f64>,
        p: &Array2<f64>,
        row_weights: &Array1<f64>,
        penalties: &Array1<f64>,
    ) -> Self {
        let (n, n_classes) = (p.nrows() as f64, p.ncols() as f64);
        let weights = row_weights.view().insert_axis(Axis(1));
        let curvature = (p.mapv(|p| p * (1.0 - p)) * weights).sum_axis(Axis(1));
        // Probabilities of 0 and 1 have no curvature.
        let mean = curvature.sum() / n;
        let mean = mean.max(f64::MIN_POSITIVE.sqrt());
        let least = penalties.slice(s![..-1]);
        let least = least.iter().copied().fold(f64::INFINITY, f64::min);
        let damping = (n_classes * least / mean).sqrt();

        // The rows of A have a sum of 0; this keeps the digits of the diagonal if the probabilities are near 0 and 1.
        let mut classes = (p * &weights).t().dot(p) * (-n_classes / (n * mean));
        classes.diag_mut().fill(0.0);
        let diagonal = damping - classes.sum_axis(Axis(1));
        classes.diag_mut().assign(&diagonal);

        let weighted = features * &curvature.view().insert_axis(Axis(1));
        let above = sums(features, &weighted);
        let below = concatenate![Axis(0), above.column(features.ncols()), [mean]];
        let mut products = concatenate![Axis(0), above, below.insert_axis(Axis(0))] / n_classes;
        let mut diagonal = products.diag_mut();
        diagonal += &(penalties / (1.0 + damping));
        let ridge = RIDGE * diagonal.fold(0.0, |max, &value| f64::max(max, value));
        diagonal += ridge;
        Self::Kronecker {
            of_classes: inverse(classes.view()),
            of_features: inverse(products.view()),
        }
    }

    /// Returns the product of the inverse with a residual, shape K × (m + 1).
    pub fn solve(&self, residual: &Array2<f64>) -> Array2<f64> {
        match self {
            Self::Diagonal(diagonal) => residual / diagonal,
            Self::Kronecker {
                of_classes,
                of_features,
            } => of_classes.dot(residual).dot(of_features),
        }
    }
}

/// Returns the inverse of a positive definite matrix, by the inverses of a half and of its Schur complement.
fn inverse(matrix: ArrayView2<f64>) -> Array2<f64> {
    let n = matrix.nrows();
    if n == 1 {
        return matrix.mapv(f64::recip);
    }
    let half = n / 2;
    let mut first = inverse(matrix.slice(s![..half, ..half]));
    let aside = matrix.slice(s![..half, half..]);
    let factor = first.dot(&aside);
    let mut complement = matrix.slice(s![half.., half..]).to_owned();
    general_mat_mul(-1.0, &aside.t(), &factor, 1.0, &mut complement);
    let last = inverse(complement.view());
    let between = -factor.dot(&last);
    general_mat_mul(-1.0, &between, &factor.t(), 1.0, &mut first);
    let above = concatenate![Axis(1), first, between];
    let below = concatenate![Axis(1), between.t(), last];
    concatenate![Axis(0), above, below]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_equal_probabilities_have_their_exact_hessian_without_a_penalty() {
        let features = Array2::from_shape_fn((50, 6), |(i, j)| {
            ((i * i + 1) as f64 * (j + 1) as f64).sin()
        });
        let weights = Array1::from_shape_fn(50, |i| 1.0 + (i % 3) as f64);
        let probabilities = [0.5, 0.3, 0.2];
        let p = Array2::from_shape_fn((50, 3), |(_, k)| probabilities[k]);
        let penalties = Array1::from_vec(vec![1e-16; 7]);
        let found = Preconditioner::kronecker(&features, &p, &weights, &penalties);
        // A residual whose sum over the classes is 0, as that of a gradient.
        let mut step = Array2::from_shape_fn((3, 7), |(k, j)| ((k * 5 + j) as f64).cos());
        step -= &step.mean_axis(Axis(0)).unwrap();
        let augmented = concatenate![Axis(1), features, Array2::ones((50, 1))];
        let mut changes = augmented.dot(&step.t());
        for (mut change, weight) in changes.rows_mut().into_iter().zip(&weights) {
            let mean = (0..3).map(|k| probabilities[k] * change[k]).sum::<f64>();
            (0..3).for_each(|k| change[k] = weight * probabilities[k] * (change[k] - mean));
        }
        let product = changes.t().dot(&augmented) / 50.0;
        let error = found.solve(&product) - &step;
        assert!(error.iter().all(|error| error.abs() < 1e-6), "{error}");
    }

    #[test]
    fn the_inverse_of_a_matrix_times_the_matrix_is_the_identity() {
        for n in [1, 2, 7, 64, 65] {
            let root = Array2::from_shape_fn((n, n), |(i, j)| ((i * 13 + j * j * 7) as f64).sin());
            let matrix = root.dot(&root.t()) + Array2::<f64>::eye(n);
            let error = inverse(matrix.view()).dot(&matrix) - Array2::<f64>::eye(n);
            assert!(error.iter().all(|error| error.abs() < 1e-10), "{n}");
        }
    }
}
