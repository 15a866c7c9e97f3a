//! A part of a Gram matrix that is held elsewhere: rows are brought together when the solver first asks for them.

use ndarray::ArrayView2;

use super::gram::{Dense, Gram};
use super::passes::padded;
use super::row_sums::weighted_sum;
use super::runs::Runs;
use crate::recognition::scalar::Scalar;

/// Room for the rows of parts, one part after another.
#[derive(Debug)]
pub(crate) struct Room<T> {
    values: Vec<T>,
    is_here: Vec<bool>,
    diagonal: Vec<T>,
}

impl<T> Room<T> {
    pub fn new() -> Self {
        Self {
            values: Vec::new(),
            is_here: Vec::new(),
            diagonal: Vec::new(),
        }
    }
}

/// K of some rows of a whole matrix (standard layout).
pub(crate) struct Part<'a, T> {
    whole: &'a [T],
    width: usize,
    rows: &'a [usize],
    runs: Runs,
    stride: usize,
    room: &'a mut Room<T>,
}

impl<'a, T: Scalar> Part<'a, T> {
    /// The rows and columns at these indices.
    ///
    /// # Panics
    /// When `whole` is not stored row by row.
    pub fn new(whole: &'a ArrayView2<T>, rows: &'a [usize], room: &'a mut Room<T>) -> Self {
        let width = whole.ncols();
        let whole = whole.as_slice().expect("a product is stored row by row");
        let stride = padded(rows.len());
        room.is_here.clear();
        room.is_here.resize(rows.len(), false);
        if room.values.len() < rows.len() * stride {
            room.values.resize(rows.len() * stride, T::zero());
        }
        room.diagonal.clear();
        room.diagonal
            .extend(rows.iter().map(|&row| whole[row * width + row]));
        room.diagonal.resize(stride, T::zero());
        Self {
            whole,
            width,
            rows,
            runs: Runs::new(rows),
            stride,
            room,
        }
    }

    fn bring(&mut self, i: usize) {
        if self.room.is_here[i] {
            return;
        }
        self.room.is_here[i] = true;
        let from = &self.whole[self.rows[i] * self.width..][..self.width];
        let to = &mut self.room.values[i * self.stride..][..self.stride];
        self.runs.copy(from, to).fill(T::zero());
    }

    fn at(&self, i: usize) -> &[T] {
        &self.room.values[i * self.stride..][..self.stride]
    }
}

impl<T: Scalar> Gram<T> for Part<'_, T> {
    fn len(&self) -> usize {
        self.rows.len()
    }

    fn rows(&mut self, i: usize, j: usize) -> (&[T], &[T]) {
        self.bring(i);
        self.bring(j);
        (self.at(i), self.at(j))
    }

    fn row_and_diagonal(&mut self, i: usize) -> (&[T], &[T]) {
        self.bring(i);
        (self.at(i), &self.room.diagonal)
    }

    fn times(&mut self, beta: &[f64]) -> Vec<f64> {
        (0..beta.len())
            .filter(|&j| beta[j] != 0.0)
            .for_each(|j| self.bring(j));
        weighted_sum(self.rows.len(), beta, |j| self.at(j))
    }

    fn fits(&self, _: usize) -> bool {
        true
    }

    fn part(&mut self, indices: &[usize]) -> Dense<T> {
        let mut part = Dense::default();
        part.refill(indices.len(), |i, to| {
            let from = &self.whole[self.rows[indices[i]] * self.width..][..self.width];
            for (to, &column) in to.iter_mut().zip(indices) {
                *to = from[self.rows[column]];
            }
        });
        part
    }
}
