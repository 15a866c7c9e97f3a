//! Kernel values between classes, computed for many classes at once.

use std::ops::Range;

use ndarray::ArrayViewMut2;

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
    /// Row by row.
    values: Vec<T>,
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
            values: Vec::new(),
        }
    }

    /// Those with another group or the same, in the memory of the last ones.
    pub fn compute(&mut self, other: &Range<usize>) {
        self.rows = self.sorted.rows_of(other);
        let size = (self.rows.len(), self.columns.len());
        self.values.resize(size.0 * size.1, T::zero());
        let values = ArrayViewMut2::from_shape(size, &mut self.values);
        let mut values = values.expect("room for all values was made");
        let points = self.sorted.points();
        let rows = points.range(self.rows.clone());
        if self.rows == self.columns {
            self.packed.multiply_own(values.view_mut());
        } else {
            self.packed.multiply(rows.values, values.view_mut());
        }
        let columns = points.range(self.columns.clone());
        rows.apply(values, columns, &self.sorted.kernel());
    }

    /// Those of some of the other group's rows with some of the own group's, row by row.
    pub fn part(&self, rows: &Range<usize>, columns: &Range<usize>) -> Vec<&[T]> {
        let within =
            |of: &Range<usize>, all: &Range<usize>| of.start - all.start..of.end - all.start;
        let columns = within(columns, &self.columns);
        let width = self.columns.len();
        within(rows, &self.rows)
            .map(|row| &self.values[row * width..][columns.clone()])
            .collect()
    }
}
