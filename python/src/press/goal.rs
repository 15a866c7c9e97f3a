//! Goal of a press: pose, depth, force or travel.

use crate::arrays::view;
use crate::errors::bad_input;
use bubbletouch::Result;
use bubbletouch::contact::{self, Approach, Contact, Row, Workspace, first_contact};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::Model;
use bubbletouch::world::Patch;
use glam::DVec3;
use pyo3::prelude::*;

/// Goal of presses: its kind (pose, depth, force or travel), and one amount for all poses or one amount per pose.
pub struct Goal {
    kind: fn(f64) -> contact::Goal,
    amounts: Vec<f64>,
}

impl Goal {
    /// Creates a goal from at most one of the three amounts; without any, the goal is the pose itself.
    ///
    /// # Errors
    /// If two amounts are given, an amount is not a number, or a depth is negative.
    pub fn from_arguments(
        depth: Option<&Bound<PyAny>>,
        travel: Option<&Bound<PyAny>>,
        force: Option<&Bound<PyAny>>,
    ) -> PyResult<Self> {
        type Kind = fn(f64) -> contact::Goal;
        type IsAllowed = fn(f64) -> bool;
        let (place, given, kind, is_allowed, allowed): (_, _, Kind, IsAllowed, _) =
            match (depth, travel, force) {
                (None, None, None) => {
                    return Ok(Self {
                        kind: |_| contact::Goal::Pose,
                        amounts: vec![0.0],
                    });
                }
                (Some(depth), None, None) => (
                    "depth",
                    depth,
                    contact::Goal::Depth,
                    |x| x.is_finite() && x >= 0.0,
                    "a finite number of metres, zero or more",
                ),
                (None, Some(travel), None) => (
                    "travel",
                    travel,
                    contact::Goal::Travel,
                    f64::is_finite,
                    "a finite number of metres",
                ),
                (None, None, Some(force)) => (
                    "force",
                    force,
                    contact::Goal::Force,
                    |x| x.is_finite() && x > 0.0,
                    "a finite positive number of newtons",
                ),
                _ => {
                    let given = "more than one of depth, travel and force";
                    return Err(bad_input("press", given, "one of them, or none"));
                }
            };
        let amounts = match given.extract::<f64>() {
            Ok(amount) => vec![amount],
            Err(_) => {
                let is_shape = |shape: &[usize]| shape.len() == 1;
                view(place, given, "a number, or (n,)", is_shape, |array| {
                    Ok(array.iter().copied().collect())
                })?
            }
        };
        match amounts.iter().find(|amount| !is_allowed(**amount)) {
            Some(bad) => Err(bad_input(place, bad, allowed)),
            None => Ok(Self { kind, amounts }),
        }
    }

    /// Checks that there is one amount for all n poses, or one per pose.
    ///
    /// # Errors
    /// If the number of amounts is wrong.
    pub fn check(&self, n_poses: usize) -> PyResult<()> {
        let n = self.amounts.len();
        if n == 1 || n == n_poses {
            return Ok(());
        }
        let allowed = "one for all poses, or one each";
        Err(bad_input(
            "press",
            format!("{n} amounts for {n_poses} poses"),
            allowed,
        ))
    }

    /// Returns the kind of the goal with an amount of 0; used where only the kind matters.
    pub fn kind(&self) -> contact::Goal {
        (self.kind)(0.0)
    }

    /// Returns the amount of the press with the given number: metres or newtons.
    pub fn amount(&self, number: usize) -> f64 {
        match self.amounts[..] {
            [amount] => amount,
            _ => self.amounts[number],
        }
    }

    /// Returns the press of the given number, on objects with one pose each.
    pub fn of_pose<'a>(
        &self,
        number: usize,
        patch: &'a Patch,
        (models, poses): (&'a [Model], &'a [Pose]),
    ) -> Press<'a> {
        Press {
            patch,
            models,
            poses,
            goal: (self.kind)(self.amount(number)),
        }
    }
}

/// Press of a patch on objects at one pose.
pub struct Press<'a> {
    patch: &'a Patch,
    models: &'a [Model],
    poses: &'a [Pose],
    goal: contact::Goal,
}

impl Press<'_> {
    /// Computes the deflections of the taxels into the workspace; returns `None` if the patch touches nothing.
    ///
    /// # Errors
    /// If a force cannot be reached.
    pub fn deflect(&self, workspace: &mut Workspace) -> Result<Option<Contact>> {
        contact::press(self.patch, self.models, self.poses, self.goal, workspace)
    }

    /// Computes the deflections of the taxels and writes them into a row of the output; previous values of the row are overwritten.
    ///
    /// # Errors
    /// If a force cannot be reached.
    pub fn deflect_into(
        &self,
        (row, is_zeros): (Row, bool),
        workspace: &mut Workspace,
    ) -> Result<Option<Contact>> {
        let press = match is_zeros {
            true => contact::press_onto_zeros,
            false => contact::press_into,
        };
        let (patch, models, poses) = (self.patch, self.models, self.poses);
        press(patch, models, poses, self.goal, row, workspace)
    }

    /// Computes the press again (deflections are equal up to rounding) and stores its contacts in the workspace. `pressed` is the result of the press. If
    /// nothing is touched, returns `None`; the content of the workspace is then undefined.
    ///
    /// # Errors
    /// If a force cannot be reached.
    pub fn meet(
        &self,
        pressed: Option<Contact>,
        workspace: &mut Workspace,
    ) -> Result<Option<Contact>> {
        let (patch, models, poses) = (self.patch, self.models, self.poses);
        let approach = Approach::new(patch, DVec3::Z)?;
        if let (Some(pressed), false) = (pressed, self.goal == contact::Goal::Pose) {
            // The contacts of a flat patch depend on its travel only.
            let travel = pressed.travel;
            let met = approach.contacts_at_travel(models, poses, travel, workspace)?;
            if let Some(met) = met {
                return Ok(Some(met).filter(|met| met.n_touched > 0));
            }
        }
        let to_depth = |depth, workspace: &mut Workspace| {
            approach.press_to_depth(models, poses, depth, workspace)
        };
        match self.goal {
            contact::Goal::Pose => contact::press_with_contacts(patch, models, poses, workspace),
            contact::Goal::Depth(depth) => to_depth(depth, workspace),
            contact::Goal::Travel(travel) => {
                let first = first_contact(patch, models, poses, workspace)?;
                let depth = first.map(|first| travel - first);
                match depth.filter(|depth| *depth > 0.0) {
                    Some(depth) => to_depth(depth, workspace),
                    None => Ok(None),
                }
            }
            contact::Goal::Force(force) => approach.press_to_force(models, poses, force, workspace),
        }
    }
}
