//! Estimation of noise: the standard deviation σ of the readings x of untouched taxels. The estimate uses differences between consecutive frames, which a
//! slow drift does not affect.
//!
//! The estimate is σ² = Var(x(t + 1) − x(t)) / 2 − q²/12, where q²/12 is the rounding of a converter of step q (Sheppard's correction). If most readings are
//! clipped, σ is the mean over taxels of the estimate from censored readings (Tobin 1958). Smoothing reduces the variance of the noise by a
//! known factor.

use super::estimate::value;
use super::robust::{jackknife, mean, variance};
use super::smoothing::Smoothed;
use super::untouched::{Untouched, Zero};
use super::{Estimate, NotIdentifiable, RecordedSkin};

/// Smallest noise that can be estimated, in steps of the converter; below this value Sheppard's correction is invalid.
const SEEN: f64 = 0.5;
/// Smallest noise that can be estimated if readings are clipped, in steps of the converter; below this value rounding changes the fraction of clipped
/// readings.
const SEEN_CLIPPED: f64 = 2.0;

/// Estimates the standard deviation of the noise in the readings (after any smoothing), as a fraction of the full scale.
pub(super) fn of_readings(untouched: Option<&Untouched>) -> Estimate {
    let untouched = untouched.ok_or("there are too few untouched frames")?;
    let n_taxels = untouched.skin.n_taxels();
    let found = jackknife(n_taxels, |keep| {
        let taxels = (0..n_taxels).filter(|&taxel| keep(taxel));
        match untouched.is_clear {
            true => of_differences(untouched, taxels),
            false => of_clipped(untouched, taxels),
        }
    });
    let (steps, words) = match untouched.is_clear {
        true => (SEEN, "half a step"),
        false => (SEEN_CLIPPED, "two steps"),
    };
    let found = found.ok_or(
        "most untouched readings are the least that the skin reads: noise below it is lost",
    )?;
    match found.value < steps * untouched.step {
        true => Err(NotIdentifiable(format!(
            "it is below {words} of the converter"
        ))),
        false => Ok(found),
    }
}

/// Extends the interval of the noise downwards by the change of the zero offsets between consecutive frames: a drift σ changes them by σ² Δt, which counts half.
/// Unknown drift changes nothing.
pub(super) fn without_drift(
    read: Estimate,
    untouched: Option<&Untouched>,
    drift: &Estimate,
) -> Estimate {
    let (Some(untouched), Some(drift)) = (untouched, value(drift)) else {
        return read;
    };
    let squared = read?.map(|std| std * std);
    let excess = 0.5 * drift.powi(2) * untouched.frame_interval();
    let lowered = squared.lowered_by(excess);
    Ok(lowered.map(|square| square.max(0.0).sqrt()))
}

/// Converts the noise of the readings to the noise before smoothing, given the smoothing `width` in pitches. The estimate is resolved.
pub(super) fn before_smoothing(read: Estimate, skin: &RecordedSkin, width: f64) -> Estimate {
    let share = Smoothed::new(skin.shape, width).variance.sqrt();
    read?.map(|std| std / share).resolved()
}

fn of_differences(untouched: &Untouched, taxels: impl Iterator<Item = usize>) -> Option<f64> {
    let mut differences = Vec::new();
    for taxel in taxels {
        for run in untouched.clear(taxel) {
            let readings = untouched.readings(taxel, run);
            let pairs = readings.iter().zip(readings.iter().skip(1));
            differences.extend(pairs.map(|(now, next)| next - now));
        }
    }
    let rounding = untouched.step.powi(2) / 12.0;
    (!differences.is_empty()).then(|| {
        let variance = 0.5 * variance(&differences) - rounding;
        variance.max(0.0).sqrt()
    })
}

fn of_clipped(untouched: &Untouched, taxels: impl Iterator<Item = usize>) -> Option<f64> {
    let zeros = taxels.flat_map(|taxel| untouched.runs.column(taxel));
    let stds: Vec<f64> = zeros
        .filter_map(|zero| match zero {
            Zero::Clipped { std, .. } => Some(*std),
            _ => None,
        })
        .collect();
    (!stds.is_empty()).then(|| mean(stds.into_iter()))
}
