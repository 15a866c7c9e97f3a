//! One binary problem (class against class, or class against the rest), solved by linfa-svm: the only file that calls it.
//!
//! It is kept as a choice and as an oracle: an independent program for the same dual problem.

use linfa::DatasetBase;
use linfa::traits::Fit;
use linfa_svm::Svm;
use ndarray::{Array1, Array2, ArrayView2, Axis, s};

use crate::recognition::data::dataset::Dataset;
use crate::recognition::svm::dual::DualSolution;
use crate::recognition::svm::gram::points::Points;
use crate::recognition::svm::kernel::KernelFunction;
use crate::recognition::svm::{BinaryProblem, Multiclass};
use crate::{Error, Result};

/// Most rows of one binary problem: linfa-svm holds a dense n × n kernel of f64, 2 GiB at this n. Larger would not fit
/// beside the rest in 4 GiB; smaller would refuse one-vs-rest on sets that fit.
pub const MAX_BINARY_ROWS: usize = 16_384;

/// Rows of the kernel that the objective is summed over at once: 64 MiB at the most rows.
const OBJECTIVE_ROWS: usize = 512;

/// A pivot below this fraction of the kernel's largest diagonal entry ends the factor: the rest of the matrix is
/// rounding. Larger would change the problem by more than the solver's tolerance; smaller keeps columns of noise.
const RANK_TOLERANCE: f64 = 1e-13;

/// Solves all problems of a multi-class SVM, for a C and a tolerance.
pub(crate) fn solve_all(
    data: &Dataset,
    classes: &[usize],
    kernel: &KernelFunction,
    multiclass: Multiclass,
    (c, tolerance): (f64, f64),
) -> Result<Vec<BinaryProblem>> {
    let labels = data.targets.view();
    let rows_of = |wanted: &dyn Fn(usize) -> bool| -> Vec<usize> {
        (0..labels.len())
            .filter(|&row| wanted(labels[row]))
            .collect()
    };
    multiclass
        .problems(classes.len())
        .into_iter()
        .map(|(positive, negative)| {
            let (positive, negative) = (classes[positive], negative.map(|class| classes[class]));
            let rows = match negative {
                Some(negative) => {
                    let sides = [positive, negative].map(|class| rows_of(&|label| label == class));
                    sides.concat()
                }
                None => rows_of(&|_| true),
            };
            let is_positive: Vec<bool> = rows.iter().map(|&row| labels[row] == positive).collect();
            let features = data.records.select(Axis(0), &rows);
            Ok(BinaryProblem {
                positive,
                negative,
                solution: solve(features.view(), &is_positive, kernel, c, tolerance)?,
                rows,
            })
        })
        .collect()
}

/// Solves one binary problem on these rows (n × m).
fn solve(
    features: ArrayView2<f64>,
    is_positive: &[bool],
    kernel: &KernelFunction,
    c: f64,
    tolerance: f64,
) -> Result<DualSolution> {
    let n_rows = features.nrows();
    if n_rows > MAX_BINARY_ROWS {
        return Err(Error::input(
            "training rows",
            format!("{n_rows} in one binary problem"),
            format!("at most {MAX_BINARY_ROWS} are allowed; one-vs-one takes fewer at a time"),
        ));
    }
    let params = Svm::<f64, bool>::params()
        .pos_neg_weights(c, c)
        .eps(tolerance);
    let (records, params) = if features.ncols() > n_rows {
        let matrix = gram(features, kernel);
        (factor(&matrix), params.linear_kernel())
    } else {
        match *kernel {
            KernelFunction::Linear => (features.to_owned(), params.linear_kernel()),
            KernelFunction::Rbf { gamma } => {
                (features.to_owned(), params.gaussian_kernel(1.0 / gamma))
            }
            // linfa's polynomial kernel has no γ: it goes into the features.
            KernelFunction::Polynomial {
                gamma,
                coef0,
                degree,
            } => (
                &features * gamma.sqrt(),
                params.polynomial_kernel(coef0, f64::from(degree)),
            ),
        }
    };
    let targets = Array1::from(is_positive.to_vec());
    let svm = params
        .fit(&DatasetBase::new(records, targets))
        .map_err(|error| Error::input("classifier", error, "see linfa-svm's documentation"))?;
    Ok(DualSolution {
        is_capped: stopped_at_cap(&svm),
        rho: svm.rho,
        objective: objective(features, kernel, &svm.alpha),
        violation: None,
        n_iterations: None,
        coefficients: svm.alpha,
    })
}

/// `Σ |β| − ½ β K β`, a block of rows at a time; linfa-svm keeps its own to itself.
fn objective(features: ArrayView2<f64>, kernel: &KernelFunction, beta: &[f64]) -> f64 {
    let origin = Array1::zeros(features.ncols());
    let points = Points::<f64>::new(features, origin.view());
    let weights = Array1::from(beta.to_vec());
    let blocks = (0..points.len()).step_by(OBJECTIVE_ROWS);
    let quadratic: f64 = blocks
        .map(|start| {
            let rows = start..(start + OBJECTIVE_ROWS).min(points.len());
            let products = points
                .range(rows.clone())
                .kernel(points.all(), kernel)
                .dot(&weights);
            products.dot(&weights.slice(s![rows]))
        })
        .sum();
    weights.mapv(f64::abs).sum() - 0.5 * quadratic
}

/// K of these rows, n × n.
fn gram(features: ArrayView2<f64>, kernel: &KernelFunction) -> Array2<f64> {
    let origin = Array1::zeros(features.ncols());
    let points = Points::<f64>::new(features, origin.view());
    points.all().kernel(points.all(), kernel)
}

/// linfa-svm keeps the reason for stopping private; its `Display` is where it tells.
fn stopped_at_cap(svm: &Svm<f64, bool>) -> bool {
    svm.to_string().starts_with("Reached maximal iterations")
}

/// A matrix L (n × r) with `L Lᵀ = K` for a positive semidefinite K (n × n): Cholesky with diagonal pivoting.
///
/// The linear kernel on L's rows is K, so linfa-svm solves the same dual problem with dot products of length r ≤ n
/// where those of the features have length m > n, and K itself comes from one matrix product. Measured on 20 classes
/// of 30 rows, one-vs-one, m = 1,024: linear 0.40 → 0.18 s, RBF 0.84 → 0.15 s.
fn factor(kernel: &Array2<f64>) -> Array2<f64> {
    let n = kernel.nrows();
    let mut rest = kernel.diag().to_owned();
    let smallest = RANK_TOLERANCE * rest.fold(0.0, |max: f64, &value| max.max(value));
    // Row k holds column k of L: contiguous where it is used.
    let mut columns = Array2::<f64>::zeros((n, n));
    let mut rank = 0;
    while rank < n {
        let pivot = (0..n).fold(0, |best, i| if rest[i] > rest[best] { i } else { best });
        if rest[pivot] <= smallest {
            break;
        }
        let mut column = kernel.row(pivot).to_owned();
        for earlier in columns.slice(s![..rank, ..]).rows() {
            column.scaled_add(-earlier[pivot], &earlier);
        }
        column /= rest[pivot].sqrt();
        rest.zip_mut_with(&column, |rest, value| *rest -= value * value);
        // Exactly zero, so that rounding cannot make it a pivot again.
        rest[pivot] = 0.0;
        columns.row_mut(rank).assign(&column);
        rank += 1;
    }
    // linfa needs at least one column; a kernel of zeros has none.
    let columns = columns.slice(s![..rank.max(1), ..]);
    columns.t().as_standard_layout().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows with no pattern, all different.
    fn rows(n: usize, m: usize) -> Array2<f64> {
        Array2::from_shape_fn((n, m), |(i, j)| ((i * m + j) as f64 * 1.7).sin())
    }

    #[test]
    fn the_factor_times_its_transpose_is_the_kernel() {
        let mut features = rows(30, 50);
        let copy = features.row(3).to_owned();
        features.row_mut(17).assign(&copy);
        for kernel in [KernelFunction::Linear, KernelFunction::Rbf { gamma: 0.02 }] {
            let matrix = gram(features.view(), &kernel);
            let factor = factor(&matrix);
            assert!(
                factor.ncols() < 30,
                "a duplicated row has no pivot of its own"
            );
            let difference = (&factor.dot(&factor.t()) - &matrix).mapv(f64::abs);
            assert!(
                difference
                    .iter()
                    .all(|&value| value < 1e-11 * matrix[[0, 0]])
            );
        }
        assert_eq!(factor(&Array2::zeros((3, 3))), Array2::<f64>::zeros((3, 1)));
    }

    #[test]
    fn narrow_and_wide_features_give_the_same_dual_problem() {
        // Zero columns change no kernel value, but make the rows wide: the factor is solved instead.
        let narrow = rows(20, 5);
        let mut wide = Array2::zeros((20, 60));
        wide.slice_mut(s![.., ..5]).assign(&narrow);
        let is_positive: Vec<bool> = (0..20).map(|i| i % 3 == 0).collect();
        let polynomial = KernelFunction::Polynomial {
            gamma: 0.5,
            coef0: 1.0,
            degree: 2,
        };
        let rbf = KernelFunction::Rbf { gamma: 0.5 };
        for kernel in [KernelFunction::Linear, rbf, polynomial] {
            let solve = |features: &Array2<f64>| {
                solve(features.view(), &is_positive, &kernel, 1.0, 1e-10).unwrap()
            };
            let (direct, factored) = (solve(&narrow), solve(&wide));
            assert!((direct.rho - factored.rho).abs() < 1e-7, "{kernel:?}");
            // With a linear kernel in 5 dimensions the coefficients need not be unique; the hyperplane is.
            let sums = |solution: &DualSolution| {
                let coefficients = Array1::from(solution.coefficients.clone());
                gram(narrow.view(), &kernel).dot(&coefficients)
            };
            let difference = sums(&direct) - sums(&factored);
            assert!(
                difference.iter().all(|value| value.abs() < 1e-7),
                "{kernel:?}"
            );
        }
    }

    #[test]
    fn a_solver_that_gives_up_is_told_from_one_that_converged() {
        // Rounding keeps the violation above such a tolerance: the solver runs into its cap of 10 million iterations.
        let features = rows(5, 3);
        let is_positive = [true, false, true, false, true];
        let solve = |tolerance| {
            let kernel = KernelFunction::Linear;
            solve(features.view(), &is_positive, &kernel, 1e4, tolerance).unwrap()
        };
        assert!(!solve(1e-3).is_capped);
        assert!(solve(f64::MIN_POSITIVE).is_capped);
    }

    #[test]
    fn too_many_rows_for_a_dense_kernel_are_refused() {
        let features = Array2::zeros((MAX_BINARY_ROWS + 1, 1));
        let is_positive = vec![true; MAX_BINARY_ROWS + 1];
        let error = solve(
            features.view(),
            &is_positive,
            &KernelFunction::Linear,
            1.0,
            1e-3,
        );
        assert!(error.unwrap_err().to_string().contains("16384"));
    }
}
