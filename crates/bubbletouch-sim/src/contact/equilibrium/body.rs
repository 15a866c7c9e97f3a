//! State of a free object during the descent to equilibrium.

use super::free_object::FreeObject;
use super::symmetric::Six;
use crate::geometry::Pose;
use glam::{DQuat, DVec3};

/// Pose of a free object. A motion has six numbers: three translations of the centre of mass along the world's axes, and three rotations
/// about them. A rotation is multiplied by the arm, so that all six numbers are in metres.
#[derive(Clone, Debug)]
pub(super) struct Body<'a> {
    /// Number of the object in the list passed to the solver.
    pub number: usize,
    pub object: FreeObject<'a>,
    /// Weight m g, newtons.
    pub weight: DVec3,
    start: DVec3,
    /// Centre of mass, metres.
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

    /// Returns the arm, metres: the distance from the centre of mass at which rotations are measured as displacements.
    pub fn arm(&self) -> f64 {
        self.object.radius
    }

    pub fn pose(&self) -> Pose {
        let from_origin = self.rotation * self.object.center_of_mass;
        Pose::new(self.rotation, self.center - from_origin)
    }

    /// Moves the body by six numbers; returns the translation, metres.
    pub fn go(&mut self, motion: &[f64]) -> DVec3 {
        let (shift, turn) = (DVec3::from_slice(motion), DVec3::from_slice(&motion[3..]));
        self.center += shift;
        let turn = DQuat::from_scaled_axis(turn / self.arm());
        self.rotation = (turn * self.rotation).normalize();
        shift
    }

    /// Returns the residual of a force (N) and a torque (N·m) together with the weight: see [`Equilibrium::imbalance`](super::Equilibrium::imbalance).
    pub fn imbalance_of(&self, (force, torque): (DVec3, DVec3)) -> f64 {
        let weight = self.weight.length();
        let of_force = (force + self.weight).length() / weight;
        of_force.max(torque.length() / (weight * self.arm()))
    }

    /// Returns the direction from the start to the present position, perpendicular to the weight; the weight's direction if the body fell straight.
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

/// Returns the displacement of a point of a body by each unit motion, per metre; `from_center` is the vector from the centre of mass to the point.
pub(super) fn unit_motions(axes: &[DVec3; 3], from_center: DVec3, arm: f64) -> [DVec3; 6] {
    let [x, y, z] = *axes;
    let turn = |axis: DVec3| axis.cross(from_center) / arm;
    [x, y, z, turn(x), turn(y), turn(z)]
}

/// Returns the derivative by each motion of a body of a quantity whose derivative by the displacement of a point is `gradient`.
pub(super) fn along(ways: &[DVec3; 6], gradient: DVec3) -> Six {
    ways.map(|way| gradient.dot(way))
}
