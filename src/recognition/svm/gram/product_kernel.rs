//! Kernel values made of the products of all rows when they are asked for: those within classes once, those between two when
//! their pair is solved, those of a row when it is judged.

use ndarray::{Array2, ArrayViewMut2, s};

use crate::recognition::svm::gram::class_products::ClassProducts;
use crate::recognition::svm::gram::points::Points;
use crate::recognition::svm::kernel::KernelFunction;
use crate::recognition::svm::linalg::products::mirror;
use crate::recognition::svm::linalg::scalar::Scalar;
use crate::recognition::svm::smo::Dense;

/// A kernel on rows whose products are known.
pub(crate) struct ProductKernel<'a, T> {
    points: &'a Points<T>,
    products: &'a ClassProducts<T>,
    kernel: KernelFunction,
    /// Values of the rows of each class with each other.
    within: Vec<Array2<T>>,
}

impl<'a, T: Scalar> ProductKernel<'a, T> {
    /// Of rows whose products are these.
    pub fn new(
        points: &'a Points<T>,
        products: &'a ClassProducts<T>,
        kernel: KernelFunction,
    ) -> Self {
        let mut own = Self {
            points,
            products,
            kernel,
            within: Vec::new(),
        };
        for (class, range) in products.ranges().iter().enumerate() {
            let mut values = Array2::zeros((range.len(), range.len()));
            own.write((class, class), values.view_mut());
            own.within.push(values);
        }
        own
    }

    /// Writes the kernel values of the rows of a class with those of one that is not after it.
    fn write(&self, (class, other): (usize, usize), mut to: ArrayViewMut2<T>) {
        let ranges = self.products.ranges();
        let (rows, others) = (ranges[class].clone(), ranges[other].clone());
        for (row, mut to) in rows.clone().zip(to.rows_mut()) {
            let to = to.as_slice_mut().expect("rows of values are contiguous");
            to.copy_from_slice(&self.products.of_row(class, row)[others.clone()]);
        }
        let (rows, others) = (self.points.range(rows), self.points.range(others));
        rows.apply(to, others, &self.kernel);
    }

    /// Those of all rows with each other.
    pub fn write_all(&self, to: &mut Dense<T>) {
        let n = self.points.len();
        let mut values = Array2::zeros((n, n));
        for (class, range) in self.products.ranges().iter().enumerate() {
            let products = self.products.of_class(class);
            let own = s![range.clone(), ..range.end];
            values.slice_mut(own).assign(&products);
        }
        mirror(&mut values.view_mut());
        let all = self.points.all();
        all.apply(values.view_mut(), all, &self.kernel);
        to.of_whole(values.view());
    }

    /// Those of the rows of two classes with each other, of which the first comes first.
    pub fn write_pair(&self, (first, second): (usize, usize), to: &mut Dense<T>) {
        let within = [first, second].map(|class| self.within[class].view());
        to.of_blocks(within, |below| self.write((second, first), below));
    }

    /// Kernel values of a row of a class with all, given its products with those of later classes.
    pub fn write_row(&self, (class, row): (usize, usize), later: &[T], to: &mut Vec<T>) {
        to.clear();
        to.extend_from_slice(self.products.of_row(class, row));
        to.extend_from_slice(later);
        let values = ArrayViewMut2::from_shape((1, to.len()), &mut to[..]);
        let values = values.expect("a row has a value with each");
        let row = self.points.range(row..row + 1);
        row.apply(values, self.points.all(), &self.kernel);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::svm::gram::later_products::LaterProducts;
    use crate::recognition::svm::smo::Gram;
    use ndarray::Array1;

    #[test]
    fn values_are_those_of_the_rows_however_they_are_asked_for() {
        let rows = Array2::from_shape_fn((23, 4), |(i, j)| ((i * 4 + j) as f64 * 1.7).sin());
        let points = Points::<f64>::new(rows.view(), Array1::zeros(4).view());
        let kernel = KernelFunction::Rbf { gamma: 0.3 };
        let expected = points.all().own_kernel(&kernel);
        let ranges = [0..9, 9..10, 10..23];
        let products = ClassProducts::new(points.all(), &ranges);
        let found = ProductKernel::new(&points, &products, kernel);
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
        let mut values = Vec::new();
        let mut later = LaterProducts::new(&products);
        for (class, range) in ranges.iter().enumerate() {
            later.gather(class, range.clone());
            for row in range.clone() {
                found.write_row((class, row), later.of_row(row), &mut values);
                assert_eq!(gram.row(row)[..23], values);
                for (value, expected) in values.iter().zip(expected.row(row)) {
                    assert!((value - expected).abs() < 1e-14);
                }
            }
        }
    }
}
