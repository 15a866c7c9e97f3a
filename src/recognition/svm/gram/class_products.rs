//! Products of rows with each other, those of two classes once: half of a square.

use std::ops::Range;

use ndarray::{ArrayView2, ArrayViewMut2, s};

use crate::recognition::svm::gram::points::PointsView;
use crate::recognition::svm::linalg::products::multiply;
use crate::recognition::svm::linalg::scalar::Scalar;

/// Products of the rows of each class with each other and with those of all classes before.
pub(crate) struct ClassProducts<T> {
    ranges: Vec<Range<usize>>,
    /// Where the products of each class start. Each of its rows has as many as there are rows up to its end.
    starts: Vec<usize>,
    values: Vec<T>,
}

impl<T: Scalar> ClassProducts<T> {
    /// Of the rows of classes that follow each other.
    pub fn new(points: PointsView<T>, ranges: &[Range<usize>]) -> Self {
        let mut starts = vec![0];
        for range in ranges {
            starts.push(starts[starts.len() - 1] + range.len() * range.end);
        }
        let mut products = Self {
            ranges: ranges.to_vec(),
            values: vec![T::zero(); starts[ranges.len()]],
            starts,
        };
        products.multiply(points);
        products
    }

    fn multiply(&mut self, points: PointsView<T>) {
        let mut rest = &mut self.values[..];
        for range in &self.ranges {
            let (own, later) = rest.split_at_mut(range.len() * range.end);
            let own = ArrayViewMut2::from_shape((range.len(), range.end), own);
            let left = points.values.slice(s![range.clone(), ..]);
            let right = points.values.slice(s![..range.end, ..]);
            multiply(
                left,
                right,
                own.expect("there is room for the products of all rows"),
            );
            rest = later;
        }
    }

    /// The rows of each class.
    pub fn ranges(&self) -> &[Range<usize>] {
        &self.ranges
    }

    /// Products of the rows of a class with all up to its end.
    pub fn of_class(&self, class: usize) -> ArrayView2<'_, T> {
        let range = &self.ranges[class];
        let own = &self.values[self.starts[class]..self.starts[class + 1]];
        ArrayView2::from_shape((range.len(), range.end), own)
            .expect("there is room for the products of all rows")
    }

    /// Products of a row of a class with all up to the class's end.
    #[inline(always)]
    pub fn of_row(&self, class: usize, row: usize) -> &[T] {
        let range = &self.ranges[class];
        &self.values[self.starts[class] + (row - range.start) * range.end..][..range.end]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::svm::gram::points::Points;
    use ndarray::{Array1, Array2};

    fn assert_products<T: Scalar>(tolerance: f64) {
        let rows = Array2::from_shape_fn((150, 20), |(i, j)| ((i * 20 + j) as f64 * 1.7).sin());
        let points = Points::<T>::new(rows.view(), Array1::zeros(20).view());
        let ranges = [0..3, 3..70, 70..71, 71..150];
        let products = ClassProducts::new(points.all(), &ranges);
        let expected = rows.dot(&rows.t());
        for (class, range) in ranges.iter().enumerate() {
            let of_class = products.of_class(class);
            assert_eq!(of_class.dim(), (range.len(), range.end));
            for row in range.clone() {
                let found = products.of_row(class, row);
                assert_eq!(found, of_class.row(row - range.start).to_vec());
                for (j, found) in found.iter().enumerate() {
                    let difference = found.wide() - expected[[row, j]];
                    assert!(difference.abs() < tolerance, "{row} {j}");
                }
            }
        }
    }

    #[test]
    fn each_class_has_products_with_all_up_to_it() {
        assert_products::<f32>(1e-5);
        assert_products::<f64>(1e-13);
    }
}
