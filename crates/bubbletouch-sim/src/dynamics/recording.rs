//! The loop, and what it keeps.

use super::state::{Integrator, State};
use super::system::System;
use crate::contact::Recording;
use crate::error::{Error, Result};
use crate::text::in_range::positive;
use ndarray::{Array1, Array2};

/// How far to go, and what to keep.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps<'a> {
    /// Seconds a step.
    pub dt: f64,
    /// How many.
    pub n: usize,
    /// The steps after which a frame is kept, from 1, ascending.
    pub frames: &'a [usize],
    /// Joules that everything together never has unless it has gained energy; infinite to never stop.
    pub energy_limit: f64,
}

/// Why a run was stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Divergence {
    /// A number is not finite.
    NotFinite,
    /// There is more energy than the limit.
    EnergyGrowth,
}

/// Frames over time, and the object's part in them.
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicRecording {
    /// What the skin feels: deflections may be negative, and forces are those between object and taxels, what stops carry included.
    pub recording: Recording,
    /// x, n_frames, metres.
    pub travel: Array1<f64>,
    /// ẋ, n_frames, m/s.
    pub speed: Array1<f64>,
    /// Why it ended early, if it did; frames that were not reached are not there.
    pub divergence: Option<Divergence>,
    /// Steps that were made.
    pub n_steps: usize,
}

/// Energy is looked at once in so many steps: more often costs time, less often lets a diverged run go on.
const LOOK_EVERY: usize = 64;

/// Steps a system from where the integrator is.
///
/// # Errors
/// The error names a `dt` that is not positive, and frames that are not ascending within the steps.
pub fn run(
    system: &System,
    integrator: &mut dyn Integrator,
    steps: &Steps,
) -> Result<DynamicRecording> {
    check(steps)?;
    let mut kept: Vec<State> = Vec::with_capacity(steps.frames.len());
    let mut divergence = None;
    let mut n_steps = 0;
    while n_steps < steps.n && divergence.is_none() {
        integrator.step(system, steps.dt);
        n_steps += 1;
        let is_frame = steps.frames.get(kept.len()) == Some(&n_steps);
        if is_frame || n_steps % LOOK_EVERY == 0 || n_steps == steps.n {
            let state = integrator.state(system);
            divergence = look(system, state, steps.energy_limit);
            if is_frame && divergence.is_none() {
                kept.push(state.clone());
            }
        }
    }
    Ok(DynamicRecording {
        divergence,
        n_steps,
        ..record(system, &kept)
    })
}

fn check(steps: &Steps) -> Result<()> {
    positive("time step", steps.dt, "s")?;
    let is_rising = steps.frames.windows(2).all(|pair| pair[0] < pair[1]);
    let are_within = steps.frames.iter().all(|step| (1..=steps.n).contains(step));
    if !(is_rising && are_within) {
        let allowed = format!("ascending steps from 1 to {}", steps.n);
        return Err(Error::input(
            "frames",
            format!("{:?}", steps.frames),
            allowed,
        ));
    }
    Ok(())
}

fn look(system: &System, state: &State, limit: f64) -> Option<Divergence> {
    let energy = state.energy(system);
    match () {
        () if !energy.is_finite() => Some(Divergence::NotFinite),
        () if energy > limit => Some(Divergence::EnergyGrowth),
        () => None,
    }
}

fn record(system: &System, kept: &[State]) -> DynamicRecording {
    let (n_frames, n_taxels) = (kept.len(), system.n_taxels());
    let all = |of: fn(&State) -> &Vec<f64>| {
        Array2::from_shape_fn((n_frames, n_taxels), |(frame, taxel)| {
            of(&kept[frame])[taxel]
        })
    };
    let deflection = all(|state| &state.deflection);
    let taxels = system.patch.taxels();
    let at_stroke = deflection.indexed_iter();
    let at_stroke = at_stroke.filter(|((_, taxel), d)| **d >= taxels.at(*taxel).stroke);
    let n_saturated = at_stroke.count();
    DynamicRecording {
        recording: Recording {
            time: kept.iter().map(|state| state.time).collect(),
            force: all(|state| &state.force),
            n_saturated,
            deflection,
        },
        travel: kept.iter().map(|state| state.travel).collect(),
        speed: kept.iter().map(|state| state.speed).collect(),
        divergence: None,
        n_steps: 0,
    }
}
