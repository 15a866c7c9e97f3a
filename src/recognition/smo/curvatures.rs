//! The inverse of the dual objective's curvature along the lines that move two variables, row by row of the Gram matrix.
//!
//! The same rows are asked for again and again: at every C, and in cross-validation in every fold.

use crate::recognition::scalar::Scalar;

/// Curvature along a pair's line, at least, relative to the Gram matrix's largest entry: equal rows with unequal labels
/// have none.
const SMALLEST_CURVATURE: f64 = 1e-12;

/// The smallest curvature that counts, given the diagonal.
pub(super) fn smallest<T: Scalar>(diagonal: &[T]) -> T {
    let largest = diagonal.iter().fold(T::zero(), |a, &b| a.max(b));
    (T::of(SMALLEST_CURVATURE) * largest).max(T::min_positive_value())
}

/// Rows of inverse curvatures, each computed when it is first asked for.
#[derive(Clone, Debug)]
pub(super) struct InverseCurvatures<T> {
    values: Vec<T>,
    is_here: Vec<bool>,
    smallest: T,
}

impl<T: Scalar> InverseCurvatures<T> {
    pub fn new() -> Self {
        Self {
            values: Vec::new(),
            is_here: Vec::new(),
            smallest: T::zero(),
        }
    }

    /// Of another matrix of n rows, with this diagonal, padded like a row; in the memory of the last.
    pub fn renew(&mut self, n: usize, diagonal: &[T]) {
        self.is_here.clear();
        self.is_here.resize(n, false);
        if self.values.len() < n * diagonal.len() {
            self.values.resize(n * diagonal.len(), T::zero());
        }
        self.smallest = smallest(diagonal);
    }

    /// The smallest curvature that counts.
    pub fn smallest(&self) -> T {
        self.smallest
    }

    /// Those along the lines of i and each other, given row i and the diagonal.
    #[inline(always)]
    pub fn of_row(&mut self, i: usize, row: &[T], diagonal: &[T]) -> &[T] {
        let values = &mut self.values[i * diagonal.len()..][..diagonal.len()];
        if !self.is_here[i] {
            self.is_here[i] = true;
            write(values, (row, diagonal), (diagonal[i], self.smallest));
        }
        values
    }
}

/// `1 / (K_ii + K_jj − 2 K_ij)`, the curvature at least the smallest.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub(super) fn write<T: Scalar>(
    to: &mut [T],
    (row, diagonal): (&[T], &[T]),
    (own, smallest): (T, T),
) {
    let n = to.len();
    let (row, diagonal) = (&row[..n], &diagonal[..n]);
    let two = T::one() + T::one();
    for at in 0..n {
        let curvature = own + diagonal[at] - two * row[at];
        let curvature = if curvature > smallest {
            curvature
        } else {
            smallest
        };
        to[at] = T::one() / curvature;
    }
}
