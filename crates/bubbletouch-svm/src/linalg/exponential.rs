//! Exponentials of f64 values in vector instructions.

/// Replaces each value x ≤ 0 by `exp(x)`, by range reduction `x = n ln 2 + r` and the Taylor polynomial of degree 13 in r. The error is at most 2 units in the last
/// place; results below 1e-307 are 0. The code has no branches, so that it is vectorised.
#[inline(always)]
pub(crate) fn exponentials(values: &mut [f64]) {
    /// Rounding constant 1.5 · 2⁵²; the sum of this constant and a number contains the rounded number in its low bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    /// Smallest x whose exponential is not replaced by 0.
    const LOWEST: f64 = -707.0;
    /// Upper part of ln 2 with 21 trailing zero bits, so that its product with an integer below 2²⁰ is exact.
    const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
    const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    for value in values {
        let x = value.max(LOWEST);
        let shifted = x * std::f64::consts::LOG2_E + ROUND;
        let n = shifted - ROUND;
        let r = x - n * LN_2_HIGH - n * LN_2_LOW;
        let mut sum = TAYLOR[0];
        for coefficient in &TAYLOR[1..] {
            sum = sum * r + coefficient;
        }
        let power = f64::from_bits((shifted.to_bits() << 52).wrapping_add(1023 << 52));
        *value = if x > LOWEST { sum * power } else { 0.0 };
    }
}

/// Coefficients 1/k! of the exponential series, from k = 13 to k = 0. The next term is below 5e-18 for |r| ≤ ln 2 / 2.
const TAYLOR: [f64; 14] = {
    let mut coefficients = [1.0; 14];
    let mut k = 1;
    let mut factorial = 1.0;
    while k < 14 {
        factorial *= k as f64;
        coefficients[13 - k] = 1.0 / factorial;
        k += 1;
    }
    coefficients
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentials_are_exact_to_two_units_in_the_last_place() {
        let values: Vec<f64> = (0..200_000).map(|i| -3.5e-3 * i as f64).collect();
        let mut fast = values.clone();
        exponentials(&mut fast);
        for (x, value) in values.iter().zip(&fast) {
            let error = (value - x.exp()).abs();
            assert!(error <= 2.0 * f64::EPSILON * x.exp(), "exp({x}) = {value}");
        }
    }

    #[test]
    fn values_too_small_for_a_normal_number_give_zero() {
        let mut values = [0.0, -710.0, -1e9, f64::MIN, f64::NEG_INFINITY];
        exponentials(&mut values);
        assert_eq!(values, [1.0, 0.0, 0.0, 0.0, 0.0]);
    }
}
