//! Loss of a multinomial logistic regression with its gradient, and an approximate inverse of its Hessian.
//!
//! With labels y, weights w_k, biases b_k and p(k | x) ∝ exp(w_k·x + b_k), the loss is `(1/n) Σ_i −ln p(y_i | x_i) + ½ penalty Σ_k |w_k|²`. Rows are
//! processed in blocks that stay in the cache. One matrix product gives the scores of a block, and another one adds to the gradient; each exponential is
//! computed once.
//!
//! **Inverse Hessian.** The Hessian block of class k is `(1/n) Σ_i p_ik (1 − p_ik) x_i x_iᵀ + penalty I`. Its mean over the K classes, with the weights
//! `d_i = (1/K) Σ_k p_ik (1 − p_ik)` of the rows, is the same m × m matrix for all classes. L-BFGS starts from the inverse of this matrix, because features
//! are strongly correlated. With 256 random projections of frames, 6,000 rows and 43 classes, this start reduces 420 iterations to 180 for an equal
//! gradient.

use crate::classifiers::lbfgs::Objective;
use ndarray::linalg::general_mat_mul;
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis, s};

use crate::linalg::exponential::exponentials;

/// Number of rows per block. With a larger value, a block exceeds the cache; with a smaller value, the matrix products are inefficient.
const BLOCK_ROWS: usize = 256;

/// Maximum cost of the approximate inverse Hessian, in evaluations of the loss. If the cost is larger, L-BFGS starts from a multiple of the identity.
const MAX_COST: f64 = 12.0;

/// Number of values that are added in parallel.
const LANES: usize = 8;

/// Loss of labelled rows as a function of the vector of all weights (n_classes × m), followed by all biases.
pub(crate) struct LogisticLoss<'a> {
    features: ArrayView2<'a, f64>,
    /// Class of each row, as an index.
    label: &'a [usize],
    n_classes: usize,
    penalty: f64,
    /// Inverse of the mean Hessian block of the weights (m × m), and the inverse of the mean second derivative by a bias; `None` for the identity.
    inverse: Option<(Array2<f64>, f64)>,
}

/// Splits a vector into the weights (n_classes × m) and the biases (n_classes,).
pub(crate) fn parts(
    vector: ArrayView1<f64>,
    n_classes: usize,
) -> (ArrayView2<f64>, ArrayView1<f64>) {
    let (weights, bias) = vector.split_at(Axis(0), vector.len() - n_classes);
    let m = weights.len() / n_classes;
    let weights = weights.into_shape_with_order((n_classes, m));
    (weights.expect("a slice of n_classes × m"), bias)
}

impl<'a> LogisticLoss<'a> {
    /// Creates the loss of rows (n × m) with labels from 0 to n_classes − 1.
    pub(crate) fn new(
        features: ArrayView2<'a, f64>,
        label: &'a [usize],
        n_classes: usize,
        penalty: f64,
    ) -> Self {
        Self {
            features,
            label,
            n_classes,
            penalty,
            inverse: None,
        }
    }

    /// Returns whether the inverse Hessian costs at most [`MAX_COST`] evaluations of the loss: n m² + m³ operations instead of 2 n m K.
    fn is_invertible_in_time(&self) -> bool {
        let [n, m] = [self.features.nrows(), self.features.ncols()].map(|count| count as f64);
        m * (1.0 + m / n) <= MAX_COST * 2.0 * self.n_classes as f64
    }

    /// Computes the probabilities of each block of rows at a point, and calls `visit(rows, labels, scores)` for each block. The scores contain the products with
    /// the weights, without biases.
    fn each_block(
        &self,
        at: ArrayView1<f64>,
        mut visit: impl FnMut(ArrayView2<f64>, &[usize], &mut Array2<f64>),
    ) {
        let (weights, _) = parts(at, self.n_classes);
        let mut scores = Array2::zeros((BLOCK_ROWS, self.n_classes));
        let labels = self.label.chunks(BLOCK_ROWS);
        for (rows, labels) in self
            .features
            .axis_chunks_iter(Axis(0), BLOCK_ROWS)
            .zip(labels)
        {
            if rows.nrows() != scores.nrows() {
                scores = Array2::zeros((rows.nrows(), self.n_classes));
            }
            general_mat_mul(1.0, &rows, &weights.t(), 0.0, &mut scores);
            visit(rows, labels, &mut scores);
        }
    }
}

impl Objective for LogisticLoss<'_> {
    fn evaluate(&mut self, at: &Array1<f64>) -> (f64, Array1<f64>) {
        let (weights, bias) = parts(at.view(), self.n_classes);
        let mut sums = vec![0.0; self.n_classes];
        let mut of_weights = Array2::zeros(weights.dim());
        let mut loss = 0.0;
        self.each_block(at.view(), |rows, labels, scores| {
            let values = scores.as_slice_mut().expect("it is in standard layout");
            loss += residuals(values, &bias.to_vec(), labels, &mut sums);
            general_mat_mul(1.0, &scores.t(), &rows, 1.0, &mut of_weights);
        });
        let per_row = 1.0 / self.label.len() as f64;
        of_weights *= per_row;
        of_weights.scaled_add(self.penalty, &weights);
        let squares: f64 = weights.iter().map(|w| w * w).sum();
        let gradient = of_weights.iter().copied();
        let gradient = gradient.chain(sums.iter().map(|sum| sum * per_row));
        (
            loss * per_row + 0.5 * self.penalty * squares,
            gradient.collect(),
        )
    }

    fn prepare(&mut self, at: &Array1<f64>) {
        if !self.is_invertible_in_time() {
            return;
        }
        let (_, bias) = parts(at.view(), self.n_classes);
        let (bias, m) = (bias.to_vec(), self.features.ncols());
        let mut hessian = Array2::zeros((m, m));
        let mut of_bias = 0.0;
        self.each_block(at.view(), |rows, _, scores| {
            let values = scores.as_slice_mut().expect("it is in standard layout");
            let weights = mean_variances(values, &bias);
            of_bias += weights.sum();
            let weighted = &rows * &weights.insert_axis(Axis(1));
            general_mat_mul(1.0, &weighted.t(), &rows, 1.0, &mut hessian);
        });
        let per_row = 1.0 / self.label.len() as f64;
        hessian *= per_row;
        hessian
            .diag_mut()
            .mapv_inplace(|value| value + self.penalty);
        // Probabilities of 0 and 1 have no curvature.
        let least = f64::MIN_POSITIVE.sqrt();
        if let Some(inverse) = inverse(hessian) {
            self.inverse = Some((inverse, 1.0 / (of_bias * per_row).max(least)));
        }
    }

    fn precondition(&self, vector: &Array1<f64>) -> Array1<f64> {
        let Some((inverse, of_bias)) = &self.inverse else {
            return vector.clone();
        };
        let (weights, bias) = parts(vector.view(), self.n_classes);
        let mut product = Array1::zeros(vector.len());
        let (to, mut to_bias) = product
            .view_mut()
            .split_at(Axis(0), vector.len() - self.n_classes);
        let to = to.into_shape_with_order(weights.dim());
        general_mat_mul(
            1.0,
            &weights,
            inverse,
            0.0,
            &mut to.expect("a slice of n_classes × m"),
        );
        to_bias.assign(&(&bias * *of_bias));
        product
    }
}

/// Replaces the scores of a block (n rows of n_classes values, without biases) by the residuals `p(k | x_i) − [k = y_i]`. Adds the residuals of each class to `sums`,
/// and returns `Σ_i −ln p(y_i | x_i)`.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn residuals(scores: &mut [f64], bias: &[f64], label: &[usize], sums: &mut [f64]) -> f64 {
    let mut loss = 0.0;
    for (row, &label) in scores.chunks_exact_mut(bias.len()).zip(label) {
        from_maximum(row, bias);
        loss -= row[label];
    }
    exponentials(scores);
    for (row, &label) in scores.chunks_exact_mut(bias.len()).zip(label) {
        let sum = sum(row);
        loss += sum.ln();
        let factor = 1.0 / sum;
        for (value, sum) in row.iter_mut().zip(&mut *sums) {
            *value *= factor;
            *sum += *value;
        }
        row[label] -= 1.0;
        sums[label] -= 1.0;
    }
    loss
}

/// Returns the mean of `p (1 − p)` over the classes for each row of scores (without biases). The scores are overwritten.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn mean_variances(scores: &mut [f64], bias: &[f64]) -> Array1<f64> {
    for row in scores.chunks_exact_mut(bias.len()) {
        from_maximum(row, bias);
    }
    exponentials(scores);
    let mean = |row: &mut [f64]| {
        let factor = 1.0 / sum(row);
        for value in row.iter_mut() {
            let p = *value * factor;
            *value = p * (1.0 - p);
        }
        sum(row) / row.len() as f64
    };
    scores.chunks_exact_mut(bias.len()).map(mean).collect()
}

/// Adds the biases to a row of scores, and subtracts the largest sum.
#[inline(always)]
fn from_maximum(row: &mut [f64], bias: &[f64]) {
    for (value, bias) in row.iter_mut().zip(bias) {
        *value += bias;
    }
    let mut largest = [f64::NEG_INFINITY; LANES];
    let (blocks, rest) = row.as_chunks::<LANES>();
    for block in blocks {
        for lane in 0..LANES {
            largest[lane] = if block[lane] > largest[lane] {
                block[lane]
            } else {
                largest[lane]
            };
        }
    }
    let all = largest.iter().chain(rest);
    let max = all.fold(f64::NEG_INFINITY, |max, &value| max.max(value));
    for value in row {
        *value -= max;
    }
}

#[inline(always)]
fn sum(row: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (blocks, rest) = row.as_chunks::<LANES>();
    for block in blocks {
        for lane in 0..LANES {
            sums[lane] += block[lane];
        }
    }
    sums.iter().chain(rest).sum()
}

/// Returns the inverse of a symmetric positive definite matrix by its Cholesky factor; `None` if the matrix is not positive definite.
fn inverse(mut matrix: Array2<f64>) -> Option<Array2<f64>> {
    let m = matrix.nrows();
    // The lower triangle becomes the Cholesky factor L, row by row.
    for i in 0..m {
        for j in 0..=i {
            let sum = matrix.slice(s![i, ..j]).dot(&matrix.slice(s![j, ..j]));
            let rest = matrix[[i, j]] - sum;
            if i > j {
                matrix[[i, j]] = rest / matrix[[j, j]];
            } else if rest > 0.0 {
                matrix[[i, i]] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    // Column j of L⁻¹ is row j of `columns`: L⁻¹[i, j] = −(Σ_{k<i} L[i, k] L⁻¹[k, j]) / L[i, i].
    let mut columns = Array2::<f64>::zeros((m, m));
    for j in 0..m {
        columns[[j, j]] = 1.0 / matrix[[j, j]];
        for i in j + 1..m {
            let sum = matrix.slice(s![i, j..i]).dot(&columns.slice(s![j, j..i]));
            columns[[j, i]] = -sum / matrix[[i, i]];
        }
    }
    // L⁻ᵀ L⁻¹.
    Some(columns.dot(&columns.t()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(n: usize, m: usize) -> Array2<f64> {
        Array2::from_shape_fn((n, m), |(i, j)| {
            ((i * 131 + j * 71) as f64 * 0.417).sin() + ((i * 17 + j * j * 3) as f64).cos()
        })
    }

    #[test]
    fn loss_and_gradient_are_their_definitions() {
        for (n, m, n_classes) in [(7, 3, 2), (300, 5, 11), (513, 20, 16)] {
            let features = rows(n, m);
            let label: Vec<usize> = (0..n).map(|i| i * i % n_classes).collect();
            let mut loss = LogisticLoss::new(features.view(), &label, n_classes, 0.3);
            let at = Array1::from_shape_fn(n_classes * (m + 1), |i| 3.0 * (i as f64 * 1.3).sin());
            let (value, gradient) = loss.evaluate(&at);
            let by_definition = |at: &Array1<f64>| {
                let (weights, bias) = parts(at.view(), n_classes);
                let scores = features.dot(&weights.t()) + bias;
                let mean: f64 = scores
                    .outer_iter()
                    .zip(&label)
                    .map(|(row, &label)| row.mapv(f64::exp).sum().ln() - row[label])
                    .sum::<f64>()
                    / n as f64;
                mean + 0.15 * weights.mapv(|w| w * w).sum()
            };
            assert!((value - by_definition(&at)).abs() < 1e-12 * value);
            for i in 0..at.len() {
                let [mut above, mut below] = [at.clone(), at.clone()];
                above[i] += 1e-5;
                below[i] -= 1e-5;
                let slope = (by_definition(&above) - by_definition(&below)) / 2e-5;
                assert!((gradient[i] - slope).abs() < 1e-8, "{n} {i}");
            }
        }
    }

    #[test]
    fn preconditioning_solves_the_mean_hessian() {
        let (features, n_classes) = (rows(400, 6), 3);
        let label: Vec<usize> = (0..400).map(|i| i % n_classes).collect();
        let mut loss = LogisticLoss::new(features.view(), &label, n_classes, 0.01);
        let at = Array1::from_shape_fn(21, |i| (i as f64).cos());
        assert_eq!(loss.precondition(&at), at);
        loss.prepare(&at);
        let (weights, bias) = parts(at.view(), n_classes);
        let mut p = (features.dot(&weights.t()) + bias).mapv(f64::exp);
        p.outer_iter_mut().for_each(|mut row| row /= row.sum());
        let d = p.mapv(|p| p * (1.0 - p)).mean_axis(Axis(1)).unwrap();
        let weighted = &features * &d.view().insert_axis(Axis(1));
        let hessian = weighted.t().dot(&features) / 400.0 + 0.01 * Array2::<f64>::eye(6);
        let product = loss.precondition(&at);
        let (solved, of_bias) = parts(product.view(), n_classes);
        let again = solved.dot(&hessian) - weights;
        assert!(again.iter().all(|error| error.abs() < 1e-12));
        assert!(
            (of_bias.to_owned() * d.mean().unwrap() - bias)
                .mapv(f64::abs)
                .sum()
                < 1e-12
        );
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_inverse() {
        assert!(inverse(Array2::from_elem((2, 2), 1.0)).is_none());
        assert!(inverse(Array2::from_elem((2, 2), f64::NAN)).is_none());
    }
}
