//! Waypoints in CSV files: a header and one row of numbers per waypoint. Column names contain the units.

use super::way_points::{Origin, WayPoints};
use crate::error::{Error, Result};
use crate::text::numbers_csv::NumberTable;
use crate::text::spelling::nearest_names;
use ndarray::Array2;
use std::io::Read;

/// Name of the column with the waypoints' times.
const TIME: &str = "time_s";

/// Table of waypoints. A trajectory marks the columns that it uses one by one, so that unused columns are detected.
pub(super) struct Table {
    /// Numbers of the file, one row per waypoint.
    numbers: NumberTable,
    claimed: Vec<bool>,
}

/// Column of a table that a trajectory uses, with the factor that converts its numbers to SI units.
#[derive(Clone, Copy)]
pub(super) struct Column {
    index: usize,
    scale: f64,
}

/// Suffixes of column names, and the size of each unit in SI units.
pub(super) type Units = &'static [(&'static str, f64)];

impl Table {
    /// Reads the whole table of waypoints. Errors begin with `place`, the file's name, and contain the line number.
    pub fn read(place: &str, source: impl Read) -> Result<Self> {
        let allowed = format!("a header with {TIME}, then way-points");
        let numbers = NumberTable::read(place, source, &allowed)?;
        Ok(Self {
            claimed: vec![false; numbers.names.len()],
            numbers,
        })
    }

    /// Marks the column `name`, optionally with the suffix of a unit, as used. Names in `reserved` are not split into name and unit. Returns an error if two
    /// columns match; `None` if no column matches.
    pub fn claim(
        &mut self,
        name: &str,
        units: Units,
        reserved: impl Fn(&str) -> bool,
    ) -> Result<Option<Column>> {
        let mut found = None;
        for (index, column) in self.numbers.names.iter().enumerate() {
            let unit = column
                .strip_prefix(name)
                .and_then(|rest| units.iter().find(|(suffix, _)| *suffix == rest));
            let Some(&(suffix, scale)) = unit else {
                continue;
            };
            if !suffix.is_empty() && reserved(column) {
                continue;
            }
            if found.is_some() {
                let given = format!("a second column for {name}: `{column}`");
                return Err(self.refuse_header(given, "one column each"));
            }
            self.claimed[index] = true;
            found = Some(Column { index, scale });
        }
        Ok(found)
    }

    /// Returns the number of columns of the file, including times.
    pub fn n_columns(&self) -> usize {
        self.claimed.len()
    }

    /// Creates an error about the header of the table.
    pub fn refuse_header(&self, given: impl ToString, allowed: impl ToString) -> Error {
        self.numbers.refuse_header(given, allowed)
    }

    /// Returns the waypoints with the claimed columns in this order. Returns an error if the column of times is missing, a column was not claimed (`known` are
    /// the possible names), or times do not ascend.
    pub fn way_points<'n>(
        mut self,
        columns: &[Column],
        known: impl Iterator<Item = &'n str>,
    ) -> Result<WayPoints> {
        let Some(time) = self.numbers.position(TIME) else {
            return Err(self.refuse_header(format!("no column {TIME}"), "times in seconds"));
        };
        self.claimed[time] = true;
        if let Some(strange) = self.claimed.iter().position(|claimed| !claimed) {
            let name = &self.numbers.names[strange];
            let (given, offered) = (format!("column `{name}`"), nearest_names(name, known));
            return Err(self.refuse_header(given, offered));
        }
        let NumberTable {
            place,
            columns: numbers,
            lines,
            ..
        } = self.numbers;
        let way_points = WayPoints {
            times: numbers[time].clone(),
            values: Array2::from_shape_fn((lines.len(), columns.len()), |(row, column)| {
                let Column { index, scale } = columns[column];
                scale * numbers[index][row]
            }),
            origin: Origin::File { place, lines },
        };
        way_points.checked()
    }
}
