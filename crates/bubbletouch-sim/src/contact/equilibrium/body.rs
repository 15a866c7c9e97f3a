//! State of a free object during the descent to equilibrium.

use super::free_object::FreeObject;
use super::symmetric::Six;
use crate::geometry::Pose;
use glam::{DQuat, DVec3};

/// Free object during the search for equilibrium. A motion has six components: three translations of the centre of mass along the world's axes, and three
/// rotations about them. Rotations are multiplied by the arm (the object's radius), so that all components are in metres.
#[derive(Clone, Debug)]
pub(super) struct Body<'a> {
    /// Index of the object in the list passed to the solver.
    pub number: usize,
    pub object: FreeObject<'a>,
    /// Weight vector of the object (mass times gravity), newtons.
    pub weight: DVec3,
    start: DVec3,
    /// Centre of mass, metres, in the world.
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

    /// Returns the object's radius, metres, by which angles are multiplied to express rotations as displacements.
    pub fn arm(&self) -> f64 {
        self.object.radius
    }

    pub fn pose(&self) -> Pose {
        let from_origin = self.rotation * self.object.center_of_mass;
        Pose::new(self.rotation, self.center - from_origin)
    }

    /// Moves the body by a motion of six components; returns the translation of the centre of mass, metres.
    pub fn go(&mut self, motion: &[f64]) -> DVec3 {
        let (shift, turn) = (DVec3::from_slice(motion), DVec3::from_slice(&motion[3..]));
        self.center += shift;
        let turn = DQuat::from_scaled_axis(turn / self.arm());
        self.rotation = (turn * self.rotation).normalize();
        shift
    }

    /// Returns the imbalance of the body, dimensionless. The imbalance is the residual force (N) relative to the weight, or the residual torque (N·m)
    /// relative to weight times radius, if larger.
    pub fn imbalance_of(&self, (force, torque): (DVec3, DVec3)) -> f64 {
        let weight = self.weight.length();
        let of_force = (force + self.weight).length() / weight;
        of_force.max(torque.length() / (weight * self.arm()))
    }

    /// Returns the unit vector from the start position to the present position, perpendicular to the weight. Returns the weight's direction if the body fell
    /// straight.
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

/// Returns the displacements of a point of a body for the six unit motions, per metre. `from_center` is the vector from the centre of mass to the point.
pub(super) fn unit_motions(axes: &[DVec3; 3], from_center: DVec3, arm: f64) -> [DVec3; 6] {
    let [x, y, z] = *axes;
    let turn = |axis: DVec3| axis.cross(from_center) / arm;
    [x, y, z, turn(x), turn(y), turn(z)]
}

/// Returns the derivatives of a function with respect to the six motions of a body, by the chain rule. `gradient` is the derivative of the function with
/// respect to the displacement of a point.
pub(super) fn along(ways: &[DVec3; 6], gradient: DVec3) -> Six {
    ways.map(|way| gradient.dot(way))
}
