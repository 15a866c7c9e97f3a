//! Skin that covers a robot: patches on cylinders, on their hemispherical or flat ends, and on boxes.

use super::body_patch::WholeBody;
use super::flat_ends::flat_ends;
use super::half_balls::{End, half_balls};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::world::{Dome, Extrusion, Grid, Layout, LinkGeometry, Patch, Robot, Taxel};
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Skin that covers a robot, with the mounting poses of its patches on the links.
#[derive(Clone, Debug)]
pub struct CoveredRobot {
    body: WholeBody,
    mounts: Vec<Mount>,
}

/// Mounting of a patch: the index of its link, and its pose on the link.
#[derive(Clone, Copy, Debug)]
struct Mount {
    link: usize,
    link_from_patch: Pose,
}

/// Properties of a skin cover: the type of the taxels, their pitch, and the size of the patches.
#[derive(Clone, Copy)]
struct Cover {
    taxel: Taxel,
    /// Distance between neighbouring taxels, metres.
    pitch: f64,
    /// Approximate side of each patch, metres.
    side: f64,
}

impl Cover {
    /// Returns the number of patches along an edge or arc of the given length, metres.
    fn parts(&self, length: f64) -> f64 {
        (length / self.side).round().max(1.0)
    }
}

/// Patches created so far, with their mountings on the links.
#[derive(Default)]
struct Covered {
    patches: Vec<Patch>,
    mounts: Vec<Mount>,
}

/// Shape of a link that is being covered with skin.
struct On<'a> {
    name: &'a str,
    link: usize,
    link_from_shape: Pose,
}

impl CoveredRobot {
    /// Covers the collision cylinders, capsules, spheres and boxes of a robot with equal patches of about `side` by `side` metres. Taxels are about `pitch`
    /// metres apart, also across seams; on boxes, taxels are 0.5 to 1.5 pitches apart across seams.
    ///
    /// - The side of a cylinder is divided around and along. The name of a patch contains the link, the ring from its lower end, and the position around it
    ///   from +x, both from 1: `trunk 2.3`. Names for the link's second shape begin with `trunk'`.
    /// - The end of a capsule, and a sphere at the end of a cylinder of its radius, are covered on their outer half. Other spheres are covered
    ///   wholly. Each half is divided from pole to rim: `head cap 2.3` is the third part of the second hemisphere in the file.
    /// - A sphere within a larger sphere of another link, such as the inner sphere of an elbow, cannot be touched and is omitted.
    /// - Each face of a box is a grid of flat patches: `palm face 5 1.2`. The faces are numbered in the order +x, −x, +y, −y, +z, −z.
    ///
    /// Flat ends of cylinders are not covered.
    ///
    /// # Errors
    /// If there is nothing to cover, the taxel is invalid, or `pitch` and `side` give a patch with no or too many taxels.
    pub fn new(robot: &Robot, taxel: Taxel, pitch: f64, side: f64) -> Result<Self> {
        Self::with_cover(robot, Cover { taxel, pitch, side }, &[])
    }

    /// Covers a robot with skin as `new` does, and also covers the flat ends of cylinders. Each flat end has a round patch of staggered rows, such as `palm
    /// end 1`. An end that lies on another cylinder, sphere or box when all joints are at zero cannot be touched and is omitted.
    ///
    /// # Errors
    /// If `new` fails for these arguments.
    pub fn with_flat_ends(robot: &Robot, taxel: Taxel, pitch: f64, side: f64) -> Result<Self> {
        Self::with_cover(robot, Cover { taxel, pitch, side }, &flat_ends(robot)?)
    }

    fn with_cover(robot: &Robot, cover: Cover, ends: &[End]) -> Result<Self> {
        let mut covered = Covered::default();
        let half_balls = half_balls(robot)?;
        for (number, link) in robot.links().iter().enumerate() {
            let mut name = link.name.clone();
            for shape in link.solids() {
                let on = On {
                    name: &name,
                    link: number,
                    link_from_shape: shape.origin,
                };
                match shape.geometry {
                    LinkGeometry::Cylinder { radius, length }
                    | LinkGeometry::Capsule { radius, length } => {
                        covered.add_side(&on, (radius, length), cover)?;
                    }
                    LinkGeometry::Box { size } => covered.add_faces(&on, size, cover)?,
                    _ => continue,
                }
                name.push('\'');
            }
            let of_link = half_balls.iter().filter(|half| half.link == number);
            for (cap, half) in of_link.enumerate() {
                covered.add_half_ball(&format!("{} cap {}", link.name, cap + 1), half, cover)?;
            }
            let of_link = ends.iter().filter(|end| end.link == number);
            for (place, end) in of_link.enumerate() {
                covered.add_end(&format!("{} end {}", link.name, place + 1), end, cover)?;
            }
        }
        if covered.patches.is_empty() {
            return Err(Error::input(
                format!("robot {}", robot.name()),
                "nothing to cover",
                "a link with a collision cylinder, capsule, sphere or box",
            ));
        }
        Ok(Self {
            body: WholeBody::new(&covered.patches)?,
            mounts: covered.mounts,
        })
    }

    /// Returns the whole body made of all patches.
    pub fn body(&self) -> &WholeBody {
        &self.body
    }

    /// Returns, for each patch, the index of the link on which it is mounted.
    pub fn links(&self) -> impl ExactSizeIterator<Item = usize> {
        self.mounts.iter().map(|mount| mount.link)
    }

    /// Writes the poses `world_from_patch` of all patches, in order, for given link poses `world_from_links`.
    ///
    /// # Panics
    /// If the number of poses differs from the number of links.
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
    fn add(&mut self, patch: Patch, link: usize, link_from_patch: Pose) {
        self.patches.push(patch);
        self.mounts.push(Mount {
            link,
            link_from_patch,
        });
    }

    fn add_side(&mut self, on: &On, (radius, length): (f64, f64), cover: Cover) -> Result<()> {
        let Cover { taxel, pitch, .. } = cover;
        let (n_around, n_along) = (cover.parts(TAU * radius), cover.parts(length));
        // At each seam half a pitch is left free, so that taxels continue at equal distances across it.
        let arc = TAU / n_around - pitch / radius;
        let part_length = length / n_along - pitch;
        let part = Extrusion::cylinder(radius, part_length.max(0.0), arc, pitch)
            .map_err(|error| error.under(format!("skin of {}, ", on.name)))?;
        for ring in 0..n_along as usize {
            let height = ((ring as f64 + 0.5) / n_along - 0.5) * length;
            for place in 0..n_around as usize {
                let turn = DQuat::from_rotation_z(TAU * place as f64 / n_around);
                let cylinder_from_patch = Pose::new(turn, height * DVec3::Z);
                let name = format!("{} {}.{}", on.name, ring + 1, place + 1);
                let patch = Patch::new(name, part.clone(), taxel)?;
                self.add(
                    patch,
                    on.link,
                    on.link_from_shape.compose(&cylinder_from_patch),
                );
            }
        }
        Ok(())
    }

    /// Adds patches on the faces of a box; the x and y axes of each patch are the two axes that follow its normal cyclically.
    fn add_faces(&mut self, on: &On, size: DVec3, cover: Cover) -> Result<()> {
        for (face, (axis, side)) in (0..6).map(|face| (face, (face / 2, face % 2))) {
            let outwards = DVec3::AXES[axis] * if side == 0 { 1.0 } else { -1.0 };
            let along = DVec3::AXES[(axis + 1) % 3];
            let turn = DMat3::from_cols(along, outwards.cross(along), outwards);
            let box_from_face = Pose::new(DQuat::from_mat3(&turn), 0.5 * size[axis] * outwards);
            let link_from_face = on.link_from_shape.compose(&box_from_face);
            let [width, height] = [1, 2].map(|next| size[(axis + next) % 3]);
            let (n_x, n_y) = (cover.parts(width), cover.parts(height));
            let taxels = |length: f64| (length / cover.pitch).round().max(1.0) as usize;
            let grid = Grid {
                nx: taxels(width / n_x),
                ny: taxels(height / n_y),
                pitch: cover.pitch,
            };
            let name = format!("{} face {}", on.name, face + 1);
            let part = Extrusion::grid(&grid);
            let part = part.map_err(|error| error.under(format!("skin of {name}, ")))?;
            let place = |k: usize, n: f64, length: f64| ((k as f64 + 0.5) / n - 0.5) * length;
            for row in 0..n_y as usize {
                for column in 0..n_x as usize {
                    let (x, y) = (place(column, n_x, width), place(row, n_y, height));
                    let face_from_patch = Pose::from_translation(DVec3::new(x, y, 0.0));
                    let name = format!("{name} {}.{}", row + 1, column + 1);
                    let patch = Patch::new(name, part.clone(), cover.taxel)?;
                    self.add(patch, on.link, link_from_face.compose(&face_from_patch));
                }
            }
        }
        Ok(())
    }

    /// Adds a patch on the flat end of a cylinder; half a pitch is left free at the rim.
    fn add_end(&mut self, name: &str, end: &End, cover: Cover) -> Result<()> {
        let radius = (end.radius - 0.5 * cover.pitch).max(0.5 * end.radius);
        let layout = Layout::disc(radius, cover.pitch);
        let layout = layout.map_err(|error| error.under(format!("skin of {name}, ")))?;
        let (layout, _) = layout.with_neighbours_together();
        let patch = Patch::new(name, layout, cover.taxel)?;
        self.add(patch, end.link, end.link_from_end);
        Ok(())
    }

    fn add_half_ball(&mut self, name: &str, half: &End, cover: Cover) -> Result<()> {
        let Cover { taxel, pitch, side } = cover;
        let area = TAU * half.radius * half.radius;
        let n_around = (area / (side * side)).round().max(1.0);
        let part = Dome::new(half.radius, FRAC_PI_2, TAU / n_around, pitch)
            .map_err(|error| error.under(format!("skin of {name}, ")))?;
        for place in 0..n_around as usize {
            let turn = DQuat::from_rotation_z(TAU * place as f64 / n_around);
            let name = format!("{name}.{}", place + 1);
            let patch = Patch::new(name, part.clone(), taxel)?;
            let link_from_patch = half.link_from_end.compose(&Pose::from_rotation(turn));
            self.add(patch, half.link, link_from_patch);
        }
        Ok(())
    }
}
