//! Goal of a press: pose, depth, force or travel.

use crate::arrays::{Object, array};
use crate::errors::{bad_input, exception};
use crate::model::Objects;
use crate::poses::Poses;
use bubbletouch::Error;
use bubbletouch::contact::{Press, Until};
use bubbletouch::geometry::Pose;
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

    /// Returns the kind of the goal with an amount of 0; used where only the kind matters.
    pub fn kind(&self) -> Until {
        (self.kind)(0.0)
    }
}

/// Presses on objects at n sets of poses, to goals of one kind.
pub struct Presses<'a> {
    /// Objects that are pressed.
    pub objects: Objects<'a>,
    /// Poses of the objects in the patch frame, set after set.
    poses: Vec<Pose>,
    /// Whether the poses are one set without the axis n.
    pub is_one: bool,
    /// Goal of each press.
    pub goal: Goal,
}

impl<'a> Presses<'a> {
    /// Reads the arguments `object` and `poses`.
    ///
    /// # Errors
    /// If an argument is invalid, or the goal has neither one amount for all sets nor one for each.
    pub fn new(object: &'a Object, poses: &Object, goal: Goal) -> PyResult<Self> {
        let objects = Objects::from_argument(object)?;
        let Poses { poses, is_one } = Poses::of_objects("poses", poses, objects.n_several)?;
        let presses = Self {
            objects,
            poses,
            is_one,
            goal,
        };
        let (n, n_sets) = (presses.goal.amounts.len(), presses.n());
        if n == 1 || n == n_sets {
            return Ok(presses);
        }
        let given = format!("{n} amounts for {n_sets} poses");
        let allowed = "one for all poses, or one each";
        Err(bad_input("press", given, allowed))
    }

    /// Returns the number n of presses.
    pub fn n(&self) -> usize {
        self.poses.len() / self.objects.models.len()
    }

    /// Returns the poses of the objects in the press of the given number.
    pub fn poses(&self, number: usize) -> &[Pose] {
        let k = self.objects.models.len();
        &self.poses[number * k..][..k]
    }

    /// Returns the press of the given number.
    pub fn press<'b>(&'b self, number: usize, patch: &'b Patch) -> Press<'b> {
        let amount = match self.goal.amounts[..] {
            [amount] => amount,
            _ => self.goal.amounts[number],
        };
        let (models, poses) = (&self.objects.models, self.poses(number));
        Press::new(patch, models, poses, (self.goal.kind)(amount))
    }

    /// Converts the error of the press of the given number to an exception, which names the pose.
    pub fn exception(&self, number: usize, error: Error) -> PyErr {
        exception(error.under(match self.is_one {
            true => "poses: ".to_owned(),
            false => format!("poses[{number}]: "),
        }))
    }
}
