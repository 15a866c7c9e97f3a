//! Estimation of drift from changes of the taxels' zero offsets. The zero offset z of a taxel is a Wiener process of standard deviation σ at the end of the
//! recording session. Between the times s and t the zero offsets of all taxels therefore change with the variance σ² (t − s).
//!
//! From the first run of untouched frames to the last: σ² = (Var(z(t) − z(s)) − noise) / (t − s). If most readings are clipped at zero, only
//! positive zeros are visible; by symmetry, equally many are negative. Then σ² = Σ (z(t)² − noise) / Σ t over the visible zeros.

use super::robust::{jackknife, variance};
use super::smoothing::Smoothed;
use super::untouched::{Untouched, Zero};
use super::{Estimate, Measured, RecordedSkin};
use std::f64::consts::FRAC_PI_2;

/// Minimum time between the first and the last frames without contact, as a fraction of the recording session. A shorter time determines the drift at the end
/// of the session poorly.
const SPAN: f64 = 0.25;

/// Estimates the standard deviation of the zero offsets at the end of the recording session, as a fraction of the full scale. `noise` is a standard
/// deviation; `width` is the width of the smoothing in pitches.
pub(super) fn estimate(
    skin: &RecordedSkin,
    untouched: Option<&Untouched>,
    (noise, width): (f64, f64),
) -> Estimate {
    let untouched = untouched.ok_or("there are too few untouched frames")?;
    let span = untouched.times[untouched.times.len() - 1] - untouched.times[0];
    if span < SPAN {
        return Err("untouched frames are from one time of the session".into());
    }
    let n_taxels = skin.n_taxels();
    // Variance of the mean of a run due to noise and rounding.
    let of_mean = noise.powi(2) / untouched.n_run as f64;
    let found = jackknife(n_taxels, |keep| {
        let taxels = (0..n_taxels).filter(|&taxel| keep(taxel));
        match untouched.is_clipped {
            false => moved(untouched, taxels).map(|moved| (moved - 2.0 * of_mean) / span),
            true => above(untouched, taxels, FRAC_PI_2 * of_mean),
        }
    });
    let found = found.ok_or(
        "most untouched readings are the least that the skin reads: zeros below it are lost",
    )?;
    let share = Smoothed::new(skin.shape, width).variance;
    let std = |variance: f64| (variance / share).max(0.0).sqrt();
    // A converter hides values below half of its step.
    let hidden = 0.5 * untouched.step;
    let found = found.map(std);
    Ok(match found.value < hidden {
        true => Measured {
            value: 0.0,
            interval: [0.0, found.interval[1].max(hidden)],
        },
        false => found,
    })
}

/// Returns how much the change of the zero offset varies between taxels (variance). The change is from the first run of frames without contact to the last
/// run.
fn moved(untouched: &Untouched, taxels: impl Iterator<Item = usize>) -> Option<f64> {
    let last = untouched.runs.nrows() - 1;
    let ends = taxels.map(|taxel| [0, last].map(|run| untouched.runs[(run, taxel)]));
    let moves: Vec<f64> = ends
        .filter_map(|ends| match ends {
            [Zero::Clear(first), Zero::Clear(last)] => Some(last - first),
            _ => None,
        })
        .collect();
    (moves.len() > 1).then(|| variance(&moves))
}

/// Returns an estimate of the variance of the zero offsets at the end of the recording session, computed only from offsets above zero.
fn above(untouched: &Untouched, taxels: impl Iterator<Item = usize>, of_mean: f64) -> Option<f64> {
    let (mut squares, mut times) = (0.0, 0.0);
    for taxel in taxels {
        for (time, zero) in untouched.times.iter().zip(untouched.runs.column(taxel)) {
            if let Zero::Clear(zero) | Zero::Clipped { mean: zero, .. } = *zero
                && zero > 0.0
            {
                squares += zero.powi(2) - of_mean;
                times += time;
            }
        }
    }
    (times > 0.0).then(|| squares / times)
}
