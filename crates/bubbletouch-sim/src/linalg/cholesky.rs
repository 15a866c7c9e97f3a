//! Symmetric positive definite systems, by blocked Cholesky factorisation.

use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, s};

/// Number of matrix columns factorised together: large enough that matrix products do most of the work, small enough for the cache.
const BLOCK: usize = 64;

/// Lower triangular Cholesky factor L of a symmetric matrix A = L Lᵀ.
#[derive(Clone, Debug)]
pub(crate) struct Cholesky(Array2<f64>);

impl Cholesky {
    /// Factorises a symmetric matrix A, of which only the lower triangle is used. Returns `None` if A is not positive definite.
    pub(crate) fn new(mut a: Array2<f64>) -> Option<Self> {
        let n = a.nrows();
        for start in (0..n).step_by(BLOCK) {
            let end = (start + BLOCK).min(n);
            let (done, mut panel) = a
                .slice_mut(s![start.., ..end])
                .split_at(ndarray::Axis(1), start);
            let width = end - start;
            general_mat_mul(
                -1.0,
                &done,
                &done.slice(s![..width, ..]).t(),
                1.0,
                &mut panel,
            );
            factorise(panel.slice_mut(s![..width, ..]))?;
            let (top, mut below) = panel.split_at(ndarray::Axis(0), width);
            // Rows of the panel are independent: each solves Lx = b for its entries b.
            for mut row in below.outer_iter_mut() {
                for i in 0..width {
                    let sum = row.slice(s![..i]).dot(&top.slice(s![i, ..i]));
                    row[i] = (row[i] - sum) / top[[i, i]];
                }
            }
        }
        for row in 0..n {
            a.slice_mut(s![row, row + 1..]).fill(0.0);
        }
        Some(Self(a))
    }

    /// Returns the solution X of A X = B, where A is the factorised matrix; B has shape (n, number of right-hand sides).
    pub(crate) fn solve(&self, b: ArrayView2<f64>) -> Array2<f64> {
        let mut x = b.as_standard_layout().into_owned();
        let n = self.0.nrows();
        let starts: Vec<usize> = (0..n).step_by(BLOCK).collect();
        for &start in &starts {
            let rows = start..(start + BLOCK).min(n);
            let (known, mut rest) = x.view_mut().split_at(ndarray::Axis(0), start);
            let mut open = rest.slice_mut(s![..rows.len(), ..]);
            general_mat_mul(
                -1.0,
                &self.0.slice(s![rows.clone(), ..start]),
                &known,
                1.0,
                &mut open,
            );
            for i in rows.clone() {
                let (before, mut row) = open.view_mut().split_at(ndarray::Axis(0), i - start);
                for (j, earlier) in before.outer_iter().enumerate() {
                    row.row_mut(0).scaled_add(-self.0[[i, start + j]], &earlier);
                }
                row.row_mut(0).mapv_inplace(|v| v / self.0[[i, i]]);
            }
        }
        for &start in starts.iter().rev() {
            let end = (start + BLOCK).min(n);
            let (mut upper, known) = x.view_mut().split_at(ndarray::Axis(0), end);
            let mut open = upper.slice_mut(s![start.., ..]);
            let below = self.0.slice(s![end.., start..end]);
            general_mat_mul(-1.0, &below.t(), &known, 1.0, &mut open);
            for i in (start..end).rev() {
                let (mut row, after) = open
                    .slice_mut(s![i - start.., ..])
                    .split_at(ndarray::Axis(0), 1);
                for (j, later) in after.outer_iter().enumerate() {
                    row.row_mut(0).scaled_add(-self.0[[i + 1 + j, i]], &later);
                }
                row.row_mut(0).mapv_inplace(|v| v / self.0[[i, i]]);
            }
        }
        x
    }
}

/// Computes the Cholesky factor of one diagonal block in place; returns `None` if the block is not positive definite.
fn factorise(mut a: ArrayViewMut2<f64>) -> Option<()> {
    for i in 0..a.nrows() {
        for j in 0..=i {
            let sum = a.slice(s![i, ..j]).dot(&a.slice(s![j, ..j]));
            let rest = a[[i, j]] - sum;
            if i > j {
                a[[i, j]] = rest / a[[j, j]];
            } else if rest > 0.0 {
                a[[i, i]] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn positive(n: usize) -> Array2<f64> {
        let wide =
            Array2::from_shape_fn((n, n + 3), |(i, j)| ((i * 7 + j * 13) as f64 * 0.61).sin());
        wide.dot(&wide.t()) + Array2::<f64>::eye(n)
    }

    #[test]
    fn the_solution_solves_the_system() {
        for n in [1, 2, 5, 63, 64, 65, 150] {
            let a = positive(n);
            let b = Array2::from_shape_fn((n, 4), |(i, j)| (i as f64 - j as f64).cos());
            let x = Cholesky::new(a.clone()).unwrap().solve(b.view());
            let error = a.dot(&x) - &b;
            assert!(error.iter().all(|e| e.abs() < 1e-10), "{n}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_factor() {
        for n in [1, 70] {
            let mut a = positive(n);
            a[[n - 1, n - 1]] = -1.0;
            assert!(Cholesky::new(a).is_none());
        }
        assert!(Cholesky::new(Array2::zeros((3, 3))).is_none());
        assert!(Cholesky::new(Array2::from_elem((2, 2), f64::NAN)).is_none());
    }
}
