//! Kernel values between the rows of classes, and the Gram matrices of pairs of classes.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, s};

use crate::gram::matrix::{Gram, GramMemory};
use crate::linalg::products::slices;
use crate::linalg::scalar::Scalar;
use crate::linalg::transposed::write_columns;

/// Minimum number of rows in a group of classes (only the last group can be smaller). With a smaller value, matrix products are inefficient.
const GROUP_ROWS: usize = 512;

/// Divides the classes, given by their row ranges, into groups of at least [`GROUP_ROWS`] rows, except the last group.
pub(crate) fn groups(ranges: &[Range<usize>]) -> Vec<Range<usize>> {
    let mut groups: Vec<Range<usize>> = Vec::new();
    for class in 0..ranges.len() {
        match groups.last_mut() {
            Some(group) if ranges[class].start - ranges[group.start].start < GROUP_ROWS => {
                group.end = class + 1;
            }
            _ => groups.push(class..class + 1),
        }
    }
    groups
}

/// Returns the size in bytes of the kernel values within all groups of classes and between two groups, given the row range of each class.
pub(crate) fn bytes_of_groups<T>(ranges: &[Range<usize>]) -> usize {
    let groups = groups(ranges);
    let size = |group: &Range<usize>| ranges[group.end - 1].end - ranges[group.start].start;
    let sizes = || groups.iter().map(size);
    let squares: usize = sizes().map(|n| n * n).sum();
    let largest = sizes().max().unwrap_or(0);
    (squares + largest * largest) * size_of::<T>()
}

/// Kernel values between two ranges of rows, which are sorted by class.
#[derive(Clone, Copy)]
pub(crate) struct Block<'a, T> {
    values: ArrayView2<'a, T>,
    /// Positions of the first row and of the first column in the sorted order.
    start: [usize; 2],
}

impl<'a, T> Block<'a, T> {
    /// Creates a block, given the positions of its first row and of its first column in the sorted order.
    pub fn new(values: &'a Array2<T>, start: [usize; 2]) -> Self {
        let values = values.view();
        Self { values, start }
    }

    /// Returns the kernel values between two ranges of rows, row by row.
    fn part(&self, rows: &Range<usize>, columns: &Range<usize>) -> Vec<&'a [T]> {
        let [top, left] = self.start;
        let rows = rows.start - top..rows.end - top;
        let columns = columns.start - left..columns.end - left;
        slices(self.values.slice_move(s![rows, columns])).expect("rows of values are contiguous")
    }
}

/// Returns the Gram matrix of two classes, given the ranges of their rows. The blocks contain the kernel values within the first class, within the second class,
/// and between rows of the second and the first class. The transposed values of the last block are written to `above`.
pub(crate) fn gram_of_pair<'a, T: Scalar>(
    [first, second]: [&Range<usize>; 2],
    [own, other, between]: [Block<'a, T>; 3],
    above: &'a mut Vec<T>,
    memory: GramMemory<T>,
) -> Gram<'a, T> {
    let n_first = first.len();
    let (own, other) = (own.part(first, first), other.part(second, second));
    let below = between.part(second, first);
    above.resize(n_first * second.len(), T::zero());
    write_columns(&below, above, second.len());
    let above: &[T] = above;
    let diagonals = [&own, &other].map(|block| block.iter().enumerate().map(|(at, row)| row[at]));
    let diagonal: Vec<T> = diagonals.into_iter().flatten().collect();
    let write = move |i: usize, to: &mut [T]| {
        let n_second = other.len();
        let (left, right) = to.split_at_mut(n_first);
        match i.checked_sub(n_first) {
            None => {
                left.copy_from_slice(own[i]);
                right.copy_from_slice(&above[i * n_second..][..n_second]);
            }
            Some(i) => {
                left.copy_from_slice(below[i]);
                right.copy_from_slice(other[i]);
            }
        }
    };
    Gram::new(diagonal.into_iter(), write, memory)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gram::centered_rows::CenteredRows;
    use crate::kernel::KernelFunction;
    use ndarray::Array1;

    #[test]
    fn rows_of_a_gram_matrix_are_kernel_values_whatever_their_source_and_memory() {
        let rows = Array2::from_shape_fn((23, 4), |(i, j)| ((i * 4 + j) as f64 * 1.7).sin());
        let points = CenteredRows::<f64>::new(rows.view(), Array1::zeros(4).view());
        let kernel = KernelFunction::Rbf { gamma: 0.3 };
        let values = points.all().own_kernel(&kernel);
        let (first, second) = (0..9, 10..23);
        let pair: Vec<usize> = first.clone().chain(second.clone()).collect();
        let own = points.select(&pair);
        let part = own.all().own_kernel(&kernel);
        // Blocks of different matrices: the first rows, and the rows from row 10 on.
        let [above, below] = [&first, &second].map(|rows| points.range(rows.clone()));
        let blocks = [
            above.own_kernel(&kernel),
            below.own_kernel(&kernel),
            below.kernel(above, &kernel),
        ];
        let starts = [[0, 0], [10, 10], [10, 0]];
        let blocks = [0, 1, 2].map(|at| Block::new(&blocks[at], starts[at]));
        let [mut transposed, mut other] = [Vec::new(), Vec::new()];
        let classes = [&first, &second];
        let whole = [Block::new(&values, [0, 0]); 3];
        let beta: Vec<f64> = (0..22).map(|i| f64::from(i % 3) - 1.0).collect();
        let expected = part.dot(&Array1::from(beta.clone()));
        for mut gram in [
            gram_of_pair(classes, whole, &mut transposed, GramMemory::default()),
            gram_of_pair(classes, blocks, &mut other, GramMemory::default()),
            Gram::of_points(&own, kernel, 1),
            Gram::of_points(&own, kernel, usize::MAX),
            Gram::whole(part.view()),
            Gram::whole(values.view()).part(&pair),
        ] {
            assert_eq!(gram.len(), pair.len());
            // Each row is computed, replaced by others, and computed again.
            for i in (0..22).chain([0, 21, 0]) {
                let (row, last) = gram.rows(i, 21);
                assert!((last[i] - part[[21, i]]).abs() < 1e-14);
                let (row, padding) = row.split_at(22);
                let values = row.iter().zip(part.row(i));
                values.for_each(|(a, b)| assert!((a - b).abs() < 1e-14));
                assert!(padding.iter().all(|value| *value == 0.0));
            }
            for (sum, expected) in gram.times(&beta).iter().zip(&expected) {
                assert!((sum - expected).abs() < 1e-13);
            }
        }
    }
}
