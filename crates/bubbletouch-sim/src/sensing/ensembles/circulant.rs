//! Rows of a random circulant matrix: cyclic shifts of one row of signs, ±1/√n (Romberg 2009).
//!
//! y = Φx with Φᵣᵢ = g₍ᵢ₋ₛᵣ₎ mod n, where g has n independent signs and s is a random order of the shifts 0 … n − 1. The ensemble stores n signs and m
//! shifts, while a dense ensemble stores m × n numbers. A shift register wired to the taxels can implement it.

use super::ensemble::{EnsembleAbout, Operator};
use super::subsample::permutation;
use crate::random::Seed;
use crate::world::ImageShape;
use ndarray::{ArrayView1, ArrayView2, ArrayViewMut2};
use rand::Rng;

pub(crate) const ABOUT: EnsembleAbout = EnsembleAbout {
    ..EnsembleAbout::new("circulant", |ImageShape { ny, nx }, m, seed| {
        Box::new(Circulant::new(m, ny * nx, &seed.named("circulant")))
    })
};

#[derive(Debug)]
struct Circulant {
    /// Random signs, stored twice in a row, so that every cyclic shift of the signs is a slice.
    signs: Vec<f64>,
    /// Cyclic shift of the signs for each measurement.
    shifts: Vec<usize>,
}

impl Circulant {
    fn new(m: usize, n: usize, stream: &Seed) -> Self {
        let scale = 1.0 / (n as f64).sqrt();
        let mut rng = stream.named("signs").rng();
        let once: Vec<f64> = (0..n)
            .map(|_| if rng.r#gen() { scale } else { -scale })
            .collect();
        let mut shifts = permutation(n, &stream.named("shifts"));
        shifts.truncate(m);
        Self {
            signs: once.repeat(2),
            shifts,
        }
    }

    /// Returns the row of the circulant matrix that gives one measurement.
    fn row(&self, measurement: usize) -> ArrayView1<'_, f64> {
        let n = self.signs.len() / 2;
        let start = n - self.shifts[measurement];
        ArrayView1::from(&self.signs[start..start + n])
    }
}

impl Operator for Circulant {
    fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
        for (frame, mut out) in frames.outer_iter().zip(out.outer_iter_mut()) {
            // A copy with contiguous layout, because dot products of strided numbers are summed in another order.
            let frame = frame.to_vec();
            let frame = ArrayView1::from(&frame);
            for (measurement, y) in out.iter_mut().enumerate() {
                *y = self.row(measurement).dot(&frame);
            }
        }
    }

    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        for measurement in 0..self.shifts.len() {
            let entries = self.row(measurement).into_iter().enumerate();
            entries.for_each(|(taxel, &value)| visit(measurement, taxel, value));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    fn matrix(m: usize, n: usize) -> Array2<f64> {
        let circulant = Circulant::new(m, n, &Seed::new(3));
        let mut matrix = Array2::zeros((m, n));
        circulant.each_entry(&mut |measurement, taxel, value| matrix[[measurement, taxel]] = value);
        matrix
    }

    #[test]
    fn every_row_is_another_shift_of_the_first_and_has_norm_one() {
        let (m, n) = (13, 40);
        let matrix = matrix(m, n);
        let mut shifts: Vec<usize> = (0..m)
            .map(|row| {
                let is_shift = |&shift: &usize| {
                    (0..n).all(|taxel| matrix[[row, (taxel + shift) % n]] == matrix[[0, taxel]])
                };
                (0..n).find(is_shift).expect("a shift of the first row")
            })
            .collect();
        shifts.sort_unstable();
        shifts.dedup();
        assert_eq!(shifts.len(), m);
        for row in matrix.rows() {
            assert!((row.dot(&row) - 1.0).abs() < 1e-12);
        }
    }
}
