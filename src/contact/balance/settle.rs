//! The balance of a free object, and who finds it.

use super::descent::Descent;
use super::energy::Energy;
use super::free_object::{FreeObject, PlacedSkin};
use super::loads::Multipliers;
use super::model::Model;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use glam::DVec3;

/// How an object ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// At rest: forces and torques balance, and every small motion costs energy or nothing.
    Settled,
    /// It rolled or slid off the skins, or there is none below it.
    Escaped {
        /// Where to from where it started: unit, in the world; across gravity, unless it fell straight down.
        direction: DVec3,
    },
    /// Neither within the largest number of steps.
    Unsettled,
}

/// Where an object is in the end, and what holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// `world_from_object`.
    pub pose: Pose,
    /// Whether it rests there.
    pub outcome: Outcome,
    /// What the skins put on it, newtons, in the world: k δ of each taxel, and its stop's force.
    pub force: DVec3,
    /// About the centre of mass, N·m.
    pub torque: DVec3,
    /// What is left of force and weight together, as a share of the weight; of the torque, as a share of the weight times
    /// the object's radius: the larger of both.
    pub imbalance: f64,
    /// Taxels that carry it.
    pub n_touched: usize,
    /// Taxels whose stops carry.
    pub n_saturated: usize,
    /// Taxels pushed along a flank as good as parallel to their axis: see [`GRAZING`](crate::contact::GRAZING).
    pub n_grazing: usize,
    /// Poses that were looked at.
    pub n_steps: usize,
}

/// Finds resting poses, and remembers what it needs to find the next one nearby sooner.
#[derive(Clone, Debug, Default)]
pub struct Balancer {
    pub(super) now: Energy,
    pub(super) next: Energy,
    pub(super) model: Model,
    pub(super) multipliers: Multipliers,
}

impl Balancer {
    /// A balancer that knows nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Puts an object to rest from a pose (`world_from_object`), under `gravity` (m/s², in the world).
    ///
    /// It goes to the rest that lies downhill; from a pose at rest it does not move. The skins do not move meanwhile, and
    /// their dampers do not count. The error names a gravity that is zero or not finite, and a pose that is not finite.
    pub fn settle<'s>(
        &mut self,
        object: &FreeObject,
        skins: &[PlacedSkin<'s>],
        gravity: DVec3,
        start: &Pose,
    ) -> Result<Balance> {
        if !(gravity.is_finite() && gravity != DVec3::ZERO) {
            return Err(Error::input(
                "gravity",
                format!("{gravity} m/s²"),
                "finite, and not zero for a free object",
            ));
        }
        if !(start.translation.is_finite() && start.rotation.is_finite()) {
            return Err(Error::input(
                "object pose",
                start.translation,
                "finite numbers",
            ));
        }
        // Where the object is, is the origin: far from the world's, places have too few digits to balance stiff springs.
        let origin = start.translation;
        let from_there = |pose: &Pose| Pose::new(pose.rotation, pose.translation - origin);
        let near = |skin: &PlacedSkin<'s>| PlacedSkin {
            world_from_patch: from_there(&skin.world_from_patch),
            ..*skin
        };
        let skins: Vec<PlacedSkin> = skins.iter().map(near).collect();
        let mut descent = Descent::new(self, object, &skins, gravity, &from_there(start));
        let (outcome, held) = match descent.run() {
            Outcome::Unsettled => match descent.finish() {
                Some(held) => (Outcome::Settled, Some(held)),
                None => (Outcome::Unsettled, None),
            },
            outcome => (outcome, None),
        };
        let mut balance = descent.balance(outcome, held);
        self.multipliers = descent.multipliers;
        balance.pose.translation += origin;
        Ok(balance)
    }
}
