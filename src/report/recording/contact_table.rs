//! Wrench and centre of pressure of each patch in each frame, as a streamed CSV table.
//!
//! Columns: `time_s, patch, n_touched, n_saturated, fx_n, fy_n, fz_n, tx_nm, ty_nm, tz_nm, cop_x_m, cop_y_m, cop_z_m,
//! n_sticking, n_slipping`. Numbers have as many digits as bring the same bits back. The centre of pressure is empty where there is
//! no contact; the wrench is then zero, and says so. The last two are empty for a patch without friction.

use crate::contact::GripCounts;
use crate::error::{Error, Result};
use crate::files::CsvFile;
use glam::DVec3;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What one patch felt at one instant, all its taxels together. Which frame the vectors are in, the writer decides; all
/// rows of a table should be in the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchContact<'a> {
    /// The patch.
    pub patch: &'a str,
    /// Taxels in contact.
    pub n_touched: usize,
    /// Taxels at their stroke.
    pub n_saturated: usize,
    /// Newtons.
    pub force: DVec3,
    /// Newton metres, about the origin of that frame.
    pub torque: DVec3,
    /// Mean place of the taxels in contact, weighted by their normal forces, metres; `None` where there is no contact.
    pub center_of_pressure: Option<DVec3>,
    /// What the taxels of a patch with friction did since the step before.
    pub grips: Option<GripCounts>,
}

/// The table in the making. [`commit`](Self::commit) puts it in place; dropped before, it leaves nothing behind.
pub struct ContactTable {
    path: PathBuf,
    file: CsvFile,
}

#[derive(Serialize)]
struct Row<'a> {
    time_s: f64,
    patch: &'a str,
    n_touched: usize,
    n_saturated: usize,
    fx_n: f64,
    fy_n: f64,
    fz_n: f64,
    tx_nm: f64,
    ty_nm: f64,
    tz_nm: f64,
    cop_x_m: Option<f64>,
    cop_y_m: Option<f64>,
    cop_z_m: Option<f64>,
    n_sticking: Option<usize>,
    n_slipping: Option<usize>,
}

impl ContactTable {
    /// Starts a table that will stand at `path`.
    pub fn create(path: &Path) -> Result<Self> {
        Ok(Self {
            path: path.to_owned(),
            file: CsvFile::create(path)?,
        })
    }

    /// Adds a row; `time` in seconds. The error names a number that is not finite, or why nothing can be written.
    pub fn row(&mut self, time: f64, contact: &PatchContact) -> Result<()> {
        let center = contact.center_of_pressure;
        let vectors = [contact.force, contact.torque, center.unwrap_or_default()];
        if !(time.is_finite() && vectors.iter().all(|v| v.is_finite())) {
            return Err(Error::input(
                format!("{}, patch {}", self.path.display(), contact.patch),
                format!("{contact:?} at {time} s"),
                "finite numbers",
            ));
        }
        self.file.row(Row {
            time_s: time,
            patch: contact.patch,
            n_touched: contact.n_touched,
            n_saturated: contact.n_saturated,
            fx_n: contact.force.x,
            fy_n: contact.force.y,
            fz_n: contact.force.z,
            tx_nm: contact.torque.x,
            ty_nm: contact.torque.y,
            tz_nm: contact.torque.z,
            cop_x_m: center.map(|c| c.x),
            cop_y_m: center.map(|c| c.y),
            cop_z_m: center.map(|c| c.z),
            n_sticking: contact.grips.map(|grips| grips.n_sticking),
            n_slipping: contact.grips.map(|grips| grips.n_slipping),
        })
    }

    /// Makes it durable and puts it in place.
    pub fn commit(self) -> Result<()> {
        self.file.commit()
    }
}
