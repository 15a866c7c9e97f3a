//! Weighted sums of matrix rows, in f64.

use crate::linalg::scalar::Scalar;

/// Returns the indices of the coefficients that are not zero. The loop has no branches, because their pattern is unpredictable.
pub(crate) fn support(beta: &[f64]) -> Vec<usize> {
    let (mut support, mut n_support) = (vec![0; beta.len()], 0);
    for (j, &beta) in beta.iter().enumerate() {
        support[n_support] = j;
        n_support += usize::from(beta != 0.0);
    }
    support.truncate(n_support);
    support
}

/// Returns the sum of the rows in `support`, multiplied by their coefficients: its first n values, summed in f64.
pub(crate) fn weighted_sum<'a, T: Scalar>(
    n: usize,
    (support, beta): (&[usize], &[f64]),
    row: impl Fn(usize) -> &'a [T],
) -> Vec<f64> {
    let mut sums = vec![0.0; n];
    let (fours, last) = support.as_chunks::<4>();
    for four in fours {
        add_four(&mut sums, &four.map(|j| (row(j), beta[j])));
    }
    last.iter()
        .for_each(|&j| add_row(&mut sums, row(j), beta[j]));
    sums
}

/// Adds four rows, each multiplied by its weight, to the sums in one pass. The sums are then read and written a quarter as often.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn add_four<T: Scalar>(sums: &mut [f64], rows: &[(&[T], f64); 4]) {
    let n = sums.len();
    let [(a, p), (b, q), (c, r), (d, s)] = *rows;
    let (a, b, c, d) = (&a[..n], &b[..n], &c[..n], &d[..n]);
    for at in 0..n {
        let sum = sums[at] + p * a[at].wide() + q * b[at].wide();
        sums[at] = sum + r * c[at].wide() + s * d[at].wide();
    }
}

/// Adds a row, multiplied by the coefficient `beta`, to the sums, in f64.
#[multiversion::multiversion(targets("x86_64+avx2+fma"))]
pub(crate) fn add_row<T: Scalar>(sums: &mut [f64], row: &[T], beta: f64) {
    for (sum, value) in sums.iter_mut().zip(row) {
        *sum += beta * value.wide();
    }
}
