//! Inner products and weighted sums of a few selected rows of a large matrix.
//!
//! A matrix product first copies its rows into panels. For a few dozen rows with many features, the copy takes as long as the multiplications. If the
//! processor supports it, rows are therefore multiplied without copying (`row_tiles`).

use ndarray::Array2;

use crate::linalg::scalar::Scalar;

/// Rows of a matrix, stored contiguously in memory.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a, T> {
    /// Matrix values in row-major order.
    pub values: &'a [T],
    /// Number of values in each row.
    pub n_features: usize,
}

impl<'a, T: Scalar> Rows<'a, T> {
    /// Adds the given rows, multiplied by their weights, to `sums`; each row is a pair (row number, weight). Sums are in f64, because large weights may nearly
    /// cancel.
    pub fn add_weighted(self, sums: &mut [f64], rows: impl Iterator<Item = (usize, f64)>) {
        let rows = rows.filter(|(_, weight)| *weight != 0.0);
        let mut weighing: Vec<(&[T], f64)> =
            Vec::with_capacity(rows.size_hint().1.unwrap_or(0) + 4);
        weighing.extend(rows.map(|(row, weight)| (self.row(row), weight)));
        let mut rows = weighing;
        // The last group of four is filled with rows of weight 0.
        let n_fours = rows.len().div_ceil(4);
        if let Some(&(first, _)) = rows.first() {
            rows.resize(4 * n_fours, (first, 0.0));
        }
        for four in rows.as_chunks::<4>().0 {
            add_four(sums, four);
        }
    }

    /// Returns the row with the given number.
    #[inline(always)]
    pub fn row(self, row: usize) -> &'a [T] {
        &self.values[row * self.n_features..][..self.n_features]
    }
}

/// Writes the inner products of rows with other rows of equal length into `to`, row by row: rows.len() × others.len() values.
pub(crate) fn multiply<T: Scalar>(rows: &[&[T]], others: &[&[T]], to: &mut [T]) {
    if to.is_empty() || T::products_in_place(rows, others, to) {
        return;
    }
    let whole = |rows: &[&[T]]| {
        let n_features = rows.first().map_or(0, |row| row.len());
        Array2::from_shape_vec((rows.len(), n_features), rows.concat())
            .expect("whole rows were copied")
    };
    let products = whole(rows).dot(&whole(others).t());
    to.iter_mut()
        .zip(&products)
        .for_each(|(to, &from)| *to = from);
}

/// Adds four rows, each multiplied by its weight, to the sums in one pass. The sums are then read and written a quarter as often.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn add_four<T: Scalar>(sums: &mut [f64], rows: &[(&[T], f64); 4]) {
    let n = sums.len();
    let [(a, p), (b, q), (c, r), (d, s)] = *rows;
    let (a, b, c, d) = (&a[..n], &b[..n], &c[..n], &d[..n]);
    for at in 0..n {
        sums[at] += (p * a[at].wide() + q * b[at].wide()) + (r * c[at].wide() + s * d[at].wide());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns n rows of m irregular test values, row by row.
    fn values(n: usize, m: usize) -> Vec<f64> {
        (0..n * m).map(|i| (i as f64 * 1.7 + 0.3).sin()).collect()
    }

    #[test]
    fn products_of_rows_are_sums_of_products_whatever_their_numbers_and_precision() {
        for m in [0, 1, 7, 8, 37, 64] {
            let values = values(11, m);
            let single: Vec<f32> = values.iter().map(|&value| value as f32).collect();
            for (rows, others) in [
                (vec![], vec![1]),
                (vec![3], vec![10, 0]),
                (vec![9, 1, 4, 4, 0], vec![2, 7, 8, 9, 10, 3, 1]),
            ] {
                let expected = Array2::from_shape_fn((rows.len(), others.len()), |(i, j)| -> f64 {
                    let (row, other) = (&values[rows[i] * m..], &values[others[j] * m..]);
                    row.iter().zip(other).take(m).map(|(a, b)| a * b).sum()
                });
                assert_products(&values, (&rows, &others), &expected, 1e-13);
                assert_products(&single, (&rows, &others), &expected, 1e-5);
            }
        }
    }

    fn assert_products<T: Scalar>(
        values: &[T],
        (rows, others): (&[usize], &[usize]),
        expected: &Array2<f64>,
        tolerance: f64,
    ) {
        let n_features = values.len() / 11;
        let all = Rows { values, n_features };
        let [left, right] = [rows, others].map(|of| of.iter().map(|&row| all.row(row)));
        let (left, right): (Vec<&[T]>, Vec<&[T]>) = (left.collect(), right.collect());
        let mut products = vec![T::one(); left.len() * right.len()];
        multiply(&left, &right, &mut products);
        for (product, expected) in products.iter().zip(expected) {
            assert!((product.wide() - expected).abs() <= tolerance);
        }
    }

    #[test]
    fn a_row_alone_has_the_bits_that_it_has_among_others() {
        for m in [1, 16, 37, 1024, 1500] {
            let values: Vec<f32> = values(11, m).iter().map(|&value| value as f32).collect();
            let all: Vec<&[f32]> = values.chunks_exact(m).collect();
            let (rows, others) = all.split_at(3);
            let mut together = vec![0.0; 24];
            multiply(rows, others, &mut together);
            for (row, expected) in rows.iter().zip(together.chunks_exact(8)) {
                let mut alone = vec![0.0; 8];
                multiply(&[row], others, &mut alone);
                assert_eq!(alone, expected, "{m}");
            }
        }
    }

    #[test]
    fn weighted_sums_add_each_row_as_often_as_asked() {
        let (n, m) = (9, 13);
        let values = values(n, m);
        let rows = Rows {
            values: &values,
            n_features: m,
        };
        for n_weights in 0..n {
            let weights: Vec<(usize, f64)> = (0..n_weights)
                .map(|i| (i * 4 % n, i as f64 - 2.0))
                .collect();
            let mut sums = vec![1.0; m];
            rows.add_weighted(&mut sums, weights.iter().copied());
            for (k, sum) in sums.iter().enumerate() {
                let added = weights
                    .iter()
                    .map(|(row, weight)| weight * values[row * m + k]);
                assert!((sum - 1.0 - added.sum::<f64>()).abs() < 1e-13);
            }
        }
    }
}
