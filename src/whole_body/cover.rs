//! A robot covered in skin: a patch on every part of the sides of its cylinders.

use super::body_patch::{BodyPatch, WholeBody};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::world::{Extrusion, LinkGeometry, Robot, ShapeRole, Taxel};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// A robot's skin, and where its patches are on the links.
#[derive(Clone, Debug)]
pub struct CoveredRobot {
    body: WholeBody,
    mounts: Vec<Mount>,
}

/// Where a patch is.
#[derive(Clone, Copy, Debug)]
struct Mount {
    link: usize,
    link_from_patch: Pose,
}

/// The side of a cylinder on a link.
struct Side<'a> {
    name: &'a str,
    link: usize,
    link_from_cylinder: Pose,
    radius: f64,
    length: f64,
}

impl CoveredRobot {
    /// Covers the sides of the cylinders and capsules that a robot's links touch with, each cut around and along into equal
    /// patches of about `side` metres, a taxel about every `pitch` metres, across the seams too.
    ///
    /// Patches are called by their link, their ring from its lower end and their place around it from +x, both from 1:
    /// `trunk 2.3`; a link's second cylinder begins with `trunk'`. The error is a robot without a cylinder, a taxel that
    /// cannot be, or a pitch or side for which a patch has no or too many taxels.
    pub fn new(robot: &Robot, taxel: Taxel, pitch: f64, side: f64) -> Result<Self> {
        let mut patches = Vec::new();
        let mut mounts = Vec::new();
        for (number, link) in robot.links().iter().enumerate() {
            let mut name = link.name.clone();
            for shape in &link.shapes {
                let (LinkGeometry::Cylinder { radius, length }
                | LinkGeometry::Capsule { radius, length }) = shape.geometry
                else {
                    continue;
                };
                if shape.role == ShapeRole::Collision {
                    let side_of = Side {
                        name: &name,
                        link: number,
                        link_from_cylinder: shape.origin,
                        radius,
                        length,
                    };
                    side_of.cover(taxel, pitch, side, &mut patches, &mut mounts)?;
                    name.push('\'');
                }
            }
        }
        if patches.is_empty() {
            return Err(Error::input(
                format!("robot {}", robot.name()),
                "no cylinder to cover",
                "a link with a collision cylinder or capsule",
            ));
        }
        Ok(Self {
            body: WholeBody::new(patches)?,
            mounts,
        })
    }

    /// The patches.
    pub fn body(&self) -> &WholeBody {
        &self.body
    }

    /// The `world_from_patch` poses for a robot whose links are at `world_from_link` poses, in the order of the patches.
    ///
    /// # Panics
    /// If there are not as many poses as links.
    pub fn patch_poses(&self, world_from_links: &[Pose], poses: &mut Vec<Pose>) {
        poses.clear();
        poses.extend(
            self.mounts
                .iter()
                .map(|mount| world_from_links[mount.link].compose(&mount.link_from_patch)),
        );
    }
}

impl Side<'_> {
    fn cover(
        &self,
        taxel: Taxel,
        pitch: f64,
        side: f64,
        patches: &mut Vec<BodyPatch>,
        mounts: &mut Vec<Mount>,
    ) -> Result<()> {
        let parts = |length: f64| (length / side).round().max(1.0);
        let (n_around, n_along) = (parts(TAU * self.radius), parts(self.length));
        // Half a pitch is left at each seam, so that taxels go on across it.
        let arc = TAU / n_around - pitch / self.radius;
        let length = self.length / n_along - pitch;
        let part = Extrusion::cylinder(self.radius, length.max(0.0), arc, pitch)
            .map_err(|error| error.under(format!("skin of {}, ", self.name)))?;
        for ring in 0..n_along as usize {
            let height = ((ring as f64 + 0.5) / n_along - 0.5) * self.length;
            for place in 0..n_around as usize {
                let turn = DQuat::from_rotation_z(TAU * place as f64 / n_around);
                let cylinder_from_patch = Pose::new(turn, height * DVec3::Z);
                let name = format!("{} {}.{}", self.name, ring + 1, place + 1);
                patches.push(BodyPatch::new(name, part.clone(), taxel)?);
                mounts.push(Mount {
                    link: self.link,
                    link_from_patch: self.link_from_cylinder.compose(&cylinder_from_patch),
                });
            }
        }
        Ok(())
    }
}
