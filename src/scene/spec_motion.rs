//! Specification of poses and motions in a scene file, and their conversion to SI units.

use crate::files::FilePath;
use crate::geometry::{Pose, rotation_from_rpy};
use crate::inputs::check::Rule;
use crate::inputs::params::{named, params};
use crate::inputs::range::Range::{NotNegative, Positive};
use crate::inputs::units::MM;
use crate::world::{Interpolation, Oscillation, Phase};
use glam::DVec3;
use std::collections::BTreeMap;

named!(Interpolation);

params! {
    /// Position and rotation of a body, such as `at = { position_mm = [0.0, 0.0, 50.0], rotation_deg = [180.0, 0.0, 0.0] }`.
    #[derive(Copy, Default)]
    pub struct PoseSpec {
        /// Position of the body's origin, mm. Default: 0.
        position_mm: [f64; 3] = [0.0; 3];
        /// Rotations about the fixed axes x, y, z, applied in this order, degrees. Default: 0.
        rotation_deg: [f64; 3] = [0.0; 3];
    }
}

params! {
    /// Imposed motion of a base or an object: phases of constant velocity, an oscillation, way-points, or a CSV file of way-points.
    #[derive(Default)]
    pub struct MotionSpec {
        /// Phases of constant velocity, one after another, starting at the pose `at`.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        phases: Vec<PhaseSpec> = Vec::new();
        /// Poses at given times, in the world or on the link that carries the object; replaces `at`.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        way_points: Vec<WayPointSpec> = Vec::new();
        /// Sinusoidal motion about the pose `at`.
        oscillation: Option<OscillationSpec>;
        /// CSV file with a time and a pose in each row (way-points).
        csv: Option<FilePath>;
        /// Interpolation of the poses between way-points. Default: `cubic`.
        interpolation: Option<Interpolation>;
    }
}

params! {
    /// Phase of a motion with constant velocity, such as `{ duration_s = 1.0, linear_mm_per_s = [0.0, 0.0, -5.0] }`.
    #[derive(Copy)]
    pub struct PhaseSpec {
        /// Duration of the phase, s.
        duration_s: f64 => NotNegative;
        /// Velocity of the body's origin in the world frame, mm/s. Default: 0.
        linear_mm_per_s: [f64; 3] = [0.0; 3];
        /// Angular velocity about the body's origin in the world frame, degrees per second. Default: 0.
        angular_deg_per_s: [f64; 3] = [0.0; 3];
    }
}

params! {
    /// Sinusoidal motion, such as `{ linear_mm = [0.0, 0.0, 10.0], period_s = 0.5 }`.
    ///
    /// At time t, with s = sin(2π t / period), the body at `at` is rotated about the origin by s · `angular_deg`, then translated by s · `linear_mm`.
    #[derive(Copy)]
    pub struct OscillationSpec {
        /// Amplitude of the translation in the world or link frame, mm. Default: 0.
        linear_mm: [f64; 3] = [0.0; 3];
        /// Amplitude of the rotation vector about the origin of the world or link frame, degrees. Default: 0.
        angular_deg: [f64; 3] = [0.0; 3];
        /// Period of the oscillation, s, positive.
        period_s: f64 => Positive;
    }
}

params! {
    /// Pose at a given time (way-point), such as `{ time_s = 0.5, position_mm = [0.0, 0.0, 20.0] }`.
    #[derive(Copy)]
    pub struct WayPointSpec {
        /// Time of the way-point since the start of the scene, s.
        time_s: f64;
        /// Position of the body's origin in the world frame, mm. Default: 0.
        position_mm: [f64; 3] = [0.0; 3];
        /// Rotations about the fixed axes x, y, z, applied in this order, degrees. Default: 0. If one angle changes between two way-points, the body turns by this
        /// change, also beyond 180°. If several change, the body takes the shorter way, and changes of 180° or more are refused.
        rotation_deg: [f64; 3] = [0.0; 3];
    }
}

params! {
    /// Joint positions over time: way-points in the scene file or in a CSV file.
    #[derive(Default)]
    pub struct JointsSpec {
        /// CSV file with a time and the joint positions in each row (way-points).
        csv: Option<FilePath>;
        /// Interpolation of the joint positions between way-points. Default: `cubic`.
        interpolation: Option<Interpolation>;
        /// Times of the way-points since the start of the scene, s.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        time_s: Vec<f64> = Vec::new();
        /// Positions of each moved joint, one number for each time. A key is the joint's name with its unit, such as `elbow_deg`, `elbow_rad`, `slide_mm` or
        /// `slide_m`.
        #[serde(skip_serializing_if = "BTreeMap::is_empty")]
        positions: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    }
}

/// Keys of `[motion]` that exclude each other or act together.
pub(super) const MOTION_RULES: &[Rule] = &[
    Rule::OneOf(&["phases", "way_points", "csv", "oscillation"]),
    Rule::Beside("interpolation", &["way_points", "csv"]),
];

/// Keys of `[joints]` that exclude each other.
pub(super) const JOINTS_RULES: &[Rule] = &[Rule::Excludes("csv", &["time_s", "positions"])];

/// Converts a vector in mm to metres.
pub(crate) fn metres(vector_mm: [f64; 3]) -> DVec3 {
    MM * DVec3::from_array(vector_mm)
}

/// Converts a vector of angles in degrees to radians.
fn radians(angles_deg: [f64; 3]) -> DVec3 {
    1f64.to_radians() * DVec3::from_array(angles_deg)
}

impl PoseSpec {
    /// Returns the pose, with its position in metres.
    pub fn pose(&self) -> Pose {
        let rotation = rotation_from_rpy(radians(self.rotation_deg));
        Pose::new(rotation, metres(self.position_mm))
    }
}

impl WayPointSpec {
    /// Returns the position, metres, and the rotations about the fixed axes, radians.
    pub(super) fn position_and_angles(&self) -> [DVec3; 2] {
        [metres(self.position_mm), radians(self.rotation_deg)]
    }
}

impl PhaseSpec {
    /// Returns the phase in SI units.
    pub(super) fn phase(&self) -> Phase {
        Phase {
            duration: self.duration_s,
            linear: metres(self.linear_mm_per_s),
            angular: radians(self.angular_deg_per_s),
        }
    }
}

impl OscillationSpec {
    /// Returns the oscillation about a pose, in SI units.
    pub(super) fn about(&self, start: Pose) -> Oscillation {
        Oscillation {
            start,
            linear: metres(self.linear_mm),
            angular: radians(self.angular_deg),
            period: self.period_s,
        }
    }
}
