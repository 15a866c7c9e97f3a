//! What a scene is like at one instant, and who wants to know.

use crate::contact::Wrench;
use crate::error::Result;
use crate::geometry::Pose;
use glam::DVec3;

/// Everything at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Seconds.
    pub time: f64,
    /// One a patch, in the plan's order.
    pub patches: Vec<PatchReading>,
    /// One an object, in the plan's order.
    pub objects: Vec<ObjectReading>,
}

/// What a patch feels, and where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchReading {
    /// `world_from_patch`.
    pub pose: Pose,
    /// n_taxels, metres.
    pub deflection: Vec<f64>,
    /// n_taxels, newtons along the axes, never negative; zero on a taxel that only relaxes.
    pub force: Vec<f64>,
    /// Taxels with a force.
    pub n_touched: usize,
    /// Taxels at their stroke that an object would push further.
    pub n_saturated: usize,
    /// Taxels whose contact is grazing: see [`GRAZING`](crate::contact::GRAZING).
    pub n_grazing: usize,
    /// What the objects put on the patch, in its frame, without friction and without what stops carry.
    pub wrench: Wrench,
    /// The mean rest centre of the taxels, weighted by their forces; metres, in the patch frame. `None` if none is touched.
    pub center_of_pressure: Option<DVec3>,
}

/// Where an object is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectReading {
    /// `world_from_object`; of an escaped one, where it was last.
    pub pose: Pose,
    /// What decides that.
    pub held: Held,
}

/// What holds an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Held {
    /// Its motion.
    Imposed,
    /// Skin: it is at rest.
    AtRest,
    /// Skin, but no rest was found within the largest number of steps.
    Unsettled,
    /// Nothing: it left the skin, and touches none any more.
    Escaped {
        /// When, seconds.
        time: f64,
        /// Where to: unit, in the world.
        direction: DVec3,
    },
}

/// Who is handed each frame as soon as it is made.
pub trait FrameSink {
    /// Takes a frame; an error ends the simulation.
    fn frame(&mut self, frame: &Frame) -> Result<()>;
}

/// Keeps all: for scenes that fit in memory.
impl FrameSink for Vec<Frame> {
    fn frame(&mut self, frame: &Frame) -> Result<()> {
        self.push(frame.clone());
        Ok(())
    }
}
