//! The poses in which an object rests on a table, exactly from its spheres or corners.
//!
//! With d the direction of down in the object's frame, the centre of mass stands h(d) = max_j (c_j · d + r_j) above the table
//! (c_j relative to it). An object that is tipped slowly rolls downhill on h over the sphere of directions: it rests in the
//! local minima. The chance of a minimum is the share of directions that roll into it, as if the object were put
//! down in a random orientation (quasi-static toppling; Goldberg, Mirtich, Zhuang, Craig, Carlisle, Canny, *Part pose
//! statistics*, 1999).

use super::basins::basins;
use super::support::Support;
use crate::geometry::Pose;
use crate::objects::Model;
use glam::{DQuat, DVec3};

/// The least barrier between two poses, as a share of the farthest point's distance. Smaller: the bumps of spheres on a round
/// side become poses. Larger: poses that need a firm push to leave are lost (1 % keeps all that stand ± 8°).
const BARRIER: f64 = 0.01;
/// The least probability of a pose. Smaller: more poses that hardly occur.
const LEAST_PROBABILITY: f64 = 0.02;

/// A pose in which an object rests on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestPose {
    /// Rests on z = 0, z up, the box around it centred at x = y = 0.
    pub table_from_object: Pose,
    /// z of the object's top, metres.
    pub height: f64,
    /// How likely among the object's poses, above 0; they sum to 1.
    pub probability: f64,
}

/// The pose with the object's own z up.
pub fn as_modelled(object: &Model) -> RestPose {
    resting(object, DVec3::NEG_Z, 1.0)
}

/// The poses in which an object, as a homogeneous solid ([`Model::center_of_mass`]), rests on a table, likeliest first; at least one.
///
/// A round object that rolls has one pose for all the directions it rolls through. Poses less likely than 2 % are left
/// out. Takes 15 to 30 ms for 3,000 spheres, most where a long side rolls.
pub fn stable_poses(object: &Model) -> Vec<RestPose> {
    stable_poses_about(object, object.center_of_mass())
}

/// [`stable_poses`] with a given centre of mass, metres, in the object's frame.
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

/// The pose with `down` (unit, object frame) pointing at the table, by the shortest turn from upright or upside-down.
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
