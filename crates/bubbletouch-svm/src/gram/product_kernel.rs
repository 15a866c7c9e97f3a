//! Kernel values computed from pairwise products (or L1 distances) of all rows. Values within classes are computed once. Values between two classes are
//! computed when their pair is solved, and values of a validation row when it is scored.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, s};

use crate::gram::centered_rows::CenteredRows;
use crate::gram::matrix::Dense;
use crate::kernel::KernelFunction;
use crate::linalg::scalar::Scalar;

/// Kernel values that are computed from stored inner products (or L1 distances) of all rows.
pub(crate) struct ProductKernel<'a, T> {
    points: &'a CenteredRows<T>,
    /// Range of row indices of each class.
    ranges: &'a [Range<usize>],
    /// Inner products (or L1 distances) between all pairs of rows, n × n.
    pairwise: ArrayView2<'a, T>,
    kernel: KernelFunction,
    /// Kernel values between the rows of each class.
    within: Vec<Array2<T>>,
}

impl<'a, T: Scalar> ProductKernel<'a, T> {
    /// Creates the kernel matrix for rows sorted by class, given their inner products or L1 distances.
    pub fn new(
        (points, ranges): (&'a CenteredRows<T>, &'a [Range<usize>]),
        pairwise: ArrayView2<'a, T>,
        kernel: KernelFunction,
    ) -> Self {
        let mut own = Self {
            points,
            ranges,
            pairwise,
            kernel,
            within: Vec::new(),
        };
        for (class, range) in ranges.iter().enumerate() {
            let mut values = Array2::zeros((range.len(), range.len()));
            own.write((class, class), values.view_mut());
            own.within.push(values);
        }
        own
    }

    /// Writes the kernel values between the rows of one class and the rows of another class.
    fn write(&self, (class, other): (usize, usize), mut to: ArrayViewMut2<T>) {
        let (rows, others) = (self.ranges[class].clone(), self.ranges[other].clone());
        let pairwise = self.pairwise.slice(s![rows.clone(), others.clone()]);
        to.assign(&pairwise);
        let (rows, others) = (self.points.range(rows), self.points.range(others));
        rows.apply(to, others, &self.kernel);
    }

    /// Writes the complete Gram matrix of all rows into `to`.
    pub fn write_all(&self, to: &mut Dense<T>) {
        let (mut values, all) = (self.pairwise.to_owned(), self.points.all());
        all.apply(values.view_mut(), all, &self.kernel);
        to.of_whole(values.view());
    }

    /// Writes the Gram matrix of two classes into `to`; the rows of the first class come first.
    pub fn write_pair(&self, (first, second): (usize, usize), to: &mut Dense<T>) {
        let within = [first, second].map(|class| self.within[class].view());
        to.of_blocks(within, |below| self.write((second, first), below));
    }

    /// Returns the kernel values between the rows with the given numbers and all rows.
    pub fn rows(&self, rows: &[usize]) -> Array2<T> {
        let mut values = self.pairwise.select(Axis(0), rows);
        let own = self.points.select(rows);
        own.all()
            .apply(values.view_mut(), self.points.all(), &self.kernel);
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gram::matrix::Gram;
    use crate::linalg::products::own_products;
    use ndarray::Array1;

    #[test]
    fn values_are_those_of_the_rows_however_they_are_asked_for() {
        let rows = Array2::from_shape_fn((23, 4), |(i, j)| ((i * 4 + j) as f64 * 1.7).sin());
        let points = CenteredRows::<f64>::new(rows.view(), Array1::zeros(4).view());
        let kernel = KernelFunction::Rbf { gamma: 0.3 };
        let expected = points.all().own_kernel(&kernel);
        let ranges = [0..9, 9..10, 10..23];
        let products = own_products(points.all().values);
        let found = ProductKernel::new((&points, &ranges), products.view(), kernel);
        let mut gram = Dense::default();
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            found.write_pair((a, b), &mut gram);
            let rows: Vec<usize> = ranges[a].clone().chain(ranges[b].clone()).collect();
            assert_eq!(gram.len(), rows.len());
            for (i, &row) in rows.iter().enumerate() {
                for (j, &other) in rows.iter().enumerate() {
                    assert!((gram.row(i)[j] - expected[[row, other]]).abs() < 1e-14);
                }
                assert!(gram.row(i)[rows.len()..].iter().all(|value| *value == 0.0));
            }
        }
        found.write_all(&mut gram);
        let some = [22, 0, 9, 10];
        for (&row, values) in some.iter().zip(found.rows(&some).rows()) {
            assert_eq!(gram.row(row)[..23], values.to_vec());
            for (value, expected) in values.iter().zip(expected.row(row)) {
                assert!((value - expected).abs() < 1e-14);
            }
        }
    }
}
