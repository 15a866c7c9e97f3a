//! Sphere unions in CSV files with the columns x, y, z, r in metres.

use super::{Sphere, SphereUnion};
use crate::error::{Error, Result};
use crate::mesh::{LengthUnit, SizeLimits};
use crate::text::numbers_csv::{check_width, finite, line_of, rows_of, unreadable};
use glam::DVec3;
use std::io::{self, Read, Write};

/// Names of the columns: centre coordinates and radius, in this order.
const COLUMNS: [&str; 4] = ["x", "y", "z", "r"];

/// Reads spheres from CSV with the columns `x,y,z,r`. Without a unit the numbers are metres, and the size must be within `sizes`. With a header, columns may have any order and further columns are ignored; without a header
/// there must be exactly four columns.
///
/// # Errors
/// If the file is invalid, or the size is outside the limits; errors begin with `place`, the name of the file, and contain line and column.
pub fn read_spheres(
    place: &str,
    unit: Option<LengthUnit>,
    sizes: &SizeLimits,
    source: impl Read,
) -> Result<SphereUnion> {
    let mut reader = rows_of(source);
    let mut layout = None;
    let mut spheres = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| unreadable(place, e, "text rows of x,y,z,r in metres"))?;
        let row = Row {
            place: format!("{place}, line {}", line_of(&record)),
            record: &record,
        };
        match &layout {
            None if row.is_header() => layout = Some(row.header()?),
            None => {
                spheres.push(row.sphere(&[0, 1, 2, 3], 4)?);
                layout = Some(([0, 1, 2, 3], 4));
            }
            Some((columns, n)) => spheres.push(row.sphere(columns, *n)?),
        }
    }
    if spheres.is_empty() {
        let allowed = "rows of x,y,z,r in metres";
        return Err(Error::input(place, "no spheres", allowed));
    }
    let union = SphereUnion::new(spheres)?;
    let Some(unit) = unit else {
        sizes.check(place, union.bounds().size())?;
        return Ok(union);
    };
    let metres = unit.metres();
    let scaled = |sphere: &Sphere| Sphere {
        center: metres * sphere.center,
        radius: metres * sphere.radius,
    };
    let spheres = SphereUnion::new(union.spheres().iter().map(scaled).collect());
    spheres.map_err(|error| error.under(format!("{place}: ")))
}

/// Writes a header and one row per sphere with 17 significant digits; [`read_spheres`] restores equal bits.
///
/// # Errors
/// If writing to the sink fails.
pub fn write_spheres(union: &SphereUnion, mut sink: impl Write) -> io::Result<()> {
    writeln!(sink, "{}", COLUMNS.join(","))?;
    for Sphere { center, radius } in union.spheres() {
        let DVec3 { x, y, z } = center;
        writeln!(sink, "{x:.16e},{y:.16e},{z:.16e},{radius:.16e}")?;
    }
    Ok(())
}

struct Row<'a> {
    place: String,
    record: &'a csv::StringRecord,
}

impl Row<'_> {
    /// Returns whether the first row contains no number and is therefore a header.
    fn is_header(&self) -> bool {
        let mut fields = self.record.iter();
        fields.all(|field| field.parse::<f64>().is_err())
    }

    /// Returns the indices of the columns x, y, z, r, and the total number of columns.
    fn header(&self) -> Result<([usize; 4], usize)> {
        let mut columns = [0; 4];
        for (column, name) in columns.iter_mut().zip(COLUMNS) {
            let mut fields = self.record.iter();
            let found = fields.position(|field| field.eq_ignore_ascii_case(name));
            *column = found.ok_or_else(|| {
                let header = self.record.iter().collect::<Vec<_>>().join(",");
                let given = format!("header `{header}` without a column {name}");
                Error::input(&self.place, given, "columns x,y,z,r in metres")
            })?;
        }
        Ok((columns, self.record.len()))
    }

    fn sphere(&self, columns: &[usize; 4], n_columns: usize) -> Result<Sphere> {
        check_width(&self.place, self.record, n_columns)?;
        let [x, y, z, radius] = [0, 1, 2, 3].map(|k| self.number(columns[k], COLUMNS[k]));
        let (center, radius) = (DVec3::new(x?, y?, z?), radius?);
        if radius <= 0.0 {
            let place = format!("{}, column r", self.place);
            return Err(Error::input(place, radius, "a positive radius in metres"));
        }
        Ok(Sphere { center, radius })
    }

    fn number(&self, column: usize, name: &str) -> Result<f64> {
        let allowed = "a finite number of metres";
        finite(&self.place, name, &self.record[column], allowed)
    }
}
