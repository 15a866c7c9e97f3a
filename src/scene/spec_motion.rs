//! Poses and motions in a scene file.

use crate::files::FilePath;
use crate::world::Interpolation;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// `at = { position_mm = [0.0, 0.0, 50.0], rotation_deg = [180.0, 0.0, 0.0] }`
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoseSpec {
    /// Of the origin.
    #[serde(default)]
    pub position_mm: [f64; 3],
    /// Turns about the fixed axes x, y, z in turn.
    #[serde(default, alias = "rpy_deg")]
    pub rotation_deg: [f64; 3],
}

/// How a base or an object moves, in one of three ways: phases of constant velocity, way-points, or way-points in a CSV file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionSpec {
    /// One after the other, from `at`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub phases: Vec<PhaseSpec>,
    /// Poses in the world; `at` is then not given.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub way_points: Vec<WayPointSpec>,
    /// A file of way-points: see [`PoseTrajectory::read_csv`](crate::world::PoseTrajectory::read_csv).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub csv: Option<FilePath>,
    /// Between way-points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interpolation: Option<Interpolation>,
}

/// `{ duration_s = 1.0, linear_mm_per_s = [0.0, 0.0, -5.0] }`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhaseSpec {
    /// How long.
    pub duration_s: f64,
    /// Of the origin, in the world.
    #[serde(default)]
    pub linear_mm_per_s: [f64; 3],
    /// In the world, about the origin.
    #[serde(default)]
    pub angular_deg_per_s: [f64; 3],
}

/// `{ time_s = 0.5, position_mm = [0.0, 0.0, 20.0] }`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WayPointSpec {
    /// When.
    pub time_s: f64,
    /// Of the origin, in the world.
    #[serde(default)]
    pub position_mm: [f64; 3],
    /// Turns about the fixed axes x, y, z in turn.
    #[serde(default, alias = "rpy_deg")]
    pub rotation_deg: [f64; 3],
}

/// Way-points of a robot's joints, here or in a CSV file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointsSpec {
    /// A file of way-points: see [`JointTrajectory::read_csv`](crate::world::JointTrajectory::read_csv).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub csv: Option<FilePath>,
    /// Between way-points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interpolation: Option<Interpolation>,
    /// Times of the way-points.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub time_s: Vec<f64>,
    /// One number a time for each joint that is moved, under its name and its unit: `elbow_deg`, `elbow_rad`,
    /// `slide_mm` or `slide_m`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub positions: BTreeMap<String, Vec<f64>>,
}
