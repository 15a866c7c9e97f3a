//! State of a scene at one instant, and the receivers of such frames.

use crate::contact::Wrench;
use crate::contact::equilibrium::{Equilibrium, Touch};
use crate::error::Result;
use crate::geometry::Pose;
use glam::DVec3;

/// State of a scene at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Time since the start, seconds.
    pub time: f64,
    /// One reading for each patch, in the order of the plan.
    pub patches: Vec<PatchReading>,
    /// One reading for each object, in the order of the plan.
    pub objects: Vec<ObjectReading>,
    /// Contacts of planes and objects with free objects. The numbers of planes and objects are those of the plan.
    pub touches: Vec<Touch>,
}

/// Pose, deflections and forces of a patch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchReading {
    /// Pose of the patch, `world_from_patch`.
    pub pose: Pose,
    /// Deflections, metres, shape (n_taxels,).
    pub deflection: Vec<f64>,
    /// Forces along the axes, newtons, shape (n_taxels,), never negative; zero on a taxel that only relaxes. A taxel at its stroke that carries a
    /// free object includes the reaction of its stop. The reaction of a stop to an imposed object is indeterminate and not counted.
    pub force: Vec<f64>,
    /// Forces of the objects on the taxels, newtons, patch frame, shape (n_taxels,). Each is the sum of the axial force, transverse forces of inclined
    /// contacts, and friction. The sum over all taxels is the force of `wrench`.
    pub force3: Vec<DVec3>,
    /// Output of the signal chain, metres or newtons, shape (n_taxels,). `None` if the patch has no signal chain.
    pub signal: Option<Vec<f64>>,
    /// Number of taxels with a force.
    pub n_touched: usize,
    /// Number of taxels at their stroke that an object would push further, or whose stop carries a free object.
    pub n_saturated: usize,
    /// Number of taxels with a grazing contact: see [`GRAZING`](crate::contact::GRAZING).
    pub n_grazing: usize,
    /// Sum of the reactions of all stops to free objects, newtons; included in the forces above.
    pub stop_force: f64,
    /// Wrench of the objects on the patch, in the patch frame, from the forces above and friction.
    pub wrench: Wrench,
    /// Friction of the patch. `None` if the patch has no friction.
    pub friction: Option<FrictionReading>,
    /// Mean rest centre of the taxels, weighted by their forces; metres, patch frame. `None` if no taxel has a force.
    pub center_of_pressure: Option<DVec3>,
}

/// Friction state of a patch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrictionReading {
    /// Friction part of the wrench's force, newtons, patch frame.
    pub shear: DVec3,
    /// Number of taxels with sticking contacts.
    pub n_sticking: usize,
    /// Number of taxels whose contacts slipped during the last step.
    pub n_slipping: usize,
}

/// Pose of an object and how it is determined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectReading {
    /// Pose `world_from_object`. For an escaped object, its last pose.
    pub pose: Pose,
    /// How the pose is determined: imposed, pressed, free or escaped.
    pub held: PoseControl,
    /// For a free object that has not escaped: its equilibrium and the residual of the forces.
    pub balance: Option<Equilibrium>,
}

/// How the pose of an object is determined.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PoseControl {
    /// The pose follows an imposed motion.
    #[default]
    Imposed,
    /// The pose follows an imposed motion, plus a travel that controls the force on a patch.
    Pressed {
        /// Distance from the pose of the imposed motion, metres.
        travel: f64,
        /// Spring force Σ k δ of the patch, newtons.
        force: f64,
        /// Target value of the force, newtons.
        wanted: f64,
    },
    /// The object is free and in equilibrium.
    AtRest,
    /// No equilibrium: the solver reached its iteration limit before all free objects were at rest.
    NotConverged,
    /// Escape: a free object left the skin and has no contact.
    Escaped {
        /// Time of the escape, seconds.
        time: f64,
        /// Direction of the escape: unit vector in the world frame.
        direction: DVec3,
    },
}

/// Tolerance of a reached force, N, relative above 1 N. A smaller tolerance counts rounding errors of stiff skins as missed forces.
const REACHED: f64 = 1e-9;

impl PoseControl {
    /// Returns whether the object is pressed and its force differs from the target.
    pub fn is_off(&self) -> bool {
        match self {
            Self::Pressed { force, wanted, .. } => {
                (force - wanted).abs() > REACHED * wanted.max(1.0)
            }
            _ => false,
        }
    }
}

/// Receiver of frames, which are passed on as soon as they are computed.
pub trait FrameSink {
    /// Receives a frame.
    ///
    /// # Errors
    /// If the simulation must stop, for example because a file cannot be written.
    fn frame(&mut self, frame: &Frame) -> Result<()>;
}

/// Stores all frames, for scenes that fit into memory.
impl FrameSink for Vec<Frame> {
    fn frame(&mut self, frame: &Frame) -> Result<()> {
        self.push(frame.clone());
        Ok(())
    }
}
