//! One object among others moved along a line so that a skin feels a force, no farther than it can go in a step.

use super::force_goal::FORCE_ACCURACY;
use super::root_search::crossing;
use super::spring_load::sample;
use super::{Workspace, press_with_contacts};
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::Patch;
use glam::DVec3;

/// Where an object is that is moved for a force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeldForce {
    /// How far it went along the direction, metres.
    pub travel: f64,
    /// Σ k δ of the patch there, N.
    pub force: f64,
}

/// A skin, and one object among others that is moved onto it along a line.
#[derive(Clone, Copy, Debug)]
pub struct MovedObject<'a> {
    /// The skin.
    pub patch: &'a Patch,
    /// All objects.
    pub objects: &'a [Model],
    /// The number of the one that is moved.
    pub moving: usize,
    /// Where to: unit, in the patch frame.
    pub direction: DVec3,
}

impl MovedObject<'_> {
    /// Moves the object to where the springs of the patch carry `force` newtons together (Σ k δ of all objects): to within 1e-13 of
    /// it, or to the last bit of the travel.
    ///
    /// `poses`: `patch_from_object`, one an object, that of the moved one before any travel; afterwards where the last press found it.
    /// `travels`, metres, ascending: how far back it may go, how far it is, how far ahead it may go. If the force is not
    /// reached between them it goes to the end on that side. Where the force jumps past what is wanted, the upper side of the jump is.
    ///
    /// # Panics
    /// If there are not as many poses as objects, or not that many objects.
    pub fn hold(
        &self,
        poses: &mut [Pose],
        travels: [f64; 3],
        force: f64,
        workspace: &mut Workspace,
    ) -> HeldForce {
        let [back, here, ahead] = travels;
        let start = poses[self.moving].translation;
        let mut carried = |travel: f64| {
            poses[self.moving].translation = start + travel * self.direction;
            press_with_contacts(self.patch, self.objects, poses, workspace);
            let is_moved = |number| number == self.moving;
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
        HeldForce {
            travel,
            force: carried(travel).value,
        }
    }
}
