//! Time loop: a moving patch over moving or fixed objects.

use super::tree;
use super::{DamperState, Workspace};
use crate::error::Result;
use crate::geometry::{Pose, check_poses};
use crate::objects::Model;
use crate::text::in_range::positive;
use crate::world::{Patch, VelocityPlan};
use ndarray::{Array1, Array2, ArrayView1};

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

/// Moves the patch and the objects along their planned motions from t = 0 and records `n_frames` frames. Frame k is recorded at the time (k + 1) dt, seconds.
///
/// A sphere or triangle of an object that pushed a taxel in the previous frame continues to push this taxel, even from behind the substrate.
///
/// The list `world_from_objects` contains one plan per object; the plan of a fixed object has no phases. The simulation is stable for any `dt`.
///
/// # Errors
/// If `dt` is not positive, the number of plans differs from the number of objects, or a planned pose is invalid, as in [`press`](super::press()).
pub fn simulate(
    patch: &Patch,
    objects: &[Model],
    world_from_patch: &VelocityPlan,
    world_from_objects: &[VelocityPlan],
    dt: f64,
    n_frames: usize,
) -> Result<SimulatedRecording> {
    positive("time step", dt, "s")?;
    let n_taxels = patch.n_taxels();
    let mut recording = SimulatedRecording {
        time: Array1::from_shape_fn(n_frames, |k| (k + 1) as f64 * dt),
        deflection: Array2::zeros((n_frames, n_taxels)),
        force: Array2::zeros((n_frames, n_taxels)),
        n_saturated: 0,
    };
    let mut state = DamperState::at_rest(n_taxels);
    let mut workspace = Workspace::new();
    let mut poses: Vec<Pose> = Vec::with_capacity(objects.len());
    for frame in 0..n_frames {
        let time = recording.time[frame];
        let world_from_patch = world_from_patch.pose_at(time);
        poses.clear();
        poses.extend(
            world_from_objects
                .iter()
                .map(|plan| plan.pose_at(time).seen_from(&world_from_patch)),
        );
        check_poses("object", objects.len(), &poses)?;
        let contact = tree::deflect(patch, objects, &poses, &mut workspace);
        workspace.hold_touched();
        state.step(patch.taxels(), dt, workspace.deflections());
        recording.n_saturated += contact.n_saturated;
        let (mut deflection, mut force) = (
            recording.deflection.row_mut(frame),
            recording.force.row_mut(frame),
        );
        deflection.assign(&ArrayView1::from(&state.deflection));
        force.assign(&ArrayView1::from(&state.force));
    }
    Ok(recording)
}
