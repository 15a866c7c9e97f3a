//! Inner products between rows, computed by matrix products.

use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, s};

use crate::linalg::scalar::Scalar;

/// Number of rows per block when all rows are multiplied with each other. A few products of each block are computed twice.
const ROWS_AT_ONCE: usize = 128;
/// Maximum number of rows that are multiplied without copying them; for more rows, a matrix product with packed copies is faster.
pub(crate) const FEW_ROWS: usize = 4;
/// Number of rows and columns that are mirrored together, so that they fill a cache line of f32.
const TILE: usize = 16;

/// Writes the inner products `x_i · z_j` of rows x (n_left × m) and rows z (n × m) into an array of shape n_left × n.
pub(crate) fn multiply<T: Scalar>(
    left: ArrayView2<T>,
    right: ArrayView2<T>,
    mut to: ArrayViewMut2<T>,
) {
    if left.nrows() <= FEW_ROWS && in_place(left, right, &mut to) {
        return;
    }
    // Transposed, so that a row's products with many other rows are written contiguously.
    let (one, zero) = (T::one(), T::zero());
    general_mat_mul(one, &right, &left.t(), zero, &mut to.reversed_axes());
}

/// Writes the inner products of a few rows with many rows, without copying any rows. Returns `false`, and writes nothing, if the rows or the processor do not
/// allow it.
fn in_place<T: Scalar>(
    left: ArrayView2<T>,
    right: ArrayView2<T>,
    to: &mut ArrayViewMut2<T>,
) -> bool {
    let (Some(few), Some(many)) = (slices(left), slices(right)) else {
        return false;
    };
    let mut products = vec![T::zero(); few.len() * many.len()];
    let is_done = T::products_in_place(&few, &many, &mut products);
    if is_done {
        let values = to.iter_mut().zip(products);
        values.for_each(|(to, product)| *to = product);
    }
    is_done
}

/// Returns the rows of a matrix as slices; `None` if a row is not contiguous in memory.
pub(crate) fn slices<T>(rows: ArrayView2<'_, T>) -> Option<Vec<&[T]>> {
    let row = |row: usize| rows.index_axis_move(Axis(0), row).to_slice();
    (0..rows.nrows()).map(row).collect()
}

/// Returns the inner products `z_i · z_j` between all rows (n × m), as a symmetric n × n matrix. Half of them are copied from the other half.
pub(crate) fn own_products<T: Scalar>(rows: ArrayView2<T>) -> Array2<T> {
    let n = rows.nrows();
    let mut products = Array2::zeros((n, n));
    for start in (0..n).step_by(ROWS_AT_ONCE) {
        let end = n.min(start + ROWS_AT_ONCE);
        let (left, right) = (rows.slice(s![start..end, ..]), rows.slice(s![..end, ..]));
        multiply(left, right, products.slice_mut(s![start..end, ..end]));
    }
    mirror(&mut products.view_mut());
    products
}

/// Copies the lower triangle of a square matrix to the upper triangle, in tiles that fit into the cache.
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

    fn rows<T: Scalar>(n: usize, m: usize) -> Array2<T> {
        Array2::from_shape_fn((n, m), |(i, j)| {
            T::from_f64(((i * m + j) as f64 * 1.7).sin())
        })
    }

    fn assert_products<T: Scalar>(tolerance: f64) {
        for (n_left, n, m) in [
            (5, 70, 33),
            (20, 1, 600),
            (1, 17, 1),
            (2, 32, 21),
            (3, 33, 4),
            (1, 4, 21),
            (2, 128, 21),
            (5, 129, 21),
            (4, 300, 21),
        ] {
            let (left, right) = (rows::<T>(n_left, m), rows::<T>(n, m));
            // Sums of m products below 1, with rounding of each addition.
            let tolerance = tolerance * (m as f64 / 100.0).max(1.0);
            let expected = left.dot(&right.t());
            // The target is a part of a larger array.
            let mut to = Array2::zeros((n_left, n + 3));
            multiply(left.view(), right.view(), to.slice_mut(s![.., 2..n + 2]));
            for ((i, j), expected) in expected.indexed_iter() {
                assert!((to[[i, j + 2]] - *expected).wide().abs() < tolerance);
            }
            let own = own_products(right.view());
            for ((i, j), expected) in right.dot(&right.t()).indexed_iter() {
                assert!((own[[i, j]] - *expected).wide().abs() < tolerance);
                assert_eq!(own[[i, j]], own[[j, i]]);
            }
        }
    }

    #[test]
    fn products_are_those_of_ndarray_in_both_precisions() {
        assert_products::<f32>(1e-4);
        assert_products::<f64>(1e-12);
    }
}
