//! Estimation of stiffness: the median over frames of the force divided by the sum of deflections. Springs of one stiffness k carry F = k Σ δᵢ; gains of mean 1
//! and
//! crosstalk hardly change the sum. A taxel without a known reading gets the mean of its neighbours. If readings are clipped at zero, the noise of untouched
//! taxels does not cancel, so only readings well above the noise are counted.

use super::robust::{jackknife, median};
use super::saturation::CLIPPED;
use super::{Estimate, NotIdentifiable, RecordedSkin};
use ndarray::Array2;

/// Minimum number of frames for an estimate of the stiffness.
const MIN_FRAMES: usize = 40;
/// Smallest reading that the estimate uses if readings are clipped at zero, in standard deviations of the noise.
const ABOVE_NOISE: f64 = 4.0;
/// Largest noise standard deviation, relative to full scale, for which the stiffness can be estimated from clipped readings.
const MAX_CLIPPED_NOISE: f64 = 0.03;

/// Estimates the stiffness of the taxels' springs, N/m. `clipped_noise` is the standard deviation of the noise if readings are clipped at zero, otherwise
/// `None`.
pub(super) fn estimate(
    skin: &RecordedSkin,
    touched: &Array2<f64>,
    clipped_noise: Option<f64>,
) -> Estimate {
    let forces = skin.forces.as_ref().ok_or("there are no forces")?;
    let stroke = skin.stroke;
    let stroke = stroke.ok_or("nothing says how deep the full scale is")?;
    let noise = clipped_noise.unwrap_or(0.0);
    if noise > MAX_CLIPPED_NOISE {
        return Err("readings are clipped at the zero, and noise hides the light ones".into());
    }
    let counts = |reading: &f64| clipped_noise.is_none() || *reading > ABOVE_NOISE * noise;
    let frames = touched.outer_iter().zip(forces);
    // At the end of a stroke, the force exceeds the spring force.
    let frames = frames.filter(|(frame, _)| !frame.iter().any(|&reading| reading >= CLIPPED));
    let sums = frames.map(|(frame, force)| {
        let filled = skin.filled(frame).into_iter();
        (*force, stroke * filled.filter(counts).sum::<f64>())
    });
    let sums: Vec<(f64, f64)> = sums.filter(|(force, _)| *force > 0.0).collect();
    // Noise has the smallest effect on the sums of the hardest presses.
    let usual = median(&mut sums.iter().map(|(force, _)| *force).collect::<Vec<_>>());
    let hard: Vec<&(f64, f64)> = sums.iter().filter(|(force, _)| *force >= usual).collect();
    if hard.len() < MIN_FRAMES {
        let n = sums.len();
        let why = format!("only {n} frames have a force and no taxel at its full scale");
        return Err(NotIdentifiable(why));
    }
    let found = jackknife(hard.len(), |keep| {
        let kept = hard.iter().enumerate().filter(|(frame, _)| keep(*frame));
        Some(median(
            &mut kept
                .map(|(_, (force, sum))| force / sum)
                .collect::<Vec<_>>(),
        ))
    });
    Ok(found.ok_or("there are too few frames")?)
}
