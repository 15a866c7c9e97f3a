//! State of the pressed objects of a scene: their displacements and forces.

use super::frame::{ObjectReading, PoseControl};
use super::plan::ScenePlan;
use super::plan_object::PlannedPress;
use super::skin_state::{PlacedObjects, SkinState};
use crate::contact::{HeldForce, MovedObject, TaxelContact, Workspace};
use crate::error::Result;
use crate::geometry::Pose;

/// Maximum number of turns in which each of several pressed objects moves to its target force. Two fingertips on neighbouring patches need 5 to 20. If larger,
/// targets that cannot be reached together take longer; if smaller, some forces differ from their targets.
const MAX_ROUNDS: usize = 100;

/// All pressed objects of a scene, whose motion is controlled by the force on a patch.
#[derive(Clone, Debug)]
pub(super) struct PressedObjects<'p> {
    all: Vec<Pressed<'p>>,
    /// Pose of each object relative to a patch, `patch_from_object`.
    poses: Vec<Pose>,
    workspace: Workspace,
}

/// Pressed object, with its displacement, contact force and contacts.
#[derive(Clone, Debug)]
struct Pressed<'p> {
    object: usize,
    /// Control of the force.
    press: &'p PlannedPress,
    /// Pose of the imposed motion, `world_from_object`.
    imposed: Pose,
    /// Distance from the imposed pose before the present step, metres.
    before: f64,
    now: HeldForce,
    /// Target of the patch's total spring force, N.
    wanted: f64,
    /// Contacts of the object with the patch, independent of the distance that the object travels.
    contacts: Vec<TaxelContact>,
}

impl<'p> PressedObjects<'p> {
    /// Creates the pressed objects of a scene at zero displacement.
    pub fn new(plan: &'p ScenePlan) -> Self {
        let objects = plan.objects.iter().enumerate();
        let pressed = objects.filter_map(|(object, planned)| {
            Some(Pressed {
                object,
                press: planned.press.as_ref()?,
                imposed: Pose::IDENTITY,
                before: 0.0,
                now: HeldForce::default(),
                wanted: 0.0,
                contacts: Vec::new(),
            })
        });
        Self {
            all: pressed.collect(),
            poses: Vec::new(),
            workspace: Workspace::new(),
        }
    }

    /// Moves all pressed objects from the poses of their imposed motions until the target forces are reached together. The time since the last call is `dt`,
    /// seconds; infinite at the start.
    ///
    /// Each object is moved in turn while the others stay. The turns are repeated until no object moves, because each object may touch the patches of the
    /// others.
    pub fn push(
        &mut self,
        skins: &[SkinState],
        objects: &mut PlacedObjects,
        [time, dt]: [f64; 2],
    ) -> Result<()> {
        let Self {
            all,
            poses,
            workspace,
        } = self;
        let n_pressed = all.len();
        for pressed in all.iter_mut() {
            let pose = &mut objects.poses[pressed.object];
            (pressed.imposed, pressed.before) = (*pose, pressed.now.travel);
            pose.translation += pressed.before * pressed.press.direction;
        }
        for round in 0..=MAX_ROUNDS {
            let mut is_moving = false;
            for pressed in all.iter_mut() {
                let press = pressed.press;
                let skin = &skins[press.patch];
                objects.poses[pressed.object] = pressed.imposed;
                poses.clear();
                poses.extend(objects.seen_by(skin));
                let moved = MovedObject {
                    patch: &skin.patch.skin,
                    objects: objects.models,
                    moving: Some(pressed.object),
                    direction: skin.pose.rotation.conjugate() * press.direction,
                };
                pressed.wanted = press.force_at(time);
                let here = pressed.now.travel;
                let way = (press.speed * dt).min(press.travel);
                let limits = match round {
                    // Only the force is computed.
                    MAX_ROUNDS => [here; 2],
                    _ => [
                        (pressed.before - way).max(0.0),
                        (pressed.before + way).min(press.travel),
                    ],
                };
                pressed.go(&moved, poses, (way, limits), workspace)?;
                is_moving |= pressed.now.travel != here;
                let pose = &mut objects.poses[pressed.object];
                pose.translation += pressed.now.travel * press.direction;
            }
            if !is_moving || n_pressed == 1 {
                break;
            }
        }
        Ok(())
    }

    /// Returns the contacts of a patch, given by its index, with the objects that are pressed onto the patch.
    pub fn contacts_on(&self, patch: usize) -> impl Iterator<Item = &TaxelContact> {
        let on_patch = self.all.iter();
        let on_patch = on_patch.filter(move |pressed| pressed.press.patch == patch);
        on_patch.flat_map(|pressed| &pressed.contacts)
    }

    /// Writes the travel, force and target of each pressed object into `readings`, at the object's number in the scene.
    pub fn read(&self, readings: &mut [ObjectReading]) {
        for pressed in &self.all {
            readings[pressed.object].held = PoseControl::Pressed {
                travel: pressed.now.travel,
                force: pressed.now.force,
                wanted: pressed.wanted,
            };
        }
    }
}

impl Pressed<'_> {
    /// Moves the object towards its target force by at most `way` metres, in small steps. The distance from the pose of its imposed motion stays between the
    /// limits `low` and `high`, metres.
    ///
    /// `poses` contains the pose of each object, `patch_from_object`; for the pressed object, the pose of its imposed motion.
    fn go(
        &mut self,
        moved: &MovedObject,
        poses: &mut [Pose],
        (way, [low, high]): (f64, [f64; 2]),
        workspace: &mut Workspace,
    ) -> Result<()> {
        let start = poses[self.object];
        let n_parts = moved.patch.n_steps(way);
        let step = way / n_parts as f64;
        let is_let_go = self.wanted == 0.0;
        for _ in 0..n_parts {
            let here = self.now.travel;
            let back = (here - step).max(low);
            // If the target force is zero, the object moves back, with or without contacts.
            let travels = match is_let_go {
                true => [back; 3],
                false => [back, here, (here + step).min(high)],
            };
            poses[self.object] = start;
            workspace.hold(&self.contacts);
            self.now = moved.hold(poses, travels, self.wanted, workspace)?;
            let contacts = workspace.contacts().iter();
            let its = contacts.filter(|contact| contact.object == self.object);
            self.contacts.clear();
            self.contacts.extend(its);
            let is_at_end = [travels[0], travels[2]].contains(&self.now.travel);
            if !is_at_end || self.now.travel == here {
                break;
            }
        }
        Ok(())
    }
}
