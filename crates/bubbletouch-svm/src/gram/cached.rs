//! Gram matrix that is computed in parts, because it exceeds the memory limit.

use ndarray::{Array2, Axis};

use super::curvatures::InverseCurvatures;
use super::matrix::{Dense, Gram};
use crate::gram::centered_rows::CenteredRows;
use crate::kernel::KernelFunction;
use crate::linalg::lanes::padded;
use crate::linalg::scalar::Scalar;

/// Gram matrix that exceeds the memory limit: rows are computed on demand, and the most recently used rows are cached.
pub(crate) struct Cached<'a, T> {
    points: &'a CenteredRows<T>,
    kernel: KernelFunction,
    stride: usize,
    diagonal: Vec<T>,
    inverses: InverseCurvatures<T>,
    /// Maximum memory of the cached rows, and of a submatrix, bytes.
    limit: usize,
    rows: Vec<Kept<T>>,
    /// Position in the cache of each row of the Gram matrix; `None` if the row is not cached.
    place: Vec<Option<usize>>,
    n_asked: u64,
}

/// Cached row of the Gram matrix.
struct Kept<T> {
    row: usize,
    last_asked: u64,
    values: Vec<T>,
}

/// Number of rows of the Gram matrix that are computed together for a weighted sum of all rows.
const BLOCK: usize = 256;

impl<'a, T: Scalar> Cached<'a, T> {
    /// Creates the Gram matrix of the given points. The cached rows take at most `limit` bytes, but at least two rows are cached.
    pub fn new(points: &'a CenteredRows<T>, kernel: KernelFunction, limit: usize) -> Self {
        let n = points.len();
        let mut diagonal = points.all().diagonal(&kernel);
        diagonal.resize(padded(n), T::zero());
        let mut inverses = InverseCurvatures::new();
        inverses.renew(usize::MAX, &diagonal);
        Self {
            points,
            kernel,
            stride: padded(n),
            inverses,
            diagonal,
            limit,
            rows: Vec::new(),
            place: vec![None; n],
            n_asked: 0,
        }
    }

    /// Returns the position of row i of the Gram matrix in the cache; computes the row if it is not cached.
    fn fetch(&mut self, i: usize) -> usize {
        self.n_asked += 1;
        let at = match self.place[i] {
            Some(at) => at,
            None => {
                let at = self.make_room();
                let row = self.points.range(i..i + 1);
                let kernel = row.kernel(self.points.all(), &self.kernel);
                let values = &mut self.rows[at].values;
                values.clear();
                values.extend(kernel.iter());
                values.resize(self.stride, T::zero());
                self.rows[at].row = i;
                self.place[i] = Some(at);
                at
            }
        };
        self.rows[at].last_asked = self.n_asked;
        at
    }

    /// Returns a position in the cache for a new row: an empty position, or the position of the least recently used row.
    fn make_room(&mut self) -> usize {
        let most = (self.limit / (self.stride * size_of::<T>()).max(1)).max(2);
        if self.rows.len() < most {
            self.rows.push(Kept {
                row: 0,
                last_asked: 0,
                values: Vec::new(),
            });
            return self.rows.len() - 1;
        }
        let mut oldest = 0;
        for (at, kept) in self.rows.iter().enumerate() {
            if kept.last_asked < self.rows[oldest].last_asked {
                oldest = at;
            }
        }
        self.place[self.rows[oldest].row] = None;
        oldest
    }
}

impl<T: Scalar> Gram<T> for Cached<'_, T> {
    fn len(&self) -> usize {
        self.points.len()
    }

    fn rows(&mut self, i: usize, j: usize) -> (&[T], &[T]) {
        self.fetch(i);
        let at_j = self.fetch(j);
        // Row i was used immediately before row j, so row j has not replaced it.
        let at_i = self.place[i].unwrap_or(at_j);
        (&self.rows[at_i].values, &self.rows[at_j].values)
    }

    fn row_and_diagonal(&mut self, i: usize) -> (&[T], &[T]) {
        let at = self.fetch(i);
        (&self.rows[at].values, &self.diagonal)
    }

    fn inverse_curvatures(&mut self, i: usize) -> &[T] {
        let at = self.fetch(i);
        self.inverses
            .of_row(i, &self.rows[at].values, &self.diagonal)
    }

    fn smallest_curvature(&self) -> T {
        self.inverses.smallest()
    }

    fn times(&mut self, beta: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.points.len()];
        let support: Vec<usize> = (0..beta.len()).filter(|&j| beta[j] != 0.0).collect();
        for block in support.chunks(BLOCK) {
            let rows = self.points.select(block);
            let values: Array2<T> = rows.all().kernel(self.points.all(), &self.kernel);
            for (row, &j) in values.axis_iter(Axis(0)).zip(block) {
                for (sum, value) in sums.iter_mut().zip(row) {
                    *sum += beta[j] * value.wide();
                }
            }
        }
        sums
    }

    fn fits(&self, n: usize) -> bool {
        Dense::<T>::bytes(n) <= self.limit
    }

    fn part(&mut self, indices: &[usize]) -> Dense<T> {
        let some = self.points.select(indices);
        let mut part = Dense::default();
        part.of_whole(some.all().own_kernel(&self.kernel).view());
        part
    }
}
