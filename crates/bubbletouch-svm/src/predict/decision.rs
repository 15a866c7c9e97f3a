//! Decision functions of all binary problems, which are evaluated by matrix products.

use std::borrow::Cow;

use ndarray::{Array1, Array2, ArrayView2, Axis, s};
use serde::{Deserialize, Serialize};

use super::condorcet_winner::{Pairs, condorcet_winners_by_hyperplanes};
use crate::binary_problem::BinaryProblem;
use crate::gram::centered_rows::CenteredRows;
use crate::gram::sorted::Sorted;
use crate::kernel::KernelFunction;
use crate::linalg::products::{FEW_ROWS, multiply};
use crate::linalg::scalar::Scalar;
use crate::multiclass::Multiclass;
use crate::predict::class_weights::{ClassWeights, weighted_sums};
use crate::predict::voting::Voting;

/// Number of rows for which decision values are computed together. With a smaller value, packing the support vectors dominates the time. With a larger
/// value, the kernel values take more memory; with this value, they take 10 MB for 5,000 support vectors.
const BLOCK_ROWS: usize = 512;

/// Decision functions `Σ y_i a_i K(x_i, x) − ρ` of all binary problems.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "T: Scalar")]
pub(crate) struct DecisionFunctions<T> {
    /// Centre that is subtracted from support vectors and from all rows to be classified (m values).
    #[serde(with = "crate::saved")]
    centre: Array1<f64>,
    /// Offset ρ of each decision function; for a linear kernel, the offset is valid for rows minus the centre.
    #[serde(with = "crate::saved")]
    rho: Array1<f64>,
    sums: Sums<T>,
}

/// Data from which the sums of kernel values in all decision functions are computed.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "T: Scalar")]
enum Sums<T> {
    /// Normals of the hyperplanes of a linear kernel, n_problems × m.
    Hyperplanes(#[serde(with = "crate::saved")] Array2<T>),
    /// Support vectors and their coefficients.
    Support(Support<T>),
}

/// Support vectors, sorted by class.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "T: Scalar")]
struct Support<T> {
    kernel: KernelFunction,
    vectors: CenteredRows<T>,
    weights: Vec<ClassWeights<T>>,
    /// Decision functions of single pairs of classes, for one-vs-one.
    #[serde(skip)]
    pairs: Option<Pairs<T>>,
}

/// Returns the decision functions of single pairs of classes; `None` unless each problem is a pair.
fn pairs_of<T: Scalar>(weights: &[ClassWeights<T>], rho: &Array1<f64>) -> Option<Pairs<T>> {
    let n = weights.len();
    (rho.len() == n * (n - 1) / 2 && weights.iter().all(|class| class.problems.len() == n - 1))
        .then(|| Pairs::new(weights, rho))
}

impl<T: Scalar> DecisionFunctions<T> {
    /// Creates the decision functions of binary problems that were trained on the given rows. If the rows are owned, they are reduced to the support vectors in
    /// place. The normals of linear problems are computed unless they are given.
    pub fn new(
        rows: Cow<Sorted<T>>,
        problems: &[BinaryProblem],
        normals: Option<Array2<T>>,
    ) -> Self {
        let sorted = rows.as_ref();
        let classes = || sorted.ranges.iter().cloned().enumerate();
        let centre = sorted.centre.clone();
        let (rho, sums) = match sorted.kernel {
            KernelFunction::Linear => {
                let about_centre = problems.iter().map(|p| sorted.rho_about_centre(p));
                let sum = || {
                    let mut normals = Array2::zeros((problems.len(), sorted.centre.len()));
                    for (class, rows) in classes() {
                        let weights = ClassWeights::new(sorted, class, rows, problems);
                        weights.add_to(&mut normals, sorted);
                    }
                    normals.mapv(T::from_f64)
                };
                let normals = normals.unwrap_or_else(sum);
                (about_centre.collect(), Sums::Hyperplanes(normals))
            }
            kernel => {
                let mut support = Vec::new();
                let weights = classes().map(|(class, rows)| {
                    ClassWeights::new(sorted, class, rows, problems).of_support(&mut support)
                });
                let weights: Vec<_> = weights.collect();
                let rho = problems.iter().map(|p| p.solution.rho).collect();
                let pairs = pairs_of(&weights, &rho);
                let vectors = match rows {
                    Cow::Borrowed(sorted) => sorted.points.select(&support),
                    Cow::Owned(sorted) => sorted.points.keep(&support),
                };
                let support = Support {
                    kernel,
                    vectors,
                    weights,
                    pairs,
                };
                (rho, Sums::Support(support))
            }
        };
        Self { centre, rho, sums }
    }

    /// Returns whether the parts of read functions have the sizes of this number of problems, classes and features. Computes the parts that are not saved.
    pub fn complete(&mut self, [n_problems, n_classes, n_features]: [usize; 3]) -> bool {
        let shape = (n_problems, n_features);
        let fit_sums = match &self.sums {
            Sums::Hyperplanes(normals) => normals.dim() == shape,
            Sums::Support(support) => {
                let n = support.vectors.len();
                let mut weights = support.weights.iter();
                support.vectors.fits(n_features)
                    && weights.len() == n_classes
                    && weights.all(|class| class.fits(n, n_problems))
            }
        };
        let are_whole = fit_sums && (self.rho.len(), self.centre.len()) == shape;
        if let (Sums::Support(support), true) = (&mut self.sums, are_whole) {
            support.pairs = pairs_of(&support.weights, &self.rho);
        }
        are_whole
    }

    /// Returns the decision values of all binary problems for each row of features, n_rows × n_problems.
    pub fn values(&self, features: ArrayView2<f64>) -> Array2<f64> {
        let mut values = Array2::zeros((features.nrows(), self.rho.len()));
        let mut room = self.allocate_kernel_values(features.nrows());
        let blocks = values.axis_chunks_iter_mut(Axis(0), BLOCK_ROWS);
        for (mut values, points) in blocks.zip(self.blocks(&features)) {
            let sums = self.sums_of(&points, &mut room);
            values.zip_mut_with(&sums.t(), |to, from| *to = from.wide());
            values -= &self.rho;
        }
        values
    }

    /// Returns the position of the class with the most votes for each row of features.
    pub fn winners(&self, features: ArrayView2<f64>, voting: Voting) -> Vec<usize> {
        let elect = |sums: Array2<T>| voting.elect(&sums, self.rho.view(), |_| true);
        let mut room = self.allocate_kernel_values(features.nrows());
        let of_block = |points: CenteredRows<T>| match &self.sums {
            Sums::Support(
                support @ Support {
                    pairs: Some(pairs), ..
                },
            ) => {
                let values = support.kernel_values(&points, &mut room);
                elect_open(pairs.condorcet_winners(values), |open| {
                    let values = values.select(Axis(0), open);
                    elect(weighted_sums(
                        &support.weights,
                        values.view(),
                        self.rho.len(),
                    ))
                })
            }
            // For many rows, the matrix product of all pairs is faster than evaluating a tenth of the pairs one by one.
            Sums::Hyperplanes(normals)
                if voting.multiclass == Multiclass::OneVsOne && points.len() <= FEW_ROWS =>
            {
                let hyperplanes = (normals.view(), self.rho.view());
                elect_open(
                    condorcet_winners_by_hyperplanes(voting.n_classes, hyperplanes, &points),
                    |open| elect(self.sums_of(&points.select(open), &mut room)),
                )
            }
            _ => elect(self.sums_of(&points, &mut room)),
        };
        self.blocks(&features).flat_map(of_block).collect()
    }

    fn blocks<'a>(
        &'a self,
        features: &'a ArrayView2<f64>,
    ) -> impl Iterator<Item = CenteredRows<T>> + 'a {
        features
            .axis_chunks_iter(Axis(0), BLOCK_ROWS)
            .map(|rows| CenteredRows::new(rows, self.centre.view()))
    }

    /// Allocates memory for the kernel values of a block of rows; the memory is reused for all blocks.
    fn allocate_kernel_values(&self, n_rows: usize) -> Array2<T> {
        let n_vectors = match &self.sums {
            Sums::Hyperplanes(_) => 0,
            Sums::Support(support) => support.vectors.len(),
        };
        Array2::zeros((BLOCK_ROWS.min(n_rows), n_vectors))
    }

    /// Returns the sum of weighted kernel values for each problem and row, shape (n_problems, n_rows), stored problem by problem.
    fn sums_of(&self, points: &CenteredRows<T>, room: &mut Array2<T>) -> Array2<T> {
        match &self.sums {
            Sums::Hyperplanes(normals) => {
                let mut sums = Array2::zeros((normals.nrows(), points.len()));
                let (normals, rows) = (normals.view(), points.all().values);
                match points.len() <= FEW_ROWS {
                    true => multiply(rows, normals, sums.view_mut().reversed_axes()),
                    false => multiply(normals, rows, sums.view_mut()),
                }
                sums
            }
            Sums::Support(support) => {
                let values = support.kernel_values(points, room);
                weighted_sums(&support.weights, values, self.rho.len())
            }
        }
    }
}

/// Returns the predicted classes of all rows: the given winners, and for undecided rows the classes that `elect` returns.
fn elect_open(
    mut winners: Vec<Option<usize>>,
    elect: impl FnOnce(&[usize]) -> Vec<usize>,
) -> Vec<usize> {
    let is_open = |row: &usize| winners[*row].is_none();
    let open: Vec<usize> = (0..winners.len()).filter(is_open).collect();
    if !open.is_empty() {
        for (&row, winner) in open.iter().zip(elect(&open)) {
            winners[row] = Some(winner);
        }
    }
    winners.into_iter().flatten().collect()
}

impl<T: Scalar> Support<T> {
    /// Returns the kernel values between the given rows and all support vectors, n_rows × n_vectors.
    fn kernel_values<'a>(
        &self,
        points: &CenteredRows<T>,
        room: &'a mut Array2<T>,
    ) -> ArrayView2<'a, T> {
        let n = points.len();
        let values = room.slice_mut(s![..n, ..]);
        points
            .all()
            .write_kernel(self.vectors.all(), &self.kernel, values);
        room.slice(s![..n, ..])
    }
}
