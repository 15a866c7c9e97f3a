//! Waypoints before interpolation: rows of numbers at ascending times, with their source (argument or file) for error messages.

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
                return Err(Error::input(
                    self.at(index),
                    format!("time {time} s after {before} s"),
                    "strictly ascending times",
                ));
            }
        }
        Ok(self)
    }

    /// Returns the location of one waypoint in its file or argument, for error messages.
    pub fn at(&self, index: usize) -> String {
        format!("{}, {}", self.origin.place(), self.origin.way_point(index))
    }
}
