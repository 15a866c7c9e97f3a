//! Discrete cosine transform (DCT-II) of arrays.

use super::dictionary::Transform;
use crate::world::ImageShape;
use ndarray::{Array2, ArrayViewMut2};
use std::f64::consts::PI;

/// Orthonormal cosine transform W_y X W_xᵀ of ny × nx arrays X.
#[derive(Debug)]
pub(super) struct Cosine {
    along_y: Array2<f64>,
    along_x: Array2<f64>,
}

impl Cosine {
    pub(super) fn new(grid: ImageShape) -> Self {
        Self {
            along_y: cosines(grid.ny),
            along_x: cosines(grid.nx),
        }
    }
}

impl Transform for Cosine {
    fn analyse(&self, mut frame: ArrayViewMut2<f64>) {
        let coefficients = self.along_y.dot(&frame).dot(&self.along_x.t());
        frame.assign(&coefficients);
    }

    fn synthesise(&self, mut frame: ArrayViewMut2<f64>) {
        let values = self.along_y.t().dot(&frame).dot(&self.along_x);
        frame.assign(&values);
    }
}

/// Returns the orthonormal DCT-II matrix of length n: row k is √(2/n) cos(π (i + ½) k / n), row 0 is 1/√n.
fn cosines(n: usize) -> Array2<f64> {
    Array2::from_shape_fn((n, n), |(k, i)| {
        let scale = if k == 0 { 1.0 } else { 2.0 };
        let angle = PI * (i as f64 + 0.5) * k as f64 / n as f64;
        f64::sqrt(scale / n as f64) * angle.cos()
    })
}
