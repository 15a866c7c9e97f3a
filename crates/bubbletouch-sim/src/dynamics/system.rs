//! What moves: taxels with mass, and an object on a guide.

use crate::contact::{Workspace, press_with_contacts};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::objects::Model;
use crate::text::in_range::positive;
use crate::world::{Patch, VelocityPlan};
use glam::DVec3;

/// What moves the object along its guide.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Its weight.
    Free {
        /// M, kg, positive.
        mass: f64,
        /// g, m/s², towards the skin, positive.
        gravity: f64,
        /// Where it is let go, at rest: metres of travel.
        travel: f64,
    },
    /// A motion, whatever it costs: of the object's origin in the patch frame. Only the way along z counts; the travel is 0 where it
    /// starts.
    Imposed(VelocityPlan),
}

/// A skin with mass and one object above it.
#[derive(Clone, Debug)]
pub struct System<'a> {
    /// The skin; all its axes are +z.
    pub patch: &'a Patch,
    /// m of each taxel, kg.
    pub taxel_mass: f64,
    /// The object.
    pub object: &'a Model,
    /// `patch_from_object` at a travel of 0.
    pub pose: Pose,
    /// What moves it.
    pub drive: Drive,
    starts: Vec<f64>,
    /// Masses of the balls on top of it, from below, kg.
    riders: Vec<f64>,
}

impl<'a> System<'a> {
    /// Checks and prepares a system. Taxels that the object does not meet within `reach` metres of travel are never pushed.
    ///
    /// # Errors
    /// The error names a mass, a gravity or a reach that is not positive, and the first taxel whose axis is not +z.
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
        if let Drive::Free { mass, gravity, .. } = drive {
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

    /// Balls like the object stacked on top of it, each free on the same guide under the same gravity: their masses from below, kg. They lie
    /// on each other where the object is let go.
    ///
    /// # Errors
    /// A mass that is not positive; an object that is not one free sphere.
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

    /// Masses of the balls on top of the object, from below, kg.
    pub fn riders(&self) -> &[f64] {
        &self.riders
    }

    /// How many taxels.
    pub fn n_taxels(&self) -> usize {
        self.starts.len()
    }

    /// The travel at which the object meets each taxel, metres; infinite for those that it does not meet.
    pub fn starts(&self) -> &[f64] {
        &self.starts
    }

    /// The travel at which the first taxel is at its stroke, metres: no rigid stop lets the object go further.
    pub fn floor(&self) -> f64 {
        let taxels = self.patch.taxels();
        let ends = self.starts.iter().enumerate();
        ends.map(|(taxel, start)| start + taxels.at(taxel).stroke)
            .fold(f64::INFINITY, f64::min)
    }

    /// The travel before the first step, metres.
    pub fn first_travel(&self) -> f64 {
        match &self.drive {
            Drive::Free { travel, .. } => *travel,
            Drive::Imposed(plan) => self.imposed(plan, 0.0),
        }
    }

    /// Where a motion has the object at a time, metres of travel.
    pub(super) fn imposed(&self, plan: &VelocityPlan, time: f64) -> f64 {
        plan.pose_at(0.0).translation.z - plan.pose_at(time).translation.z
    }
}

/// Along the axes a taxel that is pushed is pushed as much further as the object goes: one press at the end of the reach tells all.
fn starts(patch: &Patch, object: &Model, pose: &Pose, reach: f64) -> Vec<f64> {
    let mut workspace = Workspace::new();
    let low = Pose::new(pose.rotation, pose.translation - reach * DVec3::Z);
    press_with_contacts(patch, std::slice::from_ref(object), &[low], &mut workspace);
    let mut starts = vec![f64::INFINITY; patch.n_taxels()];
    for contact in workspace.contacts() {
        starts[contact.taxel] = reach - contact.needed;
    }
    starts
}
