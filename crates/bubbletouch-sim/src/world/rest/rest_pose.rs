//! Resting poses of an object on a table, computed exactly from its spheres or corners.
//!
//! Let d be the direction of down in the object's frame. The centre of mass is at the height h(d) = max_j (c_j · d + r_j) above the table, with c_j relative to
//! it. An object that is tipped slowly moves downhill on h over the sphere of directions, and rests in the local minima. The probability of a minimum is the
//! fraction of directions that lead to it, because the object is put down slowly in a random orientation. (Quasi-static toppling: Goldberg, Mirtich, Zhuang,
//! Craig, Carlisle, Canny, *Part pose statistics*, 1999.)

use super::basins::basins;
use super::support::Support;
use crate::geometry::Pose;
use crate::objects::Model;
use glam::{DQuat, DVec3};

/// Smallest height of the barrier between two resting poses, relative to the farthest point's distance from the centre of mass. If smaller, bumps of spheres
/// on a round side become poses; if larger, stable poses are merged (1 % keeps all poses that withstand ± 8°).
const BARRIER: f64 = 0.01;
/// Smallest probability of a resting pose that is returned. If smaller, rare poses are included.
const LEAST_PROBABILITY: f64 = 0.02;

/// Pose in which an object rests on the table, with its probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestPose {
    /// Pose of the object on the table: the object lies on z = 0 with its bounding box centred at x = y = 0.
    pub table_from_object: Pose,
    /// Height of the object's top above the table, metres.
    pub height: f64,
    /// Probability of this pose among the object's resting poses, above 0; the probabilities sum to 1.
    pub probability: f64,
}

/// Returns the pose in which the object's own z points up.
pub fn as_modelled(object: &Model) -> RestPose {
    resting(object, DVec3::NEG_Z, 1.0)
}

/// Returns the resting poses of an object on a table, most likely first; at least one. The object is treated as a homogeneous solid.
///
/// A round object that rolls has one pose for all directions through which it rolls. Poses less likely than 2 % are omitted. The run time is 15 to 30 ms for
/// 3,000 spheres, longest for objects that can roll on a long side.
pub fn stable_poses(object: &Model) -> Vec<RestPose> {
    stable_poses_about(object, object.center_of_mass())
}

/// Returns the stable resting poses for a given centre of mass, metres, in the object's frame.
pub fn stable_poses_about(object: &Model, center_of_mass: DVec3) -> Vec<RestPose> {
    let support = Support::about(center_of_mass, &object.extremes());
    let mut poses: Vec<_> = basins(&support, BARRIER * support.radius())
        .into_iter()
        .map(|basin| resting(object, basin.lowest, basin.share))
        .collect();
    poses.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let least = LEAST_PROBABILITY.min(poses[0].probability);
    poses.retain(|pose| pose.probability >= least);
    let total: f64 = poses.iter().map(|pose| pose.probability).sum();
    for pose in &mut poses {
        pose.probability /= total;
    }
    poses
}

/// Returns the pose in which `down` (unit vector in the object's frame) points at the table. The object is rotated by the smallest angle from upright or
/// upside-down.
fn resting(object: &Model, down: DVec3, probability: f64) -> RestPose {
    let upside_down = DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);
    let rotation = if down.z <= 0.0 {
        DQuat::from_rotation_arc(down, DVec3::NEG_Z)
    } else {
        upside_down * DQuat::from_rotation_arc(down, DVec3::Z)
    };
    let bounds = object.turned_bounds(rotation);
    let middle = bounds.center();
    RestPose {
        table_from_object: Pose::new(rotation, DVec3::new(-middle.x, -middle.y, -bounds.min.z)),
        height: bounds.size().z,
        probability,
    }
}
