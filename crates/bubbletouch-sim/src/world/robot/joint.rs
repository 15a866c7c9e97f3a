//! Joints: how a link moves on another.

use super::Dimension;
use crate::geometry::{Pose, rotation_from_rpy};
use glam::{DQuat, DVec3};

/// A joint between two links of a [`Robot`](super::Robot).
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Unique among the robot's joints.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// Index of the link that carries it.
    pub parent: usize,
    /// Index of the link that it moves.
    pub child: usize,
    /// `parent_from_joint`: where the child link is at zero coordinates.
    pub origin: Pose,
    /// Unit vector in the joint's frame; it means nothing to fixed and floating joints.
    pub axis: DVec3,
    /// Range of its position and velocity; `None` for joints of no coordinate or several, and joints without a `<limit>`.
    pub limits: Option<Limits>,
    /// The joint that it follows, if it does.
    pub mimic: Option<Mimic>,
}

/// The six kinds of URDF \[URDF\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// A hinge with ends.
    Revolute,
    /// A hinge without ends.
    Continuous,
    /// A slide.
    Prismatic,
    /// No motion.
    Fixed,
    /// Six coordinates.
    Floating,
    /// Three coordinates in the plane across the axis.
    Planar,
}

/// Limits of a hinge or slide: radians or metres, and seconds. A limit that the file lacks, or that contradicts itself, is infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Lowest position, rad or m; −∞ if there is none, as on a continuous joint.
    pub lower: f64,
    /// Highest position, rad or m, not below `lower`; +∞ if there is none, as on a continuous joint.
    pub upper: f64,
    /// Highest speed, rad/s or m/s, zero or positive; +∞ if there is none.
    pub velocity: f64,
    /// Highest torque or force, N·m or N, zero or positive; +∞ if there is none. Nothing here uses it.
    pub effort: f64,
}

/// `position = multiplier · position of the other + offset`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mimic {
    /// Index of the joint that is followed; it may itself follow one.
    pub joint: usize,
    /// No unit, rad/m or m/rad.
    pub multiplier: f64,
    /// rad or m.
    pub offset: f64,
}

impl JointKind {
    /// URDF's word and the kind of each.
    pub(super) const ALL: [(&'static str, Self); 6] = [
        ("revolute", Self::Revolute),
        ("continuous", Self::Continuous),
        ("prismatic", Self::Prismatic),
        ("fixed", Self::Fixed),
        ("floating", Self::Floating),
        ("planar", Self::Planar),
    ];

    /// What is appended to the joint's name for each of its coordinates, and what the coordinate measures.
    pub fn coordinates(self) -> &'static [(&'static str, Dimension)] {
        use Dimension::{Angle, Length};
        match self {
            Self::Fixed => &[],
            Self::Revolute | Self::Continuous => &[("", Angle)],
            Self::Prismatic => &[("", Length)],
            Self::Planar => &[(".x", Length), (".y", Length), (".theta", Angle)],
            Self::Floating => &[
                (".x", Length),
                (".y", Length),
                (".z", Length),
                (".roll", Angle),
                (".pitch", Angle),
                (".yaw", Angle),
            ],
        }
    }

    /// A hinge or a slide: what can mimic and be mimicked.
    pub fn has_one_coordinate(self) -> bool {
        self.coordinates().len() == 1
    }
}

impl Joint {
    /// `parent_from_child` at these coordinates, as many as the kind has.
    pub(super) fn pose(&self, coordinates: &[f64]) -> Pose {
        let motion = match (self.kind, coordinates) {
            (JointKind::Revolute | JointKind::Continuous, &[angle]) => {
                Pose::from_rotation(DQuat::from_axis_angle(self.axis, angle))
            }
            (JointKind::Prismatic, &[travel]) => Pose::from_translation(travel * self.axis),
            (JointKind::Planar, &[x, y, theta]) => {
                let (along_x, along_y) = plane_across(self.axis);
                let turn = DQuat::from_axis_angle(self.axis, theta);
                Pose::new(turn, x * along_x + y * along_y)
            }
            (JointKind::Floating, &[x, y, z, roll, pitch, yaw]) => Pose::new(
                rotation_from_rpy(DVec3::new(roll, pitch, yaw)),
                DVec3::new(x, y, z),
            ),
            _ => return self.origin,
        };
        self.origin.compose(&motion)
    }
}

/// The x and y directions of the plane across a unit axis, right-handed about it: those of the joint's frame for an axis
/// along +z, as other tools have it; for any other, those turned the shortest way from +z (axes with z ≥ 0) or from −z with y
/// reversed (the others). URDF leaves them open.
fn plane_across(axis: DVec3) -> (DVec3, DVec3) {
    // [Duff et al., Building an orthonormal basis, revisited, 2017]: no angle at which it loses digits.
    let sign = if axis.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    (
        DVec3::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
        DVec3::new(b, sign + axis.y * axis.y * a, -axis.y),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plane_of_a_planar_joint_is_right_handed_about_its_axis() {
        let directions = [
            DVec3::Z,
            DVec3::NEG_Z,
            DVec3::X,
            DVec3::new(1.0, -2.0, -0.5),
            DVec3::new(1e-9, 0.0, -1.0),
        ];
        for axis in directions.map(DVec3::normalize) {
            let (x, y) = plane_across(axis);
            assert!((x.cross(y) - axis).length() < 1e-15, "{axis}: {x}, {y}");
            assert!((x.length() - 1.0).abs() < 1e-15 && x.dot(y).abs() < 1e-15);
        }
        assert_eq!(plane_across(DVec3::Z), (DVec3::X, DVec3::Y));
    }
}
