//! A robot covered in skin: patches on the sides of its cylinders and on the half balls at their ends.

use super::body_patch::{BodyPatch, WholeBody};
use super::half_balls::{HalfBall, half_balls};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::world::{Dome, Extrusion, LinkGeometry, Robot, ShapeRole, Taxel};
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, TAU};

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

/// What covers: equal taxels, and how they are shared out.
#[derive(Clone, Copy)]
struct Cover {
    taxel: Taxel,
    /// From taxel to taxel, metres.
    pitch: f64,
    /// Of a patch, about, metres.
    side: f64,
}

/// Patches so far.
#[derive(Default)]
struct Covered {
    patches: Vec<BodyPatch>,
    mounts: Vec<Mount>,
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
    /// Covers the cylinders, capsules and balls that a robot's links touch with, cut into equal patches of about `side` by `side`
    /// metres, a taxel about every `pitch` metres, across the seams too.
    ///
    /// - The side of a cylinder is cut around and along. Patches are called by their link, their ring from its lower end and their
    ///   place around it from +x, both from 1: `trunk 2.3`; a link's second cylinder begins with `trunk'`.
    /// - A ball at the end of a cylinder of its radius, and the end of a capsule, is covered on its outer half, any other ball
    ///   wholly; each half is cut from pole to rim: `head cap 2.3` is the third part of the second half ball of the file. A ball
    ///   within a larger one of another link, such as an elbow's inner one, is never touched, and left out.
    ///
    /// Flat ends and boxes stay bare.
    ///
    /// # Errors
    /// A robot with nothing to cover, a taxel that cannot be, or a pitch or side for which a patch has no or too many taxels.
    pub fn new(robot: &Robot, taxel: Taxel, pitch: f64, side: f64) -> Result<Self> {
        let cover = Cover { taxel, pitch, side };
        let mut covered = Covered::default();
        let half_balls = half_balls(robot)?;
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
                    covered.add_side(&side_of, cover)?;
                    name.push('\'');
                }
            }
            let of_link = half_balls.iter().filter(|half| half.link == number);
            for (cap, half) in of_link.enumerate() {
                covered.add_half_ball(&format!("{} cap {}", link.name, cap + 1), half, cover)?;
            }
        }
        if covered.patches.is_empty() {
            return Err(Error::input(
                format!("robot {}", robot.name()),
                "no cylinder or ball to cover",
                "a link with a collision cylinder, capsule or sphere",
            ));
        }
        Ok(Self {
            body: WholeBody::new(covered.patches)?,
            mounts: covered.mounts,
        })
    }

    /// The patches.
    pub fn body(&self) -> &WholeBody {
        &self.body
    }

    /// The link that each patch is on.
    pub fn links(&self) -> impl ExactSizeIterator<Item = usize> {
        self.mounts.iter().map(|mount| mount.link)
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

impl Covered {
    fn add_side(&mut self, of: &Side, cover: Cover) -> Result<()> {
        let Cover { taxel, pitch, side } = cover;
        let parts = |length: f64| (length / side).round().max(1.0);
        let (n_around, n_along) = (parts(TAU * of.radius), parts(of.length));
        // Half a pitch is left at each seam, so that taxels go on across it.
        let arc = TAU / n_around - pitch / of.radius;
        let length = of.length / n_along - pitch;
        let part = Extrusion::cylinder(of.radius, length.max(0.0), arc, pitch)
            .map_err(|error| error.under(format!("skin of {}, ", of.name)))?;
        for ring in 0..n_along as usize {
            let height = ((ring as f64 + 0.5) / n_along - 0.5) * of.length;
            for place in 0..n_around as usize {
                let turn = DQuat::from_rotation_z(TAU * place as f64 / n_around);
                let cylinder_from_patch = Pose::new(turn, height * DVec3::Z);
                let name = format!("{} {}.{}", of.name, ring + 1, place + 1);
                self.patches
                    .push(BodyPatch::new(name, part.clone(), taxel)?);
                self.mounts.push(Mount {
                    link: of.link,
                    link_from_patch: of.link_from_cylinder.compose(&cylinder_from_patch),
                });
            }
        }
        Ok(())
    }

    fn add_half_ball(&mut self, name: &str, half: &HalfBall, cover: Cover) -> Result<()> {
        let Cover { taxel, pitch, side } = cover;
        let area = TAU * half.radius * half.radius;
        let n_around = (area / (side * side)).round().max(1.0);
        let part = Dome::new(half.radius, FRAC_PI_2, TAU / n_around, pitch)
            .map_err(|error| error.under(format!("skin of {name}, ")))?;
        for place in 0..n_around as usize {
            let turn = DQuat::from_rotation_z(TAU * place as f64 / n_around);
            let name = format!("{name}.{}", place + 1);
            self.patches
                .push(BodyPatch::dome(name, part.clone(), taxel)?);
            self.mounts.push(Mount {
                link: half.link,
                link_from_patch: half.link_from_ball.compose(&Pose::from_rotation(turn)),
            });
        }
        Ok(())
    }
}
