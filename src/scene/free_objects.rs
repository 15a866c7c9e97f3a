//! Free objects of a scene: each comes to rest on the skin that is there, in turn.

use super::frame::{Held, ObjectReading};
use super::plan::ScenePlan;
use super::plan_object::Movement;
use super::skin_state::{OUT_OF_REACH, PlacedObjects, SkinState};
use crate::contact::balance::{Balancer, FreeObject, Outcome, PlacedSkin};
use crate::contact::{SkinWorkspace, press_skin};
use crate::error::Result;
use crate::geometry::Pose;
use glam::DVec3;

/// Several free objects are at rest together when none of them moved by more in a round, metres (a turn counts at the object's
/// farthest point). Smaller: more rounds; larger: what one puts on a taxel of the other is off by as much.
pub const ROUND_TOLERANCE: f64 = 1e-7;

/// Rounds of a step, at most; steps that end by this are counted.
pub const MOST_ROUNDS: usize = 20;

/// All free objects of a scene.
#[derive(Clone, Debug)]
pub(super) struct FreeObjects {
    all: Vec<Free>,
    /// How far the others push each taxel of each patch; empty where they push none.
    pushed: Vec<Vec<f64>>,
    workspace: SkinWorkspace,
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
            Movement::Imposed(_) => None,
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
            workspace: SkinWorkspace::new(),
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
            let mut farthest: f64 = 0.0;
            let mut n_there = 0;
            for number in 0..self.all.len() {
                if !self.all[number].is_there() {
                    continue;
                }
                n_there += 1;
                farthest = farthest.max(self.settle_one(number, plan, skins, objects, time)?);
            }
            if n_there <= 1 || farthest <= ROUND_TOLERANCE {
                break;
            }
            self.n_unfinished += usize::from(round == MOST_ROUNDS);
        }
        Ok(())
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
    workspace: &mut SkinWorkspace,
) {
    for ((patch, skin), pushed) in plan.patches.iter().zip(skins).zip(pushed) {
        pushed.clear();
        if objects.can_reach(&patch.skin, &skin.pose) {
            let poses = objects.poses.iter().map(|pose| pose.seen_from(&skin.pose));
            let poses: Vec<Pose> = poses.collect();
            press_skin(&patch.skin, &plan.models, &poses, workspace);
            pushed.extend_from_slice(workspace.deflections());
        }
    }
}
