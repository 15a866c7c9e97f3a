//! Rigid shapes at their poses, and the contacts of two of them.

use super::super::curvature::Curvature;
use super::super::rigid_shape::RigidShape;
use crate::geometry::Pose;
use glam::DVec3;

/// Largest distance by which visited parts may miss their contact, relative to the largest penetration of a descent.
pub(super) const MISS: f64 = 1e-3;

/// Rigid shape at its pose in the world.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact::equilibrium) struct Placed<'a> {
    pub shape: RigidShape<'a>,
    pub pose: Pose,
}

/// Penetrations of rigid meshes, metres.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact::equilibrium) struct Depth {
    /// Largest penetration that is searched.
    pub searched: f64,
    /// Largest penetration at any pose of a descent. Tolerances are relative to it, so that they are equal at all poses.
    pub largest: f64,
}

impl Depth {
    /// Searches penetrations of at most `largest` metres.
    pub fn up_to(largest: f64) -> Self {
        Self {
            searched: largest,
            largest,
        }
    }
}

/// Range of penetrations of interest, metres.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact::equilibrium) struct Range {
    /// Largest gap between two shapes.
    pub gap: f64,
    /// Penetrations of two shapes.
    pub depth: Depth,
}

impl Range {
    /// Returns the largest distance from a surface at which a point of interest can be, metres.
    pub fn reach(&self) -> f64 {
        self.gap.max(self.depth.searched)
    }
}

/// Contact of two shapes; vectors are in the world.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact::equilibrium) struct Found {
    /// Numbers of the touching parts of both shapes.
    pub parts: [u32; 2],
    /// Numbers that identify the contact. All parts of a smooth patch that one point touches are one contact, whose penetration is the largest one.
    pub identity: [u32; 2],
    pub penetration: f64,
    /// Distance by which the parts miss the contact, metres, at most [`MISS`] times the largest penetration of a descent: the foot is beside the face, or the nearest points are
    /// beside the ridges. At most 0 for a contact.
    pub beyond: f64,
    /// Point at which the displacement of both shapes is measured, metres.
    pub point: DVec3,
    /// Derivatives of the penetration with respect to the motion of the first shape relative to the second.
    pub curvature: Curvature,
    /// Distance of the contact point from `point`, along the normal towards the second shape, metres.
    pub inset: f64,
}
