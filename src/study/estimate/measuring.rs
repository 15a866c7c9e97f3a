//! What it takes to read and to project frames.

use crate::random::Seed;
use crate::sensing::Ensemble;
use crate::signal::SignalStep;
use crate::study::measurement::signal_steps;
use crate::study::plan::Plan;
use crate::study::sweep::Group;
use crate::world::Patch;

/// Seconds to fetch one taxel and to hand on what it reads.
const READ_TAXEL_S: f64 = 1e-9;
/// Seconds to draw noise for one taxel.
const NOISE_S: f64 = 7e-9;
/// Seconds for one tap of a smoothing kernel along one axis, and the same at the other side.
const SMOOTHING_TAP_S: f64 = 6e-10;
/// Seconds to make a force of one deflection.
const FORCE_S: f64 = 3e-10;

/// Processor-seconds to read and project all frames of a group once.
pub(in crate::study) fn measure_s(
    plan: &Plan,
    group: &Group,
    n_touches: usize,
    n_measurements: usize,
) -> f64 {
    let patch = &plan.arrays[group.array];
    let n_taxels = patch.grid.n_taxels();
    let n_read = (n_touches * group.frames * n_taxels) as f64;
    let steps = signal_steps(plan, group, &Seed::new(0));
    let steps = steps.iter().map(|step| step_s(step, patch, group.frames));
    let project_s = project_s(group.ensemble, n_measurements as f64, n_taxels);
    n_read * (READ_TAXEL_S + steps.sum::<f64>() + project_s)
}

/// Seconds of a step of the signal, for one taxel of one frame; none of what has no strength.
fn step_s(step: &SignalStep, patch: &Patch, n_frames: usize) -> f64 {
    let if_any = |strength: f64, seconds: f64| if strength > 0.0 { seconds } else { 0.0 };
    match step {
        SignalStep::Noise(noise) => if_any(noise.std, NOISE_S),
        SignalStep::Smoothing { width } => {
            let taps = 2.0 * (1.0 + 4.0 * width / patch.grid.pitch);
            if_any(*width, SMOOTHING_TAP_S * taps)
        }
        SignalStep::Error {
            error, strengths, ..
        } => {
            let largest = strengths.iter().copied().fold(0.0, f64::max);
            if_any(largest, (error.about().taxel_s)(n_frames))
        }
        SignalStep::Force => FORCE_S,
    }
}

/// Seconds to project one taxel of one frame to m measurements.
pub(in crate::study) fn project_s(ensemble: Ensemble, m: f64, n_taxels: usize) -> f64 {
    (ensemble.about().taxel_s)(m, n_taxels as f64)
}
