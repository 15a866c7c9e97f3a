//! A free object on its way down.

use super::free_object::FreeObject;
use super::symmetric::Six;
use crate::geometry::Pose;
use glam::{DQuat, DVec3};

/// Where a free object is; its motions are three translations of the centre of mass along the world's axes, and three rotations about them
/// through it, times its arm (metres).
#[derive(Clone, Debug)]
pub(super) struct Body<'a> {
    /// Of the object, among those that are put to rest.
    pub number: usize,
    pub object: FreeObject<'a>,
    /// m g, newtons.
    pub weight: DVec3,
    start: DVec3,
    /// Of mass.
    pub center: DVec3,
    pub rotation: DQuat,
}

impl<'a> Body<'a> {
    pub fn new((number, object): (usize, FreeObject<'a>), gravity: DVec3, start: &Pose) -> Self {
        let center = start.transform_point(object.center_of_mass);
        Self {
            number,
            object,
            weight: object.mass * gravity,
            start: center,
            center,
            rotation: start.rotation,
        }
    }

    /// Rotations count by how far they move a point this far from the centre of mass, metres.
    pub fn arm(&self) -> f64 {
        self.object.radius
    }

    pub fn pose(&self) -> Pose {
        let from_origin = self.rotation * self.object.center_of_mass;
        Pose::new(self.rotation, self.center - from_origin)
    }

    /// Moves it (six numbers); its way, metres.
    pub fn go(&mut self, motion: &[f64]) -> DVec3 {
        let (shift, turn) = (DVec3::from_slice(motion), DVec3::from_slice(&motion[3..]));
        self.center += shift;
        let turn = DQuat::from_scaled_axis(turn / self.arm());
        self.rotation = (turn * self.rotation).normalize();
        shift
    }

    /// What is left of a force (N) and a torque (N·m) with the weight: see [`Equilibrium::imbalance`](super::Equilibrium::imbalance).
    pub fn imbalance_of(&self, (force, torque): (DVec3, DVec3)) -> f64 {
        let weight = self.weight.length();
        let of_force = (force + self.weight).length() / weight;
        of_force.max(torque.length() / (weight * self.arm()))
    }

    /// Where it went to from where it started, across its weight if it did.
    pub fn way_out(&self) -> DVec3 {
        let down = self.weight.normalize();
        let way = self.center - self.start;
        let across = way - way.dot(down) * down;
        if across.length() > 1e-9 * way.length() {
            across.normalize()
        } else {
            down
        }
    }
}

/// How a point of a body moves when it goes along or turns about each of the axes; per metre. `from_center`: from the centre of mass to it.
pub(super) fn ways(axes: &[DVec3; 3], from_center: DVec3, arm: f64) -> [DVec3; 6] {
    let [x, y, z] = *axes;
    let turn = |axis: DVec3| axis.cross(from_center) / arm;
    [x, y, z, turn(x), turn(y), turn(z)]
}

/// By each motion of a body what goes by `gradient` when a point of it moves.
pub(super) fn along(ways: &[DVec3; 6], gradient: DVec3) -> Six {
    ways.map(|way| gradient.dot(way))
}
