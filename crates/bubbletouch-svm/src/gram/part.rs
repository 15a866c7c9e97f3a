//! Gram matrix whose values are stored elsewhere; a row is assembled when the solver first requests the row.

use super::curvatures::InverseCurvatures;
use super::matrix::{Dense, Gram, gather};
use super::row_sums::weighted_sum;
use crate::linalg::lanes::padded;
use crate::linalg::scalar::Scalar;

/// Reusable memory for the rows of a submatrix.
#[derive(Debug)]
pub(crate) struct Workspace<T> {
    values: Vec<T>,
    is_here: Vec<bool>,
    diagonal: Vec<T>,
    inverses: InverseCurvatures<T>,
}

impl<T: Scalar> Workspace<T> {
    pub fn new() -> Self {
        Self {
            values: Vec::new(),
            is_here: Vec::new(),
            diagonal: Vec::new(),
            inverses: InverseCurvatures::new(),
        }
    }
}

/// Gram matrix whose rows are assembled from larger matrices by a function when they are first needed.
pub(crate) struct Part<'a, T, F> {
    n: usize,
    stride: usize,
    write: F,
    workspace: &'a mut Workspace<T>,
}

/// Returns the Gram matrix of two classes, given the blocks within each class and both blocks between the classes (first × second and second × first).
pub(crate) fn part_of_blocks<'a, T: Scalar>(
    within: &'a [Vec<&[T]>; 2],
    across: &'a [Vec<&[T]>; 2],
    workspace: &'a mut Workspace<T>,
) -> Part<'a, T, impl Fn(usize, &mut [T])> {
    let n_first = within[0].len();
    let diagonal = within.iter().flat_map(|block| {
        let rows = block.iter().enumerate();
        rows.map(|(at, row)| row[at])
    });
    let write = move |i: usize, to: &mut [T]| {
        let (left, right) = to.split_at_mut(n_first);
        let (side, row) = if i < n_first {
            (0, i)
        } else {
            (1, i - n_first)
        };
        let (own, other) = if side == 0 {
            (left, right)
        } else {
            (right, left)
        };
        own.copy_from_slice(within[side][row]);
        other.copy_from_slice(across[side][row]);
    };
    Part::new(diagonal, write, workspace)
}

impl<'a, T: Scalar, F: FnMut(usize, &mut [T])> Part<'a, T, F> {
    /// Creates a Gram matrix from its diagonal, whose length is the number of rows.
    pub fn new(
        diagonal: impl Iterator<Item = T>,
        write: F,
        workspace: &'a mut Workspace<T>,
    ) -> Self {
        workspace.diagonal.clear();
        workspace.diagonal.extend(diagonal);
        let n = workspace.diagonal.len();
        let stride = padded(n);
        workspace.diagonal.resize(stride, T::zero());
        workspace.is_here.clear();
        workspace.is_here.resize(n, false);
        if workspace.values.len() < n * stride {
            workspace.values.resize(n * stride, T::zero());
        }
        workspace.inverses.renew(n, &workspace.diagonal);
        Self {
            n,
            stride,
            write,
            workspace,
        }
    }

    fn bring(&mut self, i: usize) {
        if self.workspace.is_here[i] {
            return;
        }
        self.workspace.is_here[i] = true;
        let to = &mut self.workspace.values[i * self.stride..][..self.stride];
        let (to, padding) = to.split_at_mut(self.n);
        (self.write)(i, to);
        padding.fill(T::zero());
    }

    fn at(&self, i: usize) -> &[T] {
        &self.workspace.values[i * self.stride..][..self.stride]
    }
}

impl<T: Scalar, F: FnMut(usize, &mut [T])> Gram<T> for Part<'_, T, F> {
    fn len(&self) -> usize {
        self.n
    }

    fn rows(&mut self, i: usize, j: usize) -> (&[T], &[T]) {
        self.bring(i);
        self.bring(j);
        (self.at(i), self.at(j))
    }

    fn row_and_diagonal(&mut self, i: usize) -> (&[T], &[T]) {
        self.bring(i);
        (self.at(i), &self.workspace.diagonal)
    }

    fn inverse_curvatures(&mut self, i: usize) -> &[T] {
        self.bring(i);
        let workspace = &mut *self.workspace;
        let row = &workspace.values[i * self.stride..][..self.stride];
        workspace.inverses.of_row(i, row, &workspace.diagonal)
    }

    fn smallest_curvature(&self) -> T {
        self.workspace.inverses.smallest()
    }

    fn times(&mut self, beta: &[f64]) -> Vec<f64> {
        (0..beta.len())
            .filter(|&j| beta[j] != 0.0)
            .for_each(|j| self.bring(j));
        weighted_sum(self.n, beta, |j| self.at(j))
    }

    fn fits(&self, _: usize) -> bool {
        true
    }

    fn part(&mut self, indices: &[usize]) -> Dense<T> {
        indices.iter().for_each(|&i| self.bring(i));
        let mut part = Dense::default();
        part.refill(indices.len(), |i, to| {
            gather(to, self.at(indices[i]), indices)
        });
        part
    }
}
