//! Trajectory of a robot's joint positions.

use super::Interpolation;
use super::curve::{Curve, Moment};
use super::joint_limits::check_limits;
use super::way_point_csv::Table;
use super::way_points::WayPoints;
use crate::error::{Error, Result};
use crate::world::{Coordinate, Robot};
use ndarray::Array2;
use std::io::Read;

/// Joint positions of a robot over time, interpolated through waypoints; constant before the first and after the last waypoint.
///
/// Invariant: a joint that mimics no other joint never violates its limits of position and velocity by more than 1e-6 (rad or m, rad/s or m/s). A mimicking
/// joint follows its `<mimic>`; if it leaves its own limits, the trajectory has a note.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTrajectory {
    times: Vec<f64>,
    /// Curves of the joint positions, one per position of the robot.
    curves: Vec<Curve>,
    notes: Vec<String>,
}

impl JointTrajectory {
    /// Creates the trajectory through joint positions (n_way_points × n_positions, rad and m) at `times` (seconds, strictly ascending).
    ///
    /// Limits are checked along the whole curve in closed form, including between waypoints.
    ///
    /// # Errors
    /// If a joint leaves its limits; the error contains joint, time, value and limit. Also if a waypoint is not finite or out of order.
    pub fn new(
        robot: &Robot,
        times: Vec<f64>,
        positions: Array2<f64>,
        interpolation: Interpolation,
    ) -> Result<Self> {
        const PLACE: &str = "joint trajectory";
        let (n, n_robot) = (positions.ncols(), robot.n_positions());
        if n != n_robot {
            let given = format!("{n} positions a way-point");
            let allowed = format!("the {n_robot} of robot `{}`", robot.name());
            return Err(Error::input(PLACE, given, allowed));
        }
        let way_points = WayPoints::listed(PLACE, times, positions)?;
        Self::through(robot, way_points, interpolation)
    }

    /// Reads a trajectory from CSV: a column `time_s` and one column for each moving coordinate of the robot, in any order. A coordinate without a column
    /// stays at its default position. A column of angles has the coordinate's name, optionally with `_rad`, for radians, or `_deg` for degrees. A column of
    /// lengths has `_m` for metres or `_mm` for millimetres.
    ///
    /// # Errors
    /// If the table is invalid. The message begins with `place`, the file's name, and contains the line.
    pub fn read_csv(
        robot: &Robot,
        place: &str,
        source: impl Read,
        interpolation: Interpolation,
    ) -> Result<Self> {
        let mut table = Table::read(place, source)?;
        let names = || robot.coordinates().iter().map(|c| c.name.as_str());
        let is_name = |column: &str| names().any(|name| name == column);
        let (mut columns, mut moved) = (Vec::new(), Vec::new());
        for (index, coordinate) in robot.coordinates().iter().enumerate() {
            let units = coordinate.dimension.units();
            if let Some(column) = table.claim(&coordinate.name, units, is_name)? {
                columns.push(column);
                moved.push(index);
            }
        }
        for joint in robot.joints().iter().filter(|joint| joint.mimic.is_some()) {
            let (_, dimension) = joint.kind.coordinates()[0];
            let column = table.claim(&joint.name, dimension.units(), is_name)?;
            if column.is_some() {
                let given = format!("a column for `{}`, which mimics another joint", joint.name);
                return Err(table.refuse_header(given, "only the joint that it follows"));
            }
        }
        if columns.is_empty() && table.n_columns() < 2 {
            let names: Vec<String> = names().map(|name| format!("`{name}`")).collect();
            return Err(table.refuse_header("no column of a joint", names.join(", ")));
        }
        let mut way_points = table.way_points(&columns, names())?;
        let shape = (way_points.times.len(), robot.n_positions());
        let mut values = Array2::zeros(shape);
        values += &ndarray::aview1(&robot.rest_positions());
        for (column, &position) in way_points.values.columns().into_iter().zip(&moved) {
            values.column_mut(position).assign(&column);
        }
        way_points.values = values;
        Self::through(robot, way_points, interpolation)
    }

    fn through(robot: &Robot, way_points: WayPoints, interpolation: Interpolation) -> Result<Self> {
        let coordinates = robot.coordinates().iter().enumerate();
        let curve = |(column, coordinate): (usize, &Coordinate)| {
            let name = format!("`{}` with ", coordinate.name);
            way_points.curve(column, &name, interpolation)
        };
        let curves = coordinates.map(curve).collect::<Result<Vec<_>>>()?;
        let notes = check_limits(robot, &curves, &way_points)?;
        Ok(Self {
            times: way_points.times,
            curves,
            notes,
        })
    }

    /// Returns notes on mimicking joints that leave their own limits.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the times of the waypoints, seconds.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Returns the time of the last waypoint, seconds.
    pub fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Returns the robot's joint positions at a time in seconds, rad and m.
    pub fn positions_at(&self, time: f64) -> Vec<f64> {
        let mut positions = vec![0.0; self.curves.len()];
        self.positions_into(time, &mut positions);
        positions
    }

    /// Writes the robot's joint positions at a time in seconds into a slice, rad and m, without allocation.
    ///
    /// # Panics
    /// If the length of the slice differs from the number of positions.
    pub fn positions_into(&self, time: f64, positions: &mut [f64]) {
        assert_eq!(positions.len(), self.curves.len(), "one place a position");
        let at = Moment::new(time, &self.times);
        for (position, curve) in positions.iter_mut().zip(&self.curves) {
            *position = curve.value(at);
        }
    }

    /// Returns the joint velocities, rad/s and m/s; zero before the first and after the last waypoint. Where the velocity jumps, the velocity after the jump
    /// is returned.
    pub fn velocities_at(&self, time: f64) -> Vec<f64> {
        let at = Moment::new(time, &self.times);
        self.curves.iter().map(|curve| curve.velocity(at)).collect()
    }
}
