//! What a scene is like at one instant, and who wants to know.

use crate::contact::Wrench;
use crate::contact::equilibrium::{Equilibrium, Touch};
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
    /// What planes and objects put on free objects, by the plan's numbers of both.
    pub touches: Vec<Touch>,
}

/// What a patch feels, and where it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchReading {
    /// `world_from_patch`.
    pub pose: Pose,
    /// n_taxels, metres.
    pub deflection: Vec<f64>,
    /// n_taxels, newtons along the axes, never negative; zero on a taxel that only relaxes. Of a taxel at its stroke that carries a free
    /// object, with the reaction of its stop; of an imposed object, what stops carry is not known and not counted.
    pub force: Vec<f64>,
    /// Forces of the objects on the taxels, newtons, patch frame, shape (n_taxels,): along the axes, across them from inclined contacts, and
    /// friction. Their sum is the force of the wrench.
    pub force3: Vec<DVec3>,
    /// n_taxels, what the patch's signal reads: metres or newtons. Of a patch with a signal.
    pub signal: Option<Vec<f64>>,
    /// Taxels with a force.
    pub n_touched: usize,
    /// Taxels at their stroke that an object would push further, or whose stop carries a free object.
    pub n_saturated: usize,
    /// Taxels whose contact is grazing: see [`GRAZING`](crate::contact::GRAZING).
    pub n_grazing: usize,
    /// What the stops of taxels carry of free objects, newtons, of all together; it is in the forces above.
    pub stop_force: f64,
    /// What the objects put on the patch, in its frame, by the forces above; friction with it.
    pub wrench: Wrench,
    /// Of a patch with friction.
    pub friction: Option<FrictionReading>,
    /// The mean rest centre of the taxels, weighted by their forces; metres, in the patch frame. `None` if none is touched.
    pub center_of_pressure: Option<DVec3>,
}

/// What friction does to a patch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrictionReading {
    /// The part of the wrench's force that is friction.
    pub shear: DVec3,
    /// Taxels whose tips go with the object.
    pub n_sticking: usize,
    /// Taxels whose tips have slipped since the step before.
    pub n_slipping: usize,
}

/// Where an object is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectReading {
    /// `world_from_object`; of an escaped one, where it was last.
    pub pose: Pose,
    /// What decides that.
    pub held: Held,
    /// Of a free object that is there: what holds it, and how well that balances its weight.
    pub balance: Option<Equilibrium>,
}

/// What holds an object.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Held {
    /// Its motion.
    #[default]
    Imposed,
    /// Its motion, and a force that a patch is to feel.
    Pressed {
        /// How far it is from where its motion says, metres.
        travel: f64,
        /// Σ k δ of the patch, N.
        force: f64,
        /// What it is to be, N.
        wanted: f64,
    },
    /// What it touches: it is at rest.
    AtRest,
    /// What it touches, but within the largest number of steps no rest was found for all free objects together.
    Unsettled,
    /// Nothing: it left the skin, and touches none any more.
    Escaped {
        /// When, seconds.
        time: f64,
        /// Where to: unit, in the world.
        direction: DVec3,
    },
}

/// How near a force is to what is wanted when it is reached, N. Smaller: rounding in stiff skins counts as a miss.
const REACHED: f64 = 1e-9;

impl Held {
    /// Whether it is pressed, and with another force than is wanted.
    pub fn is_off(&self) -> bool {
        match self {
            Self::Pressed { force, wanted, .. } => {
                (force - wanted).abs() > REACHED * wanted.max(1.0)
            }
            _ => false,
        }
    }
}

/// Who is handed each frame as soon as it is made.
pub trait FrameSink {
    /// Takes a frame; an error ends the simulation.
    ///
    /// # Errors
    /// Whatever ends the simulation.
    fn frame(&mut self, frame: &Frame) -> Result<()>;
}

/// Keeps all: for scenes that fit in memory.
impl FrameSink for Vec<Frame> {
    fn frame(&mut self, frame: &Frame) -> Result<()> {
        self.push(frame.clone());
        Ok(())
    }
}
