//! Estimation of a converter's number of bits b. Readings are integer multiples of the step q = 1 / (2ᵇ − 1) of the full scale.
//!
//! The step q is the greatest common divisor of all differences of readings, computed by Euclid's algorithm with a tolerance for single precision.

use super::{Estimate, Measured, NotIdentifiable, RecordedSkin};

/// Approximate maximum number of readings that the estimate uses. More readings take longer without a better result.
const N_READINGS: usize = 200_000;
/// Largest difference between equal readings due to single precision, as a fraction of the full scale.
const ROUNDING: f64 = 4e-7;
/// Smallest step of a converter that can be detected, in multiples of [`ROUNDING`]. Within rounding, all readings are multiples of smaller steps.
const LEAST: f64 = 20.0;
/// Minimum number of different readings from which the absence of a converter step can be concluded.
const FEWEST: usize = 16;

/// Returns the step of a converter with the given number of bits, as a fraction of the full scale; 0 for 0 bits.
pub fn step_of(bits: f64) -> f64 {
    match bits > 0.0 {
        true => 1.0 / (bits.exp2() - 1.0),
        false => 0.0,
    }
}

/// Returns the step of the readings, as a fraction of the full scale: the largest number that divides all differences of readings. Returns `None` if there is
/// no step above the rounding of single precision, or all readings are equal. Readings of at least `saturation` are omitted.
pub fn step(skin: &RecordedSkin, saturation: f64) -> Option<f64> {
    let readings = different_readings(skin, saturation);
    let gaps = readings.windows(2).map(|pair| pair[1] - pair[0]);
    let step = gaps.reduce(|divisor, gap| common_divisor(gap, divisor))?;
    (step >= LEAST * ROUNDING).then(|| refined(step, &readings))
}

/// Estimates the number of bits of the analogue-to-digital converter; 0 if readings have no step. Readings of at least `saturation` are omitted, because the
/// clipping level need not be a multiple of the step.
///
/// # Errors
/// If there are too few different readings.
pub fn estimate(skin: &RecordedSkin, saturation: f64) -> Estimate {
    let n = different_readings(skin, saturation).len();
    if n < FEWEST {
        let why = format!("there are only {n} different readings");
        return Err(NotIdentifiable(why));
    }
    let Some(step) = step(skin, saturation) else {
        return Ok(Measured::exactly(0.0));
    };
    let bits = (1.0 / step + 1.0).log2();
    match (bits - bits.round()).abs() < 1e-3 {
        true => Ok(Measured::exactly(bits.round())),
        false => Err(NotIdentifiable(format!(
            "readings are multiples of {step:.5} of the full scale, which are {:.1} steps and no whole power of two less one: give the full scale of the converter",
            1.0 / step
        ))),
    }
}

/// Returns the different readings below `saturation` in ascending order. At most about [`N_READINGS`] readings are used.
fn different_readings(skin: &RecordedSkin, saturation: f64) -> Vec<f64> {
    let mut readings: Vec<f64> = Vec::new();
    for frames in [&skin.touched, &skin.untouched] {
        let stride = (2 * frames.len() / N_READINGS).max(1);
        let frames = frames.iter().step_by(stride);
        readings.extend(frames.filter(|&&reading| reading < saturation));
    }
    readings.sort_by(f64::total_cmp);
    readings.dedup_by(|a, b| *a - *b < ROUNDING);
    readings
}

/// Returns the greatest common divisor of two real numbers, up to rounding errors.
fn common_divisor(mut large: f64, mut small: f64) -> f64 {
    while small > LEAST * ROUNDING {
        let rest = large % small;
        // A remainder just below the divisor is also a rounding error.
        let rest = rest.min(small - rest);
        large = small;
        small = if rest < 2.0 * ROUNDING { 0.0 } else { rest };
    }
    match small == 0.0 {
        true => large,
        false => small,
    }
}

/// Returns the converter step that fits all readings best, starting from `step`. Readings are multiples of this step above the lowest reading.
fn refined(step: f64, readings: &[f64]) -> f64 {
    let mut step = step;
    let (mut products, mut squares) = (0.0, 0.0);
    // Small differences come first, so that an error of the step does not change the count of large ones.
    for reading in readings {
        let above = reading - readings[0];
        let count = (above / step).round();
        products += above * count;
        squares += count * count;
        if squares > 0.0 {
            step = products / squares;
        }
    }
    step
}
