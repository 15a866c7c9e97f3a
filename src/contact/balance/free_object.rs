//! What is to be put to rest, and on what.

use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::objects::{Sphere, SphereUnion};
use crate::world::Patch;
use glam::DVec3;

/// A rigid object that only gravity and skins hold.
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
        if !(mass.is_finite() && mass > 0.0) {
            return Err(Error::input(
                "object mass",
                format!("{mass} kg"),
                "a finite positive number",
            ));
        }
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
    /// How far other objects push each taxel, metres; empty if there are none.
    pub pushed: &'a [f64],
}
