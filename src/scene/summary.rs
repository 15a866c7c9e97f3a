//! What came of a scene: its largest numbers, frame by frame.

use super::frame::{Frame, FrameSink, Held};
use crate::error::Result;

/// The most that a patch felt in any frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PatchPeaks {
    /// Metres.
    pub deflection: f64,
    /// Along the axes, of all taxels together, newtons.
    pub force: f64,
    /// Taxels with a force.
    pub n_touched: usize,
    /// Taxels at their stroke.
    pub n_saturated: usize,
    /// Taxels in grazing contact.
    pub n_grazing: usize,
    /// Friction of all taxels together, newtons.
    pub shear: f64,
    /// Taxels whose tips go with the object.
    pub n_sticking: usize,
    /// Taxels whose tips have slipped.
    pub n_slipping: usize,
}

/// What came of an object.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObjectSummary {
    /// What holds it in the last frame.
    pub held: Held,
    /// Frames in which it was unsettled.
    pub n_unsettled: usize,
    /// The most of a free object's [imbalance](crate::contact::equilibrium::Equilibrium::imbalance) in any frame; 0 of others.
    pub imbalance: f64,
    /// Frames in which it was pressed with another force than was wanted.
    pub n_off: usize,
}

/// Peaks so far; a sink that keeps no frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Frames seen.
    pub n_frames: usize,
    /// One a patch, in the plan's order.
    pub patches: Vec<PatchPeaks>,
    /// One an object, in the plan's order.
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
            peaks.force = peaks.force.max(patch.force.iter().sum());
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
            summary.n_unsettled += usize::from(object.held == Held::Unsettled);
            summary.imbalance = summary.imbalance.max(imbalance);
            summary.n_off += usize::from(object.held.is_off());
        }
        Ok(())
    }
}
