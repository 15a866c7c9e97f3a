//! Coefficients of one class's support vectors in all binary problems of the class.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, s};
use serde::{Deserialize, Serialize};

use crate::binary_problem::BinaryProblem;
use crate::gram::sorted::Sorted;
use crate::linalg::scalar::Scalar;

/// Coefficients of the support vectors of one class in all binary problems that contain the class.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "T: Scalar")]
pub(crate) struct ClassWeights<T> {
    /// Range of the support vectors of the class among all support vectors.
    pub vectors: Range<usize>,
    /// Numbers of the binary problems that contain the class, ascending; for one-vs-one, in the order of the other classes.
    pub problems: Vec<usize>,
    /// Coefficients (label times multiplier) of the support vectors in each binary problem, shape (number of problems, number of vectors).
    #[serde(with = "crate::saved")]
    pub coefficients: Array2<T>,
}

impl<V: Scalar> ClassWeights<V> {
    /// Creates coefficients of 0 for one class, in all given binary problems (positive class, negative class) that contain this class.
    pub fn zeros(
        class: usize,
        vectors: Range<usize>,
        problems: impl Iterator<Item = (usize, Option<usize>)>,
    ) -> Self {
        let takes_part = |(positive, negative): (usize, Option<usize>)| {
            negative.is_none_or(|negative| positive == class || negative == class)
        };
        let own = problems.enumerate().filter(|(_, sides)| takes_part(*sides));
        let own: Vec<usize> = own.map(|(problem, _)| problem).collect();
        Self {
            coefficients: Array2::zeros((own.len(), vectors.len())),
            vectors,
            problems: own,
        }
    }

    /// Returns whether the parts have consistent sizes within these numbers of support vectors and problems.
    pub fn fits(&self, n_vectors: usize, n_problems: usize) -> bool {
        let Range { start, end } = self.vectors;
        start <= end
            && end <= n_vectors
            && self.problems.iter().all(|&problem| problem < n_problems)
            && self.coefficients.dim() == (self.problems.len(), end - start)
    }

    /// Creates the coefficients of all training rows of one class.
    pub fn new<T: Scalar>(
        sorted: &Sorted<T>,
        class: usize,
        vectors: Range<usize>,
        problems: &[BinaryProblem],
    ) -> Self {
        let sides = problems.iter().map(|p| (p.positive, p.negative));
        let mut weights = Self::zeros(class, vectors, sides);
        let own = weights.problems.iter();
        for (&problem, mut own) in own.zip(weights.coefficients.rows_mut()) {
            let BinaryProblem { rows, solution, .. } = &problems[problem];
            for (&row, &coefficient) in rows.iter().zip(&solution.coefficients) {
                let at = sorted.place[row];
                if weights.vectors.contains(&at) {
                    own[at - weights.vectors.start] = V::from_f64(coefficient);
                }
            }
        }
        weights
    }

    /// Sets the coefficients of the class in one binary problem, given by its number; does nothing if the class is not in the problem.
    pub fn set(&mut self, problem: usize, coefficients: &[f64]) {
        if let Ok(place) = self.problems.binary_search(&problem) {
            let own = self.coefficients.row_mut(place);
            own.into_iter()
                .zip(coefficients)
                .for_each(|(own, &coefficient)| *own = V::from_f64(coefficient));
        }
    }

    /// Removes the rows whose coefficients are zero in all problems, and appends the row numbers of the other rows to `support`.
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

/// Returns the sum of kernel values times coefficients for each problem and row, shape n_problems × n_rows.
pub(crate) fn weighted_sums<T: Scalar>(
    weights: &[ClassWeights<T>],
    kernel_values: ArrayView2<T>,
    n_problems: usize,
) -> Array2<T> {
    let mut sums = Array2::zeros((n_problems, kernel_values.nrows()));
    for class in weights {
        let own = kernel_values.slice(s![.., class.vectors.clone()]);
        let part = class.coefficients.dot(&own.t());
        for (part, &problem) in part.rows().into_iter().zip(&class.problems) {
            let mut sum = sums.row_mut(problem);
            sum += &part;
        }
    }
    sums
}

impl ClassWeights<f64> {
    /// Adds the support vectors of the class, times their coefficients, to the hyperplane normals of the class's problems (n_problems × m).
    pub fn add_to<T: Scalar>(&self, normals: &mut Array2<f64>, sorted: &Sorted<T>) {
        let points = sorted.points.in_place();
        for (weights, &problem) in self.coefficients.rows().into_iter().zip(&self.problems) {
            let mut normal = normals.row_mut(problem);
            let normal = normal
                .as_slice_mut()
                .expect("normals are stored one by one");
            points.add_weighted(normal, self.vectors.clone().zip(weights.iter().copied()));
        }
    }
}
