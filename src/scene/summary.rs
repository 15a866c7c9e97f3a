//! Summary of a simulation: the largest values over all frames.

use super::frame::{Frame, FrameSink, PoseControl};
use crate::error::Result;
use crate::geometry::Pose;

/// Largest values of a patch over all frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PatchPeaks {
    /// Largest deflection of any taxel, metres.
    pub deflection: f64,
    /// Largest force of the objects on the patch, newtons: the magnitude of the force of its wrench.
    pub force: f64,
    /// Largest number of taxels with a positive force in a frame.
    pub n_touched: usize,
    /// Largest number of taxels at their stroke (maximum deflection) in a frame.
    pub n_saturated: usize,
    /// Largest number of taxels with a grazing contact in a frame.
    pub n_grazing: usize,
    /// Largest friction force on the patch, newtons.
    pub shear: f64,
    /// Largest number of taxels in sticking contact in any frame.
    pub n_sticking: usize,
    /// Largest number of taxels with slipping contacts in a frame.
    pub n_slipping: usize,
}

/// Summary of the motion of one object over all frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObjectSummary {
    /// Rule by which the pose of the object was determined in the last frame.
    pub held: PoseControl,
    /// Pose `world_from_object` in the last frame; for an escaped object, the last pose before the escape.
    pub pose: Pose,
    /// Number of frames in which the object was not in equilibrium.
    pub n_unsettled: usize,
    /// Largest residual of force and torque of a free object over all frames, relative to its weight; 0 for other objects.
    pub imbalance: f64,
    /// Number of frames in which the force on a pressed object differs from its target.
    pub n_off: usize,
}

/// Frame receiver that computes the summary of a scene without storing frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Number of frames received so far.
    pub n_frames: usize,
    /// Largest values of each patch, in the order of the plan.
    pub patches: Vec<PatchPeaks>,
    /// Summary of the motion of each object, in the order of the plan.
    pub objects: Vec<ObjectSummary>,
}

impl FrameSink for Summary {
    fn frame(&mut self, frame: &Frame) -> Result<()> {
        self.n_frames += 1;
        self.patches
            .resize(frame.patches.len(), PatchPeaks::default());
        for (peaks, patch) in self.patches.iter_mut().zip(&frame.patches) {
            let deepest = patch.deflection.iter().copied().fold(0.0, f64::max);
            peaks.deflection = peaks.deflection.max(deepest);
            peaks.force = peaks.force.max(patch.wrench.force.length());
            peaks.n_touched = peaks.n_touched.max(patch.n_touched);
            peaks.n_saturated = peaks.n_saturated.max(patch.n_saturated);
            peaks.n_grazing = peaks.n_grazing.max(patch.n_grazing);
            if let Some(friction) = &patch.friction {
                peaks.shear = peaks.shear.max(friction.shear.length());
                peaks.n_sticking = peaks.n_sticking.max(friction.n_sticking);
                peaks.n_slipping = peaks.n_slipping.max(friction.n_slipping);
            }
        }
        self.objects
            .resize(frame.objects.len(), ObjectSummary::default());
        for (summary, object) in self.objects.iter_mut().zip(&frame.objects) {
            let imbalance = object.balance.map_or(0.0, |balance| balance.imbalance);
            summary.held = object.held;
            summary.pose = object.pose;
            summary.n_unsettled += usize::from(object.held == PoseControl::NotConverged);
            summary.imbalance = summary.imbalance.max(imbalance);
            summary.n_off += usize::from(object.held.is_off());
        }
        Ok(())
    }
}
