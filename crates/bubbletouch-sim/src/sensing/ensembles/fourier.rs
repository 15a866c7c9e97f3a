//! The lowest Fourier coefficients of a frame, as real numbers.
//!
//! Rows are cos and sin of 2π (u x / nx + v y / ny) with norm 1, ordered by increasing (u/nx)² + (v/ny)². Frequency 0 comes first, then a cosine and a sine of
//! each pair ± (u, v). The rows are orthonormal; all n of them form a rotation. Low frequencies contain most of a smooth contact. The position of the contact,
//! which varies from touch to touch, is encoded in the phases of all frequencies.

use super::dense::{Dense, about};
use super::ensemble::EnsembleAbout;
use crate::world::ImageShape;
use ndarray::Array2;
use std::f64::consts::TAU;

pub(crate) const ABOUT: EnsembleAbout = EnsembleAbout {
    needs_rows: true,
    ..about("lowest Fourier coefficients", |grid, m, _| {
        Box::new(Dense(rows(grid, m)))
    })
};

/// Returns the waves (u, v, whether it is a sine) of an ny × nx array, lowest frequency first. Each pair of opposite frequencies has a cosine, and a sine
/// unless the sine is 0 on every taxel.
fn waves(ImageShape { ny, nx }: ImageShape) -> Vec<(usize, usize, bool)> {
    let mut waves = Vec::with_capacity(ny * nx);
    for v in 0..ny {
        for u in 0..nx {
            let opposite = ((ny - v) % ny, (nx - u) % nx);
            if (v, u) <= opposite {
                waves.push((u, v, false));
            }
            if (v, u) < opposite {
                waves.push((u, v, true));
            }
        }
    }
    let square = |k: usize, n: usize| (k.min(n - k) as f64 / n as f64).powi(2);
    let frequency = |&(u, v, _): &(usize, usize, bool)| square(u, nx) + square(v, ny);
    // The sort is stable: equal frequencies keep their order.
    waves.sort_by(|a, b| frequency(a).total_cmp(&frequency(b)));
    waves
}

fn rows(ImageShape { ny, nx }: ImageShape, m: usize) -> Array2<f64> {
    let waves = waves(ImageShape { ny, nx });
    let mut rows = Array2::zeros((m, ny * nx));
    for (mut row, &(u, v, is_sine)) in rows.outer_iter_mut().zip(&waves) {
        for (taxel, value) in row.iter_mut().enumerate() {
            // Whole turns are removed to keep precision.
            let turns = (u * (taxel % nx) % nx) as f64 / nx as f64
                + (v * (taxel / nx) % ny) as f64 / ny as f64;
            let (sine, cosine) = (TAU * turns).sin_cos();
            *value = if is_sine { sine } else { cosine };
        }
        let norm = row.dot(&row).sqrt();
        row /= norm;
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_rows_together_are_orthonormal_and_the_first_is_the_mean() {
        for grid in [(1, 1), (1, 6), (4, 4), (5, 3), (4, 7)].map(|(ny, nx)| ImageShape { ny, nx }) {
            let n = grid.ny * grid.nx;
            let rows = rows(grid, n);
            let error = rows.dot(&rows.t()) - Array2::<f64>::eye(n);
            assert!(error.iter().all(|e| e.abs() < 1e-12), "{grid:?}");
            let mean = 1.0 / (n as f64).sqrt();
            assert!(rows.row(0).iter().all(|v| (v - mean).abs() < 1e-12));
        }
    }

    #[test]
    fn frequencies_rise() {
        let waves = waves(ImageShape { ny: 8, nx: 8 });
        let square = |k: usize| k.min(8 - k).pow(2);
        let frequencies = waves.iter().map(|&(u, v, _)| square(u) + square(v));
        assert!(frequencies.collect::<Vec<_>>().is_sorted());
        assert_eq!(waves[1..5].iter().filter(|wave| wave.2).count(), 2);
    }
}
