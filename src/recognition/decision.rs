//! The decision functions of all binary problems, by matrix products.

use std::ops::Range;

use ndarray::{Array1, Array2, ArrayView2, Axis, s};

use crate::recognition::kernel::KernelFunction;
use crate::recognition::points::Points;
use crate::recognition::scalar::Scalar;
use crate::recognition::sorted::Sorted;
use crate::recognition::svm::{BinaryProblem, Multiclass};
use crate::recognition::voting::Ballot;

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
    /// Support vectors, class by class, and what they weigh.
    SupportVectors(KernelFunction, Points<T>, Vec<ClassWeights<T>>),
}

/// The coefficients of one class's support vectors in the problems that the class takes part in.
#[derive(Clone, Debug)]
struct ClassWeights<T> {
    /// Which support vectors.
    vectors: Range<usize>,
    /// The problems, ascending.
    problems: Vec<usize>,
    /// vectors.len() × problems.len().
    coefficients: Array2<T>,
}

impl<T: Scalar> DecisionFunctions<T> {
    /// Those of the problems that these rows were trained for.
    pub fn new(sorted: &Sorted<T>, problems: &[BinaryProblem]) -> Self {
        let classes = || sorted.classes_and_ranges();
        let (rho, sums) = match sorted.kernel() {
            KernelFunction::Linear => {
                let about_centre = problems.iter().map(|p| sorted.rho_about_centre(p));
                let mut normals = Array2::zeros((problems.len(), sorted.centre().len()));
                for (class, rows) in classes() {
                    ClassWeights::new(sorted, class, rows, problems).add_to(&mut normals, sorted);
                }
                (
                    about_centre.collect(),
                    Sums::Hyperplanes(normals.mapv(T::of)),
                )
            }
            kernel => {
                let mut support = Vec::new();
                let weights = classes().map(|(class, rows)| {
                    ClassWeights::new(sorted, class, rows, problems).of_support(&mut support)
                });
                let weights = weights.collect();
                let vectors = sorted.points().select(&support);
                let rho = problems.iter().map(|p| p.solution.rho).collect();
                (rho, Sums::SupportVectors(kernel, vectors, weights))
            }
        };
        let centre = sorted.centre().to_owned();
        Self { centre, rho, sums }
    }

    /// Decision values of rows (n × m): n × n_problems.
    pub fn values(&self, features: ArrayView2<f64>) -> Array2<f64> {
        let mut values = Array2::zeros((features.nrows(), self.rho.len()));
        let blocks = values.axis_chunks_iter_mut(Axis(0), BLOCK_ROWS);
        for (mut values, sums) in blocks.zip(self.sums(&features)) {
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
        let of_block = |sums: Array2<T>| {
            let mut ballot = Ballot::new(n_classes, sums.ncols(), multiclass);
            for ((&problem, sums), &rho) in problems.iter().zip(sums.rows()).zip(&self.rho) {
                let sums = sums.to_slice().expect("sums are stored problem by problem");
                ballot.take(problem, sums, rho);
            }
            ballot.winners()
        };
        self.sums(&features).flat_map(of_block).collect()
    }

    /// `Σ y a K(x_i, x)` of blocks of rows: n_problems × rows, so that all rows of a problem lie side by side.
    fn sums<'a>(&'a self, features: &'a ArrayView2<f64>) -> impl Iterator<Item = Array2<T>> + 'a {
        let n_blocks = features.nrows().div_ceil(BLOCK_ROWS);
        // Kernel values of a block: written over and over, so that their memory is asked for once.
        let mut scratch = Array2::zeros((self.n_vectors(), BLOCK_ROWS.min(features.nrows())));
        (0..n_blocks).map(move |block| {
            let end = features.nrows().min((block + 1) * BLOCK_ROWS);
            let rows = features.slice(s![block * BLOCK_ROWS..end, ..]);
            self.sums_of(&Points::new(rows, self.centre.view()), &mut scratch)
        })
    }

    fn n_vectors(&self) -> usize {
        match &self.sums {
            Sums::Hyperplanes(_) => 0,
            Sums::SupportVectors(_, vectors, _) => vectors.len(),
        }
    }

    fn sums_of(&self, points: &Points<T>, scratch: &mut Array2<T>) -> Array2<T> {
        match &self.sums {
            Sums::Hyperplanes(normals) => normals.dot(&points.all().values.t()),
            Sums::SupportVectors(kernel, vectors, weights) => {
                let mut values = scratch.slice_mut(s![.., ..points.len()]);
                vectors
                    .all()
                    .kernel_into(points.all(), kernel, values.view_mut());
                let mut sums = Array2::zeros((self.rho.len(), points.len()));
                for class in weights {
                    let own = values.slice(s![class.vectors.clone(), ..]);
                    let part = class.coefficients.t().dot(&own);
                    for (part, &problem) in part.rows().into_iter().zip(&class.problems) {
                        let mut sum = sums.row_mut(problem);
                        sum += &part;
                    }
                }
                sums
            }
        }
    }
}

impl<V: Scalar> ClassWeights<V> {
    /// Of all rows of a class.
    fn new<T: Scalar>(
        sorted: &Sorted<T>,
        class: usize,
        vectors: Range<usize>,
        problems: &[BinaryProblem],
    ) -> Self {
        let takes_part = |problem: &BinaryProblem| match problem.negative {
            Some(negative) => problem.positive == class || negative == class,
            None => true,
        };
        let own: Vec<usize> = (0..problems.len())
            .filter(|&problem| takes_part(&problems[problem]))
            .collect();
        let mut coefficients = Array2::zeros((vectors.len(), own.len()));
        for (&problem, mut column) in own.iter().zip(coefficients.columns_mut()) {
            let BinaryProblem { rows, solution, .. } = &problems[problem];
            for (&row, &coefficient) in rows.iter().zip(&solution.coefficients) {
                let at = sorted.place()[row];
                if vectors.contains(&at) {
                    column[at - vectors.start] = V::of(coefficient);
                }
            }
        }
        Self {
            vectors,
            problems: own,
            coefficients,
        }
    }

    /// Only of the rows that support some problem, appended to those of the classes before.
    fn of_support(self, support: &mut Vec<usize>) -> Self {
        let is_support = |at: &usize| self.coefficients.row(*at).iter().any(|x| *x != V::zero());
        let kept: Vec<usize> = (0..self.vectors.len()).filter(is_support).collect();
        let first = support.len();
        support.extend(kept.iter().map(|at| self.vectors.start + at));
        Self {
            vectors: first..support.len(),
            coefficients: self.coefficients.select(Axis(0), &kept),
            ..self
        }
    }
}

impl ClassWeights<f64> {
    /// Adds `Σ y_i a_i x_i` of the class's rows to the normals of its problems (n_problems × m).
    fn add_to<T: Scalar>(&self, normals: &mut Array2<f64>, sorted: &Sorted<T>) {
        let points = sorted.points().in_place();
        for (column, &problem) in self.coefficients.columns().into_iter().zip(&self.problems) {
            let mut normal = normals.row_mut(problem);
            let normal = normal
                .as_slice_mut()
                .expect("normals are stored one by one");
            points.add_weighted(normal, self.vectors.clone().zip(column.iter().copied()));
        }
    }
}
