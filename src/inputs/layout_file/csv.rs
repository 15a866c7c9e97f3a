//! Layouts as CSV files with the columns `x_mm, y_mm, z_mm, nx, ny, nz` in any order. The columns `radius_mm`, and `row` and `column` (of the sensor's image)
//! are optional.

use super::LayoutFile;
use super::millimetres::{metres, millimetres};
use crate::error::{Error, Result};
use crate::numbers_csv::{check_width, finite, line_of, rows_of, unreadable};
use glam::DVec3;

const REQUIRED: [&str; 6] = ["x_mm", "y_mm", "z_mm", "nx", "ny", "nz"];
const OPTIONAL: [&str; 3] = ["radius_mm", "row", "column"];

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
        let value = |name: &str| -> Result<f64> {
            let index = position(name).expect("the column exists");
            let value = finite(&at, name, &row[index], "a finite number")?;
            Ok(match name.ends_with("_mm") {
                true => metres(&row[index]).unwrap_or(value),
                false => value,
            })
        };
        let vector = |names: &[&str]| -> Result<DVec3> {
            Ok(DVec3::new(
                value(names[0])?,
                value(names[1])?,
                value(names[2])?,
            ))
        };
        taxels.push((vector(&REQUIRED[..3])?, vector(&REQUIRED[3..])?));
        numbers.push(line_of(&row) as usize - 1);
        if position("radius_mm").is_some() {
            let radius = value("radius_mm")?;
            if radius <= 0.0 {
                let at = format!("{at}, column radius_mm");
                let index = position("radius_mm").expect("the column exists");
                return Err(Error::input(at, &row[index], "a positive number"));
            }
            radii.push(radius);
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
    let read = LayoutFile {
        radii: (!radii.is_empty()).then_some(radii),
        ..LayoutFile::new(place, taxels, &numbers)?
    };
    Ok(match pixels.is_empty() {
        true => read,
        false => read.with_pixels(pixels),
    })
}

/// Returns the layout as the text of a CSV file.
pub(super) fn written(file: &LayoutFile) -> String {
    let image = file.image();
    let mut header = REQUIRED.join(",");
    if file.radii.is_some() {
        header += ",radius_mm";
    }
    if image.is_some() {
        header += ",row,column";
    }
    let mut text = header + "\n";
    let taxels = file.layout.centers().iter().zip(file.layout.axes());
    for (taxel, (center, axis)) in taxels.enumerate() {
        let [x, y, z] = center.to_array().map(millimetres);
        text += &format!("{x},{y},{z},{},{},{}", axis.x, axis.y, axis.z);
        if let Some(radii) = &file.radii {
            text += &format!(",{}", millimetres(radii[taxel]));
        }
        if let Some(pixels) = &image {
            text += &format!(",{},{}", pixels[taxel][0], pixels[taxel][1]);
        }
        text += "\n";
    }
    text
}
