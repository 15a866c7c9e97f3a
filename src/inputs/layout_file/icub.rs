//! Position files of iCub's skin (`icub-main/app/skinGui/conf/positions`). A file has keys such as `name` and `taxel2Repr`, and a section `[calibration]` with
//! one row `x y z nx ny nz` (positions in metres) for each taxel. In a file without sections, each line that begins with a number is a row. Rows of zeros belong
//! to channels without a taxel. Some files have positions only, with zeros or `1 0 0` for all normals; a mesh then gives the normals.

use super::{LayoutFile, LayoutOptions, Points};
use crate::error::{Error, Result};
use glam::DVec3;

/// Reads a layout of taxels from the text of an iCub position file. Normals of any length are scaled to length 1. If the file has no normals, they are computed
/// from the mesh.
pub(super) fn read(place: &str, text: &str, options: LayoutOptions) -> Result<LayoutFile> {
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    let (mut rows, mut n_unused) = (Vec::new(), 0);
    let mut n_represented = None;
    // In a file without sections, the rows begin with a number or a parenthesis.
    let has_sections = text.lines().any(|line| line.trim_start().starts_with('['));
    let mut is_row = false;
    for (index, line) in text.lines().enumerate() {
        // YARP's comments begin with `#` or `//`.
        let line = line.split('#').next().unwrap_or_default();
        let line = line.split("//").next().unwrap_or_default().trim();
        if let Some(section) = line.strip_prefix('[') {
            let section = section.trim_end_matches(']').trim();
            is_row = section.eq_ignore_ascii_case("calibration");
            continue;
        }
        if let Some(numbers) = line.strip_prefix("taxel2Repr") {
            let numbers = numbers.split(|c: char| c == '(' || c == ')' || c.is_whitespace());
            n_represented = Some(numbers.filter(|number| !number.is_empty()).count());
        }
        if !has_sections {
            is_row =
                line.starts_with(|first: char| first.is_ascii_digit() || "+-.(".contains(first));
        }
        if line.is_empty() || !is_row {
            continue;
        }
        let at = || format!("{place}, row {}", index + 1);
        // A row may be a list in parentheses.
        let listed = line.strip_prefix('(').and_then(|row| row.strip_suffix(')'));
        let numbers = listed.unwrap_or(line).split_whitespace();
        let numbers = numbers.map(str::parse::<f64>);
        let numbers: Vec<f64> = numbers
            .collect::<std::result::Result<_, _>>()
            .map_err(|_| Error::input(at(), format!("`{line}`"), "six numbers: x y z nx ny nz"))?;
        let [x, y, z, nx, ny, nz] = numbers[..] else {
            let given = format!("{} numbers", numbers.len());
            return Err(Error::input(at(), given, "six numbers: x y z nx ny nz"));
        };
        match numbers.iter().all(|&number| number == 0.0) {
            true => n_unused += 1,
            false => {
                positions.push(DVec3::new(x, y, z));
                normals.push(DVec3::new(nx, ny, nz));
                rows.push(index + 1);
            }
        }
    }
    if rows.is_empty() {
        let allowed = "a section [calibration] with rows x y z nx ny nz";
        let given = match n_unused {
            0 => "no taxel".to_owned(),
            n => format!("no taxel, but {n} rows of zeros"),
        };
        return Err(Error::input(place, given, allowed));
    }
    let n_rows = rows.len() + n_unused;
    let points = Points {
        positions,
        rows,
        is_flat: false,
    };
    let without_normals = ("positions without normals", "rows with normals, or ");
    let mut read = LayoutFile::of_points(place, points, Some(normals), options, without_normals)?;
    if n_unused > 0 {
        read.notes.push(format!(
            "{place}: {n_unused} rows of zeros are channels without a taxel"
        ));
    }
    if let Some(n_represented) = n_represented.filter(|n| *n != n_rows) {
        read.notes.push(format!(
            "{place}: taxel2Repr has {n_represented} numbers for {n_rows} rows; the rows are read"
        ));
    }
    Ok(read)
}

/// Returns the layout as the text of an iCub position file, in which each taxel is a channel that represents itself.
pub(super) fn written(file: &LayoutFile, name: &str) -> String {
    let n_taxels = file.layout.n_taxels();
    let numbers: Vec<String> = (0..n_taxels).map(|taxel| taxel.to_string()).collect();
    let mut text = format!(
        "name                {name}\nspatial_sampling    taxel\ntaxel2Repr          ({})\n\n[calibration]\n",
        numbers.join(" ")
    );
    for (center, axis) in file.layout.centers().iter().zip(file.layout.axes()) {
        let numbers = [center.to_array(), axis.to_array()].concat();
        let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
        text += &(numbers.join("  ") + "\n");
    }
    text
}
