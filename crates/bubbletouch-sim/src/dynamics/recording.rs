//! Time loop of a dynamic simulation, and its recorded frames.

use super::state::{Integrator, State};
use super::system::System;
use crate::error::{Error, Result};
use crate::text::in_range::positive;
use ndarray::{Array1, Array2};

/// Duration of the time steps, number of steps, and the frames to record.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps<'a> {
    /// Duration of each time step, seconds.
    pub dt: f64,
    /// Total number of time steps.
    pub n: usize,
    /// Numbers of the time steps after which a frame is recorded, counted from 1, ascending.
    pub frames: &'a [usize],
    /// Energy above which the run counts as diverged, joules; infinite for no limit.
    pub energy_limit: f64,
}

/// Reason why a simulation ended before its last time step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Divergence {
    /// A value of the state is not finite.
    NotFinite,
    /// The energy exceeds the limit of the run.
    EnergyGrowth,
}

/// Deflections and forces of a patch's taxels, recorded over time.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedRecording {
    /// Time of each frame, seconds, shape (n_frames,).
    pub time: Array1<f64>,
    /// Deflections, metres, shape (n_frames, n_taxels).
    pub deflection: Array2<f64>,
    /// Forces, newtons, shape (n_frames, n_taxels).
    pub force: Array2<f64>,
    /// Number of taxels at the end of their stroke, summed over frames.
    pub n_saturated: usize,
}

/// Recorded frames of a dynamic simulation, and the motion of the object.
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicRecording {
    /// Frames of the skin. Deflections may be negative; forces act between object and taxels and include the forces at the end of the stroke.
    pub recording: SimulatedRecording,
    /// Travel of the object in each frame, metres, shape (n_frames,).
    pub travel: Array1<f64>,
    /// Speed of the object in each frame, m/s, shape (n_frames,).
    pub speed: Array1<f64>,
    /// Reason why the run ended early, if it did; later frames are then missing.
    pub divergence: Option<Divergence>,
    /// Number of completed time steps.
    pub n_steps: usize,
}

/// Number of time steps between two checks of the energy. If larger, a diverged run continues longer; if smaller, the checks take more time.
const LOOK_EVERY: usize = 64;

/// Simulates a system from the present state of the integrator, and records frames.
///
/// # Errors
/// If `dt` is not positive, or the frames are not ascending step numbers.
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
        recording: SimulatedRecording {
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
