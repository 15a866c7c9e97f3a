//! The decision functions of all binary problems, by matrix products.

use std::borrow::Cow;

use ndarray::{Array1, Array2, ArrayView2, Axis, s};

use crate::recognition::svm::gram::points::Points;
use crate::recognition::svm::gram::sorted::Sorted;
use crate::recognition::svm::kernel::KernelFunction;
use crate::recognition::svm::linalg::packed::Packed;
use crate::recognition::svm::linalg::scalar::Scalar;
use crate::recognition::svm::predict::class_weights::ClassWeights;
use crate::recognition::svm::predict::unbeaten::Pairs;
use crate::recognition::svm::predict::voting::Ballot;
use crate::recognition::svm::{BinaryProblem, Multiclass};

/// Rows whose decision values are computed at once: with 5,000 support vectors their kernel values take 5 MB. Larger
/// leaves the processor's cache, smaller makes the products inefficient.
const BLOCK_ROWS: usize = 256;

/// `Σ y a K(x_i, x) − ρ` for all problems.
#[derive(Clone, Debug)]
pub(crate) struct DecisionFunctions<T> {
    /// Subtracted from support vectors and from rows that are asked for.
    centre: Array1<f64>,
    /// ρ per problem; for a linear kernel, that about the centre.
    rho: Array1<f64>,
    sums: Sums<T>,
}

/// `Σ y a K(x_i, x)`.
#[derive(Clone, Debug)]
enum Sums<T> {
    /// The hyperplanes' normals, n_problems × m.
    Hyperplanes(Array2<T>),
    /// Kernel values, weighted.
    Support(Support<T>),
}

/// Support vectors, class by class.
#[derive(Clone, Debug)]
struct Support<T> {
    kernel: KernelFunction,
    vectors: Points<T>,
    weights: Vec<ClassWeights<T>>,
    /// For one-vs-one.
    pairs: Option<Pairs<T>>,
}

impl<T: Scalar> DecisionFunctions<T> {
    /// Those of the problems that these rows were trained for. Rows that are given away become the support vectors where they
    /// lie; the normals of linear problems' hyperplanes are summed unless they are known.
    pub fn new(
        rows: Cow<Sorted<T>>,
        problems: &[BinaryProblem],
        normals: Option<Array2<T>>,
    ) -> Self {
        let sorted = rows.as_ref();
        let classes = || sorted.classes_and_ranges();
        let centre = sorted.centre().to_owned();
        let (rho, sums) = match sorted.kernel() {
            KernelFunction::Linear => {
                let about_centre = problems.iter().map(|p| sorted.rho_about_centre(p));
                let sum = || {
                    let mut normals = Array2::zeros((problems.len(), sorted.centre().len()));
                    for (class, rows) in classes() {
                        let weights = ClassWeights::new(sorted, class, rows, problems);
                        weights.add_to(&mut normals, sorted);
                    }
                    normals.mapv(T::of)
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
                let are_pairs = problems.iter().all(|p| p.negative.is_some());
                let pairs = are_pairs.then(|| Pairs::new(&weights, &rho));
                let vectors = match rows {
                    Cow::Borrowed(sorted) => sorted.points().select(&support),
                    Cow::Owned(sorted) => sorted.into_points().keep(&support),
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

    /// Decision values of rows (n × m): n × n_problems.
    pub fn values(&self, features: ArrayView2<f64>) -> Array2<f64> {
        let mut values = Array2::zeros((features.nrows(), self.rho.len()));
        let mut room = self.room(features.nrows());
        let blocks = values.axis_chunks_iter_mut(Axis(0), BLOCK_ROWS);
        for (mut values, points) in blocks.zip(self.blocks(&features)) {
            let sums = self.sums_of(&points, &mut room);
            values.zip_mut_with(&sums.t(), |to, from| *to = from.wide());
            values -= &self.rho;
        }
        values
    }

    /// The position of the class that each row's decision values speak for.
    pub fn winners(
        &self,
        features: ArrayView2<f64>,
        (n_classes, multiclass): (usize, Multiclass),
    ) -> Vec<usize> {
        let problems = multiclass.problems(n_classes);
        let elect = |sums: Array2<T>| {
            let mut ballot = Ballot::new(n_classes, sums.ncols(), multiclass);
            for ((&problem, sums), &rho) in problems.iter().zip(sums.rows()).zip(&self.rho) {
                let sums = sums.to_slice().expect("sums are stored problem by problem");
                ballot.take(problem, sums, rho);
            }
            ballot.winners()
        };
        let mut room = self.room(features.nrows());
        let of_block = |points| match &self.sums {
            Sums::Support(
                support @ Support {
                    pairs: Some(pairs), ..
                },
            ) => {
                let values = support.kernel_values(&points, &mut room);
                let mut winners = pairs.unbeaten(values);
                let open: Vec<usize> = (0..winners.len())
                    .filter(|row| winners[*row].is_none())
                    .collect();
                let values = values.select(Axis(0), &open);
                let elected = elect(support.sums(values.view(), problems.len()));
                for (row, winner) in open.into_iter().zip(elected) {
                    winners[row] = Some(winner);
                }
                winners.into_iter().flatten().collect()
            }
            _ => elect(self.sums_of(&points, &mut room)),
        };
        self.blocks(&features).flat_map(of_block).collect()
    }

    fn blocks<'a>(&'a self, features: &'a ArrayView2<f64>) -> impl Iterator<Item = Points<T>> + 'a {
        features
            .axis_chunks_iter(Axis(0), BLOCK_ROWS)
            .map(|rows| Points::new(rows, self.centre.view()))
    }

    fn room(&self, n_rows: usize) -> Room<'_, T> {
        let (packed, n_vectors) = match &self.sums {
            Sums::Hyperplanes(_) => (None, 0),
            Sums::Support(support) => {
                let vectors = &support.vectors;
                (Some(vectors.all().packed()), vectors.len())
            }
        };
        Room {
            packed,
            values: Array2::zeros((BLOCK_ROWS.min(n_rows), n_vectors)),
        }
    }

    /// `Σ y a K(x_i, x)` of some rows: n_problems × rows, so that all rows of a problem lie side by side.
    fn sums_of(&self, points: &Points<T>, room: &mut Room<T>) -> Array2<T> {
        match &self.sums {
            Sums::Hyperplanes(normals) => {
                let mut sums = Array2::zeros((normals.nrows(), points.len()));
                let packed = points.all().packed();
                packed.multiply(normals.view(), sums.view_mut());
                sums
            }
            Sums::Support(support) => {
                support.sums(support.kernel_values(points, room), self.rho.len())
            }
        }
    }
}

/// What all blocks of rows need.
struct Room<'a, T> {
    /// The support vectors, if there are any.
    packed: Option<Packed<'a, T>>,
    /// Room for a block's kernel values: written over and over, so that its memory is asked for once.
    values: Array2<T>,
}

impl<T: Scalar> Support<T> {
    /// `K(x, x_i)`: rows × vectors.
    fn kernel_values<'a>(&self, points: &Points<T>, room: &'a mut Room<T>) -> ArrayView2<'a, T> {
        let n = points.len();
        let mut values = room.values.slice_mut(s![..n, ..]);
        let points = points.all();
        if let Some(packed) = &room.packed {
            packed.multiply(points.values, values.view_mut());
        }
        points.apply(values.view_mut(), self.vectors.all(), &self.kernel);
        room.values.slice(s![..n, ..])
    }

    /// `Σ y a K(x_i, x)` from kernel values (rows × vectors): n_problems × rows.
    fn sums(&self, kernel_values: ArrayView2<T>, n_problems: usize) -> Array2<T> {
        let mut sums = Array2::zeros((n_problems, kernel_values.nrows()));
        for class in &self.weights {
            let own = kernel_values.slice(s![.., class.vectors.clone()]);
            let part = class.coefficients.dot(&own.t());
            for (part, &problem) in part.rows().into_iter().zip(&class.problems) {
                let mut sum = sums.row_mut(problem);
                sum += &part;
            }
        }
        sums
    }
}
