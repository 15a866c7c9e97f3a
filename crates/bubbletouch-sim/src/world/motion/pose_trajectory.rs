//! Pose of a free body over time.

use super::Interpolation;
use super::curve::{Curve, Moment};
use super::rotation_curve::{RotationCurve, rotation_vector, turn_near};
use super::way_point_csv::{Column, Table, Units};
use super::way_points::WayPoints;
use crate::error::{Error, Result};
use crate::geometry::{Pose, rotation_from_rpy, written_rotation};
use crate::world::Dimension;
use glam::{DQuat, DVec3};
use std::f64::consts::PI;
use std::io::Read;

/// Name of the argument in messages.
const PLACE: &str = "pose trajectory";
const POSITION: [&str; 3] = ["x", "y", "z"];
const QUATERNION: [&str; 4] = ["qx", "qy", "qz", "qw"];
const RPY: [&str; 3] = ["roll", "pitch", "yaw"];

/// Pose of a body over time, interpolated through waypoints; constant before the first and after the last waypoint.
///
/// The coordinates of the position are interpolated as in a `JointTrajectory`. If one of the angles roll, pitch and yaw changes between adjacent waypoints,
/// the body turns about its axis by the given change, which may exceed 180°. All other rotations take the shorter path. Linear interpolation uses slerp; the other interpolations use Hermite curves of quaternions \[KKS\]. The angular velocity of these curves is
/// continuous and zero at the first and last waypoint (for squad only with equidistant times). With monotone interpolation, a turn about one axis never leaves
/// the range of its two waypoints.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseTrajectory {
    times: Vec<f64>,
    position: [Curve; 3],
    rotation: RotationCurve,
}

impl PoseTrajectory {
    /// Creates the trajectory through `poses` (`world_from_body`, one per time) at `times` (seconds, strictly ascending).
    ///
    /// # Errors
    /// If a waypoint is not finite or out of order, or its quaternion is not a unit quaternion (within 0.001), or it is turned by 180° from the waypoint before.
    /// The error names the waypoint.
    pub fn new(times: Vec<f64>, poses: &[Pose], interpolation: Interpolation) -> Result<Self> {
        let row = |pose: &Pose| {
            let [x, y, z] = pose.translation.to_array();
            let [qx, qy, qz, qw] = pose.rotation.to_array();
            [x, y, z, qx, qy, qz, qw]
        };
        let rows: Vec<_> = poses.iter().map(row).collect();
        Self::through(WayPoints::listed(PLACE, times, rows)?, interpolation)
    }

    /// Creates the trajectory through positions, metres, and angles roll, pitch, yaw, radians, about the fixed axes x, y, z in this order.
    ///
    /// # Errors
    /// If a waypoint is not finite or out of order, or several angles change from the waypoint before, one of them by 180° or more. The error names the waypoint.
    pub fn from_rpy(
        times: Vec<f64>,
        way_points: &[[DVec3; 2]],
        interpolation: Interpolation,
    ) -> Result<Self> {
        let row = |[position, rpy]: &[DVec3; 2]| {
            let ([x, y, z], [roll, pitch, yaw]) = (position.to_array(), rpy.to_array());
            [x, y, z, roll, pitch, yaw]
        };
        let rows: Vec<_> = way_points.iter().map(row).collect();
        Self::through(WayPoints::listed(PLACE, times, rows)?, interpolation)
    }

    /// Reads a trajectory from CSV. The columns are `time_s`, the position `x`, `y`, `z` in metres (`_m`) or with `_mm`, and a rotation. The rotation is either
    /// `qx`, `qy`, `qz`, `qw`, or `roll`, `pitch`, `yaw` in radians (`_rad`) or with `_deg`. Roll, pitch and yaw turn about the fixed axes x, y, z in this
    /// order.
    ///
    /// # Errors
    /// If the table is invalid, or a turn is undetermined as for `new` and `from_rpy`. The message begins with `place`, the file's name, and contains the line.
    pub fn read_csv(place: &str, source: impl Read, interpolation: Interpolation) -> Result<Self> {
        let mut table = Table::read(place, source)?;
        let mut columns = claim_all(&mut table, &POSITION, Dimension::Length.units())?;
        if columns.is_empty() {
            return Err(table.refuse_header("no column x", "x, y, z in metres or x_mm, y_mm, z_mm"));
        }
        let quaternion = claim_all(&mut table, &QUATERNION, &[("", 1.0)])?;
        let rpy = claim_all(&mut table, &RPY, Dimension::Angle.units())?;
        if quaternion.is_empty() == rpy.is_empty() {
            let both = match rpy.is_empty() {
                true => "no rotation",
                false => "two rotations",
            };
            let allowed = "qx, qy, qz, qw, or roll, pitch, yaw, or roll_deg, pitch_deg, yaw_deg";
            return Err(table.refuse_header(both, allowed));
        }
        columns.extend(quaternion.iter().chain(&rpy));
        let known = POSITION.into_iter().chain(QUATERNION).chain(RPY);
        Self::through(table.way_points(&columns, known)?, interpolation)
    }

    /// Creates the trajectory from rows of x, y, z and qx, qy, qz, qw, or x, y, z and roll, pitch, yaw.
    fn through(way_points: WayPoints, interpolation: Interpolation) -> Result<Self> {
        let times = &way_points.times;
        let rotations = rotations(&way_points)?;
        let turns = turns(&way_points, &rotations)?;
        let rotation = RotationCurve::through(times, &rotations, &turns, interpolation);
        let curve = |column| way_points.curve(column, "", interpolation);
        Ok(Self {
            position: [curve(0)?, curve(1)?, curve(2)?],
            rotation: rotation.ok_or_else(|| way_points.too_fast(""))?,
            times: way_points.times,
        })
    }

    /// Returns the pose `world_from_body` at a time in seconds.
    pub fn pose_at(&self, time: f64) -> Pose {
        let at = Moment::new(time, &self.times);
        let [x, y, z] = &self.position;
        let translation = DVec3::new(x.value(at), y.value(at), z.value(at));
        Pose::new(self.rotation.rotation(at), translation)
    }

    /// Returns the time of the last waypoint, seconds.
    pub fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }
}

/// Marks the columns with the given names as used and returns them. Returns an empty list if the table has none of them, and an error if it has only some.
fn claim_all(table: &mut Table, names: &[&str], units: Units) -> Result<Vec<Column>> {
    let mut columns = Vec::new();
    let mut missing = None;
    for name in names {
        match table.claim(name, units, |_| false)? {
            Some(column) => columns.push(column),
            None => missing = Some(name),
        }
    }
    match missing {
        Some(name) if !columns.is_empty() => {
            let given = format!("no column {name}");
            Err(table.refuse_header(given, format!("all of {}", names.join(", "))))
        }
        _ => Ok(columns),
    }
}

/// Returns the rotation of each waypoint as a unit quaternion.
fn rotations(way_points: &WayPoints) -> Result<Vec<DQuat>> {
    let rows = way_points.values.rows().into_iter().enumerate();
    rows.map(|(index, row)| {
        if row.len() == 6 {
            return Ok(rotation_from_rpy(DVec3::new(row[3], row[4], row[5])));
        }
        let quaternion = DQuat::from_xyzw(row[3], row[4], row[5], row[6]);
        written_rotation(quaternion).ok_or_else(|| {
            let given = format!("a quaternion of length {}", quaternion.length());
            Error::input(way_points.at(index), given, "length 1")
        })
    })
    .collect()
}

/// Smallest difference from 180° at which the shorter of two turns is determined, radians. If smaller, rounding of a quaternion decides; if larger, turns that
/// are determined are refused.
const UNDETERMINED: f64 = 1e-6;

/// Returns the rotation vector from each waypoint to the next, in the body's frame, radians.
fn turns(way_points: &WayPoints, rotations: &[DQuat]) -> Result<Vec<DVec3>> {
    let turn = |next: usize| {
        let whole = rotations[next - 1].conjugate() * rotations[next];
        let [from, to] = [next - 1, next].map(|index| way_points.values.row(index));
        let refuse = |given: String| {
            let allowed =
                "less than 180°, or a change of one of roll, pitch and yaw alone; more way-points";
            Err(Error::input(way_points.at(next), given, allowed))
        };
        if from.len() == 6 {
            let change = [3, 4, 5].map(|k| to[k] - from[k]);
            let largest = change.map(f64::abs).into_iter().fold(0.0, f64::max);
            if change.iter().filter(|&&change| change != 0.0).count() == 1 {
                // Yaw turns about the fixed z axis, pitch about the y axis after yaw, and roll about the x axis of the body.
                let axes = [
                    DVec3::X,
                    DQuat::from_rotation_x(-from[3]) * DVec3::Y,
                    rotations[next - 1].conjugate() * DVec3::Z,
                ];
                let parts = axes.into_iter().zip(change);
                let expected = parts.map(|(axis, change)| change * axis).sum();
                return Ok(turn_near(whole, expected));
            }
            if largest > PI - UNDETERMINED {
                let degrees = largest.to_degrees();
                return refuse(format!("several angles change, one by {degrees:.6}°"));
            }
        }
        let shortest = rotation_vector(whole);
        match shortest.length() > PI - UNDETERMINED {
            true => refuse("turned by 180°, in either direction".to_owned()),
            false => Ok(shortest),
        }
    };
    (1..rotations.len()).map(turn).collect()
}
