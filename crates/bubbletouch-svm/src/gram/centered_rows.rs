//! Feature rows minus a centre, and the kernel values between them, in the precision of the kernel values.

use std::ops::Range;

use ndarray::{Array1, Array2, ArrayView1, ArrayView2, ArrayViewMut2, Axis, s};
use serde::{Deserialize, Serialize};

use crate::kernel::KernelFunction;
use crate::linalg::centered_row::{CenteredRow, center_row};
use crate::linalg::products::{multiply, own_products};
use crate::linalg::row_products::Rows;
use crate::linalg::scalar::Scalar;

/// Feature rows (n × m) minus a centre, with their squared norms.
///
/// For some kernels, the centre is arbitrary. A constant added to all features does not change RBF distances. In a linear decision function it changes only
/// ρ, because the coefficients sum to zero. About the mean, products are small and lose fewer digits.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "T: Scalar")]
pub(crate) struct CenteredRows<T> {
    /// Centred feature values, n × m.
    #[serde(with = "crate::saved")]
    values: Array2<T>,
    /// Squared norm of each centred row.
    #[serde(with = "crate::saved")]
    norms: Array1<T>,
}

impl<T: Scalar> CenteredRows<T> {
    /// Creates centred rows from features (n × m) and a centre (m).
    pub fn new(features: ArrayView2<f64>, centre: ArrayView1<f64>) -> Self {
        Self::of_rows(features.rows().into_iter(), centre)
    }

    /// Creates centred rows from an iterator over rows (slices of m values) and a centre (m values).
    pub fn of_rows<'a>(
        rows: impl ExactSizeIterator<Item = ArrayView1<'a, f64>>,
        centre: ArrayView1<f64>,
    ) -> Self {
        Self::of_rows_and(rows, centre, |_| ())
    }

    /// Creates centred rows from an iterator, and passes the norm and projection of each row ([`CenteredRow`]) to a callback.
    pub fn of_rows_and<'a>(
        rows: impl ExactSizeIterator<Item = ArrayView1<'a, f64>>,
        centre: ArrayView1<f64>,
        mut told: impl FnMut(CenteredRow),
    ) -> Self {
        let n_rows = rows.len();
        let centre = centre.to_vec();
        let mut values = Vec::with_capacity(n_rows * centre.len());
        let mut norms = Vec::with_capacity(n_rows);
        for row in rows {
            // The rows are written one by one, because filling the whole memory first would need a second pass.
            let start = values.len();
            values.resize(start + centre.len(), T::zero());
            let own = &mut values[start..];
            let moved = match row.as_slice() {
                Some(row) => center_row(own, row, &centre),
                None => center_row(own, &row.to_vec(), &centre),
            };
            // The norm is computed from the stored values with the rounding of the products, because distances combine both.
            let own = ArrayView1::from(&*own);
            norms.push(own.dot(&own));
            told(moved);
        }
        let norms = norms.into();
        let values = Array2::from_shape_vec((n_rows, centre.len()), values);
        let values = values.expect("all rows are as long as the centre");
        Self { values, norms }
    }

    /// Returns whether the rows have this number of features, and each row has a norm.
    pub fn fits(&self, n_features: usize) -> bool {
        self.values.dim() == (self.norms.len(), n_features)
    }

    /// Returns the rows projected onto k directions (k × m), shape n × k.
    pub fn along(&self, directions: ArrayView2<T>) -> Self {
        let mut values = Array2::zeros((self.len(), directions.nrows()));
        multiply(self.values.view(), directions, values.view_mut());
        let norms = values.map_axis(Axis(1), |row| row.dot(&row));
        Self { values, norms }
    }

    /// Returns a view of all centred rows in contiguous memory.
    pub fn in_place(&self) -> Rows<'_, T> {
        Rows {
            values: self.values.as_slice().expect("rows are stored one by one"),
            n_features: self.values.ncols(),
        }
    }

    /// Returns the number of rows n.
    pub fn len(&self) -> usize {
        self.values.nrows()
    }

    fn rows(&self, rows: &[usize]) -> Array2<T> {
        let n_features = self.values.ncols();
        let all = self.values.as_slice().expect("rows are stored one by one");
        let mut values = Vec::with_capacity(rows.len() * n_features);
        for row in rows {
            values.extend_from_slice(&all[row * n_features..][..n_features]);
        }
        Array2::from_shape_vec((rows.len(), n_features), values).expect("whole rows were copied")
    }

    /// Copies the rows with the given numbers.
    pub fn select(&self, rows: &[usize]) -> Self {
        Self {
            values: self.rows(rows),
            norms: self.norms.select(Axis(0), rows),
        }
    }

    /// Removes all rows except those with the given ascending numbers, without allocating memory.
    pub fn keep(self, rows: &[usize]) -> Self {
        let n_features = self.values.ncols();
        let norms = self.norms.select(Axis(0), rows);
        let mut values = self.values.into_raw_vec_and_offset().0;
        for (to, &row) in rows.iter().enumerate() {
            if to != row {
                let from = row * n_features..(row + 1) * n_features;
                values.copy_within(from, to * n_features);
            }
        }
        values.truncate(rows.len() * n_features);
        let values = Array2::from_shape_vec((rows.len(), n_features), values);
        Self {
            values: values.expect("whole rows were kept"),
            norms,
        }
    }

    /// Returns the centred values and the squared norm of one row.
    #[inline]
    pub fn row(&self, row: usize) -> (&[T], T) {
        (self.in_place().row(row), self.norms[row])
    }

    /// Returns a view of all rows.
    pub fn all(&self) -> PointsView<'_, T> {
        self.range(0..self.len())
    }

    /// Returns a view of a range of rows.
    pub fn range(&self, rows: Range<usize>) -> PointsView<'_, T> {
        PointsView {
            values: self.values.slice(s![rows.clone(), ..]),
            norms: self.norms.slice(s![rows]),
        }
    }
}

/// View of a range of [`CenteredRows`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointsView<'a, T> {
    /// Centred feature values, n × m.
    pub values: ArrayView2<'a, T>,
    norms: ArrayView1<'a, T>,
}

impl<T: Scalar> PointsView<'_, T> {
    /// Returns the diagonal of the Gram matrix: `K(x, x)` for each row x.
    pub fn diagonal(&self, kernel: &KernelFunction) -> Vec<T> {
        self.norms
            .iter()
            .map(|&norm| kernel.of_norm(norm))
            .collect()
    }

    /// Returns the kernel values `K(x_i, z_j)` between these rows and n other rows: shape n_rows × n.
    pub fn kernel(&self, others: PointsView<T>, kernel: &KernelFunction) -> Array2<T> {
        let mut values = Array2::zeros((self.values.nrows(), others.values.nrows()));
        self.write_kernel(others, kernel, values.view_mut());
        values
    }

    /// Writes the kernel values `K(x_i, z_j)` between these rows and n other rows into `to`, shape n_rows × n.
    pub fn write_kernel(
        &self,
        others: PointsView<T>,
        kernel: &KernelFunction,
        mut to: ArrayViewMut2<T>,
    ) {
        multiply(self.values, others.values, to.view_mut());
        self.apply(to, others, kernel);
    }

    /// Returns the Gram matrix `K(x_i, x_j)` of the centred rows, n × n.
    pub fn own_kernel(&self, kernel: &KernelFunction) -> Array2<T> {
        let mut values = own_products(self.values);
        self.apply(values.view_mut(), *self, kernel);
        values
    }

    /// Converts the inner products of these rows with other rows to kernel values in place.
    pub fn apply(
        &self,
        mut products: ArrayViewMut2<T>,
        others: PointsView<T>,
        kernel: &KernelFunction,
    ) {
        let norms = others.norms.to_slice();
        let norms = norms.expect("norms are stored one by one");
        for (mut row, &norm) in products.rows_mut().into_iter().zip(self.norms) {
            let row = row.as_slice_mut().expect("rows of values are contiguous");
            kernel.of_products(row, norm, norms);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn kernels_by_products_equal_their_definitions_in_both_precisions() {
        let a = array![[0.5, -1.0, 2.0], [0.0, 0.25, 1.0]];
        let b = array![[1.0, 1.0, 1.0], [0.5, -1.0, 2.0], [-2.0, 0.0, 0.5]];
        let polynomial = KernelFunction::Polynomial {
            gamma: 0.3,
            coef0: 1.0,
            degree: 3,
        };
        let rbf = KernelFunction::Rbf { gamma: 0.3 };
        for kernel in [KernelFunction::Linear, rbf, polynomial] {
            let double = matrix::<f64>(&a, &b, &kernel);
            let single = matrix::<f32>(&a, &b, &kernel);
            for ((i, j), &value) in double.indexed_iter() {
                let dot: f64 = (0..3).map(|k| a[[i, k]] * b[[j, k]]).sum();
                let distance: f64 = (0..3).map(|k| (a[[i, k]] - b[[j, k]]).powi(2)).sum();
                let expected = match kernel {
                    KernelFunction::Linear => dot,
                    KernelFunction::Rbf { .. } => (-0.3 * distance).exp(),
                    KernelFunction::Polynomial { .. } => (0.3 * dot + 1.0).powi(3),
                };
                assert!((value - expected).abs() < 1e-13, "{kernel:?}");
                assert!(
                    (f64::from(single[[i, j]]) - expected).abs() < 1e-6,
                    "{kernel:?}"
                );
            }
        }
    }

    fn matrix<T: Scalar>(a: &Array2<f64>, b: &Array2<f64>, kernel: &KernelFunction) -> Array2<T> {
        let origin = Array1::zeros(3);
        let [a, b] = [a, b].map(|rows| CenteredRows::<T>::new(rows.view(), origin.view()));
        a.all().kernel(b.all(), kernel)
    }

    #[test]
    fn rows_that_are_kept_are_those_that_are_selected() {
        let rows = Array2::from_shape_fn((6, 3), |(i, j)| (i * 3 + j) as f64);
        let points = CenteredRows::<f64>::new(rows.view(), Array1::zeros(3).view());
        for some in [&[0, 1, 2, 3, 4, 5][..], &[1, 2, 5], &[0, 4], &[]] {
            let (kept, selected) = (points.clone().keep(some), points.select(some));
            assert_eq!(kept.values, selected.values);
            assert_eq!(kept.norms, selected.norms);
        }
    }

    #[test]
    fn the_centre_changes_no_distance() {
        let rows = array![[1e6, 1.0], [1e6 + 1.0, 3.0]];
        let centre = array![1e6, 2.0];
        let points = CenteredRows::<f32>::new(rows.view(), centre.view());
        let kernel = KernelFunction::Rbf { gamma: 0.5 };
        let values = points.all().kernel(points.all(), &kernel);
        assert!((f64::from(values[[0, 1]]) - (-2.5_f64).exp()).abs() < 1e-7);
        assert_eq!(points.all().diagonal(&kernel), [1.0, 1.0]);
    }
}
