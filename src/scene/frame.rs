//! State of a scene at one time (frame), receivers of frames, and the summary of a scene.

use crate::contact::Wrench;
use crate::contact::equilibrium::{Equilibrium, RigidContact};
use crate::error::Result;
use crate::geometry::Pose;
use glam::DVec3;

/// State of a scene at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Time since the start of the scene, seconds.
    pub time: f64,
    /// Reading of each patch of skin, in the order of the plan.
    pub patches: Vec<PatchReading>,
    /// Reading of each object, in the order of the plan.
    pub objects: Vec<ObjectReading>,
    /// Contacts of free objects with planes or with other objects. Planes and objects have their numbers in the plan.
    pub touches: Vec<RigidContact>,
}

/// Pose, deflections and forces of a patch of skin at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchReading {
    /// Pose of the patch, `world_from_patch`.
    pub pose: Pose,
    /// Deflections of the taxels, metres, shape (n_taxels,).
    pub deflection: Vec<f64>,
    /// Forces along the taxel axes, newtons, shape (n_taxels,), at least 0; zero on a taxel without contact. If a taxel at its stroke carries a free object,
    /// the reaction of its stop is included. The reaction of a stop to an imposed object is indeterminate and not included.
    pub force: Vec<f64>,
    /// Force of the objects on each taxel, newtons, patch frame, shape (n_taxels,). Each force is the sum of the axial force, the transverse force of an
    /// inclined contact, and friction. The sum over all taxels is the force of `wrench`.
    pub force3: Vec<DVec3>,
    /// Output of the signal chain, metres or newtons, shape (n_taxels,). `None` if the patch has no signal chain.
    pub signal: Option<Vec<f64>>,
    /// Number of taxels with a positive force.
    pub n_touched: usize,
    /// Number of taxels at their stroke (maximum deflection) that an object pushes further or that support a free object.
    pub n_saturated: usize,
    /// Number of taxels whose contact is grazing: the contact normal is almost perpendicular to the taxel axis (`contact::GRAZING`).
    pub n_grazing: usize,
    /// Sum of the forces of all stops (taxels at their stroke) on free objects, newtons; included in `force` and `force3`.
    pub stop_force: f64,
    /// Force and torque of the objects on the patch, in the patch frame, including friction.
    pub wrench: Wrench,
    /// Friction state of the patch; `None` if the patch has no friction.
    pub friction: Option<FrictionReading>,
    /// Centre of pressure: mean rest centre of the taxels, weighted by their forces, metres, patch frame. `None` if no taxel has a force.
    pub center_of_pressure: Option<DVec3>,
}

/// Friction force on a patch, and numbers of sticking and slipping taxels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrictionReading {
    /// Friction force on the patch, newtons, patch frame; this force is included in the wrench of the patch.
    pub shear: DVec3,
    /// Number of taxels in sticking contact, that is, without sliding.
    pub n_sticking: usize,
    /// Number of taxels whose contacts slid during the last step.
    pub n_slipping: usize,
}

/// Pose of an object at one time, and the rule that determines the pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectReading {
    /// Pose of the object, `world_from_object`; for an escaped object, the last pose before the escape.
    pub pose: Pose,
    /// Rule by which the pose is determined: imposed, pressed, free or escaped.
    pub held: PoseControl,
    /// Equilibrium of a free object, with the force residual; `None` for other objects and for escaped objects.
    pub balance: Option<Equilibrium>,
}

/// Rule by which the pose of an object is determined.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PoseControl {
    /// The pose follows an imposed motion.
    #[default]
    Imposed,
    /// The pose follows an imposed motion, and the object also travels along a line to control the force on a patch.
    Pressed {
        /// Distance of the object from the pose of its imposed motion, metres.
        travel: f64,
        /// Total spring force of the patch, newtons.
        force: f64,
        /// Target of the patch's total spring force, N.
        wanted: f64,
    },
    /// The object moves freely and is in equilibrium.
    AtRest,
    /// The object is free, but the solver reached its iteration limit before an equilibrium.
    NotConverged,
    /// The object was free, left the skin and no longer has any contact.
    Escaped {
        /// Time of the escape, seconds.
        time: f64,
        /// Direction of the escape, a unit vector in the world frame.
        direction: DVec3,
    },
}

/// Tolerance for reaching a target force, N (relative for forces above 1 N). With a smaller value, rounding errors of stiff skins count as missed forces.
const REACHED: f64 = 1e-9;

impl PoseControl {
    /// Returns whether the object is pressed and the force on its patch differs from the target.
    pub fn is_off(&self) -> bool {
        match self {
            Self::Pressed { force, wanted, .. } => {
                (force - wanted).abs() > REACHED * wanted.max(1.0)
            }
            _ => false,
        }
    }
}

/// Receiver of frames; each frame is passed on as soon as it is computed.
pub trait FrameSink {
    /// Receives the next frame of a scene.
    ///
    /// # Errors
    /// If the simulation must stop, for example because a file cannot be written.
    fn frame(&mut self, frame: &Frame) -> Result<()>;
}

/// Frame receiver that stores all frames, for scenes that fit into memory.
impl FrameSink for Vec<Frame> {
    fn frame(&mut self, frame: &Frame) -> Result<()> {
        self.push(frame.clone());
        Ok(())
    }
}

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
