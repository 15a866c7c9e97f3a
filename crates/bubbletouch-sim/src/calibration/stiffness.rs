//! Stiffness: force over the sum of deflections, as a median over frames. Springs of one stiffness k carry F = k Σ δᵢ; neither gains of mean 1 nor crosstalk
//! changes the sum much. A taxel of which nothing is known is taken to feel the mean of its neighbours. Where readings are clipped at the zero, noise on
//! untouched taxels does not cancel: only what is well above it counts.

use super::robust::{jackknife, median};
use super::{Estimate, RecordedSkin};
use ndarray::Array2;

/// Readings from which on a taxel may be at its stroke, which carries more than its spring does; of the full scale.
const CLIPPED: f64 = 0.97;
/// Frames, at least.
const FEWEST: usize = 40;
/// Standard deviations of the noise that are well above a zero that clips.
const ABOVE_NOISE: f64 = 4.0;
/// Noise, of the full scale, up to which little is lost so.
const LITTLE: f64 = 0.03;

/// N/m; of readings of a noise, clipped if that is given.
pub(super) fn estimate(
    skin: &RecordedSkin,
    touched: &Array2<f64>,
    clipped_noise: Option<f64>,
) -> Estimate {
    let Some(forces) = &skin.forces else {
        return Estimate::unknown("there are no forces");
    };
    let Some(stroke) = skin.stroke else {
        return Estimate::unknown("nothing says how deep the full scale is");
    };
    let noise = clipped_noise.unwrap_or(0.0);
    if noise > LITTLE {
        return Estimate::unknown(
            "readings are clipped at the zero, and noise hides the light ones",
        );
    }
    let counts = |reading: &f64| clipped_noise.is_none() || *reading > ABOVE_NOISE * noise;
    let frames = touched.outer_iter().zip(forces);
    let frames = frames.filter(|(frame, _)| !frame.iter().any(|&reading| reading >= CLIPPED));
    let sums = frames.map(|(frame, force)| {
        let filled = skin.filled(frame).into_iter();
        (*force, stroke * filled.filter(counts).sum::<f64>())
    });
    let sums: Vec<(f64, f64)> = sums.filter(|(force, _)| *force > 0.0).collect();
    // Noise adds least to the sums of the hardest presses.
    let usual = median(&mut sums.iter().map(|(force, _)| *force).collect::<Vec<_>>());
    let hard: Vec<&(f64, f64)> = sums.iter().filter(|(force, _)| *force >= usual).collect();
    if hard.len() < FEWEST {
        let n = sums.len();
        return Estimate::unknown(format!(
            "only {n} frames have a force and no taxel at its full scale"
        ));
    }
    let found = jackknife(hard.len(), |keep| {
        let kept = hard.iter().enumerate().filter(|(frame, _)| keep(*frame));
        Some(median(
            &mut kept
                .map(|(_, (force, sum))| force / sum)
                .collect::<Vec<_>>(),
        ))
    });
    found.unwrap_or_else(|| Estimate::unknown("there are too few frames"))
}
