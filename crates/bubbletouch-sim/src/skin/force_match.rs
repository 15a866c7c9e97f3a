//! Press of a patch on one rigid object to a given normal force, near the object's pose.

use super::parts::{RigidObject, SkinPatch};
use crate::contact::{HeldForce, MovedObject, Press, Until, Workspace};
use crate::geometry::Pose;
use glam::DVec3;

/// Requested normal force of a pair of patch and object, and the path on which the patch travels to reach this force.
#[derive(Clone, Copy, Debug)]
pub(super) struct WantedForce {
    /// Sum of the forces of the patch's taxels along their axes, newtons, positive.
    pub force: f64,
    /// Direction in which the patch travels, unit vector, in the patch frame.
    pub direction: DVec3,
    /// Largest travel towards the object, metres.
    pub reach: f64,
}

/// Travel away from the object, metres, at which the search for a smaller force ends. The value is far larger than any object that a skin touches.
const FARTHEST: f64 = 100.0;

/// Moves the patch along its direction until the requested force is reached; the deflections are in the workspace. If the force is not reached within the
/// reach, the patch ends there, or before the object is behind the substrate. Returns the travel of the patch and the force at its end.
///
/// `placed` contains the poses of all bodies in the patch frame, and `poses` is scratch memory.
pub(super) fn press_pair(
    part: &SkinPatch,
    object: &RigidObject,
    (placed, poses): (&[Pose], &mut Vec<Pose>),
    wanted: WantedForce,
    workspace: &mut Workspace,
) -> HeldForce {
    let WantedForce {
        force,
        direction,
        reach,
    } = wanted;
    let at_poses = || object.members.iter().map(|member| placed[*member]);
    poses.clear();
    poses.extend(at_poses());
    if part.is_even && direction == DVec3::Z {
        // All starts of the taxels come from one deep press of the grid. The press approaches from outside, so the travel may be far from the pose.
        let pressed =
            Press::new(&part.patch, &object.models, poses, Until::Force(force)).run(workspace);
        if let Ok(Some(contact)) = pressed
            && contact.travel.abs() <= reach
        {
            return HeldForce {
                travel: contact.travel,
                force: part.total_force(workspace.deflections()),
            };
        }
    }
    let moved = MovedObject {
        patch: &part.patch,
        objects: &object.models,
        moving: None,
        direction: -direction,
    };
    let ahead = reach.min(travel_through(part, object, poses, direction));
    let here = ahead.min(0.0);
    // If the patch travels far enough backwards, it leaves the object. Each search limit is twice the previous limit.
    let mut back = here.min(-reach);
    loop {
        poses.clear();
        poses.extend(at_poses());
        let held = moved.hold(poses, [back, here, ahead], force, workspace);
        let held = held.expect("checked poses, forces and directions");
        if held.travel > back || held.force <= force || back < -FARTHEST {
            return held;
        }
        back *= 2.0;
    }
}

/// Returns the travel at which the far side of the object is a stroke behind the lowest taxel, metres. Beyond it, the object is behind the substrate and
/// presses no taxel.
fn travel_through(part: &SkinPatch, object: &RigidObject, poses: &[Pose], direction: DVec3) -> f64 {
    let mut far = f64::NEG_INFINITY;
    for (model, pose) in object.models.iter().zip(poses) {
        let bounds = model.bounds();
        for corner in 0..8 {
            let choose = |axis: usize| match corner >> axis & 1 {
                0 => bounds.min[axis],
                _ => bounds.max[axis],
            };
            let corner = DVec3::new(choose(0), choose(1), choose(2));
            far = far.max(pose.transform_point(corner).dot(direction));
        }
    }
    let centers = part.patch.layout().centers().iter();
    let lowest = centers.map(|center| center.dot(direction));
    far - lowest.fold(f64::INFINITY, f64::min) + part.stroke
}
