//! Interface of the solver to a Gram matrix: pairs of rows, the diagonal, weighted sums of rows, and submatrices.

use ndarray::{ArrayView1, ArrayView2, ArrayViewMut2, s};

use super::curvatures::InverseCurvatures;
use super::row_sums::weighted_sum;
use crate::linalg::lanes::padded;
use crate::linalg::scalar::Scalar;
use crate::linalg::transposed::write_columns;

/// Gram matrix K of a binary problem, n × n, symmetric and positive semidefinite. Rows are padded with zeros to whole lanes.
pub(crate) trait Gram<T> {
    /// Returns the number of rows n.
    fn len(&self) -> usize;
    /// Returns rows i and j of the Gram matrix.
    fn rows(&mut self, i: usize, j: usize) -> (&[T], &[T]);
    /// Returns row i and the diagonal of the Gram matrix, both padded to whole lanes.
    fn row_and_diagonal(&mut self, i: usize) -> (&[T], &[T]);
    /// Returns the inverse curvatures `1 / (K_ii + K_jj − 2 K_ij)` of the pairs (i, j) of variables, for all j. Smaller curvatures are replaced by the minimum
    /// curvature.
    fn inverse_curvatures(&mut self, i: usize) -> &[T];
    /// Returns the minimum curvature that a pairwise step assumes for a pair of variables.
    fn smallest_curvature(&self) -> T;
    /// Returns the product Kβ of the Gram matrix and the coefficients, summed in f64 (n values).
    fn times(&mut self, beta: &[f64]) -> Vec<f64>;
    /// Subtracts the product of the Gram matrix K with the coefficients β from the vector f.
    fn take_times(&mut self, beta: &[f64], f: &mut [f64]) {
        for (f, product) in f.iter_mut().zip(self.times(beta)) {
            *f -= product;
        }
    }
    /// Returns whether a Gram matrix of n rows fits into the memory limit.
    fn fits(&self, n: usize) -> bool;
    /// Returns the submatrix of the rows and columns with the given indices.
    fn part(&mut self, indices: &[usize]) -> Dense<T>;
}

/// Gram matrix that is stored completely in memory.
#[derive(Clone, Debug)]
pub(crate) struct Dense<T> {
    n: usize,
    stride: usize,
    /// Matrix values, row by row; each row is padded to `stride` values.
    values: Vec<T>,
    diagonal: Vec<T>,
    inverses: InverseCurvatures<T>,
}

impl<T: Scalar> Default for Dense<T> {
    /// Creates an empty matrix.
    fn default() -> Self {
        Self {
            n: 0,
            stride: 0,
            values: Vec::new(),
            diagonal: Vec::new(),
            inverses: InverseCurvatures::new(),
        }
    }
}

impl<T: Scalar> Dense<T> {
    /// Returns the size in bytes of a matrix of n rows.
    pub fn bytes(n: usize) -> usize {
        n * padded(n) * size_of::<T>()
    }

    /// Changes the number of rows to n, computes all entries by `fill`, and reuses the allocated memory. The function `fill` writes the n values of each row;
    /// the caller must write the values that `fill` skips.
    pub fn refill(&mut self, n: usize, mut fill: impl FnMut(usize, &mut [T])) {
        self.n = n;
        self.stride = padded(n);
        self.values.resize(n * self.stride, T::zero());
        for (i, row) in self.values.chunks_exact_mut(self.stride.max(1)).enumerate() {
            fill(i, &mut row[..n]);
            row[n..].fill(T::zero());
        }
        self.diagonal.clear();
        self.diagonal
            .extend((0..n).map(|i| self.values[i * self.stride + i]));
        self.diagonal.resize(self.stride, T::zero());
        self.inverses.renew(n, &self.diagonal);
    }

    /// Copies all values of the given kernel matrix, n × n.
    pub fn of_whole(&mut self, whole: ArrayView2<T>) {
        self.refill(whole.nrows(), |i, to| copy(to, whole.row(i)));
    }

    /// Builds the Gram matrix of two groups of rows from its four blocks. The blocks within the groups are given; `write` computes the block between the second
    /// and the first group.
    pub fn of_blocks(
        &mut self,
        [own, others]: [ArrayView2<T>; 2],
        write: impl FnOnce(ArrayViewMut2<T>),
    ) {
        let n_first = own.nrows();
        self.refill(n_first + others.nrows(), |at, to| {
            let (left, right) = to.split_at_mut(n_first);
            match at.checked_sub(n_first) {
                None => copy(left, own.row(at)),
                Some(at) => copy(right, others.row(at)),
            }
        });
        let (above, below) =
            self.values[..self.n * self.stride].split_at_mut(n_first * self.stride);
        let shape = (others.nrows(), self.stride);
        let both = ArrayViewMut2::from_shape(shape, &mut *below);
        let both = both.expect("there is room for all rows");
        write(both.slice_move(s![.., ..n_first]));
        let rows = below.chunks_exact(self.stride.max(1));
        let rows: Vec<&[T]> = rows.map(|row| &row[..n_first]).collect();
        if n_first > 0 {
            write_columns(&rows, &mut above[n_first..], self.stride);
        }
    }

    /// Returns a row of the matrix.
    #[inline(always)]
    pub fn row(&self, i: usize) -> &[T] {
        &self.values[i * self.stride..(i + 1) * self.stride]
    }
}

/// Copies one row of a matrix into a slice.
fn copy<T: Copy>(to: &mut [T], from: ArrayView1<T>) {
    match from.as_slice() {
        Some(from) => to.copy_from_slice(from),
        None => to.iter_mut().zip(from).for_each(|(to, &from)| *to = from),
    }
}

impl<T: Scalar> Gram<T> for Dense<T> {
    fn len(&self) -> usize {
        self.n
    }

    #[inline(always)]
    fn rows(&mut self, i: usize, j: usize) -> (&[T], &[T]) {
        (self.row(i), self.row(j))
    }

    #[inline(always)]
    fn row_and_diagonal(&mut self, i: usize) -> (&[T], &[T]) {
        (self.row(i), &self.diagonal)
    }

    #[inline(always)]
    fn inverse_curvatures(&mut self, i: usize) -> &[T] {
        let row = &self.values[i * self.stride..(i + 1) * self.stride];
        self.inverses.of_row(i, row, &self.diagonal)
    }

    #[inline(always)]
    fn smallest_curvature(&self) -> T {
        self.inverses.smallest()
    }

    fn times(&mut self, beta: &[f64]) -> Vec<f64> {
        weighted_sum(self.n, beta, |j| self.row(j))
    }

    fn fits(&self, _: usize) -> bool {
        true
    }

    fn part(&mut self, indices: &[usize]) -> Self {
        let mut part = Self::default();
        part.refill(indices.len(), |i, to| {
            gather(to, self.row(indices[i]), indices)
        });
        part
    }
}

/// Copies the entries of a row with the given column indices.
pub(crate) fn gather<T: Copy>(to: &mut [T], from: &[T], columns: &[usize]) {
    for (to, &column) in to.iter_mut().zip(columns) {
        *to = from[column];
    }
}
