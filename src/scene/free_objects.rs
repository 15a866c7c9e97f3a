//! Free objects of a scene: each comes to rest on the skin that is there, in turn.

use super::frame::{Held, ObjectReading};
use super::plan::ScenePlan;
use super::plan_object::Movement;
use super::skin_state::{OUT_OF_REACH, PlacedObjects, SkinState};
use crate::contact::balance::{Balancer, FreeObject, Outcome, PlacedSkin};
use crate::contact::{Workspace, press_with_contacts};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use glam::DVec3;
use std::collections::BTreeMap;

/// Several free objects are at rest together when none of them moved by more in a round, metres (a turn counts at the object's
/// farthest point). Smaller: more rounds; larger: what one puts on a taxel of the other is off by as much.
pub const ROUND_TOLERANCE: f64 = 1e-7;

/// Rounds of a step, at most; steps that end by this are counted.
pub const MOST_ROUNDS: usize = 20;

/// Forces up to this share of an object's weight carry nothing of it. Smaller: rounding counts; larger: what two objects share is missed.
const NOTHING: f64 = 1e-9;

/// All free objects of a scene.
#[derive(Clone, Debug)]
pub(super) struct FreeObjects {
    all: Vec<Free>,
    /// How far the others push each taxel of each patch; empty where they push none.
    pushed: Vec<Vec<f64>>,
    workspace: Workspace,
    /// Steps whose rounds ended before all were at rest together.
    pub n_unfinished: usize,
}

/// One of them.
#[derive(Clone, Debug)]
struct Free {
    object: usize,
    mass: f64,
    center_of_mass: DVec3,
    balancer: Balancer,
    pose: Pose,
    held: Held,
}

impl FreeObjects {
    pub fn of(plan: &ScenePlan) -> Self {
        let objects = plan.objects.iter().enumerate();
        let all = objects.filter_map(|(object, planned)| match planned.movement {
            Movement::Imposed(_) | Movement::Carried(_) => None,
            Movement::Free {
                start,
                mass,
                center_of_mass,
            } => Some(Free {
                object,
                mass,
                center_of_mass,
                balancer: Balancer::new(),
                pose: start,
                held: Held::AtRest,
            }),
        });
        Self {
            all: all.collect(),
            pushed: vec![Vec::new(); plan.patches.len()],
            workspace: Workspace::new(),
            n_unfinished: 0,
        }
    }

    /// Puts those that are still there to rest, one after the other, until none moves any more.
    pub fn settle(
        &mut self,
        plan: &ScenePlan,
        skins: &[SkinState],
        objects: &mut PlacedObjects,
        time: f64,
    ) -> Result<()> {
        for free in &self.all {
            objects.poses[free.object] = free.world_pose();
        }
        for round in 1..=MOST_ROUNDS {
            let mut moved = Vec::new();
            let mut n_there = 0;
            for number in 0..self.all.len() {
                if !self.all[number].is_there() {
                    continue;
                }
                n_there += 1;
                if self.settle_one(number, plan, skins, objects, time)? > ROUND_TOLERANCE {
                    moved.push(number);
                }
            }
            if n_there <= 1 || moved.is_empty() {
                break;
            }
            if round == MOST_ROUNDS {
                self.n_unfinished += 1;
                for number in moved {
                    self.all[number].unsettle();
                }
            }
        }
        self.check_apart(plan, time)
    }

    /// An error if two of them rest on one taxel. Elsewhere each taxel carries the object that pushes it farthest, and what is a minimum
    /// of the energy for each of them is one for all; where two push it equally far, they would share its force, which a balance of one
    /// at a time gives to both.
    fn check_apart(&self, plan: &ScenePlan, time: f64) -> Result<()> {
        let mut carried: BTreeMap<(usize, usize), &Free> = BTreeMap::new();
        for free in self.all.iter().filter(|free| free.is_there()) {
            let nothing = NOTHING * free.mass * plan.gravity.length();
            for load in free.balancer.loads() {
                if load.force <= nothing {
                    continue;
                }
                let Some(other) = carried.insert((load.skin, load.taxel), free) else {
                    continue;
                };
                let [one, other] = [other, free].map(|free| &plan.objects[free.object].name);
                return Err(Error::input(
                    format!("{}, objects `{one}` and `{other}`", plan.place),
                    format!(
                        "at {time} s both rest on taxel {} of patch `{}`",
                        load.taxel + 1,
                        plan.patches[load.skin].skin.name()
                    ),
                    "free objects on taxels of their own (each is put to rest by itself, so the force of a taxel that two share would \
                     count for both), or a scene that ends before (--until-s)",
                ));
            }
        }
        Ok(())
    }

    /// What stops of a patch carry: a taxel and newtons each.
    pub fn stops(&self, patch: usize) -> impl Iterator<Item = (usize, f64)> {
        let there = self.all.iter().filter(|free| free.is_there());
        let loads = there.flat_map(|free| free.balancer.loads());
        let of_patch = loads.filter(move |load| load.skin == patch && load.stop > 0.0);
        of_patch.map(|load| (load.taxel, load.stop))
    }

    /// How far it went, metres.
    fn settle_one(
        &mut self,
        number: usize,
        plan: &ScenePlan,
        skins: &[SkinState],
        objects: &mut PlacedObjects,
        time: f64,
    ) -> Result<f64> {
        let Self {
            all,
            pushed,
            workspace,
            ..
        } = self;
        let free = &mut all[number];
        objects.poses[free.object] = OUT_OF_REACH;
        push_by_others(plan, skins, objects, pushed, workspace);
        let skins = skins.iter().zip(&plan.patches).zip(pushed.iter());
        let placed: Vec<PlacedSkin> = skins
            .map(|((skin, patch), pushed)| PlacedSkin {
                patch: &patch.skin,
                world_from_patch: skin.pose,
                pushed,
            })
            .collect();
        let spheres = plan.models[free.object].spheres();
        let spheres = spheres.expect("the plan lets only unions of spheres be free");
        let object = FreeObject::new(spheres, free.mass, free.center_of_mass)?;
        let balance = free
            .balancer
            .settle(&object, &placed, plan.gravity, &free.pose)?;
        let before = std::mem::replace(&mut free.pose, balance.pose);
        free.held = match balance.outcome {
            Outcome::Settled => Held::AtRest,
            Outcome::Unsettled => Held::Unsettled,
            Outcome::Escaped { direction } => Held::Escaped { time, direction },
        };
        objects.poses[free.object] = free.world_pose();
        let (center, radius) = objects.balls[free.object];
        let turned = before.rotation.angle_between(balance.pose.rotation) * radius;
        let shifted = before
            .transform_point(center)
            .distance(balance.pose.transform_point(center));
        Ok(shifted + turned)
    }

    /// Reports where they are.
    pub fn read(&self, readings: &mut [ObjectReading]) {
        for free in &self.all {
            readings[free.object] = ObjectReading {
                pose: free.pose,
                held: free.held,
            };
        }
    }
}

impl Free {
    /// It was at rest where the others were before, not where they are.
    fn unsettle(&mut self) {
        if self.is_there() {
            self.held = Held::Unsettled;
        }
    }

    fn is_there(&self) -> bool {
        !matches!(self.held, Held::Escaped { .. })
    }

    /// Where it is for skin.
    fn world_pose(&self) -> Pose {
        if self.is_there() {
            self.pose
        } else {
            OUT_OF_REACH
        }
    }
}

/// How far the objects that are in reach push each patch.
fn push_by_others(
    plan: &ScenePlan,
    skins: &[SkinState],
    objects: &PlacedObjects,
    pushed: &mut [Vec<f64>],
    workspace: &mut Workspace,
) {
    for ((patch, skin), pushed) in plan.patches.iter().zip(skins).zip(pushed) {
        pushed.clear();
        if objects.can_reach(patch, &skin.pose) {
            let poses: Vec<Pose> = objects.seen_by(patch, &skin.pose).collect();
            press_with_contacts(&patch.skin, &plan.models, &poses, workspace);
            pushed.extend_from_slice(workspace.deflections());
        }
    }
}
