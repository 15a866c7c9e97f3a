//! Free objects, and the ground that supports these objects: skins, planes and obstacles.

use super::rigid_shape::RigidShape;
use crate::contact::friction::TangentialSpring;
use crate::contact::relaxation_factor;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::text::in_range::positive;
use crate::world::Patch;
use glam::DVec3;

/// Rigid object that moves only under gravity and contact forces.
#[derive(Clone, Copy, Debug)]
pub struct FreeObject<'a> {
    pub(super) shape: RigidShape<'a>,
    pub(super) mass: f64,
    pub(super) center_of_mass: DVec3,
    /// Distance from the centre of mass to the farthest surface point, metres.
    pub(super) radius: f64,
}

impl<'a> FreeObject<'a> {
    /// Creates an object of `mass` (kg, positive) with its centre of mass given in the object's frame (metres).
    ///
    /// # Errors
    /// If a value is not finite or the mass is not positive.
    pub fn new(shape: impl Into<RigidShape<'a>>, mass: f64, center_of_mass: DVec3) -> Result<Self> {
        let shape = shape.into();
        positive("object mass", mass, "kg")?;
        if !center_of_mass.is_finite() {
            return Err(Error::input(
                "centre of mass",
                center_of_mass,
                "finite coordinates in metres",
            ));
        }
        Ok(Self {
            shape,
            mass,
            center_of_mass,
            radius: shape.reach_from(center_of_mass),
        })
    }
}

/// Skin patch at a pose, as part of the ground that supports free objects.
#[derive(Clone, Copy, Debug)]
pub struct PlacedSkin<'a> {
    /// Patch with the skin's taxels.
    pub patch: &'a Patch,
    /// Pose of the patch in the world.
    pub world_from_patch: Pose,
    /// Deflection of each taxel due to objects that are fixed or move along a given path, metres; empty if there are none.
    pub pushed: &'a [f64],
    /// Deflection of each taxel at the end of the previous time step, metres, and the length of the present step, seconds, for the dampers. `None` if there
    /// are no dampers or the taxels have relaxed.
    pub before: Option<(&'a [f64], f64)>,
    /// Tangential springs that act on objects at the beginning of the time step; empty without friction.
    pub tangential_springs: &'a [TangentialSpring],
}

impl<'a> PlacedSkin<'a> {
    /// Creates a skin that touches nothing, now and at the previous time step.
    pub fn new(patch: &'a Patch, world_from_patch: Pose) -> Self {
        Self {
            patch,
            world_from_patch,
            pushed: &[],
            before: None,
            tangential_springs: &[],
        }
    }

    /// Returns the deflection of a free taxel at the end of the time step, metres. With a damper, this is the previous deflection times the relaxation
    /// factor; without a damper, it is 0.
    pub(super) fn relaxed(&self, taxel: usize) -> f64 {
        self.before.map_or(0.0, |(deflections, dt)| {
            deflections[taxel] * relaxation_factor(self.patch.taxels().at(taxel), dt)
        })
    }

    /// Returns the stiffness of a taxel beyond its relaxed deflection, N/m. The value is k / (1 − φ) with the spring stiffness k and the relaxation factor φ
    /// of the time step.
    pub(super) fn stiffness(&self, taxel: usize) -> f64 {
        let taxel = self.patch.taxels().at(taxel);
        match self.before {
            Some((_, dt)) => crate::contact::Relaxation::new(taxel, dt).force(0.0, 1.0),
            None => taxel.stiffness,
        }
    }
}

/// Rigid half-space, such as a table: the points x with x·normal < height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Outward unit normal of the surface, in the world.
    pub normal: DVec3,
    /// Distance of the surface from the origin along the normal, metres, in the world.
    pub height: f64,
}

/// Fixed rigid object that supports free objects.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle<'a> {
    /// Shape of the obstacle.
    pub shape: RigidShape<'a>,
    /// Pose of the obstacle in the world (`world_from_object`).
    pub pose: Pose,
}

/// Fixed surroundings that support free objects.
#[derive(Clone, Debug, Default)]
pub struct Ground<'a> {
    /// Skin patches with elastic taxels.
    pub skins: Vec<PlacedSkin<'a>>,
    /// Rigid half-spaces, such as a table.
    pub planes: Vec<HalfSpace>,
    /// Fixed rigid obstacles.
    pub obstacles: Vec<Obstacle<'a>>,
}

impl Ground<'_> {
    /// Returns the ground in a frame whose origin is moved to `origin`.
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
