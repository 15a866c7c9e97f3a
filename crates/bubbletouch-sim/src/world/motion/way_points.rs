//! Way-points as they were given: rows of numbers at ascending times, each with its place for errors.

use crate::error::{Error, Result};
use ndarray::Array2;

/// Rows of numbers in time. Invariant after [`checked`](Self::checked): at least one row, all finite, times ascending.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WayPoints {
    /// Seconds.
    pub times: Vec<f64>,
    /// A row a way-point.
    pub values: Array2<f64>,
    /// Where they are from.
    pub origin: Origin,
}

/// Where way-points are from.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Origin {
    /// An argument, called this.
    Argument(&'static str),
    /// A file and the line of each way-point.
    File { place: String, lines: Vec<u64> },
}

impl Origin {
    /// The file's or argument's name.
    pub fn place(&self) -> &str {
        match self {
            Self::Argument(name) => name,
            Self::File { place, .. } => place,
        }
    }

    /// The name of one way-point, by its index.
    pub fn way_point(&self, index: usize) -> String {
        match self {
            Self::Argument(_) => format!("way-point {}", index + 1),
            Self::File { lines, .. } => format!("line {}", lines[index]),
        }
    }
}

impl WayPoints {
    /// The same, or an error that names the first bad way-point.
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

    /// The place of one way-point.
    pub fn at(&self, index: usize) -> String {
        format!("{}, {}", self.origin.place(), self.origin.way_point(index))
    }
}
