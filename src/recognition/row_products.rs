//! Products and weighted sums of a few rows among many.
//!
//! A matrix product first copies its rows into panels. For a few dozen rows of many features that takes as long as the
//! multiplications, so here rows are multiplied where they lie: a few with a few, each read once for all their products.

use std::array::from_fn;

use multiversion::target::target_cfg_f;

use crate::recognition::scalar::Scalar;

/// Rows multiplied with [`M`] others at once: their sums and what is read of the rows fill 16 vector registers.
const N: usize = 4;
/// See [`N`].
const M: usize = 3;

/// Rows of a matrix, one after the other.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a, T> {
    /// All values.
    pub values: &'a [T],
    /// How many a row has.
    pub n_features: usize,
}

impl<'a, T: Scalar> Rows<'a, T> {
    /// Products of some rows with others, by number: each with the places of its two rows among those asked for.
    pub fn products(self, rows: &[usize], others: &[usize], mut take: impl FnMut(usize, usize, T)) {
        // As many features side by side as a vector register holds.
        if size_of::<T>() == size_of::<f32>() {
            tiles::<T, _, 8>(self, rows, others, &mut take);
        } else {
            tiles::<T, _, 4>(self, rows, others, &mut take);
        }
    }

    /// Adds rows, by number, each times a weight; in f64, since large weights may all but cancel.
    pub fn add_weighted(self, sums: &mut [f64], rows: impl Iterator<Item = (usize, f64)>) {
        let mut rows: Vec<(&[T], f64)> = rows
            .filter(|(_, weight)| *weight != 0.0)
            .map(|(row, weight)| (self.row(row), weight))
            .collect();
        // Rows that weigh nothing fill up the last four.
        let n_fours = rows.len().div_ceil(4);
        if let Some(&(first, _)) = rows.first() {
            rows.resize(4 * n_fours, (first, 0.0));
        }
        for four in rows.as_chunks::<4>().0 {
            add_four(sums, four);
        }
    }

    fn row(self, row: usize) -> &'a [T] {
        &self.values[row * self.n_features..][..self.n_features]
    }
}

#[multiversion::multiversion(targets("x86_64+avx2+fma"))]
fn tiles<T: Scalar, F: FnMut(usize, usize, T), const LANES: usize>(
    all: Rows<T>,
    rows: &[usize],
    others: &[usize],
    take: &mut F,
) {
    for (i, own) in rows.chunks(N).enumerate() {
        // What the last few lack is made up by the last row.
        let left: [&[T]; N] = from_fn(|at| all.row(own[at.min(own.len() - 1)]));
        for (j, other) in others.chunks(M).enumerate() {
            let right: [&[T]; M] = from_fn(|at| all.row(other[at.min(other.len() - 1)]));
            let products = if target_cfg_f!(target_feature = "fma") {
                tile::<T, LANES, true>(left, right)
            } else {
                tile::<T, LANES, false>(left, right)
            };
            for (at, products) in products.iter().enumerate().take(own.len()) {
                for (beside, &product) in products.iter().enumerate().take(other.len()) {
                    take(i * N + at, j * M + beside, product);
                }
            }
        }
    }
}

/// All products of a few rows with a few others. Each lane keeps its own sums; they meet at the end.
#[inline(always)]
fn tile<T: Scalar, const LANES: usize, const IS_FUSED: bool>(
    left: [&[T]; N],
    right: [&[T]; M],
) -> [[T; M]; N] {
    let left = left.map(|row| row.as_chunks::<LANES>());
    let right = right.map(|row| row.as_chunks::<LANES>());
    let n = left[0].0.len();
    let left_lanes = left.map(|(lanes, _)| &lanes[..n]);
    let right_lanes = right.map(|(lanes, _)| &lanes[..n]);
    let mut sums = [[[T::zero(); LANES]; M]; N];
    for at in 0..n {
        for i in 0..N {
            for j in 0..M {
                let (a, b) = (&left_lanes[i][at], &right_lanes[j][at]);
                for lane in 0..LANES {
                    sums[i][j][lane] = if IS_FUSED {
                        a[lane].mul_add(b[lane], sums[i][j][lane])
                    } else {
                        sums[i][j][lane] + a[lane] * b[lane]
                    };
                }
            }
        }
    }
    let mut products = meet(&sums);
    for (products, (_, left)) in products.iter_mut().zip(left) {
        for (product, (_, right)) in products.iter_mut().zip(right) {
            for (&a, &b) in left.iter().zip(right) {
                *product += a * b;
            }
        }
    }
    products
}

/// The sum of each group of lanes, halves onto halves. Never inlined: only where the sums of [`tile`] have to be stored side
/// by side does the compiler keep them in vector registers; 10 times slower otherwise.
#[inline(never)]
fn meet<T: Scalar, const LANES: usize>(sums: &[[[T; LANES]; M]; N]) -> [[T; M]; N] {
    sums.map(|sums| {
        sums.map(|mut lanes| {
            let mut width = LANES / 2;
            while width > 0 {
                for lane in 0..width {
                    lanes[lane] += lanes[lane + width];
                }
                width /= 2;
            }
            lanes[0]
        })
    })
}

/// Four rows at once: the sums are read and written a quarter as often.
#[multiversion::multiversion(targets("x86_64+avx2+fma"))]
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

    /// n rows of m values with no pattern.
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
                let n_features = m;
                let double = Rows {
                    values: &values,
                    n_features,
                };
                let single = Rows {
                    values: &single,
                    n_features,
                };
                let mut expected = Vec::new();
                for (i, &row) in rows.iter().enumerate() {
                    for (j, &other) in others.iter().enumerate() {
                        let products = (0..m).map(|k| values[row * m + k] * values[other * m + k]);
                        expected.push((i, j, products.sum::<f64>()));
                    }
                }
                assert_products(double, (&rows, &others), &expected, 1e-13);
                assert_products(single, (&rows, &others), &expected, 1e-5);
            }
        }
    }

    fn assert_products<T: Scalar>(
        all: Rows<T>,
        (rows, others): (&[usize], &[usize]),
        expected: &[(usize, usize, f64)],
        tolerance: f64,
    ) {
        let mut products = Vec::new();
        all.products(rows, others, |i, j, product| products.push((i, j, product)));
        products.sort_by_key(|&(i, j, _)| (i, j));
        assert_eq!(products.len(), expected.len());
        for (product, expected) in products.iter().zip(expected) {
            assert_eq!((product.0, product.1), (expected.0, expected.1));
            assert!((product.2.wide() - expected.2).abs() <= tolerance);
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
