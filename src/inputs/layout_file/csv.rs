//! Layouts as CSV files with the columns `x_mm, y_mm, z_mm, nx, ny, nz` in any order. The columns `radius_mm`, and `row` and `column` (of the sensor's image)
//! are optional. Without normals, they are taken from a mesh; without `z_mm` too, the skin is flat. Lengths may be in `_m`, `_cm` or `_mm`. Separators are commas, semicolons or tabs; lines that begin with `#` are comments.

use super::millimetres::{millimetres, scaled};
use super::{LayoutFile, LayoutOptions, Points};
use crate::error::{Error, Result};
use crate::numbers_csv::{check_width, finite, line_of, unreadable};
use csv::StringRecord;
use glam::DVec3;

const REQUIRED: [&str; 6] = ["x_mm", "y_mm", "z_mm", "nx", "ny", "nz"];
const OPTIONAL: [&str; 3] = ["radius_mm", "row", "column"];
/// Units of lengths, each with the exponent of ten that converts it to metres.
const UNITS: [(&str, i64); 3] = [("mm", -3), ("cm", -2), ("m", 0)];

/// Column of the file that the reader uses.
#[derive(Clone, Copy)]
struct Column {
    /// Index of the column in the file.
    index: usize,
    /// Exponent of ten that converts the numbers to metres; `None` for numbers without a unit.
    exponent: Option<i64>,
}

/// Columns of a file in the order of [`REQUIRED`] and [`OPTIONAL`].
type Columns = [Option<Column>; 9];

/// Reads a layout of taxels from the text of a CSV file.
pub(super) fn read(place: &str, text: &str, options: LayoutOptions) -> Result<LayoutFile> {
    let allowed = format!("a table with the columns {}", REQUIRED.join(", "));
    let text = text.trim_start_matches('\u{feff}');
    let is_header = |line: &&str| !line.trim().is_empty() && !line.starts_with('#');
    let first = text.lines().find(is_header).unwrap_or_default();
    let separator = [',', ';', '\t'].into_iter().find(|it| first.contains(*it));
    let separator = separator.unwrap_or(',');
    let reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .delimiter(separator as u8)
        .from_reader(text.as_bytes());
    let mut rows = reader.into_records();
    let header = match rows.next() {
        Some(header) => header.map_err(|e| unreadable(place, e, &allowed))?,
        None => return Err(Error::input(place, "an empty file", allowed)),
    };
    let header_place = format!("{place}, line {}", line_of(&header));
    let (columns, notes) = read_header(place, &header_place, &header, &allowed)?;
    let has_radii = columns[6].is_some();
    let [is_flat, has_normals] = [columns[2].is_none(), columns[3].is_some()];
    let (mut positions, mut normals, mut rows_of_taxels) = (Vec::new(), Vec::new(), Vec::new());
    let (mut radii, mut pixels) = (Vec::new(), Vec::new());
    for row in rows {
        let row = row.map_err(|e| unreadable(place, e, &allowed))?;
        let at = format!("{place}, line {}", line_of(&row));
        check_width(&at, &row, header.len())?;
        let field = |column: usize| -> (&str, Column) {
            let column = columns[column].expect("the column exists");
            (&row[column.index], column)
        };
        let value = |column: usize| -> Result<f64> {
            let (written, Column { index, exponent }) = field(column);
            // Where commas do not separate fields, they may be decimal commas.
            let decimal = match separator {
                ',' => written.to_owned(),
                _ => written.replace(',', "."),
            };
            let value = finite(&at, &header[index], &decimal, "a finite number");
            let value = value.map_err(|_| {
                let at = format!("{at}, column {}", &header[index]);
                Error::input(at, format!("`{written}`"), "a finite number")
            })?;
            let metres = exponent.and_then(|exponent| scaled(&decimal, exponent));
            Ok(metres.unwrap_or(value))
        };
        let height = if is_flat { 0.0 } else { value(2)? };
        positions.push(DVec3::new(value(0)?, value(1)?, height));
        if has_normals {
            normals.push(DVec3::new(value(3)?, value(4)?, value(5)?));
        }
        rows_of_taxels.push(line_of(&row) as usize - 1);
        if has_radii {
            let radius = value(6)?;
            if radius <= 0.0 {
                let (written, Column { index, .. }) = field(6);
                let at = format!("{at}, column {}", &header[index]);
                return Err(Error::input(at, written, "a positive number"));
            }
            radii.push(radius);
        }
        if columns[7].is_some() {
            let whole = |column: usize| {
                let (written, Column { index, .. }) = field(column);
                written.parse::<usize>().map_err(|_| {
                    let at = format!("{at}, column {}", &header[index]);
                    Error::input(at, format!("`{written}`"), "an integer from 0")
                })
            };
            pixels.push([whole(7)?, whole(8)?]);
        }
    }
    let points = Points {
        positions,
        rows: rows_of_taxels,
        is_flat,
    };
    let normals = has_normals.then_some(normals);
    let without_normals = ("no column nx", "the columns nx, ny and nz, or ");
    let mut read = LayoutFile::of_points(place, points, normals, options, without_normals)?;
    read.radii = (!radii.is_empty()).then_some(radii);
    read.notes.extend(notes);
    Ok(match pixels.is_empty() {
        true => read,
        false => read.with_pixels(pixels),
    })
}

/// Returns the columns of a header, and a note on columns that the reader does not use.
fn read_header(
    place: &str,
    header_place: &str,
    header: &StringRecord,
    allowed: &str,
) -> Result<(Columns, Vec<String>)> {
    if header.iter().all(|name| name.parse::<f64>().is_ok()) {
        return Err(Error::input(header_place, "a header of numbers", allowed));
    }
    let mut columns: Columns = [None; 9];
    let mut unused = Vec::new();
    for (index, name) in header.iter().enumerate() {
        let (known, exponent) = known_column(name);
        let names = REQUIRED.iter().chain(&OPTIONAL);
        let at = known.and_then(|known| names.clone().position(|name| **name == known));
        match at {
            Some(at) if columns[at].is_none() => columns[at] = Some(Column { index, exponent }),
            None if !is_near_column(name) => unused.push(format!("`{name}`")),
            _ => {
                let twice = if at.is_some() { " twice" } else { "" };
                let known = [&REQUIRED[..], &OPTIONAL].concat().join(", ");
                let known = format!("{known}; lengths in _mm, _cm or _m");
                return Err(Error::input(
                    header_place,
                    format!("column `{name}`{twice}"),
                    known,
                ));
            }
        }
    }
    // Positions alone may have normals from elsewhere, and those of a flat skin no height.
    let has_normals = columns[3..6].iter().any(Option::is_some);
    let n_required = match (has_normals, columns[2].is_some()) {
        (true, _) => 6,
        (false, true) => 3,
        (false, false) => 2,
    };
    if let Some(at) = (0..n_required).find(|at| columns[*at].is_none()) {
        let given = format!("no column {}", REQUIRED[at]);
        return Err(Error::input(header_place, given, allowed));
    }
    if columns[7].is_some() != columns[8].is_some() {
        let given = "one of row and column";
        return Err(Error::input(header_place, given, "both, or neither"));
    }
    let note = || format!("{place}: columns that are not used: {}", unused.join(", "));
    let notes = (!unused.is_empty()).then(note);
    Ok((columns, notes.into_iter().collect()))
}

/// Returns the name of a column as in [`REQUIRED`] or [`OPTIONAL`], and the exponent of its unit. Capital letters, blanks, and brackets around the unit have no
/// meaning: `X (mm)` is `x_mm`.
fn known_column(name: &str) -> (Option<String>, Option<i64>) {
    let name = name.to_lowercase();
    let words = name.split(|c: char| c.is_whitespace() || "_()[]{}".contains(c));
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    match words[..] {
        [length @ ("x" | "y" | "z" | "radius"), unit] => {
            let exponent = UNITS.iter().find(|(known, _)| *known == unit);
            let known = exponent.map(|_| format!("{length}_mm"));
            (known, exponent.map(|(_, exponent)| *exponent))
        }
        ["n" | "normal", axis @ ("x" | "y" | "z")] => (Some(format!("n{axis}")), None),
        [name] => (Some(name.to_owned()), None),
        _ => (None, None),
    }
}

/// Returns whether an unknown name may be a column of positions, normals, radii or pixels with another spelling; such a column is not passed over.
fn is_near_column(name: &str) -> bool {
    let name = name.to_lowercase();
    let letters = name.split(|c: char| !c.is_alphabetic()).next();
    let stems = [
        "x", "y", "z", "n", "nx", "ny", "nz", "normal", "normals", "radius", "r", "row", "col",
        "column",
    ];
    letters.is_some_and(|letters| stems.contains(&letters))
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
