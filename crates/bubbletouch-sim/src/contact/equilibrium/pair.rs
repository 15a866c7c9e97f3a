//! Pair of a sphere of a free object and the taxel or rigid contact that it pushes.
//!
//! A rigid surface is treated as a taxel without a spring at the end of its stroke. The penetration of the sphere is treated as the deflection, and the
//! contact force as the force at the end of the stroke.

use super::reach::Reach;
use super::rigid_contact::{Touched, Touching};
use glam::{DMat3, DVec3};

/// Sphere of a free object: index of the body among the bodies of the solver, and index of the sphere.
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
    Taxel(Reach),
    Rigid(Touching),
    /// The deflection does not depend on free bodies, because objects that are fixed or move along a given path push the taxel.
    Fixed,
}

impl Pair {
    /// Returns the gradient and the second derivative of the deflection with respect to the sphere's motion relative to its counterpart; `None` for fixed
    /// pairs.
    pub fn derivatives(&self) -> Option<(DVec3, DMat3)> {
        match &self.kind {
            Kind::Taxel(reach) => {
                let found = reach.derivatives();
                Some((found.gradient, found.curvature))
            }
            Kind::Rigid(touching) => Some(touching.derivatives()),
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
        let gradient = self.derivatives().map(|(gradient, _)| gradient);
        -force * gradient.unwrap_or(DVec3::ZERO)
    }

    pub fn is_grazing(&self) -> bool {
        match &self.kind {
            Kind::Taxel(reach) => reach.derivatives().is_grazing,
            _ => false,
        }
    }
}
