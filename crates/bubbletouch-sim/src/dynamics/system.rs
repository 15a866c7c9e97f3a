//! Mechanical system: taxels with mass, and an object that can move only along the taxels' axis.

use crate::contact::{Record, Workspace, press};
use crate::error::{Error, Result};
use crate::geometry::{Pose, check_poses};
use crate::objects::Model;
use crate::text::in_range::{finite, positive};
use crate::world::{Patch, VelocityPlan};
use glam::DVec3;

/// Cause of the object's motion along the z axis: gravity, or a motion that is given in advance.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Free motion under gravity.
    Free {
        /// Mass of the object, kg, positive.
        mass: f64,
        /// Acceleration of gravity towards the skin, m/s², positive.
        gravity: f64,
        /// Travel of the object at the start, metres; its speed at the start is zero.
        travel: f64,
    },
    /// Given motion of the object's origin in the patch frame. Only the component along z is used. The travel is 0 at the start.
    Imposed(VelocityPlan),
}

/// Dynamic system: a skin whose taxels have mass, and one object above the skin.
#[derive(Clone, Debug)]
pub struct System<'a> {
    /// Patch of skin whose axes are all +z.
    pub patch: &'a Patch,
    /// Mass of each taxel, kg.
    pub taxel_mass: f64,
    /// Object above the skin.
    pub object: &'a Model,
    /// Pose `patch_from_object` of the object at a travel of 0.
    pub pose: Pose,
    /// Cause of the object's motion along the z axis.
    pub drive: Drive,
    starts: Vec<f64>,
    /// Masses of the balls stacked on the object, from below, kg.
    riders: Vec<f64>,
}

impl<'a> System<'a> {
    /// Creates a system and checks it. Taxels that the object does not touch within `reach` metres of travel are never pushed.
    ///
    /// # Errors
    /// If a mass, gravity or reach is not positive, the travel or the pose is not finite, or the axis of a taxel is not +z (the error names the first such taxel).
    pub fn new(
        patch: &'a Patch,
        taxel_mass: f64,
        object: &'a Model,
        pose: Pose,
        drive: Drive,
        reach: f64,
    ) -> Result<Self> {
        positive("taxel mass", taxel_mass, "kg")?;
        positive("reach of an object on a guide", reach, "m")?;
        check_poses("object", 1, &[pose])?;
        if let Drive::Free {
            mass,
            gravity,
            travel,
        } = drive
        {
            finite("travel of the object at the start", travel, "m")?;
            positive("object mass", mass, "kg")?;
            positive("gravity", gravity, "m/s²")?;
        }
        let axes = patch.layout().axes();
        if let Some(taxel) = axes.iter().position(|&axis| axis != DVec3::Z) {
            return Err(Error::input(
                format!("skin patch {}, taxel {}", patch.name(), taxel + 1),
                format!("axis {}", axes[taxel]),
                "an axis along z: the object's guide runs along the taxels",
            ));
        }
        Ok(Self {
            starts: starts(patch, object, &pose, reach),
            patch,
            taxel_mass,
            object,
            pose,
            drive,
            riders: Vec::new(),
        })
    }

    /// Stacks balls on the object. Each ball equals the object and moves freely along the same line under gravity. `masses` are listed from below, kg. At the
    /// start, adjacent balls touch.
    ///
    /// # Errors
    /// If a mass is not positive, or the object is not one free sphere.
    pub fn stacked(mut self, masses: &[f64]) -> Result<Self> {
        for &mass in masses {
            positive("mass of a stacked ball", mass, "kg")?;
        }
        let n_spheres = self
            .object
            .spheres()
            .map_or(0, |spheres| spheres.n_spheres());
        if n_spheres != 1 || !matches!(self.drive, Drive::Free { .. }) {
            let allowed = "one sphere that is free";
            return Err(Error::input(
                "object below stacked balls",
                "another one",
                allowed,
            ));
        }
        self.riders = masses.to_vec();
        Ok(self)
    }

    /// Returns the masses of the balls stacked on the object, from below, kg.
    pub fn riders(&self) -> &[f64] {
        &self.riders
    }

    /// Returns the number of taxels of the skin.
    pub fn n_taxels(&self) -> usize {
        self.starts.len()
    }

    /// Returns the travel at which the object first touches each taxel, metres; infinite for taxels that the object does not touch.
    pub fn starts(&self) -> &[f64] {
        &self.starts
    }

    /// Returns the travel at which the first taxel reaches the end of its stroke, metres; the object cannot move further.
    pub fn floor(&self) -> f64 {
        let taxels = self.patch.taxels();
        let ends = self.starts.iter().enumerate();
        ends.map(|(taxel, start)| start + taxels.at(taxel).stroke)
            .fold(f64::INFINITY, f64::min)
    }

    /// Returns the travel of the object before the first time step, metres.
    pub fn first_travel(&self) -> f64 {
        match &self.drive {
            Drive::Free { travel, .. } => *travel,
            Drive::Imposed(plan) => self.imposed(plan, 0.0),
        }
    }

    /// Returns the travel of the object at a time, metres, for a motion that is given in advance.
    pub(super) fn imposed(&self, plan: &VelocityPlan, time: f64) -> f64 {
        plan.pose_at(0.0).translation.z - plan.pose_at(time).translation.z
    }
}

/// Returns the travel at which the object first touches each taxel, metres. The deflection of a pushed taxel grows with the travel, so one press at the
/// travel `reach` yields all values.
fn starts(patch: &Patch, object: &Model, pose: &Pose, reach: f64) -> Vec<f64> {
    let mut workspace = Workspace::new();
    let low = Pose::new(pose.rotation, pose.translation - reach * DVec3::Z);
    let placed = (std::slice::from_ref(object), &[low][..]);
    press(patch, placed, Record::Contacts, &mut workspace);
    let mut starts = vec![f64::INFINITY; patch.n_taxels()];
    for contact in workspace.contacts() {
        starts[contact.taxel] = reach - contact.needed;
    }
    starts
}
