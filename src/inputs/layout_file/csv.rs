//! Layouts as CSV files with the columns `x_mm, y_mm, z_mm, nx, ny, nz` in any order. The columns `radius_mm`, and `row` and `column` (of the sensor's image)
//! are optional.

use super::LayoutFile;
use crate::error::{Error, Result};
use crate::files::WholeFile;
use crate::numbers_csv::{check_width, finite, line_of, rows_of, unreadable};
use glam::DVec3;
use std::io::Write;
use std::path::Path;

const REQUIRED: [&str; 6] = ["x_mm", "y_mm", "z_mm", "nx", "ny", "nz"];
const OPTIONAL: [&str; 3] = ["radius_mm", "row", "column"];
const MM: f64 = 1e-3;

/// Reads a layout of taxels from the text of a CSV file.
pub(super) fn read(place: &str, text: &str) -> Result<LayoutFile> {
    let allowed = format!("a table with the columns {}", REQUIRED.join(", "));
    let mut rows = rows_of(text.trim_start_matches('\u{feff}').as_bytes()).into_records();
    let header = match rows.next() {
        Some(header) => header.map_err(|e| unreadable(place, e, &allowed))?,
        None => return Err(Error::input(place, "an empty file", allowed)),
    };
    let position = |name: &str| header.iter().position(|column| column == name);
    for (index, name) in header.iter().enumerate() {
        let is_known = REQUIRED.contains(&name) || OPTIONAL.contains(&name);
        if !is_known || position(name) != Some(index) {
            let given = format!("column `{name}`{}", if is_known { " twice" } else { "" });
            let known = [&REQUIRED[..], &OPTIONAL].concat().join(", ");
            return Err(Error::input(place, given, known));
        }
    }
    if let Some(missing) = REQUIRED.iter().find(|name| position(name).is_none()) {
        return Err(Error::input(place, format!("no column {missing}"), allowed));
    }
    if position("row").is_some() != position("column").is_some() {
        return Err(Error::input(
            place,
            "one of row and column",
            "both, or neither",
        ));
    }
    let (mut taxels, mut numbers) = (Vec::new(), Vec::new());
    let (mut radii, mut pixels) = (Vec::new(), Vec::new());
    for row in rows {
        let row = row.map_err(|e| unreadable(place, e, &allowed))?;
        let at = format!("{place}, line {}", line_of(&row));
        check_width(&at, &row, header.len())?;
        let value = |name: &str| {
            let index = position(name).expect("the column exists");
            finite(&at, name, &row[index], "a finite number")
        };
        let vector = |names: &[&str]| -> Result<DVec3> {
            Ok(DVec3::new(
                value(names[0])?,
                value(names[1])?,
                value(names[2])?,
            ))
        };
        taxels.push((vector(&REQUIRED[..3])? * MM, vector(&REQUIRED[3..])?));
        numbers.push(line_of(&row) as usize - 1);
        if position("radius_mm").is_some() {
            let radius = value("radius_mm")?;
            if radius <= 0.0 {
                let at = format!("{at}, column radius_mm");
                return Err(Error::input(at, radius, "a positive number"));
            }
            radii.push(radius * MM);
        }
        if let Some(index) = position("row") {
            let whole = |name: &str, index: usize| {
                row[index].parse::<usize>().map_err(|_| {
                    let at = format!("{at}, column {name}");
                    Error::input(at, format!("`{}`", &row[index]), "an integer from 0")
                })
            };
            let column = position("column").expect("the column exists");
            pixels.push([whole("row", index)?, whole("column", column)?]);
        }
    }
    let read = LayoutFile::new(place, taxels, &numbers)?;
    Ok(LayoutFile {
        radii: (!radii.is_empty()).then_some(radii),
        pixels: (!pixels.is_empty()).then_some(pixels),
        ..read
    })
}

impl LayoutFile {
    /// Writes the layout as a CSV file, from which [`read`](Self::read) returns the same layout.
    ///
    /// # Errors
    /// If the file cannot be written, or if the running command reads it.
    pub fn write_csv(&self, path: &Path) -> Result<()> {
        let mut header = REQUIRED.join(",");
        if self.radii.is_some() {
            header += ",radius_mm";
        }
        if self.pixels.is_some() {
            header += ",row,column";
        }
        let mut text = header + "\n";
        let taxels = self.layout.centers().iter().zip(self.layout.axes());
        for (taxel, (center, axis)) in taxels.enumerate() {
            let [x, y, z] = center.to_array().map(in_mm);
            text += &format!("{x},{y},{z},{},{},{}", axis.x, axis.y, axis.z);
            if let Some(radii) = &self.radii {
                text += &format!(",{}", in_mm(radii[taxel]));
            }
            if let Some(pixels) = &self.pixels {
                text += &format!(",{},{}", pixels[taxel][0], pixels[taxel][1]);
            }
            text += "\n";
        }
        let mut file = WholeFile::create(path)?;
        file.write(|file| file.write_all(text.as_bytes()))?;
        file.commit()
    }
}

/// Converts metres to millimetres. The conversion back gives the same number, and the result has as few digits as possible.
fn in_mm(metres: f64) -> f64 {
    let mm = metres / MM;
    let candidates = [(mm * 1e9).round() / 1e9, mm, mm.next_up(), mm.next_down()];
    let exact = candidates.into_iter().find(|mm| mm * MM == metres);
    exact.unwrap_or(mm)
}
