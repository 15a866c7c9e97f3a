//! A robot's positions over time.

use super::Interpolation;
use super::curve::{Curve, Moment};
use super::joint_limits::check_limits;
use super::way_point_csv::Table;
use super::way_points::{Origin, WayPoints};
use crate::error::{Error, Result};
use crate::world::Robot;
use ndarray::Array2;
use std::io::Read;

/// The positions of a robot through way-points in time; outside their range the ends hold.
///
/// Invariant: at no time does a joint that mimics none leave its limits of position and velocity by more than 1e-6 rad, m or those a
/// second. A joint that mimics goes where its `<mimic>` says; beyond its own limits it has a [note](Self::notes).
#[derive(Clone, Debug, PartialEq)]
pub struct JointTrajectory {
    times: Vec<f64>,
    /// One a position.
    curves: Vec<Curve>,
    notes: Vec<String>,
}

impl JointTrajectory {
    /// Through `positions` (a row a way-point, a column a position of the robot; rad and m) at `times` (seconds, strictly
    /// ascending).
    ///
    /// The limits are checked along the whole curve, in closed form: between way-points, too.
    ///
    /// # Errors
    /// The error names the joint, the time, the value and the limit; or the way-point that is not finite or not in time.
    pub fn new(
        robot: &Robot,
        times: Vec<f64>,
        positions: Array2<f64>,
        interpolation: Interpolation,
    ) -> Result<Self> {
        let way_points = WayPoints {
            times,
            values: positions,
            origin: Origin::Argument("joint trajectory"),
        };
        if way_points.values.ncols() != robot.n_positions() {
            return Err(Error::input(
                way_points.origin.place(),
                format!("{} positions a way-point", way_points.values.ncols()),
                format!("the {} of robot `{}`", robot.n_positions(), robot.name()),
            ));
        }
        Self::through(robot, &way_points.checked()?, interpolation)
    }

    /// From CSV: a column `time_s` and one for each of the robot's [coordinates](Robot::coordinates) that moves, in any order; a coordinate
    /// without a column stays at its [rest position](Robot::rest_positions). Angles are in radians under
    /// the coordinate's name (or with `_rad` behind it) and in degrees with `_deg`; lengths in metres (`_m`) and in millimetres with `_mm`.
    ///
    /// # Errors
    /// Errors begin with `place`, the file's name, and give the line.
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
            if table
                .claim(&joint.name, dimension.units(), is_name)?
                .is_some()
            {
                let given = format!("a column for `{}`, which mimics another joint", joint.name);
                return Err(table.refuse_header(given, "only the joint that it follows"));
            }
        }
        if columns.is_empty() && table.n_columns() < 2 {
            let names: Vec<String> = names().map(|name| format!("`{name}`")).collect();
            return Err(table.refuse_header("no column of a joint", names.join(", ")));
        }
        let mut way_points = table.way_points(&columns, names())?;
        let rest = robot.rest_positions();
        way_points.values =
            Array2::from_shape_fn((way_points.times.len(), rest.len()), |(row, position)| {
                match moved.iter().position(|&index| index == position) {
                    Some(column) => way_points.values[(row, column)],
                    None => rest[position],
                }
            });
        Self::through(robot, &way_points, interpolation)
    }

    fn through(
        robot: &Robot,
        way_points: &WayPoints,
        interpolation: Interpolation,
    ) -> Result<Self> {
        let times = &way_points.times;
        let mut curves = Vec::new();
        for (column, coordinate) in way_points
            .values
            .columns()
            .into_iter()
            .zip(robot.coordinates())
        {
            let curve =
                Curve::through(times, &column.to_vec(), interpolation).ok_or_else(|| {
                    Error::input(
                        way_points.origin.place(),
                        format!("`{}` with an endless velocity", coordinate.name),
                        "way-points farther apart in time",
                    )
                })?;
            curves.push(curve);
        }
        let notes = check_limits(robot, &curves, way_points)?;
        Ok(Self {
            times: times.clone(),
            curves,
            notes,
        })
    }

    /// Sentences on joints that mimic others beyond their own limits.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Seconds, one a way-point.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The time of the last way-point, seconds.
    pub fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// The robot's positions at a time in seconds, rad and m.
    pub fn positions_at(&self, time: f64) -> Vec<f64> {
        let mut positions = vec![0.0; self.curves.len()];
        self.positions_into(time, &mut positions);
        positions
    }

    /// The same into a slice, without allocation.
    ///
    /// # Panics
    /// If the slice has not one place a position.
    pub fn positions_into(&self, time: f64, positions: &mut [f64]) {
        assert_eq!(positions.len(), self.curves.len(), "one place a position");
        let at = Moment::of(time, &self.times);
        for (position, curve) in positions.iter_mut().zip(&self.curves) {
            *position = curve.value(at);
        }
    }

    /// Their velocities, rad/s and m/s; zero outside the way-points. Where a linear one jumps, the velocity after.
    pub fn velocities_at(&self, time: f64) -> Vec<f64> {
        let at = Moment::of(time, &self.times);
        self.curves.iter().map(|curve| curve.velocity(at)).collect()
    }
}
