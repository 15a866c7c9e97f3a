//! Way-points as CSV: a header, then a row of numbers a way-point, with the unit in each column's name.

use super::way_points::{Origin, WayPoints};
use crate::error::{Error, Result};
use crate::text::numbers_csv::NumberTable;
use crate::text::spelling::nearest_names;
use ndarray::Array2;
use std::io::Read;

/// The column of times.
const TIME: &str = "time_s";

/// A table whose columns are claimed one by one.
pub(super) struct Table {
    /// A row a way-point.
    numbers: NumberTable,
    claimed: Vec<bool>,
}

/// A column that was claimed, and what its numbers are multiplied by to be SI.
#[derive(Clone, Copy)]
pub(super) struct Column {
    index: usize,
    scale: f64,
}

/// What the name of a column may end in, and the size of that unit in SI; see [`Dimension::units`](crate::world::Dimension::units).
pub(super) type Units = &'static [(&'static str, f64)];

impl Table {
    /// Reads all; errors begin with `place`, the file's name, and give the line.
    pub fn read(place: &str, source: impl Read) -> Result<Self> {
        let allowed = format!("a header with {TIME}, then way-points");
        let numbers = NumberTable::read(place, source, &allowed)?;
        Ok(Self {
            claimed: vec![false; numbers.names.len()],
            numbers,
        })
    }

    /// The column called `name`, or with one of the units behind it. `reserved` are names that are never a name and a unit. The
    /// error is two such columns.
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

    /// Columns of the file, the one of times included.
    pub fn n_columns(&self) -> usize {
        self.claimed.len()
    }

    /// An error in the header.
    pub fn refuse_header(&self, given: impl ToString, allowed: impl ToString) -> Error {
        self.numbers.refuse_header(given, allowed)
    }

    /// Way-points of the claimed columns in this order. The error is a missing column of times, a column that nobody claimed
    /// (`known` are the names there could be), or times that do not ascend.
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
