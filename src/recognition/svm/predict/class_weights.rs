//! What the support vectors of one class weigh in its binary problems.

use std::ops::Range;

use ndarray::Array2;

use crate::recognition::svm::BinaryProblem;
use crate::recognition::svm::gram::sorted::Sorted;
use crate::recognition::svm::linalg::scalar::Scalar;

/// The coefficients of one class's support vectors in the problems that the class takes part in.
#[derive(Clone, Debug)]
pub(crate) struct ClassWeights<T> {
    /// Which support vectors.
    pub vectors: Range<usize>,
    /// The problems, ascending: for one-vs-one those with the other classes in order.
    pub problems: Vec<usize>,
    /// problems.len() × vectors.len().
    pub coefficients: Array2<T>,
}

impl<V: Scalar> ClassWeights<V> {
    /// Of all rows of a class.
    pub fn new<T: Scalar>(
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
        let mut coefficients = Array2::zeros((own.len(), vectors.len()));
        for (&problem, mut weights) in own.iter().zip(coefficients.rows_mut()) {
            let BinaryProblem { rows, solution, .. } = &problems[problem];
            for (&row, &coefficient) in rows.iter().zip(&solution.coefficients) {
                let at = sorted.place()[row];
                if vectors.contains(&at) {
                    weights[at - vectors.start] = V::of(coefficient);
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
    pub fn of_support(self, support: &mut Vec<usize>) -> Self {
        let is_support = |at: &usize| {
            self.coefficients
                .column(*at)
                .iter()
                .any(|x| *x != V::zero())
        };
        let kept: Vec<usize> = (0..self.vectors.len()).filter(is_support).collect();
        let first = support.len();
        support.extend(kept.iter().map(|at| self.vectors.start + at));
        let shape = (self.problems.len(), kept.len());
        let coefficients = Array2::from_shape_fn(shape, |(i, j)| self.coefficients[[i, kept[j]]]);
        Self {
            vectors: first..support.len(),
            coefficients,
            ..self
        }
    }
}

impl ClassWeights<f64> {
    /// Adds `Σ y_i a_i x_i` of the class's rows to the normals of its problems (n_problems × m).
    pub fn add_to<T: Scalar>(&self, normals: &mut Array2<f64>, sorted: &Sorted<T>) {
        let points = sorted.points().in_place();
        for (weights, &problem) in self.coefficients.rows().into_iter().zip(&self.problems) {
            let mut normal = normals.row_mut(problem);
            let normal = normal
                .as_slice_mut()
                .expect("normals are stored one by one");
            points.add_weighted(normal, self.vectors.clone().zip(weights.iter().copied()));
        }
    }
}
