//! Press of a patch on one body until their normal force is a given one, near the body's pose.

use super::parts::{Body, SkinPatch};
use bubbletouch::contact::{HeldForce, MovedObject, Workspace, press_to_force};
use bubbletouch::geometry::Pose;
use glam::DVec3;
use std::slice::from_ref;

/// Wanted normal force of a pair of patch and body, and the path on which it is sought.
#[derive(Clone, Copy, Debug)]
pub struct WantedForce {
    /// Sum of the forces of the patch's taxels along their axes, newtons, positive.
    pub force: f64,
    /// Direction in which the patch travels, unit vector, in the patch frame.
    pub direction: DVec3,
    /// Largest travel towards the body, metres.
    pub reach: f64,
}

/// Travel away from the body, metres, at which the search for a smaller force ends. It is far larger than any body that a skin touches.
const FARTHEST: f64 = 100.0;

/// Moves the patch along its direction until the force is the wanted one; the deflections are in the workspace. If the force is not reached within the
/// reach, the patch ends there, or before the body is behind the substrate. Returns the travel of the patch and the force at its end.
pub fn press_pair(
    part: &SkinPatch,
    body: &Body,
    pose: Pose,
    wanted: WantedForce,
    workspace: &mut Workspace,
) -> HeldForce {
    let WantedForce {
        force,
        direction,
        reach,
    } = wanted;
    let model = from_ref(&body.model);
    if part.is_even && direction == DVec3::Z {
        // All starts of the taxels come from one deep press of the grid. The press approaches from outside, so the travel may be far from the pose.
        let pressed = press_to_force(&part.patch, model, &[pose], force, workspace);
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
        objects: model,
        moving: 0,
        direction: -direction,
    };
    let ahead = reach.min(travel_through(part, body, &pose, direction));
    let here = ahead.min(0.0);
    // Backwards, the patch leaves the body at last: each limit is twice as far as the one before.
    let mut back = here.min(-reach);
    loop {
        let travels = [back, here, ahead];
        let held = moved.hold(&mut [pose], travels, force, workspace);
        if held.travel > back || held.force <= force || back < -FARTHEST {
            return held;
        }
        back *= 2.0;
    }
}

/// Returns the travel at which the far side of the body is a stroke behind the lowest taxel, metres. Beyond it, the body is behind the substrate and
/// presses no taxel.
fn travel_through(part: &SkinPatch, body: &Body, pose: &Pose, direction: DVec3) -> f64 {
    let bounds = body.model.bounds();
    let corners = (0..8).map(|corner| {
        let choose = |axis: usize| match corner >> axis & 1 {
            0 => bounds.min[axis],
            _ => bounds.max[axis],
        };
        let corner = DVec3::new(choose(0), choose(1), choose(2));
        pose.transform_point(corner).dot(direction)
    });
    let centers = part.patch.layout().centers().iter();
    let lowest = centers.map(|center| center.dot(direction));
    corners.fold(f64::NEG_INFINITY, f64::max) - lowest.fold(f64::INFINITY, f64::min) + part.stroke
}
