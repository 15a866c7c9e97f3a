//! A stored matrix Φ, and the ensembles that need one.

use crate::random::Seed;
use ndarray::linalg::general_mat_mul;
use ndarray::{Array1, Array2, ArrayView2, ArrayViewMut2};
use ndarray_rand::RandomExt;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Φ, m × n, entries N(0, 1/n).
pub(super) fn gaussian(m: usize, n: usize, stream: &Seed) -> Array2<f64> {
    by_rows(m, n, stream, |rng| {
        Array1::random_using(n, StandardNormal, rng)
    })
}

/// Φ, m × n, entries ±1/√n, either sign as likely.
pub(super) fn bernoulli(m: usize, n: usize, stream: &Seed) -> Array2<f64> {
    by_rows(m, n, stream, |rng| {
        Array1::from_shape_simple_fn(n, || if rng.r#gen() { 1.0 } else { -1.0 })
    })
}

/// Rows of n numbers of variance 1, divided by √n. Row r comes from the stream's child r alone, so a larger m keeps the
/// smaller's rows.
fn by_rows(
    m: usize,
    n: usize,
    stream: &Seed,
    row: impl Fn(&mut ChaCha8Rng) -> Array1<f64>,
) -> Array2<f64> {
    let scale = 1.0 / (n as f64).sqrt();
    let mut matrix: Array2<f64> = Array2::zeros((m, n));
    for (number, mut entries) in matrix.outer_iter_mut().enumerate() {
        let mut rng = stream.numbered(number as u64).rng();
        entries.assign(&row(&mut rng));
    }
    matrix * scale
}

/// Y = X Φᵀ by the blocked matrix product, which sums each entry over the taxels in one fixed order whatever the
/// number of frames or measurements (a law-test holds it to that).
pub(super) fn measure(matrix: &Array2<f64>, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
    general_mat_mul(1.0, &frames, &matrix.t(), 0.0, &mut out);
}
