//! Kernel values between classes, computed for many classes at once.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, s};

use crate::recognition::packed::Packed;
use crate::recognition::scalar::Scalar;
use crate::recognition::sorted::Sorted;

/// Rows of a group of classes, at least, while classes last: enough that a product's time goes into its multiplications.
pub(crate) const GROUP_ROWS: usize = 512;

/// The classes whose rows these are, in groups of about [`GROUP_ROWS`] rows.
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

/// Each pair of classes, the smaller first, of one group or across two.
pub(crate) fn pairs(
    own: Range<usize>,
    other: Range<usize>,
) -> impl Iterator<Item = (usize, usize)> {
    own.flat_map(move |a| other.clone().filter(move |&b| b > a).map(move |b| (a, b)))
}

/// Kernel values between the rows of a group of classes and those of others, group by group.
pub(crate) struct Between<'a, T> {
    sorted: &'a Sorted<T>,
    columns: Range<usize>,
    packed: Packed<'a, T>,
    rows: Range<usize>,
    values: Array2<T>,
}

impl<'a, T: Scalar> Between<'a, T> {
    /// None yet, of this group with any.
    pub fn new(sorted: &'a Sorted<T>, own: &Range<usize>) -> Self {
        let columns = sorted.rows_of(own);
        Self {
            sorted,
            packed: sorted.points().range(columns.clone()).packed(),
            columns,
            rows: 0..0,
            values: Array2::zeros((0, 0)),
        }
    }

    /// Those with another group or the same, in the memory of the last ones where they are as many.
    pub fn compute(&mut self, other: &Range<usize>) {
        self.rows = self.sorted.rows_of(other);
        let size = (self.rows.len(), self.columns.len());
        if self.values.dim() != size {
            self.values = Array2::zeros(size);
        }
        let points = self.sorted.points();
        let rows = points.range(self.rows.clone());
        if self.rows == self.columns {
            self.packed.multiply_own(self.values.view_mut());
        } else {
            self.packed.multiply(rows.values, self.values.view_mut());
        }
        let columns = points.range(self.columns.clone());
        rows.apply(self.values.view_mut(), columns, &self.sorted.kernel());
    }

    /// Those of some of the other group's rows with some of the own group's.
    pub fn part(&self, rows: &Range<usize>, columns: &Range<usize>) -> ArrayView2<'_, T> {
        let within =
            |of: &Range<usize>, all: &Range<usize>| of.start - all.start..of.end - all.start;
        self.values
            .slice(s![within(rows, &self.rows), within(columns, &self.columns)])
    }
}
