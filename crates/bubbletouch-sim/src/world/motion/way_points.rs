//! Waypoints before interpolation: rows of numbers at ascending times, with their source (argument or file) for error messages.

use super::curve::{Curve, Interpolation};
use crate::error::{Error, Result};
use ndarray::Array2;

/// Waypoints: rows of numbers at given times. After a call of `checked`, there is at least one row, all numbers are finite, and the times ascend.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WayPoints {
    /// Times of the waypoints, seconds.
    pub times: Vec<f64>,
    /// Values of all coordinates, one row per waypoint.
    pub values: Array2<f64>,
    /// Source of the waypoints (argument or file), for error messages.
    pub origin: Origin,
}

/// Source of waypoints (argument or file), for error messages.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Origin {
    /// Argument of a function, given by its name.
    Argument(&'static str),
    /// File, and the line number of each waypoint.
    File { place: String, lines: Vec<u64> },
}

impl Origin {
    /// Returns the name of the file or argument that contains the waypoints.
    pub fn place(&self) -> &str {
        match self {
            Self::Argument(name) => name,
            Self::File { place, .. } => place,
        }
    }

    /// Returns the name of one waypoint in error messages, by its index.
    pub fn way_point(&self, index: usize) -> String {
        match self {
            Self::Argument(_) => format!("way-point {}", index + 1),
            Self::File { lines, .. } => format!("line {}", lines[index]),
        }
    }
}

impl WayPoints {
    /// Returns the waypoints that an argument with this name lists, one row per waypoint; an error if they are invalid.
    pub fn listed(
        argument: &'static str,
        times: Vec<f64>,
        values: impl Into<Array2<f64>>,
    ) -> Result<Self> {
        let way_points = Self {
            times,
            values: values.into(),
            origin: Origin::Argument(argument),
        };
        way_points.checked()
    }

    /// Returns the curve of a coordinate through all waypoints. `name` is the beginning of the message of an error.
    pub fn curve(&self, column: usize, name: &str, interpolation: Interpolation) -> Result<Curve> {
        let values = self.values.column(column).to_vec();
        let curve = Curve::through(&self.times, &values, interpolation);
        curve.ok_or_else(|| self.too_fast(name))
    }

    /// Returns the error of waypoints with an infinite velocity between them.
    pub fn too_fast(&self, name: &str) -> Error {
        let allowed = "way-points farther apart in time";
        Error::input(
            self.origin.place(),
            format!("{name}an endless velocity"),
            allowed,
        )
    }

    /// Returns the waypoints if they are valid, or an error that names the first invalid waypoint.
    pub fn checked(self) -> Result<Self> {
        let n = self.times.len();
        if n == 0 {
            return Err(Error::input(
                self.origin.place(),
                "no way-points",
                "at least one",
            ));
        }
        if self.values.nrows() != n {
            let given = format!("{n} times for {} way-points", self.values.nrows());
            return Err(Error::input(self.origin.place(), given, "a time each"));
        }
        for (index, row) in self.values.rows().into_iter().enumerate() {
            let numbers = std::iter::once(self.times[index]).chain(row.iter().copied());
            if let Some(wrong) = numbers.into_iter().find(|number| !number.is_finite()) {
                return Err(Error::input(self.at(index), wrong, "finite numbers"));
            }
        }
        for index in 1..n {
            let (before, time) = (self.times[index - 1], self.times[index]);
            if time <= before {
                let place = self.at(index);
                let given = format!("time {time} s after {before} s");
                let allowed = "strictly ascending times";
                return Err(Error::input(place, given, allowed));
            }
        }
        Ok(self)
    }

    /// Returns the location of one waypoint in its file or argument, for error messages.
    pub fn at(&self, index: usize) -> String {
        format!("{}, {}", self.origin.place(), self.origin.way_point(index))
    }
}
