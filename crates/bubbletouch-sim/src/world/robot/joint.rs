//! Joints: motions of links relative to each other.

use super::Dimension;
use crate::geometry::{Pose, rotation_from_rpy};
use glam::{DQuat, DVec3};

/// Joint between two links of a `Robot`.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name of the joint, unique in its robot.
    pub name: String,
    /// Kind of motion that the joint allows.
    pub kind: JointKind,
    /// Index of the parent link. If several joints move one link (MJCF), the parent of all joints but the first is the link itself.
    pub parent: usize,
    /// Index of the child link, which the joint moves.
    pub child: usize,
    /// Pose of the child link on the parent link (`parent_from_joint`) if the joint is at its reference position.
    pub origin: Pose,
    /// Axis of the joint, unit vector in the joint's frame; unused by fixed, floating and ball joints.
    pub axis: DVec3,
    /// Point of the joint's frame through which the axis of a hinge passes, or about which a ball joint rotates, metres; zero in URDF.
    pub anchor: DVec3,
    /// Position of a hinge or slide at which the joint does not move its child, rad or m; zero in URDF, `ref` in MJCF.
    pub reference: f64,
    /// Limits of position and velocity; `None` for joints without a `<limit>`, without coordinates, or with several coordinates.
    pub limits: Option<Limits>,
    /// Relation to the joint that this joint mimics, if any.
    pub mimic: Option<Mimic>,
}

/// Kinds of joints in URDF \[URDF\] and MJCF \[MJCF\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Hinge with limits.
    Revolute,
    /// Hinge without limits.
    Continuous,
    /// Linear slide with limits.
    Prismatic,
    /// Rigid connection without motion.
    Fixed,
    /// Free motion: six coordinates.
    Floating,
    /// Motion in the plane perpendicular to the axis: three coordinates.
    Planar,
    /// Rotation about a point: three coordinates (MJCF, and `spherical` in URDF).
    Ball,
}

/// Limits of a hinge or slide: radians or metres, and seconds. Missing or contradictory limits are infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Lowest position, rad or m; −∞ without a limit, as for a continuous joint.
    pub lower: f64,
    /// Highest position, rad or m, not below `lower`; +∞ without a limit, as for a continuous joint.
    pub upper: f64,
    /// Highest speed, rad/s or m/s, zero or positive; +∞ without a limit.
    pub velocity: f64,
    /// Highest torque or force of the joint, N·m or N, zero or positive; +∞ without a limit. This library does not use the limit.
    pub effort: f64,
}

/// Relation of a joint to another joint: `position = multiplier · position of the other + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mimic {
    /// Index of the other joint, which may itself mimic a joint.
    pub joint: usize,
    /// Factor applied to the other joint's position; dimensionless, rad/m or m/rad.
    pub multiplier: f64,
    /// Offset added to the multiplied position of the other joint, rad or m.
    pub offset: f64,
}

impl JointKind {
    /// Names of the joint kinds in URDF.
    pub(super) const ALL: [(&'static str, Self); 7] = [
        ("revolute", Self::Revolute),
        ("continuous", Self::Continuous),
        ("prismatic", Self::Prismatic),
        ("fixed", Self::Fixed),
        ("floating", Self::Floating),
        ("planar", Self::Planar),
        // Extension of URDF by Bullet, which MuJoCo also reads.
        ("spherical", Self::Ball),
    ];

    /// Returns the suffix and the dimension of each coordinate of this joint kind; the suffix is appended to the joint's name.
    pub fn coordinates(self) -> &'static [(&'static str, Dimension)] {
        use Dimension::{Angle, Length};
        match self {
            Self::Fixed => &[],
            Self::Revolute | Self::Continuous => &[("", Angle)],
            Self::Prismatic => &[("", Length)],
            Self::Planar => &[(".x", Length), (".y", Length), (".theta", Angle)],
            Self::Ball => &[(".roll", Angle), (".pitch", Angle), (".yaw", Angle)],
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

    /// Returns whether the joint is a hinge or a slide; only these can mimic and be mimicked.
    pub fn has_one_coordinate(self) -> bool {
        self.coordinates().len() == 1
    }
}

impl Joint {
    /// Creates the joint that fixes a link, with the index and name of the `child`, to its parent.
    pub(super) fn fixed(child_name: &str, parent: usize, child: usize, origin: Pose) -> Self {
        Self {
            name: format!("{child_name}_fixed"),
            kind: JointKind::Fixed,
            parent,
            child,
            origin,
            axis: DVec3::X,
            anchor: DVec3::ZERO,
            reference: 0.0,
            limits: None,
            mimic: None,
        }
    }

    /// Returns the pose `parent_from_child` for the given coordinates; their number depends on the kind of joint.
    pub(super) fn pose(&self, coordinates: &[f64]) -> Pose {
        let motion = match (self.kind, coordinates) {
            (JointKind::Revolute | JointKind::Continuous, &[angle]) => {
                self.turn(DQuat::from_axis_angle(self.axis, angle - self.reference))
            }
            (JointKind::Prismatic, &[travel]) => {
                Pose::from_translation((travel - self.reference) * self.axis)
            }
            (JointKind::Ball, &[roll, pitch, yaw]) => {
                self.turn(rotation_from_rpy(DVec3::new(roll, pitch, yaw)))
            }
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

    /// Returns the rotation about the anchor of the joint.
    fn turn(&self, rotation: DQuat) -> Pose {
        Pose::new(rotation, self.anchor - rotation * self.anchor)
    }
}

/// Returns the x and y directions of the plane perpendicular to a unit axis, right-handed about it. URDF does not define these directions. For an axis along +z
/// they are the directions of the joint's frame, as in other tools. For other axes with z ≥ 0, they are rotated from +z by the smallest rotation. For z < 0,
/// they are rotated from −z, with y reversed.
fn plane_across(axis: DVec3) -> (DVec3, DVec3) {
    // The construction is accurate for all axes \[Duff et al., Building an orthonormal basis, revisited, 2017\].
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
