//! Robots and patches of a scene, checked and ready for simulation, and the bodies that carry them.

use super::frame::PatchReading;
use crate::geometry::Pose;
use crate::random::Seed;
use crate::signal::{Chain, Quantity, Recording, SignalWorkspace};
use crate::world::{JointTrajectory, MeshFolders, Motion, Patch, Robot, Shears};

/// Robot of a scene, checked and ready for simulation.
#[derive(Clone, Debug)]
pub struct PlannedRobot {
    /// Name of the robot in the scene.
    pub name: String,
    /// Links and joints of the robot, read from its file.
    pub robot: Robot,
    /// Folders in which mesh files of the links are searched.
    pub meshes: MeshFolders,
    /// Motion of the robot's base.
    pub base: Motion,
    /// Motion of the joints; `None` if all joints stay at their rest positions.
    pub joints: Option<JointTrajectory>,
}

impl PlannedRobot {
    /// Returns the time at which the robot's motion ends, seconds.
    pub fn end(&self) -> f64 {
        let joints = self.joints.as_ref().map_or(0.0, JointTrajectory::end);
        self.base.end().max(joints)
    }
}

/// Body in whose frame the pose of a patch or an object is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carrier {
    /// The world.
    World,
    /// Link of a robot.
    Link {
        /// Index of the robot in the scene.
        robot: usize,
        /// Index of the link in the robot.
        link: usize,
    },
    /// Object of the scene, given by its index; it carries patches only.
    Object(usize),
}

/// Patch of a scene, checked and ready for simulation.
#[derive(Clone, Debug)]
pub struct PlannedPatch {
    /// Taxels and layout of the patch.
    pub skin: Patch,
    /// Body that carries the patch.
    pub carrier: Carrier,
    /// Pose of the patch on its carrier, `carrier_from_patch`.
    pub at: Pose,
    /// Tangential springs of the taxels; `None` if the patch has no friction.
    pub shears: Option<Shears>,
    /// Signal chain of the patch (conversion of deflections to sensor readings); `None` if it has no steps.
    pub signal: Option<PlannedSignal>,
    /// Notes on the layout file of the patch; empty for other layouts.
    pub notes: Vec<String>,
}

impl PlannedPatch {
    /// Returns whether the state of the patch depends on earlier steps, as with dampers or friction.
    pub fn remembers(&self) -> bool {
        let mut taxels = self.skin.taxels().all().iter();
        self.shears.is_some() || taxels.any(|taxel| taxel.damping > 0.0)
    }

    /// Returns whether any taxel has a positive friction coefficient.
    pub fn has_friction(&self) -> bool {
        let shears = self.shears.iter().flat_map(|shears| shears.all());
        shears.into_iter().any(|shear| shear.friction > 0.0)
    }
}

/// Checked signal chain of a patch, which converts deflections to sensor readings.
#[derive(Clone, Debug)]
pub struct PlannedSignal {
    pub(super) chain: Chain,
    /// Physical quantity that enters the signal chain: deflection or force.
    pub(super) begins: Quantity,
}

impl PlannedSignal {
    /// Returns the physical quantity of the sensor readings: deflection or force.
    pub fn quantity(&self) -> Quantity {
        self.chain.quantity()
    }

    /// Computes the sensor readings of a patch and writes them to `reading`. The seed of the noise is `name`; `share` is the elapsed fraction of the scene's
    /// duration, 0 to 1.
    pub(super) fn read(
        &self,
        reading: &mut PatchReading,
        name: &Seed,
        share: f64,
        scratch: &mut SignalWorkspace,
    ) {
        let felt = match self.begins {
            Quantity::Deflection => &reading.deflection,
            Quantity::Force => &reading.force,
        };
        let signal = reading.signal.get_or_insert_default();
        signal.clone_from(felt);
        let recording = Recording {
            frames: signal,
            rates: None,
            n_before: 0,
            interval: None,
            time: Some(share),
        };
        self.chain.apply_recording(recording, name, scratch);
    }
}
