//! Kernel values made of the products of all rows when they are asked for: those within classes once, those between two when
//! their pair is solved, those of a row when it is judged.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, ArrayViewMut2, s};

use crate::recognition::kernel::KernelFunction;
use crate::recognition::points::Points;
use crate::recognition::scalar::Scalar;
use crate::recognition::smo::Dense;

/// A kernel on rows whose products are known.
pub(crate) struct ProductKernel<'a, T> {
    points: &'a Points<T>,
    /// n × n.
    products: ArrayView2<'a, T>,
    kernel: KernelFunction,
    /// The rows of each class, and their kernel values with each other.
    classes: Vec<(Range<usize>, Array2<T>)>,
}

impl<'a, T: Scalar> ProductKernel<'a, T> {
    /// Of rows whose products are these (n × n), and the rows of each class.
    pub fn new(
        points: &'a Points<T>,
        products: ArrayView2<'a, T>,
        kernel: KernelFunction,
        ranges: &[Range<usize>],
    ) -> Self {
        let mut own = Self {
            points,
            products,
            kernel,
            classes: Vec::new(),
        };
        for range in ranges {
            let mut values = Array2::zeros((range.len(), range.len()));
            own.write((range, range), values.view_mut());
            own.classes.push((range.clone(), values));
        }
        own
    }

    /// Writes the kernel values of some rows with others.
    fn write(&self, (rows, others): (&Range<usize>, &Range<usize>), mut to: ArrayViewMut2<T>) {
        let products = self.products.slice(s![rows.clone(), others.clone()]);
        for (mut to, products) in to.rows_mut().into_iter().zip(products.rows()) {
            match (to.as_slice_mut(), products.to_slice()) {
                (Some(to), Some(products)) => to.copy_from_slice(products),
                _ => to.assign(&products),
            }
        }
        let others = self.points.range(others.clone());
        let rows = self.points.range(rows.clone());
        rows.apply(to, others, &self.kernel);
    }

    /// Those of all rows with each other.
    pub fn write_all(&self, to: &mut Dense<T>) {
        let all = 0..self.points.len();
        let mut values = Array2::zeros(self.products.dim());
        self.write((&all, &all), values.view_mut());
        to.of_whole(values.view());
    }

    /// Those of the rows of two classes with each other; `between` is room for some of them.
    pub fn write_pair(&self, (a, b): (usize, usize), between: &mut Vec<T>, to: &mut Dense<T>) {
        let [(first, own), (second, others)] = [a, b].map(|class| &self.classes[class]);
        let size = (first.len(), second.len());
        between.resize(size.0 * size.1, T::zero());
        let values = ArrayViewMut2::from_shape(size, &mut between[..]);
        self.write((first, second), values.expect("room for all was made"));
        to.of_blocks([own.view(), others.view()], between);
    }

    /// Those of a row with all.
    pub fn write_row(&self, row: usize, to: &mut Vec<T>) {
        to.resize(self.points.len(), T::zero());
        let values = ArrayViewMut2::from_shape((1, to.len()), &mut to[..]);
        let rows = (&(row..row + 1), &(0..self.points.len()));
        self.write(rows, values.expect("room for all was made"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::smo::Gram;
    use ndarray::Array1;

    #[test]
    fn values_are_those_of_the_rows_however_they_are_asked_for() {
        let rows = Array2::from_shape_fn((23, 4), |(i, j)| ((i * 4 + j) as f64 * 1.7).sin());
        let points = Points::<f64>::new(rows.view(), Array1::zeros(4).view());
        let kernel = KernelFunction::Rbf { gamma: 0.3 };
        let expected = points.all().own_kernel(&kernel);
        let products = points.all().packed().own_products();
        let ranges = [0..9, 9..10, 10..23];
        let found = ProductKernel::new(&points, products.view(), kernel, &ranges);
        let mut values = Vec::new();
        let mut gram = Dense::default();
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            found.write_pair((a, b), &mut values, &mut gram);
            let rows: Vec<usize> = ranges[a].clone().chain(ranges[b].clone()).collect();
            assert_eq!(gram.len(), rows.len());
            for (i, &row) in rows.iter().enumerate() {
                for (j, &other) in rows.iter().enumerate() {
                    assert_eq!(gram.row(i)[j], expected[[row, other]]);
                }
                assert!(gram.row(i)[rows.len()..].iter().all(|value| *value == 0.0));
            }
        }
        found.write_all(&mut gram);
        for row in 0..23 {
            found.write_row(row, &mut values);
            assert_eq!(values, expected.row(row).to_vec());
            assert_eq!(gram.row(row)[..23], values);
        }
    }
}
