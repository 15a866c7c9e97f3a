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
