//! Kernel values between the rows of classes, computed for groups of classes.

use std::ops::Range;

use ndarray::ArrayViewMut2;

use crate::gram::sorted::Sorted;
use crate::linalg::scalar::Scalar;

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

/// Group of classes, with the kernel values between all rows of its classes.
pub(crate) struct Group<'a, T> {
    sorted: &'a Sorted<T>,
    rows: Range<usize>,
    /// Kernel values between all rows of the group, stored row by row.
    own: Vec<T>,
}

impl<'a, T: Scalar> Group<'a, T> {
    /// Creates the group of the given classes and computes the kernel values between its rows.
    pub fn new(sorted: &'a Sorted<T>, classes: &Range<usize>) -> Self {
        let rows = sorted.rows_of(classes);
        let points = sorted.points().range(rows.clone());
        let own = points.own_kernel(&sorted.kernel());
        Self {
            sorted,
            rows,
            own: own.into_raw_vec_and_offset().0,
        }
    }

    /// Returns the size in bytes of the kernel values within all groups of classes and between two groups, given the row range of each class.
    pub fn bytes(ranges: &[Range<usize>]) -> usize {
        let groups = groups(ranges);
        let size = |group: &Range<usize>| ranges[group.end - 1].end - ranges[group.start].start;
        let sizes = || groups.iter().map(size);
        let squares: usize = sizes().map(|n| n * n).sum();
        let largest = sizes().max().unwrap_or(0);
        (squares + largest * largest) * size_of::<T>()
    }

    /// Writes the kernel values between rows of another group and rows of this group into `values`, row by row.
    pub fn with(&self, other: &Self, values: &mut Vec<T>) {
        let size = (other.rows.len(), self.rows.len());
        values.resize(size.0 * size.1, T::zero());
        let values = ArrayViewMut2::from_shape(size, values);
        let values = values.expect("room for all values was made");
        let [own, others] =
            [self, other].map(|group| self.sorted.points().range(group.rows.clone()));
        others.write_kernel(own, &self.sorted.kernel(), values);
    }

    /// Returns the kernel values between some rows and some columns of this group, row by row; `values` starts with row number `first`.
    fn part<'v>(
        &self,
        (values, first): (&'v [T], usize),
        rows: &Range<usize>,
        columns: &Range<usize>,
    ) -> Vec<&'v [T]> {
        let columns = columns.start - self.rows.start..columns.end - self.rows.start;
        let width = self.rows.len();
        let rows = rows.start - first..rows.end - first;
        rows.map(|row| &values[row * width..][columns.clone()])
            .collect()
    }

    /// Returns the kernel values between two ranges of rows of this group of classes, row by row.
    pub fn own_part(&self, rows: &Range<usize>, columns: &Range<usize>) -> Vec<&[T]> {
        self.part((&self.own, self.rows.start), rows, columns)
    }

    /// Returns kernel values between rows of another group and rows of this group, selected from the values computed by `with`.
    pub fn part_with<'v>(
        &self,
        other: &Self,
        values: &'v [T],
        (rows, columns): (&Range<usize>, &Range<usize>),
    ) -> Vec<&'v [T]> {
        self.part((values, other.rows.start), rows, columns)
    }
}
