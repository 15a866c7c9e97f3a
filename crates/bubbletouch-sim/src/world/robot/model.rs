//! A robot as links and joints, and where its links are.

use super::mimic::Drive;
use super::tree::Tree;
use super::{Coordinate, Joint, Link};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::text::spelling::known;
use std::collections::HashSet;

/// A rigid multi-link body. Invariant: its joints make one tree of its links.
///
/// ```
/// use bubbletouch_sim::geometry::Pose;
/// use bubbletouch_sim::world::Robot;
///
/// let door = Robot::from_urdf("door.urdf", r#"
/// <robot name="door">
///   <link name="frame"/>
///   <link name="leaf"/>
///   <joint name="hinge" type="revolute">
///     <parent link="frame"/>
///     <child link="leaf"/>
///     <origin xyz="0.5 0 0"/>
///     <axis xyz="0 0 1"/>
///     <limit lower="0" upper="1.6" velocity="1" effort="10"/>
///   </joint>
/// </robot>"#)?;
/// let world_from_link = door.forward(&Pose::IDENTITY, &[1.2])?;
/// assert_eq!(world_from_link[door.link("leaf")?].translation.x, 0.5);
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    name: String,
    links: Vec<Link>,
    joints: Vec<Joint>,
    tree: Tree,
    /// One a joint.
    drives: Vec<Drive>,
    coordinates: Vec<Coordinate>,
    pub(super) notes: Vec<String>,
}

impl Robot {
    /// A robot of one link without joints: its base is moved, and nothing else.
    pub fn floating(name: &str) -> Self {
        let link = Link {
            name: name.to_owned(),
            shapes: Vec::new(),
        };
        Self {
            name: name.to_owned(),
            links: vec![link],
            joints: Vec::new(),
            tree: Tree {
                root: 0,
                outward: Vec::new(),
            },
            drives: Vec::new(),
            coordinates: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// From parts that were checked. The error is two coordinates of one name.
    pub(super) fn assembled(
        (name, place): (String, &str),
        links: Vec<Link>,
        joints: Vec<Joint>,
        tree: Tree,
        drives: Vec<Drive>,
        notes: Vec<String>,
    ) -> Result<Self> {
        let mut coordinates = Vec::new();
        for (index, joint) in joints.iter().enumerate() {
            let own = joint.kind.coordinates().iter();
            let coordinate = |&(suffix, dimension): &(&str, _)| Coordinate {
                name: format!("{}{suffix}", joint.name),
                joint: index,
                dimension,
            };
            if joint.mimic.is_none() {
                coordinates.extend(own.map(coordinate));
            }
        }
        let mut names = HashSet::new();
        if let Some(second) = coordinates.iter().find(|c| !names.insert(c.name.as_str())) {
            let given = format!("two coordinates called `{}`", second.name);
            return Err(Error::input(place, given, "joints of other names"));
        }
        Ok(Self {
            name,
            links,
            joints,
            tree,
            drives,
            coordinates,
            notes,
        })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Sentences on what the file has and the robot has not, each with the file's name and the line; empty if nothing was left out.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// In the order of the file.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// In the order of the file.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Index of the link that no joint moves: the base.
    pub fn base(&self) -> usize {
        self.tree.root
    }

    /// What each of its positions is, in their order.
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// How many positions it has.
    pub fn n_positions(&self) -> usize {
        self.coordinates.len()
    }

    /// Positions at which the robot stands if nothing moves it: 0, or the nearest limit of a joint whose range excludes 0; rad and m.
    pub fn rest_positions(&self) -> Vec<f64> {
        let rest = |coordinate: &Coordinate| {
            let limits = self.joints[coordinate.joint].limits;
            limits.map_or(0.0, |limits| 0f64.clamp(limits.lower, limits.upper))
        };
        self.coordinates.iter().map(rest).collect()
    }

    /// Index of a link by its name.
    ///
    /// # Errors
    /// The error offers names that resemble it.
    pub fn link(&self, name: &str) -> Result<usize> {
        let names = self.links.iter().map(|link| link.name.as_str());
        known(format!("link of robot `{}`", self.name), name, names)
    }

    /// Index of a joint by its name.
    ///
    /// # Errors
    /// The error offers names that resemble it.
    pub fn joint(&self, name: &str) -> Result<usize> {
        let names = self.joints.iter().map(|joint| joint.name.as_str());
        known(format!("joint of robot `{}`", self.name), name, names)
    }

    /// `world_from_link` of every link, in their order; `world_from_base` is where the base is. See
    /// [`forward_into`](Self::forward_into).
    ///
    /// # Errors
    /// Those of [`forward_into`](Self::forward_into).
    pub fn forward(&self, world_from_base: &Pose, positions: &[f64]) -> Result<Vec<Pose>> {
        let mut world_from_link = vec![Pose::IDENTITY; self.links.len()];
        self.forward_into(world_from_base, positions, &mut world_from_link)?;
        Ok(world_from_link)
    }

    /// The same into a slice of one pose a link, without allocation.
    ///
    /// Limits are not checked here: see [`JointTrajectory`](crate::world::JointTrajectory).
    ///
    /// # Errors
    /// A slice of another length than the robot has positions or links, or a position that is not finite.
    pub fn forward_into(
        &self,
        world_from_base: &Pose,
        positions: &[f64],
        world_from_link: &mut [Pose],
    ) -> Result<()> {
        self.check_positions(positions)?;
        if world_from_link.len() != self.links.len() {
            return Err(self.wrong_length("link poses", world_from_link.len(), self.links.len()));
        }
        world_from_link[self.tree.root] = *world_from_base;
        for &index in &self.tree.outward {
            let joint = &self.joints[index];
            let drive = &self.drives[index];
            let own = positions.get(drive.position..).unwrap_or_default();
            let parent_from_child = match joint.mimic {
                None => joint.pose(&own[..joint.kind.coordinates().len()]),
                Some(_) if drive.multiplier == 0.0 => joint.pose(&[drive.offset]),
                Some(_) => joint.pose(&[drive.multiplier * own[0] + drive.offset]),
            };
            world_from_link[joint.child] =
                world_from_link[joint.parent].compose(&parent_from_child);
        }
        Ok(())
    }

    /// Which position moves a joint of one coordinate, and how: `(position, multiplier, offset)`; `None` for the others and for joints
    /// that no position moves, because they mimic a fixed joint. A joint that mimics none has multiplier 1 and offset 0.
    pub fn drive_of(&self, joint: usize) -> Option<(usize, f64, f64)> {
        let drive = self.drives[joint];
        let is_one = self.joints[joint].kind.has_one_coordinate() && drive.multiplier != 0.0;
        is_one.then_some((drive.position, drive.multiplier, drive.offset))
    }

    fn check_positions(&self, positions: &[f64]) -> Result<()> {
        if positions.len() != self.n_positions() {
            return Err(self.wrong_length("positions", positions.len(), self.n_positions()));
        }
        match positions.iter().position(|position| !position.is_finite()) {
            Some(wrong) => Err(Error::input(
                format!(
                    "position `{}` of robot `{}`",
                    self.coordinates[wrong].name, self.name
                ),
                positions[wrong],
                "a finite number",
            )),
            None => Ok(()),
        }
    }

    fn wrong_length(&self, what: &str, given: usize, allowed: usize) -> Error {
        let place = format!("{what} of robot `{}`", self.name);
        Error::input(place, given, format!("{allowed} of them"))
    }
}
