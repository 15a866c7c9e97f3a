//! Pair of a part of a free object and the taxel or rigid contact that it pushes. A part is a sphere, or a corner, an edge or a face of a mesh.
//!
//! A rigid surface is treated as a taxel without a spring at the end of its stroke. The penetration of the part is treated as the deflection, and the
//! contact force as the force at the end of the stroke.

use super::curvature::Curvature;
use super::meshes::MeshReach;
use super::reach::Reach;
use super::rigid_contact::{Touched, Touching};
use glam::DVec3;

/// Part of a free object: index of the body among the bodies of the solver, and index of the sphere, or number of the part of the mesh.
pub(super) type Part = (u32, u32);

/// Taxel or rigid counterpart that a sphere pushes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Key {
    /// Index of the skin, and index of the taxel in the skin.
    Taxel(u32, u32),
    /// Rigid contact of one sphere with the given counterpart. Another free object as counterpart is given by its index among the bodies of the solver.
    Rigid(Part, Touched),
}

/// Placeholder for the sphere of a pair if the deflection of the taxel is due to objects that are fixed or move along a given path.
pub(super) const OTHERS: Part = (u32::MAX, u32::MAX);

/// Sphere of a free object, with the taxel or rigid counterpart that it pushes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub key: Key,
    pub part: Part,
    /// Deflection that contact with the sphere requires, measured from the taxel's relaxed deflection, metres. The value is negative if sphere and taxel do
    /// not touch yet.
    pub deflection: f64,
    pub kind: Kind,
    /// Vector from the centre of mass to the sphere's centre, metres; in the patch frame for taxels, in the world for rigid contacts.
    pub arm: DVec3,
}

/// Quantities on which the deflection of a pair depends when bodies move.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// Taxel and sphere.
    Taxel(Reach),
    /// Taxel and part of a mesh: derivatives of the deflection, and whether the contact is grazing.
    Mesh(Curvature, bool),
    Rigid(Touching),
    /// The deflection does not depend on free bodies, because objects that are fixed or move along a given path push the taxel.
    Fixed,
}

impl Pair {
    pub fn on_mesh(key: Key, slot: u32, found: &MeshReach, center_of_mass: DVec3) -> Self {
        Self {
            key,
            part: (slot, found.part),
            deflection: found.deflection,
            kind: Kind::Mesh(found.curvature, found.is_grazing),
            arm: found.center - center_of_mass,
        }
    }

    /// Returns the derivatives of the deflection with respect to the motion of the body relative to its counterpart; `None` for fixed pairs.
    pub fn derivatives(&self) -> Option<Curvature> {
        match &self.kind {
            Kind::Taxel(reach) => Some(reach.derivatives()),
            Kind::Mesh(curvature, _) => Some(*curvature),
            Kind::Rigid(touching) => Some(touching.curvature),
            Kind::Fixed => None,
        }
    }

    /// Returns the bodies on which the deflection depends: index, sign of the motion, and vector from the centre of mass to the contact point.
    pub fn ends(&self) -> impl Iterator<Item = (usize, f64, DVec3)> {
        let other = match &self.kind {
            Kind::Rigid(touching) => touching.other,
            _ => None,
        };
        let own = (self.part != OTHERS).then_some((self.part.0 as usize, 1.0, self.arm));
        let other = other.map(|(body, arm)| (body as usize, -1.0, arm));
        own.into_iter().chain(other)
    }

    /// Returns the force on the sphere, newtons, that results from a `force` (N) along the taxel's axis. The result is in the patch frame for taxels, in the
    /// world for rigid contacts.
    pub fn push(&self, force: f64) -> DVec3 {
        let gradient = self.derivatives().map(|found| found.gradient);
        -force * gradient.unwrap_or(DVec3::ZERO)
    }

    pub fn is_grazing(&self) -> bool {
        match &self.kind {
            Kind::Taxel(reach) => reach.is_grazing(),
            Kind::Mesh(_, is_grazing) => *is_grazing,
            _ => false,
        }
    }
}
