//! Whether a solution of a binary SVM is what it says: straight from the definitions, with sums over all pairs of rows.

use bubbletouch::recognition::dataset::Dataset;
use bubbletouch::recognition::kernel::{Gamma, Kernel};
use bubbletouch::recognition::svm::{BinaryProblem, SvmParams};

/// K of two rows; of RBF kernels with γ.
pub fn kernel_value(kernel: Kernel, data: &Dataset, i: usize, j: usize) -> f64 {
    let (x, z) = (data.records.row(i), data.records.row(j));
    match kernel {
        Kernel::Rbf {
            gamma: Gamma::Value(gamma),
        } => {
            let apart = &x - &z;
            (-gamma * apart.dot(&apart)).exp()
        }
        _ => x.dot(&z),
    }
}

/// How far the optimality conditions are violated, in units of the decision value, and what f64 can know of them.
pub fn violation(params: &SvmParams, data: &Dataset, problem: &BinaryProblem) -> (f64, f64) {
    let rows = &problem.rows;
    let coefficients = &problem.solution.coefficients;
    let (mut worst, mut known): (f64, f64) = (0.0, 0.0);
    let mut signed_sum = 0.0;
    for (&row, &coefficient) in rows.iter().zip(coefficients) {
        let sign = if data.targets[row] == problem.positive {
            1.0
        } else {
            -1.0
        };
        let multiplier = sign * coefficient;
        signed_sum += coefficient;
        assert!(multiplier >= 0.0 && multiplier <= params.c * (1.0 + 1e-12));
        let terms = rows.iter().zip(coefficients);
        let terms: Vec<f64> = terms
            .map(|(&other, a)| a * kernel_value(params.kernel, data, row, other))
            .collect();
        let margin = sign * (terms.iter().sum::<f64>() - problem.solution.rho);
        let size: f64 = terms.iter().map(|term| term.abs()).sum();
        known = known.max(16.0 * f64::EPSILON * size);
        if multiplier < params.c * (1.0 - 1e-12) {
            worst = worst.max(1.0 - margin);
        }
        if multiplier > 0.0 {
            worst = worst.max(margin - 1.0);
        }
    }
    assert!(
        signed_sum.abs() <= 1e-11 * params.c * rows.len() as f64,
        "Σ yα = {signed_sum}"
    );
    (worst, known)
}
