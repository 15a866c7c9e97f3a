//! Evenly spaced round numbers for the ticks of axes.

/// Returns the multiples of a round step size that lie between `low` and `high`.
pub(crate) fn even_ticks(low: f64, high: f64) -> Vec<f64> {
    let step = tick_step(high - low);
    let (first, last) = (
        (low / step - 1e-9).ceil() as i64,
        (high / step + 1e-9).floor() as i64,
    );
    // Division by the inverse step gives the nearest floating-point number; multiplication does not, for example 3 × 0.1.
    let value = |tick: i64| match step < 1.0 {
        true => tick as f64 / (1.0 / step).round(),
        false => tick as f64 * step,
    };
    (first..=last).map(value).collect()
}

/// Returns a step size of 1, 2 or 5 times a power of ten that divides a length into about five steps.
pub(crate) fn tick_step(length: f64) -> f64 {
    let raw = length / 5.0;
    let power = 10f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|f| f * power >= raw * 0.999);
    factor.unwrap_or(10.0) * power
}
