//! Rigid motions, bounding boxes and points.

use crate::error::{Error, Result};
use glam::{DMat3, DQuat, DVec3, EulerRot};
use std::collections::HashSet;

/// Rigid motion: rotation, then translation. `a_from_b` maps points of frame b to frame a.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Rotation of the motion, unit quaternion.
    pub rotation: DQuat,
    /// Translation of the motion, metres.
    pub translation: DVec3,
}

impl Pose {
    /// Identity transform: no motion.
    pub const IDENTITY: Self = Self {
        rotation: DQuat::IDENTITY,
        translation: DVec3::ZERO,
    };

    /// Creates the motion that rotates by a unit quaternion and then translates (metres).
    pub fn new(rotation: DQuat, translation: DVec3) -> Self {
        Self {
            rotation,
            translation,
        }
    }

    /// Creates a pure translation, metres.
    pub fn from_translation(translation: DVec3) -> Self {
        Self::new(DQuat::IDENTITY, translation)
    }

    /// Creates a pure rotation.
    pub fn from_rotation(rotation: DQuat) -> Self {
        Self::new(rotation, DVec3::ZERO)
    }

    /// Returns x, y, z, qw, qx, qy, qz: the translation, metres, and the unit quaternion with its scalar part first, as in MuJoCo.
    pub fn to_array(&self) -> [f64; 7] {
        let (t, q) = (self.translation, self.rotation);
        [t.x, t.y, t.z, q.w, q.x, q.y, q.z]
    }

    /// Returns the composition of two motions: `a_from_b.compose(&b_from_c)` is `a_from_c`. The motion `inner` acts first.
    pub fn compose(&self, inner: &Self) -> Self {
        Self::new(
            (self.rotation * inner.rotation).normalize(),
            self.transform_point(inner.translation),
        )
    }

    /// Returns the inverse motion, which undoes this motion.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.conjugate();
        Self::new(rotation, -(rotation * self.translation))
    }

    /// Returns the motion relative to a frame: `world_from_b.seen_from(&world_from_a)` is `a_from_b`. Unlike `inverse().compose()`, this function subtracts the
    /// translations first, so that no digits are lost far from the world's origin.
    pub fn seen_from(&self, frame: &Self) -> Self {
        let back = frame.rotation.conjugate();
        Self::new(
            (back * self.rotation).normalize(),
            back * (self.translation - frame.translation),
        )
    }

    /// Returns the image of a point under the motion, metres.
    pub fn transform_point(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.translation
    }

    /// Returns the image of a direction under the motion, that is, the rotated direction.
    pub fn transform_vector(&self, vector: DVec3) -> DVec3 {
        self.rotation * vector
    }
}

/// Maximum deviation of the squared length of a quaternion from 1. If larger, poses scale their objects visibly; if smaller, quaternions that were stored in
/// single precision are refused.
const UNIT_TOLERANCE: f64 = 1e-6;

/// Returns an error unless there is one pose for each of `n` parts of a scene (`object` or `patch`), and each pose is finite and has a unit quaternion.
pub(crate) fn check_poses(part: &str, n: usize, poses: &[Pose]) -> Result<()> {
    if poses.len() != n {
        return Err(Error::input(
            format!("poses of {part}s"),
            format!("{} poses for {n} {part}s", poses.len()),
            format!("one pose for each {part}"),
        ));
    }
    let is_valid = |pose: &Pose| {
        let deviation = pose.rotation.length_squared() - 1.0;
        pose.translation.is_finite() && deviation.abs() <= UNIT_TOLERANCE
    };
    match poses.iter().position(|pose| !is_valid(pose)) {
        None => Ok(()),
        Some(index) => {
            let Pose {
                rotation,
                translation,
            } = poses[index];
            Err(Error::input(
                format!("pose of {part} {}", index + 1),
                format!("translation {translation} m, quaternion {rotation}"),
                "finite numbers, and a quaternion of length one",
            ))
        }
    }
}

/// Returns the rotation `Rz(yaw) Ry(pitch) Rx(roll)`: about the fixed axes x, y, z in this order, radians (URDF's roll, pitch, yaw).
pub fn rotation_from_rpy(rpy: DVec3) -> DQuat {
    // Rotations about the fixed axes x, y, z equal rotations about the moving axes z, y, x.
    DQuat::from_euler(EulerRot::ZYX, rpy.z, rpy.y, rpy.x)
}

/// Returns roll, pitch and yaw of a rotation, radians: the inverse of [`rotation_from_rpy`]. The product of the three rotations is accurate for every rotation;
/// near a pitch of ±90° roll and yaw alone are not unique.
pub fn rpy_from_rotation(rotation: DQuat) -> DVec3 {
    let matrix = DMat3::from_quat(rotation);
    let yaw = matrix.x_axis.y.atan2(matrix.x_axis.x);
    // The remaining rotation is Ry(pitch) Rx(roll), for any error of the yaw.
    let rest = DMat3::from_rotation_z(-yaw) * matrix;
    let pitch = (-rest.x_axis.z).atan2(rest.x_axis.x);
    let roll = (-rest.z_axis.y).atan2(rest.y_axis.y);
    DVec3::new(roll, pitch, yaw)
}

/// Normalises a quaternion from a file; `None` if its length differs from 1 by more than 0.001. Components with four digits are accurate enough.
pub fn written_rotation(quaternion: DQuat) -> Option<DQuat> {
    let is_near = (quaternion.length() - 1.0).abs() <= 1e-3;
    is_near.then(|| quaternion.normalize())
}

/// Converts a rotation matrix from a file to a unit quaternion. Returns `None` if an entry of R Rᵀ differs from the identity by more than 0.001, or if the
/// matrix mirrors.
pub fn written_rotation_matrix(matrix: &DMat3) -> Option<DQuat> {
    let is_orthogonal = (*matrix * matrix.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-3);
    let is_rotation = is_orthogonal && matrix.determinant() > 0.0;
    is_rotation.then(|| DQuat::from_mat3(matrix).normalize())
}

/// Axis-aligned bounding box, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Corner of the box with the smallest coordinates.
    pub min: DVec3,
    /// Corner of the box with the largest coordinates.
    pub max: DVec3,
}

impl Aabb {
    /// Returns the smallest box around other boxes; `None` if there are no boxes.
    pub fn around(boxes: impl IntoIterator<Item = Self>) -> Option<Self> {
        boxes.into_iter().reduce(|a, b| a.joined(&b))
    }

    /// Box without points, which changes no box that it is joined with.
    pub const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    /// Returns the smallest box around points, metres; [`EMPTY`](Self::EMPTY) if there are none.
    pub fn around_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        let points = points.into_iter();
        points.fold(Self::EMPTY, |around, point| Self {
            min: around.min.min(point),
            max: around.max.max(point),
        })
    }

    /// Returns the smallest box around this box and another one.
    pub fn joined(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Returns the edge lengths of the box, metres.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// Returns the squared distance from a point to the box, zero inside; m².
    #[inline]
    pub fn distance_squared(&self, point: DVec3) -> f64 {
        let beyond = (self.min - point).max(point - self.max).max(DVec3::ZERO);
        beyond.length_squared()
    }

    /// Returns whether no point is in both boxes.
    pub fn is_apart(&self, other: &Self) -> bool {
        self.min.cmpgt(other.max).any() || other.min.cmpgt(self.max).any()
    }

    /// Returns the bounding box of the box after a rotation and a translation (metres).
    pub fn turned(&self, turn: &DMat3, shift: DVec3) -> Self {
        let half = 0.5 * self.size();
        let center = *turn * self.center() + shift;
        let [x, y, z] = [turn.x_axis, turn.y_axis, turn.z_axis].map(DVec3::abs);
        let reach = half.x * x + half.y * y + half.z * z;
        Self {
            min: center - reach,
            max: center + reach,
        }
    }

    /// Returns the box enlarged by `margin` (metres, not negative) on every side.
    pub fn widened(&self, margin: f64) -> Self {
        Self {
            min: self.min - margin,
            max: self.max + margin,
        }
    }

    /// Returns the position, as a multiple of `direction`, at which a line enters the box; at least `from`. Infinite if the line misses the box.
    pub fn entry(&self, origin: DVec3, direction: DVec3, from: f64) -> f64 {
        let (mut start, mut end) = (from, f64::INFINITY);
        for axis in 0..3 {
            let low = self.min[axis] - origin[axis];
            let high = self.max[axis] - origin[axis];
            if direction[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return f64::INFINITY;
                }
                continue;
            }
            let (a, b) = (low / direction[axis], high / direction[axis]);
            start = start.max(a.min(b));
            end = end.min(a.max(b));
        }
        // Rounding must not let a line pass between two touching boxes.
        if start <= end + 1e-12 * end.abs() {
            start
        } else {
            f64::INFINITY
        }
    }

    /// Returns the centre of the box, metres.
    pub fn center(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }
}

/// Returns the bits of a point's coordinates, which are equal exactly for equal points.
pub fn place_bits(point: DVec3) -> [u64; 3] {
    // Adding zero makes −0 and 0 equal.
    (point + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// Returns each distinct point of `points` once, in the order of first occurrence.
pub fn distinct_places(points: &[DVec3]) -> Vec<DVec3> {
    let mut seen = HashSet::new();
    let is_new = |point: &DVec3| seen.insert(place_bits(*point));
    points.iter().copied().filter(is_new).collect()
}
