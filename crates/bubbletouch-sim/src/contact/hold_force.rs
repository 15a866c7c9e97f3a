//! Motion of one object, or of all objects together, along a line until a skin carries a given force, within travel limits.

use super::force_goal::FORCE_ACCURACY;
use super::press::check_direction;
use super::root_search::crossing;
use super::spring_load::sample;
use super::{Record, Until, Workspace, tree};
use crate::error::{Error, Result};
use crate::geometry::{Pose, check_poses};
use crate::objects::Model;
use crate::text::in_range::not_negative;
use crate::world::Patch;
use glam::DVec3;

/// Result of moving an object until the skin carries a given force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeldForce {
    /// Travel of the object along the direction of motion, metres.
    pub travel: f64,
    /// Total force of the springs at this travel, N.
    pub force: f64,
}

/// Skin and objects. One object, or all objects together, are moved onto the skin along a line.
#[derive(Clone, Copy, Debug)]
pub struct MovedObject<'a> {
    /// Patch of the skin.
    pub patch: &'a Patch,
    /// All objects of the scene.
    pub objects: &'a [Model],
    /// Index of the moved object; `None` if all objects move together.
    pub moving: Option<usize>,
    /// Direction of the motion, unit vector, in the patch frame.
    pub direction: DVec3,
}

impl MovedObject<'_> {
    /// Moves the object until the springs of the patch together carry `force` newtons, due to all objects. The accuracy is a relative 1e-13 or the last bit
    /// of the travel.
    ///
    /// `poses` contains one `patch_from_object` per object. The pose of the moved object is initially its pose at a travel of 0, and finally its pose at the
    /// last press. `travels`, metres, ascending, contains the lower limit, the present travel, and the upper limit. If the force is not reached between the
    /// limits, the object moves to the nearer limit. If the total force jumps past `force` at some travel, the side of the jump with the larger force is
    /// returned.
    ///
    /// # Errors
    /// If the poses are invalid, as in [`Press::run`](crate::contact::Press::run), the direction is not a unit vector, a travel is not finite, or the force is
    /// negative or not finite. If `moving` is not the index of an object.
    pub fn hold(
        &self,
        poses: &mut [Pose],
        travels: [f64; 3],
        force: f64,
        workspace: &mut Workspace,
    ) -> Result<HeldForce> {
        check_poses("object", self.objects.len(), poses)?;
        check_direction(self.direction)?;
        not_negative("touch force", force, "N")?;
        for travel in travels {
            Until::Travel(travel).check()?;
        }
        let n = self.objects.len();
        if self.moving.is_some_and(|moving| moving >= n) {
            let given = format!("{}", self.moving.unwrap_or_default());
            return Err(Error::input(
                "moving object",
                given,
                format!("below {n}, the number of objects"),
            ));
        }
        let [back, here, ahead] = travels;
        let range = self.moving.map_or(0..poses.len(), |moved| moved..moved + 1);
        let starts = poses[range.clone()].iter().map(|pose| pose.translation);
        let starts: Vec<DVec3> = starts.collect();
        let mut carried = |travel: f64| {
            for (pose, start) in poses[range.clone()].iter_mut().zip(&starts) {
                pose.translation = *start + travel * self.direction;
            }
            let placed = (self.objects, &poses[..]);
            tree::press(self.patch, placed, Record::Contacts, workspace);
            let is_moved = |number| range.contains(&number);
            sample(self.patch, workspace.contacts(), self.direction, is_moved)
        };
        let tolerance = FORCE_ACCURACY * force;
        let now = carried(here).value;
        let bracket = if (now - force).abs() <= tolerance {
            [here, here]
        } else if now < force {
            let is_enough = carried(ahead).value >= force;
            [if is_enough { here } else { ahead }, ahead]
        } else {
            let is_enough = carried(back).value < force;
            [back, if is_enough { here } else { back }]
        };
        let [low, high] = bracket;
        let travel = match low < high {
            true => crossing([low, high], (force, tolerance), &mut carried),
            false => low,
        };
        Ok(HeldForce {
            travel,
            force: carried(travel).value,
        })
    }
}
