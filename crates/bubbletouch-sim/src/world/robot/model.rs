//! Robot as links and joints, with its forward kinematics.

use super::mimic::Drive;
use super::tactile::TactileSensor;
use super::tree::Tree;
use super::{Coordinate, Joint, Link};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::text::spelling::known;
use std::collections::HashSet;

/// Robot: a rigid multi-link body. Invariant: the joints connect all links to one tree.
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
    /// Sources of the joints' coordinates (own positions or mimicked joints), one per joint.
    drives: Vec<Drive>,
    coordinates: Vec<Coordinate>,
    /// Default position of each coordinate, rad or m.
    rest: Vec<f64>,
    tactile_sensors: Vec<TactileSensor>,
    pub(super) notes: Vec<String>,
}

impl Robot {
    /// Creates a robot that is one link without joints, so that only its base moves.
    pub fn floating(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            links: vec![Link::new(name)],
            joints: Vec::new(),
            tree: Tree {
                root: 0,
                outward: Vec::new(),
            },
            drives: Vec::new(),
            coordinates: Vec::new(),
            rest: Vec::new(),
            tactile_sensors: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Creates a robot from parts that have been checked. The default positions are 0, or the limit nearest to 0. Returns an error if two coordinates have one
    /// name.
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
        let rest = coordinates.iter().map(|coordinate: &Coordinate| {
            let limits = joints[coordinate.joint].limits;
            limits.map_or(0.0, |limits| 0f64.clamp(limits.lower, limits.upper))
        });
        Ok(Self {
            rest: rest.collect(),
            name,
            links,
            joints,
            tree,
            drives,
            coordinates,
            tactile_sensors: Vec::new(),
            notes,
        })
    }

    /// Returns the robot with other default positions. `rest_of` returns the default positions of a joint, one per coordinate of its kind.
    pub(super) fn with_rest(mut self, rest_of: impl Fn(&Joint) -> Vec<f64>) -> Self {
        let own = self.joints.iter().filter(|joint| joint.mimic.is_none());
        self.rest = own.flat_map(rest_of).collect();
        self
    }

    pub(super) fn with_tactile_sensors(self, tactile_sensors: Vec<TactileSensor>) -> Self {
        Self {
            tactile_sensors,
            ..self
        }
    }

    /// Returns the tactile sensors that the robot's file declares, in the order of the file.
    pub fn tactile_sensors(&self) -> &[TactileSensor] {
        &self.tactile_sensors
    }

    /// Returns the name of the robot.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns notes on omitted or changed parts of the file, each with the file's name and the line; empty if there are none.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the links, in the order of the file.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Returns the joints, in the order of the file.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Returns the index of the base link, which no joint moves.
    pub fn base(&self) -> usize {
        self.tree.root
    }

    /// Returns the coordinate of each joint position, in the order of the positions.
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// Returns the number of joint positions.
    pub fn n_positions(&self) -> usize {
        self.coordinates.len()
    }

    /// Returns the default joint positions, rad and m. In URDF they are 0, or the limit nearest to 0 if the joint's range excludes 0. In MJCF they are the
    /// reference positions (MuJoCo's `qpos0`), which can be outside the joint's range.
    pub fn rest_positions(&self) -> Vec<f64> {
        self.rest.clone()
    }

    /// Returns the index of the link with the given name.
    ///
    /// # Errors
    /// If there is no such link; the error suggests similar names.
    pub fn link(&self, name: &str) -> Result<usize> {
        let names = self.links.iter().map(|link| link.name.as_str());
        known(format!("link of robot `{}`", self.name), name, names)
    }

    /// Returns the index of the joint with the given name.
    ///
    /// # Errors
    /// If there is no such joint; the error suggests similar names.
    pub fn joint(&self, name: &str) -> Result<usize> {
        let names = self.joints.iter().map(|joint| joint.name.as_str());
        known(format!("joint of robot `{}`", self.name), name, names)
    }

    /// Returns the index of the joint position with the given name.
    ///
    /// # Errors
    /// If there is no such position. If a mimicking joint has the name, the error contains the joint that it follows; otherwise similar names.
    pub fn position(&self, name: &str) -> Result<usize> {
        let place = format!("joint of robot `{}`", self.name);
        let mut joints = self.joints.iter().filter(|joint| joint.name == name);
        if let Some(mimic) = joints.find_map(|joint| joint.mimic) {
            let followed = &self.joints[mimic.joint].name;
            let given = format!("`{name}`, which mimics `{followed}`");
            return Err(Error::input(place, given, format!("`{followed}`")));
        }
        let names = self.coordinates.iter().map(|joint| joint.name.as_str());
        known(place, name, names)
    }

    /// Returns the pose `world_from_link` of every link, in order; `world_from_base` is the pose of the base.
    ///
    /// # Errors
    /// If the number of positions differs from the robot's, or a position is not finite.
    pub fn forward(&self, world_from_base: &Pose, positions: &[f64]) -> Result<Vec<Pose>> {
        let mut world_from_link = vec![Pose::IDENTITY; self.links.len()];
        self.forward_into(world_from_base, positions, &mut world_from_link)?;
        Ok(world_from_link)
    }

    /// Writes the pose `world_from_link` of every link into a slice of one pose per link, without allocation.
    ///
    /// The function does not check joint limits; a `JointTrajectory` does.
    ///
    /// # Errors
    /// If the number of positions or poses differs from the robot's, or a position is not finite.
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

    /// Returns the entry of the position vector that moves a joint with one degree of freedom, as `(index, multiplier, offset)`. Returns `None` for other
    /// joints and for joints that mimic a fixed joint, which no position moves. A joint that mimics no other joint has multiplier 1 and offset 0.
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
