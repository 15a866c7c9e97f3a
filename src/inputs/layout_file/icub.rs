//! Position files of iCub's skin (`icub-main/app/skinGui/conf/positions`). A file has keys such as `name` and `taxel2Repr`, and a section `[calibration]` with
//! one row `x y z nx ny nz` (positions in metres) for each taxel. Rows of zeros belong to channels without a taxel.

use super::LayoutFile;
use crate::error::{Error, Result};
use glam::DVec3;

/// Reads a layout of taxels from the text of an iCub position file. Normals of any length are scaled to length 1.
pub(super) fn read(place: &str, text: &str) -> Result<LayoutFile> {
    let (mut taxels, mut rows, mut n_unused) = (Vec::new(), Vec::new(), 0);
    let mut is_row = false;
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.starts_with('[') {
            is_row = line.eq_ignore_ascii_case("[calibration]");
            continue;
        }
        if line.is_empty() || !is_row {
            continue;
        }
        let at = || format!("{place}, row {}", index + 1);
        let numbers = line.split_whitespace().map(str::parse::<f64>);
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
                taxels.push((DVec3::new(x, y, z), DVec3::new(nx, ny, nz)));
                rows.push(index + 1);
            }
        }
    }
    if rows.is_empty() && n_unused == 0 {
        let allowed = "a section [calibration] with rows x y z nx ny nz";
        return Err(Error::input(place, "no taxel", allowed));
    }
    let mut read = LayoutFile::new(place, taxels, &rows)?;
    if n_unused > 0 {
        read.notes = vec![format!(
            "{place}: {n_unused} rows of zeros are channels without a taxel"
        )];
    }
    Ok(read)
}
