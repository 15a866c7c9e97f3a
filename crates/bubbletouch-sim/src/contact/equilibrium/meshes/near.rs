//! Corners and ridges of a mesh that are near another mesh.

use crate::geometry::Pose;
use crate::objects::MeshModel;
use glam::DMat3;

/// Ridges of a mesh that are near another mesh, and corners at the end of a ridge, by their numbers, ascending.
#[derive(Clone, Debug, Default)]
pub(super) struct Near {
    pub corners: Vec<usize>,
    pub ridges: Vec<usize>,
}

impl Near {
    /// Finds the corners and ridges of a mesh that are at most `margin` metres from another mesh; parts further away can be among them.
    pub fn new(
        (mesh, pose): (&MeshModel, &Pose),
        (other, other_pose): (&MeshModel, &Pose),
        margin: f64,
    ) -> Self {
        let to_other = pose.seen_from(other_pose);
        let turn = DMat3::from_quat(to_other.rotation);
        let features = mesh.features();
        let mut near = Self::default();
        let motion = (&turn, to_other.translation);
        other
            .bvh()
            .each_near(mesh.bvh(), motion, margin, |triangle| {
                let corners = features.own_corners(triangle);
                near.corners
                    .extend(corners.filter(|&corner| features.is_on_ridge(corner)));
                let edges = features.own_edges(triangle);
                near.ridges
                    .extend(edges.filter(|&edge| features.edges()[edge].is_ridge));
            });
        near.corners.sort_unstable();
        near.ridges.sort_unstable();
        near
    }
}
