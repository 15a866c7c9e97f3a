//! Gram matrix of a binary problem: a row is computed when it is first needed, and kept within a memory limit.

use ndarray::{ArrayView2, Axis};

use super::curvatures::InverseCurvatures;
use super::row_sums::{support, weighted_sum};
use crate::gram::centered_rows::CenteredRows;
use crate::kernel::KernelFunction;
use crate::linalg::lanes::padded;
use crate::linalg::scalar::Scalar;

/// Number of rows that are computed together for a weighted sum of rows that exceed the memory limit.
const BLOCK: usize = 256;

/// Gram matrix K of a binary problem, n × n, symmetric and positive semidefinite. Rows are padded with zeros to whole lanes.
pub(crate) struct Gram<'a, T> {
    n: usize,
    stride: usize,
    source: Source<'a, T>,
    /// Maximum memory of the kept rows, and of a submatrix, bytes.
    limit: usize,
    memory: GramMemory<T>,
}

/// Function that writes the values of a row, given its index.
type RowFunction<'a, T> = Box<dyn FnMut(usize, &mut [T]) + 'a>;

/// Origin of the rows of a Gram matrix.
enum Source<'a, T> {
    /// All rows are kept from the beginning.
    Kept,
    /// Function that writes the n values of a row, given its index.
    Function(RowFunction<'a, T>),
    /// Points whose kernel values exceed the memory limit.
    Points(&'a CenteredRows<T>, KernelFunction),
}

/// Memory of a Gram matrix, which successive matrices reuse.
#[derive(Debug, Default)]
pub(crate) struct GramMemory<T> {
    /// Values of the kept rows.
    values: Vec<T>,
    kept: Vec<KeptRow>,
    /// Position of each row among the kept rows; `None` if the row is not kept.
    place: Vec<Option<usize>>,
    n_asked: u64,
    diagonal: Vec<T>,
    inverses: InverseCurvatures<T>,
}

/// Row at one position of the memory, with the number of the request that used it last.
#[derive(Debug)]
struct KeptRow {
    row: usize,
    last_asked: u64,
}

impl<'a, T: Scalar> Gram<'a, T> {
    /// Returns the size in bytes of a matrix of n rows.
    pub fn bytes(n: usize) -> usize {
        n * padded(n) * size_of::<T>()
    }

    /// Creates a Gram matrix from its diagonal, whose length is the number of rows n, and a function that writes the n values of a row.
    pub fn new(
        diagonal: impl Iterator<Item = T>,
        write: impl FnMut(usize, &mut [T]) + 'a,
        memory: GramMemory<T>,
    ) -> Self {
        let source = Source::Function(Box::new(write));
        Self::from_source(source, diagonal, usize::MAX, memory)
    }

    /// Creates the Gram matrix of the given points. The kept rows take at most `limit` bytes, but at least two rows are kept.
    pub fn of_points(points: &'a CenteredRows<T>, kernel: KernelFunction, limit: usize) -> Self {
        let diagonal = points.all().diagonal(&kernel).into_iter();
        let source = Source::Points(points, kernel);
        Self::from_source(source, diagonal, limit, GramMemory::default())
    }

    /// Creates a Gram matrix that contains all given kernel values, n × n.
    pub fn whole(values: ArrayView2<T>) -> Self {
        let write = |i: usize, to: &mut [T]| {
            let row = to.iter_mut().zip(values.row(i));
            row.for_each(|(to, &value)| *to = value);
        };
        Gram::new(values.diag().iter().copied(), write, GramMemory::default()).kept()
    }

    fn from_source(
        source: Source<'a, T>,
        diagonal: impl Iterator<Item = T>,
        limit: usize,
        mut memory: GramMemory<T>,
    ) -> Self {
        memory.diagonal.clear();
        memory.diagonal.extend(diagonal);
        let n = memory.diagonal.len();
        let stride = padded(n);
        memory.diagonal.resize(stride, T::zero());
        memory.kept.clear();
        memory.place.clear();
        memory.place.resize(n, None);
        // Without a memory limit, the inverse curvatures of all rows are kept, too.
        let n_inverses = if limit == usize::MAX { n } else { usize::MAX };
        memory.inverses.renew(n_inverses, &memory.diagonal);
        let gram = Self {
            n,
            stride,
            source,
            limit,
            memory,
        };
        gram.with_capacity()
    }

    /// Returns the matrix after all its rows were computed, so that their source is not needed any more.
    fn kept<'b>(mut self) -> Gram<'b, T> {
        for i in 0..self.n {
            self.bring(i);
        }
        Gram {
            n: self.n,
            stride: self.stride,
            source: Source::Kept,
            limit: self.limit,
            memory: self.memory,
        }
    }

    /// Returns the memory, for another matrix.
    pub fn into_memory(self) -> GramMemory<T> {
        self.memory
    }

    /// Returns the number of rows n.
    pub fn len(&self) -> usize {
        self.n
    }

    /// Returns the maximum number of rows that are kept.
    fn capacity(&self) -> usize {
        let bytes_per_row = (self.stride * size_of::<T>()).max(1);
        (self.limit / bytes_per_row).max(2).min(self.n)
    }

    /// Allocates the memory of the rows that may be kept.
    fn with_capacity(mut self) -> Self {
        let n_values = self.capacity() * self.stride;
        if self.memory.values.len() < n_values {
            self.memory.values = vec![T::zero(); n_values];
        }
        self
    }

    /// Returns the position of row i among the kept rows; computes the row if it is not kept.
    #[inline(always)]
    fn bring(&mut self, i: usize) -> usize {
        let at = match self.memory.place[i] {
            Some(at) => at,
            None => self.compute(i),
        };
        self.memory.n_asked += 1;
        self.memory.kept[at].last_asked = self.memory.n_asked;
        at
    }

    /// Computes row i at an empty position, or at the position of the least recently used row. Returns the position.
    #[inline(never)]
    fn compute(&mut self, i: usize) -> usize {
        let capacity = self.capacity();
        let memory = &mut self.memory;
        let mut at = memory.kept.len();
        let row = KeptRow {
            row: i,
            last_asked: 0,
        };
        if at < capacity {
            memory.kept.push(row);
        } else {
            let kept = memory.kept.iter().enumerate();
            let oldest = kept.min_by_key(|(_, kept)| kept.last_asked);
            at = oldest.map_or(0, |(at, _)| at);
            let replaced = std::mem::replace(&mut memory.kept[at], row);
            memory.place[replaced.row] = None;
        }
        memory.place[i] = Some(at);
        let to = &mut memory.values[at * self.stride..][..self.stride];
        let (to, padding) = to.split_at_mut(self.n);
        match &mut self.source {
            Source::Kept => unreachable!("all rows are kept"),
            Source::Function(write) => write(i, to),
            Source::Points(points, kernel) => {
                let values = points.range(i..i + 1).kernel(points.all(), kernel);
                let values = to.iter_mut().zip(&values);
                values.for_each(|(to, &value)| *to = value);
            }
        }
        padding.fill(T::zero());
        at
    }

    /// Returns the kept row at a position.
    #[inline(always)]
    fn at(&self, at: usize) -> &[T] {
        &self.memory.values[at * self.stride..][..self.stride]
    }

    /// Returns row i of the Gram matrix, padded to whole lanes.
    #[inline(always)]
    pub fn row(&mut self, i: usize) -> &[T] {
        let at = self.bring(i);
        self.at(at)
    }

    /// Returns rows i and j of the Gram matrix.
    #[inline(always)]
    pub fn rows(&mut self, i: usize, j: usize) -> (&[T], &[T]) {
        // At least two rows are kept, so row j does not replace row i.
        let (at_i, at_j) = (self.bring(i), self.bring(j));
        (self.at(at_i), self.at(at_j))
    }

    /// Returns the entry K_ii of the diagonal.
    #[inline(always)]
    pub fn diagonal(&self, i: usize) -> T {
        self.memory.diagonal[i]
    }

    /// Returns the curvature `K_ii + K_jj − 2 K_ij` of the dual objective along a pair of variables; at least the minimum curvature.
    #[inline(always)]
    pub fn curvature(&mut self, i: usize, j: usize) -> f64 {
        let sum = (self.diagonal(i) + self.diagonal(j)).wide();
        let curvature = sum - 2.0 * self.row(i)[j].wide();
        curvature.max(self.memory.inverses.smallest().wide())
    }

    /// Returns the inverse curvatures of the pairs (i, j) of variables, for all j.
    #[inline(always)]
    pub fn inverse_curvatures(&mut self, i: usize) -> &[T] {
        let at = self.bring(i);
        let memory = &mut self.memory;
        let row = &memory.values[at * self.stride..][..self.stride];
        memory.inverses.of_row(i, row, &memory.diagonal)
    }

    /// Returns the product Kβ of the Gram matrix and the coefficients, summed in f64 (n values).
    pub fn times(&mut self, beta: &[f64]) -> Vec<f64> {
        let support = support(beta);
        if let Source::Points(points, kernel) = &self.source {
            let mut sums = vec![0.0; self.n];
            for block in support.chunks(BLOCK) {
                let values = points.select(block).all().kernel(points.all(), kernel);
                for (row, &j) in values.axis_iter(Axis(0)).zip(block) {
                    for (sum, value) in sums.iter_mut().zip(row) {
                        *sum += beta[j] * value.wide();
                    }
                }
            }
            return sums;
        }
        for &j in &support {
            self.bring(j);
        }
        let row = |j: usize| self.at(self.memory.place[j].expect("the row was computed above"));
        weighted_sum(self.n, (&support, beta), row)
    }

    /// Subtracts the product of the Gram matrix K with the coefficients β from the vector f.
    pub fn take_times(&mut self, beta: &[f64], f: &mut [f64]) {
        for (f, product) in f.iter_mut().zip(self.times(beta)) {
            *f -= product;
        }
    }

    /// Returns whether a submatrix of n rows fits into the memory limit.
    pub fn fits(&self, n: usize) -> bool {
        Self::bytes(n) <= self.limit
    }

    /// Returns the submatrix of the rows and columns with the given indices.
    pub fn part<'b>(&mut self, indices: &[usize]) -> Gram<'b, T> {
        if let Source::Points(points, kernel) = &self.source {
            return Gram::whole(points.select(indices).all().own_kernel(kernel).view());
        }
        let diagonal: Vec<T> = indices.iter().map(|&i| self.diagonal(i)).collect();
        let write = |i: usize, to: &mut [T]| gather(to, self.row(indices[i]), indices);
        Gram::new(diagonal.into_iter(), write, GramMemory::default()).kept()
    }
}

/// Copies the entries of a row with the given column indices.
pub(crate) fn gather<T: Copy>(to: &mut [T], from: &[T], columns: &[usize]) {
    for (to, &column) in to.iter_mut().zip(columns) {
        *to = from[column];
    }
}
