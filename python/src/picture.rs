//! Image files of frames.

use crate::arrays::{Object, array};
use crate::errors::{check_folder, exception, guarded};
use bubbletouch::report::frame_files;
use bubbletouch::world::Grid;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Writes the deflections (ny, nx; metres) of a grid with this pitch (metres) to a file. The extension selects a picture (.png), a table (.csv) or
/// arrays (.npz). Raises OSError if the file cannot be written, and ValueError if an argument is invalid.
#[pyfunction]
pub fn write_frame(path: PathBuf, frame: &Object, pitch: f64) -> PyResult<()> {
    guarded(|| {
        let is_shape = |shape: &[usize]| shape.len() == 2;
        let frame = array("frame", frame, "(ny, nx)", is_shape)?;
        let frame = frame.finite("frame", "finite numbers")?.matrix();
        let (ny, nx) = frame.dim();
        let grid = Grid { nx, ny, pitch };
        grid.check().map_err(exception)?;
        check_folder(&path)?;
        frame_files::write_frame(&path, &frame, &grid).map_err(exception)
    })
}
