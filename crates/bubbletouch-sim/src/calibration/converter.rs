//! Converter: bits b, of which readings are whole multiples of the step q = 1 / (2ᵇ − 1) of the full scale.
//!
//! q is the greatest common divisor of all differences of readings, by Euclid's algorithm with the tolerance that single precision leaves.

use super::{Estimate, RecordedSkin};

/// Readings that are looked at, about. More take longer and tell no other step.
const N_READINGS: usize = 200_000;
/// Difference of readings, of the full scale, that single precision may make.
const ROUNDING: f64 = 4e-7;
/// Steps of rounding that a step of a converter is larger than. With smaller ones everything is a multiple.
const LEAST: f64 = 20.0;
/// Different readings from which on their absence of a step is no chance.
const FEWEST: usize = 16;

/// The step of a converter of so many bits, of the full scale; 0 of none.
pub fn step_of(bits: f64) -> f64 {
    match bits > 0.0 {
        true => 1.0 / (bits.exp2() - 1.0),
        false => 0.0,
    }
}

/// Bits; 0 where readings have no step. Readings from `saturation` on are left out: what clips may be no step of the converter.
pub fn estimate(skin: &RecordedSkin, saturation: f64) -> Estimate {
    let mut readings: Vec<f64> = Vec::new();
    for frames in [&skin.touched, &skin.untouched] {
        let stride = (2 * frames.len() / N_READINGS).max(1);
        let frames = frames.iter().step_by(stride);
        readings.extend(frames.filter(|&&reading| reading < saturation));
    }
    readings.sort_by(f64::total_cmp);
    readings.dedup_by(|a, b| *a - *b < ROUNDING);
    if readings.len() < FEWEST {
        let n = readings.len();
        return Estimate::unknown(format!("there are only {n} different readings"));
    }
    let gaps = readings.windows(2).map(|pair| pair[1] - pair[0]);
    let Some(step) = gaps.fold(None, |divisor, gap| {
        Some(divisor.map_or(gap, |divisor| common_divisor(gap, divisor)))
    }) else {
        return Estimate::unknown("there are no readings");
    };
    if step < LEAST * ROUNDING {
        return Estimate::exactly(0.0);
    }
    let step = refined(step, &readings);
    let bits = (1.0 / step + 1.0).log2();
    match (bits - bits.round()).abs() < 1e-3 {
        true => Estimate::exactly(bits.round()),
        false => Estimate::unknown(format!(
            "readings are multiples of {step:.5} of the full scale, which are {:.1} steps and no whole power of two less one: give the full scale of the converter",
            1.0 / step
        )),
    }
}

/// Of two numbers that are multiples of it but for rounding.
fn common_divisor(mut large: f64, mut small: f64) -> f64 {
    while small > LEAST * ROUNDING {
        let rest = large % small;
        // A little less than a whole multiple is one as well.
        let rest = rest.min(small - rest);
        large = small;
        small = if rest < 2.0 * ROUNDING { 0.0 } else { rest };
    }
    match small == 0.0 {
        true => large,
        false => small,
    }
}

/// The step that fits all readings best, as multiples above the least.
fn refined(step: f64, readings: &[f64]) -> f64 {
    let mut step = step;
    let (mut products, mut squares) = (0.0, 0.0);
    // From near to far, so that a step that is a little wrong miscounts none.
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
