//! Discrete cosine transform (DCT-II) of arrays.

use ndarray::Array2;
use std::f64::consts::PI;

/// Returns the orthonormal DCT-II matrix of length n: row k is √(2/n) cos(π (i + ½) k / n), row 0 is 1/√n.
pub(super) fn cosines(n: usize) -> Array2<f64> {
    Array2::from_shape_fn((n, n), |(k, i)| {
        let scale = if k == 0 { 1.0 } else { 2.0 };
        let angle = PI * (i as f64 + 0.5) * k as f64 / n as f64;
        f64::sqrt(scale / n as f64) * angle.cos()
    })
}

/// Returns W_y X W_xᵀ, the cosine coefficients of one ny × nx array X, for the cosine matrices W_y and W_x.
pub(super) fn analyse(
    x: ndarray::ArrayView2<f64>,
    wy: &Array2<f64>,
    wx: &Array2<f64>,
) -> Array2<f64> {
    wy.dot(&x).dot(&wx.t())
}

/// Returns W_yᵀ A W_x, the array with the cosine coefficients A. The function inverts [`analyse`], because both cosine matrices are orthonormal.
pub(super) fn synthesise(
    a: ndarray::ArrayView2<f64>,
    wy: &Array2<f64>,
    wx: &Array2<f64>,
) -> Array2<f64> {
    wy.t().dot(&a).dot(wx)
}
