//! A sphere of a free object and what it pushes: a taxel, or something rigid.
//!
//! A rigid surface is treated as a taxel without a spring at the end of its stroke: its deflection is the penetration of the sphere, and its force
//! is that of the stop.

use super::reach::Reach;
use super::rigid_contact::{Touched, Touching};
use glam::{DMat3, DVec3};

/// A body's place among those on their way, and the number of one of its spheres.
pub(super) type Part = (u32, u32);

/// What is pushed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Key {
    /// A skin's number and a taxel's in it.
    Taxel(u32, u32),
    /// Something rigid, by one sphere; other free objects by their places among bodies.
    Rigid(Part, Touched),
}

/// The part of a pair that is none of a free object: how far others push the taxel.
pub(super) const OTHERS: Part = (u32::MAX, u32::MAX);

/// A sphere and what it pushes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub key: Key,
    pub part: Part,
    /// Past where it is without anything that pushes it, metres; negative if they do not touch yet.
    pub deflection: f64,
    pub kind: Kind,
    /// From the centre of mass to the sphere's centre; in the patch frame, or of rigid things in the world.
    pub arm: DVec3,
}

/// How the deflection of a pair changes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Taxel(Reach),
    Rigid(Touching),
    /// Not at all: what others push.
    Fixed,
}

impl Pair {
    /// `gradient` and curvature of its deflection by a motion of the sphere, relative to what else moves; `None` of others.
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

    /// The bodies that its deflection depends on: which, which way their points count, and where these are from their centres of mass.
    pub fn ends(&self) -> impl Iterator<Item = (usize, f64, DVec3)> {
        let other = match &self.kind {
            Kind::Rigid(touching) => touching.other,
            _ => None,
        };
        let own = (self.part != OTHERS).then_some((self.part.0 as usize, 1.0, self.arm));
        let other = other.map(|(body, arm)| (body as usize, -1.0, arm));
        own.into_iter().chain(other)
    }

    /// What a force (N) along the axis of the taxel is on the sphere, newtons; in the frame of its arm.
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
