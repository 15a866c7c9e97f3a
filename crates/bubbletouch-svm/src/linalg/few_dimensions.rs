//! Low-dimensional subspace that is spanned by some of the rows.

use ndarray::{Array1, Array2, ArrayView2};

use crate::linalg::scalar::Scalar;

/// Minimum norm of the component of a row that is orthogonal to all previous directions, relative to the row's norm. Below it, the row adds no direction.
const NEW_SHARE: f64 = 1e-2;

/// Returns up to `n_dimensions` orthonormal vectors of length m in the space that is spanned by selected rows (n × m). The rows are selected at even intervals
/// and orthogonalised by the Gram-Schmidt process.
pub(crate) fn spanned<T: Scalar>(rows: ArrayView2<T>, n_dimensions: usize) -> Array2<T> {
    let mut directions = Array2::zeros((0, rows.ncols()));
    let n_rows = n_dimensions.min(rows.nrows());
    for at in 0..n_rows {
        let mut row: Array1<T> = rows.row(at * rows.nrows() / n_rows).to_owned();
        let length = row.dot(&row).sqrt();
        for direction in directions.rows() {
            let part = direction.dot(&row);
            row.scaled_add(-part, &direction);
        }
        let new = row.dot(&row).sqrt();
        if new > T::from_f64(NEW_SHARE) * length {
            row.mapv_inplace(|value| value / new);
            directions
                .push_row(row.view())
                .expect("all rows are equally long");
        }
    }
    directions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_orthogonal_and_keep_the_products_of_the_rows_they_span() {
        let rows = Array2::from_shape_fn((6, 9), |(i, j)| ((i * 9 + j) as f64 * 1.3).sin());
        let directions = spanned(rows.view(), 6);
        let unity = directions.dot(&directions.t());
        let along = rows.dot(&directions.t());
        let (products, expected) = (along.dot(&along.t()), rows.dot(&rows.t()));
        for ((i, j), value) in unity.indexed_iter() {
            assert!((value - f64::from(u8::from(i == j))).abs() < 1e-12);
            assert!((products[[i, j]] - expected[[i, j]]).abs() < 1e-12);
        }
    }

    #[test]
    fn rows_that_are_nothing_new_give_no_direction() {
        let rows = Array2::from_shape_fn((8, 5), |(i, j)| if i % 2 == 0 { j as f32 } else { 0.0 });
        assert_eq!(spanned(rows.view(), 8).dim(), (1, 5));
        assert_eq!(
            spanned(Array2::<f32>::zeros((3, 4)).view(), 2).dim(),
            (0, 4)
        );
    }
}
