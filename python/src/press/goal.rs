//! Goal of a press: pose, depth, force or travel.

use crate::arrays::{Object, array};
use crate::errors::bad_input;
use bubbletouch::contact::{Press, Until};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::Model;
use bubbletouch::world::Patch;
use pyo3::prelude::*;

/// Goal of presses: its kind (pose, depth, force or travel), and one amount for all poses or one amount per pose.
pub struct Goal {
    kind: fn(f64) -> Until,
    amounts: Vec<f64>,
}

impl Goal {
    /// Creates a goal from at most one of the three amounts; without any, the goal is the pose itself.
    ///
    /// # Errors
    /// If two amounts are given, an amount is not a number, or a depth is negative.
    pub fn from_arguments(
        depth: Option<&Object>,
        travel: Option<&Object>,
        force: Option<&Object>,
    ) -> PyResult<Self> {
        type Kind = fn(f64) -> Until;
        let (place, given, kind, least, allowed): (_, _, Kind, _, _) = match (depth, travel, force)
        {
            (None, None, None) => {
                return Ok(Self {
                    kind: |_| Until::Pose,
                    amounts: vec![0.0],
                });
            }
            (Some(depth), None, None) => {
                let allowed = "a finite number of metres, zero or more";
                ("depth", depth, Until::Depth, 0.0, allowed)
            }
            (None, Some(travel), None) => {
                let allowed = "a finite number of metres";
                ("travel", travel, Until::Travel, f64::MIN, allowed)
            }
            (None, None, Some(force)) => {
                let allowed = "a finite positive number of newtons";
                ("force", force, Until::Force, f64::MIN_POSITIVE, allowed)
            }
            _ => {
                let given = "more than one of depth, travel and force";
                return Err(bad_input("press", given, "one of them, or none"));
            }
        };
        let amounts = match given.extract::<f64>() {
            Ok(amount) => vec![amount],
            Err(_) => {
                let is_shape = |shape: &[usize]| shape.len() == 1;
                let array = array(place, given, "a number, or (n,)", is_shape)?;
                array.values().to_vec()
            }
        };
        let is_wrong = |amount: &&f64| !(amount.is_finite() && **amount >= least);
        match amounts.iter().find(is_wrong) {
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
    pub fn kind(&self) -> Until {
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
        Press::new(patch, models, poses, (self.kind)(self.amount(number)))
    }
}
