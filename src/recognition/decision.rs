//! The decision functions of all binary problems, by matrix products.

use std::ops::Range;

use ndarray::{Array1, Array2, ArrayView2, Axis, s};

use crate::recognition::dataset::Dataset;
use crate::recognition::kernel::KernelFunction;
use crate::recognition::points::Points;
use crate::recognition::scalar::Scalar;
use crate::recognition::svm::BinaryProblem;
use crate::recognition::training::centre;

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
    /// The hyperplanes' normals, m × n_problems.
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
    pub fn new(
        data: &Dataset,
        classes: &[usize],
        kernel: KernelFunction,
        problems: &[BinaryProblem],
    ) -> Self {
        let centre = centre(data.records.view(), &kernel);
        let mut rho: Array1<f64> = problems.iter().map(|p| p.solution.rho).collect();
        let sums = match kernel {
            KernelFunction::Linear => {
                let normals = hyperplanes(data, classes, problems, &centre);
                rho -= &centre.dot(&normals);
                Sums::Hyperplanes(normals.mapv(T::of))
            }
            _ => {
                let mut rows = Vec::new();
                let weights = classes.iter().map(|&class| {
                    let own = Coefficients::new(data, class, problems);
                    let first = rows.len();
                    rows.extend(own.rows);
                    ClassWeights {
                        vectors: first..rows.len(),
                        problems: own.problems,
                        coefficients: own.values.mapv(T::of),
                    }
                });
                let weights = weights.collect();
                let vectors = data.records.select(Axis(0), &rows);
                Sums::SupportVectors(kernel, Points::new(vectors.view(), centre.view()), weights)
            }
        };
        Self { centre, rho, sums }
    }

    /// Decision values of rows (n × m): n × n_problems.
    pub fn values(&self, features: ArrayView2<f64>) -> Array2<f64> {
        let mut values = Array2::zeros((features.nrows(), self.rho.len()));
        for (block, mut values) in features
            .axis_chunks_iter(Axis(0), BLOCK_ROWS)
            .zip(values.axis_chunks_iter_mut(Axis(0), BLOCK_ROWS))
        {
            let points = Points::<T>::new(block, self.centre.view());
            values.zip_mut_with(&self.sums(&points), |to, from| *to = from.wide());
            values -= &self.rho;
        }
        values
    }

    fn sums(&self, points: &Points<T>) -> Array2<T> {
        match &self.sums {
            Sums::Hyperplanes(normals) => points.all().values.dot(normals),
            Sums::SupportVectors(kernel, vectors, weights) => {
                let values = points.all().kernel(vectors.all(), kernel);
                let mut sums = Array2::zeros((points.len(), self.rho.len()));
                for class in weights {
                    let own = values.slice(s![.., class.vectors.clone()]);
                    let part = own.dot(&class.coefficients);
                    for (mut sums, part) in sums.rows_mut().into_iter().zip(part.rows()) {
                        for (&problem, &value) in class.problems.iter().zip(part) {
                            sums[problem] += value;
                        }
                    }
                }
                sums
            }
        }
    }
}

/// The coefficients of one class's rows in the problems that it takes part in.
struct Coefficients {
    /// The class's rows that support some problem, ascending.
    rows: Vec<usize>,
    /// The problems, ascending.
    problems: Vec<usize>,
    /// rows.len() × problems.len().
    values: Array2<f64>,
}

impl Coefficients {
    fn new(data: &Dataset, class: usize, problems: &[BinaryProblem]) -> Self {
        let takes_part = |problem: &BinaryProblem| match problem.negative {
            Some(negative) => problem.positive == class || negative == class,
            None => true,
        };
        let of_class: Vec<usize> = (0..problems.len())
            .filter(|&problem| takes_part(&problems[problem]))
            .collect();
        let own: Vec<usize> = (0..data.targets.len())
            .filter(|&row| data.targets[row] == class)
            .collect();
        let mut position = vec![None; data.targets.len()];
        for (at, &row) in own.iter().enumerate() {
            position[row] = Some(at);
        }
        // Dense, one column a problem; then only rows that support some problem are kept.
        let mut dense = Array2::<f64>::zeros((own.len(), of_class.len()));
        for (column, &problem) in of_class.iter().enumerate() {
            let BinaryProblem { rows, solution, .. } = &problems[problem];
            for (&row, &coefficient) in rows.iter().zip(&solution.coefficients) {
                if let Some(at) = position[row] {
                    dense[[at, column]] = coefficient;
                }
            }
        }
        let support: Vec<usize> = (0..own.len())
            .filter(|&at| dense.row(at).iter().any(|&coefficient| coefficient != 0.0))
            .collect();
        Self {
            rows: support.iter().map(|&at| own[at]).collect(),
            problems: of_class,
            values: dense.select(Axis(0), &support),
        }
    }
}

/// `w = Σ y_i a_i x_i` per problem: m × n_problems. Class by class, each by one matrix product. The rows are taken about
/// the centre: coefficients sum to zero, so that nothing changes but rounding, which the distance to the origin would
/// multiply.
fn hyperplanes(
    data: &Dataset,
    classes: &[usize],
    problems: &[BinaryProblem],
    centre: &Array1<f64>,
) -> Array2<f64> {
    let mut normals = Array2::zeros((problems.len(), data.records.ncols()));
    for &class in classes {
        let own = Coefficients::new(data, class, problems);
        let vectors = data.records.select(Axis(0), &own.rows) - centre;
        let part = own.values.t().dot(&vectors);
        for (part, &problem) in part.rows().into_iter().zip(&own.problems) {
            let mut normal = normals.slice_mut(s![problem, ..]);
            normal += &part;
        }
    }
    normals.reversed_axes()
}
