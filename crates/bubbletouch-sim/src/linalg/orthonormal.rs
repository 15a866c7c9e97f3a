//! Orthonormal bases by Gram–Schmidt, and pivots of the QR factorisation with column pivoting (Businger and Golub 1965).

use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, Axis, s};

/// Smallest norm of a row after orthogonalisation; a row with a smaller norm is linearly dependent on earlier rows.
const DEPENDENT: f64 = 1e-10;

/// Orthonormalises rows by Gram–Schmidt, applied twice for accuracy; rows that depend on earlier rows are omitted.
///
/// Rows are made orthogonal to all earlier blocks by matrix products, then to each other within their block.
pub(crate) fn orthonormal_rows(mut rows: Array2<f64>) -> Array2<f64> {
    const BLOCK: usize = 32;
    let before = rows.map_axis(Axis(1), |row| row.dot(&row).sqrt());
    let mut basis: Array2<f64> = Array2::zeros(rows.dim());
    let mut n_kept = 0;
    for (block, mut rows) in rows.axis_chunks_iter_mut(Axis(0), BLOCK).enumerate() {
        let earlier = n_kept;
        for _ in 0..2 {
            let kept = basis.slice(s![..earlier, ..]);
            let along = rows.dot(&kept.t());
            general_mat_mul(-1.0, &along, &kept, 1.0, &mut rows);
        }
        for (number, mut row) in rows.outer_iter_mut().enumerate() {
            for _ in 0..2 {
                for kept in basis.slice(s![earlier..n_kept, ..]).outer_iter() {
                    row.scaled_add(-row.dot(&kept), &kept);
                }
            }
            let after = row.dot(&row).sqrt();
            if after > DEPENDENT * before[block * BLOCK + number] {
                basis.row_mut(n_kept).assign(&(&row / after));
                n_kept += 1;
            }
        }
    }
    basis.slice_move(s![..n_kept, ..])
}

/// Returns the indices of the first k pivot columns of a matrix, shape (k, n), k ≤ n.
///
/// Each step selects the column that is farthest from the span of the selected columns, or the first among equal columns. The direction of this column is then
/// removed from all columns by Gram–Schmidt. The cost is 4 k² n.
pub(crate) fn pivoted_columns(mut matrix: Array2<f64>) -> Vec<usize> {
    let (k, n) = matrix.dim();
    let mut is_taken = vec![false; n];
    let mut pivots = Vec::with_capacity(k);
    for _ in 0..k {
        let squares = matrix.map_axis(Axis(0), |column| column.dot(&column));
        let free = (0..n).filter(|&column| !is_taken[column]);
        let farthest = free.reduce(|a, b| if squares[b] > squares[a] { b } else { a });
        let Some(pivot) = farthest else {
            break;
        };
        is_taken[pivot] = true;
        pivots.push(pivot);
        let norm = squares[pivot].sqrt();
        if norm == 0.0 {
            continue;
        }
        let direction = matrix.column(pivot).to_owned() / norm;
        let along = direction.dot(&matrix);
        for (mut row, &entry) in matrix.outer_iter_mut().zip(&direction) {
            row.scaled_add(-entry, &along);
        }
    }
    pivots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pivots_are_those_of_scipy() {
        // scipy.linalg.qr(a, pivoting=True)[2][:5] with a[i, j] = sin(1.3 i² + 0.7 j i + 2.1 j).
        let matrix = Array2::from_shape_fn((5, 12), |(i, j)| {
            let (i, j) = (i as f64, j as f64);
            (1.3 * i * i + 0.7 * j * i + 2.1 * j).sin()
        });
        assert_eq!(pivoted_columns(matrix), [8, 5, 10, 7, 3]);
    }

    #[test]
    fn equal_columns_are_pivots_once_and_dependent_ones_come_last() {
        let matrix = ndarray::array![[1.0, 1.0, 0.0, 3.0], [0.0, 0.0, 2.0, 0.0]];
        assert_eq!(pivoted_columns(matrix), [3, 2]);
    }
}
