//! Pair of a sphere of a free object and the taxel or rigid contact that it pushes.
//!
//! A rigid surface is treated as a taxel without a spring at the end of its stroke. The penetration of the sphere is treated as deflection, and the
//! contact force as force of the stop.

use super::reach::Reach;
use super::rigid_contact::{Touched, Touching};
use glam::{DMat3, DVec3};

/// Index of a body in the descent, and number of one of its spheres.
pub(super) type Part = (u32, u32);

/// Taxel or rigid contact that a sphere pushes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Key {
    /// Number of the skin, and number of the taxel in it.
    Taxel(u32, u32),
    /// Rigid contact of one sphere; other free objects are given by their index among the bodies.
    Rigid(Part, Touched),
}

/// Marks a pair whose deflection is due to objects that are not free.
pub(super) const OTHERS: Part = (u32::MAX, u32::MAX);

/// Sphere and the taxel or rigid contact that it pushes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub key: Key,
    pub part: Part,
    /// Deflection past the free position, metres; negative if the two do not touch yet.
    pub deflection: f64,
    pub kind: Kind,
    /// Vector from the centre of mass to the sphere's centre; in the patch frame for taxels, in the world for rigid contacts.
    pub arm: DVec3,
}

/// Dependence of a pair's deflection on motions.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Taxel(Reach),
    Rigid(Touching),
    /// Fixed: the deflection by objects that are not free.
    Fixed,
}

impl Pair {
    /// Returns gradient and curvature of the deflection by the sphere's motion relative to its counterpart; `None` for fixed pairs.
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

    /// Returns the bodies on which the deflection depends: index, sign of their motion, and vector from their centre of mass to the point.
    pub fn ends(&self) -> impl Iterator<Item = (usize, f64, DVec3)> {
        let other = match &self.kind {
            Kind::Rigid(touching) => touching.other,
            _ => None,
        };
        let own = (self.part != OTHERS).then_some((self.part.0 as usize, 1.0, self.arm));
        let other = other.map(|(body, arm)| (body as usize, -1.0, arm));
        own.into_iter().chain(other)
    }

    /// Returns the force on the sphere, newtons, in the frame of its arm, for a force (N) along the axis of the taxel.
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
