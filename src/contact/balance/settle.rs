//! The balance of a free object, and who finds it.

use super::descent::Descent;
use super::energy::Energy;
use super::free_object::{FreeObject, PlacedSkin};
use super::loads::Multipliers;
use super::model::Model;
use super::pairs::Key;
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

/// What one taxel carries of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaxelLoad {
    /// The skin's number in the list that the object was put to rest on.
    pub skin: usize,
    /// The taxel's number in its layout.
    pub taxel: usize,
    /// What the object puts on it along its axis, newtons, above 0.
    pub force: f64,
    /// The part of that force which the spring at its stroke does not carry, newtons: the reaction of the stop, the multiplier of
    /// δ ≤ s in the balance; 0 before the stroke.
    pub stop: f64,
}

impl TaxelLoad {
    /// Of a taxel whose stop carries if `is_stopped`.
    pub(super) fn new(
        (skin, taxel): Key,
        force: f64,
        is_stopped: bool,
        skins: &[PlacedSkin],
    ) -> Self {
        let (skin, taxel) = (skin as usize, taxel as usize);
        let spring = skins[skin].patch.taxels().at(taxel);
        let past = force - spring.stiffness * spring.stroke;
        Self {
            skin,
            taxel,
            force,
            stop: if is_stopped { past.max(0.0) } else { 0.0 },
        }
    }
}

/// Finds resting poses, and remembers what it needs to find the next one nearby sooner.
#[derive(Clone, Debug, Default)]
pub struct Balancer {
    pub(super) now: Energy,
    pub(super) next: Energy,
    pub(super) model: Model,
    pub(super) multipliers: Multipliers,
    pub(super) carried: Vec<TaxelLoad>,
}

impl Balancer {
    /// A balancer that knows nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// What carries the object that was put to rest last, taxel by taxel, in the order of skins and taxels; empty of one that escaped.
    /// Its forces are those of the last [`Balance`]: Σ f n_c / (n_c·n) is the balance's force.
    pub fn loads(&self) -> &[TaxelLoad] {
        &self.carried
    }

    /// Puts an object to rest from a pose (`world_from_object`), under `gravity` (m/s², in the world).
    ///
    /// It goes to the rest that lies downhill; from a pose at rest it does not move. The skins do not move meanwhile, and their dampers do not
    /// count.
    ///
    /// # Errors
    /// The error names a gravity that is zero or not finite, and a pose that is not finite.
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
