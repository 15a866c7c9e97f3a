//! The right factor of matrix products, packed once for many left ones.

use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, ArrayView2, ArrayViewMut2};

use crate::recognition::svm::linalg::panels::{Panels, Wanted};
use crate::recognition::svm::linalg::row_products::Rows;
use crate::recognition::svm::linalg::scalar::Scalar;

/// Rows and columns mirrored at once: a cache line of f32.
const TILE: usize = 16;
/// Rows whose products with each other and the ones before are computed at once, where they lie.
const ROWS_AT_ONCE: usize = 32;

/// Rows (n × m) that others are multiplied with.
#[derive(Clone, Debug)]
pub(crate) struct Packed<'a, T> {
    rows: ArrayView2<'a, T>,
    /// The same rows, where the processor and the precision allow it.
    panels: Option<Panels>,
}

impl<'a, T: Scalar> Packed<'a, T> {
    /// Of rows that are stored one after the other.
    pub fn new(rows: ArrayView2<'a, T>) -> Self {
        Self {
            panels: T::panels(in_place(&rows), rows.nrows()),
            rows,
        }
    }

    /// Bytes that packing so many rows takes.
    pub fn bytes(n_rows: usize, n_features: usize) -> usize {
        Panels::bytes(n_rows, n_features)
    }

    /// `x_i · z_j` of other rows x and these z: into n_left × n, whose rows are contiguous.
    pub fn multiply(&self, left: ArrayView2<T>, mut to: ArrayViewMut2<T>) {
        if !self.by_panels(left, Wanted::All, &mut to) {
            // Transposed, so that a row's products with many of these are written side by side.
            let (one, zero) = (T::one(), T::zero());
            general_mat_mul(one, &self.rows, &left.t(), zero, &mut to.reversed_axes());
        }
    }

    /// `z_i · z_j` of all these: n × n, symmetric.
    pub fn own_products(&self) -> Array2<T> {
        let n = self.rows.nrows();
        let mut products = Array2::zeros((n, n));
        self.multiply_own(products.view_mut());
        products
    }

    /// `z_i · z_j` of all these: into n × n, symmetric, whose rows are contiguous.
    pub fn multiply_own(&self, mut to: ArrayViewMut2<T>) {
        if self.by_panels(self.rows, Wanted::UpToOwn, &mut to) {
            mirror(&mut to);
        } else {
            general_mat_mul(T::one(), &self.rows, &self.rows.t(), T::zero(), &mut to);
        }
    }

    /// `z_i · z_j` of all these for j up to i: row i into as many values as are given, at least up to its own; some of the others
    /// are written, too. `false`, and nothing written, where there is no fast way.
    pub fn multiply_up_to_own(&self, to: &mut [&mut [T]]) -> bool {
        let all = in_place(&self.rows);
        let rows: Vec<&[T]> = (0..self.rows.nrows()).map(|row| all.row(row)).collect();
        let multiply = |panels| T::multiply(panels, &rows, Wanted::UpToOwn, to);
        self.panels.as_ref().is_some_and(multiply)
    }

    fn by_panels(&self, left: ArrayView2<T>, wanted: Wanted, to: &mut ArrayViewMut2<T>) -> bool {
        assert_eq!(to.dim(), (left.nrows(), self.rows.nrows()));
        let Some(panels) = &self.panels else {
            return false;
        };
        let left = in_place(&left);
        let left: Vec<&[T]> = (0..to.nrows()).map(|row| left.row(row)).collect();
        let rows = to.rows_mut().into_iter();
        let mut rows: Vec<&mut [T]> = rows
            .map(|row| row.into_slice().expect("rows of products are contiguous"))
            .collect();
        T::multiply(panels, &left, wanted, &mut rows)
    }
}

/// Products of rows with each other: n × n, symmetric. Of so few rows that packing them takes longer than it saves; they are
/// packed where they cannot be multiplied where they lie.
pub(crate) fn own_products<T: Scalar>(rows: ArrayView2<T>) -> Array2<T> {
    let n = rows.nrows();
    let all: Vec<&[T]> = (0..n).map(|row| in_place(&rows).row(row)).collect();
    let mut products = Array2::zeros((n, n));
    let mut some = Vec::new();
    for start in (0..n).step_by(ROWS_AT_ONCE) {
        let end = n.min(start + ROWS_AT_ONCE);
        some.resize((end - start) * end, T::zero());
        if !T::products_in_place(&all[start..end], &all[..end], &mut some) {
            return Packed::new(rows).own_products();
        }
        for (row, some) in (start..end).zip(some.chunks_exact(end)) {
            let to = products.row_mut(row).into_slice();
            to.expect("a square is stored row by row")[..end].copy_from_slice(some);
        }
    }
    mirror(&mut products.view_mut());
    products
}

fn in_place<'a, T>(rows: &ArrayView2<'a, T>) -> Rows<'a, T> {
    Rows {
        values: rows.to_slice().expect("rows are stored one by one"),
        n_features: rows.ncols(),
    }
}

/// Copies what is below the diagonal to above it, in tiles that stay in the cache.
pub(crate) fn mirror<T: Copy>(square: &mut ArrayViewMut2<T>) {
    let n = square.nrows();
    for top in (0..n).step_by(TILE) {
        for left in (0..=top).step_by(TILE) {
            for i in top..n.min(top + TILE) {
                for j in left..i.min(left + TILE) {
                    square[[j, i]] = square[[i, j]];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::s;

    fn rows<T: Scalar>(n: usize, m: usize) -> Array2<T> {
        Array2::from_shape_fn((n, m), |(i, j)| T::of(((i * m + j) as f64 * 1.7).sin()))
    }

    fn assert_products<T: Scalar>(tolerance: f64) {
        for (n_left, n, m) in [
            (5, 70, 33),
            (20, 1, 600),
            (1, 17, 1),
            (2, 32, 21),
            (3, 33, 4),
        ] {
            let (left, right) = (rows::<T>(n_left, m), rows::<T>(n, m));
            // Sums of m products below 1, each addition rounded.
            let tolerance = tolerance * (m as f64 / 100.0).max(1.0);
            let expected = left.dot(&right.t());
            let packed = Packed::new(right.view());
            // Into a part of something larger.
            let mut to = Array2::zeros((n_left, n + 3));
            packed.multiply(left.view(), to.slice_mut(s![.., 2..n + 2]));
            for ((i, j), expected) in expected.indexed_iter() {
                assert!((to[[i, j + 2]] - *expected).wide().abs() < tolerance);
            }
            for own in [packed.own_products(), own_products(right.view())] {
                for ((i, j), expected) in right.dot(&right.t()).indexed_iter() {
                    assert!((own[[i, j]] - *expected).wide().abs() < tolerance);
                    assert_eq!(own[[i, j]], own[[j, i]]);
                }
            }
        }
    }

    #[test]
    fn products_are_those_of_ndarray_in_both_precisions() {
        assert_products::<f32>(1e-4);
        assert_products::<f64>(1e-12);
    }

    #[test]
    fn products_of_rows_with_each_other_are_those_with_others() {
        let m = 21;
        for n in [0, 1, 4, 32, 33, 70] {
            let rows = rows::<f32>(n, m);
            let own = own_products(rows.view());
            for ((i, j), &product) in own.indexed_iter() {
                let both = rows.row(i).into_iter().zip(rows.row(j));
                let expected: f32 = both.map(|(a, b)| a * b).sum();
                assert!((product - expected).abs() < 1e-5, "{n}: {i} {j}");
                assert_eq!(product, own[[j, i]]);
            }
        }
    }
}
