//! How far a press goes.

use crate::arrays::view;
use crate::errors::bad_input;
use bubbletouch::Result;
use bubbletouch::contact::{
    Approach, Contact, Workspace, first_contact, press_at_pose, press_to_depth, press_to_force,
    press_to_travel, press_with_contacts,
};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::Model;
use bubbletouch::world::Patch;
use glam::DVec3;
use pyo3::prelude::*;
use std::slice::from_ref;

/// Until when, and how much of it: one number for all poses or one each.
pub struct Goal {
    until: Until,
    amounts: Vec<f64>,
}

/// What ends a press.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Until {
    /// Nothing: the patch is read where it is.
    Pose,
    /// Metres past first contact.
    Depth,
    /// Metres from the pose.
    Travel,
    /// Newtons that the springs carry.
    Force,
}

impl Goal {
    /// At most one of the three; none: right at the pose.
    ///
    /// # Errors
    /// Two of them; a number that is none, or a negative depth.
    pub fn of(
        depth: Option<&Bound<PyAny>>,
        travel: Option<&Bound<PyAny>>,
        force: Option<&Bound<PyAny>>,
    ) -> PyResult<Self> {
        let (place, until, given) = match (depth, travel, force) {
            (None, None, None) => {
                return Ok(Self {
                    until: Until::Pose,
                    amounts: vec![0.0],
                });
            }
            (Some(depth), None, None) => ("depth", Until::Depth, depth),
            (None, Some(travel), None) => ("travel", Until::Travel, travel),
            (None, None, Some(force)) => ("force", Until::Force, force),
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
        let (is_allowed, allowed): (fn(f64) -> bool, _) = match until {
            Until::Depth => (
                |x: f64| x.is_finite() && x >= 0.0,
                "a finite number of metres, zero or more",
            ),
            Until::Force => (
                |x| x.is_finite() && x > 0.0,
                "a finite positive number of newtons",
            ),
            _ => (f64::is_finite, "a finite number of metres"),
        };
        match amounts.iter().find(|amount| !is_allowed(**amount)) {
            Some(bad) => Err(bad_input(place, bad, allowed)),
            None => Ok(Self { until, amounts }),
        }
    }

    /// Checks that there is one number for all of n poses, or one each.
    ///
    /// # Errors
    /// Another number of them.
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

    /// What ends it.
    pub fn until(&self) -> Until {
        self.until
    }

    fn amount(&self, number: usize) -> f64 {
        match self.amounts[..] {
            [amount] => amount,
            _ => self.amounts[number],
        }
    }

    /// The press at the pose of a number.
    pub fn of_pose<'a>(
        &self,
        number: usize,
        patch: &'a Patch,
        (model, pose): (&'a Model, &'a Pose),
    ) -> Press<'a> {
        Press {
            patch,
            models: from_ref(model),
            poses: from_ref(pose),
            until: self.until,
            amount: self.amount(number),
        }
    }
}

/// One press.
pub struct Press<'a> {
    patch: &'a Patch,
    models: &'a [Model],
    poses: &'a [Pose],
    until: Until,
    amount: f64,
}

impl Press<'_> {
    /// Deflects the taxels; `None` where the patch meets nothing.
    ///
    /// # Errors
    /// A force that cannot be reached.
    pub fn deflect(&self, workspace: &mut Workspace) -> Result<Option<Contact>> {
        let &Self {
            patch,
            models,
            poses,
            until,
            amount,
        } = self;
        Ok(match until {
            Until::Pose => Some(press_at_pose(patch, models, poses, workspace)),
            Until::Depth => press_to_depth(patch, models, poses, amount, workspace),
            Until::Travel => Some(press_to_travel(patch, models, poses, amount, workspace)),
            Until::Force => press_to_force(patch, models, poses, amount, workspace)?,
        })
    }

    /// The same press, to rounding, that leaves what touches what; `None` where nothing does, whatever the workspace holds then.
    ///
    /// # Errors
    /// A force that cannot be reached.
    pub fn meet(&self, workspace: &mut Workspace) -> Result<Option<Contact>> {
        let &Self {
            patch,
            models,
            poses,
            until,
            amount,
        } = self;
        let approach = Approach::new(patch, DVec3::Z)?;
        Ok(match until {
            Until::Pose => Some(press_with_contacts(patch, models, poses, workspace)),
            Until::Depth => approach.press_to_depth(models, poses, amount, workspace),
            Until::Travel => {
                let first = first_contact(patch, models, poses, workspace);
                let depth = first
                    .map(|first| amount - first)
                    .filter(|depth| *depth > 0.0);
                depth.and_then(|depth| approach.press_to_depth(models, poses, depth, workspace))
            }
            Until::Force => approach.press_to_force(models, poses, amount, workspace)?,
        })
    }
}
