//! Free objects, and the ground that carries them: skins, planes and obstacles.

use crate::contact::friction::TangentialSpring;
use crate::contact::relaxation_factor;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::objects::{Sphere, SphereUnion};
use crate::text::in_range::positive;
use crate::world::Patch;
use glam::DVec3;

/// A rigid object that only gravity and what it touches hold.
#[derive(Clone, Copy, Debug)]
pub struct FreeObject<'a> {
    pub(super) spheres: &'a [Sphere],
    pub(super) mass: f64,
    pub(super) center_of_mass: DVec3,
    /// From the centre of mass to the farthest point of a sphere, metres.
    pub(super) radius: f64,
}

impl<'a> FreeObject<'a> {
    /// An object of `mass` (kg, positive) with its centre of mass somewhere in its own frame (metres).
    ///
    /// # Errors
    /// The error names what is not finite or not positive.
    pub fn new(spheres: &'a SphereUnion, mass: f64, center_of_mass: DVec3) -> Result<Self> {
        positive("object mass", mass, "kg")?;
        if !center_of_mass.is_finite() {
            return Err(Error::input(
                "centre of mass",
                center_of_mass,
                "finite coordinates in metres",
            ));
        }
        Ok(Self {
            spheres: spheres.spheres(),
            mass,
            center_of_mass,
            radius: spheres.reach_from(center_of_mass),
        })
    }
}

/// A skin where it is.
#[derive(Clone, Copy, Debug)]
pub struct PlacedSkin<'a> {
    /// The skin.
    pub patch: &'a Patch,
    /// Where it is.
    pub world_from_patch: Pose,
    /// How far objects that are not free push each taxel, metres; empty if there are none.
    pub pushed: &'a [f64],
    /// How far each taxel was in a step ago, metres, and that step, seconds: what its damper holds in. `None` if all stood like this for
    /// long, or without dampers.
    pub before: Option<(&'a [f64], f64)>,
    /// Tangential springs that hold objects at the beginning of the step; empty without friction.
    pub tangential_springs: &'a [TangentialSpring],
}

impl<'a> PlacedSkin<'a> {
    /// A skin that nothing else has pushed or pushes.
    pub fn new(patch: &'a Patch, world_from_patch: Pose) -> Self {
        Self {
            patch,
            world_from_patch,
            pushed: &[],
            before: None,
            tangential_springs: &[],
        }
    }

    /// How far a taxel is in if nothing pushes it, metres: what its damper has left.
    pub(super) fn relaxed(&self, taxel: usize) -> f64 {
        self.before.map_or(0.0, |(deflections, dt)| {
            deflections[taxel] * relaxation_factor(self.patch.taxels().at(taxel), dt)
        })
    }

    /// What a taxel puts against each metre more than [relaxed](Self::relaxed) within the step: k / (1 − φ), N/m.
    pub(super) fn stiffness(&self, taxel: usize) -> f64 {
        let taxel = self.patch.taxels().at(taxel);
        match self.before {
            Some((_, dt)) => crate::contact::Relaxation::of(taxel, dt).force(0.0, 1.0),
            None => taxel.stiffness,
        }
    }
}

/// A half-space that nothing enters, a table: the points x with x·normal < height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Unit, out of it, in the world.
    pub normal: DVec3,
    /// Of its surface along the normal, from the origin, metres.
    pub height: f64,
}

/// An object that stays where it is, whatever rests on it.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle<'a> {
    /// What it is made of.
    pub spheres: &'a SphereUnion,
    /// `world_from_object`.
    pub pose: Pose,
}

/// What free objects rest on.
#[derive(Clone, Debug, Default)]
pub struct Ground<'a> {
    /// Elastic.
    pub skins: Vec<PlacedSkin<'a>>,
    /// Rigid.
    pub planes: Vec<HalfSpace>,
    /// Rigid.
    pub obstacles: Vec<Obstacle<'a>>,
}

impl Ground<'_> {
    /// The same as seen from another origin.
    pub(super) fn seen_from(&self, origin: DVec3) -> Self {
        let mut near = self.clone();
        for skin in &mut near.skins {
            skin.world_from_patch.translation -= origin;
        }
        for plane in &mut near.planes {
            plane.height -= plane.normal.dot(origin);
        }
        for obstacle in &mut near.obstacles {
            obstacle.pose.translation -= origin;
        }
        near
    }
}
