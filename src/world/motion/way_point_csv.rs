//! Way-points as CSV: a header, then a row of numbers a way-point, with the unit in each column's name.

use super::way_points::{Origin, WayPoints};
use crate::error::{Error, Result};
use crate::numbers_csv::{check_width, finite, line_of, rows_of, unreadable};
use crate::spelling::nearest_names;
use ndarray::Array2;
use std::io::Read;

/// The column of times.
const TIME: &str = "time_s";

/// A table whose columns are claimed one by one.
pub(super) struct Table {
    place: String,
    header_line: u64,
    names: Vec<String>,
    claimed: Vec<bool>,
    /// A row a way-point, a column a name.
    rows: Array2<f64>,
    lines: Vec<u64>,
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
        let mut reader = rows_of(source);
        let mut records = reader.records();
        let not_text = |error| unreadable(place, error, format!("text rows of {TIME} and numbers"));
        let Some(header) = records.next() else {
            let allowed = format!("a header with {TIME}, then way-points");
            return Err(Error::input(place, "an empty file", allowed));
        };
        let header = header.map_err(not_text)?;
        let names: Vec<String> = header.iter().map(str::to_owned).collect();
        let mut numbers = Vec::new();
        let mut lines = Vec::new();
        for record in records {
            let record = record.map_err(not_text)?;
            let line = line_of(&record);
            numbers.extend(row(place, line, &names, &record)?);
            lines.push(line);
        }
        let shape = (lines.len(), names.len());
        Ok(Self {
            place: place.to_owned(),
            header_line: line_of(&header),
            claimed: vec![false; names.len()],
            names,
            rows: Array2::from_shape_vec(shape, numbers).expect("every row has every column"),
            lines,
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
        for (index, column) in self.names.iter().enumerate() {
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

    /// An error in the header.
    pub fn refuse_header(&self, given: impl ToString, allowed: impl ToString) -> Error {
        Error::input(
            format!("{}, line {}", self.place, self.header_line),
            given,
            allowed,
        )
    }

    /// Way-points of the claimed columns in this order. The error is a missing column of times, a column that nobody claimed
    /// (`known` are the names there could be), or times that do not ascend.
    pub fn way_points<'n>(
        mut self,
        columns: &[Column],
        known: impl Iterator<Item = &'n str>,
    ) -> Result<WayPoints> {
        let Some(time) = self.names.iter().position(|name| name == TIME) else {
            return Err(self.refuse_header(format!("no column {TIME}"), "times in seconds"));
        };
        self.claimed[time] = true;
        if let Some(strange) = self.claimed.iter().position(|claimed| !claimed) {
            let name = &self.names[strange];
            let (given, offered) = (format!("column `{name}`"), nearest_names(name, known));
            return Err(self.refuse_header(given, offered));
        }
        let shape = (self.lines.len(), columns.len());
        let way_points = WayPoints {
            times: self.rows.column(time).to_vec(),
            values: Array2::from_shape_fn(shape, |(row, column)| {
                let Column { index, scale } = columns[column];
                scale * self.rows[(row, index)]
            }),
            origin: Origin::File {
                place: self.place,
                lines: self.lines,
            },
        };
        way_points.checked()
    }
}

/// The numbers of one row.
fn row(place: &str, line: u64, names: &[String], record: &csv::StringRecord) -> Result<Vec<f64>> {
    let place = format!("{place}, line {line}");
    check_width(&place, record, names.len())?;
    let number = |(field, name): (&str, &String)| finite(&place, name, field, "a finite number");
    record.iter().zip(names).map(number).collect()
}
