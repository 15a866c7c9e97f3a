//! Floating-point types of kernel values: f32 and f64.

use ndarray::NdFloat;

use crate::linalg::row_tiles;

/// Floating-point type of the values of a Gram matrix: f32 or f64.
pub(crate) trait Scalar: NdFloat + Default {
    /// Converts an f64 to the nearest value of this type.
    fn from_f64(value: f64) -> Self;
    /// Converts the value to f64, which is exact.
    fn wide(self) -> f64;
    /// Replaces each squared distance d by `exp(−γ d)`.
    fn exponentials(distances: &mut [Self], gamma: f64);
    /// Writes the inner products of rows with other rows of equal length into `products`, row by row, without copying the rows. Returns `false`, and writes
    /// nothing, if there is no fast implementation.
    fn products_in_place(_: &[&[Self]], _: &[&[Self]], _: &mut [Self]) -> bool {
        false
    }
}

impl Scalar for f64 {
    fn from_f64(value: f64) -> Self {
        value
    }

    fn wide(self) -> f64 {
        self
    }

    fn exponentials(distances: &mut [Self], gamma: f64) {
        for value in distances {
            *value = (-gamma * *value).exp();
        }
    }
}

impl Scalar for f32 {
    fn from_f64(value: f64) -> Self {
        value as f32
    }

    fn wide(self) -> f64 {
        f64::from(self)
    }

    fn exponentials(distances: &mut [Self], gamma: f64) {
        exponentials_f32(distances, gamma as f32);
    }

    fn products_in_place(rows: &[&[Self]], others: &[&[Self]], products: &mut [Self]) -> bool {
        row_tiles::products_in_place(rows, others, products)
    }
}

/// Replaces each distance d by `exp(−γ d)`, computed by range reduction and the polynomial of `expf` in the Cephes library (Moshier 1989). The error is at most
/// 2 units in the last place; results below the smallest normal number are 0. The code has no branches, so that it is vectorised.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn exponentials_f32(distances: &mut [f32], gamma: f32) {
    /// Rounding constant 1.5 · 2²³; the sum of this constant and a number contains the rounded number in its low bits.
    const ROUND: f32 = 12_582_912.0;
    /// Smallest x for which `exp(x)` is a normal number in f32.
    const LOWEST: f32 = -87.336_54;
    for value in distances {
        let x = (-gamma * *value).max(LOWEST);
        let shifted = x * std::f32::consts::LOG2_E + ROUND;
        let n = shifted - ROUND;
        // ln 2 is split into two parts; n times the first part is exact.
        let r = x - n * 0.693_359_4 - n * -2.121_944_4e-4;
        let mut sum = 1.987_569_1e-4;
        for coefficient in [
            1.398_2e-3,
            8.333_452e-3,
            4.166_579_6e-2,
            1.666_666_5e-1,
            0.5,
        ] {
            sum = sum * r + coefficient;
        }
        let fraction = sum * (r * r) + r + 1.0;
        let power = f32::from_bits((shifted.to_bits() << 23).wrapping_add(127 << 23));
        *value = if x > LOWEST { fraction * power } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fast_exponential_is_the_exact_one_to_two_units_in_the_last_place() {
        let distances: Vec<f32> = (0..200_000).map(|i| i as f32 * 4.3e-4).collect();
        let mut fast = distances.clone();
        f32::exponentials(&mut fast, 1.0);
        for (distance, value) in distances.iter().zip(&fast) {
            let exact = (-f64::from(*distance)).exp();
            let error = (f64::from(*value) - exact).abs();
            assert!(
                error <= 2.0 * f64::from(f32::EPSILON) * exact,
                "exp(-{distance}) = {value}, exactly {exact}"
            );
        }
    }

    #[test]
    fn what_is_too_small_for_a_normal_number_is_zero() {
        let mut values = [0.0, 88.0, 1e9, f32::MAX];
        f32::exponentials(&mut values, 1.0);
        assert_eq!(values, [1.0, 0.0, 0.0, 0.0]);
    }
}
