//! Kernel values between classes, computed for many classes at once.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, s};

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

/// Kernel values between the rows of two groups of classes.
pub(crate) struct Between<T> {
    rows: Range<usize>,
    columns: Range<usize>,
    values: Array2<T>,
}

impl<T: Scalar> Default for Between<T> {
    fn default() -> Self {
        Self {
            rows: 0..0,
            columns: 0..0,
            values: Array2::zeros((0, 0)),
        }
    }
}

impl<T: Scalar> Between<T> {
    /// Those of two groups, in the memory of the last ones where they are as many.
    pub fn compute(&mut self, sorted: &Sorted<T>, own: &Range<usize>, other: &Range<usize>) {
        self.rows = sorted.rows_of(own);
        self.columns = sorted.rows_of(other);
        let size = (self.rows.len(), self.columns.len());
        if self.values.dim() != size {
            self.values = Array2::zeros(size);
        }
        sorted.kernel_into(
            self.rows.clone(),
            self.columns.clone(),
            self.values.view_mut(),
        );
    }

    /// Those of some of the rows and columns.
    pub fn part(&self, rows: &Range<usize>, columns: &Range<usize>) -> ArrayView2<'_, T> {
        let within =
            |of: &Range<usize>, all: &Range<usize>| of.start - all.start..of.end - all.start;
        self.values
            .slice(s![within(rows, &self.rows), within(columns, &self.columns)])
    }
}
