//! Taxel positions of PaXini's tactile sensors as JSON, mm: `{"units": "mm", "taxels_mm": [[x, y, z], …]}`, or a list of positions. With `rotation`, a list of
//! rotation matrices by columns, the third column is the normal of a taxel. The normals may also be a list `normals`. Without both, the normals are taken from a
//! mesh. The member `units` of `taxels` and `points` may be mm, cm or m; without it, the options may contain the unit. A position may also be an object with the members
//! `x`, `y` and `z`, or `x_mm`, `y_mm` and `z_mm`, and optionally its normal `nx`, `ny` and `nz`.

use super::millimetres::scaled;
use super::{LayoutFile, LayoutOptions, Points};
use crate::error::{Error, Result};
use crate::geometry::written_rotation_matrix;
use glam::{DMat3, DVec3};
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Members of a point that are its normal.
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
const ALLOWED: &str = "points [x, y, z] in mm: a list, or the member taxels_mm, taxels or points";

/// Reads a layout of taxels from the text of a PaXini JSON file. If the file has no normals, they are computed from the mesh.
pub(super) fn read(place: &str, text: &str, options: LayoutOptions) -> Result<LayoutFile> {
    let text = text.trim_start_matches('\u{feff}');
    // Python writes NaN and Infinity, which are not JSON. As texts, they are refused with their row.
    let json: Value = serde_json::from_str(text)
        .or_else(|error| serde_json::from_str(&quoted_not_finite(text)).map_err(|_| error))
        .map_err(|e| Error::input(place, e, ALLOWED))?;
    let units = json.get("units").or_else(|| json.get("unit"));
    let exponent = match units {
        // The positions are numbers of the unit of the options.
        None if options.unit.is_some() => Some(0),
        None => Some(-3),
        Some(units) => exponent_of(&units.as_str().unwrap_or_default().to_lowercase()),
    };
    let is_millimetres = json.get("taxels_mm").is_some();
    let mut states_unit = units.is_some() || is_millimetres;
    let Some(exponent) =
        exponent.filter(|&exponent| exponent == -3 || !is_millimetres || units.is_none())
    else {
        let given = format!("units {}", units.unwrap_or(&Value::Null));
        let allowed = "\"mm\"; \"cm\" or \"m\" for the members taxels and points";
        return Err(Error::input(place, given, allowed));
    };
    let members = ["taxels_mm", "taxels", "points"];
    let points = members.iter().find_map(|name| json.get(name));
    let points = points.unwrap_or(&json).as_array();
    let points = points.ok_or_else(|| Error::input(place, "no list of points", ALLOWED))?;
    // Members of points that are no positions, such as numbers of taxels.
    let mut unused = BTreeSet::new();
    let mut normals_of_points = Vec::new();
    let row_numbers = |what: &str, row: usize, value: &Value, allowed: &str| {
        // A vector is a list, or an object with the members x, y and z.
        let numbers = match value {
            Value::Object(members) if members.len() == 3 => {
                let numbers = ["x", "y", "z"].map(|axis| members.get(axis)?.as_f64());
                numbers.into_iter().collect::<Option<Vec<f64>>>()
            }
            _ => value.as_array().and_then(|numbers| {
                let numbers = numbers.iter().map(Value::as_f64);
                numbers.collect::<Option<Vec<f64>>>()
            }),
        };
        numbers.ok_or_else(|| {
            let place = format!("{place}, {what}row {}", row + 1);
            Error::input(place, format!("`{value}`"), allowed)
        })
    };
    let mut point = |(row, point): (usize, &Value)| {
        const ALLOWED: &str = "three numbers: x, y, z";
        // Members may name their unit, such as x_mm, and stand beside others, such as the number of the taxel.
        let (mut exponent, mut place_of_taxel) = (exponent, None);
        if let Value::Object(members) = point {
            let units = ["mm", "cm", "m"]
                .map(|unit| (format!("_{unit}"), exponent_of(unit).unwrap_or(exponent)));
            for (ending, of_unit) in units.into_iter().chain([(String::new(), exponent)]) {
                let names = ["x", "y", "z"].map(|axis| format!("{axis}{ending}"));
                if names.iter().all(|name| members.contains_key(name)) {
                    exponent = of_unit;
                    states_unit |= !ending.is_empty();
                    let normal = NORMAL.map(|name| members.get(name).and_then(Value::as_f64));
                    let has_normal = normal.iter().all(Option::is_some);
                    normals_of_points.extend(
                        has_normal.then(|| DVec3::from(normal.map(Option::unwrap_or_default))),
                    );
                    let is_used = |key: &&String| {
                        names.contains(key) || has_normal && NORMAL.contains(&key.as_str())
                    };
                    unused.extend(members.keys().filter(|key| !is_used(key)).cloned());
                    place_of_taxel = Some(Value::Array(
                        names.map(|name| members[&name].clone()).to_vec(),
                    ));
                    break;
                }
            }
        }
        let point = place_of_taxel.as_ref().unwrap_or(point);
        match row_numbers("", row, point, ALLOWED)?[..] {
            [x, y, z] => {
                // The decimal number in the file, not its binary rounding, is converted to metres.
                let exact = |number: f64| scaled(&number.to_string(), exponent).unwrap_or(number);
                Ok(DVec3::new(exact(x), exact(y), exact(z)))
            }
            _ => {
                let place = format!("{place}, row {}", row + 1);
                Err(Error::input(place, format!("`{point}`"), ALLOWED))
            }
        }
    };
    let points = points.iter().enumerate().map(&mut point);
    let points = points.collect::<Result<Vec<_>>>()?;
    if options.unit.is_some() && states_unit {
        let allowed = "none: the file states its unit";
        return Err(Error::input(place, "a unit", allowed));
    }
    if points.is_empty() {
        return Err(Error::input(place, "no taxel", "at least one taxel"));
    }
    let listed_normals = || {
        let Some(normals) = json.get("normals") else {
            return Ok(None);
        };
        let normals = normals.as_array().map_or(&[][..], Vec::as_slice);
        if normals.len() != points.len() {
            let given = format!("{} normals for {} taxels", normals.len(), points.len());
            let place = format!("{place}, normals");
            return Err(Error::input(place, given, "one normal a taxel"));
        }
        let normal = |(row, normal): (usize, &Value)| {
            const ALLOWED: &str = "three numbers: nx, ny, nz";
            match row_numbers("normals, ", row, normal, ALLOWED)?[..] {
                [x, y, z] => Ok(DVec3::new(x, y, z)),
                _ => {
                    let place = format!("{place}, normals, row {}", row + 1);
                    Err(Error::input(place, format!("`{normal}`"), ALLOWED))
                }
            }
        };
        let normals = normals.iter().enumerate().map(normal);
        normals.collect::<Result<Vec<_>>>().map(Some)
    };
    let normals = match json.get("rotation") {
        Some(rotations) => {
            let rotations = rotations.as_array().map_or(&[][..], Vec::as_slice);
            if rotations.len() != points.len() {
                let given = format!("{} matrices for {} taxels", rotations.len(), points.len());
                let place = format!("{place}, rotation");
                return Err(Error::input(place, given, "one matrix a taxel"));
            }
            let normal = |(row, rotation): (usize, &Value)| {
                const ALLOWED: &str = "a rotation: nine numbers, three right-handed unit columns";
                let numbers = row_numbers("rotation, ", row, rotation, ALLOWED)?;
                let refuse = |given: String| {
                    let place = format!("{place}, rotation, row {}", row + 1);
                    Error::input(place, given, ALLOWED)
                };
                let columns = <[f64; 9]>::try_from(&numbers[..]);
                let columns = columns.map_err(|_| refuse(format!("{} numbers", numbers.len())))?;
                let matrix = DMat3::from_cols_array(&columns);
                match written_rotation_matrix(&matrix) {
                    Some(_) => Ok(matrix.z_axis),
                    None if matrix.determinant() < 0.0 => {
                        Err(refuse("a left-handed frame".to_owned()))
                    }
                    None => Err(refuse("a matrix that is no rotation".to_owned())),
                }
            };
            let normals = rotations.iter().enumerate().map(normal);
            Some(normals.collect::<Result<Vec<_>>>()?)
        }
        None => listed_normals()?,
    };
    let are_in_points = normals.is_none() && normals_of_points.len() == points.len();
    let normals = if are_in_points {
        Some(normals_of_points)
    } else {
        normals
    };
    let points = Points {
        rows: (1..=points.len()).collect(),
        positions: points,
        is_flat: false,
    };
    let without_normals = ("points without normals", "");
    let mut file = LayoutFile::of_points(place, points, normals, options, without_normals)?;
    if !unused.is_empty() {
        let unused: Vec<String> = unused.into_iter().collect();
        file.notes.push(format!(
            "{place}: members of points that are not used: {}",
            unused.join(", ")
        ));
    }
    Ok(file)
}

/// Returns the exponent of ten that converts a unit to metres; `None` if the unit is unknown.
fn exponent_of(unit: &str) -> Option<i64> {
    match unit {
        "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => Some(-3),
        "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => Some(-2),
        "m" | "meter" | "meters" | "metre" | "metres" => Some(0),
        _ => None,
    }
}

/// Returns the text with quotation marks around the words NaN and Infinity.
fn quoted_not_finite(text: &str) -> String {
    let text = text.replace("-Infinity", "Infinity");
    let text = text.replace("Infinity", "\"infinite\"");
    text.replace("NaN", "\"NaN\"")
}

/// Returns the layout as the text of a PaXini JSON file with rotations.
pub(super) fn written(file: &LayoutFile, name: &str) -> String {
    let layout = &file.layout;
    let mm = |metres: f64| 1e3 * metres;
    let points = layout.centers().iter();
    let points: Vec<[f64; 3]> = points.map(|center| center.to_array().map(mm)).collect();
    let frames = (0..layout.n_taxels()).map(|taxel| layout.frame(taxel).to_cols_array());
    let frames: Vec<[f64; 9]> = frames.collect();
    let json = json!({"model": name, "units": "mm", "taxels_mm": points, "rotation": frames});
    json.to_string() + "\n"
}
